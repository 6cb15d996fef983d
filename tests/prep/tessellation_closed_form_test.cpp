// Surfaces of closed form, displaced: bounds against a search for the largest error, the order of
// convergence of positions and normals.
#include <gtest/gtest.h>

#include "tessellation/tessellation.h"
#include "tessellation_checks.h"

namespace prep {
namespace {

using namespace tessellation_checks;
using detail::BaseDeviation;
using detail::BaseFrame;
using detail::BasePoint;
using detail::RootPoint;

// A torus over the domain of torus(around, across), whose faces are squares of its two angles.
class ExactTorus final : public detail::BaseSurface {
  public:
    ExactTorus(const detail::Domain& domain, std::uint32_t around, std::uint32_t across)
        : domain_(domain), around_(around), across_(across) {}
    static constexpr double major = 2, minor = 0.8;
    glm::dvec2 step() const {
        return {2 * std::numbers::pi / around_, 2 * std::numbers::pi / across_};
    }
    glm::dvec2 angles(const RootPoint& at) const {
        static constexpr glm::dvec2 corners[4] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
        const detail::DomainRoot& root = domain_.roots[at.root];
        const glm::dvec2 a = corners[root.corners[0] % 4], b = corners[root.corners[1] % 4];
        const glm::dvec2 p = at.weights.x * a + at.weights.y * b + at.weights.z * glm::dvec2(0.5);
        return step() * (glm::dvec2(root.face / across_, root.face % across_) + p);
    }
    static glm::dvec3 position(const glm::dvec2& t) {
        const double r = major + minor * std::cos(t.y);
        return {r * std::cos(t.x), r * std::sin(t.x), minor * std::sin(t.y)};
    }
    static glm::dvec3 normal(const glm::dvec2& t) {
        return {std::cos(t.y) * std::cos(t.x), std::cos(t.y) * std::sin(t.x), std::sin(t.y)};
    }
    void evaluate(std::span<const RootPoint> at, std::span<BasePoint> points) const override {
        for (std::size_t k = 0; k < at.size(); ++k)
            points[k] = {position(angles(at[k])), normal(angles(at[k]))};
    }
    void frames(std::span<const RootPoint> at, std::span<BaseFrame> frames) const override {
        for (std::size_t k = 0; k < at.size(); ++k) {
            const glm::dvec2 t = angles(at[k]);
            const double r = major + minor * std::cos(t.y);
            const glm::dvec3 east(-std::sin(t.x), std::cos(t.x), 0);
            const glm::dvec3 north(-std::sin(t.y) * std::cos(t.x), -std::sin(t.y) * std::sin(t.x),
                                   std::cos(t.y));
            frames[k].point = {position(t), normal(t)};
            frames[k].normal = normal(t);
            const RootPoint a{at[k].root, {1, 0, 0}};
            for (glm::length_t s = 0; s < 2; ++s) {
                RootPoint other{at[k].root, glm::dvec3(0.0)};
                other.weights[s + 1] = 1;
                const glm::dvec2 by = angles(other) - angles(a);
                frames[k].position_steps[std::size_t(s)] = by.x * r * east + by.y * minor * north;
                frames[k].direction_steps[std::size_t(s)] =
                    by.x * std::cos(t.y) * east + by.y * north;
            }
        }
    }
    // |S_tt| ≤ major + minor, |S_ts| and |S_ss| ≤ minor; of the normal all are at most 1.
    BaseDeviation deviation(std::uint32_t root, const std::array<glm::dvec3, 3>& weights,
                            const std::array<BasePoint, 3>&) const override {
        glm::dvec2 low(1e9), high(-1e9);
        for (const glm::dvec3& w : weights) {
            low = glm::min(low, angles({root, w}));
            high = glm::max(high, angles({root, w}));
        }
        const double a = high.x - low.x, b = high.y - low.y;
        return {(a * a * (major + minor) + 2 * a * b * minor + b * b * minor) / 8,
                (a * a + 2 * a * b + b * b) / 8};
    }

  private:
    const detail::Domain& domain_;
    std::uint32_t around_, across_;
};

constexpr std::uint32_t around = 8, across = 6;
constexpr double amplitude = 0.1;

// UVs are the torus' angles; each face has its own corners, so that the last wraps around.
Mesh torus_with_uvs() {
    Mesh mesh = torus(around, across);
    mesh.uvs.resize(1);
    const glm::dvec2 step(2 * std::numbers::pi / around, 2 * std::numbers::pi / across);
    for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
        for (const glm::dvec2 corner :
             {glm::dvec2(0, 0), glm::dvec2(1, 0), glm::dvec2(1, 1), glm::dvec2(0, 1)}) {
            mesh.uvs[0].indices.push_back(std::uint32_t(mesh.uvs[0].values.size()));
            mesh.uvs[0].values.emplace_back(step * (glm::dvec2(f / across, f % across) + corner));
        }
    return mesh;
}

TessellateOptions with_waves() {
    TessellateOptions options;
    options.displacements = {{std::make_shared<Waves>(1, 3, 2), amplitude, 0, 0}};
    return options;
}

glm::dvec3 displaced(const glm::dvec2& t) {
    return ExactTorus::position(t) +
           amplitude * std::sin(3 * t.x) * std::sin(2 * t.y) * ExactTorus::normal(t);
}

glm::dvec3 displaced_normal(const glm::dvec2& t) {
    constexpr double h = 1e-5;
    const glm::dvec3 u = displaced(t + glm::dvec2(h, 0)) - displaced(t - glm::dvec2(h, 0));
    const glm::dvec3 v = displaced(t + glm::dvec2(0, h)) - displaced(t - glm::dvec2(0, h));
    return glm::normalize(glm::cross(u, v));
}

// Largest errors at 15 points of each triangle; UVs are the exact parameters (of one face).
struct Errors {
    double position = 0, normal = 0;
};
Errors errors_of(const Mesh& mesh) {
    Errors most;
    constexpr int n = 4;
    for (std::size_t t = 0; t < mesh.face_count(); ++t)
        for (int j = 0; j <= n; ++j)
            for (int i = 0; i + j <= n; ++i) {
                const double w[3] = {double(n - i - j) / n, double(i) / n, double(j) / n};
                glm::dvec2 uv(0.0);
                glm::dvec3 p(0.0), normal(0.0);
                for (std::size_t k = 0; k < 3; ++k) {
                    const std::size_t c = 3 * t + k;
                    uv += w[k] * glm::dvec2(mesh.uvs[0].values[mesh.uvs[0].indices[c]]);
                    p += w[k] * glm::dvec3(mesh.positions[mesh.corner_vertices[c]]);
                    normal += w[k] * glm::dvec3(mesh.normals.values[mesh.normals.indices[c]]);
                }
                most.position = std::max(most.position, glm::length(p - displaced(uv)));
                most.normal = std::max(most.normal,
                                       glm::length(glm::normalize(normal) - displaced_normal(uv)));
            }
    return most;
}

TEST(TessellationClosedForm, PositionsAndNormalsConvergeWithOrderTwo) {
    const Mesh cage = torus_with_uvs();
    const detail::Domain domain = detail::make_domain(cage, {}, false, 1);
    const ExactTorus base(domain, around, across);
    std::vector<double> position, normal, size;
    // Uniform: all halvings that an edge length asks for. Rates of the cage's edges: 8 to 64.
    for (const double rate : {8, 16, 32, 64}) {
        TessellateOptions options = with_waves();
        options.edge_length = 3.0 / rate;
        options.samples = 0;
        const auto made = detail::tessellate(cage, domain, base, options, {});
        ASSERT_TRUE(made) << to_string(made.error());
        const Errors errors = errors_of(made->mesh);
        EXPECT_LE(errors.position, made->certificate.proved + 1e-7);
        position.push_back(errors.position);
        normal.push_back(errors.normal);
        size.push_back(double(made->mesh.face_count()));
    }
    const auto order = [&](const std::vector<double>& e) {
        return 2 * std::log(e.front() / e.back()) / std::log(size.back() / size.front());
    };
    std::printf("order of positions %.3f, of normals %.3f\n", order(position), order(normal));
    EXPECT_GE(order(position), 1.9);
    EXPECT_GE(order(normal), 1.8);
}

TEST(TessellationClosedForm, NoPointIsFartherOffThanProved) {
    const Mesh cage = torus_with_uvs();
    const detail::Domain domain = detail::make_domain(cage, {}, false, 1);
    const ExactTorus base(domain, around, across);
    std::vector<double> looseness;
    for (const double asked : {0.1, 0.01, 0.002}) {
        TessellateOptions options = with_waves();
        options.chord_error = asked;
        const auto made = detail::tessellate(cage, domain, base, options, {});
        ASSERT_TRUE(made) << to_string(made.error());
        EXPECT_LE(made->certificate.proved, asked);
        const Errors errors = errors_of(made->mesh);
        EXPECT_LE(errors.position, made->certificate.proved);
        EXPECT_LE(made->certificate.measured, made->certificate.proved);
        looseness.push_back(made->certificate.proved / errors.position);
    }
    for (const double ratio : looseness) EXPECT_LE(ratio, 4);
}

TEST(TessellationClosedForm, NormalsAtVerticesAreThoseOfTheDisplacedSurface) {
    const Mesh cage = torus_with_uvs();
    const detail::Domain domain = detail::make_domain(cage, {}, false, 1);
    const ExactTorus base(domain, around, across);
    TessellateOptions options = with_waves();
    options.edge_length = 0.1;
    const auto made = detail::tessellate(cage, domain, base, options, {});
    ASSERT_TRUE(made);
    const Mesh& mesh = made->mesh;
    for (std::size_t c = 0; c < mesh.corner_count(); ++c) {
        const glm::dvec2 uv(mesh.uvs[0].values[mesh.uvs[0].indices[c]]);
        EXPECT_LE(glm::length(glm::dvec3(mesh.normals.values[mesh.normals.indices[c]]) -
                              displaced_normal(uv)),
                  2e-5);
        EXPECT_LE(glm::length(glm::dvec3(mesh.positions[mesh.corner_vertices[c]]) - displaced(uv)),
                  2e-6);
    }
}

// Over the unit quad: positions and directions of second order or less, with exact suprema.
class Quadratic final : public detail::BaseSurface {
  public:
    glm::dvec3 bend{0.0}, turn{0.0},
        curl{0.0};  // of x² + y²: positions; directions; of x, directions
    explicit Quadratic(const detail::Domain& domain) : domain_(domain) {}
    glm::dvec2 at(const RootPoint& p) const {
        static constexpr glm::dvec2 corners[4] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
        const detail::DomainRoot& root = domain_.roots[p.root];
        return p.weights.x * corners[root.corners[0]] + p.weights.y * corners[root.corners[1]] +
               p.weights.z * glm::dvec2(0.5);
    }
    void evaluate(std::span<const RootPoint> points, std::span<BasePoint> out) const override {
        for (std::size_t k = 0; k < points.size(); ++k) {
            const glm::dvec2 p = at(points[k]);
            out[k].position = glm::dvec3(p, 0) + glm::dot(p, p) * bend;
            out[k].direction = glm::dvec3(0, 0, 1) + glm::dot(p, p) * turn + p.x * curl;
        }
    }
    void frames(std::span<const RootPoint> points, std::span<BaseFrame> out) const override {
        for (std::size_t k = 0; k < points.size(); ++k) {
            evaluate(points.subspan(k, 1), {&out[k].point, 1});
            out[k].position_steps = {glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0)};
        }
    }
    BaseDeviation deviation(std::uint32_t root, const std::array<glm::dvec3, 3>& weights,
                            const std::array<BasePoint, 3>&) const override {
        glm::dvec2 low(1), high(0);
        for (const glm::dvec3& w : weights) {
            low = glm::min(low, at({root, w}));
            high = glm::max(high, at({root, w}));
        }
        const double size = glm::dot(high - low, high - low) / 4;
        return {size * glm::length(bend), size * glm::length(turn)};
    }

  private:
    const detail::Domain& domain_;
};

class Slope final : public HeightFunction {
  public:
    Sample at(const glm::dvec2& uv) const override { return {uv.x, {1, 0}}; }
    double deviation(const std::array<glm::dvec2, 3>&, const std::array<double, 3>&,
                     double) const override {
        return 0;
    }
};

// Each by itself: no other part of the bound can make up for one that is too small.
TEST(TessellationClosedForm, EveryPartOfTheBoundIsEnoughAlone) {
    const Mesh quad = unit_quad();
    const detail::Domain domain = detail::make_domain(quad, {}, false, 1);
    for (const int part : {0, 1, 2, 3}) {
        Quadratic base(domain);
        TessellateOptions options;
        options.displacements = {{nullptr, 0.5, 0, 0}};
        Displacement& displacement = options.displacements[0];
        if (part == 0) {
            base.bend = {0, 0, 0.3};
        } else if (part == 1) {
            displacement.height = std::make_shared<Waves>(0.3, 5, 4);
        } else if (part == 2) {  // a height of 1/2 everywhere, along a direction that turns
            base.turn = {0.3, 0, 0};
            displacement.height = std::make_shared<Waves>(0, 1, 1);
            displacement.midlevel = -1;
        } else {
            base.curl = {0.3, 0, 0};
            displacement.height = std::make_shared<Slope>();
        }
        options.chord_error = 0.004;
        options.samples = 100000;
        const auto made = detail::tessellate(quad, domain, base, options, {});
        ASSERT_TRUE(made) << to_string(made.error());
        EXPECT_LE(made->certificate.proved, 0.004) << part;
        EXPECT_LE(made->certificate.measured, made->certificate.proved) << part;
        EXPECT_LE(made->certificate.proved_refinable, 3 * made->certificate.measured) << part;
        EXPECT_GT(made->certificate.triangles, 4u) << part;
    }
}

// Noise has a bound by the size of triangles alone; halving them in the proof, not in the mesh,
// makes it the true error's, beside a base that bends, turns or both.
TEST(TessellationClosedForm, NoiseIsProvedByPartsOfTriangles) {
    const Mesh quad = unit_quad();
    const detail::Domain domain = detail::make_domain(quad, {}, false, 1);
    std::vector<double> ratios;
    for (const glm::dvec3 bend : {glm::dvec3(0), {0, 0, 0.3}, {0, 0.2, -0.1}})
        for (const glm::dvec3 turn : {glm::dvec3(0), {1.5, 0, 0}})
            for (const int octaves : {1, 4})
                for (const double asked : {0.05, 0.02, 0.004}) {
                    Quadratic base(domain);
                    base.bend = bend;
                    base.turn = turn;
                    NoiseOptions noise{.frequency = 3, .octaves = octaves, .seed = 5};
                    noise.scale = 0.1;
                    const auto function = noise_function(noise);
                    ASSERT_TRUE(function);
                    TessellateOptions options;
                    options.displacements = {{.height = nullptr, .noise = *function}};
                    options.chord_error = asked;
                    options.samples = 200000;
                    const auto made = detail::tessellate(quad, domain, base, options, {});
                    ASSERT_TRUE(made) << to_string(made.error());
                    const auto& c = made->certificate;
                    EXPECT_LE(c.proved, asked);
                    EXPECT_LE(c.measured, c.proved) << octaves << ' ' << asked;
                    ratios.push_back(c.proved_refinable / c.measured);
                    EXPECT_LE(ratios.back(), 1.5) << octaves << ' ' << asked;
                }
    std::sort(ratios.begin(), ratios.end());
    std::printf("proved over measured: median %.3f, largest %.3f\n", ratios[ratios.size() / 2],
                ratios.back());
    EXPECT_LE(ratios[ratios.size() / 2], 1.1);
}

}  // namespace
}  // namespace prep
