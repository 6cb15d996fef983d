// Exact areas and supersampling: against closed forms, each other, and multisampling.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "builders.h"
#include "oracles.h"

namespace {

using rast::Coverage;

prep::Material white() {
    prep::Material m;
    m.unlit = true;
    m.diffuse = glm::vec4(1);
    m.emissive = glm::vec3(0);
    m.double_sided = true;
    return m;
}

rast::RenderRequest flat(std::uint32_t pixels) {
    rast::RenderRequest request;
    request.width = request.height = pixels;
    request.view = test::flat_view(pixels / 2.0);  // one unit is a pixel, y up
    return request;
}

double rms(const rast::Frame& a, const rast::Frame& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.color.size(); ++i)
        for (int c = 0; c < 3; ++c) sum += std::pow(double(a.color[i][c]) - b.color[i][c], 2);
    return std::sqrt(sum / double(a.color.size() * 3));
}

bool same(const rast::Frame& a, const rast::Frame& b) {
    return a.color.size() == b.color.size() &&
           std::memcmp(a.color.data(), b.color.data(), a.color.size() * sizeof(glm::vec4)) == 0;
}

TEST(ExactAreas, AHalfPlanesEdgeGivesItsAreaInEveryPixel) {
    // The left of x < at, for edges all over a pixel: columns are 1, the fraction, 0.
    for (int k = 0; k <= 256; k += 16) {
        const float at = 3 + float(k) / 256;
        prep::VertexMesh mesh;
        mesh.positions = {{-100, -100, 0}, {at, -100, 0}, {at, 100, 0}, {-100, 100, 0}};
        mesh.indices = {0, 1, 2, 0, 2, 3};
        rast::RenderRequest request = flat(16);
        request.coverage = Coverage::area;
        const rast::Frame frame = test::draw(test::scene_of(mesh, white()), request);
        for (std::uint32_t x = 0; x < 16; ++x) {
            const double expected = std::clamp(at + 8.0 - x, 0.0, 1.0);
            for (std::uint32_t y = 0; y < 16; ++y) {
                EXPECT_NEAR(frame.color[y * 16 + x].r, expected, 1e-7) << x << " " << y;
                EXPECT_NEAR(frame.color[y * 16 + x].a, expected, 1e-7);
            }
        }
    }
    // y < x / 2 about the centre: the edge cuts pixels into trapezoids, triangles or not at all.
    prep::VertexMesh mesh;
    mesh.positions = {{-128, -64, 0}, {128, -64, 0}, {128, 64, 0}};
    mesh.indices = {0, 1, 2};
    rast::RenderRequest request = flat(16);
    request.coverage = Coverage::area;
    const rast::Frame frame = test::draw(test::scene_of(mesh, white()), request);
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x) {
            // Integral over the pixel's columns of the part below the line, exact for lines that
            // leave through the sides or not; the slope ½ never passes two rows in one column.
            const double bottom = 7 - y, left = x - 8;
            const auto below = [&](double h) {  // ∫ of clamp(s / 2 − bottom, 0, 1) from 0 to h
                const double u = h / 2 - bottom;
                const double f = u <= 0 ? 0 : u >= 1 ? u - 0.5 : u * u / 2;
                return 2 * f;
            };
            EXPECT_NEAR(frame.color[std::size_t(y * 16 + x)].r, below(left + 1) - below(left), 1e-7)
                << x << " " << y;
        }
}

TEST(ExactAreas, TriangulationsSumToOneEverywhereInside) {
    // A grid of the unit square jittered inside, each cell two triangles, over all of the picture.
    std::mt19937_64 random(12);
    constexpr int cells = 40;
    prep::VertexMesh mesh;
    for (int j = 0; j <= cells; ++j)
        for (int i = 0; i <= cells; ++i) {
            const bool rim = i == 0 || j == 0 || i == cells || j == cells;
            const auto jitter = [&] { return rim ? 0.0 : double(random() % 200) / 256 - 0.4; };
            const double x = (i + jitter()) / cells, y = (j + jitter()) / cells;
            mesh.positions.push_back(glm::vec3(40 * x - 20, 40 * y - 20, 0));
        }
    for (std::uint32_t j = 0; j < cells; ++j)
        for (std::uint32_t i = 0; i < cells; ++i) {
            const std::uint32_t a = j * (cells + 1) + i, b = a + 1, c = a + cells + 1, d = c + 1;
            mesh.indices.insert(mesh.indices.end(), {a, b, d, a, d, c});
        }
    rast::RenderRequest request = flat(32);
    request.coverage = Coverage::area;
    const rast::Frame frame = test::draw(test::scene_of(mesh, white()), request);
    for (const glm::vec4& c : frame.color) {
        EXPECT_NEAR(c.a, 1, 6e-8f);  // half a float's step
        EXPECT_NEAR(c.r, 1, 6e-8f);
    }
}

TEST(ExactAreas, SamplesConvergeToThem) {
    prep::PreparedScene scene = test::scene_of(test::sphere(24, 16), white());
    prep::Node node = scene.scene.nodes[0];
    node.transform[3] = glm::dvec4(0.7, 0.3, 0.4, 1);
    scene.scene.nodes.push_back(node);  // passes through the first
    rast::RenderRequest request;
    request.width = 90;
    request.height = 70;
    request.view = test::look_at({1, 2, 4}, {0.3, 0.1, 0});
    request.shading = rast::Shading::flat;
    scene.scene.materials[0].unlit = false;  // facets differ: edges inside show as well
    const auto draw = [&](Coverage coverage, int samples, int super) {
        request.coverage = coverage;
        request.samples = samples;
        request.supersample = super;
        return test::draw(scene, request);
    };
    const rast::Frame truth = draw(Coverage::area, 1, 1);
    double before = rms(draw(Coverage::samples, 1, 1), truth);
    const double one = before;
    for (const int samples : {2, 4, 8, 16}) {
        const double error = rms(draw(Coverage::samples, samples, 1), truth);
        EXPECT_LT(error, before) << samples;
        before = error;
    }
    // Sixteen well-spread samples err as 1/16 each way; a quarter of that in all is generous.
    EXPECT_LT(before, one / 4);
    double last = one;
    for (const int super : {2, 4, 8, 16}) {
        const double error = rms(draw(Coverage::samples, 1, super), truth);
        EXPECT_LT(error, last * 0.75) << super;
        last = error;
    }
    EXPECT_LT(last, one / 12);
}

TEST(ExactAreas, DoNotDependOnCropsThreadsOrInstructionSets) {
    const prep::PreparedScene scene = test::scene_of(test::sphere(40, 30), prep::Material{});
    rast::RenderRequest request;
    request.width = 140;
    request.height = 100;
    request.coverage = Coverage::area;
    request.threads = 1;
    request.simd = prep::SimdLevel::scalar;
    request.keep_depth = true;
    const rast::Frame whole = test::draw(scene, request);
    request.threads = 3;
    request.simd = prep::SimdLevel::automatic;
    EXPECT_TRUE(same(whole, test::draw(scene, request)));
    request.crop = rast::Crop{30, 20, 71, 67};
    const rast::Frame part = test::draw(scene, request);
    for (std::uint32_t y = 0; y < 67; ++y)
        ASSERT_EQ(std::memcmp(&part.color[y * 71], &whole.color[(y + 20) * 140 + 30],
                              71 * sizeof(glm::vec4)),
                  0)
            << y;
    // Buffers are those of the sampled picture.
    rast::RenderRequest plain = request;
    plain.coverage = Coverage::samples;
    EXPECT_EQ(test::draw(scene, plain).depth, part.depth);
}

TEST(ExactAreas, TrianglesAcrossTheNearPlaneKeepWhatIsInFront) {
    // A floor from behind the eye to far away: everything below the horizon is covered once.
    prep::VertexMesh mesh;
    mesh.positions = {{-1000, -1, 1000}, {1000, -1, 1000}, {1000, -1, -1000}, {-1000, -1, -1000}};
    mesh.indices = {0, 1, 2, 0, 2, 3};
    rast::RenderRequest request;
    request.width = request.height = 32;
    request.view = test::look_at({0, 0, 0}, {0, 0, -1});
    request.coverage = Coverage::area;
    const rast::Frame frame = test::draw(test::scene_of(mesh, white()), request);
    for (std::uint32_t y = 0; y < 32; ++y)
        for (std::uint32_t x = 0; x < 32; ++x) {
            // The floor ends a thousandth below the middle, inside row 16.
            const float covered = frame.color[y * 32 + x].a;
            if (y != 16) {
                EXPECT_NEAR(covered, y > 16 ? 1 : 0, 1e-6) << x << " " << y;
            }
        }
}

// Where the near plane cuts a triangle, its depth there is the near plane's: a floor and a ramp,
// both from behind the eye to far away, meet where rays say.
TEST(ExactAreas, SurfacesThatTheNearPlaneCutsMeetWhereRaysSay) {
    // Of two corners behind the eye, and of one; heights over the ground by x and z.
    const glm::dvec3 ground[3] = {{-40, -1, 12}, {40, -1, 12}, {0, -1, -60}};
    const glm::dvec3 ramp[3] = {{-25, 6, -40}, {30, -14, -35}, {3, -1.25, 20}};
    prep::VertexMesh mesh;
    for (const auto* corners : {ground, ramp})
        for (int k = 0; k < 3; ++k) mesh.positions.push_back(glm::vec3(corners[k]));
    mesh.colors = {{}};
    for (int k = 0; k < 6; ++k)
        mesh.colors[0].push_back(k < 3 ? glm::vec4(1, 0, 0, 1) : glm::vec4(0, 1, 0, 1));
    mesh.indices = {0, 1, 2, 3, 4, 5};
    prep::Material material = white();
    material.unlit = material.double_sided = true;
    for (const bool perspective : {true, false}) {
        rast::RenderRequest request;
        request.width = 64;
        request.height = 48;
        request.coverage = Coverage::area;
        request.view = test::look_at({0, 0.25, 2}, {0, -0.75, -3}, 1.2, 0.75);
        request.view->perspective = perspective;
        request.view->half_height = 2;
        request.view->zfar = perspective ? 0 : 100;
        const rast::Frame frame = test::draw(test::scene_of(mesh, material), request);
        // What a ray meets first beyond the near plane: 0 nothing, 1 the ground, 2 the ramp; −1
        // where both are close, so that a corner's snapping decides.
        const auto seen = [&](double x, double y) {
            const test::Ray ray = test::ray_at(*request.view, frame.width, frame.height, x, y);
            double nearest = 1e300;
            int what = 0;
            for (int which = 1; which <= 2; ++which) {
                const glm::dvec3* const p = which == 1 ? ground : ramp;
                const glm::dvec3 n = glm::cross(p[1] - p[0], p[2] - p[0]);
                const double t = glm::dot(p[0] - ray.from, n) / glm::dot(ray.direction, n);
                const glm::dvec3 w = test::weights_at(ray, p);
                if (t < 0.75 || std::min({w.x, w.y, w.z}) < 0) continue;
                if (std::abs(t - nearest) < 0.03 * t) return -1;
                if (t >= nearest) continue;
                nearest = t;
                what = which;
            }
            return what;
        };
        int found[3] = {};
        for (std::uint32_t y = 0; y < frame.height; ++y)
            for (std::uint32_t x = 0; x < frame.width; ++x) {
                const int what = seen(x + 0.5, y + 0.5);
                bool whole = what >= 0;
                for (const double dx : {0.0, 0.5, 1.0})
                    for (const double dy : {0.0, 0.5, 1.0})
                        whole = whole && seen(x + dx, y + dy) == what;
                if (!whole) continue;
                const glm::vec4 expected(what == 1, what == 2, 0, what > 0);
                ASSERT_LT(glm::distance(frame.color[y * frame.width + x], expected), 1e-5)
                    << x << " " << y << " " << what;
                ++found[what];
            }
        for (const int count : found) EXPECT_GT(count, 100);
    }
}

TEST(ExactAreas, BrokenAndHugeCornersAddNothingOrTheirPart) {
    const float nan = std::nanf(""), huge = 3e38f;
    prep::VertexMesh mesh;
    mesh.positions = {{nan, 0, 0},  {1, 0, 0},       {0, 1, 0},         // left out
                      {huge, 0, 0}, {huge, huge, 0}, {-huge, huge, 0},  // beyond every pixel
                      {-4, -4, 0},  {4, -4, 0},      {-4, 4, 0}};
    mesh.indices = {0, 1, 2, 3, 4, 5, 6, 7, 8, 6, 6, 7};
    rast::RenderRequest request = flat(16);
    request.coverage = Coverage::area;
    const rast::Frame frame = test::draw(test::scene_of(mesh, white()), request);
    double sum = 0;
    for (std::uint32_t y = 8; y < 16; ++y)  // below the middle, where nothing huge reaches
        for (std::uint32_t x = 0; x < 16; ++x) sum += frame.color[y * 16 + x].a;
    EXPECT_NEAR(sum, 24, 1e-5);  // of the triangle's 32, 8 lie above
    for (const glm::vec4& c : frame.color) EXPECT_TRUE(c.a >= 0 && c.a <= 1.0000001f);
}

// One wall before everything: as many shares as pixels, and no sample shaded beside them.
TEST(ExactAreas, ShadeEveryShareOnce) {
    prep::VertexMesh mesh;
    mesh.positions = {{-900, -900, 0}, {900, -900, 0}, {0, 900, 0}};
    mesh.indices = {0, 1, 2};
    const prep::PreparedScene scene = test::scene_of(mesh, white());
    rast::RenderRequest request = flat(100);
    request.coverage = Coverage::area;
    EXPECT_EQ(test::draw(scene, request).counters.pixels_shaded, 100u * 100);
    request.keep_depth = request.keep_normals = true;
    const rast::Frame buffers = test::draw(scene, request);
    EXPECT_EQ(buffers.counters.pixels_shaded, 100u * 100);
    EXPECT_GT(buffers.depth[50 * 100 + 50], 0.0f);
    EXPECT_NEAR(buffers.normal[50 * 100 + 50].z, 1, 1e-6);
}

// However many rows of tiles the finer picture has.
TEST(Supersampling, CountsTrianglesOnce) {
    const prep::PreparedScene scene = test::scene_of(test::sphere(60, 40), prep::Material{});
    rast::RenderRequest request;
    request.width = 150;
    request.height = 170;
    for (const int factor : {2, 3, 5, 16}) {
        request.supersample = factor;
        const rast::Counters fine = test::draw(scene, request).counters;
        rast::RenderRequest larger = request;
        larger.width *= std::uint32_t(factor);
        larger.height *= std::uint32_t(factor);
        larger.supersample = 1;
        const rast::Counters whole = test::draw(scene, larger).counters;
        EXPECT_EQ(fine.triangles, whole.triangles) << factor;
        EXPECT_EQ(fine.facing_away, whole.facing_away) << factor;
        EXPECT_EQ(fine.pixels_shaded, whole.pixels_shaded) << factor;
    }
}

TEST(Supersampling, IsTheMeanOfTheFinerPicture) {
    const prep::PreparedScene scene = test::scene_of(test::sphere(20, 14), prep::Material{});
    rast::RenderRequest request;
    request.width = 50;
    request.height = 38;
    request.supersample = 3;
    request.keep_ids = true;
    const rast::Frame coarse = test::draw(scene, request);
    rast::RenderRequest finer = request;
    finer.width *= 3;
    finer.height *= 3;
    finer.supersample = 1;
    const rast::Frame fine = test::draw(scene, finer);
    for (std::uint32_t y = 0; y < 38; ++y)
        for (std::uint32_t x = 0; x < 50; ++x) {
            glm::dvec4 sum(0);
            for (std::uint32_t j = 0; j < 3; ++j)
                for (std::uint32_t i = 0; i < 3; ++i)
                    sum += glm::dvec4(fine.color[(y * 3 + j) * 150 + x * 3 + i]);
            for (int c = 0; c < 4; ++c)
                ASSERT_FLOAT_EQ(coarse.color[y * 50 + x][c], float(sum[c] / 9)) << x << " " << y;
        }
    // Rows of tiles that end within a pixel.
    for (const int factor : {3, 5}) {
        rast::RenderRequest tall;
        tall.width = 20;
        tall.height = 90;
        tall.supersample = factor;
        const rast::Frame reduced = test::draw(scene, tall);
        tall.width *= std::uint32_t(factor);
        tall.height *= std::uint32_t(factor);
        tall.supersample = 1;
        const rast::Frame whole = test::draw(scene, tall);
        const std::uint32_t n = std::uint32_t(factor);
        for (std::uint32_t y = 0; y < 90; ++y)
            for (std::uint32_t x = 0; x < 20; ++x) {
                double sum = 0;
                for (std::uint32_t j = 0; j < n; ++j)
                    for (std::uint32_t i = 0; i < n; ++i)
                        sum += whole.color[(y * n + j) * 20 * n + x * n + i].g;
                ASSERT_FLOAT_EQ(reduced.color[y * 20 + x].g, float(sum / double(n * n))) << y;
            }
    }
    // A crop of it is part of it; buffers are those of the plain picture.
    request.crop = rast::Crop{7, 9, 30, 20};
    const rast::Frame part = test::draw(scene, request);
    for (std::uint32_t y = 0; y < 20; ++y)
        ASSERT_EQ(std::memcmp(&part.color[y * 30], &coarse.color[(y + 9) * 50 + 7],
                              30 * sizeof(glm::vec4)),
                  0);
    rast::RenderRequest plain = request;
    plain.supersample = 1;
    EXPECT_EQ(test::draw(scene, plain).triangle, part.triangle);
}

TEST(Supersampling, UnofferedChoicesAreErrors) {
    const prep::PreparedScene scene = test::scene_of(test::sphere(4, 4));
    rast::RenderRequest request;
    request.supersample = 0;
    EXPECT_FALSE(rast::plan(scene, request));
    request.supersample = 17;
    EXPECT_FALSE(rast::plan(scene, request));
    request.supersample = 16;
    request.width = 2048;
    EXPECT_TRUE(rast::plan(scene, request));
    request.width = 2049;
    const auto large = rast::plan(scene, request);
    ASSERT_FALSE(large);
    EXPECT_EQ(large.error().code, prep::ErrorCode::limit);
    request = {};
    request.coverage = Coverage::area;
    request.samples = 4;
    EXPECT_FALSE(rast::plan(scene, request));
}

// A fan of slivers, far thinner than pixels near its tip, in colours that are the place: whatever
// sample a pixel is shaded at, its colour cannot be farther off than half a pixel's diagonal.
TEST(Multisampling, ShadesNothingOutsideItsTriangle) {
    constexpr int slivers = 400, size = 64;
    prep::VertexMesh mesh;
    mesh.colors.emplace_back();
    const auto add = [&](float x, float y) {
        mesh.positions.emplace_back(x, y, 0.0f);
        mesh.colors[0].emplace_back((x + 32) / 64, (y + 32) / 64, 0.0f, 1.0f);
    };
    add(-32, -32);
    for (int k = 0; k <= slivers; ++k) add(32, -32 + 64.0f * float(k) / slivers);
    for (std::uint32_t k = 0; k < slivers; ++k)
        for (const std::uint32_t v : {0u, k + 1, k + 2}) mesh.indices.push_back(v);
    const prep::PreparedScene scene = test::scene_of(mesh, white());
    for (const int samples : {2, 4, 8, 16}) {
        rast::RenderRequest request = flat(size);
        request.samples = samples;
        const rast::Frame frame = test::draw(scene, request);
        double worst = 0;
        for (int y = 1; y < size - 1; ++y)
            for (int x = size - y + 1; x < size - 1; ++x) {  // wholly below the diagonal
                const glm::vec4& c = frame.color[std::size_t(y * size + x)];
                worst = std::max({worst, std::abs(c.r * 64.0 - (x + 0.5)),
                                  std::abs(c.g * 64.0 - (size - y - 0.5))});
            }
        EXPECT_LT(worst, 0.5 + 1e-4) << samples;  // pixels, along either axis
    }
}

}  // namespace
