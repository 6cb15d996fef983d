#include "draws/draw_bindings.h"

#include <algorithm>
#include <cmath>

#include "plan/sampled_maps.h"

namespace rast::detail {
namespace {

void copy3(const glm::dvec3& from, float to[3]) {
    for (int k = 0; k < 3; ++k) to[k] = float(from[k]);
}

// Maps of one draw. Where nothing is to be left out, those that a material does not have are
// neutral ones: factors of 1, and normals straight up.
class Binder {
  public:
    Binder(const RenderPlan& plan, const prep::VertexMesh& mesh, const TextureSet& textures,
           ShadeDraw& draw)
        : plan_(plan), mesh_(mesh), textures_(textures), draw_(draw) {}

    bool bind(MapKind kind, const prep::TextureRef& ref) {
        if (!ref || !plan_.request.textures || ref.texture >= textures_.size()) return false;
        if (!textures_[ref.texture] || ref.uv_set >= mesh_.uvs.size() ||
            mesh_.uvs[ref.uv_set].empty())
            return false;
        MapPlace place;
        place.uv = &mesh_.uvs[ref.uv_set][0].x;
        // KHR_texture_transform: offset + rotation · scale · uv.
        const double c = std::cos(double(ref.rotation)), s = std::sin(double(ref.rotation));
        place.matrix[0] = float(c * ref.scale.x);
        place.matrix[1] = float(s * ref.scale.y);
        place.matrix[2] = float(-s * ref.scale.x);
        place.matrix[3] = float(c * ref.scale.y);
        place.offset[0] = ref.offset.x;
        place.offset[1] = ref.offset.y;
        set(kind, *textures_[ref.texture], place, ref.strength);
        return true;
    }
    bool factor(MapKind kind, const prep::TextureRef& ref) {
        return bind(kind, ref) || neutral(kind, white_map);
    }
    bool normals(const prep::TextureRef& ref) {
        return bind(MapKind::normal, ref) || neutral(MapKind::normal, flat_map);
    }

    // Those that read the same texels next to each other.
    void order() {
        BoundMap* const maps = draw_.maps.of;
        bool taken[drawn_maps] = {};
        for (std::size_t first = 0; first < drawn_maps; ++first)
            for (std::size_t kind = first; kind < drawn_maps; ++kind) {
                BoundMap& map = maps[kind];
                if (!map || taken[kind] || !maps[first]) continue;
                if (kind != first && (!taken[first] || !alike(maps[first], map))) continue;
                if (kind != first && maps[first].same_texels) continue;
                map.same_texels = kind != first;
                draw_.used[draw_.used_count++] = MapKind(kind);
                taken[kind] = true;
            }
    }

  private:
    static bool alike(const BoundMap& a, const BoundMap& b) {
        return a.place == b.place && a.filter == b.filter &&
               have_same_texels(a.texture->view(), b.texture->view());
    }

    void set(MapKind kind, const MipTexture& texture, const MapPlace& place, float strength) {
        std::uint8_t at = 0;
        while (at < draw_.place_count && !(draw_.places[at] == place)) ++at;
        draw_.places[at] = place;
        draw_.place_count = std::max(draw_.place_count, std::uint8_t(at + 1));
        BoundMap& map = draw_.maps[kind];
        map.texture = &texture;
        map.place = at;
        map.filter = texture.filter_for(plan_.request.filter);
        map.most = plan_.request.max_anisotropy;
        map.strength = strength;
    }

    bool neutral(MapKind kind, std::size_t from_end) {
        if (plan_.request.prune || mesh_.uvs.empty() || mesh_.uvs[0].empty()) return false;
        MapPlace place;
        place.uv = &mesh_.uvs[0][0].x;
        set(kind, *textures_[textures_.size() - from_end], place, 1);
        return true;
    }

    const RenderPlan& plan_;
    const prep::VertexMesh& mesh_;
    const TextureSet& textures_;
    ShadeDraw& draw_;
};

// The material's maps and what depends on them.
void bind_maps(const RenderPlan& plan, const prep::Material& material, Binder& binder,
               ShadeDraw& s) {
    for (const prep::MaterialMap& map : prep::material_maps) {
        if (!is_sampled(map, material, plan.request.shading)) continue;
        const prep::TextureRef& ref = material.*map.ref;
        if (map.use != prep::MapUse::normals) {
            binder.factor(map.kind, ref);
        } else if (s.normals == nullptr) {
            continue;
        } else if (material.normal_map_space == prep::NormalMapSpace::object) {
            // A neutral map is one in tangent space.
            if (binder.bind(map.kind, ref)) s.source = NormalSource::object_map;
        } else if (s.tangents != nullptr) {
            if (binder.normals(ref)) s.source = NormalSource::tangent_map;
        }
    }
}

}  // namespace

void add_neutral_maps(TextureSet& textures, TextureLevels levels) {
    const auto constant = [&](float r, float g) {
        prep::Image image;
        image.width = image.height = 1;
        image.channels = 4;
        image.pixels = {r, g, 1, 1};
        textures.push_back(std::make_unique<MipTexture>(image, prep::Texture{}, false, levels));
    };
    constant(1, 1);
    constant(0.5f, 0.5f);
}

void set_up_frame(const RenderPlan& plan, FrameInputs& out) {
    ShadeFrame& frame = out.frame;
    frame = {};
    out.lights.clear();
    frame.perspective = plan.view.perspective;
    const glm::dmat3 to_world = glm::transpose(glm::dmat3(plan.view.world_to_view));
    copy3(to_world[2], frame.to_eye[0]);
    if (plan.view.perspective) {
        const double tangent = std::tan(plan.view.yfov / 2);
        const double aspect = plan.view.aspect > 0
                                  ? plan.view.aspect
                                  : double(plan.request.width) / plan.request.height;
        copy3(to_world[0] * (-tangent * aspect * 2 / plan.request.width), frame.to_eye[1]);
        copy3(to_world[1] * (tangent * 2 / plan.request.height), frame.to_eye[2]);
    }
    const glm::dvec3 eye = plan.view.eye();
    glm::dvec3 ambient(0);
    for (const LightInstance& light : plan.lights) {
        if (light.kind == prep::LightKind::ambient) {
            ambient += glm::dvec3(light.color);
            continue;
        }
        ShadeLight s;
        s.kind = light.kind;
        copy3(-light.direction, s.to_light);
        copy3(light.position - eye, s.position);
        copy3(glm::dvec3(light.color), s.color);
        if (light.kind != prep::LightKind::directional) {
            frame.needs_position = true;
            if (light.range > 0) s.inv_range = 1 / light.range;
        }
        if (light.kind == prep::LightKind::spot) {
            // KHR_lights_punctual's falloff between the cones.
            const double outer = std::cos(double(light.outer_cone));
            const double scale = 1 / std::max(0.001, std::cos(double(light.inner_cone)) - outer);
            s.cone_scale = float(scale);
            s.cone_offset = float(-outer * scale);
        }
        out.lights.push_back(s);
    }
    if (!plan.request.prune) frame.needs_position = true;
    copy3(ambient, frame.ambient);
    frame.lights = out.lights.data();
    frame.light_count = out.lights.size();
}

ShadeDraw shade_draw(const RenderPlan& plan, const prep::PreparedScene& scene, const Draw& draw,
                     const RenderInstance& instance, const TextureSet& textures) {
    static const prep::Material plain;
    const prep::VertexMesh& mesh = instance.mesh();
    const prep::Material& material =
        draw.material < scene.scene.materials.size() ? scene.scene.materials[draw.material] : plain;
    ShadeDraw s;
    s.source_vertices = &instance;
    s.indices = mesh.indices.data();
    s.records = instance.records.data();
    s.positions = &mesh.positions[0].x;
    if (!mesh.normals.empty()) s.normals = &mesh.normals[0].x;
    if (!mesh.tangents.empty()) s.tangents = &mesh.tangents[0].x;
    s.colors = instance.colors();
    s.first_triangle = draw.first_triangle;
    s.triangle_count = draw.triangle_count;
    s.masked = material.alpha_mode == prep::AlphaMode::mask;
    s.unlit = material.unlit;
    s.source = plan.request.shading == Shading::flat || s.normals == nullptr
                   ? NormalSource::face
                   : NormalSource::interpolated;
    for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c)
            s.normal_matrix[r * 3 + c] = float(instance.normal_matrix()[c][r]);
        for (int c = 0; c < 4; ++c) s.from_eye[r][c] = float(instance.from_eye()[c][r]);
    }
    s.world_normals = instance.normal_matrix() == glm::dmat3(1.0);
    copy3(glm::dvec3(material.ambient), s.ambient);
    for (int k = 0; k < 4; ++k) s.diffuse[k] = material.diffuse[k];
    copy3(glm::dvec3(material.specular), s.specular);
    copy3(glm::dvec3(material.emissive), s.emissive);
    // The map, where there is one, is applied per pixel; vertices get the factors.
    const float shininess =
        material.metallic_roughness
            ? prep::blinn_phong(glm::vec3(0), material.metallic, material.roughness).shininess
            : material.shininess;
    s.shininess = std::max(shininess, 0.0f);
    s.alpha_cutoff = material.alpha_cutoff;
    s.flip_green = material.normal_map_flip_green;
    s.metallic_roughness = !material.unlit && material.metallic_roughness;
    s.metallic = material.metallic;
    s.roughness = material.roughness;
    copy3(glm::dvec3(material.reflectance), s.reflectance);
    Binder binder(plan, mesh, textures, s);
    bind_maps(plan, material, binder, s);
    binder.order();
    return s;
}

}  // namespace rast::detail
