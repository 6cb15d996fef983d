#include "formats/gltf/nodes/refined_primitive.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/finite.h"
#include "model/vertex_deltas.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;
constexpr int array_buffer = 34962;

class RefinedPrimitive {
  public:
    RefinedPrimitive(const PreparedScene& prepared, Index m, const std::vector<Index>& used,
                     AppendedData& data, Json& json)
        : prepared_(prepared),
          number_(m),
          faces_(prepared.scene.meshes[m]),
          mesh_(prepared.meshes[m]),
          used_(used),
          data_(data),
          json_(json) {
        for (const Index i : used) {
            const Index v = mesh_.source_vertices[i], c = mesh_.source_corners[i];
            vertices_.push_back(faces_.file_vertex(v));
            corners_.push_back(c == no_index ? vertices_.back() : faces_.corner_file_vertex(c));
        }
    }

    // What there is of an attribute; none: the refined mesh carries no such thing.
    std::optional<std::size_t> attribute(const std::string& name, const Json& before) {
        if (name == "POSITION") return bounded(at_used(mesh_.positions));
        // Of a set that was not refined, which a finding tells, zeros: a material may not go
        // without.
        if (const auto set = set_number(name, "TEXCOORD_"))
            return add(*set < mesh_.uvs.size() && !mesh_.uvs[*set].empty()
                           ? at_used(mesh_.uvs[*set])
                           : std::vector<glm::vec2>(used_.size()),
                       "VEC2");
        if (const auto set = set_number(name, "COLOR_"); set && *set < mesh_.colors.size())
            return color(mesh_.colors[*set], before);
        if (const auto set = set_number(name, "JOINTS_"); set && *set < influence_sets())
            return joints(*set);
        if (const auto set = set_number(name, "WEIGHTS_"); set && *set < influence_sets())
            return add(normalised(*set), "VEC4");
        for (const VertexAttribute& a : faces_.vertex_attributes)
            if (a.name == name && !a.values.empty()) return named(a, before);
        return std::nullopt;
    }
    // Sets of influences there may be more of than the file had, or fewer.
    std::size_t influence_sets() const { return faces_.skin_influences.size(); }

    std::optional<std::size_t> normals() {
        if (mesh_.normals.empty()) return std::nullopt;
        return add(at_used(mesh_.normals), "VEC3");
    }
    std::optional<std::size_t> tangents() {
        if (mesh_.tangents.empty() || mesh_.normals.empty()) return std::nullopt;
        return add(at_used(mesh_.tangents), "VEC4");
    }

    Json target(std::size_t t, const Json& attributes) {
        Json out = Json::object();
        if (t >= faces_.morph_targets.size()) return out;
        std::vector<glm::vec3> moved(used_.size(), glm::vec3(0.0f));
        for (std::size_t i = 0; i < moved.size(); ++i)
            if (const glm::vec3* d = delta_of(faces_.morph_targets[t].positions, vertices_[i]))
                moved[i] = *d;
        out["POSITION"] = bounded(moved);
        if (number_ >= prepared_.morphs.size() || t >= prepared_.morphs[number_].size()) return out;
        const MorphDeltas& made = prepared_.morphs[number_][t];
        if (!made.normals.empty() && attributes.contains("NORMAL"))
            out["NORMAL"] = add(at_used(made.normals), "VEC3");
        if (!made.tangents.empty() && attributes.contains("TANGENT"))
            out["TANGENT"] = add(at_used(made.tangents), "VEC3");
        return out;
    }

  private:
    template <class T>
    std::vector<T> at_used(const std::vector<T>& values) const {
        std::vector<T> out;
        out.reserve(used_.size());
        for (const Index i : used_) {
            T value = values[i];
            for (int k = 0; k < T::length(); ++k)
                if (!std::isfinite(value[k])) value[k] = 0;
            out.push_back(value);
        }
        return out;
    }
    template <class T>
    std::size_t add(std::vector<T> values, const char* type, int component = 5126,
                    std::size_t stride = 0) {
        return data_.add_accessor(
            Json{{"bufferView",
                  data_.add_view(SharedBytes::of(std::move(values)), array_buffer, stride)},
                 {"componentType", component},
                 {"count", used_.size()},
                 {"type", type}});
    }
    std::size_t bounded(std::vector<glm::vec3> values) {
        glm::vec3 low = values[0], high = values[0];
        for (const glm::vec3& v : values) {
            low = glm::min(low, v);
            high = glm::max(high, v);
        }
        const std::size_t accessor = add(std::move(values), "VEC3");
        json_["accessors"][accessor]["min"] = {low.x, low.y, low.z};
        json_["accessors"][accessor]["max"] = {high.x, high.y, high.z};
        return accessor;
    }
    // As many components as the file gave.
    std::size_t color(const std::vector<glm::vec4>& values, const Json& before) {
        std::vector<glm::vec4> own = at_used(values);
        for (glm::vec4& c : own) c = glm::clamp(c, 0.0f, 1.0f);
        if (before.value("type", "VEC4") != "VEC3") return add(std::move(own), "VEC4");
        return add(std::vector<glm::vec3>(own.begin(), own.end()), "VEC3");
    }
    std::size_t joints(std::size_t set) {
        const auto& from = faces_.skin_influences[set];
        std::vector<glm::vec<4, std::uint16_t>> own(used_.size());
        for (std::size_t i = 0; i < own.size(); ++i)
            for (int k = 0; k < 4; ++k)  // joints without weight are 0
                own[i][k] = std::uint16_t(vertices_[i] < from.joints.size() &&
                                                  from.weights[vertices_[i]][k] > 0
                                              ? from.joints[vertices_[i]][k]
                                              : 0);
        return add(std::move(own), "VEC4", 5123);
    }
    // The sum over all sets is 1.
    std::vector<glm::vec4> normalised(std::size_t set) {
        std::vector<glm::vec4> own(used_.size(), glm::vec4(0.0f));
        for (std::size_t i = 0; i < own.size(); ++i) {
            double sum = 0;
            for (const SkinInfluences& other : faces_.skin_influences)
                if (vertices_[i] < other.weights.size())
                    for (int k = 0; k < 4; ++k)
                        sum += std::max(0.0, double(other.weights[vertices_[i]][k]));
            const auto& from = faces_.skin_influences[set].weights;
            if (!(sum > 0))
                own[i].x = set == 0 ? 1.0f : 0.0f;
            else if (vertices_[i] < from.size())
                for (int k = 0; k < 4; ++k)
                    own[i][k] = float(std::max(0.0, double(from[vertices_[i]][k])) / sum);
        }
        return own;
    }
    // In the type that this primitive had: others may have had a wider one.
    std::size_t named(const VertexAttribute& a, const Json& before) {
        const std::string type = before.at("type");
        const std::size_t width = std::min<std::size_t>(std::size_t(components_of(type)), a.width);
        std::vector<float> own(used_.size() * width);
        for (std::size_t i = 0; i < used_.size(); ++i) {
            const std::size_t from = std::size_t(corners_[i]) * a.width;
            for (std::size_t k = 0; k < width && from + k < a.values.size(); ++k)
                own[i * width + k] = a.values[from + k];
        }
        return add(std::move(own), type.c_str());
    }

    const PreparedScene& prepared_;
    Index number_;
    const Mesh& faces_;
    const VertexMesh& mesh_;
    const std::vector<Index>& used_;
    AppendedData& data_;
    Json& json_;
    std::vector<Index> vertices_, corners_;  // whose influences and deltas; whose attributes
};

}  // namespace

bool is_left_out(const PreparedScene& prepared, std::size_t mesh, const std::string& semantic) {
    return mesh < prepared.requirements.size() && !prepared.requirements[mesh].provided.colors &&
           set_number(semantic, "COLOR_");
}

void RefinedLosses::note(std::vector<std::string>& notes) const {
    if (!attributes.empty())
        notes.push_back("left out of subdivided meshes: attributes " + attributes.text());
    if (!of_targets.empty())
        notes.push_back("left out of subdivided meshes: what morph targets change of " +
                        of_targets.text());
}

void write_refined_primitive(const PreparedScene& prepared, Index mesh,
                             const std::vector<Index>& used, std::span<const Index> indices,
                             bool with_tangents, AppendedData& data, Json& json, Json& primitive,
                             RefinedLosses& lost) {
    RefinedPrimitive refined(prepared, mesh, used, data, json);
    const Json before = primitive["attributes"];
    Json attributes = Json::object();
    for (const auto& item : before.items()) {
        const std::string& name = item.key();
        if (name == "NORMAL" || name == "TANGENT" || set_number(name, "JOINTS_") ||
            set_number(name, "WEIGHTS_") || is_left_out(prepared, mesh, name))
            continue;
        const Json accessor = json["accessors"][item.value().get<std::size_t>()];
        if (const auto made = refined.attribute(name, accessor)) {
            attributes[name] = *made;
            continue;
        }
        lost.attributes.add(name);
    }
    if (before.contains("JOINTS_0"))
        for (std::size_t s = 0; s < refined.influence_sets(); ++s)
            for (const char* head : {"JOINTS_", "WEIGHTS_"}) {
                const std::string name = head + std::to_string(s);
                attributes[name] = *refined.attribute(name, {});
            }
    if (const auto normals = refined.normals()) attributes["NORMAL"] = *normals;
    if (with_tangents)
        if (const auto tangents = refined.tangents()) attributes["TANGENT"] = *tangents;
    primitive["attributes"] = attributes;
    if (primitive.contains("targets")) {
        Json targets = Json::array();
        for (std::size_t t = 0; t < primitive["targets"].size(); ++t) {
            for (const auto& item : primitive["targets"][t].items())
                if (item.key() != "POSITION" && item.key() != "NORMAL" && item.key() != "TANGENT" &&
                    !is_left_out(prepared, mesh, item.key()))
                    lost.of_targets.add(item.key());
            targets.push_back(refined.target(t, attributes));
        }
        primitive["targets"] = std::move(targets);
    }
    primitive["indices"] = data.add_indices(indices, used.size());
    primitive.erase("mode");
    if (const auto extensions = primitive.find("extensions"); extensions != primitive.end()) {
        extensions->erase("KHR_draco_mesh_compression");
        if (extensions->empty()) primitive.erase("extensions");
    }
}

void drop_used_heights(const PreparedScene& prepared, Json& json) {
    const bool displaced =
        std::any_of(prepared.tessellated.begin(), prepared.tessellated.end(),
                    [](const auto& certificate) { return certificate.has_value(); });
    if (!displaced || !json.contains("materials")) return;
    const std::vector<Material>& materials = prepared.scene.materials;
    for (std::size_t k = 0; k < json["materials"].size() && k < materials.size(); ++k) {
        Json& material = json["materials"][k];
        const auto extras = material.find("extras");
        if (materials[k].displacement_map || extras == material.end() || !extras->is_object() ||
            !extras->contains("displacement") || !(*extras)["displacement"].is_object() ||
            !(*extras)["displacement"].contains("texture"))
            continue;
        extras->erase("displacement");
        if (extras->empty()) material.erase("extras");
    }
}

void assign_residual_materials(const PreparedScene& prepared, Json& json) {
    if (!json.contains("meshes")) return;
    for (const ResidualMap& map : prepared.residual_maps) {
        Json& materials = json["materials"];
        if (materials.is_null()) materials = Json::array();
        while (materials.size() <= map.material)
            materials.push_back({{"name", prepared.scene.materials[materials.size()].name}});
        for (std::size_t m = 0; m < prepared.meshes.size() && m < json["meshes"].size(); ++m) {
            Json& primitives = json["meshes"][m]["primitives"];
            for (const VertexMesh::Range& range : prepared.meshes[m].ranges)
                if (range.material == map.material && range.part < primitives.size() &&
                    !primitives[range.part].contains("material"))
                    primitives[range.part]["material"] = map.material;
        }
    }
}

void write_residual_maps(const PreparedScene& prepared, AppendedData& data, Json& json) {
    for (const ResidualMap& map : prepared.residual_maps) {
        const ImageRef& image = prepared.scene.images[map.image];
        const std::size_t view = data.add_view(SharedBytes::lent(image.bytes), 0, 0);
        for (const char* list : {"images", "textures"})
            if (!json.contains(list)) json[list] = Json::array();
        json["images"].push_back(
            {{"name", image.name}, {"mimeType", image.mime_type}, {"bufferView", view}});
        json["textures"].push_back({{"source", json["images"].size() - 1}});
        // Whatever stands there named another picture: nothing of it fits this one.
        Json& texture = json["materials"][map.material]["normalTexture"];
        texture = Json::object();
        texture["index"] = json["textures"].size() - 1;
        if (map.uv_set != 0) texture["texCoord"] = map.uv_set;
    }
}

}  // namespace prep::detail
