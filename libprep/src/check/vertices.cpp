#include <algorithm>
#include <cmath>

#include "base/finite.h"
#include "check/check_parts.h"

namespace prep::detail {
namespace {

bool denormal(const glm::vec3& p) {
    const auto is = [](float x) { return std::fpclassify(x) == FP_SUBNORMAL; };
    return is(p.x) || is(p.y) || is(p.z);
}

std::vector<bool> used_vertices(const Mesh& mesh) {
    std::vector<bool> used(mesh.vertex_count(), false);
    for (const std::uint32_t v : mesh.corner_vertices) used[v] = true;
    for (const std::uint32_t v : mesh.line_vertices) used[v] = true;
    for (const std::uint32_t v : mesh.points) used[v] = true;
    return used;
}

}  // namespace

void check_vertices(CheckContext& context) {
    const Mesh& mesh = context.mesh;
    MeshSummary& summary = context.summary;
    summary.vertices = mesh.vertex_count();
    summary.point_primitives = mesh.points.size();
    for (std::size_t l = 0; l + 1 < mesh.line_offsets.size(); ++l)
        summary.line_segments +=
            std::max<std::uint32_t>(mesh.line_offsets[l + 1] - mesh.line_offsets[l], 1) - 1;

    const std::vector<bool> used = used_vertices(mesh);
    Places bad, small, unused, repeated, farthest;
    glm::vec3 low(0.0f), high(0.0f);
    float reach = 0;
    std::uint32_t reach_vertex = 0;
    bool any = false;
    for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
        const glm::vec3& p = mesh.positions[v];
        if (!is_finite(p)) bad.add(v);
        if (denormal(p)) small.add(v);
        if (!used[v]) unused.add(v);
        if (context.topology.welded[v] != v) repeated.add(v);
        const auto& offsets = context.topology.point_offsets;
        if (is_finite(p) && offsets[v + 1] > offsets[v]) ++summary.points;
        if (!used[v] || !is_finite(p)) continue;
        low = any ? glm::min(low, p) : p;
        high = any ? glm::max(high, p) : p;
        any = true;
        const float size = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
        if (size > reach) {
            reach = size;
            reach_vertex = v;
        }
    }
    if (any) {
        summary.low = mesh.origin + glm::dvec3(low);
        summary.high = mesh.origin + glm::dvec3(high);
        // Coordinates are rounded by up to reach · 2⁻²⁴.
        const double extent = glm::length(glm::dvec3(high) - glm::dvec3(low));
        if (extent > 0 && double(reach) * 0x1p-24 > extent * 0x1p-16) farthest.add(reach_vertex);
    }
    context.add("non-finite-vertex", Severity::error, PlaceKind::vertex, std::move(bad),
                "a coordinate is NaN or infinite");
    context.add("denormal-vertex", Severity::info, PlaceKind::vertex, std::move(small),
                "a coordinate is too small for a normal float: tools that flush it to zero see "
                "another shape");
    context.add("unreferenced-vertex", Severity::info, PlaceKind::vertex, std::move(unused),
                "no face, line or point uses the vertex");
    Places points;
    std::vector<std::uint32_t> sorted(mesh.points);
    std::sort(sorted.begin(), sorted.end());
    for (const std::uint32_t v : sorted) points.add(v);
    context.add("isolated-point", Severity::info, PlaceKind::vertex, std::move(points),
                "the vertex is drawn as a point");
    context.add("repeated-position", Severity::info, PlaceKind::vertex, std::move(repeated),
                "an earlier vertex has the same position");
    context.add(
        "far-from-origin", Severity::warning, PlaceKind::vertex, std::move(farthest),
        "so far from zero that rounding to floats may move vertices by more than 1/65536 of "
        "the extent");
    if (mesh.face_count() == 0 && summary.line_segments == 0 && mesh.points.empty()) {
        Places whole;
        whole.count = 1;
        context.add("empty-mesh", Severity::warning, PlaceKind::face, std::move(whole),
                    "there are no faces, lines or points");
    }
}

}  // namespace prep::detail
