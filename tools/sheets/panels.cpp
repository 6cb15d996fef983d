#include "sheets/panels.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "sheets/edges.h"
#include "sheets/figures.h"
#include "sheets/overlay.h"
#include "sheets/shot.h"
#include "sheets/surfaces/cage_panels.h"
#include "sheets/surfaces/curvature.h"
#include "sheets/surfaces/tessellation_errors.h"
#include "sheets/test_patterns.h"

namespace report {
namespace {

using prep::Material;
using prep::no_index;
using prep::Result;

constexpr Color ink = rgb(0x1f2937);
constexpr Color tangent_color = rgb(0xdc2626);
constexpr Color bitangent_color = rgb(0x15803d);

// Root mean square over pixels that both pictures cover, in 8-bit levels; the largest too.
struct Difference {
    double rms = 0, largest = 0;
};
Difference difference(const prep::Image& a, const prep::Image& b) {
    double sum = 0, largest = 0;
    std::uint64_t count = 0;
    for (std::size_t i = 0; i + 3 < a.pixels.size(); i += 4) {
        if (!(a.pixels[i + 3] > 0) || !(b.pixels[i + 3] > 0)) continue;
        for (std::size_t k = 0; k < 3; ++k) {
            const double d = 255.0 * (a.pixels[i + k] - b.pixels[i + k]);
            sum += d * d;
            largest = std::max(largest, std::abs(d));
            ++count;
        }
    }
    return {count > 0 ? std::sqrt(sum / static_cast<double>(count)) : 0, largest};
}

class PanelDrawing {
  public:
    PanelDrawing(Subject subject, const PanelOptions& options)
        : subject_(std::move(subject)),
          scene_(subject_.scene),
          options_(options),
          materials_(scene_.scene.materials) {
        // Faces without a material get one, so that it can be replaced like the others.
        materials_.push_back({});
        for (prep::VertexMesh& mesh : scene_.meshes) {
            for (prep::VertexMesh::Range& range : mesh.ranges)
                range.material = std::min<std::uint32_t>(
                    range.material, static_cast<std::uint32_t>(materials_.size() - 1));
            triangles_ += mesh.triangle_count();
            vertices_ += mesh.vertex_count();
            with_normals_ |= !mesh.normals.empty();
            with_tangents_ |= !mesh.tangents.empty();
            with_uvs_ |= !mesh.uvs.empty() && !mesh.uvs[0].empty();
            for (const prep::VertexMesh::Range& range : mesh.ranges)
                normal_mapped_ |= bool(materials_[range.material].normal_map);
            colors_.push_back(std::exchange(mesh.colors, {}));
        }
        // Open and one-sided surfaces are drawn from both sides: nothing is to be missing.
        view_ = fitted_view(subdivided() ? with_cages(scene_) : scene_, options.azimuth,
                            options.elevation);
        world_ = prep::world_transforms(scene_.scene);
    }

    Result<PanelSet> run() {
        if (triangles_ == 0) {
            const std::pair<const char*, const char*> all[] = {{"flat", "Flat"},
                                                               {"gouraud", "Gouraud"},
                                                               {"phong", "Phong"},
                                                               {"normal-mapped", "Normal-mapped"}};
            for (const auto& [id, title] : all) add_note(id, title, "No faces: nothing to shade.");
            return std::move(out_);
        }
        const auto steps = {&PanelDrawing::shadings,  &PanelDrawing::normals,
                            &PanelDrawing::tangents,  &PanelDrawing::uv_checker,
                            &PanelDrawing::wireframe, &PanelDrawing::hard_edges,
                            &PanelDrawing::materials};
        for (const auto step : steps)
            if (std::optional<prep::Error> error = (this->*step)()) return *std::move(error);
        if (subject_.beside)
            if (std::optional<prep::Error> error = displacement()) return *std::move(error);
        if (subdivided()) {
            for (const auto step :
                 {&PanelDrawing::cages, &PanelDrawing::curvature, &PanelDrawing::errors})
                if (std::optional<prep::Error> error = (this->*step)()) return *std::move(error);
        }
        return std::move(out_);
    }

  private:
    using Step = std::optional<prep::Error>;
    Material neutral(float grey, float specular) const {
        Material m;
        m.diffuse = glm::vec4(glm::vec3(grey), 1.0f);
        m.specular = glm::vec3(specular);
        m.shininess = 40;
        return m;
    }

    // Every material like `model`; with the file's normal maps where asked for.
    void dress(const Material& model, bool normal_maps) {
        scene_.scene.materials.assign(materials_.size(), model);
        if (!normal_maps) return;
        for (std::size_t m = 0; m < materials_.size(); ++m) {
            Material& material = scene_.scene.materials[m];
            material.normal_map = materials_[m].normal_map;
            material.normal_map_space = materials_[m].normal_map_space;
            material.normal_map_flip_green = materials_[m].normal_map_flip_green;
        }
    }

    Result<Shot> shoot(rast::Shading shading, bool data = false) {
        return shoot(scene_, shading, data);
    }
    Result<Shot> shoot(const prep::PreparedScene& scene, rast::Shading shading, bool data = false) {
        ShotOptions shot;
        shot.size = options_.size;
        shot.samples = options_.samples;
        shot.shading = shading;
        shot.cull = rast::Cull::none;
        shot.threads = options_.threads;
        shot.data = data;
        if (data) shot.lights = normal_color_lights();
        Result<Shot> taken = take_shot(scene, view_, shot);
        if (taken)
            for (const std::string& text : taken->frame.warnings)
                if (std::find(out_.warnings.begin(), out_.warnings.end(), text) ==
                    out_.warnings.end())
                    out_.warnings.push_back(text);
        return taken;
    }

    Panel& add(const char* id, const char* title, std::string caption, std::string alt) {
        Panel panel;
        panel.id = id;
        panel.title = title;
        panel.caption = std::move(caption);
        panel.alt = subject_.name + ", " + std::move(alt);
        out_.panels.push_back(std::move(panel));
        return out_.panels.back();
    }
    void add_note(const char* id, const char* title, const std::string& note) {
        Panel& panel = add(id, title, "", "not drawn: " + note);
        panel.note = note;
    }

    // The image that a texture slot is given for a panel.
    std::uint32_t add_texture(prep::ImageRef image) {
        prep::Scene& scene = scene_.scene;
        prep::Texture texture;
        texture.image = static_cast<std::uint32_t>(scene.images.size());
        scene.images.push_back(std::move(image));
        scene.textures.push_back(texture);
        return static_cast<std::uint32_t>(scene.textures.size() - 1);
    }

    Step shadings() {
        const Material grey = neutral(0.40f, 0.9f);
        dress(grey, false);
        Result<Shot> flat = shoot(rast::Shading::flat);
        if (!flat) return flat.error();
        add("flat", "Flat",
            fmt::format("One normal a triangle: {} facets", with_commas(triangles_)),
            "flat shading: each triangle has one shade")
            .picture = flat->image;
        Result<Shot> gouraud = shoot(rast::Shading::gouraud);
        if (!gouraud) return gouraud.error();
        add("gouraud", "Gouraud",
            fmt::format("Light at {} vertices, interpolated: highlights smear",
                        with_commas(vertices_)),
            "Gouraud shading: light is interpolated between vertices")
            .picture = gouraud->image;
        Result<Shot> phong = shoot(rast::Shading::phong);
        if (!phong) return phong.error();
        add("phong", "Phong", "Normals interpolated, light at every pixel: highlights are round",
            "Phong shading: normals are interpolated and lit at every pixel")
            .picture = phong->image;
        phong_ = phong->image;
        out_.differences.title = "Shadings apart (8-bit levels)";
        add_difference("flat – Gouraud", flat->image, gouraud->image);
        add_difference("Gouraud – Phong", gouraud->image, phong->image);
        return normal_mapped(grey, phong->image);
    }

    void add_difference(const char* name, const prep::Image& a, const prep::Image& b) {
        const Difference d = difference(a, b);
        out_.differences.figures.push_back(
            {name, fmt::format("RMS {:.2f}, max {:.0f}", d.rms, d.largest)});
    }

    Step normal_mapped(Material grey, const prep::Image& phong) {
        std::string caption;
        if (normal_mapped_) {
            dress(grey, true);
            caption = "The file's normal maps: relief lit as the light falls";
        } else if (with_uvs_ && with_tangents_) {
            Result<prep::ImageRef> map = bump_normal_map();
            if (!map) return map.error();
            grey.normal_map.texture = add_texture(*std::move(map));
            dress(grey, false);
            caption = "Test pattern (no material has a normal map): all must look like bumps";
        } else {
            add_note("normal-mapped", "Normal-mapped",
                     with_uvs_ ? "No tangents were prepared, and a normal map needs them."
                               : "No UVs: a normal map has nothing to lie on.");
            return {};
        }
        const std::vector<std::string> told = out_.warnings;
        Result<Shot> shot = shoot(rast::Shading::normal_mapped);
        if (!shot) return shot.error();
        if (!normal_mapped_) out_.warnings = told;  // the file need not hold a pattern of ours
        // The plan has the last word: if it shaded without maps, the picture says why.
        for (const rast::PlanStep& step : shot->plan.steps)
            if (step.kind == rast::PlanStepKind::normal_maps && !step.run) caption = step.reason;
        add("normal-mapped", "Normal-mapped", caption,
            normal_mapped_ ? "shaded with the file's normal maps"
                           : "shaded with a test pattern of round bumps")
            .picture = shot->image;
        add_difference("Phong – normal-mapped", phong, shot->image);
        return {};
    }

    // Vertices to put marks on: one per cell of the screen, but each of those at the same place.
    struct Mark {
        std::uint32_t node, vertex;
        glm::dvec3 world;
        double pixel;  // world units
    };
    std::vector<Mark> marks(const Overlay& overlay, double cell) const {
        struct Taken {
            glm::dvec3 world;
            int count;
        };
        std::map<std::pair<std::int64_t, std::int64_t>, Taken> cells;
        std::vector<Mark> found;
        for (std::uint32_t n = 0; n < scene_.scene.nodes.size(); ++n) {
            const std::uint32_t m = scene_.scene.nodes[n].mesh;
            if (m == no_index) continue;
            const prep::VertexMesh& mesh = scene_.meshes[m];
            for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
                const glm::dvec3 p = to_world(n, glm::dvec3(mesh.positions[v]) + mesh.origin);
                const rast::Projected at = overlay.projected(p);
                if (!at.visible || !overlay.is_within(at.x, at.y)) continue;
                const auto key = std::make_pair(static_cast<std::int64_t>(std::floor(at.x / cell)),
                                                static_cast<std::int64_t>(std::floor(at.y / cell)));
                const auto there = cells.find(key);
                // Up to eight normals at one place: hard corners show all of theirs.
                if (there != cells.end() && (there->second.world != p || there->second.count >= 8))
                    continue;
                if (!overlay.visible(p)) continue;
                if (there == cells.end())
                    cells.emplace(key, Taken{p, 1});
                else
                    ++there->second.count;
                found.push_back({n, v, p, overlay.pixel_extent(p)});
            }
        }
        return found;
    }

    glm::dvec3 to_world(std::uint32_t node, const glm::dvec3& p) const {
        return glm::dvec3(world_[node] * glm::dvec4(p, 1.0));
    }
    static glm::dvec3 unit_or_zero(const glm::dvec3& v) {
        const double length = glm::length(v);
        return length > 0 ? v / length : v;
    }
    glm::dvec3 direction_to_world(std::uint32_t node, const glm::dvec3& d) const {
        return unit_or_zero(glm::dmat3(world_[node]) * d);
    }
    glm::dvec3 normal_to_world(std::uint32_t node, const glm::dvec3& n) const {
        return unit_or_zero(prep::normal_matrix(glm::dmat3(world_[node])) * n);
    }
    double scale() const { return options_.size / 480.0; }

    Step normals() {
        if (!with_normals_) {
            add_note("normals", "Normals", "No normals were prepared: nothing that is lit.");
            return {};
        }
        Material white = neutral(1.0f, 0.0f);
        dress(white, false);
        Result<Shot> shot = shoot(rast::Shading::phong, true);
        if (!shot) return shot.error();
        Overlay overlay(*shot);
        for (const Mark& mark : marks(overlay, 20 * scale())) {
            const prep::VertexMesh& mesh = scene_.meshes[scene_.scene.nodes[mark.node].mesh];
            if (mesh.normals.empty()) continue;
            const glm::dvec3 n = normal_to_world(mark.node, glm::dvec3(mesh.normals[mark.vertex]));
            overlay.segment(mark.world, mark.world + n * (16 * scale() * mark.pixel), ink,
                            1.1 * scale());
        }
        add("normals", "Normals", "x, y, z as red, green, blue; ticks at vertices",
            "its interpolated normals as colours, with ticks at vertices")
            .picture = overlay.image();
        return {};
    }

    Step tangents() {
        if (!with_tangents_) {
            add_note("tangents", "Tangents",
                     with_uvs_ ? "No tangents were prepared: switched off by the options."
                               : "No UVs: tangents are not defined.");
            return {};
        }
        dress(neutral(0.72f, 0.0f), false);
        std::uint64_t mirrored = 0;
        for (prep::VertexMesh& mesh : scene_.meshes) {
            if (mesh.tangents.empty()) continue;
            auto& tint = mesh.colors.emplace_back(mesh.vertex_count(), glm::vec4(1));
            for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
                if (!mirrored_uv(mesh, t)) continue;
                ++mirrored;
                for (int k = 0; k < 3; ++k)
                    tint[mesh.indices[3 * t + k]] = glm::vec4(0.55f, 0.72f, 1.0f, 1.0f);
            }
        }
        Result<Shot> shot = shoot(rast::Shading::phong);
        for (prep::VertexMesh& mesh : scene_.meshes) mesh.colors.clear();
        if (!shot) return shot.error();
        Overlay overlay(*shot);
        for (const Mark& mark : marks(overlay, 22 * scale())) {
            const prep::VertexMesh& mesh = scene_.meshes[scene_.scene.nodes[mark.node].mesh];
            if (mesh.tangents.empty() || mesh.normals.empty()) continue;
            const glm::dvec4 t(mesh.tangents[mark.vertex]);
            const glm::dvec3 b =
                t.w * glm::cross(glm::dvec3(mesh.normals[mark.vertex]), glm::dvec3(t));
            // Lifted off the surface by a pixel, along the normal: they lie in it otherwise.
            const glm::dvec3 foot =
                mark.world +
                normal_to_world(mark.node, glm::dvec3(mesh.normals[mark.vertex])) * mark.pixel;
            const double length = 14 * scale() * mark.pixel;
            overlay.segment(foot, foot + direction_to_world(mark.node, b) * length, bitangent_color,
                            1.3 * scale());
            overlay.segment(foot, foot + direction_to_world(mark.node, glm::dvec3(t)) * length,
                            tangent_color, 1.3 * scale());
        }
        Panel& panel =
            add("tangents", "Tangents",
                mirrored > 0 ? fmt::format("{} of {} triangles have mirrored UVs",
                                           with_commas(mirrored), with_commas(triangles_))
                             : std::string("No mirrored UVs"),
                "its tangents and bitangents as ticks");
        panel.picture = overlay.image();
        panel.legend = {{tangent_color, "tangent"}, {bitangent_color, "bitangent"}};
        if (mirrored > 0) panel.legend.push_back({rgb(0x9dbdf5), "mirrored"});
        return {};
    }

    Step uv_checker() {
        if (!with_uvs_) {
            add_note("uv", "UV checker", "No UVs in the file.");
            return {};
        }
        Result<prep::ImageRef> checker = report::uv_checker();
        if (!checker) return checker.error();
        Material material = neutral(1.0f, 0.06f);
        material.diffuse_map.texture = add_texture(*std::move(checker));
        dress(material, false);
        const std::vector<std::string> told = out_.warnings;
        Result<Shot> shot = shoot(rast::Shading::phong);
        if (!shot) return shot.error();
        out_.warnings = told;
        add("uv", "UV checker", "Set 0: letters must not be mirrored, squares not be stretched",
            "a checker with letters laid over it by its UVs")
            .picture = shot->image;
        return {};
    }

    // Calls use(node, a, b, kind) for every edge of every instance, in world space.
    template <class Use>
    void each_edge(const Use& use) {
        if (edges_.empty()) {
            prep::PrepareOptions prepare = options_.prepare;
            prepare.threads = options_.threads;
            for (std::uint32_t m = 0; m < scene_.scene.meshes.size(); ++m)
                edges_.push_back(classify_edges(scene_, m, prepare));
        }
        for (std::uint32_t n = 0; n < scene_.scene.nodes.size(); ++n) {
            const std::uint32_t m = scene_.scene.nodes[n].mesh;
            if (m == no_index) continue;
            const prep::Mesh& mesh = scene_.scene.meshes[m];
            for (const ClassedEdge& edge : edges_[m])
                use(to_world(n, glm::dvec3(mesh.positions[edge.v0]) + mesh.origin),
                    to_world(n, glm::dvec3(mesh.positions[edge.v1]) + mesh.origin), edge.kind);
        }
    }

    Step wireframe() {
        dress(neutral(0.86f, 0.0f), false);
        Result<Shot> shot = shoot(rast::Shading::phong);
        if (!shot) return shot.error();
        clay_ = *std::move(shot);
        Overlay overlay(*clay_);
        // Where edges are shorter than a few pixels, full ink would blacken the picture.
        double pixels = 0;
        std::uint64_t count = 0;
        each_edge([&](const glm::dvec3& a, const glm::dvec3& b, EdgeClass) {
            const rast::Projected p = overlay.projected(a), q = overlay.projected(b);
            if (!p.visible || !q.visible) return;
            pixels += std::hypot(p.x - q.x, p.y - q.y);
            ++count;
        });
        const double mean = count > 0 ? pixels / static_cast<double>(count) : 0;
        const Color color = rgb(0x1e3a5f, static_cast<float>(std::clamp(mean / 8, 0.1, 0.9)));
        const double width = (mean > 10 ? 1.2 : 0.9) * scale();
        each_edge([&](const glm::dvec3& a, const glm::dvec3& b, EdgeClass) {
            overlay.segment(a, b, color, width);
        });
        add("wireframe", "Wireframe",
            fmt::format("{} edges {}, {:.1f} px long on average", with_commas(count),
                        subdivided() ? "of the refined faces" : "as in the file", mean),
            "its edges, those behind the surface left out")
            .picture = overlay.image();
        return {};
    }

    Step hard_edges() {
        Overlay overlay(*clay_);
        std::array<std::uint64_t, edge_class_count> counts{};
        // Rarer and graver classes are drawn over the others.
        const EdgeClass order[] = {
            EdgeClass::uv_seam,         EdgeClass::border,       EdgeClass::authored,
            EdgeClass::cancelled,       EdgeClass::apart,        EdgeClass::uv_request,
            EdgeClass::material,        EdgeClass::mark,         EdgeClass::angle,
            EdgeClass::smoothing_group, EdgeClass::inconsistent, EdgeClass::non_manifold};
        for (const EdgeClass kind : order) {
            each_edge([&](const glm::dvec3& a, const glm::dvec3& b, EdgeClass edge) {
                if (edge != kind) return;
                const bool thin = kind == EdgeClass::uv_seam;
                overlay.segment(a, b, style_of(kind).color, (thin ? 1.2 : 2.0) * scale());
            });
        }
        // Of the meshes, as the other figures are, however often each is placed.
        for (const std::vector<ClassedEdge>& mesh : edges_)
            for (const ClassedEdge& edge : mesh) ++counts[static_cast<std::size_t>(edge.kind)];
        std::uint64_t hard = 0;
        out_.edges.title = "Edges";
        Panel& panel = add("hard-edges", "Hard edges", "", "the edges where its shading breaks");
        for (std::size_t i = std::size(order); i-- > 0;) {
            const std::uint64_t n = counts[static_cast<std::size_t>(order[i])];
            if (n == 0) continue;
            const EdgeClassStyle& style = style_of(order[i]);
            panel.legend.push_back({style.color, style.name});
            const bool bad =
                order[i] == EdgeClass::non_manifold || order[i] == EdgeClass::inconsistent;
            out_.edges.figures.push_back({style.name, with_commas(n), bad});
            if (order[i] != EdgeClass::uv_seam && order[i] != EdgeClass::border) hard += n;
        }
        panel.caption = hard > 0 ? fmt::format("Shading breaks at {} edges", with_commas(hard))
                                 : std::string("Shading breaks nowhere: all edges are smooth");
        if (out_.edges.figures.empty())
            out_.edges.figures.push_back({"hard, open or seam", "none"});
        panel.picture = overlay.image();
        return {};
    }

    bool subdivided() const {
        return std::any_of(scene_.cages.begin(), scene_.cages.end(),
                           [](const prep::Mesh& cage) { return cage.face_count() > 0; });
    }
    Step cages() {
        const CagePanelInput input{scene_,           world_,  *clay_,
                                   options_.prepare, scale(), options_.threads};
        std::vector<Result<Panel> (*)(const CagePanelInput&)> panels{polygons_panel};
        if (options_.prepare.subdivide) panels = {cage_panel, limit_panel};
        for (const auto& panel : panels) {
            Result<Panel> made = panel(input);
            if (!made) return made.error();
            made->alt = subject_.name + ", " + made->alt;
            out_.panels.push_back(*std::move(made));
        }
        return {};
    }

    Step curvature() {
        const double full = color_by_curvature(scene_);
        dress(neutral(0.9f, 0.0f), false);
        Result<Shot> shot = shoot(rast::Shading::phong);
        for (prep::VertexMesh& mesh : scene_.meshes) mesh.colors.clear();
        if (!shot) return shot.error();
        Panel& panel = add("curvature", "Curvature",
                           full > 0 ? fmt::format("Mean curvature; full colour from 1 / {:.3g} on, "
                                                  "which 95 % of the vertices do not reach",
                                                  1 / full)
                                    : std::string("Mean curvature: none, all faces are flat"),
                           "its mean curvature as colours: red bulges, blue hollows");
        panel.picture = shot->image;
        panel.legend = {{rgb(0xc0392b), "bulges"}, {rgb(0x2e6fc9), "hollows"}};
        return {};
    }

    // The relief in three ways under the same light: as a bump map, as a normal map on few
    // triangles, as triangles.
    Step displacement() {
        const DisplacementViews& beside = *subject_.beside;
        if (Step error = relief("bump-mapped", "Bump-mapped", beside.bumped, beside.no_bumped,
                                "its heights as a bump map: the outline is smooth",
                                "the surface before it was displaced, its heights as a bump map"))
            return error;
        if (Step error = relief("residual", "Residual normal map", beside.coarse, beside.no_coarse,
                                "displaced, what they do not carry in a normal map",
                                "displaced with few triangles and a residual normal map"))
            return error;
        add("displaced", "Displaced",
            fmt::format("{} triangles, lit by their own normals", with_commas(triangles_)),
            "displaced, without any map")
            .picture = phong_;
        return {};
    }
    Step relief(const char* id, const char* title, const std::optional<prep::PreparedScene>& scene,
                const std::string& why_not, const char* caption, const char* alt) {
        if (!scene) {
            add_note(id, title, why_not);
            return {};
        }
        const prep::PreparedScene drawn = with_relief_alone(*scene, neutral(0.40f, 0.9f));
        std::uint64_t triangles = 0;
        for (const prep::VertexMesh& mesh : drawn.meshes) triangles += mesh.triangle_count();
        Result<Shot> shot = shoot(drawn, rast::Shading::normal_mapped);
        if (!shot) return shot.error();
        add(id, title, fmt::format("{} triangles, {}", with_commas(triangles), caption), alt)
            .picture = shot->image;
        const std::string name = title;
        add_difference((name + " – displaced").c_str(), shot->image, phong_);
        return {};
    }

    // The last: triangles are apart from then on.
    Step errors() {
        if (std::all_of(scene_.tessellation_errors.begin(), scene_.tessellation_errors.end(),
                        [](const std::vector<float>& errors) { return errors.empty(); }))
            return {};
        const ErrorColors found = color_by_errors(scene_);
        dress(neutral(0.9f, 0.0f), false);
        Result<Shot> shot = shoot(rast::Shading::phong);
        if (!shot) return shot.error();
        const std::string caption =
            found.asked
                ? fmt::format("What is proved of each triangle: {} of {} miss what was asked",
                              with_commas(found.missed), with_commas(found.triangles))
                : fmt::format("What is proved of each of {} triangles, beside the largest",
                              with_commas(found.triangles));
        Panel& panel = add("tessellation-error", "Tessellation error", caption,
                           "the error proved of each triangle as colours: the darker, the larger");
        panel.picture = shot->image;
        panel.legend = {{rgb(0xe2e2e2), "none"}, {rgb(0x2e6fc9), found.asked ? "asked" : "most"}};
        if (found.missed > 0) panel.legend.push_back({rgb(0xc0392b), "above"});
        return {};
    }

    Step materials() {
        scene_.scene.materials = materials_;
        for (std::size_t m = 0; m < scene_.meshes.size(); ++m)
            scene_.meshes[m].colors = std::move(colors_[m]);
        Result<Shot> shot = shoot(rast::Shading::normal_mapped);
        if (!shot) return shot.error();
        add("materials", "Materials", "The file's own materials under this sheet's lights",
            "drawn with its own materials and textures")
            .picture = shot->image;
        return {};
    }

    Subject subject_;
    prep::PreparedScene& scene_;
    const PanelOptions& options_;
    std::vector<Material> materials_;
    std::vector<std::vector<std::vector<glm::vec4>>> colors_;
    std::uint64_t triangles_ = 0, vertices_ = 0;
    bool with_normals_ = false, with_tangents_ = false, with_uvs_ = false, normal_mapped_ = false;
    rast::View view_;
    std::vector<glm::dmat4> world_;
    std::vector<std::vector<ClassedEdge>> edges_;
    std::optional<Shot> clay_;
    prep::Image phong_;
    PanelSet out_;
};

}  // namespace

Result<PanelSet> make_panels(Subject subject, const PanelOptions& options) {
    return PanelDrawing(std::move(subject), options).run();
}

}  // namespace report
