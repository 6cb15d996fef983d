// Which samples triangles cover. The oracles are integer arithmetic in 128 bits, crossing numbers
// and rays in double, all written here.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <numbers>
#include <optional>
#include <random>

#include "instance.h"
#include "samples.h"
#include "setup.h"
#include "shapes.h"

namespace {

using Wide = __int128;
using prep::SimdLevel;
using rast::detail::CullSide;
using rast::detail::SampleOffset;
using rast::detail::ScreenVertex;
using Triangle = std::array<std::uint32_t, 3>;

// Vertices that are given, not transformed.
class Given final : public rast::detail::VertexSource {
  public:
    explicit Given(const std::vector<ScreenVertex>& vertices) : vertices_(vertices) {}
    ScreenVertex homogeneous(std::uint32_t vertex) const override { return vertices_[vertex]; }

  private:
    const std::vector<ScreenVertex>& vertices_;
};

struct Hits {
    std::uint32_t width, height;
    std::vector<int> front, back;
    std::vector<float> nearest;  // −1: nothing
    rast::Counters counters;
    int at(std::uint32_t x, std::uint32_t y, bool of_back) const {
        return (of_back ? back : front)[std::size_t(y) * width + x];
    }
};

struct HitOptions {
    SimdLevel level = SimdLevel::automatic;
    CullSide cull = CullSide::none;
    std::optional<SampleOffset> offset;  // set: one of several samples of a pixel
};

// Each triangle is set up and drawn alone, so that none hides another.
Hits count_hits(const std::vector<ScreenVertex>& vertices, const std::vector<Triangle>& triangles,
                std::uint32_t width, std::uint32_t height, const HitOptions& options = {}) {
    using namespace rast::detail;
    const Kernels& kernels = kernels_for(options.level);
    Hits hits{width, height, {}, {}, {}, {}};
    const std::size_t pixels = std::size_t(width) * height;
    hits.front.assign(pixels, 0);
    hits.back.assign(pixels, 0);
    hits.nearest.assign(pixels, -1.0f);
    const Given source(vertices);
    std::vector<VertexRecord> records;
    for (const ScreenVertex& v : vertices) records.push_back(record_of(v));
    Window window;
    window.width = std::int32_t(width);
    window.height = std::int32_t(height);
    window.first_x = (1 - window.width) * 128;
    window.first_y = (1 - window.height) * 128;
    window.tiles_x = (window.width + tile_size - 1) / tile_size;
    window.tiles_y = (window.height + tile_size - 1) / tile_size;
    BinScratch scratch;
    TriangleChunk chunk;
    chunk.count = 1;
    TileSamples samples;
    samples.clear();
    const DrawGeometry geometry{&source, records.data(), triangles.data()->data(), false,
                                options.cull};
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        chunk.first_triangle = std::uint32_t(t);
        set_up_chunk(geometry, window, options.offset.has_value(), kernels, scratch, chunk);
        const rast::Counters& c = chunk.counters;
        hits.counters.non_finite += c.non_finite;
        hits.counters.degenerate += c.degenerate;
        hits.counters.facing_away += c.facing_away;
        hits.counters.outside += c.outside;
        hits.counters.between_samples += c.between_samples;
        hits.counters.crossing += c.crossing;
        for (const TileSlice& slice : chunk.slices) {
            const std::int32_t x0 = std::int32_t(slice.tile) % window.tiles_x * tile_size;
            const std::int32_t y0 = std::int32_t(slice.tile) / window.tiles_x * tile_size;
            TilePlace place{window.first_x + x0 * 256, window.first_y + y0 * 256,
                            std::min(tile_size, window.width - x0),
                            std::min(tile_size, window.height - y0)};
            if (options.offset) {
                place.x += options.offset->x;
                place.y += options.offset->y;
            }
            // Only the triangle's box is looked at and emptied again.
            std::int32_t i0 = 0, j0 = 0, i1 = place.width - 1, j1 = place.height - 1;
            if (!(chunk.order[slice.begin] & order_crossing)) {
                const SetupTriangle& s = chunk.triangles[0];
                const auto [low_x, high_x] = std::minmax({s.x[0], s.x[1], s.x[2]});
                const auto [low_y, high_y] = std::minmax({s.y[0], s.y[1], s.y[2]});
                i0 = std::clamp((low_x - place.x) / 256 - 2, 0, i1);
                j0 = std::clamp((low_y - place.y) / 256 - 2, 0, j1);
                i1 = std::clamp((high_x - place.x) / 256 + 2, 0, i1);
                j1 = std::clamp((high_y - place.y) / 256 + 2, 0, j1);
            }
            if (chunk.order[slice.begin] & order_crossing)
                raster_crossing(samples.depth.data(), samples.id.data(), place, chunk.crossing[0],
                                nullptr, kernels);
            else
                kernels.raster(samples.depth.data(), samples.id.data(), place,
                               chunk.triangles.data(), &chunk.order[slice.begin], 1, nullptr);
            for (std::int32_t y = j0; y <= j1; ++y)
                for (std::int32_t x = i0; x <= i1; ++x) {
                    const std::size_t at = std::size_t(y) * tile_size + std::size_t(x);
                    if (samples.id[at] == id_none) continue;
                    const std::size_t i = std::size_t(y0 + y) * width + std::size_t(x0 + x);
                    ++(samples.id[at] & id_back_face ? hits.back : hits.front)[i];
                    hits.nearest[i] = std::max(hits.nearest[i], samples.depth[at]);
                    samples.id[at] = id_none;
                    samples.depth[at] = -1.0f;
                }
        }
    }
    // Nothing was drawn outside those boxes.
    EXPECT_EQ(std::count(samples.id.begin(), samples.id.end(), id_none),
              std::ptrdiff_t(samples.id.size()));
    return hits;
}

// A vertex at (x, y) 1/256 pixels from the top left corner, seen at homogeneous w.
ScreenVertex vertex_at(std::int64_t x, std::int64_t y, std::uint32_t width, std::uint32_t height,
                       double w = 1, double depth = 0.5) {
    return {(double(x) / 256 - width * 0.5) * w, (double(y) / 256 - height * 0.5) * w, depth * w,
            w};
}

struct Point {
    std::int64_t x = 0, y = 0;
    bool operator==(const Point&) const = default;
};

int orientation(const Point& a, const Point& b, const Point& c) {
    const Wide d = Wide(b.x - a.x) * (c.y - a.y) - Wide(b.y - a.y) * (c.x - a.x);
    return d > 0 ? 1 : d < 0 ? -1 : 0;
}

bool on_segment(const Point& p, const Point& a, const Point& b) {
    return orientation(a, b, p) == 0 && p.x >= std::min(a.x, b.x) && p.x <= std::max(a.x, b.x) &&
           p.y >= std::min(a.y, b.y) && p.y <= std::max(a.y, b.y);
}

Point centre_of(std::uint32_t x, std::uint32_t y) {
    return {std::int64_t(x) * 256 + 128, std::int64_t(y) * 256 + 128};
}

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

// Whether a sample on the boundary belongs to a triangle, as Direct3D and Vulkan say it: a left
// edge has the inside to its right, a top edge is level with the inside below.
bool oracle_covers(Point a, Point b, Point c, const Point& p) {
    const int turn = orientation(a, b, c);
    if (turn == 0) return false;
    if (turn < 0) std::swap(b, c);
    const Point corners[3] = {a, b, c};
    for (int i = 0; i < 3; ++i) {
        const Point &from = corners[i], &to = corners[(i + 1) % 3], &third = corners[(i + 2) % 3];
        const int side = orientation(from, to, p);
        if (side < 0) return false;
        if (side > 0) continue;
        const bool level = from.y == to.y;
        const bool top = level && third.y > from.y;
        // The inside is on the right: a point just right of the edge is on the third corner's side.
        const Point right{from.x + to.x + 2, from.y + to.y};
        const bool left =
            !level && orientation({2 * from.x, 2 * from.y}, {2 * to.x, 2 * to.y}, right) > 0;
        if (!top && !left) return false;
    }
    return true;
}

std::int64_t random_coordinate(std::mt19937_64& random, std::uint32_t extent) {
    const std::int64_t whole = std::int64_t(random() % (extent + 1)) * 256;
    switch (random() % 4) {
        case 0:
            return whole;  // on the pixel grid
        case 1:
            return whole + 128;  // on sample rows and columns
        default:
            return whole + std::int64_t(random() % 256);
    }
}

// ---------------------------------------------------------------------------- single triangles

TEST(Coverage, EqualsExactIntegersOnRandomTriangles) {
    std::mt19937_64 random(1);
    constexpr std::uint32_t extent = 24;
    constexpr std::int64_t far = 16370 * 256;  // just inside the guard band
    std::vector<SimdLevel> levels;
    for (const SimdLevel level :
         {SimdLevel::scalar, SimdLevel::sse4, SimdLevel::avx2, SimdLevel::avx512})
        if (prep::simd_available(level)) levels.push_back(level);
    std::uint64_t wrong = 0, covered = 0, slivers = 0;
    for (int n = 0; n < 60000; ++n) {
        Point p[3];
        const auto anywhere = [&] {
            return std::int64_t(random() % (2 * std::uint64_t(far))) - far;
        };
        switch (n % 5) {
            case 0:  // in the picture
                for (Point& q : p)
                    q = {random_coordinate(random, extent), random_coordinate(random, extent)};
                break;
            case 1:  // smaller than a pixel
                p[0] = {random_coordinate(random, extent), random_coordinate(random, extent)};
                for (int i = 1; i < 3; ++i)
                    p[i] = {p[0].x + std::int64_t(random() % 300) - 150,
                            p[0].y + std::int64_t(random() % 300) - 150};
                break;
            case 2:  // slivers through the picture
                p[0] = {anywhere() / 2, anywhere() / 2};
                p[1] = {256 * extent - p[0].x, 256 * extent - p[0].y};
                p[2] = {p[1].x + std::int64_t(random() % 64), p[1].y + std::int64_t(random() % 64)};
                ++slivers;
                break;
            case 3:  // all over the guard band
                for (Point& q : p) q = {anywhere(), anywhere()};
                break;
            default:  // its corners
                for (Point& q : p)
                    q = {random() % 2 ? far - std::int64_t(random() % 512)
                                      : -far + std::int64_t(random() % 512),
                         random() % 2 ? far - std::int64_t(random() % 512)
                                      : -far + std::int64_t(random() % 512)};
        }
        std::vector<ScreenVertex> vertices;
        for (const Point& q : p) {
            vertices.push_back(vertex_at(q.x, q.y, extent, extent));
            const auto record = rast::detail::record_of(vertices.back());
            ASSERT_EQ(record.x, q.x - std::int64_t(extent) * 128);
            ASSERT_EQ(record.y, q.y - std::int64_t(extent) * 128);
        }
        HitOptions options;
        options.level = levels[std::size_t(n / 5) % levels.size()];
        const Hits hits = count_hits(vertices, {{0, 1, 2}}, extent, extent, options);
        // y runs down: what turns clockwise on the screen has a positive determinant.
        const bool back = orientation(p[0], p[1], p[2]) > 0;
        for (std::uint32_t y = 0; y < extent; ++y)
            for (std::uint32_t x = 0; x < extent; ++x) {
                const int expected = oracle_covers(p[0], p[1], p[2], centre_of(x, y)) ? 1 : 0;
                wrong += hits.at(x, y, back) != expected || hits.at(x, y, !back) != 0;
                covered += expected;
            }
    }
    EXPECT_EQ(wrong, 0u);
    EXPECT_GT(covered, 1000000u);  // the test has something to test
    EXPECT_GT(slivers, 10000u);
}

TEST(Coverage, ZeroAreaOnTheGridIsCountedAndDrawsNothing) {
    std::mt19937_64 random(2);
    std::uint64_t degenerate = 0, counted = 0;
    for (int n = 0; n < 20000; ++n) {
        Point p[3];
        for (Point& q : p) q = {std::int64_t(random() % 12) * 64, std::int64_t(random() % 12) * 64};
        std::vector<ScreenVertex> vertices;
        for (const Point& q : p) vertices.push_back(vertex_at(q.x, q.y, 8, 8));
        degenerate += orientation(p[0], p[1], p[2]) == 0;
        counted += count_hits(vertices, {{0, 1, 2}}, 8, 8).counters.degenerate;
    }
    EXPECT_EQ(counted, degenerate);
    EXPECT_GT(degenerate, 100u);
}

TEST(Coverage, NonFiniteVerticesAreCountedAndDrawNothing) {
    for (const double bad : {double(NAN), double(INFINITY), -double(INFINITY)})
        for (int component = 0; component < 4; ++component) {
            std::vector<ScreenVertex> vertices;
            for (int i = 0; i < 3; ++i) {
                glm::dvec4 p(i == 1 ? 30 : -10, i == 2 ? 30 : -10, 0.5, 1);
                if (i == 1) p[component] = bad;
                vertices.push_back({p.x, p.y, p.z, p.w});
            }
            const Hits hits = count_hits(vertices, {{0, 1, 2}}, 16, 16);
            EXPECT_EQ(hits.counters.non_finite, 1u);
            EXPECT_EQ(std::count(hits.front.begin(), hits.front.end(), 0), 256);
            EXPECT_EQ(std::count(hits.back.begin(), hits.back.end(), 0), 256);
        }
}

// -------------------------------------------------------------------------- planar triangulations

// A star-shaped polygon about a point, counter-clockwise where y runs down or not.
std::vector<Point> random_polygon(std::mt19937_64& random, std::uint32_t extent) {
    const std::size_t corners = 3 + random() % 20;
    const Point middle{std::int64_t(extent) * 128, std::int64_t(extent) * 128};
    std::vector<Point> around;
    for (std::size_t i = 0; i < corners; ++i) {
        const Point p{random_coordinate(random, extent), random_coordinate(random, extent)};
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
            const Hits hits = count_hits(vertices, wound, extent, extent);
            for (std::uint32_t y = 0; y < extent; ++y)
                for (std::uint32_t x = 0; x < extent; ++x) {
                    const Place place = place_in(polygon, centre_of(x, y));
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

    void flip(std::mt19937_64& random) {
        std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> edges;
        for (std::size_t t = 0; t < triangles.size(); ++t)
            for (int i = 0; i < 3; ++i) edges[{triangles[t][i], triangles[t][(i + 1) % 3]}] = t;
        const std::size_t t = random() % triangles.size();
        const int i = int(random() % 3);
        const std::uint32_t a = triangles[t][i], b = triangles[t][(i + 1) % 3],
                            c = triangles[t][(i + 2) % 3];
        const auto other = edges.find({b, a});
        if (other == edges.end()) return;
        std::uint32_t d = 0;
        for (const std::uint32_t v : triangles[other->second])
            if (v != a && v != b) d = v;
        if (orientation(points[c], points[d], points[b]) <= 0 ||
            orientation(points[d], points[c], points[a]) <= 0)
            return;
        triangles[other->second] = {c, d, b};
        triangles[t] = {d, c, a};
    }
};

TEST(Coverage, TriangulatedRectanglesCoverEverySampleOnce) {
    std::mt19937_64 random(4);
    constexpr std::uint32_t extent = 32;
    for (int n = 0; n < 150; ++n) {
        // From inside the picture to corners beyond the guard band, where edges are homogeneous.
        const std::int64_t reach = n % 3 == 0 ? 0 : n % 3 == 1 ? 16000 * 256 : 3000000 * 256ll;
        Triangulation mesh;
        mesh.points = {{-reach, -reach},
                       {extent * 256 + reach, -reach},
                       {extent * 256 + reach, extent * 256 + reach},
                       {-reach, extent * 256 + reach}};
        mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
        for (int k = 0; k < 60; ++k)
            mesh.insert({random_coordinate(random, extent), random_coordinate(random, extent)});
        for (int k = 0; k < 100; ++k) mesh.flip(random);
        std::vector<ScreenVertex> vertices;
        for (const Point& p : mesh.points)
            vertices.push_back(
                vertex_at(p.x, p.y, extent, extent, 0.1 + 0.01 * double(random() % 1000)));
        for (const bool turned : {false, true}) {
            std::vector<Triangle> wound = mesh.triangles;
            if (turned)
                for (Triangle& t : wound) std::swap(t[1], t[2]);
            HitOptions options;
            const auto offsets = rast::detail::sample_offsets(1 << (n % 5));
            if (offsets.size() > 1) options.offset = offsets[std::size_t(n) % offsets.size()];
            const Hits hits = count_hits(vertices, wound, extent, extent, options);
            for (std::uint32_t y = 0; y < extent; ++y)
                for (std::uint32_t x = 0; x < extent; ++x) {
                    // The picture's own edge may lie on the rectangle's.
                    ASSERT_EQ(hits.at(x, y, !turned), 1) << n << ": " << x << " " << y;
                    ASSERT_EQ(hits.at(x, y, turned), 0) << n << ": " << x << " " << y;
                }
            EXPECT_EQ(hits.counters.crossing > 0, reach > 16384 * 256);
        }
    }
}

// ---------------------------------------------------------------------------------- closed meshes

struct Eye {
    glm::dmat3 rotation{1.0};
    glm::dvec3 position{0.0};
    rast::View view;
};

Eye random_eye(std::mt19937_64& random, double distance) {
    std::normal_distribution<double> normal;
    const glm::dquat turn =
        glm::normalize(glm::dquat(normal(random), normal(random), normal(random), normal(random)));
    Eye eye;
    eye.rotation = glm::mat3_cast(turn);
    eye.position = glm::transpose(eye.rotation) * glm::dvec3(0, 0, distance);
    eye.view.yfov = 1.0;
    return eye;
}

std::vector<ScreenVertex> seen_from(const Eye& eye, const std::vector<glm::vec3>& positions,
                                    std::uint32_t extent) {
    std::vector<ScreenVertex> out;
    const glm::dmat4 to_clip = rast::projection(eye.view, 1.0);
    for (const glm::vec3& p : positions) {
        const glm::dvec4 clip =
            to_clip * glm::dvec4(eye.rotation * (glm::dvec3(p) - eye.position), 1.0);
        out.push_back({clip.x * 0.5 * extent, clip.y * -0.5 * extent, clip.z, clip.w});
    }
    return out;
}

std::vector<Triangle> triangles_of(const prep::Mesh& mesh) {
    const prep::Mesh fans = shapes::fan_triangulated(mesh);
    std::vector<Triangle> out;
    for (std::size_t i = 0; i + 2 < fans.corner_vertices.size(); i += 3)
        out.push_back(
            {fans.corner_vertices[i], fans.corner_vertices[i + 1], fans.corner_vertices[i + 2]});
    return out;
}

prep::Mesh random_closed_mesh(std::mt19937_64& random, int kind) {
    switch (kind % 4) {
        case 0: {
            prep::Mesh mesh = shapes::icosphere(3);
            shapes::jitter(mesh, 0.05f, random);
            return mesh;
        }
        case 1: {  // spikes that fold over each other
            prep::Mesh mesh = shapes::icosphere(2);
            shapes::jitter(mesh, 0.9f, random);
            return mesh;
        }
        case 2: {
            prep::Mesh mesh = shapes::torus(24, 12);
            shapes::jitter(mesh, 0.1f, random);
            return mesh;
        }
        default: {  // dense: most triangles fall between samples
            prep::Mesh mesh = shapes::uv_sphere(96, 64);
            shapes::jitter(mesh, 0.01f, random);
            return mesh;
        }
    }
}

TEST(Coverage, ClosedMeshesHaveAsManyFrontHitsAsBackHits) {
    std::mt19937_64 random(5);
    constexpr std::uint32_t extent = 96;
    std::uint64_t hit = 0;
    for (int n = 0; n < 60; ++n) {
        const prep::Mesh mesh = random_closed_mesh(random, n);
        Eye eye = random_eye(random, 4.5);
        eye.view.znear = 0.1;
        const std::vector<ScreenVertex> vertices = seen_from(eye, mesh.positions, extent);
        for (const bool turned : {false, true}) {
            std::vector<Triangle> triangles = triangles_of(mesh);
            if (turned)
                for (Triangle& t : triangles) std::swap(t[1], t[2]);
            HitOptions options;
            const auto offsets = rast::detail::sample_offsets(1 << (n % 5));
            if (offsets.size() > 1) options.offset = offsets[std::size_t(n) % offsets.size()];
            const Hits hits = count_hits(vertices, triangles, extent, extent, options);
            ASSERT_EQ(hits.counters.crossing, 0u);
            for (std::size_t i = 0; i < hits.front.size(); ++i) {
                ASSERT_EQ(hits.front[i], hits.back[i]) << n << ": " << i;
                hit += hits.front[i] > 0;
            }
        }
    }
    EXPECT_GT(hit, 50000u);
}

// ------------------------------------------------------------------------------------- near plane

// What a ray meets beyond the near plane, in double.
struct RayHits {
    int front = 0, back = 0;
    double nearest = -1;     // reversed depth
    double clearance = 1e9;  // pixels to the closest triangle edge, or depth's to the near plane
};

RayHits ray_hits(const Eye& eye, const std::vector<glm::vec3>& positions,
                 const std::vector<Triangle>& triangles, std::uint32_t extent, std::uint32_t x,
                 std::uint32_t y) {
    // In view space, through the pixel's centre, scaled so that t = 1 is at distance 1 along −z.
    const double tangent = std::tan(eye.view.yfov / 2);
    const glm::dvec3 direction(((x + 0.5) / extent * 2 - 1) * tangent,
                               (1 - (y + 0.5) / extent * 2) * tangent, -1);
    const double pixel = 2 * tangent / extent;  // at distance 1
    RayHits hits;
    for (const Triangle& t : triangles) {
        glm::dvec3 p[3];
        for (int i = 0; i < 3; ++i)
            p[i] = eye.rotation * (glm::dvec3(positions[t[i]]) - eye.position);
        // Volumes of the ray with the three edges: their signs say on which side it passes.
        double volume[3], distance = 1e9;
        for (int i = 0; i < 3; ++i) {
            const glm::dvec3 plane = glm::cross(p[(i + 1) % 3], p[(i + 2) % 3]);
            volume[i] = glm::dot(direction, plane);
            const double slope = std::hypot(plane.x, plane.y);
            if (slope > 0) distance = std::min(distance, std::abs(volume[i]) / slope / pixel);
        }
        const bool all_in = (volume[0] > 0 && volume[1] > 0 && volume[2] > 0) ||
                            (volume[0] < 0 && volume[1] < 0 && volume[2] < 0);
        // Close to an edge's line matters only where the edge itself is close; being cautious
        // everywhere costs samples, not correctness.
        hits.clearance = std::min(hits.clearance, distance);
        if (!all_in) continue;
        const glm::dvec3 normal = glm::cross(p[1] - p[0], p[2] - p[0]);
        const double along = glm::dot(direction, normal);
        const double at = glm::dot(p[0], normal) / along;  // distance along −z
        // Grazing planes: a vertex moved by half of 1/256 pixel moves the hit far.
        const double tilt = std::hypot(normal.x, normal.y) * pixel / std::abs(along);
        hits.clearance = std::min(
            hits.clearance, std::abs(at - eye.view.znear) / eye.view.znear / std::max(tilt, 1e-9));
        if (at <= eye.view.znear) continue;
        ++(along < 0 ? hits.front : hits.back);
        hits.nearest = std::max(hits.nearest, eye.view.znear / at);
    }
    return hits;
}

TEST(Coverage, NearPlaneThroughClosedMeshesEqualsRays) {
    std::mt19937_64 random(6);
    constexpr std::uint32_t extent = 40;
    std::uint64_t compared = 0, inside = 0, crossing = 0;
    for (int n = 0; n < 64; ++n) {
        prep::Mesh mesh = n % 2 ? shapes::icosphere(1) : shapes::cube();
        shapes::jitter(mesh, 0.3f, random);
        // From outside, through the surface, to the middle: the plane sweeps through the mesh and
        // through the eye.
        Eye eye = random_eye(random, 2.2 * double(n) / 64);
        eye.view.znear = n % 4 == 0 ? 1e-3 : 0.4;
        const std::vector<ScreenVertex> vertices = seen_from(eye, mesh.positions, extent);
        for (const bool turned : {false, true}) {
            std::vector<Triangle> triangles = triangles_of(mesh);
            if (turned)
                for (Triangle& t : triangles) std::swap(t[1], t[2]);
            const Hits hits = count_hits(vertices, triangles, extent, extent);
            crossing += hits.counters.crossing;
            for (std::uint32_t y = 0; y < extent; ++y)
                for (std::uint32_t x = 0; x < extent; ++x) {
                    const RayHits rays = ray_hits(eye, mesh.positions, triangles, extent, x, y);
                    // Snapping moves edges by up to 1/256 of a pixel's diagonal half.
                    if (rays.clearance < 0.02) continue;
                    ++compared;
                    const std::size_t i = std::size_t(y) * extent + x;
                    ASSERT_EQ(hits.front[i], rays.front) << n << ": " << x << " " << y;
                    ASSERT_EQ(hits.back[i], rays.back) << n << ": " << x << " " << y;
                    inside += hits.front[i] != hits.back[i];
                }
        }
    }
    EXPECT_GT(compared, 100000u);
    EXPECT_GT(inside, 20000u);  // the plane did cut
    EXPECT_GT(crossing, 250u);
}

// At every sample, near edges too: what is cut open shows exactly one back face more than front
// faces, or none. Two triangles of one edge must never both win or both lose it.
TEST(Coverage, NearPlaneSweepLeavesNoCracks) {
    std::mt19937_64 random(7);
    constexpr std::uint32_t extent = 64;
    std::uint64_t open = 0;
    for (int n = 0; n < 120; ++n) {
        prep::Mesh mesh = n % 2 ? shapes::icosphere(3) : shapes::uv_sphere(32, 16);
        Eye eye = random_eye(random, 1.6 * double(n) / 120);
        eye.view.znear = n % 3 == 0 ? 1e-6 : 0.2;
        const Hits hits =
            count_hits(seen_from(eye, mesh.positions, extent), triangles_of(mesh), extent, extent);
        for (std::size_t i = 0; i < hits.front.size(); ++i) {
            const int more = hits.back[i] - hits.front[i];
            ASSERT_TRUE(more == 0 || more == 1) << n << ": " << i << " " << more;
            // A convex body: at most one of each.
            ASSERT_LE(hits.front[i], 1);
            ASSERT_LE(hits.back[i], 1);
            open += more == 1;
        }
    }
    EXPECT_GT(open, 100000u);
}

TEST(Coverage, VisibleDepthEqualsRays) {
    std::mt19937_64 random(8);
    constexpr std::uint32_t extent = 40;
    std::uint64_t compared = 0;
    double worst = 0;
    for (int n = 0; n < 24; ++n) {
        prep::Mesh mesh = shapes::icosphere(1);
        shapes::jitter(mesh, 0.4f, random);
        Eye eye = random_eye(random, 2.5 * double(n) / 24);
        eye.view.znear = 0.3;
        const std::vector<Triangle> triangles = triangles_of(mesh);
        const Hits hits =
            count_hits(seen_from(eye, mesh.positions, extent), triangles, extent, extent);
        for (std::uint32_t y = 0; y < extent; ++y)
            for (std::uint32_t x = 0; x < extent; ++x) {
                const RayHits rays = ray_hits(eye, mesh.positions, triangles, extent, x, y);
                if (rays.clearance < 0.1) continue;
                const float depth = hits.nearest[std::size_t(y) * extent + x];
                if (rays.nearest < 0) {
                    ASSERT_EQ(depth, -1.0f);
                    continue;
                }
                worst = std::max(worst, std::abs(depth - rays.nearest) / rays.nearest);
                ++compared;
            }
    }
    EXPECT_GT(compared, 5000u);
    // Corners move by up to 1/512 pixel in x and y; on triangles about 10 pixels wide whose depth
    // changes by its own size that is about 4e-4, more on steep ones.
    EXPECT_LT(worst, 0.02);
}

TEST(Coverage, WindingDecidesTheSideAndCulling) {
    const std::vector<ScreenVertex> vertices{vertex_at(0, 0, 16, 16), vertex_at(0, 4096, 16, 16),
                                             vertex_at(4096, 0, 16, 16)};
    // Down, then right: counter-clockwise to the eye.
    HitOptions drop_back, drop_front;
    drop_back.cull = CullSide::back;
    drop_front.cull = CullSide::front;
    const Hits front = count_hits(vertices, {{0, 1, 2}}, 16, 16, drop_back);
    EXPECT_EQ(front.counters.facing_away, 0u);
    EXPECT_EQ(front.at(2, 2, false), 1);
    EXPECT_EQ(count_hits(vertices, {{0, 1, 2}}, 16, 16, drop_front).counters.facing_away, 1u);
    EXPECT_EQ(count_hits(vertices, {{0, 2, 1}}, 16, 16, drop_back).counters.facing_away, 1u);
}

// The records that the kernels make are those of the doubles behind them, on every level.
TEST(Coverage, TransformedVerticesAreTheirDoublesRounded) {
    std::mt19937_64 random(9);
    std::normal_distribution<float> normal;
    prep::VertexMesh mesh;
    for (int i = 0; i < 1003; ++i)
        mesh.positions.push_back({3 * normal(random), 3 * normal(random), 3 * normal(random)});
    mesh.positions[17].y = NAN;
    mesh.positions[500].z = INFINITY;
    rast::View view;
    view.znear = 0.1;
    view.world_to_view[3] = glm::dvec4(0, 0, -2, 1);
    rast::detail::RenderInstance instance(mesh, 0, glm::dmat4(1.0), view, 640, 480);
    std::size_t unsnapped = 0;
    for (const SimdLevel level :
         {SimdLevel::scalar, SimdLevel::sse4, SimdLevel::avx2, SimdLevel::avx512}) {
        if (!prep::simd_available(level)) continue;
        instance.records.assign(mesh.vertex_count(), {});
        instance.transform(rast::detail::kernels_for(level), 0, mesh.vertex_count());
        for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
            const auto expected = rast::detail::record_of(instance.homogeneous(v));
            ASSERT_EQ(instance.records[v].x, expected.x) << v;
            ASSERT_EQ(instance.records[v].y, expected.y) << v;
            if (expected.x == rast::detail::mark_non_finite) continue;
            ASSERT_EQ(instance.records[v].w, expected.w) << v;
            ASSERT_EQ(instance.records[v].depth, expected.depth) << v;
            unsnapped += expected.x == rast::detail::mark_unsnapped;
        }
        EXPECT_EQ(instance.records[17].x, rast::detail::mark_non_finite);
        EXPECT_EQ(instance.records[500].x, rast::detail::mark_non_finite);
    }
    EXPECT_GT(unsnapped, 100u);
}

}  // namespace
