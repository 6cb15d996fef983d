#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "geometry/tile.h"
#include "plan/sampled_maps.h"
#include "rast/render.h"
#include "shading/texture.h"

namespace rast {
namespace {

using prep::Material;
using prep::TextureRef;

// What the materials in use bring, over all instances.
struct SceneContents {
    std::set<std::uint32_t> materials;
    bool default_material = false;
    std::uint64_t triangles = 0, vertices = 0;
    bool normals_missing = false, tangents_missing = false;
};

SceneContents contents_of(const prep::PreparedScene& prepared) {
    SceneContents s;
    for (const prep::Node& node : prepared.scene.nodes) {
        if (node.mesh == prep::no_index) continue;
        const prep::VertexMesh& mesh = prepared.meshes[node.mesh];
        s.triangles += mesh.triangle_count();
        s.vertices += mesh.vertex_count();
        s.normals_missing |= mesh.triangle_count() > 0 && mesh.normals.empty();
        for (const prep::VertexMesh::Range& range : mesh.ranges) {
            if (range.material >= prepared.scene.materials.size()) {
                s.default_material = true;
                continue;
            }
            s.materials.insert(range.material);
            const Material& m = prepared.scene.materials[range.material];
            s.tangents_missing |= bool(m.normal_map) && mesh.tangents.empty() &&
                                  m.normal_map_space == prep::NormalMapSpace::tangent;
        }
    }
    return s;
}

class Planner {
  public:
    Planner(const prep::PreparedScene& prepared, const RenderRequest& request)
        : prepared_(prepared), contents_(contents_of(prepared)) {
        plan_.request = request;
        plan_.triangles = contents_.triangles;
        const std::size_t textures = prepared.scene.textures.size();
        plan_.textures_used.assign(textures, false);
        plan_.colour_textures.assign(textures, false);
    }

    RenderPlan run() {
        RenderRequest& r = plan_.request;
        if (!r.prune)
            r.keep_depth = r.keep_ids = r.keep_normals = r.keep_uvs = r.keep_barycentrics =
                r.keep_positions = true;
        camera();
        lights();
        shading();
        textures();
        variants();
        anti_aliasing();
        step("depth test", true, depth_reason());
        step("culling", plan_.request.cull != Cull::none, cull_reason());
        step("alpha blending", false,
             any([](const Material& m) { return m.alpha_mode == prep::AlphaMode::blend; })
                 ? "blended materials are drawn opaque by this renderer"
                 : "no material in use is blended");
        step("alpha mask",
             any([](const Material& m) { return m.alpha_mode == prep::AlphaMode::mask; }),
             any([](const Material& m) { return m.alpha_mode == prep::AlphaMode::mask; })
                 ? "a material in use cuts by alpha"
                 : "no material in use cuts by alpha");
        step("depth output", plan_.request.keep_depth,
             plan_.request.keep_depth ? "asked for" : "nothing reads it");
        step("triangle numbers output", plan_.request.keep_ids,
             plan_.request.keep_ids ? "asked for" : "nothing reads them");
        const auto output = [&](const char* name, bool kept) {
            step(name, kept, kept ? "asked for" : "nothing reads it");
        };
        output("normal output", plan_.request.keep_normals);
        output("UV output", plan_.request.keep_uvs);
        output("barycentric output", plan_.request.keep_barycentrics);
        output("position output", plan_.request.keep_positions);
        step("crop", plan_.request.crop.has_value(),
             plan_.request.crop ? "a part of the picture is asked for" : "the whole picture");
        memory();
        return std::move(plan_);
    }

  private:
    void step(std::string name, bool run, std::string reason) {
        plan_.steps.push_back({std::move(name), run, std::move(reason)});
    }

    void anti_aliasing() {
        const RenderRequest& r = plan_.request;
        const bool areas = r.coverage == Coverage::area;
        step("multisampling", r.samples > 1,
             r.samples > 1 ? std::to_string(r.samples) +
                                 " samples a pixel asked for; shaded once per triangle and pixel"
             : areas ? "exact areas take its place"
                     : "one sample a pixel asked for");
        step("exact areas", areas,
             areas ? "asked for: every triangle counts by what is seen of it"
                   : "samples decide what is seen");
        step("supersampling", r.supersample > 1,
             r.supersample > 1 ? "each pixel is the mean of " +
                                     std::to_string(r.supersample * r.supersample) + " finer ones"
                               : "none asked for");
    }

    // Bands are whole rows of tiles where that fits, so that no tile is drawn twice.
    void memory() {
        const RenderRequest& r = plan_.request;
        const std::uint64_t width = r.crop ? r.crop->width : r.width;
        const std::uint64_t height = r.crop ? r.crop->height : r.height;
        const bool bytes = r.pixels == PixelFormat::bytes && r.coverage != Coverage::area &&
                           r.supersample == 1;  // those two are made of floats first
        const std::uint64_t row =
            width * ((r.keep_color ? (bytes ? 4 : 16) : 0) + (r.keep_depth ? 4 : 0) +
                     (r.keep_ids ? 8 : 0) + (r.keep_normals ? 12 : 0) + (r.keep_uvs ? 8 : 0) +
                     (r.keep_barycentrics ? 12 : 0) + (r.keep_positions ? 12 : 0));
        constexpr std::uint64_t tile = detail::tile_size;
        std::uint64_t rows =
            std::max<std::uint64_t>(r.band_bytes / std::max<std::uint64_t>(row, 1), 1);
        if (rows > tile) rows = rows / tile * tile;
        plan_.band_rows = std::uint32_t(std::min(rows, height));
        const std::uint64_t geometry = contents_.vertices * sizeof(detail::VertexRecord) +
                                       contents_.triangles * sizeof(std::uint16_t);
        // Supersampled, a row of tiles of the finer picture at a time.
        const std::uint64_t factor = std::uint64_t(r.supersample);
        const std::uint64_t fine =
            factor > 1 ? 16 * width * factor * (tile + 2 * (factor - 1)) : 0;  // and what is left
        plan_.memory_estimate = height * row + fine + geometry;
        plan_.band_memory_estimate = plan_.band_rows * row + fine + geometry;
        step("bands", plan_.band_rows < height,
             plan_.band_rows < height
                 ? "the whole picture's pixels would take more than " +
                       std::to_string(r.band_bytes >> 20) +
                       " MiB: " + std::to_string(plan_.band_rows) + " rows are drawn at a time"
                 : "the whole picture's pixels take at most " + std::to_string(r.band_bytes >> 20) +
                       " MiB");
    }

    template <class Test>
    bool any(const Test& test) const {
        return std::any_of(contents_.materials.begin(), contents_.materials.end(),
                           [&](std::uint32_t m) { return test(prepared_.scene.materials[m]); });
    }

    void camera() {
        const prep::Scene& scene = prepared_.scene;
        const double aspect = double(plan_.request.width) / plan_.request.height;
        if (plan_.request.view) {
            plan_.view = *plan_.request.view;
            step("camera", true, "the view is given");
        } else if (scene.active_camera != prep::no_index) {
            plan_.view = camera_view(scene, scene.active_camera, aspect);
            step("camera", true, "camera '" + scene.nodes[scene.active_camera].name + "'");
        } else {
            OrbitOptions orbit;
            orbit.aspect = aspect;
            plan_.view = orbit_view(prepared_, orbit);
            step("camera", true, "the scene has none: the whole of it is framed");
        }
        plan_.view = bounded_view(prepared_, plan_.view);
        if (!(plan_.view.aspect > 0)) plan_.view.aspect = aspect;
    }

    void lights() {
        if (plan_.request.lights) {
            plan_.lights = *plan_.request.lights;
            step("lights", !plan_.lights.empty(), std::to_string(plan_.lights.size()) + " given");
            return;
        }
        plan_.lights = scene_lights(prepared_.scene);
        if (!plan_.lights.empty()) {
            step("lights", true, "the scene brings " + std::to_string(plan_.lights.size()));
            return;
        }
        plan_.lights = three_light_setup(plan_.view);
        step("lights", true, "the scene has none: key, fill, rim and ambient light are set up");
    }

    void shading() {
        Shading& shading = plan_.request.shading;
        const bool mapped = any([](const Material& m) { return bool(m.normal_map); });
        if (plan_.request.prune && shading == Shading::normal_mapped &&
            (!mapped || !plan_.request.textures)) {
            step("normal maps", false,
                 mapped ? "textures are switched off: shaded as Phong"
                        : "no material in use has a normal map: shaded as Phong");
            shading = Shading::phong;
        } else {
            step("normal maps", shading == Shading::normal_mapped,
                 shading == Shading::normal_mapped ? "a material in use has one"
                                                   : "the shading asked for does not read them");
        }
        if (shading != Shading::flat && contents_.normals_missing) {
            plan_.warnings.push_back(
                "some meshes carry no normals: they are shaded by their face normals");
        }
        if (shading == Shading::normal_mapped && contents_.tangents_missing)
            plan_.warnings.push_back(
                "some normal-mapped meshes carry no tangents: their maps are left out");
        step("vertex lighting", shading == Shading::gouraud,
             shading == Shading::gouraud ? "Gouraud: light is computed at vertices"
                                         : "light is computed at pixels");
        step("vertex normals", shading != Shading::flat,
             shading == Shading::flat ? "flat shading uses face normals" : "interpolated");
    }

    void textures() {
        bool colour_used = false, data_used = false;
        const auto use = [&](const TextureRef& ref, bool colour) {
            if (!ref || ref.texture >= plan_.textures_used.size()) return;
            plan_.textures_used[ref.texture] = true;
            if (colour) plan_.colour_textures[ref.texture] = true;
            (colour ? colour_used : data_used) = true;
        };
        if (plan_.request.textures) {
            for (const std::uint32_t m : contents_.materials) {
                const Material& material = prepared_.scene.materials[m];
                for (const prep::MaterialMap& map : prep::material_maps) {
                    if (!detail::is_sampled(map, material, plan_.request.shading)) continue;
                    // Without colours, what is cut out still counts.
                    const bool cuts = map.kind == prep::MapKind::diffuse &&
                                      material.alpha_mode == prep::AlphaMode::mask;
                    const bool kept =
                        map.use == prep::MapUse::normals && plan_.request.keep_normals;
                    if (plan_.request.keep_color || cuts || kept) use(material.*map.ref, map.color);
                }
            }
        }
        const bool some = colour_used || data_used;
        const std::string none =
            plan_.request.textures ? "no material in use samples a texture" : "switched off";
        step("textures", some, some ? "sampled by materials in use" : none);
        step("sRGB decoding", colour_used,
             colour_used ? "colour textures are stored encoded" : "no colour texture is sampled");
        step("texture filter", some, some ? filter_reason() : none);
        const auto level_step = [&](const char* name, TextureLevels kind) {
            bool read = false;
            for (std::size_t t = 0; t < plan_.textures_used.size(); ++t)
                read |= plan_.textures_used[t] &&
                        levels_for(filter_of(t), prepared_.scene.textures[t].mip) == kind;
            step(name, read,
                 !some  ? none
                 : read ? "the filter reads them; each is made when a pixel first asks for it"
                        : "the filter does not read them");
        };
        level_step("mip levels", TextureLevels::mipmap);
        level_step("ripmap levels", TextureLevels::ripmap);
    }

    TextureFilter filter_of(std::size_t texture) const {
        return filter_for(plan_.request.filter, prepared_.scene.textures[texture]);
    }

    std::string filter_reason() const {
        if (plan_.request.filter != TextureFilter::by_sampler)
            return filter_text(plan_.request.filter);
        std::map<TextureFilter, std::size_t> found;
        for (std::size_t t = 0; t < plan_.textures_used.size(); ++t)
            if (plan_.textures_used[t]) ++found[filter_of(t)];
        if (found.size() == 1) return "by the samplers, " + filter_text(found.begin()->first);
        std::string text;
        for (const auto& [filter, count] : found)
            text += (text.empty() ? "by the samplers, " : "; ") + std::to_string(count) + " × " +
                    filter_text(filter);
        return text;
    }

    std::string filter_text(TextureFilter filter) const {
        const std::string most = std::to_string(plan_.request.max_anisotropy);
        switch (filter) {
            case TextureFilter::by_sampler:
                return "as no filter of another name: one to eight reads a sample";
            case TextureFilter::nearest:
                return "nearest texel: one read a sample";
            case TextureFilter::bilinear:
                return "bilinear: four reads a sample, first level only";
            case TextureFilter::nearest_mip:
                return "nearest mip: four reads on the mip level nearest to the footprint";
            case TextureFilter::trilinear:
                return "trilinear: four reads on each of two mip levels";
            case TextureFilter::bicubic:
                return "bicubic: 16 reads on each of two mip levels";
            case TextureFilter::anisotropic:
                return "anisotropic: up to " + most + " trilinear probes";
            case TextureFilter::ripmap:
                return "ripmap: up to four bilinear reads of levels halved along either axis";
            case TextureFilter::ewa:
                return "elliptical weighted average: ellipses up to " + most + " to 1";
        }
        return {};
    }

    // How the triangles of one range are shaded: what shade_draw() will bind.
    std::string variant_of(const prep::VertexMesh& mesh, std::uint32_t index) const {
        static const Material plain;
        const Material& m =
            index < prepared_.scene.materials.size() ? prepared_.scene.materials[index] : plain;
        const RenderRequest& r = plan_.request;
        const auto bound = [&](const TextureRef& ref) {
            return bool(ref) && r.textures && ref.uv_set < mesh.uvs.size() &&
                   !mesh.uvs[ref.uv_set].empty();
        };
        std::string name;
        const auto part = [&name](const std::string& text) {
            name += (name.empty() ? "" : ", ") + text;
        };
        if (m.unlit) {
            part("unlit");
        } else if (r.shading == Shading::flat || mesh.normals.empty()) {
            part("face normals");
        } else if (r.shading == Shading::gouraud) {
            part("light at vertices");
        } else if (r.shading == Shading::normal_mapped && bound(m.normal_map) &&
                   m.normal_map_space == prep::NormalMapSpace::object) {
            part("object-space normal map");
        } else if (r.shading == Shading::normal_mapped && bound(m.normal_map) &&
                   !mesh.tangents.empty()) {
            part("tangent-space normal map");
        } else {
            part("vertex normals");
        }
        if (!mesh.colors.empty()) part("vertex colours");
        const auto maps = [&](prep::MapUse use) {
            for (const prep::MaterialMap& map : prep::material_maps)
                if (map.use == use && detail::is_sampled(map, m, r.shading) && bound(m.*map.ref))
                    part(std::string(map.name) + " map");
        };
        maps(prep::MapUse::always);
        if (!m.unlit && m.metallic_roughness) part("metallic-roughness");
        for (const prep::MapUse use : {prep::MapUse::metallic_roughness, prep::MapUse::lit})
            maps(use);
        if (m.alpha_mode == prep::AlphaMode::mask) part("alpha mask");
        return name;
    }

    void variants() {
        std::map<std::string, std::uint64_t> triangles;
        for (const prep::Node& node : prepared_.scene.nodes) {
            if (node.mesh == prep::no_index) continue;
            const prep::VertexMesh& mesh = prepared_.meshes[node.mesh];
            for (const prep::VertexMesh::Range& range : mesh.ranges)
                if (range.triangle_count > 0)
                    triangles[variant_of(mesh, range.material)] += range.triangle_count;
        }
        for (const auto& [name, count] : triangles) plan_.variants.push_back({name, count});
        std::stable_sort(
            plan_.variants.begin(), plan_.variants.end(),
            [](const PlanVariant& a, const PlanVariant& b) { return a.triangles > b.triangles; });
        std::string list;
        for (const PlanVariant& v : plan_.variants)
            list += (list.empty() ? "" : "; ") + v.name + " (" + std::to_string(v.triangles) +
                    (v.triangles == 1 ? " triangle)" : " triangles)");
        step("shading", plan_.request.keep_color && !plan_.variants.empty(),
             !plan_.request.keep_color ? "nothing reads colours"
             : plan_.variants.empty()  ? "there are no triangles"
                                       : list);
    }

    std::string depth_reason() const {
        switch (plan_.request.depth_format) {
            case DepthFormat::fixed16:
                return "fixed point of 16 bits asked for";
            case DepthFormat::fixed24:
                return "fixed point of 24 bits asked for";
            case DepthFormat::float32:
                break;
        }
        return "reversed float, which has its fine steps far away";
    }

    std::string cull_reason() const {
        switch (plan_.request.cull) {
            case Cull::none:
                return "switched off";
            case Cull::back:
                return "back faces are left out";
            case Cull::front:
                return "front faces are left out";
            case Cull::by_material:
                return "back faces are left out but for double-sided materials";
        }
        return {};
    }

    const prep::PreparedScene& prepared_;
    SceneContents contents_;
    RenderPlan plan_;
};

}  // namespace

prep::Result<RenderPlan> plan(const prep::PreparedScene& scene, const RenderRequest& request) {
    if (request.width == 0 || request.height == 0)
        return prep::Error{prep::ErrorCode::invalid, "the picture has no extent", ""};
    if (request.width > max_picture_extent || request.height > max_picture_extent)
        return prep::Error{prep::ErrorCode::limit,
                           "the picture is larger than " + std::to_string(max_picture_extent) +
                               " pixels a side, found " + std::to_string(request.width) + "x" +
                               std::to_string(request.height),
                           ""};
    if (request.crop) {
        const Crop& c = *request.crop;
        if (c.width == 0 || c.height == 0 || c.x > request.width || c.y > request.height ||
            c.width > request.width - c.x || c.height > request.height - c.y)
            return prep::Error{prep::ErrorCode::invalid,
                               "the crop must be a part of the picture of " +
                                   std::to_string(request.width) + "x" +
                                   std::to_string(request.height) + ", found " +
                                   std::to_string(c.width) + "x" + std::to_string(c.height) +
                                   " at " + std::to_string(c.x) + ", " + std::to_string(c.y),
                               ""};
    }
    if (request.max_anisotropy < 1 || request.max_anisotropy > 16)
        return prep::Error{prep::ErrorCode::invalid,
                           "anisotropy is 1 to 16, found " + std::to_string(request.max_anisotropy),
                           ""};
    const int samples = request.samples;
    if (samples != 1 && samples != 2 && samples != 4 && samples != 8 && samples != 16)
        return prep::Error{prep::ErrorCode::invalid,
                           "a pixel has 1, 2, 4, 8 or 16 samples, found " + std::to_string(samples),
                           ""};
    if (request.supersample < 1 || request.supersample > max_supersample)
        return prep::Error{prep::ErrorCode::invalid,
                           "supersampling is 1 to " + std::to_string(max_supersample) +
                               " pixels each way, found " + std::to_string(request.supersample),
                           ""};
    if (request.coverage == Coverage::area && samples != 1)
        return prep::Error{
            prep::ErrorCode::invalid,
            "exact areas take the place of samples: ask for 1 sample a pixel, found " +
                std::to_string(samples),
            ""};
    const std::uint32_t most = max_picture_extent / std::uint32_t(request.supersample);
    if (request.width > most || request.height > most)
        return prep::Error{prep::ErrorCode::limit,
                           "supersampled " + std::to_string(request.supersample) +
                               " times, a picture is at most " + std::to_string(most) +
                               " pixels a side, found " + std::to_string(request.width) + "x" +
                               std::to_string(request.height),
                           ""};
    return Planner(scene, request).run();
}

}  // namespace rast
