// The oracles of `meshprep cost`: right where the answer is known, and sharp: what is a little
// worse is seen to be worse.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <numbers>
#include <random>
#include <string>

#include "cost/oracles/fan_normals.h"
#include "cost/oracles/glb_corners.h"
#include "cost/oracles/height_wave.h"
#include "cost/oracles/partitions.h"
#include "cost/oracles/pictures.h"
#include "cost/oracles/surfaces.h"

namespace {

using cost::Pixels;
using cost::Real;
using cost::Triangle2;
using cost::Vector;

Real length(const Vector& v) {
    return std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
}

// Objects that name a symbol of the libraries would show in the symbols that they leave open.
TEST(CostOracles, NameNoSymbolOfWhatTheyJudge) {
    for (const char* archive : {COST_ORACLES, COST_MEASURE}) {
        const std::string command = "nm -C " + std::string(archive) + " 2>/dev/null";
        const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
        ASSERT_TRUE(pipe);
        std::string symbols;
        std::array<char, 4096> part{};
        while (const std::size_t n = std::fread(part.data(), 1, part.size(), pipe.get()))
            symbols.append(part.data(), n);
        if (symbols.empty()) {
            // Without nm nothing is known; with it, an archive without symbols is a fault.
            if (std::system("nm --version >/dev/null 2>&1") != 0)
                GTEST_SKIP() << "there is no nm to list the symbols of " << archive;
            FAIL() << "nm lists no symbols of " << archive;
        }
        EXPECT_NE(symbols.find("cost::"), std::string::npos) << archive;
        EXPECT_EQ(symbols.find("prep::"), std::string::npos) << archive;
        EXPECT_EQ(symbols.find("rast::"), std::string::npos) << archive;
    }
}

TEST(CostOracles, PartitionsThatDifferAreCounted) {
    const std::vector<std::uint32_t> points = {0, 0, 1, 1, 2, 3, 3, 4};
    EXPECT_EQ(cost::partition_mistakes(points, points).wrong, 0u);
    // 0 is torn; 1 and 2 melt; 3 is torn and melts with 4.
    const auto m =
        cost::partition_mistakes(points, std::vector<std::uint32_t>{9, 8, 5, 5, 5, 6, 7, 7});
    EXPECT_EQ(m.points, 5u);
    EXPECT_EQ(m.torn, 2u);
    EXPECT_EQ(m.melted, 4u);
    EXPECT_EQ(m.wrong, 5u);
}

// A cube's corner: three faces of area vector 4 a side, as quads.
TEST(CostOracles, FanNormalsOfACubeAreItsDiagonals) {
    std::vector<glm::vec3> positions;
    for (int i = 0; i < 8; ++i)
        positions.push_back({i & 1 ? 1.f : -1.f, i & 2 ? 1.f : -1.f, i & 4 ? 1.f : -1.f});
    const std::vector<std::uint32_t> corners = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4,
                                                2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5};
    const std::vector<std::uint32_t> offsets = {0, 4, 8, 12, 16, 20, 24};
    const cost::FanNormals n = cost::area_fan_normals(positions, offsets, corners, corners, 8);
    for (std::size_t v = 0; v < 8; ++v) {
        const Vector diagonal(positions[v]);
        EXPECT_EQ(cost::degrees_between(n.sums[v], diagonal), 0.0);
        EXPECT_LT(n.bounds[v], 1e-12);
        // A thousandth of a degree off is seen as that.
        const Vector off = diagonal + Vector(0, 0, 1.7320508e-3L * std::numbers::pi_v<Real> / 180);
        EXPECT_NEAR(cost::degrees_between(off, n.sums[v]), 0.001 * std::sqrt(2.0 / 3), 1e-6);
    }
}

// A unit square upwards and a triangle of half its area to the side: areas weigh, of all of a
// polygon.
TEST(CostOracles, FanNormalsWeighWholePolygons) {
    const std::vector<glm::vec3> positions = {
        {0, 0, 0}, {-1, 0, 0}, {-1, -1, 0}, {0, -1, 0}, {0, 0, -1}};
    const std::vector<std::uint32_t> corners = {0, 1, 2, 3, 0, 3, 4}, offsets = {0, 4, 7};
    const std::vector<std::uint32_t> fans = {0, 1, 1, 1, 0, 1, 1};
    const cost::FanNormals n = cost::area_fan_normals(positions, offsets, corners, fans, 2);
    EXPECT_EQ(cost::degrees_between(n.sums[0], {1, 0, 2}), 0.0);
}

TEST(CostOracles, FanNormalsSayWhereTheyCannotTell) {
    // Two faces back to back: the sum is zero.
    const std::vector<glm::vec3> positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    const std::vector<std::uint32_t> corners = {0, 1, 2, 0, 2, 1}, offsets = {0, 3, 6};
    const cost::FanNormals n = cost::area_fan_normals(positions, offsets, corners, corners, 3);
    for (const double bound : n.bounds) EXPECT_EQ(bound, 180);
}

// Normals and tangents of the closed forms against differences of their positions.
TEST(CostOracles, SurfacesAgreeWithTheirOwnDifferences) {
    const Real h = 1e-5L;
    for (const Real u : {0.03L, 0.31L, 0.77L}) {
        for (const Real v : {0.11L, 0.48L, 0.83L}) {
            const auto torus = [](Real a, Real b) { return cost::torus_at(a, b); };
            const auto check = [&](const auto& at) {
                const cost::SurfaceSample s = at(u, v);
                const Vector du = (at(u + h, v).position - at(u - h, v).position) / (2 * h);
                const Vector dv = (at(u, v + h).position - at(u, v - h).position) / (2 * h);
                EXPECT_LT(cost::degrees_between(s.du, du), 1e-7);
                EXPECT_NEAR(double(length(s.du) / length(du)), 1, 1e-8);
                EXPECT_NEAR(cost::degrees_between(s.normal, du), 90, 1e-6);
                EXPECT_NEAR(cost::degrees_between(s.normal, dv), 90, 1e-6);
                EXPECT_NEAR(double(length(s.normal)), 1, 1e-15);
            };
            check(torus);
        }
    }
}

TEST(CostOracles, TurnedPartsNormalsStandOnItsProfile) {
    const auto profile = cost::turned_profile();
    ASSERT_EQ(profile.size(), 3u);
    const cost::TurnedFace faces[] = {cost::TurnedFace::side, cost::TurnedFace::chamfer};
    for (std::size_t i = 0; i < 2; ++i) {
        const Vector along(profile[i + 1].radius - profile[i].radius, 0,
                           profile[i + 1].z - profile[i].z);
        EXPECT_NEAR(cost::degrees_between(cost::turned_normal(faces[i], 0), along), 90, 1e-12);
    }
    EXPECT_NEAR(
        cost::degrees_between(cost::turned_normal(cost::TurnedFace::side, 0.25L), {0, 1, 0}), 0,
        1e-12);
}

std::vector<Vector> random_control(int around, int across) {
    std::vector<Vector> points;
    std::mt19937_64 random(1);
    for (int i = 0; i < around; ++i)
        for (int j = 0; j < across; ++j) {
            const Real wide = 0.45L + 0.1L * Real(random() % 1000) / 1000;
            points.push_back(cost::torus_at(Real(i) / around, Real(j) / across, 1, wide).position);
        }
    return points;
}

// One step of Catmull and Clark's rules for quads of which four meet everywhere, from their paper.
std::vector<Vector> refined(const std::vector<Vector>& p, int n, int m) {
    const auto at = [&](int i, int j) { return p[std::size_t((i + n) % n * m + (j + m) % m)]; };
    std::vector<Vector> out(std::size_t(4 * n * m));
    const auto put = [&](int i, int j, const Vector& v) {
        out[std::size_t((i % (2 * n)) * 2 * m + j % (2 * m))] = v;
    };
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < m; ++j) {
            const auto face = [&](int a, int b) {
                return (at(a, b) + at(a + 1, b) + at(a + 1, b + 1) + at(a, b + 1)) / Real(4);
            };
            put(2 * i + 1, 2 * j + 1, face(i, j));
            put(2 * i + 1, 2 * j,
                (at(i, j) + at(i + 1, j) + face(i, j) + face(i, j - 1)) / Real(4));
            put(2 * i, 2 * j + 1,
                (at(i, j) + at(i, j + 1) + face(i, j) + face(i - 1, j)) / Real(4));
            const Vector faces =
                (face(i, j) + face(i - 1, j) + face(i, j - 1) + face(i - 1, j - 1)) / Real(4);
            const Vector edges =
                (at(i, j) * Real(4) + at(i + 1, j) + at(i - 1, j) + at(i, j + 1) + at(i, j - 1)) /
                Real(8);
            put(2 * i, 2 * j, (faces + edges * Real(2) + at(i, j)) / Real(4));
        }
    return out;
}

TEST(CostOracles, TheSplineIsWhatCatmullAndClarksRulesTendTo) {
    const int n = 8, m = 6;
    const std::vector<Vector> cage = random_control(n, m);
    const cost::SplineTorus spline(cage, n, m);
    std::vector<Vector> points = cage;
    int a = n, b = m;
    double last = 1;
    for (int level = 0; level < 6; ++level) {
        points = refined(points, a, b);
        a *= 2;
        b *= 2;
        double worst = 0;
        for (int i = 0; i < a; i += a / 8 - 1)
            for (int j = 0; j < b; ++j)
                worst = std::max(
                    worst, double(length(points[std::size_t(i * b + j)] -
                                         spline.at(Real(i) * n / a, Real(j) * m / b).position)));
        EXPECT_LT(worst, last / 3);  // a quarter each level
        last = worst;
    }
    EXPECT_LT(last, 2e-4);
}

TEST(CostOracles, NearestPointsAreAsFarAsPointsWereMoved) {
    const cost::SplineTorus spline(random_control(8, 6), 8, 6);
    for (const Real h : {1e-9L, 1e-6L, 1e-3L, 1e-2L}) {
        for (int k = 0; k < 25; ++k) {
            const auto p = spline.at(0.37L * k, 0.73L * k);
            const Vector n = glm::cross(p.du, p.dv);
            const auto found = spline.nearest(p.position + n * (h / length(n)));
            EXPECT_NEAR(double(found.distance / h), 1, 1e-6) << double(h) << ", point " << k;
            EXPECT_LT(cost::degrees_between(found.normal, n), 1e-4);
        }
    }
}

TEST(CostOracles, AreasOfTrianglesInPixels) {
    // The lower left half of the square 1 … 3: pixels full, half and empty.
    const Triangle2 half = {{{1, 1}, {1, 3}, {3, 3}}};
    const Pixels p = cost::exact_coverage(std::vector{half}, 4, 4);
    const auto at = [&](std::size_t x, std::size_t y) { return p.values[y * 4 + x]; };
    EXPECT_DOUBLE_EQ(at(1, 1), 0.5);
    EXPECT_DOUBLE_EQ(at(1, 2), 1);
    EXPECT_DOUBLE_EQ(at(2, 2), 0.5);
    EXPECT_DOUBLE_EQ(at(2, 1), 0);
    EXPECT_DOUBLE_EQ(at(0, 0), 0);

    std::mt19937_64 random(2);
    for (int k = 0; k < 200; ++k) {
        const auto coordinate = [&] { return Real(random() % 100000) / 100000 * 20; };
        Triangle2 t;
        for (auto& c : t) c = {coordinate(), coordinate()};
        const Pixels exact = cost::exact_coverage(std::vector{t}, 20, 20);
        Real sum = 0, area = 0;
        for (const double v : exact.values) sum += v;
        area = std::abs((t[1].x - t[0].x) * (t[2].y - t[0].y) -
                        (t[1].y - t[0].y) * (t[2].x - t[0].x)) /
               2;
        EXPECT_NEAR(double(sum), double(area), 1e-12);
        // Samples tend to the areas; twice the footprint is seen.
        const Pixels sampled = cost::sampled_coverage(std::vector{t}, 20, 20);
        const double error = cost::picture_error(sampled, exact).rmse;
        EXPECT_LT(error, 0.004);
        if (area < 10) continue;
        Triangle2 wide = t;
        for (auto& c : wide) c = t[0] + (c - t[0]) * Real(1.1);
        EXPECT_GT(
            cost::picture_error(cost::sampled_coverage(std::vector{wide}, 20, 20), exact).rmse,
            5 * error);
    }
}

// One triangle's bits are the definition's: samples within its three edges.
TEST(CostOracles, SamplesOfATriangleAreThoseWithinIt) {
    std::mt19937_64 random(4);
    for (int k = 0; k < 40; ++k) {
        const auto coordinate = [&] { return Real(random() % 100000) / 100000 * 14 - 2; };
        Triangle2 t;
        for (auto& c : t) c = {coordinate(), coordinate()};
        const auto side = [](const cost::Point2& a, const cost::Point2& b, const cost::Point2& p) {
            return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
        };
        std::vector<double> counted;
        for (int y = 0; y < 9; ++y)
            for (int x = 0; x < 11; ++x) {
                int within = 0;
                for (int j = 0; j < 13; ++j)
                    for (int i = 0; i < 13; ++i) {
                        const cost::Point2 p(x + (Real(i) + 0.5L) / 13, y + (Real(j) + 0.5L) / 13);
                        const Real a = side(t[0], t[1], p), b = side(t[1], t[2], p),
                                   c = side(t[2], t[0], p);
                        within += (a > 0 && b > 0 && c > 0) || (a < 0 && b < 0 && c < 0);
                    }
                counted.push_back(within / 169.0);
            }
        EXPECT_EQ(cost::sampled_coverage(std::vector{t}, 11, 9, 13).values, counted) << k;
    }
}

// The bound against sums of 113 bits, where faces all but cancel, in fans of 3 to 3,000 faces.
TEST(CostOracles, FanNormalsAreAsNearAsTheirBoundSays) {
    __extension__ using Wide = __float128;
    std::mt19937_64 random(6);
    for (const std::uint32_t faces : {3u, 16u, 17u, 200u, 3000u}) {
        std::vector<glm::vec3> positions = {{0.3f, -0.2f, 0.1f}};
        std::vector<std::uint32_t> corners, fans, offsets = {0};
        const auto coordinate = [&] { return float(double(random() >> 11) * 0x1p-52 - 1); };
        for (std::uint32_t f = 0; f < faces; ++f) {
            const std::uint32_t first = std::uint32_t(positions.size());
            for (int k = 0; k < 2; ++k)
                positions.push_back({coordinate(), coordinate(), coordinate()});
            // Every other face turns back on the one before it, all but a little.
            if (f % 2 == 1) {
                positions[first] = positions[first - 1];
                positions[first + 1] = positions[first - 2] * 1.0000001f;
            }
            corners.insert(corners.end(), {0, first, first + 1});
            fans.insert(fans.end(), {0, 0xffffffffu, 0xffffffffu});
            offsets.push_back(std::uint32_t(corners.size()));
        }
        const cost::FanNormals n = cost::area_fan_normals(positions, offsets, corners, fans, 1);
        Wide exact[3] = {0, 0, 0};
        for (std::uint32_t f = 0; f < faces; ++f) {
            Wide a[3], b[3];
            for (int k = 0; k < 3; ++k) {
                a[k] = Wide(positions[corners[3 * f + 1]][k]) - Wide(positions[0][k]);
                b[k] = Wide(positions[corners[3 * f + 2]][k]) - Wide(positions[0][k]);
            }
            for (int k = 0; k < 3; ++k)
                exact[k] += a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
        }
        // By the cross product in 113 bits: the angle is far below long double's rounding of 1.
        const Wide s[3] = {Wide(n.sums[0].x), Wide(n.sums[0].y), Wide(n.sums[0].z)};
        Real across = 0, along = 0;
        for (int k = 0; k < 3; ++k) {
            const Wide c =
                s[(k + 1) % 3] * exact[(k + 2) % 3] - s[(k + 2) % 3] * exact[(k + 1) % 3];
            across += Real(c) * Real(c);
            along += Real(s[k]) * Real(exact[k]);
        }
        const double error =
            double(std::atan2(std::sqrt(across), along) * 180 / std::numbers::pi_v<Real>);
        EXPECT_LE(error, n.bounds[0]) << faces;
        EXPECT_LT(n.bounds[0], 180) << faces;
    }
}

// Angles by atan2 against those of exact construction: (1, 0, 0) and (cos t, sin t, 0) of tangents
// that are powers of two, whose arctangent is its series in 113 bits.
TEST(CostOracles, AnglesAreThoseOf113Bits) {
    __extension__ using Wide = __float128;
    const Wide pi = Wide(std::numbers::pi_v<Real>) - 5.0165576126683320235e-20L;
    for (int e = 2; e <= 60; ++e) {
        Wide t = 1;
        for (int i = 0; i < e; ++i) t /= 2;
        Wide sum = 0, power = t;
        for (int k = 0; k < 60; ++k, power *= t * t)
            sum += (k % 2 == 0 ? power : -power) / (2 * k + 1);
        const double truth = double(sum * 180 / pi);
        EXPECT_NEAR(cost::degrees_between({3, 0, 0}, {1, Real(t), 0}) / truth, 1, 3e-16) << e;
        EXPECT_NEAR(
            cost::degrees_between({0, -1, 0}, {Real(t), 1, 0}) / double(180 - sum * 180 / pi), 1,
            3e-16)
            << e;
    }
}

TEST(CostOracles, TrianglesThatOverlapCountOnceInSamples) {
    const Triangle2 t = {{{0, 0}, {4, 0}, {0, 4}}};
    EXPECT_EQ(cost::sampled_coverage(std::vector{t, t}, 4, 4).values,
              cost::sampled_coverage(std::vector{t}, 4, 4).values);
}

TEST(CostOracles, BoxMeansAreMeansOfBoxes) {
    // 4 × 2 pixels of two channels, the second ten times the first.
    cost::Pixels fine{4, 2, 2, {}};
    for (const double v : {1, 2, 3, 4, 5, 6, 7, 16}) {
        fine.values.push_back(v);
        fine.values.push_back(10 * v);
    }
    const cost::Pixels means = cost::box_means(fine, 2);
    EXPECT_EQ(means.width, 2u);
    EXPECT_EQ(means.height, 1u);
    EXPECT_EQ(means.values, (std::vector<double>{3.5, 35, 7.5, 75}));
    EXPECT_EQ(cost::box_means(fine, 1).values, fine.values);
}

TEST(CostOracles, ASphereIsLitAsItsFormulaSays) {
    cost::LitSphere s;
    s.ambient = 0.25;
    s.towards = {0, 0, 1};
    // The middle: light, normal and eye in one line.
    const Pixels p = cost::lit_sphere(s, 101, 101, 1);
    EXPECT_NEAR(p.values[50 * 101 + 50], 0.25 * 0.5 + 0.5 + 0.4, 1e-12);
    EXPECT_EQ(p.values[0], 0);
    // Its area: π of the 2.3 × 2.3 that the picture shows.
    s.diffuse = s.ambient = 1;
    s.light = 0;
    double sum = 0;
    for (const double v : cost::lit_sphere(s, 50, 50, 16).values) sum += v;
    EXPECT_NEAR(sum / 2500, std::numbers::pi / (2.3 * 2.3), 1e-4);
    // A power 2 % larger is seen above the noise of 64 samples for 256.
    cost::LitSphere shiny;
    shiny.towards = Vector(2, 3, 6) / Real(7);
    cost::LitSphere more = shiny;
    more.shininess *= 1.02;
    std::vector<bool> inside;
    cost::LitSphere white = shiny;
    white.ambient = white.diffuse = 1;
    white.light = 0;
    for (const double v : cost::lit_sphere(white, 96, 72, 8).values) inside.push_back(v > 0.999);
    const Pixels truth = cost::lit_sphere(shiny, 96, 72, 16);
    const double noise =
        cost::picture_error(cost::lit_sphere(shiny, 96, 72, 8), truth, inside).rmse;
    EXPECT_GT(cost::picture_error(cost::lit_sphere(more, 96, 72, 8), truth, inside).rmse,
              5 * noise);
}

TEST(CostOracles, ATexturedPlaneShowsItsTexture) {
    cost::TexturedPlane s;
    s.size = 2;
    s.texels = {0.3, 0.3, 0.3, 0.3};
    for (const double v : cost::textured_plane(s, 12, 8, 4).values) EXPECT_NEAR(v, 0.3, 1e-15);
    // Far away a checker is its mean.
    s.texels = {0, 1, 1, 0};
    s.size = 2;
    s.height = 5000;
    for (const double v : cost::textured_plane(s, 4, 3, 32).values) EXPECT_NEAR(v, 0.5, 0.05);
    // Straight down from 1 m with 90°: the picture's height is 2 units; its middle is at the
    // origin, between the texels 1, 0 (x) and 1, 0 (z).
    s.height = 1;
    s.pitch = 90;
    s.yfov = std::numbers::pi / 2;
    s.size = 4;
    s.texels.assign(16, 0);
    s.texels[0] = 1;  // u, v from 0 to 1/4
    const Pixels p = cost::textured_plane(s, 16, 16, 1);
    // The pixel right of and below the middle is at (1/16, −pitched z): texel centre is at 1/8.
    EXPECT_NEAR(p.values[8 * 16 + 8], (1 - 0.25) * (1 - 0.25), 1e-9);
    EXPECT_NEAR(p.values[8 * 16 + 10], 0.75 * (1 - 0.75), 1e-9);
}

std::vector<std::byte> glb(const std::string& document, const std::vector<std::byte>& data) {
    std::vector<std::byte> file;
    const auto word = [&](std::size_t v) {
        for (int k = 0; k < 4; ++k) file.push_back(std::byte(v >> (8 * k)));
    };
    std::string text = document;
    while (text.size() % 4 != 0) text += ' ';
    word(0x46546C67), word(2), word(28 + text.size() + data.size());
    word(text.size()), word(0x4E4F534A);
    for (const char c : text) file.push_back(std::byte(c));
    word(data.size()), word(0x004E4942);
    file.insert(file.end(), data.begin(), data.end());
    return file;
}

// A triangle whose numbers are of every kind that is quantised, under a node that turns by 90°
// about z and stretches, and one above it that moves.
TEST(CostOracles, GlbCornersAreWhatTheSpecificationSays) {
    const std::string document = R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[1]}],
      "nodes":[{"mesh":0,"rotation":[0,0,0.70710678118654752,0.70710678118654752],"scale":[2,4,8]},
               {"children":[0],"translation":[100,0,0]}],
      "meshes":[{"primitives":[{"indices":0,"attributes":{"POSITION":1,"NORMAL":2,"TANGENT":3,
        "TEXCOORD_0":4}}]}],
      "accessors":[{"bufferView":0,"componentType":5121,"count":3,"type":"SCALAR"},
       {"bufferView":1,"componentType":5123,"count":3,"type":"VEC3"},
       {"bufferView":2,"componentType":5120,"normalized":true,"count":3,"type":"VEC3"},
       {"bufferView":3,"componentType":5122,"normalized":true,"count":3,"type":"VEC4"},
       {"bufferView":4,"byteOffset":1,"componentType":5121,"normalized":true,"count":3,
        "type":"VEC2"}],
      "bufferViews":[{"buffer":0,"byteLength":4},
       {"buffer":0,"byteOffset":4,"byteLength":24,"byteStride":8},
       {"buffer":0,"byteOffset":28,"byteLength":12,"byteStride":4},
       {"buffer":0,"byteOffset":40,"byteLength":24},{"buffer":0,"byteOffset":64,"byteLength":12,
        "byteStride":4}],"buffers":[{"byteLength":76}]})";
    std::vector<std::byte> data;
    const auto bytes = [&](std::initializer_list<int> values) {
        for (const int v : values) data.push_back(std::byte(std::uint8_t(v)));
    };
    const auto words = [&](std::initializer_list<int> values) {
        for (const int v : values) {
            data.push_back(std::byte(std::uint8_t(v & 255)));
            data.push_back(std::byte(std::uint8_t((v >> 8) & 255)));
        }
    };
    bytes({2, 0, 1, 99});
    words({1, 0, 0, 7, 0, 300, 0, 7, 0, 0, 65535, 7});
    bytes({127, 0, 0, 55, 0, -127, 0, 55, 64, 0, -128, 55});
    words({32767, 0, 0, 32767, 0, -32767, 0, -32767, 0, 0, -32768, 32767});
    bytes({9, 0, 255, 9, 9, 51, 204, 9, 9, 255, 0, 9});
    const auto file = glb(document, data);
    const auto corners = cost::corners_of_glb(file);
    ASSERT_TRUE(corners);
    ASSERT_EQ(corners->positions.size(), 3u);
    const auto near = [](const Vector& a, const Vector& b) {
        return double(length(a - b) / std::max(length(b), Real(1))) < 1e-14;
    };
    // In the order of the indices: 2, 0, 1. x goes to y, y to −x.
    EXPECT_TRUE(near(corners->positions[0], {100, 0, 8 * 65535.0L}));
    EXPECT_TRUE(near(corners->positions[1], {100, 2, 0}));
    EXPECT_TRUE(near(corners->positions[2], {100 - 1200, 0, 0}));
    // Planes: z's normal by 2 · 4, x's by 4 · 8; −128 is −1.
    EXPECT_TRUE(near(corners->normals[0], {0, 32 * Real(64) / 127, -8}));
    EXPECT_TRUE(near(corners->normals[1], {0, 32, 0}));
    EXPECT_TRUE(near(corners->normals[2], {16, 0, 0}));
    EXPECT_TRUE(near(corners->tangents[0], {0, 0, -8}));
    EXPECT_TRUE(near(corners->tangents[1], {0, 2, 0}));
    EXPECT_TRUE(near(corners->tangents[2], {4, 0, 0}));
    EXPECT_EQ(corners->handedness, (std::vector<Real>{1, 1, -1}));
    EXPECT_EQ(corners->uvs[0], (glm::vec<2, Real>(1, 0)));
    EXPECT_EQ(corners->uvs[1], (glm::vec<2, Real>(0, 1)));
    EXPECT_NEAR(double(corners->uvs[2].x), 0.2, 1e-16);
    EXPECT_NEAR(double(corners->uvs[2].y), 0.8, 1e-16);
    // Mirrored along x: planes stay on their side.
    std::string mirrored = document;
    mirrored.replace(mirrored.find("\"scale\":[2,"), 11, "\"scale\":[-2,");
    const auto other = cost::corners_of_glb(glb(mirrored, data));
    ASSERT_TRUE(other);
    EXPECT_TRUE(near(other->normals[1], {0, -32, 0}));
    EXPECT_TRUE(near(other->normals[2], {16, 0, 0}));
    // A file that ends early is none.
    for (std::size_t size = 0; size < file.size(); ++size)
        EXPECT_FALSE(cost::corners_of_glb(std::span(file).first(size))) << size;
    // Nor is one whose indices or children lead nowhere.
    data[1] = std::byte(3);
    EXPECT_FALSE(cost::corners_of_glb(glb(document, data)));
    data[1] = std::byte(0);
    std::string circle = document;
    circle.replace(circle.find("\"children\":[0]"), 14, "\"children\":[1]");
    EXPECT_FALSE(cost::corners_of_glb(glb(circle, data)));
}

TEST(CostOracles, WavesOfTexelsTendToTheWave) {
    double last = 1;
    for (const int size : {32, 64, 128}) {
        const cost::WaveTexels wave(size);
        double worst = 0;
        for (int j = 0; j < 2 * size; ++j)
            for (int i = 0; i < 2 * size; ++i) {
                const Real u = Real(i) / (2 * size), v = Real(j) / (2 * size);
                worst =
                    std::max(worst, double(std::abs(wave.bilinear(u, v) - cost::wave_at(u, v))));
                // Texels are at their centres, and copies repeat.
                if (i % 2 == 0 || j % 2 == 0) continue;
                EXPECT_NEAR(double(wave.bilinear(u + 3, v - 2) - cost::wave_at(u, v)), 0, 1e-7);
            }
        EXPECT_LT(worst, last / 3.5);
        EXPECT_LT(worst, 16 * std::numbers::pi * std::numbers::pi / 4 / size / size);
        last = worst;
    }
}

TEST(CostOracles, NormalsOfTheWaveAreThoseOfItsDifferences) {
    const Real height = Real(0.05), step = Real(1e-5);
    double steepest = 0;
    for (int j = 0; j < 20; ++j)
        for (int i = 0; i < 20; ++i) {
            const Real u = i / Real(20), v = j / Real(20);
            const auto slope = [&](Real du, Real dv) {
                return height * (cost::wave_at(u + du, v + dv) - cost::wave_at(u - du, v - dv)) /
                       (2 * step);
            };
            const Vector by_differences(-slope(step, 0), -slope(0, step), 1);
            const Vector n = cost::wave_normal(u, v, height);
            EXPECT_LT(cost::degrees_between(n, by_differences), 1e-6);
            EXPECT_NEAR(double(length(n)), 1, 1e-15);
            steepest = std::max(steepest, cost::degrees_between(n, Vector(0, 0, 1)));
        }
    EXPECT_GT(steepest, 15);
}

}  // namespace
