#include <algorithm>
#include <cmath>

#include "base/finite.h"
#include "formats/gltf/gltf.h"
#include "formats/gltf/gltf_writer.h"
#include "formats/registry.h"
#include "prep/save.h"
#include "text/name_list.h"

namespace prep {
namespace detail {

FileSetRules rules_for(const PreparedScene& prepared, const std::filesystem::path& path,
                       const SaveOptions& options) {
    FileSetRules rules;
    rules.replace = options.replace;
    rules.target = path;
    rules.written = options.written;
    rules.spared = options.spared;
    if (options.replace_sources) return rules;
    rules.spare = prepared.scene.libraries;
    rules.source = prepared.scene.source;
    for (const ImageRef& image : prepared.scene.images)
        for (std::filesystem::path& file : files_of(image)) rules.spare.push_back(std::move(file));
    return rules;
}

bool is_reordered(const PreparedScene& prepared) {
    return std::any_of(prepared.orders.begin(), prepared.orders.end(),
                       [](const auto& order) { return order.has_value(); });
}

void note_groups(const PreparedScene& prepared, const std::string& format,
                 std::vector<std::string>& notes) {
    std::size_t count = 0;
    for (const Mesh& mesh : prepared.scene.meshes)
        for (const std::string& part : mesh.parts) count += !part.empty();
    if (count > 0)
        notes.push_back(format + " holds no groups within a mesh: " + std::to_string(count) +
                        (count == 1 ? " name was left out" : " names were left out"));
}

namespace {

void note_loose_parts(const PreparedScene& prepared, std::vector<std::string>& notes) {
    std::size_t loose = 0;
    for (const Mesh& mesh : prepared.scene.meshes) loose += mesh.loose_parts_with_attributes;
    if (loose > 0)
        notes.push_back(
            "normals, UVs and materials of lines and points are kept from glTF to glTF "
            "only: those of " +
            std::to_string(loose) +
            (loose == 1 ? " primitive were left out" : " primitives were left out"));
}

void note_missing_uvs(const PreparedScene& prepared, const std::string& format,
                      std::vector<std::string>& notes) {
    std::size_t missing = 0;
    for (const Mesh& mesh : prepared.scene.meshes)
        for (const auto& set : mesh.uvs) {
            std::uint32_t largest = 0;  // one pass that is as fast as memory, for most meshes
            for (const std::uint32_t i : set.indices) largest = std::max(largest, i);
            if (largest == no_index)
                missing +=
                    std::size_t(std::count(set.indices.begin(), set.indices.end(), no_index));
        }
    if (missing > 0)
        notes.push_back(
            format + " holds UVs of all corners or of none: " + std::to_string(missing) +
            (missing == 1 ? " corner without one got zeros" : " corners without one got zeros"));
}

void note_subdivision(const PreparedScene& prepared, const std::string& format,
                      std::vector<std::string>& notes) {
    std::size_t tags = 0;
    for (const Mesh& mesh : prepared.scene.meshes) {
        const SubdivisionTags& of = mesh.subdivision;
        tags += of.creases.size() + of.corners.size() + of.holes.size();
    }
    if (tags > 0)
        notes.push_back(format + " holds no tags of subdivision, creases, corners and holes: " +
                        std::to_string(tags) + " left out");
}

// What glTF files keep and the other formats do not, beside what their writers tell of themselves.
void note_lost(const PreparedScene& prepared, const std::string& format, const FormatHolds& holds,
               std::vector<std::string>& notes) {
    std::size_t shown = 0;
    NameList custom;
    std::vector<bool> is_shown(prepared.scene.meshes.size(), false);
    for (const Node& node : prepared.scene.nodes) {
        if (node.mesh == no_index || is_shown[node.mesh]) continue;
        is_shown[node.mesh] = true;
        ++shown;
    }
    if (const std::size_t hidden = is_shown.size() - shown; hidden > 0)
        notes.push_back(std::to_string(hidden) +
                        (hidden == 1
                             ? " mesh that the file's scene does not show was left out"
                             : " meshes that the file's scene does not show were left out"));
    for (const Mesh& mesh : prepared.scene.meshes) {
        for (const VertexAttribute& attribute : mesh.vertex_attributes) custom.add(attribute.name);
    }
    if (!custom.empty())
        notes.push_back(format + " holds no attributes of other names: " + custom.text() +
                        " left out");
    if (holds.materials) {
        NameList beyond;
        for (const std::string& extension : extensions_beyond_materials(prepared.scene))
            beyond.add(extension);
        if (!beyond.empty())
            notes.push_back(format + " holds nothing of these extensions of materials: " +
                            beyond.text() + ": left out");
    }
    if (const std::size_t targets = morph_target_count(prepared.scene); targets > 0)
        notes.push_back(format + " holds no morph targets: " + std::to_string(targets) +
                        " left out");
    std::string kinds;
    const auto node_holds = [&](Index Node::*what) {
        return std::any_of(prepared.scene.nodes.begin(), prepared.scene.nodes.end(),
                           [&](const Node& node) { return node.*what != no_index; });
    };
    const auto add_kind = [&](const char* kind, bool is_there) {
        if (is_there) kinds += (kinds.empty() ? "" : ", ") + std::string(kind);
    };
    add_kind("cameras", node_holds(&Node::camera));
    add_kind("lights", node_holds(&Node::light));
    add_kind("skins", !prepared.scene.skins.empty());
    add_kind("material variants",
             std::any_of(prepared.scene.meshes.begin(), prepared.scene.meshes.end(),
                         [](const Mesh& mesh) { return !mesh.variant_materials.empty(); }));
    if (!kinds.empty()) notes.push_back(format + " holds no " + kinds + ": left out");
    if (const std::size_t count = prepared.scene.animations.size(); count > 0)
        notes.push_back(format + " holds no animations: " + std::to_string(count) + " left out");
}

void note_non_finite(const PreparedScene& prepared, const FormatHolds& holds,
                     std::vector<std::string>& notes) {
    const auto note = [&](const char* one, const char* several, std::size_t count) {
        if (count > 0)
            notes.push_back(std::to_string(count) + (count == 1 ? one : several) +
                            " not finite and written so: many programs refuse the file");
    };
    const auto count_in = [](const auto& values) {
        std::size_t count = 0;
        for (const auto& v : values) count += !is_finite(v);
        return count;
    };
    std::size_t vertices = 0, uvs = 0, colors = 0;
    if (holds.corner_values) {
        for (const Mesh& mesh : prepared.scene.meshes) {
            vertices += count_in(mesh.positions);
            for (const CornerLayer<glm::vec2>& set : mesh.uvs)
                if (!set.empty()) {
                    uvs += count_in(set.values);
                    break;
                }
            if (!mesh.colors.empty()) colors += count_in(mesh.colors[0].values);
        }
    } else {
        for (const VertexMesh& mesh : prepared.meshes) {
            vertices += count_in(mesh.positions);
            for (const std::vector<glm::vec2>& set : mesh.uvs)
                if (!set.empty()) {
                    uvs += count_in(set);
                    break;
                }
            if (!mesh.colors.empty()) colors += count_in(mesh.colors[0]);
        }
    }
    note(" vertex is", " vertices are", vertices);
    if (holds.uvs) note(" UV is", " UVs are", uvs);
    if (holds.float_colors) note(" colour is", " colours are", colors);
}

Result<void> check_bits(const Quantization& quantization, const std::filesystem::path& path) {
    for (const QuantizationRow& row : quantization_rows)
        if (const int bits = quantization.*row.bits;
            bits != 0 && (bits < row.least || bits > row.most))
            return Error{ErrorCode::invalid,
                         std::string(row.name) + " are quantised to " + std::to_string(row.least) +
                             " to " + std::to_string(row.most) + " bits, not " +
                             std::to_string(bits),
                         path.string()};
    return {};
}

}  // namespace
}  // namespace detail

Result<std::vector<std::string>> save_scene(const PreparedScene& prepared,
                                            const std::filesystem::path& path,
                                            const SaveOptions& options) {
    const std::string ending = lower_ending(path);
    const detail::Format* const format = detail::format_that_writes(ending);
    if (!format)
        return Error{
            ErrorCode::unsupported,
            "cannot write '" + ending + "': " + detail::format_titles(true) + " are written",
            path.string()};
    if (!format->holds.compression &&
        (options.compression == Compression::draco || options.compression == Compression::meshopt))
        return Error{ErrorCode::unsupported,
                     "the compression " + std::string(name_of(options.compression)) +
                         " is one of glTF files: write .glb or .gltf, or leave it out",
                     path.string()};
    const auto& nodes = prepared.scene.nodes;
    if (!format->holds.everything && !prepared.scene.meshes.empty() &&
        std::none_of(nodes.begin(), nodes.end(),
                     [](const Node& node) { return node.mesh != no_index; }))
        return Error{ErrorCode::invalid,
                     "the file's scene shows no mesh: nothing would be in the output; glTF files "
                     "keep what no node shows",
                     path.string()};
    if (!format->holds.triangle_order && detail::is_reordered(prepared))
        return Error{ErrorCode::unsupported,
                     std::string(format->file.name) +
                         " files hold polygons in the order of the input: --optimize is for glTF; "
                         "write .glb or .gltf, or leave it out",
                     path.string()};
    if (!format->holds.compression && options.quantization.any())
        return Error{ErrorCode::unsupported,
                     "quantised attributes are those of glTF files: write .glb or .gltf, or leave "
                     "the quantisation out",
                     path.string()};
    if (auto checked = detail::check_bits(options.quantization, path); !checked)
        return std::move(checked).error();
    auto notes = format->write(prepared, path, options);
    if (notes && !(format->holds.everything && prepared.scene.retained_file))
        detail::note_loose_parts(prepared, *notes);
    if (notes && format->holds.uvs && !format->holds.partial_uvs &&
        !(format->holds.everything && prepared.scene.retained_file))
        detail::note_missing_uvs(prepared, std::string(format->file.name), *notes);
    if (notes && !format->holds.subdivision)
        detail::note_subdivision(prepared, std::string(format->file.name), *notes);
    if (notes && !format->holds.everything) {
        const std::string name(format->file.name);
        detail::note_lost(prepared, name, format->holds, *notes);
        detail::note_non_finite(prepared, format->holds, *notes);
    }
    return notes;
}

Result<GlbBytes> save_glb(const PreparedScene& prepared, const SaveOptions& options) {
    if (auto checked = detail::check_bits(options.quantization, {}); !checked)
        return std::move(checked).error();
    GlbBytes out;
    const auto glb = detail::encode_glb(prepared, out.notes, options);
    if (!glb) return glb.error();
    const auto parts = glb->parts();
    std::size_t size = 0;
    for (const auto& part : parts) size += part.size();
    out.bytes.reserve(size);
    for (const auto& part : parts) out.bytes.insert(out.bytes.end(), part.begin(), part.end());
    return out;
}

}  // namespace prep
