#include <fmt/format.h>

#include "file_set.h"
#include "gltf_build.h"
#include "gltf_rewrite.h"
#include "prep/version.h"
#include "writers.h"

namespace prep::detail {
namespace {

constexpr std::uint64_t glb_limit = 0xffffffffu;  // a GLB's length is 32-bit

void append_u32(std::vector<std::byte>& out, std::uint32_t value) {
    for (int k = 0; k < 4; ++k) out.push_back(std::byte(value >> (8 * k)));
}

// What the meshes will take in the binary part, so that it need not grow; images come on top.
std::size_t expected_bytes(const PreparedScene& prepared) {
    std::size_t bytes = 0;
    for (const VertexMesh& mesh : prepared.meshes) {
        const std::size_t floats = 3 + (mesh.normals.empty() ? 0 : 3) +
                                   (mesh.tangents.empty() ? 0 : 4) + 2 * mesh.uvs.size() +
                                   4 * mesh.colors.size();
        bytes += 4 * (floats * mesh.vertex_count() + mesh.indices.size() + mesh.lines.size() +
                      mesh.points.size());
    }
    return bytes + bytes / 64;
}

// A URI reference to a file of this name (RFC 3986): everything but unreserved characters encoded.
std::string percent_encoded(const std::string& name) {
    static constexpr std::string_view plain =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-._~";
    std::string uri;
    for (const char c : name) {
        if (plain.find(c) != std::string_view::npos)
            uri += c;
        else
            uri += fmt::format("%{:02X}", static_cast<unsigned char>(c));
    }
    return uri;
}

}  // namespace

WriteResult write_gltf(const PreparedScene& prepared, const std::filesystem::path& path,
                       const SaveOptions& options) {
    std::vector<std::string> notes;
    Json document;
    std::vector<std::byte> binary;
    if (prepared.scene.document) {
        auto rewritten = rewrite_gltf(prepared, notes);
        if (!rewritten) return std::move(rewritten).error();
        document = std::move(rewritten->json);
        binary = std::move(rewritten->binary);
    } else {
        document["asset"] = {{"version", "2.0"}};
        GltfBuffer buffer(document);
        buffer.bytes().reserve(expected_bytes(prepared));
        build_gltf(prepared, document, buffer, notes);
        binary = std::move(buffer.bytes());
    }
    document["asset"]["generator"] = fmt::format("meshprep {}", version());
    binary.resize((binary.size() + 3) & ~std::size_t(3));

    const bool glb = path.extension() != ".gltf";
    if (!binary.empty()) {
        Json entry{{"byteLength", binary.size()}};
        std::filesystem::path bin = path.filename();
        bin.replace_extension(".bin");
        if (!glb) entry["uri"] = percent_encoded(bin.string());
        document["buffers"] = Json::array({std::move(entry)});
    }
    std::string json = document.dump(glb ? -1 : 2, ' ', false, Json::error_handler_t::replace);
    if (!glb) {
        json += '\n';
        FileSet files(rules_for(prepared, path, options));
        if (!binary.empty()) {
            std::filesystem::path bin = path;
            bin.replace_extension(".bin");
            if (auto done = files.add(bin, binary); !done) return std::move(done).error();
        }
        if (auto done = files.add(path, std::as_bytes(std::span(json))); !done)
            return std::move(done).error();
        if (auto done = files.commit(); !done) return std::move(done).error();
        return notes;
    }
    while (json.size() % 4 != 0) json += ' ';
    const std::uint64_t total = 12 + 8 + json.size() + (binary.empty() ? 0 : 8 + binary.size());
    if (total > glb_limit)
        return Error{ErrorCode::limit, "a GLB file holds at most 4 GiB: write .gltf instead",
                     path.string()};
    std::vector<std::byte> head, middle;
    append_u32(head, 0x46546c67);  // "glTF"
    append_u32(head, 2);
    append_u32(head, std::uint32_t(total));
    append_u32(head, std::uint32_t(json.size()));
    append_u32(head, 0x4e4f534a);  // "JSON"
    if (!binary.empty()) {
        append_u32(middle, std::uint32_t(binary.size()));
        append_u32(middle, 0x004e4942);  // "BIN"
    }
    const std::span<const std::byte> parts[] = {head, std::as_bytes(std::span(json)), middle,
                                                binary};
    FileSet files(rules_for(prepared, path, options));
    if (auto done = files.add(path, parts); !done) return std::move(done).error();
    if (auto done = files.commit(); !done) return std::move(done).error();
    return notes;
}

}  // namespace prep::detail
