#include "formats/gltf/vertex_data.h"

#include "base/parallel.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

void append_joints(const RawAccessor& raw, std::size_t first,
                   std::vector<glm::vec<4, std::uint16_t>>& to) {
    to.resize(first + raw.count, glm::vec<4, std::uint16_t>(0));
    const std::vector<Index> numbers = to_indices(raw);
    for (std::size_t i = 0; i < numbers.size(); ++i)
        to[first + i / 4][int(i % 4)] = std::uint16_t(numbers[i]);
}

}  // namespace

Result<void> DecodeBudget::spend(std::uint64_t bytes, const std::string& pointer) {
    if (bytes > left_)
        return Error{ErrorCode::limit,
                     "the primitives use the file's data so often that they would fill " +
                         std::to_string(decoded_limit(document_.input_bytes) >> 20) + " MiB",
                     document_.place(pointer)};
    left_ -= bytes;
    return {};
}

Result<void> DecodeBudget::spend_on_sparse(std::size_t accessor) {
    const Json& in = document_.json["accessors"][accessor];
    if (!in.contains("sparse")) return {};
    const std::uint64_t bytes =
        in["count"].get<std::uint64_t>() *
        stored_size(in["type"].get<std::string>(), in["componentType"].get<int>());
    if (bytes > sparse_left_)
        return Error{ErrorCode::limit,
                     "sparse accessors are used so often that they would come to " +
                         std::to_string(sparse_limit(document_.input_bytes) >> 20) + " MiB",
                     document_.place("/accessors/" + std::to_string(accessor))};
    sparse_left_ -= bytes;
    return {};
}

Result<void> VertexData::append(const std::string& semantic, const RawAccessor& raw,
                                const std::string& pointer, std::size_t first, Mesh& mesh) {
    const auto bad = [&](std::string text) {
        return Error{ErrorCode::invalid, std::move(text), d_.place(pointer)};
    };
    const auto wants = [&](int low, int high) -> Result<void> {
        if (raw.width < low || raw.width > high)
            return bad(semantic + " needs " + std::to_string(std::uint64_t(low)) +
                       (high > low ? " or " + std::to_string(std::uint64_t(high)) : "") +
                       " components, found " + std::to_string(std::uint64_t(raw.width)));
        if (raw.component_type == 5125) return bad(semantic + " cannot be of unsigned 32-bit type");
        return {};
    };
    if (semantic == "POSITION") {
        if (auto done = wants(3, 3); !done) return done;
        const std::size_t before = mesh.positions.size();
        mesh.positions.resize(before + raw.count);
        if (raw.count > 0) write_floats(raw, 3, &mesh.positions[before].x);
    } else if (semantic == "NORMAL") {
        if (auto done = wants(3, 3); !done) return done;
        normals_.append(first, raw);
    } else if (semantic == "TANGENT") {
        if (auto done = wants(4, 4); !done) return done;
        tangents_.append(first, raw);
    } else if (const auto uv = set_number(semantic, "TEXCOORD_")) {
        if (auto done = wants(2, 2); !done) return done;
        if (uvs_.size() <= *uv) uvs_.resize(*uv + 1);
        uvs_[*uv].append(first, raw);
    } else if (const auto color = set_number(semantic, "COLOR_")) {
        if (auto done = wants(3, 4); !done) return done;
        if (colors_.size() <= *color) colors_.resize(*color + 1);
        colors_[*color].append(first, raw);
        for (std::size_t i = first; i < colors_[*color].values.size(); ++i) {
            glm::vec4& c = colors_[*color].values[i];
            if (raw.width == 3) c.a = 1;
            // glTF 2.0, 3.7.2.1; what is no number stays, to be told.
            for (int k = 0; *color == 0 && k < 4; ++k) c[k] = c[k] < 0 ? 0 : c[k] > 1 ? 1 : c[k];
        }
    } else if (set_number(semantic, "JOINTS_") || set_number(semantic, "WEIGHTS_")) {
        if (auto done = wants(4, 4); !done) return done;
        if (semantic[0] == 'J' && raw.component_type != 5121 && raw.component_type != 5123)
            return bad("joints must be unsigned whole numbers of 8 or 16 bits");
        const std::size_t set = *set_number(semantic, semantic[0] == 'J' ? "JOINTS_" : "WEIGHTS_");
        if (influences_.size() <= set) influences_.resize(set + 1);
        if (semantic[0] == 'J')
            append_joints(raw, first, influences_[set].joints);
        else
            influences_[set].weights.append(first, raw);
    } else if (semantic.starts_with("_")) {
        return append_named(semantic, raw, pointer, first, mesh);
    }
    return {};
}

Result<void> VertexData::append_named(const std::string& name, const RawAccessor& raw,
                                      const std::string& pointer, std::size_t first, Mesh& mesh) {
    VertexAttribute& to = mesh.vertex_attributes[named_index_.at(name)];
    // Each primitive may have it in a type of its own: the widest holds them all.
    if (to.values.empty() || Index(raw.width) > to.width) {
        named_width_ += Index(raw.width) - (to.values.empty() ? 0 : to.width);
        if (auto done = widen(to, Index(raw.width), pointer); !done) return done;
    }
    if (auto done = budget_.spend(
            (first + raw.count) * to.width * sizeof(float) - to.values.size() * sizeof(float),
            pointer);
        !done)
        return done;
    to.values.resize((first + raw.count) * to.width, 0.0f);
    if (raw.count > 0) write_floats(raw, int(to.width), &to.values[first * to.width]);
    return {};
}

Result<void> VertexData::widen(VertexAttribute& attribute, Index width,
                               const std::string& pointer) {
    const std::size_t vertices = attribute.values.size() / attribute.width;
    if (auto done = budget_.spend(vertices * (width - attribute.width) * sizeof(float), pointer);
        !done)
        return done;
    std::vector<float> values(vertices * width, 0.0f);
    for (std::size_t v = 0; v < vertices; ++v)
        std::copy_n(&attribute.values[v * attribute.width], attribute.width, &values[v * width]);
    attribute.values = std::move(values);
    attribute.width = width;
    return {};
}

void VertexData::note_names(const Json& attributes, bool triangles, bool material, Mesh& mesh) {
    bool layers = material;
    for (const auto& item : attributes.items()) {
        const std::string& name = item.key();
        layers |= name == "NORMAL" || name.starts_with("TEXCOORD_");
        if (name.starts_with("_") &&
            named_index_.emplace(name, mesh.vertex_attributes.size()).second)
            mesh.vertex_attributes.push_back({name, 1, {}});
    }
    if (layers && !triangles) ++mesh.loose_parts_with_attributes;
}

Result<void> VertexData::finish(const std::string& pointer, Mesh& mesh, int threads) {
    const std::uint64_t layers =
        2 + uvs_.size() + colors_.size() + 6 * influences_.size() + named_width_;
    if (auto done =
            budget_.spend(layers * (mesh.vertex_count() + mesh.corner_count()) * 4, pointer);
        !done)
        return done;
    const bool loose =
        mesh.corner_count() == 0 || !mesh.line_vertices.empty() || !mesh.points.empty();
    if (!colors_.empty() && loose && !colors_[0].values.empty()) {
        mesh.vertex_colors = colors_[0].values;
        mesh.vertex_colors.resize(mesh.vertex_count());
        const std::vector<bool>& has = colors_[0].has;
        for (std::size_t v = 0; v < mesh.vertex_colors.size(); ++v)
            if (v >= has.size() || !has[v]) mesh.vertex_colors[v] = glm::vec4(1.0f);
    }
    mesh.colors.resize(mesh.corner_count() > 0 ? colors_.size() : 0);
    mesh.uvs.resize(uvs_.size());
    const std::size_t sets = uvs_.size();
    parallel_tasks(2 + sets + mesh.colors.size(), mesh.corner_count() < worth_threads ? 1 : threads,
                   [&](std::size_t i) {
                       if (i == 0) return normals_.finish(mesh, mesh.normals);
                       if (i == 1) return tangents_.finish(mesh, mesh.tangents);
                       if (i - 2 < sets) return uvs_[i - 2].finish(mesh, mesh.uvs[i - 2]);
                       const std::size_t color = i - 2 - sets;
                       colors_[color].finish(mesh, mesh.colors[color]);
                   });
    uvs_.clear();
    colors_.clear();
    // A set of which the file has one half, or none, moves nothing.
    for (auto& [joints, weights] : influences_) {
        joints.resize(mesh.vertex_count(), Joints::value_type(0));
        weights.values.resize(mesh.vertex_count(), glm::vec4(0.0f));
        mesh.skin_influences.push_back({std::move(joints), std::move(weights.values)});
    }
    influences_.clear();
    for (VertexAttribute& a : mesh.vertex_attributes)
        if (!a.values.empty()) a.values.resize(mesh.vertex_count() * a.width, 0.0f);
    named_width_ = 0;
    named_index_.clear();
    return {};
}

}  // namespace prep::detail
