// The members of everything in a scene, each list once: whoever writes scenes as bytes and whoever
// reads them goes over the same. A member that is not listed does not compile.
#pragma once

#include <type_traits>

#include "contained/member_count.h"
#include "prep/scene.h"

namespace prep::detail {

// A member that does not go over; its place is counted.
struct LeftOut {};

// `list(members…)` for a value of struct T, constant or not.
template <class T, class List, class... Members>
void all_members(List& list, Members&&... members) {
    static_assert(sizeof...(Members) == member_count<std::remove_const_t<T>>(),
                  "a member of this struct is missing in its list");
    (list(std::forward<Members>(members)), ...);
}

template <class T, class Struct>
concept Is = std::is_same_v<std::remove_const_t<T>, Struct>;

template <class List, class V>
void fields(List& list, CornerLayer<V>& t) {
    all_members<CornerLayer<V>>(list, t.values, t.indices);
}
template <class List, class V>
void fields(List& list, const CornerLayer<V>& t) {
    all_members<CornerLayer<V>>(list, t.values, t.indices);
}

template <class List, Is<EdgeMark> T>
void fields(List& list, T& t) {
    all_members<T>(list, t.v0, t.v1, t.sharpness);
}

template <class List, Is<VertexMark> T>
void fields(List& list, T& t) {
    all_members<T>(list, t.vertex, t.sharpness);
}

template <class List, Is<SubdivisionTags> T>
void fields(List& list, T& t) {
    all_members<T>(list, t.creases, t.corners, t.holes, t.interpolate_boundary,
                   t.face_varying_boundary);
}

template <class List, Is<VertexDeltas> T>
void fields(List& list, T& t) {
    all_members<T>(list, t.first_vertex, t.values);
}

template <class List, Is<MorphTarget> T>
void fields(List& list, T& t) {
    all_members<T>(list, t.positions, t.normals, t.tangents, t.name, t.weight);
}

template <class List, Is<SkinInfluences> T>
void fields(List& list, T& t) {
    all_members<T>(list, t.joints, t.weights);
}

template <class List, Is<VertexAttribute> T>
void fields(List& list, T& t) {
    all_members<T>(list, t.name, t.width, t.values);
}

template <class List, Is<Mesh> T>
void fields(List& list, T& t) {
    all_members<T>(list, t.name, t.origin, t.positions, t.file_vertices, t.face_offsets,
                   t.corner_vertices, t.corner_file_vertices, t.normals, t.tangents, t.uvs,
                   t.colors, t.face_materials, t.variant_materials, t.face_smoothing,
                   t.smoothing_kind, t.face_parts, t.parts, t.morph_targets, t.skin_influences,
                   t.vertex_attributes, t.indexed_by_vertex, t.tied_to_file, t.hard_marks,
                   t.subdivision, t.line_offsets, t.line_vertices, t.points, t.vertex_colors,
                   t.loose_parts_with_attributes);
}

template <class List, Is<Trs> T>
void fields(List& list, T& t) {
    all_members<T>(list, t.translation, t.rotation, t.scale);
}

template <class List, Is<Node> T>
void fields(List& list, T& t) {
    all_members<T>(list, t.name, t.parent, t.transform, t.trs, t.mesh, t.camera, t.light, t.skin);
}

template <class List, Is<TextureRef> T>
void fields(List& list, T& t) {
    all_members<T>(list, t.texture, t.uv_set, t.offset, t.scale, t.rotation, t.strength);
}

template <class List, Is<Material> T>
void fields(List& list, T& t) {
    all_members<T>(list, t.name, t.ambient, t.diffuse, t.specular, t.shininess, t.emissive,
                   t.diffuse_map, t.specular_map, t.emissive_map, t.occlusion_map, t.normal_map,
                   t.bump_map, t.displacement_map, t.normal_map_space, t.normal_map_flip_green,
                   t.displacement_scale, t.displacement_midlevel, t.displacement_kind, t.unlit,
                   t.reflectance, t.clearcoat, t.clearcoat_roughness, t.sheen, t.sheen_roughness,
                   t.anisotropy_rotation, t.layer_normal_map, t.anisotropy_map, t.anisotropy,
                   t.metallic_roughness, t.metallic, t.roughness, t.metallic_roughness_map,
                   t.alpha_mode, t.alpha_cutoff, t.double_sided);
}

template <class List, Is<Texture> T>
void fields(List& list, T& t) {
    all_members<T>(list, t.image, t.wrap_u, t.wrap_v, t.mag, t.min, t.mip);
}

template <class List, Is<PackedChannel> T>
void fields(List& list, T& t) {
    all_members<T>(list, t.source, t.channel, t.inverted, t.value);
}

template <class List, Is<ImageRef> T>
void fields(List& list, T& t) {
    all_members<T>(list, t.name, t.path, t.bytes, t.read_from, t.mime_type, t.channels,
                   LeftOut{} /* options */);
}

template <class List, Is<Light> T>
void fields(List& list, T& t) {
    all_members<T>(list, t.name, t.kind, t.color, t.intensity, t.range, t.inner_cone, t.outer_cone);
}

template <class List, Is<Camera> T>
void fields(List& list, T& t) {
    all_members<T>(list, t.name, t.perspective, t.yfov, t.aspect, t.xmag, t.ymag, t.znear, t.zfar);
}

template <class List, Is<Skin> T>
void fields(List& list, T& t) {
    all_members<T>(list, t.name, t.joints, t.inverse_bind);
}

template <class List, Is<AnimationSampler> T>
void fields(List& list, T& t) {
    all_members<T>(list, t.interpolation, t.times, t.values);
}

template <class List, Is<AnimationChannel> T>
void fields(List& list, T& t) {
    all_members<T>(list, t.sampler, t.node, t.path);
}

template <class List, Is<Animation> T>
void fields(List& list, T& t) {
    all_members<T>(list, t.name, t.samplers, t.channels);
}

template <class List, Is<Placement> T>
void fields(List& list, T& t) {
    all_members<T>(list, t.file_unit, t.file_unit_source, t.scale, t.up);
}

// What our own readers keep of their files never leaves the process: none of them is contained.
template <class List, Is<Scene> T>
void fields(List& list, T& t) {
    all_members<T>(list, t.name, t.source, t.libraries, t.library_missing, t.passed_over, t.meshes,
                   t.nodes, t.materials, t.textures, t.images, t.lights, t.cameras, t.skins,
                   t.animations, t.active_camera, t.placement, LeftOut{} /* retained_file */,
                   t.source_bytes, t.warnings, t.remarks);
}

}  // namespace prep::detail
