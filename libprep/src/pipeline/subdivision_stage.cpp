// The cage of a mesh, and the surface in its place: quads recovered, creases from hard edges,
// points welded that the file repeats at seams, then subdivision with everything that the mesh
// carries.
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "base/finite.h"
#include "model/origin.h"
#include "model/vertex_deltas.h"
#include "normals/authored_normals.h"
#include "pipeline/mesh_preparation.h"
#include "prep/subdivide.h"
#include "repair/repair_steps.h"
#include "surface/recover_quads.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

std::pair<Index, Index> ends(Index a, Index b) {
    return {std::min(a, b), std::max(a, b)};
}

bool all_triangles(const Mesh& mesh) {
    for (std::size_t f = 0; f < mesh.face_count(); ++f)
        if (mesh.face_offsets[f + 1] - mesh.face_offsets[f] != 3) return false;
    return mesh.face_count() > 0;
}

}  // namespace

// The edges between faces that the options call hard become infinitely sharp; what is sharp already
// stays.
Result<void> MeshPreparation::crease_hard_edges() {
    const MeshView view(mesh_);
    const Topology topology = build_topology(view, {}, options_.threads);
    HardEdgeOptions options = options_.hard_edges;
    options.threads = options_.threads;
    const auto hard = hard_edges(
        view, topology, face_normals(view, options_.normal.precision, options_.threads), options);
    if (!hard) return hard.error();
    std::map<std::pair<Index, Index>, std::size_t> known;
    auto& creases = mesh_.subdivision.creases;
    for (std::size_t k = 0; k < creases.size(); ++k)
        known.emplace(ends(creases[k].v0, creases[k].v1), k);
    constexpr float infinite = 10;
    for (Index c = 0; c < mesh_.corner_count(); ++c) {
        if (!hard->reasons[c] || topology.kinds[c] != EdgeKind::interior) continue;
        const Index v0 = mesh_.corner_vertices[c];
        const Index v1 =
            mesh_.corner_vertices[next_corner(mesh_.face_offsets, topology.corner_faces[c], c)];
        const auto [place, is_new] = known.try_emplace(ends(v0, v1), creases.size());
        if (is_new)
            creases.push_back({v0, v1, infinite});
        else
            creases[place->second].sharpness = infinite;
    }
    return {};
}

// A file that repeats points at seams would come apart there.
Result<void> MeshPreparation::weld_cage(const std::string& reason) {
    move_cage_to_its_origin();
    if (geometry_.shared || !is_welded()) return {};
    std::uint64_t moved_apart = 0;
    const std::uint64_t apart = log_.run("weld", reason, [&] {
        const MovingPoints points = moving_points(mesh_, options_.threads);
        moved_apart = points.apart;
        weld_points(mesh_, points.first);
        return join_parts(mesh_, points.first);
    });
    add_finding("parts-apart", Severity::info, apart, {},
                "points of primitives that lie on each other stay apart: more than two faces would "
                "meet in an edge",
                PlaceKind::vertex);
    add_finding("moving-apart", Severity::info, moved_apart, {},
                "points that lie on others stay apart: joints or morph targets move them elsewhere",
                PlaceKind::vertex);
    geometry_.shared = true;
    return {};
}

// Coordinates that floats hold may lie where floats hold nothing between them, as where a cage's
// edges are few of their steps. A document's meshes stay where their nodes have them.
void MeshPreparation::move_cage_to_its_origin() {
    PositionBounds bounds;  // of faces: what nothing refines may lie anywhere
    for (const Index v : mesh_.corner_vertices) bounds.add(glm::dvec3(mesh_.positions[v]));
    const glm::dvec3 origin = bounds.far_origin();
    if (origin == glm::dvec3(0.0)) return;
    bool moves = !(mesh_.tied_to_file && options_.document_stays);
    std::vector<glm::vec3> moved(moves ? mesh_.positions.size() : 0);
    for (std::size_t v = 0; v < moved.size(); ++v) {
        const glm::dvec3 p(mesh_.positions[v]);
        moved[v] = glm::vec3(p - origin);
        moves = moves && (!is_finite(p) || glm::dvec3(moved[v]) + origin == p);
    }
    if (moves) {
        mesh_.positions = std::move(moved);
        mesh_.origin += origin;
        return;
    }
    constexpr double coarse = 0x1p-16;  // of the cage's size
    const double step = 0x1p-23 * glm::length(origin);
    if (!(step > coarse * bounds.diagonal()) || bounds.diagonal() == 0) return;
    add_finding("far-from-origin", Severity::warning, 1, {},
                fmt::format("the cage lies so far from its origin that new points are rounded to "
                            "steps of {:.2g} of its size: put the distance into its node",
                            step / bounds.diagonal()),
                PlaceKind::vertex);
}

Result<void> MeshPreparation::make_cage() {
    if (auto done = weld_cage("a cage is one surface: equal positions are one point"); !done)
        return done;
    const SubdivideOptions& options = options_.subdivision;
    if (options_.recover_quads) {
        const RecoveredQuads quads =
            log_.run("quads", "pairs of triangles that make one quad alone",
                     [&] { return recover_quads(mesh_); });
        add_finding("ambiguous-quad", Severity::warning, quads.ambiguous, quads.places,
                    "triangles stay: several neighbours would make as good a quad",
                    PlaceKind::face);
        add_finding("lone-triangle", Severity::info, quads.alone, quads.places,
                    "triangles stay: no neighbour makes a quad", PlaceKind::face);
    } else if (options.scheme == SubdivisionScheme::catmark && all_triangles(mesh_)) {
        add_finding("triangulated-cage", Severity::warning, mesh_.face_count(), {0},
                    "all faces of the cage are triangles: Catmull-Clark on quads that were "
                    "triangulated is not what was modelled; --quads recovers them, --subdivide "
                    "loop is made for triangles",
                    PlaceKind::face);
    }
    return options_.crease_hard_edges ? crease_hard_edges() : Result<void>();
}

Result<void> MeshPreparation::subdivide_mesh() {
    if (!options_.subdivide) return {};
    if (mesh_.face_count() == 0) {
        log_.skipped("subdivide", "there are no faces");
        return {};
    }
    if (auto done = make_cage(); !done) return done;
    SubdivideOptions options = options_.subdivision;
    options.threads = options_.threads;
    const std::string reason =
        std::string(name_of(options.scheme)) + ", level " + std::to_string(options.level) +
        (options.control_points ? ", points of the refined cage" : ", points on the limit surface");
    auto refined = log_.run("subdivide", reason, [&] { return subdivide(mesh_, options); });
    if (!refined) return std::move(refined).error();
    if (auto done = morph_limit_normals(options, *refined); !done) return done;

    add_finding("fallback-limit-normal", Severity::info, refined->fallback_normals, {},
                "the surface's derivatives give no normal: it is the mean of those nearby, or the "
                "cage face's",
                PlaceKind::vertex);
    if (refined->largest_dropped_weight > 0) {
        add_finding("dropped-weight", Severity::info, 1, {},
                    "influences beyond --max-influences were dropped; the largest share of a "
                    "vertex is " +
                        std::to_string(refined->largest_dropped_weight),
                    PlaceKind::vertex);
    }
    add_finding("attribute-not-finite", Severity::warning, refined->attributes_left_out, {},
                "attributes with numbers that are not finite were left out", PlaceKind::vertex);
    add_finding("approximate-seams", Severity::warning, refined->approximate_seams, {},
                "channels (UV sets, colours, attributes) by whose rules the creases would be cut "
                "into too many faces: values at seams are not OpenSubdiv's where creases of "
                "different sharpness meet them; --face-varying corners-only needs no such rules",
                PlaceKind::corner);
    report_left_out(refined->holes, refined->uv_sets_left_out, refined->color_sets_left_out);
    take_surface(std::move(refined->mesh));
    return {};
}

void MeshPreparation::report_left_out(std::uint64_t holes, std::uint64_t uv_sets,
                                      std::uint64_t color_sets) {
    const std::string text = "sets that cover a part of a face were left out there";
    add_finding("hole", Severity::info, holes, {}, "faces of the cage are holes, and left out",
                PlaceKind::face);
    add_finding("partial-uv-set", Severity::warning, uv_sets, {}, "UV " + text, PlaceKind::corner);
    add_finding("partial-color-set", Severity::warning, color_sets, {}, "colour " + text,
                PlaceKind::corner);
}

// In the cage's place.
void MeshPreparation::take_surface(Mesh&& surface) {
    const bool tied = mesh_.tied_to_file;
    if (options_.keep_cages) out_.cages[index_] = std::move(mesh_);
    mesh_ = std::move(surface);
    mesh_.tied_to_file = tied;  // its parts are the document's primitives still
    geometry_ = {};
    geometry_.shared = true;
    normal_replaced_.clear();
    // The normals of polygons may be the file's; those of a limit surface differ at creases.
    normals_apart_ =
        options_.subdivide || normals_made_ ? SplitReason::hard_edge : SplitReason::authored_normal;
    limit_normals_ = !mesh_.normals.empty();
    normals_made_ = limit_normals_;
    out_.subdivided[index_] = true;
}

// A morph target turns the normals of the surface as the surface of the moved cage has them. Faces
// and corners are the same: what is one normal depends on the topology alone.
Result<void> MeshPreparation::morph_limit_normals(const SubdivideOptions& options,
                                                  const SubdividedMesh& rest) {
    if (rest.mesh.normals.empty()) return {};
    for (const MorphTarget& target : mesh_.morph_targets) {
        Mesh moved;
        moved.positions = mesh_.positions;
        for (Index v = 0; v < moved.positions.size(); ++v)
            if (const glm::vec3* d = delta_of(target.positions, mesh_.file_vertex(v)))
                moved.positions[v] += *d;
        moved.origin = mesh_.origin;
        moved.face_offsets = mesh_.face_offsets;
        moved.corner_vertices = mesh_.corner_vertices;
        moved.subdivision = mesh_.subdivision;
        moved.hard_marks = mesh_.hard_marks;
        auto refined = log_.run("morph targets", "the limit surface of each moved cage",
                                [&] { return subdivide(moved, options); });
        if (!refined) return std::move(refined).error();
        limit_morph_normals_.push_back(std::move(refined->mesh.normals));
    }
    return {};
}

}  // namespace prep::detail
