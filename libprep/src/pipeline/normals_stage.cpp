// What happens to authored normals, and how those that are missing are made: weld and topology,
// face normals, hard edges, corner normals.
#include <algorithm>

#include "base/parallel.h"
#include "normals/authored_normals.h"
#include "normals/crease_fans.h"
#include "pipeline/array_bytes.h"
#include "pipeline/mesh_preparation.h"
#include "surface/soup.h"

namespace prep::detail {
namespace {

constexpr std::size_t normal_grain = 16384;

// Formats that index by vertex repeat a point for every seam: adjacency then needs the weld. A file
// that indexes attributes apart from positions says itself which points are one.
bool indexed_by_vertex(const Mesh& mesh) {
    if (mesh.indexed_by_vertex) return true;
    const auto follows = [&](const std::vector<std::uint32_t>& indices) {
        return !indices.empty() &&
               std::equal(indices.begin(), indices.end(), mesh.corner_vertices.begin());
    };
    if (follows(mesh.normals.indices) || follows(mesh.tangents.indices)) return true;
    for (const auto& uv : mesh.uvs)
        if (follows(uv.indices)) return true;
    return is_soup(mesh);
}

std::vector<std::uint32_t> first_corners(const NormalReview& review, unsigned faults) {
    std::vector<std::uint32_t> places;
    for (std::uint32_t c = 0; c < review.faults.size(); ++c) {
        if (!(review.faults[c] & faults)) continue;
        places.push_back(c);
        if (places.size() == Finding::max_places) break;
    }
    return places;
}

}  // namespace

bool MeshPreparation::is_welded() const {
    return options_.weld == WeldMode::exact ||
           (options_.weld == WeldMode::automatic && indexed_by_vertex(mesh_));
}

Result<void> MeshPreparation::prepare_normals() {
    if (limit_normals_) {
        const bool tessellated = out_.tessellated[index_].has_value();
        // Polygons got theirs before they were cut.
        if (options_.subdivide || !tessellated)
            skip_normals(tessellated ? "the normals of the tessellated surface stand"
                                     : "the normals of the limit surface stand");
        return {};
    }
    // The file's own go into the output, whatever reads them there.
    const bool stay = !mesh_.normals.empty() && need_.provided.normals &&
                      options_.request.normals != Request::Level::never;
    // Of faces: lines and points may have some where no face has.
    const auto is_missing = [](std::uint32_t index) { return index == no_index; };
    const std::vector<std::uint32_t>& indices = mesh_.normals.indices;
    const bool of_faces = !std::all_of(indices.begin(), indices.end(), is_missing);
    if (!need_.normals.needed && !(stay && of_faces)) {
        if (!of_faces) mesh_.normals = {};
        skip_normals(need_.normals.reason);
        return {};
    }
    // Of those that no picture reads only what is no direction is mended.
    const bool only_kept = !need_.normals.needed && options_.request.consumer.exact;
    const Authored authored = only_kept ? Authored::keep : options_.normals;
    NormalReview review;
    unsigned replace = 0xff;
    std::string reason =
        need_.normals.needed ? need_.normals.reason : "the file's own are replaced";
    if (authored != Authored::replace && !mesh_.normals.empty()) {
        const MeshView view(mesh_);
        if (authored == Authored::repair) {
            geometry_.faces = log_.run(
                "face normals", "authored normals are held against them",
                [&] { return face_normals(view, options_.normal.precision, options_.threads); });
        }
        review = review_normals(view, geometry_.faces ? &*geometry_.faces : nullptr);
        report_review(review);
        // Formats with normals by vertex would have to make up those that are missing.
        replace = normal_non_finite | normal_zero | normal_missing;
        if (authored == Authored::repair) replace |= normal_non_unit | normal_flipped;
        bool any = false;
        for (const std::uint8_t f : review.faults) any |= (f & replace) != 0;
        if (!any) {
            skip_normals(need_.normals.needed ? "the file's own normals are kept"
                                              : need_.normals.reason);
            return {};
        }
        reason = "some authored normals are missing or bad";
    }
    auto computed = compute_normals(reason);
    if (!computed) return std::move(computed).error();
    report_fallbacks(*computed);
    if (review.faults.empty()) {
        mesh_.normals = std::move(computed->normals);
        normals_made_ = true;
    } else {
        mesh_.normals = merge_normals(mesh_.normals, review, replace, computed->normals);
        for (const std::uint8_t faults : review.faults)
            normal_replaced_.push_back((faults & replace) != 0);
    }
    return {};
}

bool MeshPreparation::keeps_lengths() const {
    return options_.tangent.mode == TangentMode::mikktspace_exact;
}

// Shaders and MikkTSpace take normals for unit vectors: a length that is off by what a validator
// lets pass turns tangents by degrees.
void MeshPreparation::make_normals_unit() {
    if (keeps_lengths()) return;
    std::vector<glm::vec3>& values = mesh_.normals.values;
    parallel_blocks(values.size(), normal_grain, options_.threads,
                    [&](std::size_t begin, std::size_t end) {
                        for (std::size_t i = begin; i < end; ++i)
                            values[i] = unit_normal(values[i]);
                    });
}

Result<CornerNormals> MeshPreparation::compute_normals(const std::string& reason) {
    const MeshView view(mesh_);
    const bool weld = !geometry_.shared && out_.welded[index_];
    std::vector<std::uint32_t> welded;
    if (weld) {
        welded = log_.run("weld", "vertices are repeated at seams: equal positions are one point",
                          [&] { return weld_exact(view.positions, options_.threads); });
        log_.count_moved("weld", array_bytes(view.positions) + array_bytes(welded));
    } else if (!geometry_.shared) {
        const bool attributes =
            !mesh_.normals.empty() || !mesh_.tangents.empty() || !mesh_.uvs.empty();
        log_.skipped("weld", options_.weld == WeldMode::none ? "switched off"
                             : attributes
                                 ? "the file indexes positions apart from attributes"
                                 : "the file's faces share vertices, and nothing repeats them");
    }
    // Morph targets are shaded over the same topology later.
    const bool walk = mesh_.morph_targets.empty() && may_have_crease_fans(view, options_.normal);
    std::optional<CornerPoints> points;
    log_.run("topology", reason, [&] {
        if (!walk) {
            geometry_.topology = build_topology(view, welded, options_.threads);
            return true;
        }
        points.emplace(view, welded, options_.threads);
        geometry_.around =
            corners_by_vertex(points->of_corners(), view.positions.size(), options_.threads);
        return true;
    });
    if (!geometry_.faces) {
        geometry_.faces = log_.run("face normals", reason, [&] {
            return face_normals(view, options_.normal.precision, options_.threads);
        });
    }
    HardEdgeOptions hard_options = options_.hard_edges;
    hard_options.threads = options_.threads;
    if (out_.subdivided[index_]) {  // hard edges are the cage's, and are marked
        hard_options.angle_degrees.reset();
        hard_options.smoothing_groups = false;
    }
    NormalOptions normal_options = options_.normal;
    normal_options.threads = options_.threads;
    const auto general_edges = [&] {
        return hard_edges(view, *geometry_.topology, *geometry_.faces, hard_options);
    };
    // The walk's normals are made with its edges: their time is theirs.
    std::optional<CreaseNormals> walked;
    auto hard = log_.run("hard edges", reason, [&]() -> Result<HardEdges> {
        if (!walk) return general_edges();
        walked = crease_fans(view, points->of_corners(), welded, *geometry_.around,
                             *geometry_.faces, hard_options, normal_options);
        return walked ? std::move(walked->hard) : HardEdges{};
    });
    if (walk && !walked) {
        log_.run_on("topology", [&] {
            geometry_.topology = build_topology(view, welded, options_.threads);
            return true;
        });
        hard = log_.run_on("hard edges", general_edges);
    }
    if (!hard) return std::move(hard).error();
    count_moved(view, welded, *hard, walked ? &walked->normals : nullptr);
    if (!welded.empty()) geometry_.around.reset();  // they are by point
    log_.count_exact("face normals", geometry_.faces->exact_faces);
    log_.count_exact("hard edges", hard->exact_decisions);
    geometry_.hard = *std::move(hard);
    auto normals = log_.run("normals", reason, [&]() -> Result<CornerNormals> {
        if (walked) return std::move(walked->normals);
        return corner_normals(view, *geometry_.topology, *geometry_.faces, *geometry_.hard,
                              normal_options);
    });
    if (normals) log_.count_exact("normals", normals->exact_sums);
    if (normals && !walked)
        log_.count_moved("normals", surface_bytes(view) + array_bytes(*geometry_.topology) +
                                        array_bytes(*geometry_.faces) +
                                        array_bytes(*geometry_.hard) +
                                        array_bytes(normals->normals));
    geometry_.faces.reset();
    if (mesh_.morph_targets.empty()) geometry_.topology.reset();
    return normals;
}

void MeshPreparation::count_moved(const MeshView& view, std::span<const std::uint32_t> welded,
                                  const HardEdges& hard, const CornerNormals* walked) {
    const std::uint64_t around = geometry_.around ? array_bytes(*geometry_.around) : 0;
    const std::uint64_t topology = geometry_.topology ? array_bytes(*geometry_.topology) : 0;
    const std::uint64_t faces = array_bytes(*geometry_.faces);
    log_.count_moved("topology",
                     array_bytes(view.corner_vertices) + array_bytes(welded) + around + topology);
    log_.count_moved("face normals", surface_bytes(view) + faces);
    log_.count_moved("hard edges", surface_bytes(view) + faces + array_bytes(hard) +
                                       (walked ? around + array_bytes(walked->normals) : topology));
}

void MeshPreparation::skip_normals(const std::string& reason) {
    if (!geometry_.shared) log_.skipped("weld", reason);
    for (const char* stage : {"topology", "face normals", "hard edges", "normals"})
        log_.skipped(stage, reason);
}

void MeshPreparation::report_review(const NormalReview& review) {
    const bool repair = options_.normals == Authored::repair;
    add_finding("missing-normal", Severity::info, review.missing,
                first_corners(review, normal_missing),
                "corners without a normal got a computed one");
    add_finding("non-finite-normal", Severity::warning, review.non_finite,
                first_corners(review, normal_non_finite),
                "authored normals that are not finite were replaced");
    add_finding("zero-normal", Severity::warning, review.zero, first_corners(review, normal_zero),
                "authored normals of length zero were replaced");
    add_finding("non-unit-normal", Severity::warning, review.non_unit,
                first_corners(review, normal_non_unit),
                repair ? "authored normals that are not unit were replaced"
                : keeps_lengths()
                    ? "authored normals that are not unit were kept: the C reference takes them so"
                    : "authored normals that are not unit were rescaled");
    add_finding("flipped-normal", Severity::warning, review.flipped,
                first_corners(review, normal_flipped),
                "authored normals against their face were replaced");
}

void MeshPreparation::report_fallbacks(const CornerNormals& computed) {
    std::vector<std::uint32_t> vanished, undefined;
    std::uint64_t vanished_count = 0, undefined_count = 0;
    for (const auto& fallback : computed.fallbacks) {
        const bool none = fallback.kind == NormalFallback::none_defined;
        ++(none ? undefined_count : vanished_count);
        auto& places = none ? undefined : vanished;
        if (places.size() < Finding::max_places) places.push_back(fallback.corner);
    }
    add_finding("vanishing-normal", Severity::warning, vanished_count, vanished,
                "the face normals around a corner cancel: it took the largest face's");
    add_finding("undefined-normal", Severity::warning, undefined_count, undefined,
                "no face around a corner has a normal: it got (0, 0, 1)");
}

}  // namespace prep::detail
