// Triangles as fine as an error asks in a mesh's place: of its limit surface or its polygons,
// displaced by the materials' height maps or by one for all.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "pipeline/mesh_preparation.h"
#include "tessellation/tessellation.h"

namespace prep::detail {
namespace {

// "an error of at most 0.001, edges of at most 0.1, at most 20000 triangles"
std::string goal_of(const TessellateOptions& options) {
    std::string text;
    const auto add = [&](const std::string& goal) { text += (text.empty() ? "" : ", ") + goal; };
    if (options.chord_error) add(fmt::format("an error of at most {}", *options.chord_error));
    if (options.pixel_error) add(fmt::format("at most {} pixels", *options.pixel_error));
    if (options.edge_length) add(fmt::format("edges of at most {}", *options.edge_length));
    if (options.max_triangles) add(fmt::format("at most {} triangles", *options.max_triangles));
    return text;
}

// "0.013 and 1.6 pixels are"
std::string proved_of(const TessellationCertificate& c) {
    if (!c.proved_pixels) return fmt::format("{:.3g} is", c.proved);
    const std::string pixels = std::isfinite(*c.proved_pixels)
                                   ? fmt::format("{:.3g} pixels", *c.proved_pixels)
                                   : std::string("no number of pixels");
    return c.asked ? fmt::format("{:.3g} and {} are", c.proved, pixels) : pixels + " are";
}
std::string asked_of(const TessellateOptions& options) {
    std::string text;
    if (options.chord_error) text = fmt::format("{:.3g}", *options.chord_error);
    if (options.pixel_error)
        text += fmt::format("{}{:.3g} pixels", text.empty() ? "" : " and ", *options.pixel_error);
    return text;
}

bool has_goal(const TessellateOptions& options) {
    return options.chord_error || options.pixel_error || options.edge_length ||
           options.max_triangles;
}

struct Extent {
    double diagonal = 1;  // of the box around all positions; 1 where that is no length
    double farthest = 0;  // coordinate
};
Extent extent_of(const Mesh& mesh) {
    glm::dvec3 low(mesh.positions.front()), high = low;
    for (const glm::vec3& p : mesh.positions) {
        low = glm::min(low, glm::dvec3(p));
        high = glm::max(high, glm::dvec3(p));
    }
    Extent extent;
    const double diagonal = glm::length(high - low);
    if (diagonal > 0 && std::isfinite(diagonal)) extent.diagonal = diagonal;
    const glm::dvec3 far = glm::max(glm::abs(low), glm::abs(high));
    const double farthest = std::max({far.x, far.y, far.z});
    if (std::isfinite(farthest)) extent.farthest = farthest;
    return extent;
}

// The screens of the world as each node with the mesh sees them; of a mesh without a node, one that
// sees nothing. Errors: invalid (a node's transform).
Result<std::vector<ScreenMetric>> screens_of(const Scene& scene, std::uint32_t index,
                                             std::span<const MeshInstance> instances,
                                             const std::vector<ScreenMetric>& world) {
    std::vector<ScreenMetric> screens;
    constexpr double most = 1e30;  // their products are numbers
    for (const MeshInstance& instance : instances) {
        glm::dmat4 transform = instance.transform;
        transform[3] = transform * glm::dvec4(scene.meshes[index].origin, 1.0);
        for (glm::length_t k = 0; k < 4; ++k)
            if (!(glm::length(transform[k]) < most))
                return Error{
                    ErrorCode::invalid,
                    "the transform of a node with a mesh is not finite or far too large: "
                    "an error in pixels means nothing there",
                    fmt::format("node {} '{}'", instance.node, scene.nodes[instance.node].name)};
        for (const ScreenMetric& metric : world) screens.push_back(transformed(metric, transform));
    }
    constexpr glm::dvec4 behind(0, 0, 0, -1);
    if (screens.empty() && !world.empty()) screens.push_back({.w = behind});
    return screens;
}

// Where heights, and no error of any kind, were asked for.
void choose_goal(const Mesh& mesh, TessellateOptions& options) {
    constexpr double share_of_diagonal = 1e-3;
    constexpr double float_steps = 0x1p-20;  // errors finer than floats are refused
    constexpr std::uint64_t usual_most = 1'000'000;
    const Extent extent = extent_of(mesh);
    options.chord_error =
        std::max(share_of_diagonal * extent.diagonal, float_steps * extent.farthest);
    options.max_triangles = usual_most;
}

// What is cut into triangles, in words.
std::string surface_of(const TessellateOptions& options, const std::vector<std::string>& pictures,
                       double band_limit) {
    std::string text =
        options.scheme ? std::string(name_of(*options.scheme)) + " limit surface" : "polygons";
    if (pictures.empty()) return text;
    text += fmt::format(" displaced by {}", fmt::join(pictures, ", "));
    if (band_limit != 0) text += fmt::format(" as samples {} apart carry it", band_limit);
    return text;
}

}  // namespace

std::vector<std::vector<MeshInstance>> instances_of(const Scene& scene) {
    std::vector<std::vector<MeshInstance>> instances(scene.meshes.size());
    const std::vector<glm::dmat4> transforms = world_transforms(scene);
    for (std::uint32_t n = 0; n < scene.nodes.size(); ++n)
        if (scene.nodes[n].mesh != no_index)
            instances[scene.nodes[n].mesh].push_back({n, transforms[n]});
    return instances;
}

// True where the mesh stays as it is; the log, or a finding, says why.
bool MeshPreparation::is_not_tessellated() {
    if (mesh_.face_count() == 0) {
        log_.skipped("tessellate", "there are no faces");
        return true;
    }
    const char* const what = !mesh_.morph_targets.empty()     ? "morph targets"
                             : !mesh_.skin_influences.empty() ? "skin weights"
                                                              : nullptr;
    if (what == nullptr) return false;
    log_.skipped("tessellate", std::string("the mesh has ") + what);
    add_finding("moving-mesh-kept", Severity::warning, mesh_.face_count(), {},
                std::string("faces are left as they are, neither displaced nor refined: the "
                            "mesh has ") +
                    what + ", which would not fit the new points",
                PlaceKind::face);
    return true;
}

Result<TessellateOptions> MeshPreparation::tessellate_options() const {
    TessellateOptions options = options_.tessellation;
    if (options_.subdivide) options.scheme = options_.subdivision.scheme;
    options.subdivision = options_.subdivision;
    options.hard_edges = options_.hard_edges;
    options.threads = options_.threads;
    options.keep_errors = options_.keep_cages;
    if (options.pixel_error) {
        auto screens = screens_of(out_.scene, index_, instances_, options.screens);
        if (!screens) return std::move(screens).error();
        options.screens = std::move(*screens);
    }
    return options;
}

Result<void> MeshPreparation::tessellate_mesh() {
    if (is_not_tessellated()) return {};
    if (auto done = options_.subdivide
                        ? make_cage()
                        : weld_cage("triangles on both sides of a seam share their points");
        !done)
        return done;
    auto chosen = tessellate_options();
    if (!chosen) return std::move(chosen).error();
    TessellateOptions options = *std::move(chosen);
    const DisplaceOptions& displacement = options_.displacement;
    std::vector<std::string> pictures;
    std::vector<Displacement> as_read;
    if (displacement.map || displacement.noise || displacement.from_materials) {
        auto maps = log_.run("height maps", "displacement was asked for", [&] {
            return maps_.of(out_.scene, mesh_,
                            options_.subdivide ? &options_.subdivision : nullptr);
        });
        if (!maps) return std::move(maps).error();
        report_heights(*maps);
        if (maps->displacements.empty() && !options_.subdivide && !has_goal(options)) {
            log_.skipped("tessellate",
                         "no material of this mesh has a displacement map that is read");
            return {};
        }
        options.displacements = std::move(maps->displacements);
        options.material_displacements = std::move(maps->material_displacements);
        pictures = std::move(maps->names);
        as_read = std::move(maps->as_read);
    }
    if (!has_goal(options)) choose_goal(mesh_, options);
    const std::string reason =
        surface_of(options, pictures, displacement.band_limit) + ": " + goal_of(options);
    choose_residuals(options);
    // A limit surface has its own; those of polygons are interpolated.
    if (!options_.subdivide) {
        if (auto done = prepare_normals(); !done) return done;
        make_normals_unit();
    }
    TessellationHooks hooks;
    if (baking_) hooks.places = &baking_->places;
    auto made = log_.run("tessellate", reason, [&] { return tessellate(mesh_, options, hooks); });
    if (!made) return std::move(made).error();
    if (baking_) {
        baking_->cage = mesh_;
        baking_->options = std::move(options);
        // What a band limit left out is in the normals.
        if (!as_read.empty()) baking_->options.displacements = std::move(as_read);
    }
    report_left_out(made->holes, made->uv_sets_left_out, made->color_sets_left_out);
    report_not_tessellated();
    report_certificate(made->certificate, baking_ ? baking_->options : options);
    take_surface(std::move(made->mesh));
    if (options_.keep_cages) out_.tessellation_errors[index_] = std::move(made->errors);
    out_.tessellated[index_] = made->certificate;
    return {};
}

// A document keeps lines and points, and what they have; it tells which of the faces' went.
void MeshPreparation::report_not_tessellated() {
    if (mesh_.tied_to_file && options_.document_stays) return;
    add_finding("attribute-left-out", Severity::warning, mesh_.vertex_attributes.size(), {},
                "the file's attributes of other names do not go through tessellation",
                PlaceKind::vertex);
    add_finding(
        "loose-parts-left-out", Severity::warning,
        mesh_.points.size() + (mesh_.line_offsets.empty() ? 0 : mesh_.line_offsets.size() - 1), {},
        "lines and points do not go through tessellation", PlaceKind::vertex);
}

void MeshPreparation::choose_residuals(const TessellateOptions& options) {
    if (!residuals_) return;
    auto of = residuals_->choose(out_.scene, index_, options, residual_report());
    if (of.materials.empty()) return;
    MeshRequirements& need = out_.requirements[index_];
    const Reason why = reason(ReasonCode::residual_map);
    const Need made{true, sentence(why, out_.scene), false, why};
    if (!need.normals.needed) need.normals = made;
    need.tangents = need.uvs = made;
    // Materials without a residual map keep their own normal maps, and the sets of those.
    std::map<Index, Index> kept;
    for (const Index m : mesh_.face_materials)
        if (!kept.contains(m) && !std::binary_search(of.materials.begin(), of.materials.end(), m))
            kept.emplace(m, need.tangent_uv_set_of(m));
    need.tangent_uv_set = of.uv_set;
    need.other_tangent_uv_sets.clear();
    for (const auto& [material, set] : kept)
        if (set != of.uv_set) need.other_tangent_uv_sets.push_back({material, set});
    need.provided |= {true, true, false, {of.uv_set}};
    baking_.emplace();
    baking_->of = std::move(of);
}

ResidualMaps::Report MeshPreparation::residual_report() {
    return [this](const char* kind, std::uint64_t count, const std::string& text) {
        add_finding(kind, Severity::warning, count, {}, text, PlaceKind::face);
    };
}

Result<void> MeshPreparation::bake_residuals() {
    if (!baking_) return {};
    Result<void> done = log_.run("residual maps", "residual normal maps were asked for", [&] {
        return residuals_->bake(out_.scene, index_, baking_->cage, baking_->options, baking_->of,
                                out_.meshes[index_], baking_->places, residual_report());
    });
    baking_.reset();
    return done;
}

void MeshPreparation::report_heights(const DisplacementMaps::OfMesh& maps) {
    if (maps.displacements.empty())
        add_finding("no-displacement-map", Severity::warning, 1, {},
                    "displacement by materials was asked for, and none of this mesh has a "
                    "displacement map",
                    PlaceKind::face);
    for (std::size_t k = 0; k < maps.names.size(); ++k) {
        if (maps.changes[k] > 0)
            add_finding(
                "band-limited", Severity::info, 1, {},
                fmt::format("what samples {} apart cannot carry of {} is left out of the "
                            "heights: they change by up to {:.3g}; errors are measured "
                            "against what is left",
                            options_.displacement.band_limit, maps.names[k], maps.changes[k]),
                PlaceKind::face);
        const MapPrecision& q = maps.precisions[k];
        if (q.bits == 0 || q.bits > 8) continue;
        add_finding("coarse-heights", Severity::warning, 1, {},
                    fmt::format("{} has {} bits{}: heights are off by up to {:.3g} in the map "
                                "itself, and slopes show steps; save it with 16 bits or as floats",
                                maps.names[k], q.bits,
                                q.file_bits != q.bits ? " in a file for more" : "", q.half_step),
                    PlaceKind::face);
    }
}

void MeshPreparation::report_certificate(const TessellationCertificate& c,
                                         const TessellateOptions& options) {
    if (options.max_triangles && c.triangles > *options.max_triangles)
        add_finding("budget-too-small", Severity::warning, c.triangles - *options.max_triangles, {},
                    fmt::format("the coarsest triangles of this mesh are {}: more than the {} "
                                "that were asked for",
                                c.triangles, *options.max_triangles),
                    PlaceKind::face);
    const std::string proved = proved_of(c);
    add_finding(
        "budget-reached", Severity::info, c.over_budget, {},
        fmt::format("triangles {}: {} triangles were reached before; {} proved",
                    options.chord_error || options.pixel_error ? "miss the error that was asked"
                                                               : "have longer edges than asked",
                    c.triangles, proved),
        PlaceKind::face);
    add_finding("unresolved-error", Severity::warning, c.unresolved,
                c.worst_triangle == no_index ? std::vector<std::uint32_t>{}
                                             : std::vector<std::uint32_t>{c.worst_triangle},
                fmt::format("triangles miss what was asked and cannot be halved any more: {} "
                            "proved; a length of {:.3g} stays wherever sides that share a point "
                            "have other heights or directions",
                            proved, c.largest_shared_gap),
                PlaceKind::face);
    const bool missed = (options.chord_error && c.proved > *options.chord_error) ||
                        (options.pixel_error && c.proved_pixels > options.pixel_error);
    const bool only_shared = missed && c.unresolved == 0 && c.over_budget == 0;
    add_finding(
        "seam-gap", Severity::warning, only_shared ? 1 : 0,
        c.worst_triangle == no_index ? std::vector<std::uint32_t>{}
                                     : std::vector<std::uint32_t>{c.worst_triangle},
        fmt::format("sides that share a point have other heights or directions, up to {:.3g} "
                    "from what they share: {} proved instead of {}, however many "
                    "triangles there are; heights agree where the map does so across seams, "
                    "directions where creases are not infinitely sharp",
                    c.largest_shared_gap, proved, asked_of(options)),
        PlaceKind::face);
}

}  // namespace prep::detail
