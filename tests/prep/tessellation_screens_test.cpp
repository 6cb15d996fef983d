// Errors on screens: bounds of single triangles against long double, the order in which a budget
// takes them, and which of many screens decide.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "prep/displacement/tessellate.h"
#include "tessellation/screen_bound.h"
#include "tessellation_checks.h"

namespace prep {
namespace {

using namespace tessellation_checks;
using detail::ScreenBound;
using detail::Screens;
using Corners = std::array<glm::dvec3, 3>;

double part(std::mt19937& random) {
    return double(random()) / 4294967296.0;
}
glm::dvec3 point(std::mt19937& random) {
    return 2.0 * glm::dvec3(part(random), part(random), part(random)) - 1.0;
}

// A picture of 90° a side, of 2 x 2 units, from `eye` along `along`.
ScreenMetric seen_from(const glm::dvec3& eye, const glm::dvec3& along) {
    const glm::dvec3 w = glm::normalize(along);
    const glm::dvec3 x = glm::normalize(
        glm::cross(w, std::abs(w.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0)));
    const glm::dvec3 y = glm::cross(x, w);
    ScreenMetric metric;
    metric.x = {x, -glm::dot(x, eye)};
    metric.y = {y, -glm::dot(y, eye)};
    metric.w = {w, -glm::dot(w, eye)};
    metric.near_distance = 1e-3;
    return metric;
}

// Far from the origin depths cancel: what that rounds must not make the bound smaller.
TEST(TessellationScreens, BoundsAreNotBelowTheExactOnesFarFromTheOrigin) {
    std::mt19937 random(3);
    std::size_t checked = 0;
    for (int k = 0; k < 500; ++k) {
        const glm::dvec3 eye = 1e8 * point(random);
        const ScreenMetric m = seen_from(eye, point(random));
        const glm::dvec3 p = eye + glm::dvec3(m.w) * (0.1 + part(random));
        using Real = long double;
        const Real depth = Real(m.w.x) * Real(p.x) + Real(m.w.y) * Real(p.y) +
                           Real(m.w.z) * Real(p.z) + Real(m.w.w);
        if (!(depth > 0.05L)) continue;
        ++checked;
        const double bound = ScreenBound(m).pixels_per_unit({p, p, p}, 0);
        // In a corner of the picture the rows (1, 0, ±1), (0, 1, ±1) stretch by √3 at most.
        EXPECT_GE(Real(bound), std::sqrt(Real(3)) / depth * (1 - 1e-15L)) << k;
        EXPECT_LE(Real(bound), std::sqrt(Real(3)) / depth * 1.001L) << k;
    }
    EXPECT_GT(checked, 400U);
}

TEST(TessellationScreens, LengthsAreTheErrorsOfSoManyPixels) {
    std::mt19937 random(4);
    for (int k = 0; k < 1000; ++k) {
        const ScreenBound screen(seen_from({0, 0, 0}, {0, 0, 1}));
        const double depth = std::exp2(10 * part(random) - 5),
                     pixels = std::exp2(12 * part(random) - 6);
        const Corners corners{glm::dvec3(0, 0, depth), {0, 0, depth}, {0, 0, 2 * depth}};
        const double length = screen.length_of(corners, pixels);
        EXPECT_LE(screen.pixels_per_unit(corners, length) * length, pixels);
        const double more = length * (1 + 1e-9);
        EXPECT_GT(screen.pixels_per_unit(corners, more) * more, pixels);
    }
}

// What nothing shows is not seen by errors that have no bound either.
TEST(TessellationScreens, AScreenThatSeesNothingStaysSo) {
    const ScreenBound nothing(ScreenMetric{.w = {0, 0, 0, -1}});
    const Corners corners{glm::dvec3(0, 0, 0), {1, 0, 0}, {0, 1, 0}};
    for (const double error : {0.0, 1.0, std::numeric_limits<double>::infinity()})
        EXPECT_EQ(nothing.pixels_per_unit(corners, error), 0) << error;
}

// Many views of a box: what is left of them decides as all do.
TEST(TessellationScreens, FewDecideWhatAllDo) {
    std::mt19937 random(5);
    for (const double away : {3.0, 1.0}) {
        std::vector<ScreenMetric> metrics;
        std::vector<ScreenBound> all;
        for (int k = 0; k < 300; ++k) {
            const glm::dvec3 to = glm::normalize(point(random)) * (away + 10 * part(random));
            metrics.push_back(seen_from(to, k % 5 == 0 ? to : point(random) - to));
            if (k % 7 == 0) metrics.back() = transformed(metrics.back(), glm::dmat4(2.0));
            all.emplace_back(metrics.back());
        }
        Screens screens(metrics);
        screens.focus(glm::dvec3(-1), glm::dvec3(1));
        EXPECT_LT(screens.count(), all.size() / (away > 2 ? 3 : 1));
        EXPECT_GT(screens.count(), 0U);
        double seen = 0;
        for (int k = 0; k < 2000; ++k) {
            const double size = k % 2 ? 1.0 : 1.5;  // beyond the box as well
            const Corners corners{size * point(random), size * point(random), size * point(random)};
            const double error = std::exp2(-20 * part(random));
            const double most = pixels_per_unit(all, corners, error);
            EXPECT_EQ(pixels_per_unit(screens.around(corners, error), corners, error), most) << k;
            seen = std::max(seen, most);
        }
        EXPECT_GT(seen, 0);
    }
}

// Heights 0, of which no more is known than that they are off by a part of a triangle's extent:
// 1.01 of it where u is below ½, 0.999 beyond.
class Unknown : public HeightFunction {
  public:
    Sample at(const glm::dvec2&) const override { return {}; }
    double deviation(const std::array<glm::dvec2, 3>& uv, const std::array<double, 3>&,
                     double) const override {
        const glm::dvec2 p = uv[1] - uv[0], q = uv[2] - uv[0];
        const double area = std::abs(p.x * q.y - p.y * q.x);
        return (uv[0].x < 0.5 ? 1.01 : 0.999) * std::sqrt(area / (0.5 * 0.4 * 0.4));
    }
};

Mesh two_squares() {
    Mesh mesh;
    mesh.positions = {{-0.9F, -0.4F, 0}, {-0.1F, -0.4F, 0}, {-0.1F, 0.4F, 0}, {-0.9F, 0.4F, 0},
                      {0.1F, -0.4F, 0},  {0.9F, -0.4F, 0},  {0.9F, 0.4F, 0},  {0.1F, 0.4F, 0}};
    add_face(mesh, {0, 1, 2, 3});
    add_face(mesh, {4, 5, 6, 7});
    mesh.uvs.resize(1);
    mesh.uvs[0].values = {{0, 0},    {0.4F, 0}, {0.4F, 0.4F}, {0, 0.4F},
                          {0.6F, 0}, {1, 0},    {1, 0.4F},    {0.6F, 0.4F}};
    mesh.uvs[0].indices = {0, 1, 2, 3, 4, 5, 6, 7};
    return mesh;
}
std::array<std::size_t, 2> per_face(const TessellatedMesh& made) {
    std::array<std::size_t, 2> counts{};
    for (const std::uint32_t f : made.cage_faces) ++counts[f];
    return counts;
}

// From depth 1 an error of 1.01 reaches the eye, one of 0.999 nearly: the larger is worse. They are
// those of a closed face's roots, half as large as its triangles.
TEST(TessellationScreens, BudgetsTakeTheLargerErrorBeyondTheEyeToo) {
    TessellateOptions options;
    options.displacements = {{std::make_shared<Unknown>(), std::numbers::sqrt2, 0, 0}};
    options.pixel_error = 0.01;
    options.max_triangles = 6;
    options.screens = {seen_from({0, 0, -1}, {0, 0, 1})};
    const auto made = tessellate(two_squares(), options);
    ASSERT_TRUE(made) << to_string(made.error());
    EXPECT_EQ(per_face(*made), (std::array<std::size_t, 2>{4, 2}));
}

// Each of two views sees one of the squares.
TEST(TessellationScreens, EveryScreenCounts) {
    TessellateOptions options;
    options.displacements = {{std::make_shared<Unknown>(), 0.001, 0, 0}};
    options.pixel_error = 1e-4;
    options.screens = {seen_from({-0.5, 0, -0.2}, {0, 0, 1}), seen_from({0.5, 0, -0.2}, {0, 0, 1})};
    const auto made = tessellate(two_squares(), options);
    ASSERT_TRUE(made) << to_string(made.error());
    for (const std::size_t count : per_face(*made)) EXPECT_GT(count, 4U);
    EXPECT_LE(*made->certificate.proved_pixels, 1e-4);
}

TEST(TessellationScreens, TooManyAndTooFineAreErrors) {
    TessellateOptions options;
    options.displacements = {{std::make_shared<Unknown>(), 0.001, 0, 0}};
    options.pixel_error = 0.01;
    // Slits, none of which sees all.
    for (int k = 0; k < 5000; ++k) {
        options.screens.push_back(seen_from({0, 0, -1}, {0, 0, 1}));
        options.screens.back().x *= 50;
        options.screens.back().x.w = -50 * (0.1 + 0.8 * k / 5000);
    }
    const auto many = tessellate(two_squares(), options);
    ASSERT_FALSE(many);
    EXPECT_EQ(many.error().code, ErrorCode::limit);
    EXPECT_NE(many.error().text.find("5000 pictures"), std::string::npos) << many.error().text;
    options.screens.resize(1);
    EXPECT_TRUE(tessellate(two_squares(), options));
    options.screens = {seen_from({0, 0, -1}, {0, 0, 1})};
    options.pixel_error = 1e-9;
    const auto fine = tessellate(two_squares(), options);
    ASSERT_FALSE(fine);
    EXPECT_EQ(fine.error().code, ErrorCode::limit);
    EXPECT_NE(fine.error().text.find("pixels is finer"), std::string::npos) << fine.error().text;
}

}  // namespace
}  // namespace prep
