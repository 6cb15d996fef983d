#include "formats/gltf/compression/kept_meshopt.h"

#include <algorithm>
#include <cstring>

#include "formats/gltf/compression/compress.h"

namespace prep::detail {

const Json* KeptMeshopt::compressed_view(std::size_t accessor) const {
    const Json& in = document_.json["accessors"][accessor];
    if (!in.contains("bufferView") || in.contains("sparse")) return nullptr;
    return extension_of(document_.json["bufferViews"][in["bufferView"].get<std::size_t>()],
                        "EXT_meshopt_compression");
}

bool KeptMeshopt::has_part_of(const Json& primitive) const {
    const auto compressed = [&](const Json& accessor) {
        return compressed_view(accessor.get<std::size_t>()) != nullptr;
    };
    return (primitive.contains("indices") && compressed(primitive["indices"])) ||
           std::any_of(primitive["attributes"].begin(), primitive["attributes"].end(), compressed);
}

void KeptMeshopt::keep_filter(std::size_t accessor, const std::vector<std::uint32_t>& elements,
                              std::size_t stride, std::size_t view) {
    const Json* const compressed = compressed_view(accessor);
    const std::string filter =
        compressed ? compressed->value("filter", std::string("NONE")) : "NONE";
    if (filter == "NONE") return;
    const Json& in = document_.json["accessors"][accessor];
    const auto from_stride = compressed->value("byteStride", std::size_t(0));
    const auto offset = in.value("byteOffset", std::size_t(0));
    // Octahedral coordinates and quaternions are filtered as whole elements.
    if (filter != "EXPONENTIAL" && (stride != from_stride || offset % stride != 0)) return;
    const auto source = in["bufferView"].get<std::size_t>();
    auto known = filtered_.find(source);
    if (known == filtered_.end()) {
        auto read = document_.filtered_view(source);
        if (!read) return;
        known = filtered_.emplace(source, *std::move(read)).first;
    }
    std::vector<std::byte> bytes(elements.size() * stride);
    for (std::size_t i = 0; i < elements.size(); ++i) {
        const std::size_t at = offset + elements[i] * from_stride;
        if (at + stride > known->second.size()) return;
        std::memcpy(bytes.data() + i * stride, known->second.data() + at, stride);
    }
    compress_view(json_, appended_, view, MeshoptMode::attributes, stride, bytes, filter);
}

void KeptMeshopt::compress_from(std::size_t first, bool turns) {
    for (std::size_t a = first; a < json_["accessors"].size(); ++a) {
        const Json& accessor = json_["accessors"][a];
        if (!accessor.contains("bufferView")) continue;
        const auto v = accessor["bufferView"].get<std::size_t>();
        const Json& view = json_["bufferViews"][v];
        const auto* bytes = appended_.bytes_of(v);
        if (!bytes || extension_of(view, "EXT_meshopt_compression")) continue;
        MeshoptMode mode = MeshoptMode::attributes;
        const std::size_t stride =
            view.value("byteStride", stored_size(accessor["type"], accessor["componentType"]));
        if (view.value("target", 0) == 34963)
            mode = turns ? MeshoptMode::triangles : MeshoptMode::indices;
        compress_view(json_, appended_, v, mode, stride, *bytes);
    }
}

}  // namespace prep::detail
