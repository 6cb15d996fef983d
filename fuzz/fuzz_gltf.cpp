// glTF in, prepared, GLB out, by each compression: what is written must be readable, and have the
// same triangles unless some lie at NaN or infinity (those are not written).
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "formats/gltf/gltf.h"
#include "formats/gltf/gltf_writer.h"
#include "invariants.h"
#include "prep/prepare.h"
#include "prep/tangent_conventions.h"

namespace {

std::size_t triangles(const prep::PreparedScene& prepared) {
    std::size_t total = 0;
    for (const prep::VertexMesh& mesh : prepared.meshes) total += mesh.indices.size() / 3;
    return total;
}

bool finite(const prep::PreparedScene& prepared) {
    for (const prep::VertexMesh& mesh : prepared.meshes)
        for (const glm::vec3& p : mesh.positions)
            if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) return false;
    return true;
}

prep::Result<prep::PreparedScene> prepared(prep::Scene scene) {
    prep::PrepareOptions options;
    options.threads = 1;
    options.request.tangents = prep::Request::Level::always;
    return prep::prepare(std::move(scene), options);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    prep::GltfOptions options;
    options.directory = "nowhere";
    auto scene = prep::parse_gltf(std::as_bytes(std::span(data, size)), options);
    if (!scene) return 0;
    if (!test::broken_promise(*scene).empty()) std::abort();
    for (const prep::Mesh& mesh : scene->meshes) prep::tangent_conventions(mesh, 0, 1);
    const auto first = prepared(std::move(*scene));
    if (!first) return 0;
    using prep::Compression;
    for (const int bits : {0, 8})
        for (const Compression compression :
             {Compression::keep, Compression::none, Compression::draco, Compression::meshopt}) {
            std::vector<std::string> notes;
            prep::SaveOptions save;
            save.compression = compression;
            save.quantization = {bits, bits, bits, bits};
            const auto glb = prep::detail::encode_glb(*first, notes, save);
            if (!glb) return 0;
            std::vector<std::byte> file;
            for (const std::span<const std::byte> part : glb->parts())
                file.insert(file.end(), part.begin(), part.end());
            auto again = prep::parse_gltf(file, options);
            if (!again) std::abort();
            const auto second = prepared(std::move(*again));
            if (!second) std::abort();
            if (finite(*first) && triangles(*second) != triangles(*first)) std::abort();
        }
    return 0;
}
