// Triangulations of the plane: every sample inside is covered exactly once. The oracles are integer
// arithmetic in 128 bits and crossing numbers.
#include <gtest/gtest.h>

#include <algorithm>

#include "hits.h"

namespace {

using namespace hits;

enum class Place { outside, boundary, inside };

Place place_in(const std::vector<Point>& polygon, const Point& p) {
    bool inside = false;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Point &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        if (on_segment(p, a, b)) return Place::boundary;
        if ((a.y > p.y) != (b.y > p.y) && orientation(a, b, p) == (b.y > a.y ? 1 : -1))
            inside = !inside;
    }
    return inside ? Place::inside : Place::outside;
}

// -------------------------------------------------------------------------- planar triangulations

// A star-shaped polygon about a point, counter-clockwise where y runs down or not.
std::vector<Point> random_polygon(std::mt19937_64& random, std::uint32_t extent) {
    const std::size_t corners = 3 + random() % 20;
    const Point middle{std::int64_t(extent) * 128, std::int64_t(extent) * 128};
    std::vector<Point> around;
    const std::int64_t step = random_step(random);
    for (std::size_t i = 0; i < corners; ++i) {
        const Point p{random_coordinate(random, extent, step),
                      random_coordinate(random, extent, step)};
        if (!(p == middle)) around.push_back(p);
    }
    const auto half = [&](const Point& p) {
        return p.y > middle.y || (p.y == middle.y && p.x > middle.x) ? 0 : 1;
    };
    const auto squared = [&](const Point& p) {
        return (p.x - middle.x) * (p.x - middle.x) + (p.y - middle.y) * (p.y - middle.y);
    };
    std::sort(around.begin(), around.end(), [&](const Point& a, const Point& b) {
        if (half(a) != half(b)) return half(a) < half(b);
        const int turn = orientation(middle, a, b);
        return turn != 0 ? turn > 0 : squared(a) < squared(b);
    });
    // One corner per direction.
    std::vector<Point> polygon;
    for (const Point& p : around)
        if (polygon.empty() || half(polygon.back()) != half(p) ||
            orientation(middle, polygon.back(), p) != 0)
            polygon.push_back(p);
    return polygon;
}

// Ears cut off in random order; empty when the polygon is not simple or goes round clockwise.
std::vector<Triangle> ears(const std::vector<Point>& p, std::mt19937_64& random) {
    std::vector<std::uint32_t> ring(p.size());
    for (std::uint32_t i = 0; i < p.size(); ++i) ring[i] = i;
    std::vector<Triangle> triangles;
    while (ring.size() > 2) {
        const std::size_t n = ring.size(), start = random() % n;
        bool found = false;
        for (std::size_t k = 0; k < n && !found; ++k) {
            const std::size_t i = (start + k) % n;
            const std::uint32_t a = ring[(i + n - 1) % n], b = ring[i], c = ring[(i + 1) % n];
            if (orientation(p[a], p[b], p[c]) <= 0) continue;
            bool empty = true;
            for (const std::uint32_t q : ring)
                empty = empty &&
                        (q == a || q == b || q == c || orientation(p[a], p[b], p[q]) < 0 ||
                         orientation(p[b], p[c], p[q]) < 0 || orientation(p[c], p[a], p[q]) < 0);
            if (!empty) continue;
            triangles.push_back({a, b, c});
            ring.erase(ring.begin() + std::ptrdiff_t(i));
            found = true;
        }
        if (!found) return {};
    }
    return triangles;
}

bool simple(const std::vector<Point>& p) {
    const std::size_t n = p.size();
    if (n < 3) return false;
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = i + 1; j < n; ++j) {
            const Point &a = p[i], &b = p[(i + 1) % n], &c = p[j], &d = p[(j + 1) % n];
            const bool next = j == i + 1, last = (j + 1) % n == i;
            if (!next && !last) {
                if (on_segment(a, c, d) || on_segment(b, c, d) || on_segment(c, a, b) ||
                    on_segment(d, a, b))
                    return false;
                if (orientation(a, b, c) != orientation(a, b, d) &&
                    orientation(c, d, a) != orientation(c, d, b))
                    return false;
            } else if ((next && n > 2 && on_segment(d, a, b)) || (last && on_segment(c, a, b))) {
                return false;
            }
        }
    return true;
}

TEST(Coverage, TriangulatedPolygonsCoverEveryInsideSampleOnce) {
    std::mt19937_64 random(3);
    constexpr std::uint32_t extent = 48;
    const auto positions = every_sample();
    std::uint64_t polygons = 0, inside = 0, wrong = 0, boundary = 0;
    for (int n = 0; n < 1500; ++n) {
        const std::vector<Point> polygon = random_polygon(random, extent);
        if (!simple(polygon)) continue;
        const std::vector<Triangle> triangles = ears(polygon, random);
        if (triangles.empty()) continue;
        ++polygons;
        for (const bool turned : {false, true}) {
            std::vector<Triangle> wound = triangles;
            if (turned)
                for (Triangle& t : wound) std::swap(t[0], t[2]);
            std::vector<ScreenVertex> vertices;
            for (const Point& p : polygon)  // each at a distance of its own
                vertices.push_back(
                    vertex_at(p.x, p.y, extent, extent, 0.1 + 0.01 * double(random() % 1000)));
            HitOptions options;
            options.offset = positions[polygons % positions.size()];
            const Hits hits = count_hits(vertices, wound, extent, extent, options);
            for (std::uint32_t y = 0; y < extent; ++y)
                for (std::uint32_t x = 0; x < extent; ++x) {
                    const Place place = place_in(polygon, sample_of(x, y, options.offset));
                    const int seen = hits.at(x, y, !turned);
                    wrong += hits.at(x, y, turned) != 0;
                    if (place == Place::boundary) {
                        wrong += seen > 1;
                        ++boundary;
                    } else {
                        wrong += seen != (place == Place::inside ? 1 : 0);
                        inside += place == Place::inside;
                    }
                }
        }
    }
    EXPECT_EQ(wrong, 0u);
    EXPECT_GT(polygons, 300u);
    EXPECT_GT(inside, 100000u);
    EXPECT_GT(boundary, 1000u);
}

// A rectangle cut up by points put in at random, on edges too, with random flips: full of slivers.
struct Triangulation {
    std::vector<Point> points;
    std::vector<Triangle> triangles;

    void insert(const Point& p) {
        for (const Point& q : points)
            if (p == q) return;
        const std::uint32_t index = std::uint32_t(points.size());
        std::vector<Triangle> kept;
        bool placed = false;
        for (const Triangle& t : triangles) {
            int side[3];
            bool holds = true;
            for (int i = 0; i < 3; ++i) {
                side[i] = orientation(points[t[i]], points[t[(i + 1) % 3]], p);
                holds = holds && side[i] >= 0;
            }
            if (!holds) {
                kept.push_back(t);
                continue;
            }
            placed = true;
            for (int i = 0; i < 3; ++i)
                if (side[i] > 0) kept.push_back({t[i], t[(i + 1) % 3], index});
        }
        if (placed) points.push_back(p);
        triangles = std::move(kept);
    }

    // Turns an inner edge round where its two triangles are convex and `wanted` says so.
    template <class Wanted>
    bool flip(std::size_t t, int i, const Wanted& wanted) {
        const std::uint32_t a = triangles[t][i], b = triangles[t][(i + 1) % 3],
                            c = triangles[t][(i + 2) % 3];
        for (Triangle& other : triangles)
            for (int k = 0; k < 3; ++k) {
                if (other[k] != b || other[(k + 1) % 3] != a) continue;
                const std::uint32_t d = other[(k + 2) % 3];
                if (orientation(points[c], points[d], points[b]) <= 0 ||
                    orientation(points[d], points[c], points[a]) <= 0 || !wanted(a, b, c, d))
                    return false;
                other = {c, d, b};
                triangles[t] = {d, c, a};
                return true;
            }
        return false;
    }

    void flip_at_random(std::mt19937_64& random) {
        const std::size_t t = random() % triangles.size();
        flip(t, int(random() % 3), [](auto...) { return true; });
    }

    // Lawson (1977): until no corner lies in the circle of a neighbour.
    void make_delaunay() {
        const auto in_circle = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c,
                                   std::uint32_t d) {
            Wide x[3], y[3], square[3];
            const std::uint32_t corners[3] = {a, b, c};
            for (int k = 0; k < 3; ++k) {
                x[k] = points[corners[k]].x - points[d].x;
                y[k] = points[corners[k]].y - points[d].y;
                square[k] = x[k] * x[k] + y[k] * y[k];
            }
            return square[0] * (x[1] * y[2] - x[2] * y[1]) +
                       square[1] * (x[2] * y[0] - x[0] * y[2]) +
                       square[2] * (x[0] * y[1] - x[1] * y[0]) >
                   0;
        };
        for (bool changed = true; changed;) {
            changed = false;
            for (std::size_t t = 0; t < triangles.size(); ++t)
                for (int i = 0; i < 3; ++i) changed = flip(t, i, in_circle) || changed;
        }
    }
};

Triangulation rectangle(std::int64_t low, std::int64_t high) {
    return {{{low, low}, {high, low}, {high, high}, {low, high}}, {{0, 1, 2}, {0, 2, 3}}};
}

// The triangles tile the whole picture: either winding hits every sample once, on its own side.
Hits expect_every_sample_once(const Triangulation& mesh, std::uint32_t extent,
                              const HitOptions& options, std::mt19937_64& random) {
    std::vector<ScreenVertex> vertices;
    for (const Point& p : mesh.points)  // each at a distance of its own
        vertices.push_back(
            vertex_at(p.x, p.y, extent, extent, 0.1 + 0.01 * double(random() % 1000)));
    Hits hits;
    for (const bool turned : {false, true}) {
        std::vector<Triangle> wound = mesh.triangles;
        if (turned)
            for (Triangle& t : wound) std::swap(t[1], t[2]);
        hits = count_hits(vertices, wound, extent, extent, options);
        std::size_t wrong = 0;
        for (std::uint32_t y = 0; y < extent; ++y)
            for (std::uint32_t x = 0; x < extent; ++x)
                wrong += hits.at(x, y, !turned) != 1 || hits.at(x, y, turned) != 0;
        EXPECT_EQ(wrong, 0u);
    }
    return hits;
}

TEST(Coverage, TriangulatedRectanglesCoverEverySampleOnce) {
    std::mt19937_64 random(4);
    constexpr std::uint32_t extent = 32;
    const auto positions = every_sample();
    for (std::size_t n = 0; n < 155; ++n) {
        // From inside the picture to corners beyond the guard band, where edges are homogeneous.
        const std::int64_t reach = n % 3 == 0 ? 0 : n % 3 == 1 ? 16000 * 256 : 3000000 * 256ll;
        const std::int64_t step = random_step(random);
        Triangulation mesh = rectangle(-reach, extent * 256 + reach);
        for (int k = 0; k < 60; ++k)
            mesh.insert(
                {random_coordinate(random, extent, step), random_coordinate(random, extent, step)});
        for (int k = 0; k < 100; ++k) mesh.flip_at_random(random);
        HitOptions options;
        options.offset = positions[n % positions.size()];
        const Hits hits = expect_every_sample_once(mesh, extent, options, random);
        EXPECT_EQ(hits.counters.crossing > 0, reach > 16384 * 256) << n;
    }
}

TEST(Coverage, DelaunayTriangulationsCoverEverySampleOnce) {
    std::mt19937_64 random(10);
    constexpr std::uint32_t extent = 32;
    const auto positions = every_sample();
    std::size_t triangles = 0;
    for (std::size_t n = 0; n < 2 * positions.size(); ++n) {
        const std::int64_t step = random_step(random);
        Triangulation mesh = rectangle(0, extent * 256);
        for (int k = 0; k < 80; ++k)
            mesh.insert(
                {random_coordinate(random, extent, step), random_coordinate(random, extent, step)});
        mesh.make_delaunay();
        HitOptions options;
        options.offset = positions[n % positions.size()];
        expect_every_sample_once(mesh, extent, options, random);
        triangles += mesh.triangles.size();
    }
    EXPECT_GT(triangles, 6000u);
}

// Hubs on samples, off them and at the border: dozens of edges through one point, slivers between.
TEST(Coverage, FansCoverEverySampleOnce) {
    std::mt19937_64 random(11);
    constexpr std::uint32_t extent = 32;
    constexpr std::int64_t side = extent * 256;
    const auto positions = every_sample();
    for (std::size_t n = 0; n < 4 * positions.size(); ++n) {
        const std::int64_t step = random_step(random);
        // Along the rim, clockwise on the screen from the top left corner.
        std::vector<std::int64_t> along{0, side, 2 * side, 3 * side};
        for (int k = 0; k < 90; ++k) along.push_back(std::int64_t(random() % (4 * side)));
        std::sort(along.begin(), along.end());
        along.erase(std::unique(along.begin(), along.end()), along.end());
        Triangulation mesh;
        for (const std::int64_t s : along) {
            const std::int64_t part = s % side;
            const Point rim[4] = {{part, 0}, {side, part}, {side - part, side}, {0, side - part}};
            mesh.points.push_back(rim[s / side]);
        }
        const std::uint32_t count = std::uint32_t(along.size());
        mesh.points.push_back({random_coordinate(random, extent, step),
                               n % 4 == 0 ? 0 : random_coordinate(random, extent, step)});
        for (std::uint32_t k = 0; k < count; ++k)
            mesh.triangles.push_back({count, k, (k + 1) % count});
        HitOptions options;
        options.offset = positions[n % positions.size()];
        expect_every_sample_once(mesh, extent, options, random);
    }
}

}  // namespace
