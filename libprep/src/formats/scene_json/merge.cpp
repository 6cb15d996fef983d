#include "formats/scene_json/merge.h"

#include <algorithm>

#include "text/name_list.h"

namespace prep::detail {
namespace {

template <class T>
void append(std::vector<T>& into, std::vector<T>&& from) {
    into.insert(into.end(), std::make_move_iterator(from.begin()),
                std::make_move_iterator(from.end()));
}

void shift(std::uint32_t& index, std::size_t by) {
    if (index != no_index) index += static_cast<std::uint32_t>(by);
}

}  // namespace

MergedPart merge_scene(Scene& into, Scene&& part, const std::string& name, ReadFiles& files) {
    // A glTF file says itself which of its meshes its scene shows, unless it is a mere collection.
    if (!part.retained_file || part.nodes.empty()) instance_unused_meshes(part);
    std::string left;
    const auto leave = [&left](bool present, const char* what) {
        if (present) left += (left.empty() ? "" : ", ") + std::string(what);
    };
    leave(!part.lights.empty(), "lights");
    leave(!part.cameras.empty(), "cameras");
    leave(!part.skins.empty(), "skins");
    leave(!part.animations.empty(), "animations");
    leave(morph_target_count(part) > 0, "morph targets");
    leave(std::any_of(part.meshes.begin(), part.meshes.end(),
                      [](const Mesh& mesh) { return !mesh.vertex_attributes.empty(); }),
          "attributes of other names");
    leave(std::any_of(part.meshes.begin(), part.meshes.end(),
                      [](const Mesh& mesh) { return !mesh.variant_materials.empty(); }),
          "variants of materials");
    if (!left.empty())
        into.warnings.push_back("mesh '" + name + "': the file's own " + left +
                                " are not part of the scene");
    NameList beyond;
    for (const std::string& extension : extensions_beyond_materials(part)) beyond.add(extension);
    if (!beyond.empty())
        into.warnings.push_back("mesh '" + name + "': these extensions of the file's materials " +
                                "are not part of the scene: " + beyond.text());

    for (Texture& texture : part.textures) shift(texture.image, into.images.size());
    for (Material& material : part.materials)
        for (const MaterialMap& map : material_maps)
            shift((material.*map.ref).texture, into.textures.size());
    for (Mesh& mesh : part.meshes) {
        // They belong to the file that is left behind.
        mesh.morph_targets.clear();
        mesh.skin_influences.clear();
        mesh.vertex_attributes.clear();
        mesh.loose_parts_with_attributes = 0;
        mesh.tied_to_file = false;
        for (auto* list : {&mesh.face_materials, &mesh.variant_materials})
            for (std::uint32_t& material : *list) shift(material, into.materials.size());
    }

    MergedPart merged;
    merged.first_mesh = static_cast<std::uint32_t>(into.meshes.size());
    merged.mesh_count = static_cast<std::uint32_t>(part.meshes.size());
    merged.nodes = std::move(part.nodes);
    for (Node& node : merged.nodes) {
        shift(node.mesh, into.meshes.size());
        node.camera = node.light = node.skin = no_index;
    }
    // Each file once, however many meshes name it.
    const auto read = [&](std::filesystem::path file) {
        if (files.insert(file.native()).second) into.libraries.push_back(std::move(file));
    };
    if (!part.source.empty()) read(std::move(part.source));
    for (std::filesystem::path& library : part.libraries) read(std::move(library));
    into.library_missing |= part.library_missing;
    append(into.passed_over, std::move(part.passed_over));
    append(into.images, std::move(part.images));
    append(into.textures, std::move(part.textures));
    append(into.materials, std::move(part.materials));
    append(into.meshes, std::move(part.meshes));
    return merged;
}

void instance_part(Scene& scene, const MergedPart& part, std::uint32_t parent) {
    const std::size_t first = scene.nodes.size();
    for (const Node& node : part.nodes) {
        Node copy = node;
        if (copy.parent == no_index)
            copy.parent = parent;
        else
            shift(copy.parent, first);
        scene.nodes.push_back(std::move(copy));
    }
}

}  // namespace prep::detail
