#include "formats/gltf/meshes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "formats/gltf/vertex_data.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

Index largest_of(std::span<const Index> list) {  // several at once, which max_element() is not
    Index largest = 0;
    for (const Index i : list) largest = std::max(largest, i);
    return largest;
}

class MeshReader {
  public:
    MeshReader(GltfDocument& document, Scene& scene, std::vector<std::vector<GltfJoints>>& joints,
               int threads)
        : d_(document), scene_(scene), joints_(joints), threads_(threads), budget_(document) {
        accessors_ = (*top_array(d_, "accessors"))->size();
        materials_ = (*top_array(d_, "materials"))->size();
    }

    Result<void> run() {
        const Json* list = *top_array(d_, "meshes");
        if (auto done = find_shared(*list); !done) return done;
        for (std::size_t m = 0; m < list->size(); ++m)
            if (auto done = mesh((*list)[m], "/meshes/" + std::to_string(m)); !done) return done;
        return {};
    }

  private:
    // --- what is there, by JSON alone ---------------------------------------------------------

    // Looks at the lists, and finds the accessors that more than one primitive uses.
    Result<void> find_shared(const Json& meshes) {
        std::vector<std::uint8_t> users(accessors_, 0);
        for (std::size_t m = 0; m < meshes.size(); ++m) {
            const std::string pointer = "/meshes/" + std::to_string(m) + "/primitives";
            const auto primitives = meshes[m].find("primitives");
            if (primitives == meshes[m].end() || !primitives->is_array() || primitives->empty())
                return d_.bad(pointer, "expected a list with at least one primitive");
            for (std::size_t p = 0; p < primitives->size(); ++p) {
                const std::string place = pointer + "/" + std::to_string(p);
                const Json& primitive = (*primitives)[p];
                if (!primitive.is_object()) return d_.bad(place, "expected an object");
                const auto attributes = primitive.find("attributes");
                if (attributes == primitive.end() || !attributes->is_object() ||
                    attributes->empty())
                    return d_.bad(place + "/attributes",
                                  "expected an object with at least one attribute");
                for (const auto& item : attributes->items()) {
                    const auto accessor =
                        index_value(d_, item.value(),
                                    place + "/attributes/" + pointer_key(item.key()), accessors_);
                    if (!accessor) return accessor.error();
                    if (users[*accessor] < 2) ++users[*accessor];
                }
            }
        }
        shared_.resize(accessors_);
        for (std::size_t a = 0; a < accessors_; ++a) shared_[a] = users[a] > 1;
        return {};
    }

    std::uint64_t count_of(Index accessor) const {
        return d_.json["accessors"][accessor]["count"].get<std::uint64_t>();
    }

    // --- a mesh ------------------------------------------------------------------------------

    Result<void> mesh(const Json& in, const std::string& pointer) {
        scene_.meshes.emplace_back();
        d_.primitives.emplace_back();
        joints_.emplace_back();
        Mesh& mesh = scene_.meshes.back();
        mesh.indexed_by_vertex = mesh.tied_to_file = true;
        mesh.name = name_of(in);
        const Json& primitives = in["primitives"];
        for (std::size_t p = 0; p < primitives.size(); ++p)
            if (auto done =
                    primitive(primitives[p], p, pointer + "/primitives/" + std::to_string(p), mesh);
                !done)
                return done;
        // What is no weight counts as none: nothing here draws by them.
        const auto weights = in.find("weights");
        for (std::size_t t = 0; t < mesh.morph_targets.size(); ++t) {
            if (weights == in.end() || !weights->is_array() || t >= weights->size()) break;
            const Json& w = (*weights)[t];
            const double weight = w.is_number() ? w.get<double>() : 0;
            if (std::abs(weight) <= double(std::numeric_limits<float>::max()))
                mesh.morph_targets[t].weight = float(weight);
        }
        return vertices_.finish(pointer, mesh, threads_);
    }

    void add_variants(const Json& in, Mesh& mesh) const {
        std::vector<Index>& list = mesh.variant_materials;
        for (const Index m : materials_of_variants(in))
            if (m < materials_) list.push_back(m);
        std::sort(list.begin(), list.end());
        list.erase(std::unique(list.begin(), list.end()), list.end());
    }

    Result<void> primitive(const Json& in, std::size_t part, const std::string& pointer,
                           Mesh& mesh) {
        const Json& attributes = in["attributes"];
        GltfPrimitive out;
        out.first_vertex = Index(mesh.positions.size());
        const auto written_mode = whole_member(d_, in, "mode", pointer, 0, 6, 4);
        if (!written_mode) return written_mode.error();
        int mode = int(*written_mode);
        out.triangles = mode >= 4;
        const auto material = index_member(d_, in, "material", pointer, materials_);
        if (!material) return material.error();

        std::optional<std::vector<Index>> indices;
        if (out.triangles && in.contains("extensions") && in["extensions"].is_object() &&
            in["extensions"].contains("KHR_draco_mesh_compression")) {
            auto decoded = decode_draco(d_, in, pointer, out.draco);
            if (!decoded) return std::move(decoded).error();
            // What the accessor says is not read, but written again.
            if (const auto named = index_member(d_, in, "indices", pointer, accessors_); !named)
                return named.error();
            out.draco_indices = *decoded;
            indices = *std::move(decoded);
            mode = 4;  // strips come out of the decoder as triangles
        }
        const auto count = vertex_count(attributes, out, pointer);
        if (!count) return count.error();
        if (auto done = check_targets(in, pointer, *count); !done) return done;
        if (!indices) {
            auto read = read_indices(in, pointer, *count);
            if (!read) return std::move(read).error();
            indices = *std::move(read);
        }
        if (auto done = budget_.spend(indices->size() * 16, pointer); !done) return done;
        const bool in_range = indices->empty() || largest_of(*indices) < *count;
        for (std::size_t i = 0; !in_range; ++i)
            if ((*indices)[i] >= *count)
                return d_.bad(pointer + "/indices", "index " + std::to_string((*indices)[i]) +
                                                        " (number " + std::to_string(i) +
                                                        ") is out of range: the primitive has " +
                                                        std::to_string(*count) + " vertices");
        vertices_.note_names(attributes, out.triangles, *material != no_index, mesh);
        if (const auto targets = in.find("targets"); targets != in.end())
            mesh.morph_targets.resize(std::max(mesh.morph_targets.size(), targets->size()));
        if (!attributes.contains("POSITION")) {
            scene_.warnings.push_back(d_.place(pointer) + ": no positions: nothing to draw");
            indices->clear();
            out.elements.clear();
        } else {
            take_used(attributes, *count, *indices, out);
            const auto vertices = out.elements.empty() ? *count : out.elements.size();
            if (mesh.positions.size() + vertices >= no_index)
                return Error{ErrorCode::limit, "more than 2^32 - 2 vertices", d_.place(pointer)};
            out.vertex_count = Index(vertices);
        }
        warn_left_over(mode, indices->size(), pointer);
        // They fill different arrays.
        Result<void> read;
        parallel_both(
            indices->size() < worth_threads ? 1 : threads_,
            [&] {
                if (!attributes.contains("POSITION")) return;
                read = read_attributes(attributes, pointer + "/attributes", out, mesh);
                if (read) read = read_targets(in, pointer, out, mesh);
            },
            [&] {
                add_elements(mode, *std::move(indices), out.first_vertex, mesh);
                mesh.face_materials.resize(mesh.face_count(), *material);
            });
        if (!read) return read;
        if (out.triangles) add_variants(in, mesh);
        mesh.face_parts.resize(mesh.face_count(), Index(part));
        mesh.parts.resize(part + 1);
        d_.primitives.back().push_back(std::move(out));
        return {};
    }

    // All attributes have the same number of elements; returns it.
    Result<std::uint64_t> vertex_count(const Json& attributes, const GltfPrimitive& out,
                                       const std::string& pointer) const {
        std::optional<std::uint64_t> count;
        std::string first;
        for (const auto& item : attributes.items()) {
            const auto draco = out.draco.find(item.key());
            const std::uint64_t n = draco != out.draco.end()
                                        ? draco->second.count
                                        : count_of(item.value().template get<Index>());
            if (!count) {
                count = n;
                first = item.key();
            }
            if (n != *count)
                return d_.bad(pointer + "/attributes/" + pointer_key(item.key()),
                              "has " + std::to_string(n) + " elements, " + first + " has " +
                                  std::to_string(*count));
        }
        return *count;
    }

    Result<std::vector<Index>> read_indices(const Json& in, const std::string& pointer,
                                            std::uint64_t count) {
        std::vector<Index> indices;
        if (!in.contains("indices")) {
            // A list of all vertices would cost a file of zeros nothing and us four bytes each.
            if (!in["attributes"].contains("POSITION")) return indices;
            indices.resize(count);
            for (std::size_t i = 0; i < count; ++i) indices[i] = Index(i);
            return indices;
        }
        const auto accessor = index_member(d_, in, "indices", pointer, accessors_);
        if (!accessor) return accessor.error();
        const std::string place = pointer + "/indices";
        if (auto done = budget_.spend_on_sparse(*accessor); !done) return std::move(done).error();
        const auto raw = d_.raw_accessor(*accessor);
        if (!raw) return raw.error();
        const int type = raw->component_type;
        if (raw->width != 1 || (type != 5121 && type != 5123 && type != 5125))
            return d_.bad(place, "indices must be unsigned whole scalars, accessor " +
                                     std::to_string(*accessor) + " is of another type");
        indices = to_indices(*raw);
        const Index restart = type == 5121 ? 0xff : type == 5123 ? 0xffff : 0xffffffff;
        if (const auto found = largest_of(indices) < restart
                                   ? indices.end()
                                   : std::find(indices.begin(), indices.end(), restart);
            found != indices.end())
            return d_.bad(place, "index number " + std::to_string(found - indices.begin()) +
                                     " is " + std::to_string(restart) +
                                     ", the largest of its type, which means primitive restart");
        return indices;
    }

    // Primitives that share their vertices with others, as when one buffer serves a whole scene,
    // take what they use: the memory is that of the indices then, however many they are.
    void take_used(const Json& attributes, std::uint64_t count, std::vector<Index>& indices,
                   GltfPrimitive& out) const {
        if (!out.draco.empty() || indices.empty() ||
            !shared_[attributes["POSITION"].template get<Index>()])
            return;
        std::vector<Index> used(indices);
        std::sort(used.begin(), used.end());
        used.erase(std::unique(used.begin(), used.end()), used.end());
        if (used.size() == count) return;
        for (Index& i : indices)
            i = Index(std::lower_bound(used.begin(), used.end(), i) - used.begin());
        out.elements = std::move(used);
    }

    // --- attributes --------------------------------------------------------------------------

    // Those that the primitive has vertices of.
    Result<RawAccessor> elements_of(Index accessor, const GltfPrimitive& primitive) {
        if (auto done = budget_.spend_on_sparse(accessor); !done) return std::move(done).error();
        return primitive.elements.empty() ? d_.raw_accessor(accessor)
                                          : d_.raw_elements(accessor, primitive.elements);
    }

    // What the primitive uses of an attribute. Shared accessors that are read whole are read once.
    Result<const RawAccessor*> attribute(const GltfPrimitive& primitive,
                                         const std::string& semantic, Index accessor) {
        const auto draco = primitive.draco.find(semantic);
        if (draco != primitive.draco.end()) return &draco->second;
        const bool whole = primitive.elements.empty();
        if (whole && shared_[accessor])
            if (const auto known = decoded_.find(accessor); known != decoded_.end())
                return &known->second;
        auto raw = elements_of(accessor, primitive);
        if (!raw) return std::move(raw).error();
        if (whole && shared_[accessor])
            return &decoded_.emplace(accessor, *std::move(raw)).first->second;
        unshared_ = *std::move(raw);
        return &unshared_;
    }

    Result<void> read_attributes(const Json& attributes, const std::string& pointer,
                                 const GltfPrimitive& out, Mesh& mesh) {
        for (const auto& item : attributes.items()) {
            const std::string& semantic = item.key();
            const std::string place = pointer + "/" + pointer_key(semantic);
            const auto raw = attribute(out, semantic, item.value().template get<Index>());
            if (!raw) return raw.error();
            if (auto done = budget_.spend(std::uint64_t(out.vertex_count) * 16, place); !done)
                return done;
            if (auto done = vertices_.append(semantic, **raw, place, out.first_vertex, mesh); !done)
                return done;
            if (set_number(semantic, "JOINTS_"))
                if (auto done = find_largest_joint(attributes, semantic, **raw, place, out); !done)
                    return done;
        }
        return {};
    }

    // Targets that share an accessor share its values.
    Result<void> read_targets(const Json& in, const std::string& pointer, const GltfPrimitive& out,
                              Mesh& mesh) {
        const auto targets = in.find("targets");
        if (targets == in.end()) return {};
        std::map<Index, std::shared_ptr<const std::vector<glm::vec3>>> selected;
        for (std::size_t t = 0; t < targets->size(); ++t) {
            MorphTarget& to = mesh.morph_targets[t];
            for (const auto& [semantic, runs] :
                 {std::pair("POSITION", &to.positions), std::pair("NORMAL", &to.normals),
                  std::pair("TANGENT", &to.tangents)}) {
                const auto member = (*targets)[t].find(semantic);
                if (member == (*targets)[t].end()) continue;
                const Index accessor = member->template get<Index>();
                auto& values = (out.elements.empty() ? deltas_ : selected)[accessor];
                if (!values) {
                    if (auto done =
                            budget_.spend(std::uint64_t(out.vertex_count) * sizeof(glm::vec3),
                                          pointer + "/targets/" + std::to_string(t));
                        !done)
                        return done;
                    const auto raw = elements_of(accessor, out);
                    if (!raw) return raw.error();
                    Growing<glm::vec3> read;
                    read.append(0, *raw);
                    values = std::make_shared<const std::vector<glm::vec3>>(std::move(read.values));
                }
                runs->push_back({out.first_vertex, values});
            }
        }
        return {};
    }

    Result<void> find_largest_joint(const Json& attributes, const std::string& semantic,
                                    const RawAccessor& joints, const std::string& place,
                                    const GltfPrimitive& out) {
        const std::vector<Index> numbers = to_indices(joints);
        std::vector<float> weights;
        const auto weight = attributes.find("WEIGHTS_" + semantic.substr(7));
        if (weight != attributes.end()) {
            const auto raw = attribute(out, weight.key(), weight->template get<Index>());
            if (!raw) return raw.error();
            weights = to_floats(**raw);
        }
        GltfJoints found{place, 0};
        for (std::size_t i = 0; i < numbers.size(); ++i)
            if (i < weights.size() && weights[i] != 0)
                found.largest = std::max(found.largest, numbers[i]);
        joints_.back().push_back(std::move(found));
        return {};
    }

    Result<void> check_targets(const Json& in, const std::string& pointer,
                               std::uint64_t count) const {
        const auto targets = in.find("targets");
        if (targets == in.end()) return {};
        if (!targets->is_array()) return d_.bad(pointer + "/targets", "expected an array");
        for (std::size_t t = 0; t < targets->size(); ++t) {
            const std::string place = pointer + "/targets/" + std::to_string(t);
            if (!(*targets)[t].is_object()) return d_.bad(place, "expected an object");
            for (const auto& item : (*targets)[t].items()) {
                const std::string at = place + "/" + pointer_key(item.key());
                const auto accessor = index_value(d_, item.value(), at, accessors_);
                if (!accessor) return accessor.error();
                if (count_of(*accessor) != count)
                    return d_.bad(at, "has " + std::to_string(count_of(*accessor)) +
                                          " elements, the primitive has " + std::to_string(count) +
                                          " vertices");
                const std::string& semantic = item.key();
                const bool vector =
                    semantic == "POSITION" || semantic == "NORMAL" || semantic == "TANGENT";
                if (vector && d_.json["accessors"][*accessor]["type"] != "VEC3")
                    return d_.bad(at, "a target's " + semantic + " must be VEC3");
            }
        }
        return {};
    }

    void warn_left_over(int mode, std::size_t count, const std::string& pointer) {
        const std::size_t each = mode == 4 ? 3 : mode == 1 ? 2 : 1;
        const std::size_t least = mode >= 4 ? 3 : mode == 0 ? 0 : 2;
        if (count % each == 0 && (count == 0 || count >= least)) return;
        scene_.warnings.push_back(
            d_.place(pointer) + ": " + std::to_string(count) + " indices make no " +
            (mode >= 4 ? "whole triangles" : "whole lines") + ": the last ones were left out");
    }

    // --- faces, lines and points -------------------------------------------------------------

    // Of the first primitive they are the mesh's corners as they are.
    static void add_triangles(std::vector<Index> indices, Index base, Mesh& mesh) {
        indices.resize(indices.size() / 3 * 3);
        std::vector<Index>& corners = mesh.corner_vertices;
        const std::size_t before = corners.size(), faces = mesh.face_offsets.size();
        if (before == 0 && base == 0) {
            corners = std::move(indices);
        } else {
            corners.resize(before + indices.size());
            for (std::size_t i = 0; i < indices.size(); ++i)
                corners[before + i] = base + indices[i];
        }
        mesh.face_offsets.resize(faces + (corners.size() - before) / 3);
        for (std::size_t f = faces; f < mesh.face_offsets.size(); ++f)
            mesh.face_offsets[f] = mesh.face_offsets[f - 1] + 3;
    }

    static void add_elements(int mode, std::vector<Index> indices, Index base, Mesh& mesh) {
        const std::size_t n = indices.size();
        const auto face = [&](Index a, Index b, Index c) {
            for (const Index v : {a, b, c}) mesh.corner_vertices.push_back(base + v);
            mesh.face_offsets.push_back(Index(mesh.corner_vertices.size()));
        };
        const auto line = [&](std::size_t first, std::size_t last, bool closed) {
            if (last - first < 2) return;
            for (std::size_t i = first; i < last; ++i)
                mesh.line_vertices.push_back(base + indices[i]);
            if (closed) mesh.line_vertices.push_back(base + indices[first]);
            mesh.line_offsets.push_back(Index(mesh.line_vertices.size()));
        };
        switch (mode) {
            case 0:
                for (const Index v : indices) mesh.points.push_back(base + v);
                break;
            case 1:
                for (std::size_t i = 0; i + 1 < n; i += 2) line(i, i + 2, false);
                break;
            case 2:
                line(0, n, true);
                break;
            case 3:
                line(0, n, false);
                break;
            case 4:
                add_triangles(std::move(indices), base, mesh);
                break;
            case 5:  // the order of the specification: the first vertex stays the provoking one
                for (std::size_t i = 0; i + 2 < n; ++i)
                    face(indices[i], indices[i + 1 + i % 2], indices[i + 2 - i % 2]);
                break;
            case 6:
                for (std::size_t i = 0; i + 2 < n; ++i)
                    face(indices[i + 1], indices[i + 2], indices[0]);
                break;
            default:
                break;
        }
    }

    GltfDocument& d_;
    Scene& scene_;
    std::vector<std::vector<GltfJoints>>& joints_;
    int threads_;
    DecodeBudget budget_;
    VertexData vertices_{d_, budget_};
    std::size_t accessors_ = 0, materials_ = 0;
    std::vector<bool> shared_;              // per accessor: several primitives use it
    std::map<Index, RawAccessor> decoded_;  // the shared ones
    RawAccessor unshared_;                  // the last of the others
    std::map<Index, std::shared_ptr<const std::vector<glm::vec3>>> deltas_;  // by accessor
};

}  // namespace

Result<void> read_gltf_meshes(GltfDocument& document, Scene& scene,
                              std::vector<std::vector<GltfJoints>>& joints, int threads) {
    return MeshReader(document, scene, joints, threads).run();
}

}  // namespace prep::detail
