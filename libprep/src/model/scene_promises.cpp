#include "model/scene_promises.h"

#include <algorithm>

namespace prep {
namespace detail {
namespace {

using Index = std::uint32_t;

bool below(const std::vector<Index>& list, std::size_t count) {
    return std::all_of(list.begin(), list.end(), [&](Index i) { return i < count; });
}
bool below_or_none(Index i, std::size_t count) {
    return i == no_index || i < count;
}
bool below_or_none(const std::vector<Index>& list, std::size_t count) {
    return std::all_of(list.begin(), list.end(), [&](Index i) { return below_or_none(i, count); });
}

// From 0 to `total` in steps of `least` or more.
bool are_offsets(const std::vector<Index>& list, std::size_t total, Index least) {
    if (list.empty() || list.front() != 0 || list.back() != total) return false;
    for (std::size_t i = 1; i < list.size(); ++i)
        if (list[i] < list[i - 1] || list[i] - list[i - 1] < least) return false;
    return true;
}

template <class T>
bool is_absent_or(const std::vector<T>& list, std::size_t size) {
    return list.empty() || list.size() == size;
}

template <class T>
bool is_layer(const CornerLayer<T>& layer, std::size_t corners) {
    return layer.empty() ||
           (layer.indices.size() == corners && below_or_none(layer.indices, layer.values.size()));
}

// Runs of differences: ascending, apart, within 32 bits.
bool are_runs(const std::vector<VertexDeltas>& runs) {
    std::uint64_t from = 0;
    for (const VertexDeltas& run : runs) {
        if (!run.values || run.first_vertex < from) return false;
        from = std::uint64_t(run.first_vertex) + run.values->size();
        if (from > no_index) return false;
    }
    return true;
}

// Vertices of the file that the mesh refers to.
std::size_t file_vertex_count(const Mesh& mesh) {
    std::size_t count = mesh.file_vertices.empty() ? mesh.vertex_count() : 0;
    for (const Index v : mesh.file_vertices) count = std::max(count, std::size_t(v) + 1);
    for (const Index v : mesh.corner_file_vertices) count = std::max(count, std::size_t(v) + 1);
    return count;
}

const char* broken_by_file_vertex(const Mesh& mesh) {
    if (!is_absent_or(mesh.file_vertices, mesh.vertex_count())) return "a vertex of the file";
    if (!is_absent_or(mesh.corner_file_vertices, mesh.corner_count()))
        return "a corner's vertex of the file";
    const std::size_t count = file_vertex_count(mesh);
    for (const MorphTarget& target : mesh.morph_targets)
        for (const auto* runs : {&target.positions, &target.normals, &target.tangents})
            if (!are_runs(*runs)) return "a morph target";
    for (const SkinInfluences& set : mesh.skin_influences)
        if (set.joints.size() != set.weights.size() || set.joints.size() < count)
            return "a set of joints";
    for (const VertexAttribute& a : mesh.vertex_attributes)
        if (a.width == 0 || (!a.values.empty() && a.values.size() / a.width < count))
            return "a vertex attribute";
    return nullptr;
}

const char* broken_in_mesh(const Mesh& mesh, const Scene& scene) {
    const std::size_t vertices = mesh.vertex_count(), corners = mesh.corner_count();
    const bool no_faces = mesh.face_offsets.empty() && corners == 0;  // as one that was moved from
    if (!no_faces && !are_offsets(mesh.face_offsets, corners, 3)) return "a face";
    const std::size_t faces = mesh.face_count();
    if (!below(mesh.corner_vertices, vertices)) return "a corner";
    if (!is_layer(mesh.normals, corners)) return "a normal";
    if (!is_layer(mesh.tangents, corners)) return "a tangent";
    for (const auto& layer : mesh.uvs)
        if (!is_layer(layer, corners)) return "a UV";
    for (const auto& layer : mesh.colors)
        if (!is_layer(layer, corners)) return "a colour";
    if (!is_absent_or(mesh.face_materials, faces) ||
        !below_or_none(mesh.face_materials, scene.materials.size()) ||
        !below(mesh.variant_materials, scene.materials.size()))
        return "a face's material";
    if (!is_absent_or(mesh.face_smoothing, faces)) return "a smoothing group";
    if (!is_absent_or(mesh.face_parts, faces) || !below_or_none(mesh.face_parts, mesh.parts.size()))
        return "a part";
    for (const glm::uvec2& mark : mesh.hard_marks)
        if (mark.x >= vertices || mark.y >= vertices) return "a mark";
    for (const EdgeMark& crease : mesh.subdivision.creases)
        if (crease.v0 >= vertices || crease.v1 >= vertices) return "a crease";
    for (const VertexMark& corner : mesh.subdivision.corners)
        if (corner.vertex >= vertices) return "a sharp vertex";
    if (!below(mesh.subdivision.holes, faces)) return "a hole";
    if (!are_offsets(mesh.line_offsets, mesh.line_vertices.size(), 2) ||
        !below(mesh.line_vertices, vertices))
        return "a line";
    if (!below(mesh.points, vertices)) return "a point";
    if (!is_absent_or(mesh.vertex_colors, vertices)) return "a vertex colour";
    return broken_by_file_vertex(mesh);
}

// Each node is walked over once; a walk that meets itself is a cycle. O(nodes).
bool parents_end(const std::vector<Node>& nodes) {
    std::vector<Index> walk(nodes.size(), no_index);
    for (Index start = 0; start < nodes.size(); ++start) {
        Index n = start;
        for (; n != no_index && walk[n] == no_index; n = nodes[n].parent) walk[n] = start;
        if (n != no_index && walk[n] == start) return false;
    }
    return true;
}

const char* broken_in_nodes(const Scene& scene) {
    const std::size_t count = scene.nodes.size();
    for (const Node& node : scene.nodes)
        if (!below_or_none(node.parent, count) || !below_or_none(node.mesh, scene.meshes.size()) ||
            !below_or_none(node.camera, scene.cameras.size()) ||
            !below_or_none(node.light, scene.lights.size()) ||
            !below_or_none(node.skin, scene.skins.size()))
            return "a node";
    if (!parents_end(scene.nodes)) return "a node's parent";
    if (scene.active_camera != no_index &&
        (scene.active_camera >= count || scene.nodes[scene.active_camera].camera == no_index))
        return "the camera";
    for (const Skin& skin : scene.skins)
        if (!below(skin.joints, count) || skin.inverse_bind.size() != skin.joints.size())
            return "a joint";
    return nullptr;
}

// Numbers to a key; 0: any whole number of them.
std::size_t width_of(AnimationPath path) {
    return path == AnimationPath::rotation                                      ? 4
           : path == AnimationPath::translation || path == AnimationPath::scale ? 3
                                                                                : 0;
}

const char* broken_in_animations(const Scene& scene) {
    for (const Animation& animation : scene.animations) {
        for (const AnimationSampler& sampler : animation.samplers)
            if (!sampler.times != !sampler.values) return "a key";
        for (const AnimationChannel& channel : animation.channels) {
            if (channel.sampler >= animation.samplers.size() ||
                !below_or_none(channel.node, scene.nodes.size()))
                return "a channel";
            const AnimationSampler& sampler = animation.samplers[channel.sampler];
            if (!sampler.times || channel.path == AnimationPath::other) continue;
            const std::size_t keys = sampler.times->size() *
                                     (sampler.interpolation == Interpolation::cubic_spline ? 3 : 1);
            const std::size_t values = sampler.values->size(), width = width_of(channel.path);
            if (width > 0 ? values != keys * width : keys > 0 && values % keys != 0) return "a key";
        }
    }
    return nullptr;
}

bool broken_in_image(const ImageRef& image) {
    if (image.channels.size() > 4) return true;
    for (const PackedChannel& channel : image.channels)
        if (channel.channel > PackedChannel::opacity ||
            (channel.source && broken_in_image(*channel.source)))
            return true;
    return false;
}

}  // namespace

const char* broken_promise(const Scene& scene) {
    for (const ImageRef& image : scene.images)
        if (broken_in_image(image)) return "a picture's channels";
    for (const Mesh& mesh : scene.meshes)
        if (const char* const broken = broken_in_mesh(mesh, scene)) return broken;
    for (const Texture& texture : scene.textures)
        if (!below_or_none(texture.image, scene.images.size())) return "a texture";
    for (const Material& material : scene.materials)
        for (const MaterialMap& map : material_maps)
            if (!below_or_none((material.*map.ref).texture, scene.textures.size()))
                return "a material's map";
    if (const char* const broken = broken_in_nodes(scene)) return broken;
    return broken_in_animations(scene);
}

}  // namespace detail

Result<void> require_consistent(const Scene& scene) {
    const char* const broken = detail::broken_promise(scene);
    if (!broken) return {};
    return Error{ErrorCode::invalid,
                 std::string(broken) + " has an index, a size or an offset that is not possible",
                 "scene"};
}

}  // namespace prep
