#include "formats/gltf/compression/meshopt_encode.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cstdint>
#include <cstring>

namespace prep::detail {
namespace {

// The extension asks for version 1 of the codecs of indices; this library's default is 0.
void choose_versions() {
    static const bool chosen = [] {
        meshopt_encodeVertexVersion(0);
        meshopt_encodeIndexVersion(1);
        return true;
    }();
    (void)chosen;
}

std::vector<unsigned> as_indices(std::size_t stride, std::span<const std::byte> bytes) {
    std::vector<unsigned> out(bytes.size() / stride);
    for (std::size_t i = 0; i < out.size(); ++i)
        if (stride == 2) {
            std::uint16_t value;
            std::memcpy(&value, bytes.data() + 2 * i, 2);
            out[i] = value;
        } else {
            std::memcpy(&out[i], bytes.data() + 4 * i, 4);
        }
    return out;
}

}  // namespace

const char* name_of(MeshoptMode mode) {
    return mode == MeshoptMode::attributes  ? "ATTRIBUTES"
           : mode == MeshoptMode::triangles ? "TRIANGLES"
                                            : "INDICES";
}

bool meshopt_holds(MeshoptMode mode, std::size_t stride, std::size_t size) {
    if (size == 0 || stride == 0 || size % stride != 0) return false;
    if (mode == MeshoptMode::attributes) return stride % 4 == 0 && stride <= 256;
    return (stride == 2 || stride == 4) && (mode == MeshoptMode::indices || size / stride % 3 == 0);
}

std::optional<std::vector<std::byte>> encode_meshopt(MeshoptMode mode, std::size_t stride,
                                                     std::span<const std::byte> bytes) {
    if (!meshopt_holds(mode, stride, bytes.size())) return std::nullopt;
    choose_versions();
    const std::size_t count = bytes.size() / stride;
    std::vector<std::byte> out;
    const auto to = [&](std::size_t bound) {
        out.resize(bound);
        return reinterpret_cast<unsigned char*>(out.data());
    };
    if (mode == MeshoptMode::attributes) {
        unsigned char* const first = to(meshopt_encodeVertexBufferBound(count, stride));
        out.resize(meshopt_encodeVertexBuffer(first, out.size(), bytes.data(), count, stride));
    } else {
        const bool triangles = mode == MeshoptMode::triangles;
        const std::vector<unsigned> indices = as_indices(stride, bytes);
        const std::size_t vertices =
            std::size_t(*std::max_element(indices.begin(), indices.end())) + 1;
        unsigned char* const first =
            to(triangles ? meshopt_encodeIndexBufferBound(count, vertices)
                         : meshopt_encodeIndexSequenceBound(count, vertices));
        out.resize(triangles
                       ? meshopt_encodeIndexBuffer(first, out.size(), indices.data(), count)
                       : meshopt_encodeIndexSequence(first, out.size(), indices.data(), count));
    }
    if (out.empty() || out.size() >= bytes.size()) return std::nullopt;
    return out;
}

}  // namespace prep::detail
