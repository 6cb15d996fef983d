#include "formats/gltf/structure.h"

namespace prep::detail {
namespace {

constexpr std::uint64_t max_offset = std::uint64_t(1) << 40;
// Zeros that accessors without a bufferView stand for: what one may occupy, and what decoding all
// of them may have to clear.
constexpr std::uint64_t max_zero_bytes = std::uint64_t(256) << 20;
constexpr std::uint64_t max_zero_bytes_in_all = std::uint64_t(4) << 30;
// The vertex codec spends at least two bits on sixteen bytes; the others spend more.
constexpr std::uint64_t max_compression = 64;
constexpr const char* meshopt = "EXT_meshopt_compression";

struct View {
    std::uint64_t length = 0, stride = 0;  // as an accessor sees it
};

class Checker {
  public:
    explicit Checker(const GltfDocument& document) : d_(document) {}

    Result<void> run() {
        const Json* views = *top_array(d_, "bufferViews");
        for (std::size_t v = 0; v < views->size(); ++v)
            if (auto done = view((*views)[v], "/bufferViews/" + std::to_string(v)); !done)
                return done;
        const Json* accessors = *top_array(d_, "accessors");
        for (std::size_t a = 0; a < accessors->size(); ++a)
            if (auto done = accessor((*accessors)[a], a, "/accessors/" + std::to_string(a)); !done)
                return done;
        return {};
    }

  private:
    Result<void> view(const Json& in, const std::string& pointer) {
        const auto buffer = index_member(d_, in, "buffer", pointer, d_.buffers.size());
        if (!buffer) return buffer.error();
        if (*buffer == no_index) return d_.bad(pointer + "/buffer", "the member is missing");
        const auto offset = whole_member(d_, in, "byteOffset", pointer, 0, max_offset, 0);
        const auto length = whole_member(d_, in, "byteLength", pointer, 1, max_offset, {});
        const auto stride = whole_member(d_, in, "byteStride", pointer, 4, 252, 0);
        for (const auto* r : {&offset, &length, &stride})
            if (!*r) return r->error();
        const auto available = d_.json["buffers"][*buffer]["byteLength"].get<std::uint64_t>();
        if (*offset > available || *length > available - *offset)
            return d_.bad(pointer + (*offset > available ? "/byteOffset" : "/byteLength"),
                          "the view ends at byte " + std::to_string(*offset + *length) +
                              ", its buffer has " + std::to_string(available));
        if (*stride % 4 != 0)
            return d_.bad(pointer + "/byteStride",
                          "expected a multiple of 4, found " + std::to_string(*stride));
        views_.push_back({*length, *stride});
        const auto extensions = in.find("extensions");
        if (extensions == in.end()) return {};
        if (!extensions->is_object()) return d_.bad(pointer + "/extensions", "expected an object");
        const auto compressed = extensions->find(meshopt);
        if (compressed == extensions->end()) return {};
        return compressed_view(*compressed, *length, pointer + "/extensions/" + meshopt);
    }

    // What it decompresses to is allocated before the codec has seen a byte.
    Result<void> compressed_view(const Json& in, std::uint64_t length, const std::string& pointer) {
        if (!in.is_object()) return d_.bad(pointer, "expected an object");
        const auto count = whole_member(d_, in, "count", pointer, 1, max_elements, {});
        if (!count) return count.error();
        const auto stride = whole_member(d_, in, "byteStride", pointer, 1, 256, {});
        if (!stride) return stride.error();
        if (*count * *stride != length)
            return d_.bad(pointer + "/count", std::to_string(*count) + " elements of " +
                                                  std::to_string(*stride) +
                                                  " bytes are not the bufferView's byteLength of " +
                                                  std::to_string(length));
        decompressed_bytes_ += length;
        if (decompressed_bytes_ / max_compression > d_.input_bytes)
            return d_.bad(pointer + "/count", "more elements than the compressed bytes can hold");
        return {};
    }

    struct Type {
        std::string name;
        int component_type = 0;
        std::uint64_t count = 0;
    };

    Result<Type> type_of(const Json& in, const std::string& pointer) const {
        Type out;
        const auto code = whole_member(d_, in, "componentType", pointer, 5120, 5126, {});
        if (!code) return code.error();
        out.component_type = int(*code);
        if (component_size(out.component_type) == 0)
            return d_.bad(pointer + "/componentType",
                          "expected 5120 to 5123, 5125 or 5126, found " + std::to_string(*code));
        const auto type = in.find("type");
        if (type == in.end()) return d_.bad(pointer + "/type", "the member is missing");
        if (!type->is_string()) return d_.bad(pointer + "/type", "expected a string");
        out.name = type->get<std::string>();
        if (components_of(out.name) == 0)
            return d_.bad(pointer + "/type",
                          "expected SCALAR, VEC2, VEC3, VEC4, MAT2, MAT3 or MAT4, found '" +
                              out.name.substr(0, 40) + "'");
        const auto count = whole_member(d_, in, "count", pointer, 1, max_elements, {});
        if (!count) return count.error();
        out.count = *count;
        return out;
    }

    // `count` elements of `element` bytes in a view, from `offset`.
    Result<void> fits(std::uint64_t offset, std::uint64_t count, std::uint64_t element,
                      std::uint64_t stride, const View& view, const std::string& pointer) const {
        // All factors are below 2^41 · 2^8: no overflow.
        const std::uint64_t end = offset + (count - 1) * stride + element;
        if (end > view.length)
            return d_.bad(pointer, std::to_string(count) + " elements of " +
                                       std::to_string(element) + " bytes end at byte " +
                                       std::to_string(end) + ", the bufferView has " +
                                       std::to_string(view.length));
        return {};
    }

    Result<void> accessor(const Json& in, std::size_t index, const std::string& pointer) {
        const auto type = type_of(in, pointer);
        if (!type) return type.error();
        const std::uint64_t component = component_size(type->component_type);
        const std::uint64_t element = stored_size(type->name, type->component_type);
        if (const auto it = in.find("normalized"); it != in.end() && !it->is_boolean())
            return d_.bad(pointer + "/normalized", "expected true or false");
        const auto view = index_member(d_, in, "bufferView", pointer, views_.size());
        if (!view) return view.error();
        const auto offset = whole_member(d_, in, "byteOffset", pointer, 0, max_offset, 0);
        if (!offset) return offset.error();
        if (*view == no_index) {
            const std::uint64_t bytes = type->count * element;
            zero_bytes_ += bytes;
            if (bytes > max_zero_bytes || zero_bytes_ > max_zero_bytes_in_all)
                return Error{ErrorCode::limit,
                             "an accessor without a bufferView may stand for " +
                                 std::to_string(max_zero_bytes >> 20) +
                                 " MiB of zeros, all together for " +
                                 std::to_string(max_zero_bytes_in_all >> 20),
                             d_.place(pointer + "/count")};
        } else {
            if (*offset % component != 0)
                return d_.bad(pointer + "/byteOffset", "expected a multiple of " +
                                                           std::to_string(component) +
                                                           ", the size of the "
                                                           "component, found " +
                                                           std::to_string(*offset));
            const View& v = views_[*view];
            if (v.stride && v.stride < element)
                return d_.bad(pointer, "elements of " + std::to_string(element) +
                                           " bytes do not fit the bufferView's byteStride of " +
                                           std::to_string(v.stride));
            if (auto done = fits(*offset, type->count, element, v.stride ? v.stride : element, v,
                                 pointer + (in.contains("byteOffset") ? "/byteOffset" : ""));
                !done)
                return done;
        }
        const auto sparse = in.find("sparse");
        if (sparse == in.end()) return {};
        if (!sparse->is_object()) return d_.bad(pointer + "/sparse", "expected an object");
        if (auto done = check_sparse(*sparse, *type, element, pointer + "/sparse"); !done)
            return done;
        // That the sparse indices ascend and are in range only their values can tell. Many
        // accessors may name the same ones.
        sparse_indices_ += whole_member(d_, *sparse, "count", pointer, 1, type->count, {}).value();
        if (sparse_indices_ * sizeof(std::uint32_t) > sparse_limit(d_.input_bytes))
            return d_.bad(pointer + "/sparse/count",
                          "sparse accessors name the same indices again and again",
                          ErrorCode::limit);
        return d_.check_sparse_indices(index);
    }

    Result<void> check_sparse(const Json& in, const Type& type, std::uint64_t element,
                              const std::string& pointer) const {
        const auto count = whole_member(d_, in, "count", pointer, 1, type.count, {});
        if (!count) return count.error();
        for (const char* key : {"indices", "values"}) {
            const std::string place = pointer + "/" + key;
            const auto part = in.find(key);
            if (part == in.end() || !part->is_object()) return d_.bad(place, "expected an object");
            std::uint64_t size = element, alignment = component_size(type.component_type);
            if (std::string_view(key) == "indices") {
                const auto code = whole_member(d_, *part, "componentType", place, 5121, 5125, {});
                if (!code) return code.error();
                if (*code != 5121 && *code != 5123 && *code != 5125)
                    return d_.bad(place + "/componentType",
                                  "expected 5121, 5123 or 5125, found " + std::to_string(*code));
                size = alignment = component_size(int(*code));
            }
            const auto view = index_member(d_, *part, "bufferView", place, views_.size());
            if (!view) return view.error();
            if (*view == no_index) return d_.bad(place + "/bufferView", "the member is missing");
            if (views_[*view].stride)
                return d_.bad(
                    place + "/bufferView",
                    "the bufferView has a byteStride, but sparse data are tightly packed");
            const auto offset = whole_member(d_, *part, "byteOffset", place, 0, max_offset, 0);
            if (!offset) return offset.error();
            if (*offset % alignment != 0)
                return d_.bad(place + "/byteOffset", "expected a multiple of " +
                                                         std::to_string(alignment) + ", found " +
                                                         std::to_string(*offset));
            if (auto done = fits(*offset, *count, size, size, views_[*view], place); !done)
                return done;
        }
        return {};
    }

    const GltfDocument& d_;
    std::vector<View> views_;
    std::uint64_t zero_bytes_ = 0, decompressed_bytes_ = 0, sparse_indices_ = 0;
};

}  // namespace

Result<void> check_structure(const GltfDocument& document) {
    return Checker(document).run();
}

}  // namespace prep::detail
