// The table of features and scenes: what a scene holds, by looking at it.
#include <algorithm>
#include <cmath>

#include "prep/image.h"
#include "random_scenes.h"

namespace test {
namespace {

using prep::LightKind;
using prep::Material;
using prep::Mesh;
using prep::Scene;

template <class Test>
bool any_mesh(const Scene& s, const Test& test) {
    return std::any_of(s.meshes.begin(), s.meshes.end(), test);
}

// Of the materials that some face has.
template <class Test>
bool any_material(const Scene& s, const Test& test) {
    return any_mesh(s, [&](const Mesh& mesh) {
        return std::any_of(mesh.face_materials.begin(), mesh.face_materials.end(),
                           [&](std::uint32_t m) { return test(s.materials[m]); });
    });
}

template <class Test>
bool any_light(const Scene& s, const Test& test) {
    return std::any_of(s.lights.begin(), s.lights.end(), test);
}
template <LightKind kind>
bool has_light(const Scene& s) {
    return any_light(s, [](const prep::Light& l) { return l.kind == kind; });
}

template <prep::MapKind kind>
bool has_map(const Scene& s) {
    return any_material(
        s, [](const Material& m) { return bool(m.*prep::material_maps[std::size_t(kind)].ref); });
}

bool masked(const Material& m) {
    return m.alpha_mode == prep::AlphaMode::mask;
}
float least_alpha(const Scene& s, const prep::TextureRef& map) {
    const auto image = prep::load_image(s.images[s.textures[map.texture].image]);
    if (!image) return 1;
    float least = 1;
    for (std::size_t i = 3; image->channels == 4 && i < image->pixels.size(); i += 4)
        least = std::min(least, image->pixels[i]);
    return least;
}
bool is_flat(const Scene& s, const prep::TextureRef& map) {
    const auto image = prep::load_image(s.images[s.textures[map.texture].image]);
    if (!image || image->channels < 3) return false;
    for (std::size_t i = 0; i < image->pixels.size(); i += image->channels)
        if (image->pixels[i] != 0.5f || image->pixels[i + 1] != 0.5f || image->pixels[i + 2] != 1)
            return false;
    return true;
}

constexpr SceneFeature features[] = {
    {"points alone",
     [](const Scene& s) { return any_mesh(s, [](const Mesh& m) { return m.face_count() == 0; }); }},
    {"triangles",
     [](const Scene& s) {
         return any_mesh(s, [](const Mesh& m) {
             return m.face_count() > 0 && m.corner_count() == 3 * m.face_count();
         });
     }},
    {"quads",
     [](const Scene& s) {
         return any_mesh(s, [](const Mesh& m) { return m.corner_count() == 4 * m.face_count(); });
     }},
    {"corners that coincide",
     [](const Scene& s) {
         return any_mesh(s, [](const Mesh& m) {
             for (std::size_t f = 0; f < m.face_count(); ++f)
                 for (std::uint32_t c = m.face_offsets[f]; c + 1 < m.face_offsets[f + 1]; ++c)
                     if (m.corner_vertices[c] == m.corner_vertices[c + 1]) return true;
             return false;
         });
     }},
    {"positions that are not finite",
     [](const Scene& s) {
         return any_mesh(s, [](const Mesh& m) {
             return std::any_of(m.positions.begin(), m.positions.end(),
                                [](const glm::vec3& p) { return !std::isfinite(p.x); });
         });
     }},
    {"no UVs",
     [](const Scene& s) {
         return any_mesh(s, [](const Mesh& m) { return m.face_count() > 0 && m.uvs.empty(); });
     }},
    {"two UV sets",
     [](const Scene& s) { return any_mesh(s, [](const Mesh& m) { return m.uvs.size() == 2; }); }},
    {"vertex colours",
     [](const Scene& s) { return any_mesh(s, [](const Mesh& m) { return !m.colors.empty(); }); }},
    {"authored normals",
     [](const Scene& s) { return any_mesh(s, [](const Mesh& m) { return !m.normals.empty(); }); }},
    {"faces without a material",
     [](const Scene& s) {
         return any_mesh(
             s, [](const Mesh& m) { return m.face_count() > 0 && m.face_materials.empty(); });
     }},
    {"several materials on a mesh",
     [](const Scene& s) {
         return any_mesh(s, [](const Mesh& m) {
             return std::adjacent_find(m.face_materials.begin(), m.face_materials.end(),
                                       std::not_equal_to<>()) != m.face_materials.end();
         });
     }},
    {"a mesh placed twice",
     [](const Scene& s) {
         std::vector<int> count(s.meshes.size());
         for (const prep::Node& n : s.nodes)
             if (n.mesh != prep::no_index && ++count[n.mesh] > 1) return true;
         return false;
     }},
    {"mirrored",
     [](const Scene& s) {
         return std::any_of(s.nodes.begin(), s.nodes.end(), [](const prep::Node& n) {
             return glm::determinant(glm::dmat3(n.transform)) < 0;
         });
     }},
    {"flattened",
     [](const Scene& s) {
         return std::any_of(s.nodes.begin(), s.nodes.end(), [](const prep::Node& n) {
             return glm::determinant(glm::dmat3(n.transform)) == 0;
         });
     }},
    {"unlit",
     [](const Scene& s) { return any_material(s, [](const Material& m) { return m.unlit; }); }},
    {"metallic-roughness",
     [](const Scene& s) {
         return any_material(s, [](const Material& m) { return m.metallic_roughness; });
     }},
    {"no highlights (k_s = 0)",
     [](const Scene& s) {
         return any_material(s, [](const Material& m) {
             return !m.unlit && !m.metallic_roughness && m.specular == glm::vec3(0);
         });
     }},
    {"glowing",
     [](const Scene& s) {
         return any_material(s, [](const Material& m) { return m.emissive != glm::vec3(0); });
     }},
    {"double-sided",
     [](const Scene& s) {
         return any_material(s, [](const Material& m) { return m.double_sided; });
     }},
    {"blended",
     [](const Scene& s) {
         return any_material(
             s, [](const Material& m) { return m.alpha_mode == prep::AlphaMode::blend; });
     }},
    {"mask that cuts",
     [](const Scene& s) {
         return any_material(s, [&](const Material& m) {
             return masked(m) && m.diffuse_map && least_alpha(s, m.diffuse_map) < 0.05f;
         });
     }},
    {"mask that never cuts, with a map",
     [](const Scene& s) {
         return any_material(s, [&](const Material& m) {
             return masked(m) && m.diffuse_map && m.diffuse.a == 1 &&
                    least_alpha(s, m.diffuse_map) > m.alpha_cutoff + 0.01f;
         });
     }},
    {"alpha exactly at the cutoff",
     [](const Scene& s) {
         return any_material(s, [](const Material& m) {
             return masked(m) && !m.diffuse_map && m.diffuse.a == m.alpha_cutoff;
         });
     }},
    {"diffuse map", has_map<prep::MapKind::diffuse>},
    {"specular map", has_map<prep::MapKind::specular>},
    {"emissive map", has_map<prep::MapKind::emissive>},
    {"occlusion map", has_map<prep::MapKind::occlusion>},
    {"normal map", has_map<prep::MapKind::normal>},
    {"metallic-roughness map", has_map<prep::MapKind::metallic_roughness>},
    {"bump map", has_map<prep::MapKind::bump>},
    {"displacement map", has_map<prep::MapKind::displacement>},
    {"layer normal map", has_map<prep::MapKind::layer_normal>},
    {"anisotropy map", has_map<prep::MapKind::anisotropy>},
    {"anisotropy without a map",
     [](const Scene& s) {
         return any_material(
             s, [](const Material& m) { return m.anisotropy != 0 && !m.anisotropy_map; });
     }},
    {"normal map that is (0, 0, 1)",
     [](const Scene& s) {
         return any_material(s, [&](const Material& m) {
             return m.normal_map && is_flat(s, m.normal_map) &&
                    m.normal_map_space == prep::NormalMapSpace::tangent;
         });
     }},
    {"normal map of strength 0",
     [](const Scene& s) {
         return any_material(
             s, [](const Material& m) { return m.normal_map && m.normal_map.strength == 0; });
     }},
    {"object-space normal map",
     [](const Scene& s) {
         return any_material(s, [](const Material& m) {
             return m.normal_map && m.normal_map_space == prep::NormalMapSpace::object;
         });
     }},
    {"map on the second UV set",
     [](const Scene& s) {
         return any_material(
             s, [](const Material& m) { return m.diffuse_map && m.diffuse_map.uv_set == 1; });
     }},
    {"map on a UV set that is missing",
     [](const Scene& s) {
         return any_material(s, [](const Material& m) {
             return std::any_of(std::begin(prep::material_maps), std::end(prep::material_maps),
                                [&](const prep::MaterialMap& map) {
                                    return m.*map.ref && (m.*map.ref).uv_set > 1;
                                });
         });
     }},
    {"map moved and turned",
     [](const Scene& s) {
         return any_material(
             s, [](const Material& m) { return m.diffuse_map && m.diffuse_map.rotation != 0; });
     }},
    {"picture that cannot be read", [](const Scene& s) { return s.textures.size() > 7; }},
    {"normal map that cannot be read",
     [](const Scene& s) {
         return any_material(s, [](const Material& m) { return m.normal_map.texture == 7; });
     }},
    {"no lights of its own", [](const Scene& s) { return s.lights.empty(); }},
    {"ambient light alone",
     [](const Scene& s) {
         return !s.lights.empty() &&
                !any_light(s, [](const prep::Light& l) { return l.kind != LightKind::ambient; });
     }},
    {"ambient light", has_light<LightKind::ambient>},
    {"directional light", has_light<LightKind::directional>},
    {"point light", has_light<LightKind::point>},
    {"spot light", has_light<LightKind::spot>},
    {"light of a range",
     [](const Scene& s) { return any_light(s, [](const prep::Light& l) { return l.range > 0; }); }},
    {"light out of its range",
     [](const Scene& s) {
         return std::any_of(s.nodes.begin(), s.nodes.end(), [&](const prep::Node& n) {
             return n.light != prep::no_index && s.lights[n.light].range > 0 &&
                    glm::length(glm::dvec3(n.transform[3])) > s.lights[n.light].range + 12;
         });
     }},
    {"spot light turned away",
     [](const Scene& s) {
         return std::any_of(s.nodes.begin(), s.nodes.end(), [&](const prep::Node& n) {
             return n.light != prep::no_index && s.lights[n.light].kind == LightKind::spot &&
                    glm::dot(glm::dvec3(n.transform[2]), glm::dvec3(n.transform[3])) < 0;
         });
     }},
    {"black light",
     [](const Scene& s) {
         return any_light(s, [](const prep::Light& l) { return l.color == glm::vec3(0); });
     }},
    {"perspective camera",
     [](const Scene& s) { return !s.cameras.empty() && s.cameras[0].perspective; }},
    {"orthographic camera",
     [](const Scene& s) { return !s.cameras.empty() && !s.cameras[0].perspective; }},
    {"camera among the triangles",
     [](const Scene& s) {
         return s.active_camera != prep::no_index && s.nodes[s.active_camera].transform[3].z < 1.5;
     }},
};

}  // namespace

std::span<const SceneFeature> scene_features() {
    return features;
}

std::string coverage_table(std::span<const Scene> scenes) {
    std::string table;
    for (const SceneFeature& feature : features) {
        std::size_t count = 0;
        std::string first;
        for (const Scene& scene : scenes) {
            if (!feature.in(scene)) continue;
            if (++count <= 5) first += " " + scene.name;
        }
        std::string name = feature.name;
        name.resize(std::max<std::size_t>(name.size(), 36), ' ');
        table += name + std::to_string(count) + " of " + std::to_string(scenes.size()) +
                 ": scenes" + first + (count > 5 ? " …" : "") + "\n";
    }
    return table;
}

}  // namespace test
