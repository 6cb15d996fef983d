// Band limits within charts, and in what tessellation makes of them.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "displacement/height_field.h"
#include "height_maps.h"
#include "pipeline/displacement_maps.h"
#include "prep/displacement/tessellate.h"

namespace prep {
namespace {

using detail::HeightMap;
using namespace test;

constexpr double pi = std::numbers::pi;
// What is linear over a chart stays so up to its border, whatever lies around it; charts of few
// texels and slivers as well.
TEST(ChartFilter, SlopesGoOnUpToTheBorder) {
    constexpr std::uint32_t size = 128;
    Charts square, tilted, sliver, corner;
    add_quad(square, {{{0.2, 0.3}, {0.7, 0.3}, {0.7, 0.8}, {0.2, 0.8}}});
    add_quad(tilted, {{{0.5, 0.15}, {0.85, 0.5}, {0.5, 0.85}, {0.15, 0.5}}});
    add_quad(sliver, {{{0.1, 0.5}, {0.9, 0.53}, {0.9, 0.56}, {0.1, 0.53}}});
    corner = {{{{0.1, 0.1}, {0.2, 0.11}, {0.11, 0.2}}}};
    const auto plane = [](const glm::dvec2& p) { return 3 * p.x - 2 * p.y; };
    for (const Charts& charts : {square, tilted, sliver, corner})
        for (const double spacing : {0.01, 0.04, 0.2, 3.0}) {
            const Image image = picture(size, size, [&](auto x, auto y) {
                const glm::dvec2 p((x + 0.5) / size, (y + 0.5) / size);
                return is_inside(charts, p) ? plane(p) : 1e6;
            });
            const auto map = HeightMap::make(image, plain());
            ASSERT_TRUE(map);
            const auto limited = map->limited({.triangles = charts}, spacing);
            ASSERT_TRUE(limited);
            const HeightMap read = limited->map.confined(charts);
            double most = 0;
            for (int j = 0; j < 400; ++j)
                for (int i = 0; i < 400; ++i) {
                    const glm::dvec2 p((i + 0.5) / 400, (j + 0.5) / 400);
                    if (is_inside(charts, p))
                        most = std::max(most, std::abs(read.value(p) - plane(p)));
                }
            // A texel's step is 0.04.
            EXPECT_LE(most, 2e-3) << charts.size() << " triangles, spacing " << spacing;
            EXPECT_LE(limited->change, 2e-3);
        }
}

// Charts that are as large as the map have two ends, whatever the map's wrap: a ramp stays one, for
// any number of threads.
TEST(ChartFilter, WholeMapsHaveTwoEnds) {
    constexpr std::uint32_t size = 64;
    const auto ramp = [](const glm::dvec2& p) { return 2 * p.x + p.y; };
    const Image image = picture(size, size, [&](auto x, auto y) {
        return ramp({(x + 0.5) / size, (y + 0.5) / size});
    });
    for (const Wrap wrap : {Wrap::repeat, Wrap::mirror, Wrap::clamp})
        for (const double inset : {0.0, 0.3 / size, 0.5 / size, 0.7 / size})
            for (const double spacing : {1.5 / size, 3.0 / size, 0.1, 0.4}) {
                Charts charts;
                add_quad(charts, {{{inset, inset},
                                   {1 - inset, inset},
                                   {1 - inset, 1 - inset},
                                   {inset, 1 - inset}}});
                std::vector<HeightMap> made;
                for (const int threads : {1, 3}) {
                    HeightMapOptions options = plain(HeightFilter::bilinear, wrap);
                    options.threads = threads;
                    const auto map = HeightMap::make(image, options);
                    const auto limited = map->limited({.triangles = charts}, spacing);
                    ASSERT_TRUE(limited);
                    made.push_back(limited->map.confined(charts));
                }
                double most = 0;
                for (int j = 0; j < 60; ++j)
                    for (int i = 0; i < 60; ++i) {
                        // Beyond the last texels' centres there is what the map repeats.
                        const glm::dvec2 p =
                            glm::dvec2(1.0 / size) +
                            (1 - 2.0 / size) * glm::dvec2(double(i), double(j)) / 59.0;
                        ASSERT_EQ(made[0].value(p), made[1].value(p));
                        most = std::max(most, std::abs(made[0].value(p) - ramp(p)));
                    }
                EXPECT_LE(most, 1e-3) << int(wrap) << " inset " << inset << " by " << spacing;
            }
}

// Where a height bends, its slope at the border is not the chart's: what is off grows with the
// square of the spacing, not with the spacing.
TEST(ChartFilter, BordersKeepTheirOwnSlope) {
    constexpr std::uint32_t size = 256;
    Charts charts;
    add_quad(charts, {{{0.2, 0.2}, {0.8, 0.2}, {0.8, 0.8}, {0.2, 0.8}}});
    const auto height = [](const glm::dvec2& p) { return 4 * p.x * p.x; };
    const Image image = picture(size, size, [&](auto x, auto y) {
        const glm::dvec2 p((x + 0.5) / size, (y + 0.5) / size);
        return is_inside(charts, p) ? height(p) : 1e6;
    });
    const auto map = HeightMap::make(image, plain());
    ASSERT_TRUE(map);
    for (const double spacing : {0.02, 0.04}) {
        const auto limited = map->limited({.triangles = charts}, spacing);
        ASSERT_TRUE(limited);
        const HeightMap read = limited->map.confined(charts);
        double most = 0;
        for (int k = 0; k <= 200; ++k)
            for (const double x : {0.2, 0.8}) {
                const glm::dvec2 p(x, 0.2 + 0.6 * k / 200);
                most = std::max(most, std::abs(read.value(p) - height(p)));
            }
        // Half the second derivative times the square of a spacing is 4 s².
        EXPECT_LE(most, 4 * spacing * spacing + 1e-3) << spacing;
    }
}

// Beside a chart that needs finer texels, one whose texels are coarser than its spacing along one
// side is what it was along that: linear between texels.
TEST(ChartFilter, TexelsCoarserThanASpacingAreReadBetween) {
    Charts charts;
    add_quad(charts, {{{0.05, 0.1}, {0.45, 0.1}, {0.45, 0.9}, {0.05, 0.9}}});
    add_quad(charts, {{{0.55, 0.1}, {0.95, 0.1}, {0.95, 0.9}, {0.55, 0.9}}});
    const std::vector<double> areas{0.16, 0.16, 40, 40};  // lengths of the second: 16 times
    const Image image = picture(32, 2048, [](auto x, auto) { return x % 2 == 0 ? 1.0 : -1.0; });
    const auto map = HeightMap::make(image, plain());
    ASSERT_TRUE(map);
    const auto limited = map->limited({.triangles = charts, .areas = areas}, 0.05);
    ASSERT_TRUE(limited);
    EXPECT_EQ(limited->map.width(), 5 * 32U);
    for (double x = 20; x <= 28; x += 0.05) {
        const double u = (x + 0.5) / 32;
        EXPECT_NEAR(limited->map.value({u, 0.5}), map->value({u, 0.5}), 0.35) << x;
    }
}

TEST(ChartFilter, OtherChartsMoveNothing) {
    constexpr std::uint32_t size = 128;
    Charts charts;
    add_quad(charts, {{{0.1, 0.1}, {0.45, 0.1}, {0.45, 0.9}, {0.1, 0.9}}});
    const Charts first = charts;
    add_quad(charts, {{{0.49, 0.1}, {0.9, 0.1}, {0.9, 0.9}, {0.49, 0.9}}});
    const auto limited = [&](double other) {
        const Image image = picture(size, size, [&](auto x, auto y) {
            const glm::dvec2 p((x + 0.5) / size, (y + 0.5) / size);
            return p.x < 0.47 ? std::sin(20 * p.x) * std::cos(31 * p.y) : other;
        });
        const auto map = HeightMap::make(image, plain());
        const auto made = map->limited({.triangles = charts}, 0.05);
        return made->map.confined(charts);
    };
    const HeightMap one = limited(0), other = limited(1e6);
    const auto as_read = HeightMap::make(picture(size, size,
                                                 [&](auto x, auto y) {
                                                     return std::sin(20 * (x + 0.5) / size) *
                                                            std::cos(31 * (y + 0.5) / size);
                                                 }),
                                         plain());
    double changed = 0;
    for (int j = 0; j < 200; ++j)
        for (int i = 0; i < 200; ++i) {
            const glm::dvec2 p((i + 0.5) / 200, (j + 0.5) / 200);
            if (!is_inside(first, p)) continue;
            ASSERT_EQ(one.value(p), other.value(p)) << p.x << ", " << p.y;
            changed = std::max(changed, std::abs(one.value(p) - as_read->value(p)));
        }
    EXPECT_GT(changed, 0.02);  // the filter did something
}

// A height over a square that is continuous, in four charts, turned and mirrored: what is left of
// it is the same on both sides of each seam but for what bends within a spacing, the waves that
// samples carry are there, the others are not.
void check_seams(std::uint32_t size, const std::vector<double>& angles) {
    constexpr double spacing = 0.02;  // of the square
    // Quarter q of the square, by its own (s, t) in 0 … 1, in the atlas.
    const auto atlas = [](int q, const glm::dvec2& st) {
        const glm::dvec2 low(q % 2 == 0 ? 0.04 : 0.54, q < 2 ? 0.04 : 0.54);
        glm::dvec2 at = st;
        if (q == 1) at = {1 - st.x, st.y};  // mirrored
        if (q == 2) at = {st.y, 1 - st.x};  // turned
        if (q == 3) at = {1 - st.y, 1 - st.x};
        return low + 0.42 * at;
    };
    const auto square = [](int q, const glm::dvec2& st) {
        return glm::dvec2((q % 2 + st.x) / 2, (q / 2 + st.y) / 2);
    };
    Mesh mesh;
    for (int j = 0; j <= 2; ++j)
        for (int i = 0; i <= 2; ++i)
            mesh.positions.emplace_back(0.5f * float(i), 0.5f * float(j), 0);
    mesh.uvs.resize(1);
    mesh.face_offsets = {0};
    for (int q = 0; q < 4; ++q) {
        for (const glm::ivec2& c :
             {glm::ivec2(0, 0), glm::ivec2(1, 0), glm::ivec2(1, 1), glm::ivec2(0, 1)}) {
            mesh.corner_vertices.push_back(std::uint32_t((q / 2 + c.y) * 3 + q % 2 + c.x));
            mesh.uvs[0].indices.push_back(std::uint32_t(mesh.uvs[0].values.size()));
            mesh.uvs[0].values.emplace_back(atlas(q, glm::dvec2(c)));
        }
        mesh.face_offsets.push_back(std::uint32_t(mesh.corner_vertices.size()));
    }
    const auto limited = [&](const auto& height) {
        const Image image = picture(size, size, [&](auto x, auto y) {
            const glm::dvec2 p((x + 0.5) / size, (y + 0.5) / size);
            for (int q = 0; q < 4; ++q) {
                const glm::dvec2 low = glm::min(atlas(q, {0, 0}), atlas(q, {1, 1}));
                const glm::dvec2 at = (p - low) / 0.42;
                if (at.x < -0.02 || at.y < -0.02 || at.x > 1.02 || at.y > 1.02) continue;
                glm::dvec2 st = at;
                if (q == 1) st = {1 - at.x, at.y};
                if (q == 2) st = {1 - at.y, at.x};
                if (q == 3) st = {1 - at.y, 1 - at.x};
                return height(square(q, st));
            }
            return 1e6;
        });
        HeightMapOptions options = plain(HeightFilter::bicubic);
        options.sample_spacing = spacing;
        return *height_function(image, options, &mesh);
    };
    // The largest difference of the two sides, and the largest value, along the seams.
    const auto seams = [&](const std::shared_ptr<const HeightFunction>& map) {
        glm::dvec2 most(0.0);
        const auto see = [&](int a, const glm::dvec2& st_a, int b, const glm::dvec2& st_b) {
            ASSERT_LT(glm::length(square(a, st_a) - square(b, st_b)), 1e-12);
            const double one = map->value(atlas(a, st_a)), other = map->value(atlas(b, st_b));
            most = glm::max(most, glm::dvec2(std::abs(one - other), std::abs(one)));
        };
        // From a kernel's width inside of the surface's border, where there is nothing across, on.
        for (int k = 100; k <= 500; ++k) {
            const double t = k / 500.0;
            see(0, {1, t}, 1, {0, t});
            see(2, {1, 1 - t}, 3, {0, 1 - t});
            see(0, {t, 1}, 2, {t, 0});
            see(1, {1 - t, 1}, 3, {1 - t, 0});
        }
        return most;
    };
    // Below 1/(4 spacing) = 12.5 cycles, and beyond 1/(2 spacing) = 25.
    const auto wave = [](double cycles, double angle) {
        return [=](const glm::dvec2& p) {
            return std::sin(2 * pi * cycles * (p.x * std::cos(angle) + p.y * std::sin(angle)) + 1);
        };
    };
    for (const double angle : angles) {
        // A texel's step is 0.05 and 0.1.
        const glm::dvec2 few = seams(limited(wave(3, angle)));
        const glm::dvec2 more = seams(limited(wave(6, angle)));
        const glm::dvec2 gone = seams(limited(wave(32, angle)));
        std::printf("angle %.1f: sides of seams apart %.4f (3 cycles), %.4f (6); 32: %.4f left\n",
                    angle, few.x, more.x, gone.y);
        EXPECT_LE(few.x, 0.025) << angle;
        EXPECT_LE(more.x, 0.025) << angle;
        EXPECT_GE(few.y, 0.9) << angle;
        EXPECT_LE(gone.y, 0.02) << angle;
    }
    // Periods near a step and its half, which must not come back as coarse waves.
    for (const double texels : {2.05, 4.1, 8.3})
        EXPECT_LE(seams(limited(wave(0.84 * size / texels, 0))).y, 0.03) << texels << " texels";
    // Within a chart, a kernel's width from its border.
    for (const auto& [cycles, passes] : {std::pair(11.0, true), std::pair(28.0, false)}) {
        const auto map = limited(wave(cycles, 0.7));
        double most = 0;
        for (int j = 0; j < 100; ++j)
            for (int i = 0; i < 100; ++i)
                most = std::max(
                    most,
                    std::abs(map->value(atlas(2, {0.3 + 0.4 * i / 100, 0.3 + 0.4 * j / 100}))));
        if (passes)
            EXPECT_GE(most, 0.95);
        else
            EXPECT_LE(most, 0.02);
    }
}

TEST(ChartFilter, SidesOfSeamsAgree) {
    check_seams(512, {0.0, 0.5, 1.1, 2.0});
}

// 34 texels to a spacing, which are read in steps of 4.
TEST(ChartFilter, SidesOfSeamsAgreeInSteps) {
    check_seams(2048, {0.5});
}

// Charts of one surface at different sizes in the map: spacings are lengths of the surface.
TEST(ChartFilter, EachChartHasItsOwnSpacing) {
    constexpr std::uint32_t size = 512;
    Charts charts;
    add_quad(charts, {{{0.02, 0.02}, {0.66, 0.02}, {0.66, 0.66}, {0.02, 0.66}}});
    add_quad(charts, {{{0.7, 0.7}, {0.86, 0.7}, {0.86, 0.86}, {0.7, 0.86}}});  // a quarter as wide
    const std::vector<double> areas(charts.size(), 0.5);
    for (const auto& [cycles, passes] : {std::pair(4.0, true), std::pair(11.0, false)}) {
        const double all = cycles;
        const Image image = picture(size, size, [&](auto x, auto y) {
            const double u = (x + 0.5) / size, v = (y + 0.5) / size;
            const bool large = u < 0.68 && v < 0.68;
            const double s = large ? (u - 0.02) / 0.64 : (u - 0.7) / 0.16;
            return std::cos(2 * pi * all * s);
        });
        const auto map = HeightMap::make(image, plain());
        const auto made =
            map->limited({.triangles = charts, .areas = areas}, 0.05);  // 5 and 10 cycles
        ASSERT_TRUE(made);
        for (const auto& [low, width] : {std::pair(0.02, 0.64), std::pair(0.7, 0.16)}) {
            double most = 0;
            for (int i = 0; i <= 200; ++i)
                most = std::max(most, std::abs(made->map.value({low + width * (0.3 + 0.4 * i / 200),
                                                                low + 0.5 * width})));
            if (passes)
                EXPECT_GE(most, 0.93) << width;
            else
                EXPECT_LE(most, 0.02) << width;
        }
    }
}

// Of a limit surface lengths are its own, which are 0.62 of the cage's.
TEST(ChartFilter, LengthsAreThoseOfTheLimitSurface) {
    constexpr std::uint32_t size = 256;
    Scene scene;
    Mesh& cube = scene.meshes.emplace_back();
    for (int k = 0; k < 8; ++k)
        cube.positions.emplace_back(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1);
    cube.corner_vertices = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5};
    cube.face_offsets = {0};
    cube.uvs.resize(1);
    for (std::uint32_t f = 0; f < 6; ++f) {
        cube.face_offsets.push_back(4 * f + 4);
        const glm::vec2 low(0.33f * float(f % 3) + 0.01f, 0.5f * float(f / 3) + 0.01f);
        for (const glm::vec2& c :
             {glm::vec2(0), glm::vec2(0.3F, 0), glm::vec2(0.3F), glm::vec2(0, 0.3F)}) {
            cube.uvs[0].indices.push_back(std::uint32_t(cube.uvs[0].values.size()));
            cube.uvs[0].values.push_back(low + c);
        }
    }
    // As an area: 6 · 0.3² over that of the limit surface.
    SubdivideOptions subdivision;
    subdivision.level = 5;
    const auto fine = subdivide(cube, subdivision);
    ASSERT_TRUE(fine);
    double area = 0;
    const Mesh& mesh = fine->mesh;
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
        const auto at = [&](std::size_t k) {
            return glm::dvec3(mesh.positions[mesh.corner_vertices[4 * f + k]]);
        };
        area += 0.5 * glm::length(glm::cross(at(2) - at(0), at(3) - at(1)));
    }
    EXPECT_NEAR(std::sqrt(area / 24), 0.62, 0.01);
    const double scale = std::sqrt(6 * 0.09 / area);  // of UVs, to a length
    constexpr double spacing = 0.1;
    subdivision.level = 0;
    for (const bool passes : {true, false}) {
        const double cycles = (passes ? 0.245 : 0.51) / (spacing * scale);
        DisplaceOptions options;
        options.band_limit = spacing;
        options.residual.emplace();
        options.midlevel = 0;
        const Image image = picture(size, size, [&](auto, auto y) {
            return std::cos(2 * pi * cycles * ((y + 0.5) / size - 0.16));
        });
        const std::filesystem::path path =
            std::filesystem::path(::testing::TempDir()) / "chart_filter_waves.exr";
        ASSERT_TRUE(save_image(path, image, PixelType::f32));
        options.map.emplace();
        options.map->path = path;
        detail::DisplacementMaps maps(options, 0);
        const auto of = maps.of(scene, cube, &subdivision);
        ASSERT_TRUE(of);
        ASSERT_EQ(of->as_read.size(), 1U);
        double most = 0, read = 0;
        for (int i = 0; i <= 100; ++i) {
            const glm::dvec2 uv(0.16, 0.13 + 0.06 * i / 100);
            most = std::max(most, std::abs(of->displacements[0].height->value(uv)));
            read = std::max(read, std::abs(of->as_read[0].height->value(uv)));
        }
        EXPECT_GT(read, 0.98);
        if (passes)
            EXPECT_GE(most, 0.95);
        else
            EXPECT_LE(most, 0.02);
    }
}

// The issue that it is for: cos(c r²) on a plane, cut into edges of a length: what such edges
// cannot carry is not in the mesh, what they carry is.
TEST(BandLimit, ZonePlateInATessellation) {
    constexpr std::uint32_t size = 1024;
    constexpr double most_cycles = 50, spacing = 1.0 / 64;
    const auto phase = [](double r) { return 2 * pi * most_cycles * r * r; };
    const Image image = picture(size, size, [&](auto x, auto y) {
        return std::cos(phase(std::hypot((x + 0.5) / size - 0.5, (y + 0.5) / size - 0.5)));
    });
    Mesh plane;
    // Twice as large as its UVs: lengths are the mesh's.
    plane.positions = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}};
    plane.corner_vertices = {0, 1, 2, 3};
    plane.face_offsets = {0, 4};
    plane.uvs.resize(1);
    plane.uvs[0].values = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    plane.uvs[0].indices = {0, 1, 2, 3};
    for (const bool limits : {true, false}) {
        HeightMapOptions options = plain();
        options.wrap_u = options.wrap_v = Wrap::clamp;
        options.scale = 1e-3;
        options.sample_spacing = limits ? 2 * spacing : 0;
        const auto height = height_function(image, options, &plane);
        ASSERT_TRUE(height);
        TessellateOptions cut;
        cut.displacements = {{*height}};
        cut.edge_length = 2 * spacing;
        const auto made = tessellate(plane, cut);
        ASSERT_TRUE(made);
        double stopped = 0, passed = 0, count = 0;
        for (const glm::vec3& p : made->mesh.positions) {
            const double r = std::hypot(p.x / 2 - 0.5, p.y / 2 - 0.5);
            const double cycles = 2 * most_cycles * r, change = 2 * most_cycles * 4 * spacing;
            const double height_there = double(p.z) * 1e3;
            if (r > 0.5 - 4 * spacing) continue;
            if (cycles >= 0.5 / spacing + change)
                stopped = std::max(stopped, std::abs(height_there));
            if (cycles <= 0.25 / spacing - change && std::abs(std::cos(phase(r))) > 0.9)
                passed += height_there / std::cos(phase(r)), ++count;
        }
        ASSERT_GT(count, 20);
        if (limits) {
            EXPECT_LE(stopped, 0.02);
            EXPECT_GE(passed / count, 0.95);
            EXPECT_LE(passed / count, 1.05);
        } else {
            EXPECT_GE(stopped, 0.9);  // what such a mesh shows otherwise: waves that are not there
        }
    }
}

}  // namespace
}  // namespace prep
