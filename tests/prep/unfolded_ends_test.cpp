// Band limits where charts end at the borders of maps that repeat, against heights that are known:
// nothing of the other side is read there, but where the surface goes on by the map's wrap it is.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "displacement/height_field.h"
#include "height_maps.h"
#include "prep/displacement/tessellate.h"

namespace prep {
namespace {

using detail::HeightMap;
using namespace test;

constexpr double pi = std::numbers::pi;
constexpr HeightFilter filters[] = {HeightFilter::bilinear, HeightFilter::bicubic};

// Adds a rectangle in columns and rows of quads: `place` makes positions of (s, t) in 0 … 1, UVs go
// from low to high. Closed: the last column is the first one's, as far as positions go.
struct Strip {
    glm::vec2 low{0.0F}, high{1.0F};
    std::uint32_t columns = 1, rows = 1;
    bool is_closed = false;
};
template <class Place>
void add_strip(Mesh& mesh, const Strip& strip, const Place& place) {
    if (mesh.face_offsets.empty()) mesh.face_offsets = {0};
    mesh.uvs.resize(1);
    const auto first = std::uint32_t(mesh.positions.size());
    const std::uint32_t across = strip.columns + (strip.is_closed ? 0 : 1);
    for (std::uint32_t j = 0; j <= strip.rows; ++j)
        for (std::uint32_t i = 0; i < across; ++i)
            mesh.positions.push_back(place(double(i) / strip.columns, double(j) / strip.rows));
    for (std::uint32_t j = 0; j < strip.rows; ++j)
        for (std::uint32_t i = 0; i < strip.columns; ++i) {
            for (const auto& [di, dj] : {std::pair(0U, 0U), {1U, 0U}, {1U, 1U}, {0U, 1U}}) {
                mesh.corner_vertices.push_back(first + (j + dj) * across + (i + di) % across);
                mesh.uvs[0].indices.push_back(std::uint32_t(mesh.uvs[0].values.size()));
                const glm::vec2 part(float(i + di) / float(strip.columns),
                                     float(j + dj) / float(strip.rows));
                mesh.uvs[0].values.push_back(strip.low + (strip.high - strip.low) * part);
            }
            mesh.face_offsets.push_back(std::uint32_t(mesh.corner_vertices.size()));
        }
}
glm::vec3 flat(double x, double y) {
    return {float(x), float(y), 0};
}

// A square of that side on the map once around, from those UVs on.
Mesh square(float side, const glm::vec2& low) {
    Mesh mesh;
    add_strip(mesh, {low, low + 1.0F}, [&](double s, double t) { return side * flat(s, t); });
    return mesh;
}
// The texels that a repeated map has of heights over UVs from `low` on.
template <class Height>
Image around(std::uint32_t size, const glm::dvec2& low, const Height& height) {
    return picture(size, size, [&](auto x, auto y) {
        const glm::dvec2 uv((x + 0.5) / size, (y + 0.5) / size);
        return height(uv - glm::floor(uv - low));
    });
}
HeightMapOptions limited_to(double spacing, HeightFilter filter = HeightFilter::bilinear) {
    HeightMapOptions options = plain(filter);
    options.sample_spacing = spacing;
    return options;
}

// What is linear over a chart stays so up to its border and into its corners, wherever in the
// repeated map the chart lies.
TEST(UnfoldedEnds, RampsGoOnUpToTheBorder) {
    constexpr std::uint32_t size = 64;
    const auto ramp = [](const glm::dvec2& p) { return 2 * p.x + p.y; };
    for (const HeightFilter filter : filters)
        for (const glm::vec2& low : {glm::vec2(0), glm::vec2(0.25F, 0.75F), glm::vec2(0.3F, -0.1F),
                                     glm::vec2(-0.5F, 3), glm::vec2(5, -2)})
            for (const double spacing : {1.5 / size, 3.0 / size, 0.1, 0.4}) {
                const Mesh mesh = square(1, low);
                const auto map =
                    height_function(around(size, low, ramp), limited_to(spacing, filter), &mesh);
                ASSERT_TRUE(map);
                double most = 0;
                for (int j = 0; j <= 130; ++j)
                    for (int i = 0; i <= 130; ++i) {
                        const glm::dvec2 p =
                            glm::dvec2(low) + glm::dvec2(double(i), double(j)) / 130.0;
                        most = std::max(most, std::abs((*map)->value(p) - ramp(p)));
                    }
                // A texel's step is 0.05.
                EXPECT_LE(most, 1e-3) << low.x << ", " << low.y << " by " << spacing;
            }
}

// Waves that samples carry, on charts of one period: as high as they were, and within a few
// spacings of the border at most 1.3 times as high and 1.4 times as steep. A cliff of half a texel
// would be many times as steep.
TEST(UnfoldedEnds, WavesHaveNoCliffs) {
    constexpr std::uint32_t size = 256;
    for (const HeightFilter filter : filters)
        for (const double low : {0.0, 0.25, 0.6})
            for (const double phase : {0.0, 1.0, 2.5})
                for (const double spacing : {0.025, 0.05, 0.1}) {
                    const auto wave = [&](const glm::dvec2& p) {
                        return std::sin(2 * pi * p.x + phase);
                    };
                    const Mesh mesh = square(1, glm::vec2(float(low), 0));
                    const auto map = height_function(around(size, {low, 0}, wave),
                                                     limited_to(spacing, filter), &mesh);
                    ASSERT_TRUE(map);
                    double steepest = 0, farthest = 0, highest = 0;
                    constexpr int steps = 4 * int(size);
                    for (int j = 0; j <= 8; ++j)
                        for (int i = 0; i <= steps; ++i) {
                            const glm::dvec2 p(float(low) + double(i) / steps, j / 8.0);
                            const auto at = (*map)->at(p);
                            steepest = std::max(steepest, glm::length(at.gradient));
                            farthest = std::max(farthest, std::abs(at.value - wave(p)));
                            if (std::abs(double(i) / steps - 0.5) < 0.25)
                                highest = std::max(highest,
                                                   at.value / wave(p) * (std::abs(wave(p)) > 0.9));
                        }
                    EXPECT_LE(steepest, 1.4 * 2 * pi) << low << ", " << phase << ", " << spacing;
                    EXPECT_LE(farthest, 0.3) << low << ", " << phase << ", " << spacing;
                    EXPECT_GE(highest, 0.95) << low << ", " << phase << ", " << spacing;
                }
}

// A ring that closes by the map's wrap, a band that ends at the same border and one that lies
// across it, in rows of their own.
class MixedCharts : public ::testing::TestWithParam<HeightFilter> {
  protected:
    static constexpr std::uint32_t size = 128;
    static double ramp(const glm::dvec2& p) { return 2 * p.x + p.y; }
    static double wave(const glm::dvec2& p) { return std::sin(4 * pi * p.x + 1); }
    static Mesh mesh() {
        Mesh mesh;
        add_strip(mesh, {.low = {0, 0.0625F}, .high = {1, 0.25F}, .columns = 4},
                  [](double s, double t) { return flat(s, 0.1875 * t); });
        add_strip(
            mesh,
            {.low = {0, 0.375F}, .high = {1, 0.625F}, .columns = 32, .rows = 2, .is_closed = true},
            [](double s, double t) {
                return glm::vec3(std::cos(2 * pi * s) / (2 * pi), std::sin(2 * pi * s) / (2 * pi),
                                 1 + 0.25 * t);
            });
        add_strip(mesh, {.low = {0.5F, 0.75F}, .high = {1.5F, 0.9375F}, .columns = 3},
                  [](double s, double t) { return flat(s, 2 + 0.1875 * t); });
        return mesh;
    }
    static Image image() {
        return picture(size, size, [](auto x, auto y) {
            const glm::dvec2 p((x + 0.5) / size, (y + 0.5) / size);
            if (p.y < 0.3125) return ramp(p);
            if (p.y < 0.6875) return wave(p);
            return ramp({p.x < 0.5 ? p.x + 1 : p.x, p.y});
        });
    }
};

TEST_P(MixedCharts, EachGoesOnAsItsSurfaceDoes) {
    const Mesh mesh = this->mesh();
    for (const double spacing : {2.0 / size, 0.03, 0.06}) {
        const auto map = height_function(image(), limited_to(spacing, GetParam()), &mesh);
        ASSERT_TRUE(map);
        double ends = 0, across = 0, ring = 0, seam = 0;
        for (int j = 0; j <= 20; ++j)
            for (int i = 0; i <= 400; ++i) {
                const double s = i / 400.0, t = j / 20.0;
                const glm::dvec2 a(s, 0.0625 + 0.1875 * t), b(s, 0.375 + 0.25 * t);
                const glm::dvec2 c(0.5 + s, 0.75 + 0.1875 * t);
                ends = std::max(ends, std::abs((*map)->value(a) - ramp(a)));
                across = std::max(across, std::abs((*map)->value(c) - ramp(c)));
                // What is beyond a seam is laid flat, over a facet's angle.
                ring = std::max(ring, std::abs((*map)->value(b) - wave(b)));
                seam = std::max(seam, std::abs((*map)->value({0, b.y}) - (*map)->value({1, b.y})));
            }
        EXPECT_LE(ends, 1e-3) << spacing;
        EXPECT_LE(across, 1e-3) << spacing;
        EXPECT_LE(ring, 0.07) << spacing;
        EXPECT_LE(seam, 1e-9) << spacing;
    }
}
INSTANTIATE_TEST_SUITE_P(UnfoldedEnds, MixedCharts, ::testing::ValuesIn(filters));

// A ball of latitudes and longitudes, whose chart ends at the poles in teeth: heights that change
// with the latitude alone stay within what a border's waves may be, up into the teeth's tips, and
// the seam stays closed.
TEST(UnfoldedEnds, PolesOfABall) {
    constexpr std::uint32_t size = 256, columns = 48, rows = 24;
    using Corners = std::array<std::pair<std::uint32_t, std::uint32_t>, 3>;
    Mesh ball;
    ball.uvs.resize(1);
    ball.face_offsets = {0};
    const auto vertex = [](std::uint32_t i, std::uint32_t j) {
        return j == 0 ? 0 : j == rows ? 1 : 2 + (j - 1) * columns + i % columns;
    };
    ball.positions = {{0, 1, 0}, {0, -1, 0}};
    for (std::uint32_t j = 1; j < rows; ++j)
        for (std::uint32_t i = 0; i < columns; ++i) {
            const double t = pi * j / rows, p = 2 * pi * i / columns;
            ball.positions.emplace_back(std::sin(t) * std::cos(p), std::cos(t),
                                        -std::sin(t) * std::sin(p));
        }
    for (std::uint32_t j = 0; j < rows; ++j)
        for (std::uint32_t i = 0; i < columns; ++i)
            for (const bool upper : {true, false}) {
                if (j == (upper ? 0 : rows - 1)) continue;
                for (const auto& [di, dj] : upper ? Corners{{{0, 0}, {0, 1}, {1, 0}}}
                                                  : Corners{{{1, 0}, {0, 1}, {1, 1}}}) {
                    ball.corner_vertices.push_back(vertex(i + di, j + dj));
                    ball.uvs[0].indices.push_back(std::uint32_t(ball.uvs[0].values.size()));
                    ball.uvs[0].values.emplace_back(float(i + di) / columns, float(j + dj) / rows);
                }
                ball.face_offsets.push_back(std::uint32_t(ball.corner_vertices.size()));
            }
    const auto by_latitude = [](const glm::dvec2& p) { return std::cos(2 * pi * p.y); };
    const auto by_longitude = [](const glm::dvec2& p) {
        return std::sin(6 * pi * p.x) * std::pow(std::sin(pi * p.y), 2);
    };
    for (const HeightFilter filter : filters)
        for (const double spacing : {0.1, 0.3}) {
            const auto of = [&](const auto& height) {
                return *height_function(around(size, {0, 0}, height), limited_to(spacing, filter),
                                        &ball);
            };
            const auto latitudes = of(by_latitude), longitudes = of(by_longitude);
            double steepest = 0, seam = 0;
            for (std::uint32_t i = 0; i < columns; ++i)
                for (int k = 0; k <= 200; ++k) {
                    // Down the side of a tooth, from its tip on.
                    const glm::dvec2 top((i + 1.0) / columns, k / 200.0 / rows);
                    const glm::dvec2 bottom(double(i) / columns, 1 - k / 200.0 / rows);
                    steepest = std::max(steepest, std::abs(latitudes->at(top).gradient.y));
                    steepest = std::max(steepest, std::abs(latitudes->at(bottom).gradient.y));
                    // Between the teeth.
                    const double v = (1 + (rows - 2.0) * k / 200) / rows;
                    seam = std::max(
                        seam, std::abs(longitudes->value({0, v}) - longitudes->value({1, v})));
                }
            EXPECT_LE(steepest, 1.3 * 2 * pi) << spacing;
            // At the seam's ends bicubic ones read gutters of teeth.
            EXPECT_LE(seam, filter == HeightFilter::bilinear ? 1e-9 : 1e-4) << spacing;
        }
}

// Maps that no end is read across in stay as they were: of charts with gutters, of rings, of tiles,
// of no charts, and where the limit is below a texel.
TEST(UnfoldedEnds, OthersAreFoldedStill) {
    constexpr std::uint32_t size = 64;
    const auto width = [&](const detail::ChartAtlas& atlas, double spacing, Wrap wrap) {
        const auto map =
            HeightMap::make(random_picture(size, size, 5), plain(HeightFilter::bilinear, wrap));
        return map->limited(atlas, spacing)->map.width();
    };
    const auto quad = [](double low, double high) {
        Charts charts;
        add_quad(charts, {{{low, 0.2}, {high, 0.2}, {high, 0.7}, {low, 0.7}}});
        return charts;
    };
    EXPECT_EQ(width({.triangles = quad(0.05, 0.95)}, 0.1, Wrap::repeat), size);
    EXPECT_EQ(width({.triangles = quad(0, 3)}, 0.1, Wrap::repeat), size);
    EXPECT_EQ(width({}, 0.1, Wrap::repeat), size);
    EXPECT_EQ(width({.triangles = quad(0, 1)}, 0.5 / size, Wrap::repeat), size);
    EXPECT_EQ(width({.triangles = quad(0, 1)}, 0.1, Wrap::mirror), size);
    EXPECT_EQ(width({.triangles = quad(0, 1)}, 0.1, Wrap::clamp), size);
    EXPECT_GT(width({.triangles = quad(0, 1)}, 0.1, Wrap::repeat), size);
}

TEST(UnfoldedEnds, VectorsToo) {
    constexpr std::uint32_t size = 64;
    const auto vector = [](const glm::dvec2& p) {
        return glm::dvec3(2 * p.x + p.y, p.x - p.y, 0.5 - 3 * p.x);
    };
    Image image;
    image.width = image.height = size;
    image.channels = 3;
    image.floating = true;
    for (std::uint32_t y = 0; y < size; ++y)
        for (std::uint32_t x = 0; x < size; ++x)
            for (glm::length_t k = 0; k < 3; ++k)
                image.pixels.push_back(float(vector({(x + 0.5) / size, (y + 0.5) / size})[k]));
    const Mesh mesh = square(1, {0, 0});
    for (const HeightFilter filter : filters) {
        const auto map = vector_function(
            image, {.map = limited_to(0.1, filter), .axes = VectorAxes::object}, &mesh);
        ASSERT_TRUE(map);
        double most = 0;
        for (int j = 0; j <= 130; ++j)
            for (int i = 0; i <= 130; ++i) {
                const glm::dvec2 p = glm::dvec2(double(i), double(j)) / 130.0;
                most = std::max(most, glm::length((*map)->at(p).value - vector(p)));
            }
        EXPECT_LE(most, 2e-3);
    }
}

// The issue that it is for: a plane under a wave that repeats, cut to an error. No face is steeper
// than a border's waves may be, and there are no more of them than with a map that does not repeat,
// but for the last texels' halves, which are level there.
TEST(UnfoldedEnds, PlanesTakeNoMoreTrianglesThanClamped) {
    constexpr std::uint32_t size = 256;
    constexpr double amplitude = 0.05;
    const Mesh plane = square(2, {0, 0});
    const Image image = around(
        size, {0, 0}, [](const glm::dvec2& p) { return amplitude * std::sin(2 * pi * p.x + 1); });
    for (const HeightFilter filter : filters)
        for (const double spacing : {0.2, 0.4}) {
            std::size_t faces[2] = {};
            for (const Wrap wrap : {Wrap::repeat, Wrap::clamp}) {
                HeightMapOptions options = limited_to(spacing, filter);
                options.wrap_u = options.wrap_v = wrap;
                const auto height = height_function(image, options, &plane);
                ASSERT_TRUE(height);
                TessellateOptions cut;
                cut.displacements = {{*height}};
                cut.chord_error = 0.001;
                const auto made = tessellate(plane, cut);
                ASSERT_TRUE(made);
                const Mesh& mesh = made->mesh;
                double steepest = 0;
                for (std::size_t f = 0; f < mesh.face_count(); ++f) {
                    const auto at = [&](std::size_t k) {
                        return glm::dvec3(mesh.positions[mesh.corner_vertices[3 * f + k]]);
                    };
                    const glm::dvec3 n = glm::cross(at(1) - at(0), at(2) - at(0));
                    steepest = std::max(steepest, std::hypot(n.x, n.y) / std::abs(n.z));
                }
                EXPECT_LE(steepest, 1.3 * amplitude * pi) << spacing;
                faces[wrap == Wrap::clamp] = mesh.face_count();
            }
            EXPECT_LE(double(faces[0]), 1.1 * double(faces[1])) << spacing;
        }
}

}  // namespace
}  // namespace prep
