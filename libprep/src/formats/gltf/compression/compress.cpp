#include "formats/gltf/compression/compress.h"

#include <algorithm>
#include <cstring>
#include <set>

namespace prep::detail {
namespace {

constexpr const char* draco_name = "KHR_draco_mesh_compression";
constexpr const char* meshopt_name = "EXT_meshopt_compression";

std::size_t size_of(const Json& json, const char* list) {
    const auto it = json.find(list);
    return it == json.end() ? 0 : it->size();
}

// Whether an extension says something by the order of a primitive's vertices or triangles, or may.
bool order_says_something(const Json& primitive) {
    const auto extensions = primitive.find("extensions");
    if (extensions == primitive.end()) return false;
    return std::any_of(extensions->items().begin(), extensions->items().end(),
                       [](const auto& item) { return item.key() != "KHR_materials_variants"; });
}

class Compressor {
  public:
    Compressor(Json& json, PackedBuffer packed, const CompressionPlan& plan,
               std::vector<std::string>& notes)
        : json_(json), plan_(plan), notes_(notes) {
        document_.buffers.push_back(SharedBytes(packed.bytes.joined()));
        document_.buffers.push_back(Error{ErrorCode::io, "a buffer without bytes", {}});
    }

    Result<PackedBuffer> run() {
        // Made first: a new key moves its siblings, and references to them are held below.
        for (const char* list : {"accessors", "bufferViews"})
            if (!json_.contains(list)) json_[list] = Json::array();
        document_.json = json_;
        for (std::size_t m = 0; m < size_of(json_, "meshes"); ++m)
            for (std::size_t p = 0; p < json_["meshes"][m]["primitives"].size(); ++p) {
                const auto kept = plan_.kept_draco.find({m, p});
                const DracoCoding exact;
                if (plan_.draco || kept != plan_.kept_draco.end())
                    if (auto done = draco(json_["meshes"][m]["primitives"][p],
                                          kept == plan_.kept_draco.end() ? exact : kept->second);
                        !done)
                        return std::move(done).error();
            }
        tell_left(left_, "primitive", "Draco");
        if (plan_.optimized && reordered_ > 0) tell_reordered();
        if (plan_.meshopt)
            if (auto done = meshopt(); !done) return std::move(done).error();
        declare_compression(json_);
        auto packed = pack_buffer(document_, json_, appended_, notes_);
        if (packed) remove_empty_lists(json_);
        return packed;
    }

  private:
    void tell_left(std::size_t count, const std::string& what, const std::string& codec) {
        if (count > 0)
            notes_.push_back(std::to_string(count) + " " + what + (count == 1 ? "" : "s") +
                             " that " + codec + " cannot hold left uncompressed");
    }

    void tell_reordered() {
        notes_.push_back(std::to_string(reordered_) +
                         (reordered_ == 1 ? " primitive is" : " primitives are") +
                         " in Draco's order, not in the optimized one: --compress meshopt or none "
                         "keeps that");
    }

    Result<void> draco(Json& primitive, const DracoCoding& how) {
        if (primitive.value("mode", 4) != 4 || !primitive["attributes"].contains("POSITION"))
            return {};
        if (extension_of(primitive, draco_name)) return {};
        DracoSource source;
        for (const auto& item : primitive["attributes"].items()) {
            auto raw = document_.raw_accessor(item.value().get<std::size_t>());
            if (!raw) return std::move(raw).error();
            if (raw->width > 4) {  // a matrix: Draco converts no wider values
                ++left_;
                return {};
            }
            source.attributes.emplace_back(item.key(), *std::move(raw));
        }
        // What predicts the others comes first.
        std::stable_partition(source.attributes.begin(), source.attributes.end(),
                              [](const auto& a) { return a.first == "POSITION"; });
        const std::size_t vertices = source.attributes.front().second.count;
        if (primitive.contains("indices")) {
            const auto raw = document_.raw_accessor(primitive["indices"].get<std::size_t>());
            if (!raw) return raw.error();
            source.indices = to_indices(*raw);
        } else {
            for (std::size_t i = 0; i < vertices; ++i) source.indices.push_back(std::uint32_t(i));
        }
        source.indices.resize(source.indices.size() / 3 * 3);
        DracoCoding coding = how;
        coding.keeps_order |= primitive.contains("targets") || order_says_something(primitive);
        const auto made = encode_draco(source, coding);
        if (!made || (coding.keeps_order && made->vertices != vertices)) {
            ++left_;
            return {};
        }
        reordered_ += !made->keeps_order;
        store(*made, primitive);
        return targets_apart(primitive);
    }

    // A view that morph targets share with what is compressed now would stay whole for their sake.
    Result<void> targets_apart(Json& primitive) {
        if (!primitive.contains("targets")) return {};
        for (Json& target : primitive["targets"])
            for (Json& index : target) {
                const auto accessor = index.get<std::size_t>();
                if (const auto known = apart_.find(accessor); known != apart_.end()) {
                    index = known->second;
                    continue;
                }
                Json out = json_["accessors"][accessor];
                if (!out.contains("bufferView") || out.contains("sparse")) continue;
                const auto raw = document_.raw_accessor(accessor);
                if (!raw) return raw.error();
                const std::size_t size = raw->element_size(), stride = (size + 3) / 4 * 4;
                std::vector<std::byte> bytes(raw->count * stride);
                for (std::size_t i = 0; i < raw->count; ++i)
                    std::memcpy(bytes.data() + i * stride, raw->bytes.data() + i * size, size);
                out.erase("byteOffset");
                out["bufferView"] =
                    appended_.add_view(std::move(bytes), 34962, stride == size ? 0 : stride);
                index = apart_[accessor] = appended_.add_accessor(std::move(out));
            }
        return {};
    }

    void store(const DracoData& made, Json& primitive) {
        Json extension{{"bufferView", view_of(made.bytes)}};
        for (auto& item : primitive["attributes"].items()) {
            Json accessor = json_["accessors"][item.value().get<std::size_t>()];
            for (const char* key : {"bufferView", "byteOffset", "sparse", "min", "max"})
                accessor.erase(key);
            accessor["count"] = made.vertices;
            if (item.key() == "POSITION") {
                accessor["min"] = bounds(made.least, accessor);
                accessor["max"] = bounds(made.most, accessor);
            }
            item.value() = appended_.add_accessor(std::move(accessor));
            extension["attributes"][item.key()] = made.ids.at(item.key());
        }
        primitive["indices"] =
            appended_.add_accessor({{"componentType", made.vertices <= 65535 ? 5123 : 5125},
                                    {"count", made.triangles * 3},
                                    {"type", "SCALAR"}});
        primitive["extensions"][draco_name] = std::move(extension);
    }

    static Json bounds(const std::vector<float>& values, const Json& accessor) {
        Json out = Json::array();
        for (const float v : values)
            if (accessor["componentType"] == 5126)
                out.push_back(v);
            else
                out.push_back(std::int64_t(v));
        return out;
    }

    // Primitives with the same data share them.
    std::size_t view_of(const std::vector<std::byte>& bytes) {
        const auto [it, is_new] = views_.emplace(bytes, 0);
        if (is_new) it->second = appended_.add_view(bytes, 0, 0);
        return it->second;
    }

    // --- meshopt -----------------------------------------------------------------------------

    // What the accessors of a view are.
    struct ViewUse {
        std::set<std::size_t> sizes;  // of elements
        bool indices = false, others = false;
        bool whole_triangles = true;  // every list of indices: triangles that may be turned
        bool picture = false;
    };

    std::vector<ViewUse> uses() const {
        enum Role { attribute, index, triangle_index };
        std::vector<Role> roles(size_of(json_, "accessors"), attribute);
        if (json_.contains("meshes"))
            for (const Json& mesh : json_["meshes"])
                for (const Json& primitive : mesh["primitives"]) {
                    if (!primitive.contains("indices")) continue;
                    Role& role = roles[primitive["indices"].get<std::size_t>()];
                    const bool may_turn = primitive.value("mode", 4) == 4 &&
                                          !order_says_something(primitive) && role != index;
                    role = may_turn ? triangle_index : index;
                }
        std::vector<ViewUse> out(size_of(json_, "bufferViews"));
        for (std::size_t a = 0; a < roles.size(); ++a) {
            const Json& accessor = json_["accessors"][a];
            const std::size_t size =
                stored_size(accessor.value("type", ""), accessor.value("componentType", 5126));
            if (accessor.contains("bufferView")) {
                ViewUse& use = out[accessor["bufferView"].get<std::size_t>()];
                use.sizes.insert(size);
                (roles[a] == attribute ? use.others : use.indices) = true;
                use.whole_triangles &=
                    roles[a] == triangle_index &&
                    accessor.value("count", std::size_t(0)) % 3 == 0 &&
                    accessor.value("byteOffset", std::size_t(0)) % (3 * size) == 0;
            }
            if (const auto sparse = accessor.find("sparse"); sparse != accessor.end())
                for (const char* part : {"indices", "values"}) {
                    ViewUse& use = out[(*sparse)[part]["bufferView"].get<std::size_t>()];
                    use.sizes.insert(4);
                    use.others = true;
                }
        }
        if (json_.contains("images"))
            for (const Json& image : json_["images"])
                if (const std::size_t v = image.value("bufferView", out.size()); v < out.size())
                    out[v].picture = true;
        return out;
    }

    Result<void> meshopt() {
        const std::vector<ViewUse> all = uses();
        std::size_t left = 0;
        for (std::size_t v = 0; v < document_.json["bufferViews"].size(); ++v) {
            const ViewUse& use = all[v];
            if (use.picture || use.sizes.empty()) continue;
            if (extension_of(json_["bufferViews"][v], meshopt_name)) continue;
            const auto bytes = document_.view(v);
            if (!bytes) return bytes.error();
            // The extension's stride is the view's where that states one.
            const std::size_t size = *use.sizes.begin();
            const auto stated = json_["bufferViews"][v].find("byteStride");
            const bool has_stride = stated != json_["bufferViews"][v].end();
            MeshoptMode mode = MeshoptMode::attributes;
            std::size_t stride = has_stride              ? stated->get<std::size_t>()
                                 : use.sizes.size() == 1 ? size
                                                         : 4;
            if (use.indices && !use.others && use.sizes.size() == 1 && size <= 4) {
                const bool triangles = use.whole_triangles && bytes->size() % (3 * size) == 0;
                mode = triangles ? MeshoptMode::triangles : MeshoptMode::indices;
                stride = size;
            } else if (!has_stride && !meshopt_holds(mode, stride, bytes->size())) {
                stride = 4;
            }
            if (!meshopt_holds(mode, stride, bytes->size())) {
                ++left;
                continue;
            }
            compress_view(json_, appended_, v, mode, stride, *bytes);
        }
        tell_left(left, "bufferView", "meshopt");
        return {};
    }

    Json& json_;
    GltfDocument document_;
    const CompressionPlan& plan_;
    std::vector<std::string>& notes_;
    std::size_t left_ = 0, reordered_ = 0;  // primitives
    std::map<std::vector<std::byte>, std::size_t> views_;
    std::map<std::size_t, std::size_t> apart_;  // accessors of targets, by those of the file
    AppendedData appended_{json_};
};

}  // namespace

Result<PackedBuffer> compress_gltf(Json& json, PackedBuffer packed, const CompressionPlan& plan,
                                   std::vector<std::string>& notes) {
    try {
        return Compressor(json, std::move(packed), plan, notes).run();
    } catch (const Json::exception& e) {  // members of a type that no reader here asks for
        return Error{ErrorCode::invalid, std::string("the glTF document: ") + e.what(), {}};
    }
}

bool compress_view(Json& json, AppendedData& appended, std::size_t view, MeshoptMode mode,
                   std::size_t stride, std::span<const std::byte> bytes,
                   const std::string& filter) {
    auto made = encode_meshopt(mode, stride, bytes);
    if (!made) return false;
    Json extension{
        {"byteStride", stride}, {"mode", name_of(mode)}, {"count", bytes.size() / stride}};
    if (filter != "NONE") extension["filter"] = filter;
    json["bufferViews"][view]["extensions"][meshopt_name] = std::move(extension);
    appended.replace_view(view, *std::move(made));
    return true;
}

void declare_compression(Json& json) {
    const auto any = [&](const char* list, const auto& uses_it) {
        const auto it = json.find(list);
        return it != json.end() && std::any_of(it->begin(), it->end(), uses_it);
    };
    const bool draco = any("meshes", [](const Json& mesh) {
        return std::any_of(mesh["primitives"].begin(), mesh["primitives"].end(),
                           [](const Json& p) { return extension_of(p, draco_name) != nullptr; });
    });
    const bool meshopt = any("bufferViews", [](const Json& view) {
        return extension_of(view, meshopt_name) != nullptr;
    });
    for (const auto& [name, used] : {std::pair(draco_name, draco), {meshopt_name, meshopt}})
        for (const char* list : {"extensionsUsed", "extensionsRequired"}) {
            const auto it = json.find(list);
            if (it != json.end() && !it->is_array()) {
                if (!used) continue;
                *it = Json::array();
            }
            if (it != json.end()) {
                const bool listed = std::find(it->begin(), it->end(), Json(name)) != it->end();
                if (listed == used) continue;
                if (!used) {
                    it->erase(std::remove(it->begin(), it->end(), Json(name)), it->end());
                    if (it->empty()) json.erase(list);
                    continue;
                }
            }
            if (used) json[list].push_back(name);
        }
}

Json buffers_of(std::size_t bytes, std::uint64_t fallback_bytes) {
    Json out = Json::array();
    if (bytes > 0) out.push_back({{"byteLength", bytes}});
    if (fallback_bytes > 0)
        out.push_back({{"byteLength", fallback_bytes},
                       {"extensions", {{meshopt_name, {{"fallback", true}}}}}});
    return out;
}

}  // namespace prep::detail
