#include "formats/gltf/rewrite.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/finite.h"
#include "formats/gltf/appended_data.h"
#include "formats/gltf/build.h"
#include "formats/gltf/compression/kept_meshopt.h"
#include "formats/gltf/extensions.h"
#include "formats/gltf/nodes/placed_document.h"
#include "formats/gltf/nodes/refined_primitive.h"
#include "formats/gltf/references.h"
#include "formats/gltf/values/bounds.h"
#include "formats/gltf/values/document_repair.h"
#include "formats/gltf/values/pictures.h"
#include "formats/gltf/values/primitive_vertices.h"
#include "formats/gltf/values/value_repair.h"
#include "normals/authored_normals.h"
#include "text/note_once.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

class Rewriter {
  public:
    Rewriter(const PreparedScene& prepared, Compression compression,
             std::vector<std::string>& notes)
        : prepared_(prepared),
          document_(*gltf_document(prepared.scene)),
          keeps_draco_(compression == Compression::keep || compression == Compression::draco),
          keeps_meshopt_(compression == Compression::keep || compression == Compression::meshopt),
          notes_(notes) {
        plan_.draco = compression == Compression::draco;
        plan_.meshopt = compression == Compression::meshopt;
    }

    Result<RewrittenGltf> run() {
        json_ = document_.json;
        // Made first: a new key moves its siblings, and references to them are held below. pack()
        // takes away what stays empty.
        for (const char* list : {"accessors", "bufferViews"})
            if (!json_.contains(list)) json_[list] = Json::array();
        assign_residual_materials(prepared_, json_);
        for (Index m = 0; m < prepared_.scene.meshes.size(); ++m)
            if (auto done = mesh(m); !done) return std::move(done).error();
        drop_used_heights(prepared_, json_);
        write_residual_maps(prepared_, appended_, json_);
        lost_.note(notes_);
        if (dropped_triangles_ > 0)
            notes_.push_back(non_finite_note(dropped_triangles_, "triangle"));
        if (!keeps_meshopt_) remove_meshopt();
        declare_compression(json_);
        embed_pictures(prepared_.scene.images, json_, appended_,
                       [&](const std::string& text) { note_once(notes_, text); });
        if (auto done = place_document(prepared_.scene, document_, json_, appended_); !done)
            return std::move(done).error();
        note_non_finite_data(document_, json_, notes_);
        repair_document(document_, json_, appended_, notes_);
        auto packed = pack_buffer(document_, json_, appended_, notes_);
        if (!packed) return std::move(packed).error();
        remove_empty_lists(json_);
        RewrittenGltf out;
        out.json = std::move(json_);
        out.packed = *std::move(packed);
        out.plan = std::move(plan_);
        return out;
    }

  private:
    struct Gathered {
        std::size_t accessor = 0;  // of the file
        bool implied = false;      // zeros, of which the file stores none
        bool repaired = false;     // they are not the file's
        RawAccessor values;        // at the primitive's vertices
    };
    // Which elements of the file's accessors the vertices are. Welded vertices are one in place,
    // but each of its corners keeps the attributes that it had: then `of_corners` has those.
    struct Elements {
        std::vector<Index> of_vertices, of_corners;
        const std::vector<Index>& of(const std::string& semantic) const {
            const bool by_vertex = semantic == "POSITION" || semantic.starts_with("JOINTS_") ||
                                   semantic.starts_with("WEIGHTS_");
            return by_vertex || of_corners.empty() ? of_vertices : of_corners;
        }
    };
    using AttributeMap = std::map<std::string, Gathered>;
    struct GatheredPrimitive {
        AttributeMap attributes;  // but normals and tangents, which the mesh has
        std::vector<AttributeMap> targets;
    };

    Result<void> mesh(Index m) {
        const std::vector<GltfPrimitive>& primitives = document_.primitives[m];
        const VertexMesh& mesh = prepared_.meshes[m];
        positions_finite_ = all_finite(floats_of(mesh.positions));
        const RangesByPart ranges(mesh);
        for (std::size_t p = 0; p < primitives.size(); ++p) {
            if (!primitives[p].triangles) continue;
            PrimitiveTriangles triangles(mesh, ranges.of(p));
            if (triangles.empty() && is_subdivided(m) && primitives[p].vertex_count > 2)
                return Error{ErrorCode::unsupported,
                             "no face of a primitive is left of its subdivision (holes, or a "
                             "boundary rule of none): it cannot be written back; use another "
                             "--subdivide-boundary",
                             document_.place(primitive_pointer(m, p))};
            if (triangles.empty()) continue;
            if (auto done = primitive(m, p, std::move(triangles)); !done) return done;
        }
        return {};
    }

    // What each vertex in use is of the file's.
    Elements elements_of(Index m, const GltfPrimitive& source,
                         const std::vector<Index>& used) const {
        const VertexMesh& mesh = prepared_.meshes[m];
        const Mesh& faces = prepared_.scene.meshes[m];
        Elements elements;
        const bool by_corner = !faces.corner_file_vertices.empty();
        elements.of_vertices.resize(used.size());
        if (by_corner) elements.of_corners.resize(used.size());
        for (std::size_t k = 0; k < used.size(); ++k) {
            const Index v = mesh.source_vertices[used[k]], c = mesh.source_corners[used[k]];
            const Index of_vertex = faces.file_vertex(v);
            elements.of_vertices[k] = source.element_of(of_vertex - source.first_vertex);
            if (!by_corner) continue;
            const Index of_corner = c == no_index ? of_vertex : faces.corner_file_vertex(c);
            elements.of_corners[k] = source.element_of(of_corner - source.first_vertex);
        }
        return elements;
    }

    Result<void> primitive(Index m, std::size_t p, PrimitiveTriangles triangles) {
        const GltfPrimitive& source = document_.primitives[m][p];
        const VertexMesh& mesh = prepared_.meshes[m];
        if (!positions_finite_)
            triangles.change([&](std::vector<Index>& indices) {
                dropped_triangles_ += drop_non_finite(mesh.positions, indices);
            });
        if (triangles.empty()) {
            if (!source.draco.empty())
                return Error{ErrorCode::unsupported,
                             "a compressed primitive without a triangle of finite positions cannot "
                             "be written",
                             document_.place(primitive_pointer(m, p))};
            note_once(notes_,
                      "primitives without a triangle of finite positions were left as they are");
            return {};
        }
        const UsedVertices used = number_used(mesh, triangles);
        const std::span<const Index> indices = triangles.indices();
        if (is_subdivided(m)) {
            refined(m, p, used.list, indices);
            return {};
        }
        const Elements elements = elements_of(m, source, used.list);
        Json& out = json_["meshes"][m]["primitives"][p];
        DracoCoding coding;
        if (keeps_draco_ && !source.draco.empty()) {
            auto read = draco_coding(document_, out, primitive_pointer(m, p));
            if (!read) return std::move(read).error();
            coding = *std::move(read);
        }
        auto gathered = gather_all(source, out, elements, coding, m);
        if (!gathered) return std::move(gathered).error();
        const VertexVectors<glm::vec3> normals = repaired_normals(mesh.normals, used);
        const VertexVectors<glm::vec4> tangents = repaired_tangents(mesh.tangents, normals, used);
        if (!changed_ && elements.of_corners.empty() &&
            untouched(m, out, source, elements.of_vertices, indices, normals, tangents))
            return {};

        const bool by_meshopt = keeps_meshopt_ && meshopt_.has_part_of(out);
        const std::size_t first_accessor = json_["accessors"].size();
        const bool had_tangents = out["attributes"].contains("TANGENT");
        Json attributes = Json::object();
        for (const auto& item : out["attributes"].items())
            if (const auto it = gathered->attributes.find(item.key());
                it != gathered->attributes.end())
                attributes[item.key()] =
                    emit_reshaped(item.key(), std::move(it->second), elements, m, used.list);
        const auto frame = [&](const char* semantic, const auto& values) -> Result<void> {
            if (out["attributes"].contains(semantic)) {
                auto kept = kept_directions(source, out["attributes"], semantic, elements, values);
                if (!kept) return std::move(kept).error();
                if (*kept) {
                    attributes[semantic] = emit(semantic, **std::move(kept), elements);
                    return {};
                }
            }
            attributes[semantic] = appended_.add_floats(values.bytes, values.width);
            return {};
        };
        if (!normals.empty())
            if (auto done = frame("NORMAL", normals); !done) return done;
        if (!tangents.empty() && !normals.empty() && (had_tangents || wants_tangents(m, out)))
            if (auto done = frame("TANGENT", tangents); !done) return done;
        out["attributes"] = std::move(attributes);
        targets(m, used.list, std::move(gathered->targets), elements, out);
        if (out.contains("extensions") && !same_numbers(source, out, elements.of_vertices, indices))
            adapt_extensions(
                document_, out, {elements.of_vertices, indices},
                [&](const std::vector<Index>& list) {
                    return appended_.add_indices(list, used.list.size());
                },
                notes_);
        out["indices"] =
            appended_.add_indices(indices, used.list.size(), std::move(triangles).bytes());
        // Strips and fans have become triangles, the default.
        out.erase("mode");
        remove_extension(out, "KHR_draco_mesh_compression");
        if (keeps_draco_ && !source.draco.empty()) plan_.kept_draco[{m, p}] = std::move(coding);
        if (by_meshopt) meshopt_.compress_from(first_accessor, !out.contains("extensions"));
        return {};
    }

    bool is_subdivided(Index m) const {
        return m < prepared_.subdivided.size() && prepared_.subdivided[m];
    }

    void refined(Index m, std::size_t p, const std::vector<Index>& used,
                 std::span<const Index> indices) {
        Json& out = json_["meshes"][m]["primitives"][p];
        const bool tangents = out["attributes"].contains("TANGENT") || wants_tangents(m, out);
        if ((keeps_draco_ && !document_.primitives[m][p].draco.empty()) ||
            (keeps_meshopt_ && meshopt_.has_part_of(out)))
            note_once(notes_,
                      "refined primitives are written uncompressed: --compress draco or meshopt");
        if (out.contains("extensions") && out["extensions"].contains("EXT_mesh_features")) {
            remove_extension(out, "EXT_mesh_features");
            note_once(notes_, "feature IDs of refined primitives were left out");
        }
        write_refined_primitive(prepared_, m, used, indices, tangents, appended_, json_, out,
                                lost_);
        const std::vector<Index> no_old(used.size(), no_index);
        adapt_extensions(
            document_, out, {no_old, indices},
            [&](const std::vector<Index>& list) {
                return appended_.add_indices(list, used.size());
            },
            notes_);
    }

    // Whether vertices and triangles still have the numbers that the file gave them.
    bool same_numbers(const GltfPrimitive& source, const Json& out, const std::vector<Index>& old,
                      std::span<const Index> indices) const {
        const auto same = [&](const std::vector<Index>& before) {
            return std::equal(before.begin(), before.end(), indices.begin(), indices.end());
        };
        if (old.size() != source.vertex_count || out.value("mode", 4) != 4) return false;
        for (std::size_t i = 0; i < old.size(); ++i)
            if (old[i] != i) return false;
        if (!source.draco.empty()) return same(source.draco_indices);
        if (out.contains("indices")) {
            const auto raw = document_.raw_accessor(out["indices"].get<std::size_t>());
            return raw && same_indices(*raw, indices);
        }
        for (std::size_t i = 0; i < indices.size(); ++i)
            if (indices[i] != i) return false;
        return indices.size() == source.vertex_count;
    }

    std::span<const MorphDeltas> morphs(std::size_t m) const {
        if (m >= prepared_.morphs.size()) return {};
        return prepared_.morphs[m];
    }

    // Morph targets: what was computed for them, else their own data at the new vertices. What
    // moves an attribute that the primitive does not have is left out.
    void targets(std::size_t m, const std::vector<Index>& used, std::vector<AttributeMap> gathered,
                 const Elements& elements, Json& primitive) {
        if (!primitive.contains("targets")) return;
        const Json& attributes = primitive["attributes"];
        const std::span<const MorphDeltas> made = morphs(m);
        for (std::size_t t = 0; t < primitive["targets"].size(); ++t) {
            Json& target = primitive["targets"][t];
            const bool moves = target.contains("POSITION");
            const bool turns = moves || target.contains("NORMAL");
            // One that moves nothing of its own may still share edges with what moves.
            const bool bends = t < made.size() &&
                               std::any_of(made[t].normals.begin(), made[t].normals.end(),
                                           [](const glm::vec3& d) { return d != glm::vec3(0.0f); });
            const bool new_normals =
                t < made.size() && !made[t].normals.empty() && (turns || bends);
            const bool new_tangents = t < made.size() && !made[t].tangents.empty() && turns;
            Json result = Json::object();
            for (const auto& item : target.items()) {
                const bool made_anew = (item.key() == "NORMAL" && new_normals) ||
                                       (item.key() == "TANGENT" && new_tangents);
                if (made_anew || !attributes.contains(item.key())) continue;
                result[item.key()] =
                    emit(item.key(), std::move(gathered[t].at(item.key())), elements);
            }
            if (new_normals && attributes.contains("NORMAL"))
                result["NORMAL"] = appended_.add_floats(values_at(made[t].normals, used));
            if (new_tangents && attributes.contains("TANGENT"))
                result["TANGENT"] = appended_.add_floats(values_at(made[t].tangents, used));
            target = std::move(result);
        }
    }

    // A mesh carries tangents as a whole; primitives whose material reads none need none, unless
    // they were asked for.
    bool wants_tangents(std::size_t m, const Json& primitive) const {
        const bool has_material = primitive.contains("material");
        if (m < prepared_.requirements.size()) {
            const MeshRequirements& r = prepared_.requirements[m];
            const Index own = has_material ? primitive["material"].get<Index>() : no_index;
            if (r.tangents.asked || std::find(r.drawn_in_frame.begin(), r.drawn_in_frame.end(),
                                              own) != r.drawn_in_frame.end())
                return true;
        }
        const std::vector<Material>& materials = prepared_.scene.materials;
        for (const Index other : materials_of_variants(primitive))
            if (other < materials.size() && calls_for_tangents(materials[other])) return true;
        if (!has_material) return false;
        return calls_for_tangents(materials[primitive["material"].get<std::size_t>()]);
    }

    // --- values --------------------------------------------------------------------------

    bool note_repairs(unsigned kinds) {
        for (unsigned k = 0; k < repair_kinds; ++k)
            if (kinds >> k & 1u) note_once(notes_, repair_notes[k]);
        changed_ |= kinds != 0;
        return kinds != 0;
    }

    // All that is carried over, valid: sets changed_ where that took a change.
    Result<GatheredPrimitive> gather_all(const GltfPrimitive& source, const Json& primitive,
                                         const Elements& elements, const DracoCoding& coding,
                                         std::size_t m) {
        GatheredPrimitive result;
        changed_ = false;
        std::vector<RawAccessor*> weights;
        for (const auto& item : primitive["attributes"].items()) {
            const bool left_out = is_left_out(prepared_, m, item.key());
            changed_ |= left_out;
            if (left_out || item.key() == "NORMAL" || item.key() == "TANGENT") continue;
            auto values = gather(source, item.key(), item.value().get<std::size_t>(),
                                 elements.of(item.key()));
            if (!values) return std::move(values).error();
            Gathered& kept = result.attributes[item.key()] = *std::move(values);
            kept.repaired =
                note_repairs(repair_values(item.key(), RepairOf::attribute, kept.values));
            // Their sums are off by what Draco rounded, and would be again.
            const auto form = coding.values.find(item.key());
            const bool rounded =
                form != coding.values.end() && form->second.form != DracoValues::Form::exact;
            if (item.key().starts_with("WEIGHTS_") && !rounded) weights.push_back(&kept.values);
        }
        if (normalise_weights(weights) && note_repairs(repaired_weight_sum))
            for (auto& [semantic, kept] : result.attributes)
                kept.repaired |= semantic.starts_with("WEIGHTS_");
        if (!primitive.contains("targets")) return result;
        for (const Json& target : primitive["targets"]) {
            AttributeMap& kept = result.targets.emplace_back();
            for (const auto& item : target.items()) {
                auto values = gather({}, item.key(), item.value().get<std::size_t>(),
                                     elements.of(item.key()));
                if (!values) return std::move(values).error();
                Gathered& to = kept[item.key()] = *std::move(values);
                to.repaired =
                    note_repairs(repair_values(item.key(), RepairOf::morph_target, to.values));
            }
        }
        return result;
    }

    // The mesh's own layer of a semantic, which repairs may have changed; null: it has none.
    template <class T>
    static const std::vector<T>* layer_of(const std::vector<std::vector<T>>& sets,
                                          const std::string& semantic, const char* head) {
        const auto set = set_number(semantic, head);
        return set && *set < sets.size() && !sets[*set].empty() ? &sets[*set] : nullptr;
    }

    // The mesh's own values of a layer, valid, where corners that a repair put into faces have some
    // that no element of the file has: `raw` is what the file has for them.
    std::optional<RawAccessor> reshaped(const std::string& semantic, const RawAccessor& raw,
                                        std::size_t m, const std::vector<Index>& used) const {
        const VertexMesh& mesh = prepared_.meshes[m];
        const auto* uvs = layer_of(mesh.uvs, semantic, "TEXCOORD_");
        const auto* colors = layer_of(mesh.colors, semantic, "COLOR_");
        if (!uvs && !colors) return std::nullopt;
        RawAccessor now;
        now.width = raw.width;
        now.count = used.size();
        const std::size_t size = now.element_size();
        std::vector<std::byte> bytes(used.size() * size);
        for (std::size_t i = 0; i < used.size(); ++i)
            std::memcpy(bytes.data() + i * size, uvs ? &(*uvs)[used[i]].x : &(*colors)[used[i]].x,
                        size);
        now.bytes = std::move(bytes);
        repair_values(semantic, RepairOf::attribute, now);
        if (to_floats(now) == to_floats(raw)) return std::nullopt;
        return now;
    }

    VertexVectors<glm::vec3> repaired_normals(const std::vector<glm::vec3>& values,
                                              const UsedVertices& used) {
        if (VertexVectors<glm::vec3> same = own_vectors(values, used); !same.empty()) return same;
        std::vector<glm::vec3> result = values_at(values, used.list);
        for (glm::vec3& n : result)
            if (!is_finite(n)) {
                n = glm::vec3(0, 0, 1);
                note_once(notes_, "normals that are not finite were written as (0, 0, 1)");
                changed_ = true;
            }
        return VertexVectors<glm::vec3>(std::move(result));
    }

    // Where nothing calls for tangents, the file's own may be anything.
    VertexVectors<glm::vec4> repaired_tangents(const std::vector<glm::vec4>& values,
                                               const VertexVectors<glm::vec3>& normals,
                                               const UsedVertices& used) {
        if (VertexVectors<glm::vec4> same = own_vectors(values, used); !same.empty()) return same;
        std::vector<glm::vec4> result = values_at(values, used.list);
        for (std::size_t i = 0; i < result.size(); ++i) {
            glm::vec4& t = result[i];
            if (is_finite(t)) continue;
            changed_ = true;
            if (is_finite(glm::vec3(t))) {
                t.w = 1;
                note_once(notes_, "signs of tangents that are not finite were written as 1");
                continue;
            }
            glm::vec3 n = normals.empty() ? glm::vec3(0, 0, 1) : normals.values()[i];
            if (n == glm::vec3(0.0f)) n = glm::vec3(0, 0, 1);
            const glm::vec3 axis = std::abs(n.x) < 0.5f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
            t = glm::vec4(glm::normalize(glm::cross(n, axis)), 1.0f);
            note_once(notes_, "tangents that are not finite were replaced by any in the surface");
        }
        return VertexVectors<glm::vec4>(std::move(result));
    }

    // --- helpers of primitive() ----------------------------------------------------------

    // Same vertices in the same order, the same triangles, the same normals and tangents: the
    // primitive's accessors stay.
    bool untouched(std::size_t m, const Json& out, const GltfPrimitive& source,
                   const std::vector<Index>& local, std::span<const Index> indices,
                   const VertexVectors<glm::vec3>& normals,
                   const VertexVectors<glm::vec4>& tangents) const {
        if (!source.draco.empty() && !keeps_draco_) return false;
        if (!morphs(m).empty() && out.contains("targets")) return false;
        const Json& attributes = out["attributes"];
        if (attributes.contains("NORMAL") != !normals.empty() ||
            (!tangents.empty() && wants_tangents(m, out) && !attributes.contains("TANGENT")) ||
            (tangents.empty() && attributes.contains("TANGENT")))
            return false;
        return same_values(source, attributes, "NORMAL", normals) &&
               same_values(source, attributes, "TANGENT", tangents) &&
               same_numbers(source, out, local, indices);
    }

    template <class T>
    bool same_values(const GltfPrimitive& source, const Json& attributes, const char* semantic,
                     const VertexVectors<T>& values) const {
        if (values.empty() || !attributes.contains(semantic)) return true;
        const auto draco = source.draco.find(semantic);
        if (draco != source.draco.end()) return same_directions(draco->second, values, true);
        const auto accessor = attributes[semantic].get<std::size_t>();
        if (document_.json["accessors"][accessor]["count"] != values.values().size()) return false;
        const auto raw = document_.raw_accessor(accessor);
        return raw && same_directions(*raw, values, raw->component_type != 5126);
    }

    template <class T>
    static bool same_directions(const RawAccessor& raw, const VertexVectors<T>& values,
                                bool rounded) {
        const std::size_t width = sizeof(T) / sizeof(float);
        if (raw.width != int(width) || raw.count != values.values().size()) return false;
        const auto same = [&](const void* before) {
            return std::memcmp(values.bytes.data(), before, values.bytes.size()) == 0;
        };
        if (!rounded && raw.component_type == 5126) return same(raw.bytes.data());
        std::vector<float> before = to_floats(raw);
        if (rounded) {
            // Whole numbers have no unit vectors but along the axes: what they say is a direction.
            for (std::size_t i = 0; i + width <= before.size(); i += width) {
                const glm::vec3 n = unit_normal({before[i], before[i + 1], before[i + 2]});
                std::memcpy(&before[i], &n, sizeof n);
            }
        }
        return same(before.data());
    }

    // The file's own normals or tangents, where they are rounded to whole numbers, in the file
    // or by Draco, and their directions were kept.
    template <class T>
    Result<std::optional<Gathered>> kept_directions(const GltfPrimitive& source,
                                                    const Json& attributes, const char* semantic,
                                                    const Elements& elements,
                                                    const VertexVectors<T>& values) const {
        const auto accessor = attributes[semantic].get<std::size_t>();
        if (!(keeps_draco_ && source.draco.contains(semantic)) &&
            document_.json["accessors"][accessor]["componentType"] == 5126)
            return std::optional<Gathered>();
        auto gathered = gather(source, semantic, accessor, elements.of(semantic));
        if (!gathered) return std::move(gathered).error();
        if (!are_unit(gathered->values) || !same_directions(gathered->values, values, true))
            return std::optional<Gathered>();
        return std::optional<Gathered>(*std::move(gathered));
    }

    // An accessor's elements for the given source vertices, in the accessor's own type.
    Result<Gathered> gather(const GltfPrimitive& source, const std::string& semantic,
                            std::size_t accessor, const std::vector<Index>& local) const {
        Gathered result;
        result.accessor = accessor;
        if (const auto draco = source.draco.find(semantic); draco != source.draco.end()) {
            result.values = selected(draco->second, local);
            return result;
        }
        auto read = document_.raw_elements(accessor, local);
        if (!read) return std::move(read).error();
        result.values = *std::move(read);
        const Json& in = document_.json["accessors"][accessor];
        result.implied = !in.contains("bufferView") && !in.contains("sparse");
        return result;
    }

    // Writes them; returns the new accessor.
    std::size_t emit(const std::string& semantic, Gathered gathered, const Elements& elements) {
        RawAccessor& raw = gathered.values;
        Json out = document_.json["accessors"][gathered.accessor];
        const bool bounded = out.contains("min") || semantic == "POSITION";
        for (const char* key : {"bufferView", "byteOffset", "sparse", "min", "max"}) out.erase(key);
        out["count"] = raw.count;
        if (bounded) set_bounds(raw, out);
        if (!gathered.implied) {
            StoredElements stored = stored_elements(raw, out["type"].get<std::string>());
            out["bufferView"] = appended_.add_view(std::move(stored.bytes), 34962,
                                                   stored.apart ? stored.stride : 0);
            if (keeps_meshopt_ && !gathered.repaired)
                meshopt_.keep_filter(gathered.accessor, elements.of(semantic), stored.stride,
                                     out["bufferView"].get<std::size_t>());
        }
        return appended_.add_accessor(std::move(out));
    }

    std::size_t emit_reshaped(const std::string& semantic, Gathered gathered,
                              const Elements& elements, std::size_t m,
                              const std::vector<Index>& used) {
        std::optional<RawAccessor> now;
        if (!elements.of_corners.empty()) now = reshaped(semantic, gathered.values, m, used);
        if (!now) return emit(semantic, std::move(gathered), elements);
        return appended_.add_accessor(
            Json{{"bufferView", appended_.add_view(std::move(now->bytes), 34962, 0)},
                 {"componentType", 5126},
                 {"count", now->count},
                 {"type", type_of_width(now->width)}});
    }

    static void remove_extension(Json& object, const char* name) {
        const auto it = object.find("extensions");
        if (it == object.end() || !it->is_object()) return;
        it->erase(name);
        if (it->empty()) object.erase("extensions");
    }

    void remove_meshopt() {
        for (Json& view : json_["bufferViews"]) remove_extension(view, "EXT_meshopt_compression");
    }

    const PreparedScene& prepared_;
    const GltfDocument& document_;
    const bool keeps_draco_, keeps_meshopt_;
    CompressionPlan plan_;
    std::vector<std::string>& notes_;
    RefinedLosses lost_;
    std::uint64_t dropped_triangles_ = 0;
    Json json_;
    bool positions_finite_ = true;  // of the mesh at hand
    bool changed_ = false;          // the primitive at hand: values were made valid, or left out
    AppendedData appended_{json_};
    KeptMeshopt meshopt_{document_, json_, appended_};
};

}  // namespace

Result<RewrittenGltf> rewrite_gltf(const PreparedScene& prepared, Compression compression,
                                   std::vector<std::string>& notes) {
    try {
        return Rewriter(prepared, compression, notes).run();
    } catch (const Json::exception& e) {
        // Where the reader let something through that it carries without knowing it.
        return Error{ErrorCode::invalid,
                     std::string("the glTF document contradicts itself: ") + e.what(),
                     {}};
    }
}

}  // namespace prep::detail
