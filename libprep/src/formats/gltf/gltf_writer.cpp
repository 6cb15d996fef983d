#include "formats/gltf/gltf_writer.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/atomic_files.h"
#include "formats/gltf/build.h"
#include "formats/gltf/compression/compress.h"
#include "formats/gltf/rewrite.h"
#include "formats/writers.h"
#include "prep/version.h"

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

void note_unwritten(const Scene& scene, std::vector<std::string>& notes) {
    std::size_t attributes = 0;
    for (const Mesh& mesh : scene.meshes) attributes += mesh.vertex_attributes.size();
    if (attributes > 0)
        notes.push_back(std::to_string(attributes) +
                        (attributes == 1 ? " attribute" : " attributes") +
                        " of other names, written to files that come from glTF only: left out");
}

struct Encoded {
    Json document;
    PackedBuffer packed;  // its entries are still to be added
};

Result<Encoded> encode(const PreparedScene& prepared, Compression compression,
                       std::vector<std::string>& notes) {
    Encoded out;
    CompressionPlan plan;
    if (gltf_document(prepared.scene)) {
        auto rewritten = rewrite_gltf(prepared, compression, notes);
        if (!rewritten) return std::move(rewritten).error();
        out.document = std::move(rewritten->json);
        out.packed = std::move(rewritten->packed);
        plan = std::move(rewritten->plan);
    } else {
        out.document["asset"] = {{"version", "2.0"}};
        GltfBuffer buffer(out.document);
        buffer.bytes().reserve(expected_bytes(prepared));
        build_gltf(prepared, out.document, buffer, notes);
        note_groups(prepared, "glTF", notes);
        note_unwritten(prepared.scene, notes);
        out.packed.bytes = std::move(buffer.bytes());
        plan.draco = compression == Compression::draco;
        plan.meshopt = compression == Compression::meshopt;
    }
    out.document["asset"]["generator"] = fmt::format("meshprep {}", version());
    if (!plan.nothing()) {
        auto compressed = compress_gltf(out.document, std::move(out.packed), plan, notes);
        if (!compressed) return std::move(compressed).error();
        out.packed = *std::move(compressed);
    }
    std::vector<std::byte>& bytes = out.packed.bytes;
    bytes.resize((bytes.size() + 3) & ~std::size_t(3));
    return out;
}

std::string text_of(const Json& document, int indent) {
    return document.dump(indent, ' ', false, Json::error_handler_t::replace);
}

WriteResult write_separate(const PreparedScene& prepared, const std::filesystem::path& path,
                           const SaveOptions& options) {
    std::vector<std::string> notes;
    auto encoded = encode(prepared, options.compression, notes);
    if (!encoded) return std::move(encoded).error();
    FileSet files(rules_for(prepared, path, options));
    if (!encoded->packed.bytes.empty()) {
        std::filesystem::path bin = path;
        bin.replace_extension(".bin");
        encoded->document["buffers"] = buffers_of(encoded->packed);
        encoded->document["buffers"][0]["uri"] = percent_encoded(bin.filename().string());
        if (auto done = files.add(bin, encoded->packed.bytes); !done)
            return std::move(done).error();
    }
    const std::string json = text_of(encoded->document, 2) + '\n';
    if (auto done = files.add(path, std::as_bytes(std::span(json))); !done)
        return std::move(done).error();
    if (auto done = files.commit(); !done) return std::move(done).error();
    return notes;
}

}  // namespace

std::array<std::span<const std::byte>, 4> GlbFile::parts() const {
    return {head, std::as_bytes(std::span(json)), binary_head, binary};
}

Result<GlbFile> encode_glb(const PreparedScene& prepared, std::vector<std::string>& notes,
                           Compression compression) {
    auto encoded = encode(prepared, compression, notes);
    if (!encoded) return std::move(encoded).error();
    GlbFile out;
    if (!encoded->packed.bytes.empty()) encoded->document["buffers"] = buffers_of(encoded->packed);
    out.binary = std::move(encoded->packed.bytes);
    out.json = text_of(encoded->document, -1);
    while (out.json.size() % 4 != 0) out.json += ' ';
    const std::uint64_t total =
        12 + 8 + out.json.size() + (out.binary.empty() ? 0 : 8 + out.binary.size());
    if (total > glb_limit)
        return Error{ErrorCode::limit, "a GLB file holds at most 4 GiB: write .gltf instead", ""};
    append_u32(out.head, 0x46546c67);  // "glTF"
    append_u32(out.head, 2);
    append_u32(out.head, std::uint32_t(total));
    append_u32(out.head, std::uint32_t(out.json.size()));
    append_u32(out.head, 0x4e4f534a);  // "JSON"
    if (!out.binary.empty()) {
        append_u32(out.binary_head, std::uint32_t(out.binary.size()));
        append_u32(out.binary_head, 0x004e4942);  // "BIN"
    }
    return out;
}

WriteResult write_gltf(const PreparedScene& prepared, const std::filesystem::path& path,
                       const SaveOptions& options) {
    if (path.extension() == ".gltf") return write_separate(prepared, path, options);
    std::vector<std::string> notes;
    const auto glb = encode_glb(prepared, notes, options.compression);
    if (!glb) {
        Error error = glb.error();
        if (error.place.empty()) error.place = path.string();
        return error;
    }
    FileSet files(rules_for(prepared, path, options));
    if (auto done = files.add(path, glb->parts()); !done) return std::move(done).error();
    if (auto done = files.commit(); !done) return std::move(done).error();
    return notes;
}

}  // namespace prep::detail
