// Seeded campaigns: spikes of one texel in large maps, bulges between straight edges, budgets
// against errors. A slice of each in the suite; MESHPREP_LONG_TESTS=1 takes all of them.
#include <gtest/gtest.h>

#include <cstdlib>

#include "prep/displacement/tessellate.h"
#include "tessellation/tessellation.h"
#include "tessellation_checks.h"

namespace prep {
namespace {

using namespace tessellation_checks;

bool all_of_them() {
    return std::getenv("MESHPREP_LONG_TESTS") != nullptr;
}

// A parallelogram somewhere in space and its plane's coordinates.
struct Sheet {
    glm::dvec3 origin, u, v, normal;
    glm::dvec2 uv_origin, uv_u, uv_v;  // its UVs

    static Sheet random(std::mt19937& random, double uv_size) {
        std::uniform_real_distribution<double> number(-1, 1);
        const auto vector = [&] {
            return glm::dvec3(number(random), number(random), number(random));
        };
        Sheet s;
        s.origin = vector();
        s.u = glm::normalize(vector());
        s.normal = glm::normalize(glm::cross(s.u, vector()));
        s.v = glm::cross(s.normal, s.u) + 0.3 * number(random) * s.u;
        const double turn = 7 * number(random);
        const double mirror = number(random) < 0 ? -1 : 1;
        s.uv_origin = glm::dvec2(number(random), number(random));
        s.uv_u = uv_size * glm::dvec2(std::cos(turn), std::sin(turn));
        s.uv_v = mirror * uv_size * glm::dvec2(-std::sin(turn), std::cos(turn));
        return s;
    }
    Mesh mesh() const {
        Mesh made;
        made.uvs.resize(1);
        for (const glm::dvec2 at : {glm::dvec2(0, 0), {1, 0}, {1, 1}, {0, 1}}) {
            made.positions.emplace_back(origin + at.x * u + at.y * v);
            made.uvs[0].values.emplace_back(uv_origin + at.x * uv_u + at.y * uv_v);
            made.uvs[0].indices.push_back(std::uint32_t(made.uvs[0].indices.size()));
        }
        add_face(made, {0, 1, 2, 3});
        return made;
    }
    // As floats have it, of the mesh above.
    struct Lifted {
        glm::dvec2 uv;
        double height;
    };
};

// The corners of a triangle: UV and height over the sheet's plane.
std::array<Sheet::Lifted, 3> lifted(const Mesh& mesh, std::size_t f, const Sheet& sheet) {
    std::array<Sheet::Lifted, 3> corners;
    for (std::size_t k = 0; k < 3; ++k)
        corners[k] = {
            glm::dvec2(mesh.uvs[0].values[mesh.uvs[0].indices[3 * f + k]]),
            glm::dot(glm::dvec3(mesh.positions[mesh.corner_vertices[3 * f + k]]) - sheet.origin,
                     sheet.normal)};
    return corners;
}

// Maps of 4096² texels, all 0 but one; a fourth of its height is asked for.
TEST(TessellationCampaign, SpikesOfOneTexelAreMet) {
    constexpr std::uint32_t size = 4096;
    const int maps = all_of_them() ? 20 : 1, charts = all_of_them() ? 50 : 25;
    std::uint64_t met = 0, bounded = 0, most_triangles = 0;
    double tightest = 1e9, loosest = 0;
    for (int m = 0; m < maps; ++m) {
        std::mt19937 random(std::uint32_t(1000 + m));
        const auto x = std::uint32_t(random() % size), y = std::uint32_t(random() % size);
        const float amplitude = (m % 2 == 0 ? 1.0F : -0.5F);
        Image image{.width = size, .height = size, .channels = 1, .pixels = {}};
        image.pixels.assign(std::size_t(size) * size, 0.0F);
        image.pixels[std::size_t(y) * size + x] = amplitude;
        HeightMapOptions heights;
        heights.scale = 0.2;
        heights.midlevel = 0;
        const auto map = height_function(image, heights);
        ASSERT_TRUE(map) << to_string(map.error());
        image = {};
        const double tall = 0.2 * std::abs(double(amplitude));
        for (int c = 0; c < charts; ++c) {
            Sheet sheet = Sheet::random(random, 1);
            std::uniform_real_distribution<double> number(0.02, 0.98);
            const glm::dvec2 top((x + 0.5) / size, (y + 0.5) / size);
            sheet.uv_origin = top - number(random) * sheet.uv_u - number(random) * sheet.uv_v;
            const Mesh mesh = sheet.mesh();
            TessellateOptions options;
            options.chord_error = tall / 4;
            options.displacements = {{*map, 1, 0, 0}};
            const auto made = tessellate(mesh, options);
            ASSERT_TRUE(made) << to_string(made.error());
            most_triangles = std::max(most_triangles, made->certificate.triangles);
            // Every copy of the spike within the sheet, at 31² points of its tent.
            double worst = 0;
            std::uint64_t tents = 0, vertices = 0;
            const auto tent = [&](const glm::dvec2& uv) {
                const double dx = uv.x * size - 0.5 - x, dy = uv.y * size - 0.5 - y;
                const double rx = dx - size * std::round(dx / size);
                const double ry = dy - size * std::round(dy / size);
                return 0.2 * double(amplitude) * std::max(0.0, 1 - std::abs(rx)) *
                       std::max(0.0, 1 - std::abs(ry));
            };
            for (std::size_t f = 0; f < made->mesh.face_count(); ++f) {
                const auto t = lifted(made->mesh, f, sheet);
                const glm::dvec2 p = t[1].uv - t[0].uv, q = t[2].uv - t[0].uv;
                const double area = p.x * q.y - p.y * q.x;
                const glm::dvec2 low = glm::min(t[0].uv, glm::min(t[1].uv, t[2].uv)) - 1.0 / size;
                const glm::dvec2 high = glm::max(t[0].uv, glm::max(t[1].uv, t[2].uv)) + 1.0 / size;
                for (double i = std::ceil(low.x - top.x); i <= high.x - top.x; ++i)
                    for (double j = std::ceil(low.y - top.y); j <= high.y - top.y; ++j)
                        for (int k = -15; k <= 15; ++k)
                            for (int l = -15; l <= 15; ++l) {
                                const glm::dvec2 at =
                                    top + glm::dvec2(i, j) + glm::dvec2(k, l) / (15.0 * size);
                                const glm::dvec2 d = at - t[0].uv;
                                const double b = (d.x * q.y - d.y * q.x) / area;
                                const double a = (p.x * d.y - p.y * d.x) / area;
                                if (!(a >= 0 && b >= 0 && a + b <= 1)) continue;
                                tents += k == 0 && l == 0;
                                const double flat =
                                    (1 - a - b) * t[0].height + b * t[1].height + a * t[2].height;
                                worst = std::max(worst, std::abs(tent(at) - flat));
                            }
                for (const Sheet::Lifted& corner : t)
                    vertices += std::abs(tent(corner.uv)) > tall / 4;
            }
            // UVs and positions of the file are floats.
            constexpr double rounding = 1e-3;
            loosest = std::max(loosest, made->certificate.proved / worst);
            tightest = std::min(tightest, made->certificate.proved / worst);
            met += tents > 0 && vertices > 0;
            bounded += made->certificate.proved >= worst - rounding * tall &&
                       made->certificate.proved <= tall / 4;
            EXPECT_LE(worst, tall / 4 + rounding * tall) << m << ' ' << c;
        }
    }
    EXPECT_EQ(bounded, std::uint64_t(maps) * std::uint64_t(charts));
    EXPECT_EQ(met, std::uint64_t(maps) * std::uint64_t(charts));
    EXPECT_LE(most_triangles, 5000U);
    std::printf(
        "%llu spikes met, %llu certificates, at most %llu triangles, proved / true %.2f to "
        "%.2f\n",
        (unsigned long long)met, (unsigned long long)bounded, (unsigned long long)most_triangles,
        tightest, loosest);
}

// The largest error of a triangle, by golden sections from many starts.
template <class Error>
double maximised(const Error& error, std::mt19937& random, int starts) {
    constexpr double golden = 0.6180339887498949;
    double most = 0;
    std::uniform_real_distribution<double> number(0, 1);
    for (int s = 0; s < starts; ++s) {
        double b = number(random), c = number(random);
        if (b + c > 1) b = 1 - b, c = 1 - c;
        for (int round = 0; round < 3; ++round) {
            // Along b, along c, along the third side.
            const double db = round == 1 ? 0 : 1, dc = round == 0 ? 0 : round == 1 ? 1 : -1;
            double low = -1, high = 1;
            const auto keep = [&](double at, double step) {  // at + t step ≥ 0
                if (step > 0) low = std::max(low, -at / step);
                if (step < 0) high = std::min(high, -at / step);
            };
            keep(b, db);
            keep(c, dc);
            keep(1 - b - c, -db - dc);
            const auto value = [&](double t) { return error(b + t * db, c + t * dc); };
            double x = high - golden * (high - low), y = low + golden * (high - low);
            double fx = value(x), fy = value(y);
            for (int k = 0; k < 20; ++k) {
                if (fx > fy) {
                    high = y, y = x, fy = fx;
                    fx = value(x = high - golden * (high - low));
                } else {
                    low = x, x = y, fx = fy;
                    fy = value(y = low + golden * (high - low));
                }
                most = std::max({most, fx, fy});
            }
            const double t = 0.5 * (low + high);
            b += t * db;
            c += t * dc;
        }
    }
    return most;
}

// Nothing along the edges, where a rate by edges would look; all of it inside.
TEST(TessellationCampaign, BulgesBetweenStraightEdgesAreBounded) {
    const int cages = all_of_them() ? 200 : 12;
    std::vector<double> looseness;
    std::uint64_t triangles = 0;
    for (int seed = 0; seed < cages; ++seed) {
        std::mt19937 random{std::uint32_t(seed)};
        Sheet sheet = Sheet::random(random, 1);
        sheet.uv_origin = glm::dvec2(0.0);
        sheet.uv_u = {1, 0};
        sheet.uv_v = {0, 1};
        const double kx = std::numbers::pi * (1 + double(random() % 4));
        const double ky = std::numbers::pi * (1 + double(random() % 4));
        const double scale = std::exp2(-1.0 - double(random() % 6));
        const Waves waves(scale, kx, ky);
        TessellateOptions options;
        options.chord_error = scale * (seed % 3 == 0 ? 0.3 : seed % 3 == 1 ? 0.05 : 0.02);
        options.displacements = {{std::make_shared<Waves>(waves), 1, 0, 0}};
        const auto made = tessellate(sheet.mesh(), options);
        ASSERT_TRUE(made) << to_string(made.error());
        double worst = 0;
        triangles += made->mesh.face_count();
        for (std::size_t f = 0; f < made->mesh.face_count(); ++f) {
            const auto t = lifted(made->mesh, f, sheet);
            worst = std::max(
                worst,
                maximised(
                    [&](double b, double c) {
                        const double a = 1 - b - c;
                        const glm::dvec2 uv = a * t[0].uv + b * t[1].uv + c * t[2].uv;
                        return std::abs(waves.at(uv).value -
                                        (a * t[0].height + b * t[1].height + c * t[2].height));
                    },
                    random, 64));
        }
        // The test's plane, UVs and heights come out of floats.
        EXPECT_LE(worst, made->certificate.proved + 1e-6) << seed;
        EXPECT_LE(made->certificate.proved, *options.chord_error) << seed;
        looseness.push_back(made->certificate.proved / worst);
    }
    std::sort(looseness.begin(), looseness.end());
    const double median = looseness[looseness.size() / 2];
    const double most = looseness[looseness.size() * 95 / 100];
    EXPECT_LE(median, 4);
    EXPECT_LE(most, 10);
    std::printf("%d cages, %llu triangles, proved / true: median %.2f, 95 %% %.2f\n", cages,
                (unsigned long long)triangles, median, most);
}

// A budget is used up to 5 %, for an error no more than a tenth above that which takes as many.
TEST(TessellationCampaign, BudgetsAreAsGoodAsErrors) {
    const int cases = all_of_them() ? 20 : 4;
    double worst = 0, least_used = 1;
    for (int seed = 0; seed < cases; ++seed) {
        std::mt19937 random(std::uint32_t(seed + 50));
        Mesh cage = seed % 4 == 0   ? cube()
                    : seed % 4 == 1 ? torus(6 + std::uint32_t(seed), 5)
                    : seed % 4 == 2 ? prism(3 + std::uint32_t(seed) / 3)
                                    : unit_quad();
        if (seed % 4 != 3) add_charts(cage, random);
        TessellateOptions options;
        if (seed % 2 == 0) options.scheme = SubdivisionScheme::catmark;
        options.samples = 0;
        options.displacements = {
            {std::make_shared<Waves>(0.05, 6 + seed % 5, 4 + seed % 7, 0.3), 1, 0, 0}};
        const std::uint64_t budget = 1500 + 700 * std::uint64_t(seed % 6);
        options.max_triangles = budget;
        const auto made = tessellate(cage, options);
        ASSERT_TRUE(made) << to_string(made.error());
        EXPECT_LE(made->certificate.triangles, budget);
        EXPECT_GE(made->certificate.triangles, budget * 95 / 100);
        least_used = std::min(least_used, double(made->certificate.triangles) / double(budget));
        options.max_triangles.reset();
        double low = made->certificate.proved_refinable / 16, high = low * 256;
        for (int k = 0; k < 14; ++k) {
            options.chord_error = std::sqrt(low * high);
            const auto by_error = tessellate(cage, options);
            ASSERT_TRUE(by_error) << to_string(by_error.error());
            (by_error->certificate.triangles > budget ? low : high) = *options.chord_error;
        }
        const double ratio = made->certificate.proved_refinable / high;
        EXPECT_LE(ratio, 1.1) << seed;
        worst = std::max(worst, ratio);
    }
    std::printf("%d budgets, error over that of as many triangles at most %.3f, used %.3f\n", cases,
                worst, least_used);
}

}  // namespace
}  // namespace prep
