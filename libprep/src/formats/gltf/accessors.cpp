#include <meshoptimizer.h>

#include <algorithm>
#include <cstring>

#include "formats/gltf/document.h"

namespace prep {
namespace detail {

std::size_t component_size(int type) {
    switch (type) {
        case 5120:
        case 5121:
            return 1;
        case 5122:
        case 5123:
            return 2;
        case 5125:
        case 5126:
            return 4;
        default:
            return 0;
    }
}

int components_of(const std::string& type) {
    if (type == "SCALAR") return 1;
    if (type == "VEC2") return 2;
    if (type == "VEC3") return 3;
    if (type == "VEC4" || type == "MAT2") return 4;
    if (type == "MAT3") return 9;
    if (type == "MAT4") return 16;
    return 0;
}

const char* type_of_width(int components) {
    static constexpr const char* vectors[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
    if (components >= 9) return components < 16 ? "MAT3" : "MAT4";
    return vectors[std::clamp(components, 1, 4) - 1];
}

namespace {

// Columns of small matrices start at multiples of four bytes.
std::size_t padded_matrix_size(const std::string& type, std::size_t component) {
    if (type == "MAT2" && component == 1) return 8;
    if (type == "MAT3" && component == 1) return 12;
    if (type == "MAT3" && component == 2) return 24;
    return 0;
}

}  // namespace

std::size_t stored_size(const std::string& type, int component_type) {
    const std::size_t component = component_size(component_type);
    const std::size_t padded = padded_matrix_size(type, component);
    return padded ? padded : component * std::size_t(components_of(type));
}

std::size_t RawAccessor::element_size() const {
    return component_size(component_type) * std::size_t(width);
}

namespace {

struct CompressedView {
    SharedBytes bytes;
    std::uint64_t stride = 0, count = 0;
};

Result<CompressedView> compressed_view(const GltfDocument& d, const Json& extension,
                                       const std::string& pointer) {
    const auto buffer = index_member(d, extension, "buffer", pointer, d.buffers.size());
    if (!buffer) return buffer.error();
    if (*buffer == no_index) return d.bad(pointer + "/buffer", "the member is missing");
    if (!d.buffers[*buffer]) return d.buffers[*buffer].error();
    const SharedBytes& bytes = *d.buffers[*buffer];
    const auto offset = whole_member(d, extension, "byteOffset", pointer, 0, bytes.size(), 0);
    const auto length = whole_member(d, extension, "byteLength", pointer, 1, bytes.size(), {});
    const auto stride = whole_member(d, extension, "byteStride", pointer, 1, 256, {});
    const auto count = whole_member(d, extension, "count", pointer, 1, max_elements, {});
    for (const auto* r : {&offset, &length, &stride, &count})
        if (!*r) return r->error();
    if (*offset + *length > bytes.size())
        return d.bad(pointer + "/byteLength", "the view goes beyond its buffer");
    return CompressedView{bytes.part(*offset, *length), *stride, *count};
}

Result<std::vector<std::byte>> decompress(const GltfDocument& d, const Json& extension,
                                          const std::string& pointer, bool undo_filter = true) {
    const auto view = compressed_view(d, extension, pointer);
    if (!view) return view.error();
    const std::uint64_t *const stride = &view->stride, *const count = &view->count;
    std::vector<std::byte> out(*count * *stride);
    const auto* in = reinterpret_cast<const unsigned char*>(view->bytes.data());
    const std::string mode = extension.value("mode", std::string());
    int failed = -1;
    if (mode == "ATTRIBUTES") {
        if (*stride % 4 != 0) return d.bad(pointer + "/byteStride", "expected a multiple of 4");
        failed = meshopt_decodeVertexBuffer(out.data(), *count, *stride, in, view->bytes.size());
    } else if (mode == "TRIANGLES" || mode == "INDICES") {
        if (*stride != 2 && *stride != 4) return d.bad(pointer + "/byteStride", "expected 2 or 4");
        if (mode == "TRIANGLES" && *count % 3 != 0)
            return d.bad(pointer + "/count", "expected a multiple of 3");
        failed =
            mode == "TRIANGLES"
                ? meshopt_decodeIndexBuffer(out.data(), *count, *stride, in, view->bytes.size())
                : meshopt_decodeIndexSequence(out.data(), *count, *stride, in, view->bytes.size());
    } else {
        return d.bad(pointer + "/mode", "expected ATTRIBUTES, TRIANGLES or INDICES");
    }
    if (failed) return d.bad(pointer, "the compressed data cannot be decoded");
    if (!undo_filter) return out;
    const std::string filter = extension.value("filter", std::string("NONE"));
    if (filter == "OCTAHEDRAL") {
        if (*stride != 4 && *stride != 8)
            return d.bad(pointer + "/byteStride", "expected 4 or 8 with this filter");
        meshopt_decodeFilterOct(out.data(), *count, *stride);
    } else if (filter == "QUATERNION") {
        if (*stride != 8) return d.bad(pointer + "/byteStride", "expected 8 with this filter");
        meshopt_decodeFilterQuat(out.data(), *count, *stride);
    } else if (filter == "EXPONENTIAL") {
        meshopt_decodeFilterExp(out.data(), *count, *stride);
    } else if (filter != "NONE") {
        return d.bad(pointer + "/filter", "unknown filter");
    }
    return out;
}

}  // namespace

}  // namespace detail

using namespace detail;

Result<SharedBytes> GltfDocument::view(std::size_t index) const {
    const Json& view = json["bufferViews"][index];
    const std::string pointer = "/bufferViews/" + std::to_string(index);
    if (const auto known = decompressed_.find(index); known != decompressed_.end())
        return known->second;
    if (const Json* compressed = extension_of(view, "EXT_meshopt_compression")) {
        Result<std::vector<std::byte>> bytes = Error{};
        try {
            bytes = decompress(*this, *compressed, pointer + "/extensions/EXT_meshopt_compression");
        } catch (const Json::exception& e) {
            bytes = bad(pointer, e.what());
        }
        if (!bytes) return std::move(bytes).error();
        return decompressed_.emplace(index, *std::move(bytes)).first->second;
    }
    const auto buffer = index_member(*this, view, "buffer", pointer, buffers.size());
    if (!buffer) return buffer.error();
    if (*buffer == no_index) return bad(pointer + "/buffer", "the member is missing");
    if (!buffers[*buffer]) return buffers[*buffer].error();
    const SharedBytes& bytes = *buffers[*buffer];
    const auto offset = whole_member(*this, view, "byteOffset", pointer, 0, bytes.size(), 0);
    if (!offset) return offset.error();
    const auto length = whole_member(*this, view, "byteLength", pointer, 1,
                                     std::max<std::size_t>(bytes.size(), 1), {});
    if (!length) return length.error();
    if (*offset + *length > bytes.size())
        return bad(pointer + "/byteLength", "the view ends at byte " +
                                                std::to_string(*offset + *length) +
                                                ", its buffer has " + std::to_string(bytes.size()));
    return bytes.part(*offset, *length);
}

namespace {

// Where a view's compressed bytes are described.
std::string compressed_pointer(std::size_t index) {
    return "/bufferViews/" + std::to_string(index) + "/extensions/EXT_meshopt_compression";
}

}  // namespace

Result<SharedBytes> GltfDocument::stored_view(std::size_t index) const {
    const Json& extension = json["bufferViews"][index]["extensions"]["EXT_meshopt_compression"];
    const auto view = compressed_view(*this, extension, compressed_pointer(index));
    if (!view) return view.error();
    return view->bytes;
}

Result<std::vector<std::byte>> GltfDocument::filtered_view(std::size_t index) const {
    const Json& extension = json["bufferViews"][index]["extensions"]["EXT_meshopt_compression"];
    return decompress(*this, extension, compressed_pointer(index), false);
}

namespace {

struct Layout {
    std::size_t offset = 0, stride = 0, element = 0, component = 0;
    std::size_t count = 0;
};

// `count` elements of a view, or those of them that are asked for: copied where they do not lie one
// after the other.
Result<SharedBytes> gather(const GltfDocument& d, std::size_t view_index, const Layout& layout,
                           const std::string& type, const std::string& pointer,
                           const std::vector<std::uint32_t>* only) {
    const auto bytes = d.view(view_index);
    if (!bytes) return bytes.error();
    const std::size_t padded = padded_matrix_size(type, layout.component);
    const std::size_t source = padded ? padded : layout.element;
    const std::size_t stride = layout.stride ? layout.stride : source;
    if (layout.offset > bytes->size() ||
        (layout.count > 0 &&
         (bytes->size() - layout.offset < source ||
          (layout.count - 1) > (bytes->size() - layout.offset - source) / stride)))
        return d.bad(pointer, std::to_string(layout.count) + " elements from byte " +
                                  std::to_string(layout.offset) + " with stride " +
                                  std::to_string(stride) + " do not fit the bufferView of " +
                                  std::to_string(bytes->size()) + " bytes");
    const std::size_t count = only ? only->size() : layout.count;
    if (!only && stride == layout.element && !padded)
        return bytes->part(layout.offset, count * layout.element);
    std::vector<std::byte> out(count * layout.element);
    const std::byte* from = bytes->data() + layout.offset;
    const std::size_t rows = type == "MAT2" ? 2 : 3, column = rows * layout.component;
    for (std::size_t i = 0; i < count; ++i) {
        const std::byte* const element = from + (only ? (*only)[i] : i) * stride;
        std::byte* const to = out.data() + i * layout.element;
        if (!padded)
            std::memcpy(to, element, layout.element);
        else
            for (std::size_t c = 0; c < rows; ++c)
                std::memcpy(to + c * column, element + c * (padded / rows), column);
    }
    return SharedBytes(std::move(out));
}

// check_structure() has seen to it that members are there and of their types.
std::size_t whole(const Json& object, const char* key) {
    const auto it = object.find(key);
    return it == object.end() ? 0 : it->get<std::size_t>();
}

// The elements that a sparse part changes, of an accessor with `elements` of them.
Result<std::vector<std::uint32_t>> sparse_targets(const GltfDocument& d, const Json& sparse,
                                                  std::size_t elements,
                                                  const std::string& pointer) {
    const Json& part = sparse["indices"];
    RawAccessor indices{int(whole(part, "componentType")), 1, false, whole(sparse, "count"), {}};
    const Layout layout{whole(part, "byteOffset"), 0, indices.element_size(),
                        component_size(indices.component_type), indices.count};
    auto read = gather(d, whole(part, "bufferView"), layout, "SCALAR", pointer, nullptr);
    if (!read) return std::move(read).error();
    indices.bytes = *std::move(read);
    std::vector<std::uint32_t> targets = to_indices(indices);
    for (std::size_t i = 0; i < targets.size(); ++i) {
        if (targets[i] >= elements)
            return d.bad(pointer, "index " + std::to_string(targets[i]) +
                                      " is out of range: the accessor has " +
                                      std::to_string(elements) + " elements");
        if (i > 0 && targets[i] <= targets[i - 1])
            return d.bad(pointer, "the indices must ascend, found " + std::to_string(targets[i]) +
                                      " after " + std::to_string(targets[i - 1]));
    }
    return targets;
}

Result<void> apply_sparse(const GltfDocument& d, const Json& sparse, const std::string& type,
                          const std::string& pointer, RawAccessor& raw) {
    const auto targets = sparse_targets(d, sparse, raw.count, pointer + "/indices");
    if (!targets) return targets.error();
    const Json& part = sparse["values"];
    const Layout layout{whole(part, "byteOffset"), 0, raw.element_size(),
                        component_size(raw.component_type), targets->size()};
    const auto values =
        gather(d, whole(part, "bufferView"), layout, type, pointer + "/values", nullptr);
    if (!values) return values.error();
    const std::size_t size = raw.element_size();
    std::vector<std::byte> changed(raw.bytes.begin(), raw.bytes.end());
    for (std::size_t i = 0; i < targets->size(); ++i)
        std::memcpy(changed.data() + (*targets)[i] * size, values->data() + i * size, size);
    raw.bytes = std::move(changed);
    return {};
}

// `only`: the elements to be read; null: all.
Result<RawAccessor> read_accessor(const GltfDocument& d, std::size_t index,
                                  const std::vector<std::uint32_t>* only) {
    const std::string pointer = "/accessors/" + std::to_string(index);
    const Json& accessor = d.json["accessors"][index];
    const std::string type = accessor["type"].get<std::string>();
    RawAccessor raw;
    raw.component_type = int(whole(accessor, "componentType"));
    raw.width = components_of(type);
    raw.normalized = accessor.value("normalized", false);
    raw.count = whole(accessor, "count");
    if (accessor.contains("bufferView")) {
        const std::size_t view = whole(accessor, "bufferView");
        const Layout layout{whole(accessor, "byteOffset"),
                            whole(d.json["bufferViews"][view], "byteStride"), raw.element_size(),
                            component_size(raw.component_type), raw.count};
        auto read = gather(d, view, layout, type, pointer, only);
        if (!read) return std::move(read).error();
        raw.bytes = *std::move(read);
        if (only) raw.count = only->size();
    } else {
        if (only) raw.count = only->size();
        raw.bytes = std::vector<std::byte>(raw.count * raw.element_size());
    }
    if (const auto it = accessor.find("sparse"); it != accessor.end())
        if (auto done = apply_sparse(d, *it, type, pointer + "/sparse", raw); !done)
            return std::move(done).error();
    return raw;
}

// 0, 1, 2, …
bool ascends_by_one(const std::vector<std::uint32_t>& elements) {
    for (std::size_t i = 0; i < elements.size(); ++i)
        if (elements[i] != i) return false;
    return true;
}

}  // namespace

Result<void> GltfDocument::check_sparse_indices(std::size_t index) const {
    const Json& accessor = json["accessors"][index];
    const auto targets = sparse_targets(*this, accessor["sparse"], whole(accessor, "count"),
                                        "/accessors/" + std::to_string(index) + "/sparse/indices");
    return targets ? Result<void>() : Result<void>(targets.error());
}

Result<RawAccessor> GltfDocument::raw_accessor(std::size_t index) const {
    return read_accessor(*this, index, nullptr);
}

Result<RawAccessor> GltfDocument::raw_elements(std::size_t index,
                                               const std::vector<std::uint32_t>& elements) const {
    const Json& accessor = json["accessors"][index];
    const bool all = elements.size() == whole(accessor, "count") && ascends_by_one(elements);
    if (all) return raw_accessor(index);
    if (!accessor.contains("sparse")) return read_accessor(*this, index, &elements);
    auto whole_one = raw_accessor(index);
    if (!whole_one) return whole_one;
    return selected(*whole_one, elements);
}

namespace detail {

namespace {

template <class T>
T value_at(const RawAccessor& raw, std::size_t i) {
    T value;
    std::memcpy(&value, raw.bytes.data() + i * sizeof(T), sizeof(T));
    return value;
}

template <class T>
std::vector<std::uint32_t> indices_of(const RawAccessor& raw) {
    std::vector<std::uint32_t> out(raw.bytes.size() / sizeof(T));
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = value_at<T>(raw, i);
    return out;
}

template <class T>
void write_scaled(const RawAccessor& raw, double largest, int width, float* out) {
    const auto from = std::size_t(raw.width), to = std::size_t(width), both = std::min(from, to);
    for (std::size_t i = 0; i < raw.count; ++i)
        for (std::size_t k = 0; k < both; ++k) {
            const T v = value_at<T>(raw, i * from + k);
            out[i * to + k] =
                raw.normalized ? float(std::max(double(v) / largest, -1.0)) : float(v);
        }
}

}  // namespace

StoredElements stored_elements(const RawAccessor& raw, const std::string& type) {
    const std::size_t size = raw.element_size(), component = component_size(raw.component_type);
    const std::size_t padded = padded_matrix_size(type, component);
    const std::size_t columns = !padded ? 1 : type == "MAT2" ? 2 : 3, column = size / columns;
    const std::size_t filled = padded ? padded : size;
    StoredElements out{raw.bytes, (filled + 3) & ~std::size_t(3), false};
    out.apart = out.stride != filled;
    if (out.stride == size) return out;
    std::vector<std::byte> bytes(raw.count * out.stride);
    for (std::size_t i = 0; i < raw.count; ++i)
        for (std::size_t c = 0; c < columns; ++c)
            std::memcpy(bytes.data() + i * out.stride + c * (filled / columns),
                        raw.bytes.data() + i * size + c * column, column);
    out.bytes = std::move(bytes);
    return out;
}

RawAccessor selected(const RawAccessor& raw, const std::vector<std::uint32_t>& elements) {
    RawAccessor out{raw.component_type, raw.width, raw.normalized, elements.size(), {}};
    const std::size_t size = raw.element_size();
    std::vector<std::byte> bytes(elements.size() * size);
    for (std::size_t i = 0; i < elements.size(); ++i)
        std::memcpy(bytes.data() + i * size, raw.bytes.data() + elements[i] * size, size);
    out.bytes = std::move(bytes);
    return out;
}

const GltfDocument* gltf_document(const Scene& scene) {
    return dynamic_cast<const GltfDocument*>(scene.retained_file.get());
}

std::vector<std::uint32_t> materials_of_variants(const Json& primitive) {
    std::vector<std::uint32_t> materials;
    const Json::json_pointer mappings("/extensions/KHR_materials_variants/mappings");
    if (!primitive.contains(mappings)) return materials;
    for (const Json& mapping : primitive.at(mappings)) {
        if (!mapping.is_object()) continue;
        const auto material = mapping.find("material");
        if (material == mapping.end() || !material->is_number_unsigned()) continue;
        const auto index = material->get<std::uint64_t>();
        if (index < no_index) materials.push_back(std::uint32_t(index));
    }
    return materials;
}

std::optional<std::size_t> set_number(std::string_view semantic, std::string_view prefix) {
    if (!semantic.starts_with(prefix)) return std::nullopt;
    const std::string_view digits = semantic.substr(prefix.size());
    if (digits.empty() || digits.size() > 2 ||
        digits.find_first_not_of("0123456789") != std::string_view::npos)
        return std::nullopt;
    return std::size_t(std::stoul(std::string(digits)));
}

void write_floats(const RawAccessor& raw, int width, float* out) {
    switch (raw.component_type) {
        case 5120:
            return write_scaled<std::int8_t>(raw, 127, width, out);
        case 5121:
            return write_scaled<std::uint8_t>(raw, 255, width, out);
        case 5122:
            return write_scaled<std::int16_t>(raw, 32767, width, out);
        case 5123:
            return write_scaled<std::uint16_t>(raw, 65535, width, out);
        case 5125:
            return write_scaled<std::uint32_t>(raw, 4294967295.0, width, out);
        default:
            break;
    }
    const auto from = std::size_t(raw.width), to = std::size_t(width), both = std::min(from, to);
    if (from == to) {
        if (raw.count > 0) std::memcpy(out, raw.bytes.data(), raw.count * from * sizeof(float));
        return;
    }
    for (std::size_t i = 0; i < raw.count; ++i)
        std::memcpy(out + i * to, raw.bytes.data() + i * from * sizeof(float),
                    both * sizeof(float));
}

std::vector<float> to_floats(const RawAccessor& raw) {
    std::vector<float> out(raw.count * std::size_t(raw.width));
    write_floats(raw, raw.width, out.data());
    return out;
}

bool same_indices(const RawAccessor& raw, std::span<const std::uint32_t> indices) {
    if (raw.count != indices.size()) return false;
    if (raw.component_type == 5125)
        return raw.bytes.size() == indices.size_bytes() &&
               (indices.empty() ||
                std::memcmp(raw.bytes.data(), indices.data(), indices.size_bytes()) == 0);
    const std::vector<std::uint32_t> own = to_indices(raw);
    return std::equal(own.begin(), own.end(), indices.begin(), indices.end());
}

std::vector<std::uint32_t> to_indices(const RawAccessor& raw) {
    switch (raw.component_type) {
        case 5121:
            return indices_of<std::uint8_t>(raw);
        case 5123:
            return indices_of<std::uint16_t>(raw);
        case 5125:
            return indices_of<std::uint32_t>(raw);
        default:
            return {};
    }
}

}  // namespace detail
}  // namespace prep
