#include <algorithm>
#include <cmath>

#include "check/check_parts.h"
#include "prep/hard_edges.h"
#include "surface/duplicate_faces.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

bool has_repeated_point(const CheckContext& context, Index begin, Index end,
                        std::vector<Index>& scratch) {
    scratch.clear();
    for (Index c = begin; c < end; ++c) scratch.push_back(context.point_of(c));
    std::sort(scratch.begin(), scratch.end());
    return std::adjacent_find(scratch.begin(), scratch.end()) != scratch.end();
}

// Largest distance of a corner from the mean plane, against the diagonal of the face's box.
bool is_planar(const CheckContext& context, Index face, Index begin, Index end) {
    constexpr double tolerance = 0.01;
    glm::dvec3 centre(0.0), low(0.0), high(0.0);
    const auto at = [&](Index c) {
        return glm::dvec3(context.mesh.positions[context.mesh.corner_vertices[c]]);
    };
    for (Index c = begin; c < end; ++c) {
        const glm::dvec3 p = at(c);
        centre += p / double(end - begin);
        low = c == begin ? p : glm::min(low, p);
        high = c == begin ? p : glm::max(high, p);
    }
    const glm::dvec3& area = context.faces.area_vectors[face];
    const glm::dvec3 normal = area / glm::length(area);
    double off = 0;
    for (Index c = begin; c < end; ++c)
        off = std::max(off, std::abs(glm::dot(at(c) - centre, normal)));
    return off <= tolerance * glm::length(high - low);
}

void find_folds(CheckContext& context) {
    HardEdgeOptions options;
    options.angle_degrees = 179.9;
    options.smoothing_groups = options.marks = false;
    options.threads = context.threads;
    const auto hard = hard_edges(context.view, context.topology, context.faces, options);
    Places folds;
    for (Index c = 0; c < hard->reasons.size(); ++c)
        if ((hard->reasons[c] & hard_angle) && c < context.topology.opposite[c]) folds.add(c);
    context.add("folded-edge", Severity::warning, PlaceKind::edge, std::move(folds),
                "the two faces of the edge lie on each other");
}

}  // namespace

void check_faces(CheckContext& context) {
    const Mesh& mesh = context.mesh;
    MeshSummary& summary = context.summary;
    summary.faces = mesh.face_count();
    summary.corners = mesh.corner_count();
    Places repeated, flat, uneven;
    std::vector<Index> candidates, scratch;
    candidates.reserve(mesh.face_count());
    for (Index f = 0; f < mesh.face_count(); ++f) {
        const Index begin = mesh.face_offsets[f], end = mesh.face_offsets[f + 1];
        const Index corners = end - begin;
        ++(corners == 3 ? summary.triangles : corners == 4 ? summary.quads : summary.polygons);
        summary.largest_face = std::max(summary.largest_face, corners);
        if (has_repeated_point(context, begin, end, scratch))
            repeated.add(f);
        else
            candidates.push_back(f);
        const bool listed = !candidates.empty() && candidates.back() == f;
        if (context.faces.states[f] == FaceState::zero_area && listed) flat.add(f);
        if (context.faces.states[f] != FaceState::regular) continue;
        summary.area += glm::length(context.faces.area_vectors[f]) / 2;
        if (corners > 3 && !is_planar(context, f, begin, end)) uneven.add(f);
    }
    context.add("repeated-vertex-face", Severity::warning, PlaceKind::face, std::move(repeated),
                "two corners of the face are at the same point");
    context.add("zero-area-face", Severity::warning, PlaceKind::face, std::move(flat),
                "the corners differ, but the area is exactly zero");
    const DuplicateFaces found = find_duplicate_faces(mesh, context.topology.welded, candidates);
    Places duplicates, opposites;
    for (const Index f : found.same) duplicates.add(f);
    for (const Index f : found.opposite) opposites.add(f);
    context.add("duplicate-face", Severity::warning, PlaceKind::face, std::move(duplicates),
                "an earlier face has the same points in the same direction");
    context.add("opposite-face", Severity::info, PlaceKind::face, std::move(opposites),
                "an earlier face has the same points in the other direction");
    find_folds(context);
    context.add("non-planar-face", Severity::info, PlaceKind::face, std::move(uneven),
                "a corner is off the mean plane by more than 1 % of the face's size, so that the "
                "triangulation shapes the surface");
}

}  // namespace prep::detail
