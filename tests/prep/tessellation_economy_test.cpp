// How many triangles an error takes: adaptive against uniform grids, at equal true error
// (tessellation_economy.h). docs/displacement.md has the tables that this prints.
#include "tessellation_economy.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>

#include "prep/load.h"
#include "shared_data.h"
#include "tessellation_checks.h"

namespace prep {
namespace {

using namespace tessellation_checks;

// Every face the whole of the UV square.
Mesh charted(Mesh mesh) {
    mesh.uvs.assign(1, {});
    mesh.uvs[0].values = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    for (std::uint32_t c = 0; c < mesh.corner_count(); ++c) mesh.uvs[0].indices.push_back(c % 4);
    return mesh;
}

constexpr std::optional<SubdivisionScheme> polygons = std::nullopt;
constexpr auto catmark = SubdivisionScheme::catmark, loop = SubdivisionScheme::loop;

// Cones on a plane: detail here and there, as of craters.
Displacement cones() {
    constexpr std::uint32_t size = 64;
    Image image{.width = size, .height = size, .channels = 1, .pixels = {}, .floating = true};
    for (std::uint32_t y = 0; y < size; ++y)
        for (std::uint32_t x = 0; x < size; ++x) {
            double height = 0;
            for (const glm::dvec3 c :
                 {glm::dvec3(14, 18, 9), {45, 30, 6}, {22, 50, 5}, {52, 54, 4}})
                height = std::max(height, 1 - glm::length(glm::dvec2(c) - glm::dvec2(x, y)) / c.z);
            image.pixels.push_back(float(0.1 * height));
        }
    HeightMapOptions options;
    options.midlevel = 0;
    options.wrap_u = options.wrap_v = Wrap::clamp;
    const auto made = height_function(image, options);
    EXPECT_TRUE(made);
    return {.height = *made};
}

Displacement waves(double scale, double k) {
    return {.height = std::make_shared<Waves>(scale, k, k)};
}

TEST(TessellationEconomy, TrianglesAtEqualTrueError) {
    constexpr double round = 2 * std::numbers::pi;
    struct Case {
        const char* name;
        Mesh cage;
        std::optional<SubdivisionScheme> scheme;
        Displacement by;
        double most = 0;  // of uniform triangles at level 4, where that is less than all
    };
    const Displacement nothing{.height = nullptr};
    std::vector<Case> cases{{"quad, a spike of a texel of 32²",
                             unit_quad(),
                             polygons,
                             {.height = std::make_shared<Spike>(32, 10, 18, 0.1)},
                             0.5},
                            {"quad, four cones", unit_quad(), polygons, cones(), 0.5},
                            {"quad, sines", unit_quad(), polygons, waves(0.1, round)},
                            {"quad, noise", unit_quad(), polygons, space_noise(4, 3, 0.1)},
                            {"cube, noise", cube(), polygons, space_noise(1, 3, 0.2)},
                            {"cube's limit surface", cube(), catmark, nothing},
                            {"the same, sines", charted(cube()), catmark, waves(0.1, round)},
                            {"the same, noise", cube(), catmark, space_noise(1, 3, 0.2)},
                            {"torus' limit surface", torus(6, 4), catmark, nothing},
                            {"the same, noise", torus(6, 4), catmark, space_noise(0.7, 3, 0.2)}};
    const std::size_t few = for_tables() ? 10 : 2;  // faces that are few enough for level 4
    std::vector<double> ratios;
    for (Case& c : cases) {
        Economy of(c.cage, c.scheme, c.by);
        // Points along a face's side: of one quad those that have all centres of 32² and 64²
        // texels.
        const int dense = c.cage.face_count() == 1 ? 128 : 64;
        for (int level = 1; level <= (c.cage.face_count() < few ? 4 : 3); ++level) {
            const std::uint64_t even = of.uniform_triangles(level);
            const double error = of.uniform_error(level, dense >> level);
            // The coarsest of some that is no farther off than that.
            Economy::Made best;
            for (const double more : {4.0, 2.7, 2.0, 1.5, 1.2, 1.0}) {
                best = of.adaptive(more * error, 8, 1 << 20);
                EXPECT_LE(best.error, best.proved);
                EXPECT_LE(best.proved, more * error);
                if (best.error <= error) break;
            }
            EXPECT_LE(best.error, error);
            const double ratio = double(best.triangles) / double(even);
            ratios.push_back(ratio);
            std::printf("%-34s level %d, error %.3g: uniform %zu, adaptive %zu (%.2f)\n", c.name,
                        level, error, std::size_t(even), std::size_t(best.triangles), ratio);
            // Detail here and there is what it is for.
            if (level == 4 && c.most > 0) {
                EXPECT_LE(ratio, c.most) << c.name;
            }
        }
    }
    std::sort(ratios.begin(), ratios.end());
    const double median = ratios[ratios.size() / 2];
    std::printf("median %.2f, largest %.2f\n", median, ratios.back());
    EXPECT_LE(median, 1.1);
}

// What files have: cages of several makers, pictures, and noise.
struct RealCase {
    const char* name;
    const char* cage;  // in the corpus
    std::optional<SubdivisionScheme> scheme;
    const char* map = nullptr;  // in the corpus; seen along z, over the box around the cage
    double noise = 0;           // cells along the box's diagonal
    double height = 0;          // over the diagonal
};
constexpr RealCase real_cases[] = {
    {"wall, stones", "Brickwall/brickwall.obj", polygons,
     "seaside-rocks01/seaside-rocks01-height.jpg", 0, 0.04},
    {"wall, tiles", "Brickwall/brickwall.obj", polygons, "floor_tiles/floor_tiles_bumpmap.png", 0,
     0.02},
    {"wall, letters", "Brickwall/brickwall.obj", polygons, "parallax_cube/cube_depth.png", 0, 0.03},
    {"spot's limit surface", "spot_control_mesh.obj", catmark},
    {"spot's limit surface, noise", "spot_control_mesh.obj", catmark, nullptr, 6, 0.02},
    {"spot's cage, stones", "spot_control_mesh.obj", polygons,
     "seaside-rocks01/seaside-rocks01-height.jpg", 0, 0.01},
    {"penguin's limit surface", "penguin_control_mesh.obj", catmark},
    {"penguin's limit surface, letters", "penguin_control_mesh.obj", catmark,
     "parallax_cube/cube_depth.png", 0, 0.02},
    {"Suzanne's limit surface", "suzanne.obj", catmark},
    {"Suzanne's limit surface, noise", "suzanne.obj", catmark, nullptr, 8, 0.01},
    {"car's limit surface", "subdiv/catmark_car.obj", catmark},
    {"rook's limit surface", "subdiv/catmark_rook.obj", catmark},
    {"rook's limit surface, noise", "subdiv/catmark_rook.obj", catmark, nullptr, 5, 0.02},
    {"helmet's limit surface", "osd-shapes/catmark_helmet.obj", catmark},
    {"helmet's limit surface, letters", "osd-shapes/catmark_helmet.obj", catmark,
     "parallax_cube/cube_depth.png", 0, 0.03},
    {"pole of 64", "subdiv/catmark_pole64.obj", catmark},
    {"cube with creases, noise", "subdiv/catmark_cube_creases0.obj", catmark, nullptr, 3, 0.03},
    {"sheet with a crease", "subdiv/catmark_single_crease.obj", catmark},
    {"fandisk's quads, tiles", "fandisk_quads.off", polygons, "floor_tiles/floor_tiles_bumpmap.png",
     0, 0.01},
    {"fandisk's limit surface", "fandisk_quads.off", catmark},
    {"fandisk, Loop", "fandisk.obj", loop},
    {"fandisk, Loop, noise", "fandisk.obj", loop, nullptr, 6, 0.01},
    {"head, Loop", "african_head/african_head.obj", loop},
    {"head, Loop, noise", "african_head/african_head.obj", loop, nullptr, 10, 0.01},
    {"head, noise", "african_head/african_head.obj", polygons, nullptr, 10, 0.01},
    {"beetle, noise", "beetle.obj", polygons, nullptr, 4, 0.01},
};

// Of half as many texels a side, until they are no more than that.
Image reduced(Image image, std::uint32_t most) {
    while (image.width > most) {
        Image half = image;
        half.width /= 2;
        half.height /= 2;
        half.channels = 1;
        half.floating = true;
        half.integer_bits = 0;
        half.pixels.clear();
        for (std::uint32_t y = 0; y < half.height; ++y)
            for (std::uint32_t x = 0; x < half.width; ++x)
                half.pixels.push_back((*image.at(2 * x, 2 * y) + *image.at(2 * x + 1, 2 * y) +
                                       *image.at(2 * x, 2 * y + 1) +
                                       *image.at(2 * x + 1, 2 * y + 1)) /
                                      4);
        image = std::move(half);
    }
    return image;
}

std::unique_ptr<Economy> economy_of(const RealCase& c, const std::filesystem::path& corpus,
                                    double* diagonal) {
    auto scene = load_scene(corpus / c.cage);
    EXPECT_TRUE(scene) << c.cage;
    Mesh cage = std::move(scene->meshes.at(0));
    glm::dvec3 low(cage.positions[0]), high(low);
    for (const glm::vec3& p : cage.positions) {
        low = glm::min(low, glm::dvec3(p));
        high = glm::max(high, glm::dvec3(p));
    }
    *diagonal = glm::length(high - low);
    Displacement by{.height = nullptr};
    if (c.noise > 0) by = space_noise(c.noise / *diagonal, 4, c.height * *diagonal);
    if (c.map) {
        glm::length_t flat = 2;  // the axis along which it is seen: a wall's own
        for (glm::length_t k = 0; k < 3; ++k)
            if (high[k] - low[k] < 0.01 * *diagonal) flat = k;
        cage.uvs.assign(1, {});
        const glm::length_t u = (flat + 1) % 3, v = (flat + 2) % 3;
        for (const glm::vec3& p : cage.positions) {
            const glm::dvec3 at = glm::dvec3(p) - low;
            cage.uvs[0].values.emplace_back(at[u] / (high[u] - low[u]), at[v] / (high[v] - low[v]));
        }
        cage.uvs[0].indices = cage.corner_vertices;
        auto image = load_image(corpus / c.map);
        EXPECT_TRUE(image) << c.map;
        HeightMapOptions options;
        options.scale = c.height * *diagonal;
        options.wrap_u = options.wrap_v = Wrap::clamp;
        auto made = height_function(reduced(*std::move(image), 256), options);
        EXPECT_TRUE(made);
        by.height = *made;
    }
    return std::make_unique<Economy>(std::move(cage), c.scheme, std::move(by));
}

double quantile(std::vector<double> values, double part) {
    std::sort(values.begin(), values.end());
    return values[std::min(values.size() - 1, std::size_t(part * double(values.size())))];
}

// Errors that take more than 10,000 triangles: MESHPREP_TABLES, the finest MESHPREP_LONG_TESTS.
TEST(TessellationEconomy, RealCasesBesideTheBestUniformLevel) {
    MESHPREP_REQUIRE_SHARED(shared);
    const bool all = std::getenv("MESHPREP_LONG_TESTS") != nullptr;
    const std::uint64_t limit = all ? 1'000'000 : for_tables() ? 30'000 : 10'000;
    // No level is looked at that has so many times as many triangles. The first of these stands for
    // the level that is no farther off, which has at least as many.
    const std::uint64_t beyond = for_tables() ? 8 : 2;
    std::vector<double> ratios, bounds;
    for (const RealCase& c : real_cases) {
        double diagonal = 1;
        const auto of = economy_of(c, shared / "corpus", &diagonal);
        for (const double part : {3e-2, 3e-3, 3e-4, 3e-5}) {
            const double asked = part * diagonal;
            const Economy::Made made = of->adaptive(asked, 4, limit);
            if (!made.within_limit) {
                std::printf("%-34s %.0e: more than %zu triangles\n", c.name, part,
                            std::size_t(limit));
                break;
            }
            EXPECT_LE(made.error, made.proved) << c.name << ' ' << part;
            EXPECT_LE(made.proved, asked) << c.name << ' ' << part;
            // The coarsest level that is no farther off.
            int level = 0;
            bool found = false;
            while (of->uniform_triangles(level) < beyond * made.triangles) {
                // As densely as the adaptive one's worst triangles.
                const int each = Economy::points_of(of->uniform_triangles(level));
                const double error = of->uniform_error(level, std::max(4, 4 * each), made.error);
                found = error <= made.error;
                if (found) break;
                ++level;
            }
            const double ratio = double(made.triangles) / double(of->uniform_triangles(level));
            ratios.push_back(ratio);
            EXPECT_LE(ratio, 1) << c.name << ' ' << part;
            bounds.push_back(made.proved / made.error);
            std::printf(
                "%-34s %.0e: %8zu triangles, proved %.3g, true %.3g (%.2f); level %d%s has "
                "%zu (%.2f)\n",
                c.name, part, std::size_t(made.triangles), made.proved / diagonal,
                made.error / diagonal, bounds.back(), level, found ? "" : " or more",
                std::size_t(of->uniform_triangles(level)), ratio);
            std::fflush(stdout);
        }
    }
    std::printf(
        "%zu of them: triangles over a uniform level's: median %.2f, largest %.2f; proved "
        "over true: median %.2f, 95 %% %.2f, largest %.2f\n",
        ratios.size(), quantile(ratios, 0.5), quantile(ratios, 1), quantile(bounds, 0.5),
        quantile(bounds, 0.95), quantile(bounds, 1));
    EXPECT_LE(quantile(ratios, 0.5), 0.5);
    EXPECT_LE(quantile(bounds, 0.5), 4);
    EXPECT_LE(quantile(bounds, 0.95), 10);
}

}  // namespace
}  // namespace prep
