#include "formats/gltf/gltf_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/atomic_files.h"
#include "formats/gltf/build.h"
#include "formats/gltf/compression/compress.h"
#include "formats/gltf/compression/quantize.h"
#include "formats/gltf/rewrite.h"
#include "formats/writers.h"
#include "prep/formats.h"
#include "prep/version.h"

namespace prep::detail {
namespace {

constexpr std::uint64_t glb_limit = 0xffffffffu;  // a GLB's length is 32-bit

void append_u32(std::vector<std::byte>& out, std::uint32_t value) {
    for (int k = 0; k < 4; ++k) out.push_back(std::byte(value >> (8 * k)));
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
    Json document;       // its buffers are still to be added
    BinaryParts binary;  // in part the prepared scene's own arrays
    std::uint64_t fallback_bytes = 0;
    Json labels = Json::object();  // of the buffer: its name and extras

    Json buffers() const {
        Json all = buffers_of(binary.size(), fallback_bytes);
        if (!binary.empty()) all[0].update(labels);
        return all;
    }
};

// Name and extras of the document's buffer. Those of several buffers, whose data become one, are
// left out, with a note. Buffers that only stand for what is compressed have no data.
Json labels_of_buffers(const Json& document, std::vector<std::string>& notes) {
    Json labels = Json::object();
    const auto buffers = document.find("buffers");
    if (buffers == document.end() || !buffers->is_array()) return labels;
    std::size_t count = 0;
    for (const Json& buffer : *buffers) {
        const Json* const meshopt = extension_of(buffer, "EXT_meshopt_compression");
        if (meshopt != nullptr && meshopt->value("fallback", false)) continue;
        ++count;
        for (const char* member : {"name", "extras"})
            if (const auto found = buffer.find(member); found != buffer.end())
                labels[member] = *found;
    }
    if (count <= 1 || labels.empty()) return labels;
    notes.push_back("the file's buffers became one: their names and extras were left out");
    return Json::object();
}

// Whether a document has data by either codec: rounded anew, all of them are compressed by it.
CompressionPlan compression_of(const GltfDocument& document) {
    CompressionPlan plan;
    for (const auto& primitives : document.primitives)
        for (const GltfPrimitive& p : primitives) plan.draco |= !p.draco.empty();
    if (const auto views = document.json.find("bufferViews"); views != document.json.end())
        for (const Json& view : *views)
            plan.meshopt |= extension_of(view, "EXT_meshopt_compression") != nullptr;
    return plan;
}

// A program may have added or taken away what the document knows nothing of.
Result<void> check_same_meshes(const Scene& scene, const GltfDocument& document) {
    bool same = scene.meshes.size() == document.primitives.size();
    for (std::size_t m = 0; same && m < scene.meshes.size(); ++m)
        same = scene.meshes[m].tied_to_file &&
               scene.meshes[m].parts.size() == document.primitives[m].size();
    if (same) return {};
    return Error{ErrorCode::invalid,
                 "the scene's meshes are not those of its document any more: without "
                 "Scene::retained_file it is written anew",
                 document.name};
}

bool same_numbers(const std::optional<Trs>& a, const std::optional<Trs>& b) {
    if (!a || !b) return a.has_value() == b.has_value();
    return a->translation == b->translation && a->rotation == b->rotation && a->scale == b->scale;
}

// Likewise of nodes, but for the one above them all that place_scene() adds.
Result<void> check_same_nodes(const Scene& scene, const GltfDocument& document) {
    const bool placed = scene.placement.scale != 1 || scene.placement.up != Axis::y;
    const auto above = placed ? std::uint32_t(document.nodes.size()) : no_index;
    const auto same = [&](const Node& a, const Node& b) {
        return b.parent == (a.parent == no_index ? above : a.parent) &&
               a.transform == b.transform && same_numbers(a.trs, b.trs) && a.mesh == b.mesh &&
               a.camera == b.camera && a.light == b.light && a.skin == b.skin && a.name == b.name;
    };
    if (scene.nodes.size() == document.nodes.size() + std::size_t(placed) &&
        std::equal(document.nodes.begin(), document.nodes.end(), scene.nodes.begin(), same))
        return {};
    return Error{ErrorCode::invalid,
                 "the scene's nodes are not those of its document any more: without "
                 "Scene::retained_file it is written anew",
                 document.name};
}

Result<Encoded> encode(const PreparedScene& prepared, const SaveOptions& options,
                       std::vector<std::string>& notes) {
    Encoded out;
    PackedBuffer packed;
    CompressionPlan plan;
    const bool rounds = options.quantization.any();
    const Compression compression = options.compression;
    if (const GltfDocument* const document = gltf_document(prepared.scene)) {
        if (auto done = check_same_meshes(prepared.scene, *document); !done)
            return std::move(done).error();
        if (auto done = check_same_nodes(prepared.scene, *document); !done)
            return std::move(done).error();
        auto rewritten = rewrite_gltf(prepared, rounds ? Compression::none : compression, notes);
        if (!rewritten) return std::move(rewritten).error();
        out.document = std::move(rewritten->json);
        out.labels = labels_of_buffers(document->json, notes);
        packed = std::move(rewritten->packed);
        plan = std::move(rewritten->plan);
        if (rounds && compression == Compression::keep) plan = compression_of(*document);
    } else {
        out.document["asset"] = {{"version", "2.0"}};
        GltfBuffer buffer(out.document);
        build_gltf(prepared, out.document, buffer, notes);
        note_groups(prepared, "glTF", notes);
        note_unwritten(prepared.scene, notes);
        packed.bytes = std::move(buffer.binary());
    }
    plan.draco |= compression == Compression::draco;
    plan.meshopt |= compression == Compression::meshopt;
    out.document["asset"]["generator"] = fmt::format("meshprep {}", version());
    plan.optimized = is_reordered(prepared);
    if (rounds) {
        QuantizationReport unread;
        auto quantized =
            quantize_gltf(out.document, std::move(packed), options.quantization,
                          options.quantized != nullptr ? *options.quantized : unread, notes);
        if (!quantized) return std::move(quantized).error();
        packed = *std::move(quantized);
        notes.insert(notes.end(), unread.remarks.begin(), unread.remarks.end());
    }
    if (!plan.nothing()) {
        auto compressed = compress_gltf(out.document, std::move(packed), plan, notes);
        if (!compressed) return std::move(compressed).error();
        packed = *std::move(compressed);
    }
    out.binary = std::move(packed.bytes);
    out.binary.pad();
    out.fallback_bytes = packed.fallback_bytes;
    if (out.binary.empty() && !out.labels.empty())
        notes.push_back("no data is left: the buffer's name and extras were left out");
    return out;
}

// Where the first number stands that JSON has no way to write; empty: there is none. The document
// is nested no deeper than what is read.
std::string non_finite_place(const Json& value) {
    if (value.is_object()) {
        for (auto member = value.begin(); member != value.end(); ++member)
            if (std::string place = non_finite_place(*member); !place.empty())
                return "/" + member.key() + (place == "/" ? "" : place);
    } else if (value.is_array()) {
        for (std::size_t i = 0; i < value.size(); ++i)
            if (std::string place = non_finite_place(value[i]); !place.empty())
                return "/" + std::to_string(i) + (place == "/" ? "" : place);
    } else if (value.is_number_float() && !std::isfinite(value.get<double>())) {
        return "/";
    }
    return "";
}

Result<std::string> text_of(const Json& document, int indent) {
    if (std::string place = non_finite_place(document); !place.empty())
        return Error{ErrorCode::invalid,
                     "the number at " + place + " is not finite, and glTF holds no such", ""};
    return document.dump(indent, ' ', false, Json::error_handler_t::replace);
}

WriteResult write_separate(const PreparedScene& prepared, const std::filesystem::path& path,
                           const SaveOptions& options) {
    std::vector<std::string> notes;
    auto encoded = encode(prepared, options, notes);
    if (!encoded) return std::move(encoded).error();
    FileSet files(rules_for(prepared, path, options));
    if (!encoded->binary.empty()) {
        std::filesystem::path bin = path;
        bin.replace_extension(".bin");
        encoded->document["buffers"] = encoded->buffers();
        encoded->document["buffers"][0]["uri"] = percent_encoded(bin.filename().string());
        if (auto done = files.add(bin, encoded->binary.parts()); !done)
            return std::move(done).error();
    }
    auto json = text_of(encoded->document, 2);
    if (!json) return std::move(json).error();
    *json += '\n';
    if (auto done = files.add(path, std::as_bytes(std::span(*json))); !done)
        return std::move(done).error();
    if (auto done = files.commit(); !done) return std::move(done).error();
    return notes;
}

}  // namespace

std::vector<std::span<const std::byte>> GlbFile::parts() const {
    std::vector<std::span<const std::byte>> all{head, std::as_bytes(std::span(json)), binary_head};
    for (const auto& part : binary.parts()) all.push_back(part);
    return all;
}

Result<GlbFile> encode_glb(const PreparedScene& prepared, std::vector<std::string>& notes,
                           const SaveOptions& options) {
    auto encoded = encode(prepared, options, notes);
    if (!encoded) return std::move(encoded).error();
    GlbFile out;
    if (!encoded->binary.empty()) encoded->document["buffers"] = encoded->buffers();
    out.binary = std::move(encoded->binary);
    auto json = text_of(encoded->document, -1);
    if (!json) return std::move(json).error();
    out.json = *std::move(json);
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

namespace {

WriteResult write_together(const PreparedScene& prepared, const std::filesystem::path& path,
                           const SaveOptions& options) {
    std::vector<std::string> notes;
    const auto glb = encode_glb(prepared, notes, options);
    if (!glb) return glb.error();
    FileSet files(rules_for(prepared, path, options));
    if (auto done = files.add(path, glb->parts()); !done) return std::move(done).error();
    if (auto done = files.commit(); !done) return std::move(done).error();
    return notes;
}

}  // namespace

WriteResult write_gltf(const PreparedScene& prepared, const std::filesystem::path& path,
                       const SaveOptions& options) {
    const bool separate = lower_ending(path) == ".gltf";
    auto notes = separate ? write_separate(prepared, path, options)
                          : write_together(prepared, path, options);
    if (notes || !notes.error().place.empty()) return notes;
    Error error = std::move(notes).error();
    error.place = path.string();
    return error;
}

}  // namespace prep::detail
