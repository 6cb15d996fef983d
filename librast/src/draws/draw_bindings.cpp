#include "draws/draw_bindings.h"

#include <algorithm>
#include <cmath>

#include "plan/draw_choice.h"

namespace rast::detail {
namespace {

void copy3(const glm::dvec3& from, float to[3]) {
    for (int k = 0; k < 3; ++k) to[k] = float(from[k]);
}

// Maps of one draw. Neutral ones are factors of 1, normals straight up, and slopes of 0.
class Binder {
  public:
    Binder(const RenderPlan& plan, const prep::VertexMesh& mesh, const TextureSet& textures,
           ShadeDraw& draw)
        : plan_(plan), mesh_(mesh), textures_(textures), draw_(draw) {}

    bool bind(MapKind kind, const prep::TextureRef& ref) {
        const std::size_t at = texture_slot(plan_.textures_read.size() / texture_uses, kind, ref);
        if (at >= textures_.size() || !textures_[at]) return false;
        MapPlace place;
        place.uv = &mesh_.uvs[ref.uv_set][0].x;
        const glm::vec2 units = textures_[at]->units();
        // KHR_texture_transform: offset + rotation · scale · uv; in the picture's own units.
        const double c = std::cos(double(ref.rotation)), s = std::sin(double(ref.rotation));
        place.matrix[0] = float(c * ref.scale.x) / units.x;
        place.matrix[1] = float(s * ref.scale.y) / units.x;
        place.matrix[2] = float(-s * ref.scale.x) / units.y;
        place.matrix[3] = float(c * ref.scale.y) / units.y;
        place.offset[0] = ref.offset.x / units.x;
        place.offset[1] = ref.offset.y / units.y;
        set(kind, *textures_[at], place, ref.strength);
        return true;
    }
    bool neutral(MapKind kind, std::size_t from_end) {
        if (plan_.request.prune || mesh_.uvs.empty() || mesh_.uvs[0].empty()) return false;
        MapPlace place;
        place.uv = &mesh_.uvs[0][0].x;
        set(kind, *textures_[textures_.size() - from_end], place, 1);
        return true;
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

    const RenderPlan& plan_;
    const prep::VertexMesh& mesh_;
    const TextureSet& textures_;
    ShadeDraw& draw_;
};

// The maps of the plan's choice. What cannot be read drops out; where nothing is to be left out, a
// neutral one takes the place of what is not there.
void bind_maps(const DrawChoice& choice, const prep::Material& material, Binder& binder,
               ShadeDraw& s) {
    for (const prep::MaterialMap& map : prep::material_maps) {
        if (map.use == prep::MapUse::not_drawn) break;
        const bool normals = map.kind == MapKind::normal;
        bool bound = choice.has(map.kind) && binder.bind(map.kind, material.*map.ref);
        if (!bound && (choice.could_be >> unsigned(map.kind) & 1u) != 0) {
            bound = binder.neutral(map.kind, normals                     ? flat_map
                                             : map.kind == MapKind::bump ? no_slopes
                                                                         : white_map);
            if (bound && normals) s.source = NormalSource::tangent_map;
        }
        if (!bound && normals && choice.has(map.kind)) s.source = NormalSource::interpolated;
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
    constant(0, 0);
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
    for (std::size_t l = 0; l < plan.lights.size(); ++l) {
        const LightInstance& light = plan.lights[l];
        if (plan.skips.light(l)) continue;
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
            if (light.range > 0) s.inv_range = 1 / light.range;
        }
        if (light.kind == prep::LightKind::spot) {
            // KHR_lights_punctual's falloff between the cones. Its sample code takes a difference
            // of at least 0.001: cones of less than 2.5 degrees would be dark on their axis, where
            // its text has all of the light. Here it is what floats of cosines tell apart.
            constexpr double least = 0x1p-20;
            const double outer = std::cos(double(light.outer_cone));
            const double scale = 1 / std::max(least, std::cos(double(light.inner_cone)) - outer);
            s.cone_scale = float(scale);
            s.cone_offset = float(-outer * scale);
        }
        out.lights.push_back(s);
    }
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
    const DrawChoice choice = choose(plan, consumer_of(plan), mesh, material, draw.material);
    s.masked = choice.masked;
    s.highlights = choice.highlights;
    s.unlit = material.unlit;
    s.source = choice.source;
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
    s.glows = material.emissive != glm::vec3(0.0f);
    s.alpha_cutoff = material.alpha_cutoff;
    s.flip_green = material.normal_map_flip_green;
    s.metallic_roughness = !material.unlit && material.metallic_roughness;
    s.metallic = material.metallic;
    s.roughness = material.roughness;
    copy3(glm::dvec3(material.reflectance), s.reflectance);
    Binder binder(plan, mesh, textures, s);
    bind_maps(choice, material, binder, s);
    binder.order();
    return s;
}

}  // namespace rast::detail
