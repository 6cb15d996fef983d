#include "tessellation/polygon_surface.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "prep/corner_normals.h"
#include "prep/topology.h"

namespace prep::detail {
namespace {

template <class T>
T weighted(const glm::dvec3& w, const T& a, const T& b, const T& c) {
    return w.x * a + w.y * b + w.z * c;
}

// One direction a vertex: the sum of what its fans of faces have, which are several only where
// faces meet in a point or along an edge of three.
std::vector<glm::dvec3> vertex_directions(const Mesh& mesh, const CornerNormals& smooth) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;  // vertex, fan
    for (std::uint32_t c = 0; c < mesh.corner_count(); ++c)
        if (smooth.normals.indices[c] != no_index)
            pairs.emplace_back(mesh.corner_vertices[c], smooth.normals.indices[c]);
    const auto value = [&](std::uint32_t fan) { return smooth.doubles[fan]; };
    const auto less = [&](const auto& p, const auto& q) {
        if (p.first != q.first) return p.first < q.first;
        const glm::dvec3 a = value(p.second), b = value(q.second);
        return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
    };
    std::sort(pairs.begin(), pairs.end(), less);
    std::vector<glm::dvec3> directions(mesh.vertex_count(), glm::dvec3(0, 0, 1));
    for (std::size_t begin = 0, end = 0; begin < pairs.size(); begin = end) {
        glm::dvec3 sum(0.0);
        for (; end < pairs.size() && pairs[end].first == pairs[begin].first; ++end)
            if (end == begin || value(pairs[end].second) != value(pairs[end - 1].second))
                sum += value(pairs[end].second);
        directions[pairs[begin].first] = unit_or(sum, value(pairs[begin].second));
    }
    return directions;
}

}  // namespace

glm::dvec3 unit_or(const glm::dvec3& vector, const glm::dvec3& otherwise) {
    const double length = glm::length(vector);
    return length > 1e-150 && std::isfinite(length) ? vector / length : otherwise;
}

double direction_deviation(const std::array<glm::dvec3, 3>& n) {
    const auto squared = [](const glm::dvec3& v) { return glm::dot(v, v); };
    const double spread =
        std::max({squared(n[0] - n[1]), squared(n[1] - n[2]), squared(n[2] - n[0])});
    if (spread == 0) return 0;
    const glm::dvec3 mean = unit_or(n[0] + n[1] + n[2], glm::dvec3(0.0));
    const double least =
        std::min({glm::dot(n[0], mean), glm::dot(n[1], mean), glm::dot(n[2], mean)});
    if (!(least > 0)) return 2;
    return std::min(2.0, spread / (3 * std::numbers::sqrt3 * least * least));
}

Result<PolygonSurface> PolygonSurface::make(const Mesh& mesh, const Domain& domain,
                                            const HardEdgeOptions& hard_options, int threads) {
    PolygonSurface surface;
    surface.mesh_ = &mesh;
    surface.domain_ = &domain;
    const MeshView view(mesh);
    const Topology topology = build_topology(view, {}, threads);
    const FaceNormals faces = face_normals(view, Precision::accurate, threads);
    NormalOptions by_angle;
    by_angle.weight = NormalWeight::angle;
    by_angle.keep_doubles = true;
    by_angle.threads = threads;
    HardEdges none;
    none.reasons.assign(mesh.corner_count(), hard_none);
    const auto smooth = corner_normals(view, topology, faces, none, by_angle);
    if (!smooth) return smooth.error();
    surface.directions_ = vertex_directions(mesh, *smooth);

    surface.normals_.resize(mesh.corner_count());
    const bool has_normals = !mesh.normals.empty() &&
                             std::none_of(mesh.normals.indices.begin(), mesh.normals.indices.end(),
                                          [](std::uint32_t i) { return i == no_index; });
    if (has_normals) {
        for (std::size_t c = 0; c < mesh.corner_count(); ++c)
            surface.normals_[c] = mesh.normals.values[mesh.normals.indices[c]];
    } else {
        HardEdgeOptions options = hard_options;
        options.threads = threads;
        const auto hard = hard_edges(view, topology, faces, options);
        if (!hard) return hard.error();
        const auto shading = corner_normals(view, topology, faces, *hard, by_angle);
        if (!shading) return shading.error();
        for (std::size_t c = 0; c < mesh.corner_count(); ++c)
            surface.normals_[c] = shading->normals.values[shading->normals.indices[c]];
    }

    surface.centres_.resize(domain.fans());
    for (std::uint32_t fan = 0; fan < domain.fans(); ++fan) {
        Corner sum;
        glm::dvec3 first(0.0);
        double count = 0;
        for_fan_corners(domain, fan, [&](std::uint32_t c) {
            const std::uint32_t v = mesh.corner_vertices[c];
            const glm::dvec3 p(mesh.positions[v]);
            if (count == 0) first = p;
            sum.position += p - first;
            sum.direction += surface.directions_[v];
            sum.normal += glm::dvec3(surface.normals_[c]);
            count += 1;
        });
        Corner& centre = surface.centres_[fan];
        centre.position = first + sum.position / count;
        centre.direction = unit_or(sum.direction, glm::dvec3(0, 0, 1));
        centre.normal = unit_or(sum.normal, centre.direction);
    }
    return surface;
}

std::array<PolygonSurface::Corner, 3> PolygonSurface::corners(std::uint32_t root) const {
    const DomainRoot& r = domain_->roots[root];
    std::array<Corner, 3> three;
    for (std::size_t k = 0; k < 2; ++k) {
        const std::uint32_t v = mesh_->corner_vertices[r.corners[k]];
        three[k] = {glm::dvec3(mesh_->positions[v]), directions_[v],
                    glm::dvec3(normals_[r.corners[k]])};
    }
    three[2] = centres_[r.fan];
    return three;
}

void PolygonSurface::evaluate(std::span<const RootPoint> at, std::span<BasePoint> points) const {
    for (std::size_t k = 0; k < at.size(); ++k) {
        const auto [a, b, c] = corners(at[k].root);
        const glm::dvec3& w = at[k].weights;
        points[k].position = weighted(w, a.position, b.position, c.position);
        points[k].direction =
            unit_or(weighted(w, a.direction, b.direction, c.direction), c.direction);
    }
}

void PolygonSurface::frames(std::span<const RootPoint> at, std::span<BaseFrame> frames) const {
    for (std::size_t k = 0; k < at.size(); ++k) {
        const auto [a, b, c] = corners(at[k].root);
        const glm::dvec3& w = at[k].weights;
        BaseFrame& frame = frames[k];
        frame.point.position = weighted(w, a.position, b.position, c.position);
        const glm::dvec3 sum = weighted(w, a.direction, b.direction, c.direction);
        const glm::dvec3 n = frame.point.direction = unit_or(sum, c.direction);
        frame.normal = unit_or(weighted(w, a.normal, b.normal, c.normal), n);
        frame.position_steps = {b.position - a.position, c.position - a.position};
        const double length = std::max(glm::length(sum), 1e-150);
        const std::array<glm::dvec3, 2> steps{b.direction - a.direction, c.direction - a.direction};
        for (std::size_t s = 0; s < 2; ++s)
            frame.direction_steps[s] = (steps[s] - glm::dot(steps[s], n) * n) / length;
    }
}

BaseDeviation PolygonSurface::deviation(std::uint32_t root,
                                        const std::array<glm::dvec3, 3>& weights,
                                        const std::array<BasePoint, 3>&) const {
    const auto [a, b, c] = corners(root);
    std::array<glm::dvec3, 3> values;
    for (std::size_t k = 0; k < 3; ++k)
        values[k] = weighted(weights[k], a.direction, b.direction, c.direction);
    return {0, direction_deviation(values)};
}

}  // namespace prep::detail
