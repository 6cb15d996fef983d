#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "repeatable.h"
#include "sample_files.h"

namespace samples {
namespace {

using Point = glm::dvec3;

double length(const Point& p) {
    return std::sqrt(p.x * p.x + p.y * p.y + p.z * p.z);
}
double dot(const Point& a, const Point& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

// The union of two distance fields with a fillet of about `k` where they meet (quadratic
// polynomial smooth minimum, Quilez 2013).
double fuse(double a, double b, double k) {
    const double h = std::max(k - std::fabs(a - b), 0.0) / k;
    return std::min(a, b) - h * h * k / 4;
}

struct Segment {  // a cone with round ends
    Point a, b;
    double radius_a, radius_b;
};

double distance(const Segment& s, const Point& p) {
    const Point ab = s.b - s.a;
    const double t = clamp01(dot(p - s.a, ab) / dot(ab, ab));
    return length(p - (s.a + ab * t)) - mix(s.radius_a, s.radius_b, t);
}

constexpr int joints = 10;  // segments of an arm

std::vector<Segment> arms() {
    constexpr int count = 8;
    std::vector<Segment> segments;
    for (int arm = 0; arm < count; ++arm) {
        const double angle = 2 * pi * (arm + 0.5) / count;
        const double curl = 0.7 + 0.4 * hash01(arm, 3), lift = hash01(arm, 5);
        Point last{};
        for (int j = 0; j <= joints; ++j) {
            const double t = double(j) / joints;
            const double turn = angle + curl * 0.9 * t * t;
            const double reach = 0.18 + 1.12 * t;
            const double height = 0.30 * (1 - t) * (1 - t) + (0.10 + 0.28 * lift) * t * t * t +
                                  0.05 * sine(4 * pi * t + arm);
            const Point here{reach * cosine(turn), height, reach * sine(turn)};
            const double radius = mix(0.15, 0.085, t);
            if (j > 0) segments.push_back({last, here, mix(0.15, 0.085, t - 1.0 / joints), radius});
            last = here;
        }
    }
    return segments;
}

struct Octopus {
    std::vector<Segment> limbs = arms();

    // Negative inside. Continuous with its first derivative but where arms end.
    double operator()(const Point& p) const {
        const Point head{p.x, (p.y - 0.78) * 0.86, p.z + 0.06};
        double d = length(head) - 0.44;
        d = fuse(d, length(p - Point(0, 0.36, 0)) - 0.27, 0.20);
        // Webs between the arms, but no thickening along one.
        double all_arms = 10, arm = 10;
        for (std::size_t i = 0; i < limbs.size(); ++i) {
            arm = fuse(arm, distance(limbs[i], p), 0.04);
            if (i % joints != joints - 1) continue;
            all_arms = fuse(all_arms, arm, 0.22);
            arm = 10;
        }
        d = fuse(d, all_arms, 0.16);
        for (const double sign : {-1.0, 1.0})
            d = fuse(d, length(p - Point(sign * 0.20, 0.68, 0.32)) - 0.115, 0.10);
        return d;
    }
};

struct Surface {
    std::vector<Point> vertices;
    std::vector<std::uint32_t> quads;  // four a face
};

// Naive surface nets (Gibson 1998): one vertex per cell that the surface crosses, at the mean of
// its crossings, then moved onto the surface along the gradient; one quad per crossed grid edge.
template <class Field>
Surface surface_nets(const Field& field, const Point& low, double cell, const glm::ivec3& cells) {
    const glm::ivec3 points = cells + 1;
    const auto grid_point = [&](int x, int y, int z) { return low + Point(x, y, z) * cell; };
    const auto at = [](const glm::ivec3& size, int x, int y, int z) {
        return (std::size_t(z) * std::size_t(size.y) + std::size_t(y)) * std::size_t(size.x) +
               std::size_t(x);
    };
    std::vector<double> value(std::size_t(points.x) * std::size_t(points.y) *
                              std::size_t(points.z));
    for (int z = 0; z < points.z; ++z)
        for (int y = 0; y < points.y; ++y)
            for (int x = 0; x < points.x; ++x)
                value[at(points, x, y, z)] = field(grid_point(x, y, z));

    const auto move_onto = [&](Point p) {
        constexpr double h = 1e-4;
        for (int step = 0; step < 4; ++step) {
            const Point gradient{field(p + Point(h, 0, 0)) - field(p - Point(h, 0, 0)),
                                 field(p + Point(0, h, 0)) - field(p - Point(0, h, 0)),
                                 field(p + Point(0, 0, h)) - field(p - Point(0, 0, h))};
            const double squared = dot(gradient, gradient);
            if (squared < 1e-12) break;
            p = p - gradient * (field(p) * 2 * h / squared);
        }
        return p;
    };

    constexpr std::uint32_t none = 0xFFFFFFFFu;
    std::vector<std::uint32_t> cell_vertex(
        std::size_t(cells.x) * std::size_t(cells.y) * std::size_t(cells.z), none);
    Surface surface;
    for (int z = 0; z < cells.z; ++z)
        for (int y = 0; y < cells.y; ++y)
            for (int x = 0; x < cells.x; ++x) {
                Point sum{0};
                int crossings = 0;
                for (int edge = 0; edge < 12; ++edge) {
                    const int axis = edge / 4, u = edge & 1, v = edge >> 1 & 1;
                    glm::ivec3 a{x, y, z};
                    a[(axis + 1) % 3] += u;
                    a[(axis + 2) % 3] += v;
                    glm::ivec3 b = a;
                    b[axis] += 1;
                    const double da = value[at(points, a.x, a.y, a.z)];
                    const double db = value[at(points, b.x, b.y, b.z)];
                    if ((da < 0) == (db < 0)) continue;
                    const Point pa = grid_point(a.x, a.y, a.z), pb = grid_point(b.x, b.y, b.z);
                    sum = sum + pa + (pb - pa) * (da / (da - db));
                    ++crossings;
                }
                if (crossings == 0) continue;
                cell_vertex[at(cells, x, y, z)] = std::uint32_t(surface.vertices.size());
                surface.vertices.push_back(move_onto(sum / double(crossings)));
            }

    for (int axis = 0; axis < 3; ++axis)
        for (int z = 1; z < cells.z; ++z)
            for (int y = 1; y < cells.y; ++y)
                for (int x = 1; x < cells.x; ++x) {
                    const glm::ivec3 a{x, y, z};
                    glm::ivec3 b = a;
                    b[axis] += 1;
                    const bool inside_a = value[at(points, a.x, a.y, a.z)] < 0;
                    if (inside_a == (value[at(points, b.x, b.y, b.z)] < 0)) continue;
                    std::uint32_t corner[4];
                    constexpr int around[4][2] = {{-1, -1}, {0, -1}, {0, 0}, {-1, 0}};
                    for (int k = 0; k < 4; ++k) {
                        glm::ivec3 c = a;
                        c[(axis + 1) % 3] += around[k][0];
                        c[(axis + 2) % 3] += around[k][1];
                        corner[k] = cell_vertex[at(cells, c.x, c.y, c.z)];
                    }
                    if (!inside_a) std::swap(corner[1], corner[3]);
                    surface.quads.insert(surface.quads.end(), corner, corner + 4);
                }

    // Even the quads out: to the mean of the neighbours, then back onto the surface.
    for (int round = 0; round < 4; ++round) {
        std::vector<Point> sum(surface.vertices.size(), Point(0));
        std::vector<int> count(surface.vertices.size(), 0);
        for (std::size_t i = 0; i < surface.quads.size(); ++i) {
            const std::uint32_t v = surface.quads[i];
            const std::uint32_t next = surface.quads[i % 4 == 3 ? i - 3 : i + 1];
            sum[v] = sum[v] + surface.vertices[next];
            ++count[v];
        }
        for (std::size_t v = 0; v < sum.size(); ++v)
            surface.vertices[v] = move_onto(sum[v] / double(count[v]));
    }
    return surface;
}

void append_little_endian(std::string& bytes, std::uint32_t value) {
    for (int shift = 0; shift < 32; shift += 8) bytes.push_back(char(value >> shift & 0xFF));
}

}  // namespace

std::vector<File> octopus() {
    const Surface surface =
        surface_nets(Octopus{}, Point(-1.60, -0.28, -1.60), 0.058, glm::ivec3(56, 28, 56));
    std::string ply =
        "ply\nformat binary_little_endian 1.0\n"
        "comment An octopus; made by samples/generate_samples.\n"
        "element vertex " +
        std::to_string(surface.vertices.size()) +
        "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
        std::to_string(surface.quads.size() / 4) +
        "\nproperty list uchar int vertex_indices\nend_header\n";
    for (const Point& p : surface.vertices)
        for (const double coordinate : {p.x, p.y, p.z}) {
            // Sixteen binary digits after the point: enough, and nothing hangs on the last bit.
            const double rounded = std::floor(coordinate * 65536 + 0.5) / 65536;
            append_little_endian(ply, std::bit_cast<std::uint32_t>(float(rounded + 0.0)));
        }
    for (std::size_t i = 0; i < surface.quads.size(); i += 4) {
        ply.push_back(4);
        for (std::size_t k = 0; k < 4; ++k) append_little_endian(ply, surface.quads[i + k]);
    }
    return {{"octopus/octopus.ply", ply}};
}

}  // namespace samples
