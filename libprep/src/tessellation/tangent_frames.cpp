#include "tessellation/tangent_frames.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "base/parallel.h"
#include "prep/tangents.h"
#include "tessellation/polygon_surface.h"

namespace prep::detail {
namespace {

glm::dvec3 any_perpendicular(const glm::dvec3& n) {
    const glm::dvec3 size = glm::abs(n);
    const glm::dvec3 axis = size.x <= size.y && size.x <= size.z ? glm::dvec3(1, 0, 0)
                            : size.y <= size.z                   ? glm::dvec3(0, 1, 0)
                                                                 : glm::dvec3(0, 0, 1);
    return unit_or(glm::cross(n, axis), glm::dvec3(1, 0, 0));
}

// The surface's directions at the corners of the cage; no_index at those without a root. Those at a
// vertex that differ by roundings only are one value, as tangents are shared between equal normals.
CornerLayer<glm::vec3> corner_directions(const Mesh& mesh, const Domain& domain,
                                         const BaseSurface& base, int threads) {
    std::vector<BasePoint> points(domain.roots.size());
    parallel_blocks(points.size(), 1024, threads, [&](std::size_t begin, std::size_t end) {
        std::vector<RootPoint> at;
        for (std::size_t r = begin; r < end; ++r)
            at.push_back({std::uint32_t(r), glm::dvec3(1, 0, 0)});
        base.evaluate(at, std::span(points).subspan(begin, end - begin));
    });
    constexpr double same = 1e-6;
    CornerLayer<glm::vec3> layer;
    layer.indices.assign(mesh.corner_count(), no_index);
    // The values of a vertex are a list: the newest first, and the one before each.
    std::vector<std::uint32_t> newest(mesh.vertex_count(), no_index), before;
    std::vector<glm::dvec3> exact;
    for (std::size_t r = 0; r < points.size(); ++r) {
        const std::uint32_t corner = domain.roots[r].corners[0];
        std::uint32_t& first = newest[mesh.corner_vertices[corner]];
        std::uint32_t value = first;
        while (value != no_index && !(glm::length(exact[value] - points[r].direction) < same))
            value = before[value];
        if (value == no_index) {
            value = std::uint32_t(exact.size());
            exact.push_back(points[r].direction);
            layer.values.push_back(glm::vec3(points[r].direction));
            before.push_back(first);
            first = value;
        }
        layer.indices[corner] = value;
    }
    return layer;
}

// Twice the area of the fan's UVs; 0 where a corner has none.
double uv_area(const Domain& domain, std::uint32_t fan, const CornerLayer<glm::vec2>& uvs) {
    const auto at = [&](std::uint32_t c) { return glm::dvec2(uvs.values[uvs.indices[c]]); };
    for (std::uint32_t r = domain.fan_roots[fan]; r < domain.fan_roots[fan + 1]; ++r)
        if (uvs.indices[domain.roots[r].corners[0]] == no_index) return 0;
    const glm::dvec2 about = at(domain.roots[domain.fan_roots[fan]].corners[0]);
    double area = 0;
    for (std::uint32_t r = domain.fan_roots[fan]; r < domain.fan_roots[fan + 1]; ++r) {
        const glm::dvec2 a = at(domain.roots[r].corners[0]) - about;
        const glm::dvec2 b = at(domain.roots[r].corners[1]) - about;
        area += a.x * b.y - a.y * b.x;
    }
    return area;
}

// The least cosine to their mean, about, at which tangents count as leaning to it, and the least
// length of n × τ.
constexpr double least_lean = 0.05;

// Whether vectors have components of at least `least` along their mean.
bool lean(std::span<const glm::dvec3> vectors, double least) {
    glm::dvec3 mean(0.0);
    for (const glm::dvec3& v : vectors) mean += v;
    mean = unit_or(mean, glm::dvec3(0.0));
    return std::all_of(vectors.begin(), vectors.end(),
                       [&](const glm::dvec3& v) { return glm::dot(v, mean) > least; });
}

// n × τ of directions and tangents that are linear over a triangle: its Bézier coefficients.
std::array<glm::dvec3, 6> across_triangle(const std::array<glm::dvec3, 3>& n,
                                          const std::array<glm::dvec3, 3>& tangents) {
    std::array<glm::dvec3, 6> across;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t next = (k + 1) % 3;
        across[k] = glm::cross(n[k], tangents[k]);
        across[3 + k] = 0.5 * (glm::cross(n[k], tangents[next]) + glm::cross(n[next], tangents[k]));
    }
    return across;
}

// The surface's directions over the roots of a fan, at the points of a grid.
class FanDirections {
  public:
    FanDirections(const Domain& domain, std::uint32_t fan, const BaseSurface& base) {
        for (std::uint32_t r = domain.fan_roots[fan]; r < domain.fan_roots[fan + 1]; ++r)
            for (int j = 0; j <= steps; ++j)
                for (int i = 0; i + j <= steps; ++i)
                    at_.push_back({r, glm::dvec3(steps - i - j, i, j) / double(steps)});
        points_.resize(at_.size());
        base.evaluate(at_, points_);
    }

    // Whether n × τ has a direction everywhere: in each cell of the grid those at its corners lean
    // to their mean. tangents(root) are those at the root's corners.
    template <class Tangents>
    bool are_across(const Tangents& tangents) const {
        std::vector<glm::dvec3> across;
        for (std::size_t k = 0; k < at_.size(); ++k) {
            const auto [a, b, c] = tangents(at_[k].root);
            const glm::dvec3& w = at_[k].weights;
            across.push_back(glm::cross(points_[k].direction, w.x * a + w.y * b + w.z * c));
        }
        constexpr std::size_t of_root = (steps + 1) * (steps + 2) / 2;
        for (std::size_t root = 0; root < across.size(); root += of_root) {
            std::size_t row = root;
            for (std::size_t j = 0; j < steps; ++j) {
                const std::size_t length = steps + 1 - j, above = row + length;
                for (std::size_t i = 0; i + 1 < length; ++i) {
                    const glm::dvec3 &p = across[row + i], &q = across[row + i + 1],
                                     &r = across[above + i];
                    if (!lean(std::array{p, q, r}, least_lean)) return false;
                    if (i + 2 < length &&
                        !lean(std::array{q, across[above + i + 1], r}, least_lean))
                        return false;
                }
                row = above;
            }
        }
        return true;
    }

  private:
    static constexpr int steps = 8;
    std::vector<RootPoint> at_;
    std::vector<BasePoint> points_;
};

double largest_difference(const std::array<glm::dvec3, 3>& v) {
    return std::max({glm::length(v[0] - v[1]), glm::length(v[1] - v[2]), glm::length(v[2] - v[0])});
}

}  // namespace

Result<TangentFrames> TangentFrames::make(const Mesh& mesh, const Domain& domain,
                                          const BaseSurface& base, std::size_t uv_set,
                                          int threads) {
    const CornerLayer<glm::vec3> normals = corner_directions(mesh, domain, base, threads);
    const CornerLayer<glm::vec2>& uvs = mesh.uvs[uv_set];
    TangentInput input;
    input.positions = mesh.positions;
    input.face_offsets = mesh.face_offsets;
    input.corner_vertices = mesh.corner_vertices;
    input.normals = normals;
    input.uv = uvs;
    TangentOptions options;
    options.threads = threads;
    const Result<CornerTangents> made = corner_tangents(input, options);
    if (!made) return made.error();
    const CornerLayer<glm::vec4>& tangents = made->tangents;

    TangentFrames frames;
    frames.corners_.resize(mesh.corner_count());
    for (std::size_t c = 0; c < frames.corners_.size(); ++c)
        frames.corners_[c] = glm::dvec3(tangents.values[tangents.indices[c]]);
    frames.centres_.assign(domain.fans(), glm::dvec3(0.0));
    frames.signs_.resize(domain.fans());
    for (std::uint32_t fan = 0; fan < domain.fans(); ++fan) {
        for_fan_corners(domain, fan,
                        [&](std::uint32_t c) { frames.centres_[fan] += frames.corners_[c]; });
        const std::uint32_t first = domain.fan_roots[fan];
        frames.centres_[fan] /= double(domain.fan_roots[fan + 1] - first);
        const double area = uv_area(domain, fan, uvs);
        const std::uint32_t corner = domain.roots[first].corners[0];
        const double sign = double(tangents.values[tangents.indices[corner]].w);
        frames.signs_[fan] = area > 0 ? -1 : area < 0 ? 1 : sign;
    }
    frames.keep_from_cancelling(domain, base, normals, threads);
    return frames;
}

void TangentFrames::keep_from_cancelling(const Domain& domain, const BaseSurface& base,
                                         const CornerLayer<glm::vec3>& normals, int threads) {
    constant_.assign(domain.fans(), 0);
    std::vector<BasePoint> centres(domain.fans());
    parallel_blocks(centres.size(), 1024, threads, [&](std::size_t begin, std::size_t end) {
        std::vector<RootPoint> at;
        for (std::size_t fan = begin; fan < end; ++fan)
            at.push_back({domain.fan_roots[fan], {0, 0, 1}});
        base.evaluate(at, std::span(centres).subspan(begin, end - begin));
    });
    const auto normal = [&](std::uint32_t c) {
        return glm::dvec3(normals.values[normals.indices[c]]);
    };
    for (std::uint32_t fan = 0; fan < domain.fans(); ++fan) {
        const glm::dvec3& n = centres[fan].direction;
        const glm::dvec3 mean = centres_[fan];
        bool leans = glm::length(mean) > least_lean;
        for_fan_corners(domain, fan, [&](std::uint32_t c) {
            leans = leans && glm::dot(corners_[c], mean) > least_lean * glm::length(mean);
        });
        // Most faces are far from it, and need no closer look.
        constexpr double well = 0.5;
        bool leans_well = leans;
        for (std::uint32_t r = domain.fan_roots[fan]; r < domain.fan_roots[fan + 1]; ++r) {
            const auto [a, b] = domain.roots[r].corners;
            leans_well = leans_well && lean(across_triangle({normal(a), normal(b), n},
                                                            {corners_[a], corners_[b], mean}),
                                            well);
        }
        if (leans_well) continue;
        const FanDirections directions(domain, fan, base);
        const auto stays_across = [&] {
            return directions.are_across(
                [&](std::uint32_t root) { return tangents(domain.roots[root]); });
        };
        if (leans && stays_across()) continue;
        constant_[fan] = 1;
        const glm::dvec3 level = mean - glm::dot(mean, n) * n;
        const glm::dvec3 first =
            glm::length(level) > least_lean ? glm::normalize(level) : any_perpendicular(n);
        // The nearest to it that no direction of the fan is along, where there is any.
        constexpr int turns = 8;
        for (int k = 0; k < turns; ++k) {
            const double angle = (k % 2 ? 1 : -1) * ((k + 1) / 2) * (3.14159265358979324 / turns);
            centres_[fan] = std::cos(angle) * first + std::sin(angle) * glm::cross(n, first);
            if (stays_across()) break;
            centres_[fan] = first;
        }
    }
}

std::array<glm::dvec3, 3> TangentFrames::tangents(const DomainRoot& root) const {
    const glm::dvec3& centre = centres_[root.fan];
    if (constant_[root.fan]) return {centre, centre, centre};
    return {corners_[root.corners[0]], corners_[root.corners[1]], centre};
}

TangentFrame TangentFrames::at(const DomainRoot& root, const glm::dvec3& weights,
                               const glm::dvec3& direction) const {
    const auto [a, b, c] = tangents(root);
    TangentFrame frame;
    frame.tangent = weights.x * a + weights.y * b + weights.z * c;
    frame.across = glm::cross(direction, frame.tangent);
    // Shorter ones are roundings: tangents are floats, about one long.
    const double length = glm::length(frame.across);
    frame.is_arbitrary = !(length > 1e-12);
    const glm::dvec3 side =
        frame.is_arbitrary ? any_perpendicular(direction) : frame.across / length;
    frame.axes = {glm::cross(side, direction), signs_[root.fan] * side, direction};
    return frame;
}

glm::dmat3 TangentFrames::step(const DomainRoot& root, const TangentFrame& frame, std::size_t axis,
                               const glm::dvec3& turn) const {
    glm::dmat3 change(0.0);
    change[2] = turn;
    if (frame.is_arbitrary) return change;
    const std::array<glm::dvec3, 3> tangents = this->tangents(root);
    const double sign = signs_[root.fan];
    const glm::dvec3 side = sign * frame.axes[1];
    const glm::dvec3 rise = glm::cross(turn, frame.tangent) +
                            glm::cross(frame.axes[2], tangents[axis + 1] - tangents[0]);
    const glm::dvec3 of_side = (rise - glm::dot(rise, side) * side) / glm::length(frame.across);
    change[0] = glm::cross(of_side, frame.axes[2]) + glm::cross(side, turn);
    change[1] = sign * of_side;
    return change;
}

double frame_deviation(const std::array<TangentFrame, 3>& corners, double turn) {
    std::array<glm::dvec3, 3> n, t, across, side;
    double longest = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        n[k] = corners[k].axes[2];
        t[k] = corners[k].tangent;
        across[k] = corners[k].across;
        side[k] = corners[k].axes[1];
        longest = std::max(longest, glm::length(t[k]));
    }
    const double of_n = std::min(2.0, turn);  // of unit vectors
    const double turns = largest_difference(n) / 3;
    const double e = of_n * longest + turns * largest_difference(t);
    const glm::dvec3 mean = unit_or(across[0] + across[1] + across[2], glm::dvec3(0.0));
    const double least =
        std::min({glm::dot(across[0], mean), glm::dot(across[1], mean), glm::dot(across[2], mean)});
    double of_side = 2;
    // The last term is what the sides' own roundings are over so short a vector.
    if (least > 1e-6 && 2 * least > e)
        of_side =
            std::min(2.0, 2 * e / (2 * least - e) + direction_deviation(across) + 0x1p-46 / least);
    const double of_tangent = std::min(2.0, of_side + of_n + turns * largest_difference(side));
    return std::sqrt(of_side * of_side + of_tangent * of_tangent + of_n * of_n);
}

}  // namespace prep::detail
