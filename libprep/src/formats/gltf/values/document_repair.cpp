#include "formats/gltf/values/document_repair.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <set>

#include "formats/gltf/references.h"
#include "formats/gltf/values/bounds.h"

namespace prep::detail {
namespace {

constexpr const char* quantization = "KHR_mesh_quantization";
constexpr std::size_t alignment = 4;    // of vertex data
constexpr std::size_t most_copies = 4;  // of the input, in views of their own

std::uint64_t number_of(const Json& object, const char* key, std::uint64_t otherwise) {
    const Json* value = member(object, key);
    return value && value->is_number_unsigned() ? value->get<std::uint64_t>() : otherwise;
}

// What the format has without KHR_mesh_quantization.
bool is_plain_type(const std::string& semantic, const Json& accessor, bool of_target) {
    const std::uint64_t type = number_of(accessor, "componentType", 5126);
    if (semantic == "POSITION" || semantic == "NORMAL" || semantic == "TANGENT")
        return type == 5126;
    if (!semantic.starts_with("TEXCOORD_")) return true;
    const Json* normalized = member(accessor, "normalized");
    const bool whole = normalized && normalized->is_boolean() && normalized->get<bool>();
    return type == 5126 || of_target || (whole && (type == 5121 || type == 5123));
}

class DocumentRepair {
  public:
    DocumentRepair(const GltfDocument& document, Json& json, AppendedData& appended,
                   std::vector<std::string>& notes)
        : document_(document), json_(json), appended_(appended), notes_(notes) {
        if (const Json* accessors = member(document.json, "accessors"))
            own_accessors_ = accessors->size();
    }

    void run() {
        find_uses();
        give_strides();
        for (const auto& [index, use] : uses_) {
            if (use.in_draco) continue;
            const Json& accessor = json_["accessors"][index];
            if (use.is_vertex_data() && (!is_aligned(accessor) || shares_unsaid_stride(accessor)))
                lay_apart(index);
            repair_bounds(index, use);
        }
        if (bounds_repaired_)
            notes_.push_back("bounds of accessors that were missing or wrong were computed");
        if (laid_out_)
            notes_.push_back(
                "vertex data that was not aligned, or shared a view without a stride, got a stride "
                "or views of its own");
        if (left_)
            notes_.push_back(
                "vertex data that is not aligned, or shares a view without a stride, was kept so: "
                "matrices, or more than four times the file's bytes");
        declare();
    }

  private:
    struct Use {
        unsigned all = 0, as_vertex_data = 0;
        bool needs_bounds = false, in_draco = false;
        bool is_vertex_data() const { return as_vertex_data > 0 && as_vertex_data == all; }
    };

    void find_uses() {
        visit_accessors(json_, [&](Json& index) {
            if (Use* use = use_of(index)) ++use->all;
        });
        each(json_, "meshes", [&](const Json& mesh) {
            each(mesh, "primitives", [&](const Json& primitive) {
                const Json* draco = extension_of(primitive, "KHR_draco_mesh_compression");
                const Json* packed = draco ? member(*draco, "attributes") : nullptr;
                if (const Json* attributes = member(primitive, "attributes"))
                    vertex_data(*attributes, packed, false);
                if (const Json* indices = member(primitive, "indices"); indices && draco)
                    if (Use* use = use_of(*indices)) use->in_draco = true;
                each(primitive, "targets",
                     [&](const Json& target) { vertex_data(target, nullptr, true); });
            });
        });
        each(json_, "animations", [&](const Json& animation) {
            each(animation, "samplers", [&](const Json& sampler) {
                if (const Json* input = member(sampler, "input"))
                    if (Use* use = use_of(*input)) use->needs_bounds = true;
            });
        });
    }

    void vertex_data(const Json& attributes, const Json* packed, bool of_target) {
        if (!attributes.is_object()) return;
        for (const auto& item : attributes.items()) {
            const std::string& semantic = item.key();
            if (Use* use = use_of(item.value())) {
                ++use->as_vertex_data;
                use->needs_bounds |= semantic == "POSITION";
                use->in_draco |= packed && packed->contains(semantic);
            }
            if (const Json* accessor = accessor_at(item.value()))
                quantized_ |= !is_plain_type(semantic, *accessor, of_target);
        }
    }

    const Json* accessor_at(const Json& index) const {
        const Json& list = json_["accessors"];
        return index.is_number_unsigned() && index.get<std::uint64_t>() < list.size()
                   ? &list[index.get<std::size_t>()]
                   : nullptr;
    }
    // Null for those that were made while writing, which are valid.
    Use* use_of(const Json& index) {
        const bool own = index.is_number_unsigned() && index.get<std::uint64_t>() < own_accessors_;
        return own ? &uses_[index.get<std::size_t>()] : nullptr;
    }

    const Json& view_of(const Json& accessor) const {
        return json_["bufferViews"][accessor["bufferView"].get<std::size_t>()];
    }
    bool has_plain_view(const Json& accessor) const {
        return accessor.contains("bufferView") &&
               !extension_of(view_of(accessor), "EXT_meshopt_compression");
    }

    // Views begin at multiples of 4 where they are written.
    bool is_aligned(const Json& accessor) const {
        if (!has_plain_view(accessor)) return true;
        return number_of(accessor, "byteOffset", 0) % alignment == 0 &&
               number_of(view_of(accessor), "byteStride", tight_size(accessor)) % alignment == 0;
    }

    // Views without a stride that several vertex accessors share: where nothing else refers to
    // them, and all have elements of one size, that is their stride.
    void give_strides() {
        std::map<std::uint64_t, unsigned> references;
        visit_views(json_, [&](Json& view) { ++references[view.get<std::uint64_t>()]; });
        struct View {
            unsigned accessors = 0;
            std::size_t size = 0;
            bool alike = true;
        };
        std::map<std::uint64_t, View> views;
        for (const auto& [index, use] : uses_) {
            const Json& accessor = json_["accessors"][index];
            if (!use.is_vertex_data() || !has_plain_view(accessor) ||
                view_of(accessor).contains("byteStride"))
                continue;
            View& view = views[accessor["bufferView"].get<std::uint64_t>()];
            const std::size_t size = tight_size(accessor);
            view.alike &= ++view.accessors == 1 || view.size == size;
            view.size = size;
        }
        constexpr std::size_t largest_stride = 252;
        for (const auto& [index, view] : views) {
            if (view.accessors < 2) continue;
            if (view.alike && view.accessors == references[index] && view.size % alignment == 0 &&
                view.size <= largest_stride) {
                json_["bufferViews"][index]["byteStride"] = view.size;
                laid_out_ = true;
            } else {
                unsaid_.insert(index);
            }
        }
    }
    bool shares_unsaid_stride(const Json& accessor) const {
        return has_plain_view(accessor) &&
               unsaid_.contains(accessor["bufferView"].get<std::uint64_t>());
    }

    static std::size_t tight_size(const Json& accessor) {
        return stored_size(accessor["type"].get<std::string>(),
                           accessor["componentType"].get<int>());
    }

    // Not matrices, whose columns have room between them; nor more than a few times the input, as
    // accessors may name the same bytes again and again.
    void lay_apart(std::size_t index) {
        const Json& source = json_["accessors"][index];
        const std::size_t size = tight_size(source);
        const std::size_t stride = (size + alignment - 1) / alignment * alignment;
        copied_ += source["count"].get<std::uint64_t>() * stride;
        if (source["type"].get<std::string>().starts_with("MAT") ||
            copied_ > most_copies * document_.input_bytes) {
            left_ = true;
            return;
        }
        const Result<RawAccessor> raw = document_.raw_accessor(index);
        if (!raw) return;
        std::vector<std::byte> bytes(raw->count * stride);
        for (std::size_t i = 0; i < raw->count; ++i)
            std::memcpy(bytes.data() + i * stride, raw->bytes.data() + i * size, size);
        const std::size_t view = appended_.add_view(SharedBytes::of(std::move(bytes)), 34962,
                                                    stride == size ? 0 : stride);
        Json& accessor = json_["accessors"][index];
        accessor["bufferView"] = view;
        accessor.erase("byteOffset");
        accessor.erase("sparse");
        laid_out_ = true;
    }

    void repair_bounds(std::size_t index, const Use& use) {
        Json& accessor = json_["accessors"][index];
        const bool said = accessor.contains("min") || accessor.contains("max");
        if (!said && !use.needs_bounds) return;
        if (!accessor.contains("bufferView") && !accessor.contains("sparse")) return;
        // 32-bit integers do not go through floats, which set_bounds() takes.
        if (accessor["componentType"] == 5125) return;
        const Result<RawAccessor> raw = document_.raw_accessor(index);
        if (!raw) return;
        Json computed = Json::object();
        set_bounds(*raw, computed);
        for (const char* key : {"min", "max"}) {
            if (!computed.contains(key)) return;
            for (const Json& value : computed[key])
                if (!std::isfinite(value.get<double>())) return;  // noted elsewhere
        }
        for (const char* key : {"min", "max"}) {
            if (!use.needs_bounds && !accessor.contains(key)) continue;
            if (is_same(accessor, computed, key)) continue;
            accessor[key] = computed[key];
            bounds_repaired_ = true;
        }
    }

    static bool is_same(const Json& accessor, const Json& computed, const char* key) {
        const Json* said = member(accessor, key);
        const Json& values = computed[key];
        if (!said || !said->is_array() || said->size() != values.size()) return false;
        for (std::size_t k = 0; k < values.size(); ++k)
            if (!(*said)[k].is_number() ||
                float((*said)[k].get<double>()) != float(values[k].get<double>()))
                return false;
        return true;
    }

    static void find_extensions(const Json& value, std::set<std::string>& names) {
        if (value.is_array())
            for (const Json& item : value) find_extensions(item, names);
        if (!value.is_object()) return;
        for (const auto& item : value.items()) {
            if (item.key() == "extras") continue;
            find_extensions(item.value(), names);
            if (item.key() == "extensions" && item.value().is_object())
                for (const auto& extension : item.value().items()) names.insert(extension.key());
        }
    }

    void declare() {
        std::set<std::string> names;
        find_extensions(json_, names);
        // Those are declare_compression()'s: views that nothing refers to any more may have them.
        names.erase("EXT_meshopt_compression");
        names.erase("KHR_draco_mesh_compression");
        if (quantized_) names.insert(quantization);
        bool any = false;
        for (const std::string& name : names) {
            any |= add(name, "extensionsUsed");
            if (name == quantization && quantized_) any |= add(name, "extensionsRequired");
        }
        if (any) notes_.push_back("extensions that are used and were not declared are declared");
    }

    bool add(const std::string& name, const char* key) {
        Json& list = json_[key];
        if (!list.is_array()) list = Json::array();
        if (std::find(list.begin(), list.end(), Json(name)) != list.end()) return false;
        list.push_back(name);
        return true;
    }

    const GltfDocument& document_;
    Json& json_;
    AppendedData& appended_;
    std::vector<std::string>& notes_;
    std::size_t own_accessors_ = 0;
    std::map<std::size_t, Use> uses_;
    std::set<std::uint64_t> unsaid_;  // shared views that no stride fits
    std::uint64_t copied_ = 0;        // bytes
    bool bounds_repaired_ = false, laid_out_ = false, left_ = false, quantized_ = false;
};

}  // namespace

void repair_document(const GltfDocument& document, Json& json, AppendedData& appended,
                     std::vector<std::string>& notes) {
    DocumentRepair(document, json, appended, notes).run();
}

}  // namespace prep::detail
