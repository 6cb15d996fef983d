// Bounds of limit surfaces over triangles: against samples, of cells, around extraordinary
// vertices.
#include <gtest/gtest.h>

#include "limit_cages.h"
#include "limit_surface/loop_patch.h"
#include "prep/displacement/tessellate.h"
#include "tessellation/limit/cone_kernels.h"
#include "tessellation/polygon_surface.h"
#include "tessellation/tessellation.h"

namespace prep {
namespace {

using namespace tessellation_checks;

// A random triangle of bisection within a random root, against samples of LimitSurface.
TEST(TessellationLimit, BoundsHoldOverSampledTriangles) {
    std::mt19937 random(11);
    struct Looseness {
        std::vector<double> position, direction, at_corners, of_small;
        int coarse_bounds = 0;
    };
    std::map<SubdivisionScheme, Looseness> of_scheme;
    for (const Cage& cage : cages()) {
        Looseness& looseness = of_scheme[cage.scheme];
        auto base = base_of(cage);
        ASSERT_TRUE(base) << to_string(base.error());
        const detail::Domain domain = domain_of(cage, *base);
        base->set_domain(domain);
        std::uniform_int_distribution<std::uint32_t> roots(0,
                                                           std::uint32_t(domain.roots.size() - 1));
        for (int trial = 0; trial < 150; ++trial) {
            const std::uint32_t root = roots(random);
            std::uint64_t path = 1;
            // Half of them end at a corner of the cage.
            const int depth = trial % 13;
            bool at_corner = trial % 2 == 0;
            for (int k = 0; k < depth; ++k) {
                std::uint64_t bit = random() % 2;
                if (at_corner) {
                    const auto w = detail::path_weights(2 * path);
                    bit = w[0].x == 1 || w[1].x == 1 || w[2].x == 1 ? 0 : 1;
                }
                path = 2 * path + bit;
            }
            const SampledTriangle triangle(*base, root, path);
            const detail::BaseDeviation bound = triangle.bound();
            double position = 0, direction = 0;
            constexpr int n = 24;
            for (int j = 0; j <= n; ++j)
                for (int i = 0; i + j <= n; ++i) {
                    const detail::BaseDeviation off = triangle.off(
                        glm::dvec3(double(n - i - j) / n, double(i) / n, double(j) / n));
                    position = std::max(position, off.position);
                    direction = std::max(direction, off.direction);
                }
            EXPECT_LE(position, bound.position + 1e-13) << trial;
            EXPECT_LE(direction, bound.direction + 1e-11) << trial;
            if (const auto coarse = base->coarse_deviation(root, triangle.weights)) {
                ++looseness.coarse_bounds;
                EXPECT_LE(position, coarse->position + 1e-13) << trial;
                EXPECT_LE(direction, coarse->direction + 1e-11) << trial;
            }
            if (position > 1e-12) looseness.position.push_back(bound.position / position);
            if (direction > 1e-11)
                (at_corner ? looseness.at_corners : looseness.direction)
                    .push_back(bound.direction / direction);
            if (direction > 1e-11 && !at_corner && depth >= 8)
                looseness.of_small.push_back(bound.direction / direction);
        }
    }
    const auto median = [](std::vector<double> v) {
        std::nth_element(v.begin(), v.begin() + std::ptrdiff_t(v.size() / 2), v.end());
        return v[v.size() / 2];
    };
    for (const auto& [scheme, looseness] : of_scheme) {
        std::printf(
            "%s, median of bound / true: position %.2f, direction %.2f, of small triangles %.2f, "
            "at corners %.2f; %d bounds of cells\n",
            scheme == SubdivisionScheme::loop ? "loop" : "catmark", median(looseness.position),
            median(looseness.direction), median(looseness.of_small), median(looseness.at_corners),
            looseness.coarse_bounds);
        // Half of the triangles end at a corner, where no cell has a bound, and some of the others
        // lie in two cells or are large.
        EXPECT_GE(looseness.coarse_bounds, 250);
        EXPECT_LE(median(looseness.position), 1.5);
        // Large triangles and all. At extraordinary vertices second derivatives are not bounded,
        // and the bound is of first order.
        EXPECT_LE(median(looseness.direction), 6);
        EXPECT_LE(median(looseness.of_small), 4.5);
        EXPECT_LE(median(looseness.at_corners), 13);
    }
}

Result<detail::ChannelSurface> channel_surface(const Cage& cage) {
    SubdivideOptions options;
    options.scheme = cage.scheme;
    const auto channel = detail::position_cage(cage.mesh, options);
    if (!channel) return channel.error();
    std::vector<double> numbers;
    for (const glm::vec3& p : cage.mesh.positions)
        for (int k = 0; k < 3; ++k) numbers.push_back(double(p[k]));
    return detail::ChannelSurface::make(*channel, numbers, 3, true, 12, 1);
}

void expect_cells_of_their_surface(SubdivisionScheme scheme) {
    const bool triangles = scheme == SubdivisionScheme::loop;
    const auto made_of = [&](const Mesh& mesh) {
        return channel_surface({triangles ? in_triangles(mesh) : mesh, scheme});
    };
    std::mt19937 random(21);
    const auto a = made_of(torus(6, 5)), b = made_of(torus(5, 6));
    ASSERT_TRUE(a && b);
    const std::array<const detail::ChannelSurface*, 2> surfaces{&*a, &*b};
    std::vector<std::unique_ptr<detail::CellBounds>> asked;
    for (const auto* surface : surfaces)
        for (const bool with_normals : {false, true})
            asked.push_back(std::make_unique<detail::CellBounds>(*surface, with_normals));
    int bounded = 0;
    for (int trial = 0; trial < 20000; ++trial) {
        const std::size_t which = random() % 4;
        const auto root = std::uint32_t(random() % 30);
        const double side = std::ldexp(1.0, -3 - int(random() % 3)), cell = 4 * side;
        glm::dvec2 low = cell * glm::dvec2(std::floor(double(random() % 1024) / 1024 / cell),
                                           std::floor(double(random() % 1024) / 1024 / cell));
        if (triangles) {
            low *= detail::triangle_root_side;
            if (low.x + low.y >= detail::triangle_root_side) continue;
        }
        const std::array<glm::dvec2, 3> p{low, low + glm::dvec2(side, 0),
                                          low + glm::dvec2(0, side)};
        const auto known = asked[which]->deviation(root, p);
        const detail::CellBounds fresh(*surfaces[which / 2], which % 2 == 1);
        const auto made = fresh.deviation(root, p);
        ASSERT_EQ(known.has_value(), made.has_value());
        if (!known) continue;
        ++bounded;
        ASSERT_EQ(known->position, made->position);
        ASSERT_EQ(known->direction, made->direction);
        ASSERT_EQ(known->direction > 0, which % 2 == 1);
    }
    EXPECT_GT(bounded, triangles ? 5000 : 10000);
}

// Against one that has never been asked: two surfaces in turn, with normals and without.
TEST(TessellationLimit, CellsAreThoseOfTheSurfaceAndOfWhatIsAsked) {
    expect_cells_of_their_surface(SubdivisionScheme::catmark);
    expect_cells_of_their_surface(SubdivisionScheme::loop);
}

// A fold that is bent in a strip: beside it the cells are flat.
TEST(TessellationLimit, CellsBoundTheTrianglesInThem) {
    for (const SubdivisionScheme scheme : {SubdivisionScheme::catmark, SubdivisionScheme::loop}) {
        constexpr std::uint32_t n = 6;
        Mesh quads;
        for (std::uint32_t y = 0; y <= n; ++y)
            for (std::uint32_t x = 0; x <= n; ++x)
                quads.positions.emplace_back(x, y, x < 3 ? 3 - x : x - 3);
        for (std::uint32_t y = 0; y < n; ++y)
            quads.subdivision.creases.push_back({y * (n + 1) + 3, (y + 1) * (n + 1) + 3, 1.5F});
        for (std::uint32_t y = 0; y < n; ++y)
            for (std::uint32_t x = 0; x < n; ++x) {
                const std::uint32_t v = y * (n + 1) + x;
                add_face(quads, {v, v + 1, v + n + 2, v + n + 1});
            }
        const Cage cage{scheme == SubdivisionScheme::loop ? in_triangles(quads) : quads, scheme};
        auto base = base_of(cage);
        ASSERT_TRUE(base) << to_string(base.error());
        const detail::Domain domain = domain_of(cage, *base);
        base->set_domain(domain);
        int bounded = 0;
        for (std::uint32_t root = 0; root < domain.roots.size(); ++root)
            for (std::uint64_t path = 4; path < 256; ++path) {
                const auto coarse = base->coarse_deviation(root, detail::path_weights(path));
                if (!coarse) continue;
                ++bounded;
                const SampledTriangle triangle(*base, root, path);
                for (const glm::dvec3 w : {glm::dvec3(1.0 / 3),
                                           {0.5, 0.5, 0},
                                           {0, 0.5, 0.5},
                                           {0.5, 0, 0.5},
                                           {0.6, 0.2, 0.2}}) {
                    const detail::BaseDeviation off = triangle.off(w);
                    EXPECT_LE(off.position, coarse->position + 1e-14);
                    EXPECT_LE(off.direction, coarse->direction + 1e-14);
                }
            }
        EXPECT_GT(bounded, 5000);
    }
}

// A base without bounds of cells.
class WithoutCells final : public detail::BaseSurface {
  public:
    explicit WithoutCells(const detail::BaseSurface& base) : base_(base) {}
    void evaluate(std::span<const detail::RootPoint> at,
                  std::span<detail::BasePoint> points) const override {
        base_.evaluate(at, points);
    }
    void frames(std::span<const detail::RootPoint> at,
                std::span<detail::BaseFrame> frames) const override {
        base_.frames(at, frames);
    }
    detail::BaseDeviation deviation(
        std::uint32_t root, const std::array<glm::dvec3, 3>& weights,
        const std::array<detail::BasePoint, 3>& corners) const override {
        return base_.deviation(root, weights, corners);
    }

  private:
    const detail::BaseSurface& base_;
};

Mesh uneven_torus() {
    Mesh mesh = torus(24, 12);
    std::mt19937 random(3);
    std::uniform_real_distribution<float> part(-0.02F, 0.02F);
    for (glm::vec3& p : mesh.positions)
        p = 0.5F * p + glm::vec3(part(random), part(random), part(random));
    return mesh;
}

void expect_cells_to_cost_no_triangles(const Cage& cage) {
    auto base = base_of(cage);
    ASSERT_TRUE(base) << to_string(base.error());
    const detail::Domain domain = domain_of(cage, *base);
    base->set_domain(domain);
    for (const auto& [frequency, scale, asked] :
         {std::array{5.0, 0.05, 0.015}, std::array{5.0, 0.05, 0.004}, std::array{6.0, 0.02, 0.008},
          std::array{3.0, 0.2, 0.03}}) {
        NoiseOptions noise;
        noise.frequency = frequency;
        noise.scale = scale;
        const auto function = noise_function(noise);
        ASSERT_TRUE(function) << to_string(function.error());
        TessellateOptions options;
        options.scheme = cage.scheme;
        options.chord_error = asked;
        options.displacements.resize(1);
        options.displacements[0].noise = *function;
        const auto count = [&](const detail::BaseSurface& surface) -> std::uint64_t {
            const auto made = detail::tessellate(cage.mesh, domain, surface, options, {});
            EXPECT_TRUE(made) << to_string(made.error());
            return made ? made->certificate.triangles : 0;
        };
        // Parts of a triangle begin with what the whole has, which may be of a cell.
        const auto without = double(count(WithoutCells(*base)));
        EXPECT_NEAR(double(count(*base)), without, 0.005 * without) << asked;
    }
}

TEST(TessellationLimit, CellsCostNoTriangles) {
    expect_cells_to_cost_no_triangles({uneven_torus(), SubdivisionScheme::catmark});
    expect_cells_to_cost_no_triangles({in_triangles(uneven_torus()), SubdivisionScheme::loop});
}

// A vector that is 0: quick bounds are for heights and noise, and a look is taken at every
// triangle.
class NoVector final : public VectorFunction {
  public:
    Sample at(const glm::dvec2&) const override { return {}; }
    double deviation(const std::array<glm::dvec2, 3>&, const std::array<glm::dvec3, 3>&,
                     double) const override {
        return 0;
    }
};

TEST(TessellationLimit, QuickBoundsHalveTheSameTriangles) {
    Mesh cage = uneven_torus();
    cage.uvs.resize(1);
    for (std::uint32_t f = 0; f < cage.face_count(); ++f)
        for (std::uint32_t c = 0; c < 4; ++c) {
            cage.uvs[0].indices.push_back(std::uint32_t(cage.uvs[0].values.size()));
            cage.uvs[0].values.emplace_back((float(f % 24) + float(c == 1 || c == 2)) / 24.0F,
                                            (float(f / 24) + float(c >= 2)) / 12.0F);
        }
    Image image{.width = 96, .height = 64, .channels = 1, .pixels = {}};
    std::mt19937 random(4);
    for (int k = 0; k < 96 * 64; ++k) image.pixels.push_back(float(random() % 1024) / 1024.0F);
    const auto map = height_function(image);
    ASSERT_TRUE(map) << to_string(map.error());
    TessellateOptions options;
    options.scheme = SubdivisionScheme::catmark;
    options.displacements = {{*map, 0.01, 0, 0}};
    for (const double asked : {0.012, 0.004, 0.001}) {
        options.chord_error = asked;
        options.displacements[0].vector = nullptr;
        const auto quick = tessellate(cage, options);
        options.displacements[0].vector = std::make_shared<NoVector>();
        const auto slow = tessellate(cage, options);
        ASSERT_TRUE(quick && slow);
        EXPECT_EQ(quick->certificate.triangles, slow->certificate.triangles) << asked;
        EXPECT_TRUE(quick->mesh.positions == slow->mesh.positions) << asked;
    }
}

// The hull, and the cone about the vertex' normal, of what a tip is bounded by.
void expect_tip_to_hold(const detail::LimitTip& tip, const detail::RingCones& cones,
                        const glm::dvec3& axis, const glm::dvec3& p, const glm::dvec3& normal) {
    glm::dvec3 low(HUGE_VAL), high(-HUGE_VAL);
    for (const glm::dvec3& at : tip.hull) {
        low = glm::min(low, at);
        high = glm::max(high, at);
    }
    for (glm::length_t d = 0; d < 3; ++d) {
        EXPECT_GE(p[d], low[d] - 1e-14);
        EXPECT_LE(p[d], high[d] + 1e-14);
    }
    EXPECT_LE(glm::length(normal - axis), cones.from_level(tip.ring, tip.sector, tip.level) + 1e-9);
}

// Of the innermost part no bound of a triangle shows what it adds: pieces around it reach farther.
TEST(TessellationLimit, WhatIsLeftAroundAVertexIsBounded) {
    std::mt19937 random(16);
    std::uniform_real_distribution<double> number(0, 1);
    std::map<SubdivisionScheme, std::size_t> tips;
    for (const Cage& cage : cages()) {
        const auto surface = channel_surface(cage);
        ASSERT_TRUE(surface);
        const bool triangles = cage.scheme == SubdivisionScheme::loop;
        const double root_side = triangles ? detail::triangle_root_side : 1;
        const detail::RingCones cones(*surface, 1);
        detail::PatchEvaluator evaluator(surface->pieces(), SimdLevel::automatic);
        detail::LimitPieces pieces;
        const auto look = [&](std::uint32_t root, double asked_area) {
            double area = 0;
            for (const auto& patch : pieces.patches)
                area += patch.box.size().x * patch.box.size().y;
            for (const auto& patch : pieces.quartics)
                area += std::abs(detail::cross_of(patch.corners[1] - patch.corners[0],
                                                  patch.corners[2] - patch.corners[0])) /
                        2;
            for (const detail::LimitTip& tip : pieces.tips) {
                ++tips[cage.scheme];
                const glm::dvec2 size = tip.box.size();
                area += size.x * size.y / (triangles ? 2 : 1);
                const glm::dvec3 axis = surface->rings.normal(tip.ring).normal;
                for (int sample = 0; sample < 20; ++sample) {
                    glm::dvec2 at = tip.box.low + glm::dvec2(number(random), number(random)) * size;
                    const glm::dvec2 part = (at - tip.box.low) / size;
                    if (triangles && part.x + part.y > 1) at = tip.box.low + tip.box.high - at;
                    glm::dvec3 p, du, dv;
                    evaluator.point(root, at.x / root_side, at.y / root_side, &p.x, &du.x, &dv.x);
                    expect_tip_to_hold(tip, cones, axis, p, glm::normalize(glm::cross(du, dv)));
                }
            }
            EXPECT_NEAR(area, asked_area, 1e-12 * asked_area);
        };
        for (std::uint32_t root = 0; root < surface->tree.roots.size(); ++root)
            for (const double size : {0x1p-3, 0x1p-7}) {
                if (triangles) {
                    const double side = root_side * size, rest = root_side - side;
                    for (const glm::dvec2 at : {glm::dvec2(0.0), {rest, 0}, {0, rest}}) {
                        const detail::ParameterTriangle asked{at, at + glm::dvec2(side, 0),
                                                              at + glm::dvec2(0, side)};
                        detail::collect_pieces(*surface, root, asked, {}, pieces);
                        look(root, side * side / 2);
                    }
                    continue;
                }
                for (const double x : {0.0, 1.0})
                    for (const double y : {0.0, 1.0}) {
                        const glm::dvec2 a(x, y), b = a + size * (1.0 - 2.0 * a);
                        const detail::ParameterBox box{glm::min(a, b), glm::max(a, b)};
                        detail::collect_pieces(*surface, root, box, pieces);
                        look(root, size * size);
                    }
            }
    }
    EXPECT_GT(tips[SubdivisionScheme::catmark], 100u);
    EXPECT_GT(tips[SubdivisionScheme::loop], 100u);
}

// Patches that bend a little, lie apart, and one of which folds back.
std::array<detail::BezierPatch, detail::patches_at_once> random_patches(std::mt19937& random) {
    std::uniform_real_distribution<double> part(-1, 1);
    std::array<detail::BezierPatch, detail::patches_at_once> patches;
    for (std::size_t p = 0; p < patches.size(); ++p) {
        const double bend = p == 3 ? 3 : 0.02 * double(p + 1);
        const glm::dvec3 to(part(random), part(random), 0);
        for (std::size_t c = 0; c < 16; ++c) {
            const glm::dvec3 off(part(random), part(random), part(random));
            patches[p].p[c] = to + glm::dvec3(c % 4, c / 4, 0) + bend * off;
        }
    }
    return patches;
}

template <class Net>
double widest_tangent(const Net& net, const glm::dvec3& e, double error) {
    double widest = 0;
    for (const glm::dvec3& n : net) {
        const double by_e = glm::dot(n, e);
        if (!(by_e - error > 0)) return std::numeric_limits<double>::infinity();
        widest = std::max(widest, (glm::length(n - by_e * e) + error) / (by_e - error));
    }
    return widest;
}

double cone_of(const detail::BezierPatch& patch, const glm::dvec3& e) {
    const detail::NormalNet net = detail::normal_net(patch);
    return widest_tangent(net.n, e, net.error);
}

TEST(TessellationLimit, ConesAreThoseOfEachPatchForEveryInstructionSet) {
    constexpr std::size_t at_once = detail::patches_at_once;
    std::mt19937 random(19);
    std::uniform_real_distribution<double> part(-0.3, 0.3);
    const auto direction = [&] {
        return glm::normalize(glm::dvec3(part(random), part(random), 1));
    };
    std::size_t unbounded = 0;
    for (int round = 0; round < 50; ++round) {
        const auto patches = random_patches(random);
        std::array<glm::dvec3, 3> normals;
        std::array<glm::dvec3, at_once> axes;
        for (glm::dvec3& n : normals) n = direction();
        for (glm::dvec3& e : axes) e = direction();
        std::array<double, 48 * at_once> points;
        std::array<double, 3 * at_once> by_axis;
        for (std::size_t p = 0; p < at_once; ++p)
            for (std::size_t d = 0; d < 3; ++d) {
                by_axis[d * at_once + p] = axes[p][int(d)];
                for (std::size_t c = 0; c < 16; ++c)
                    points[(3 * c + d) * at_once + p] = patches[p].p[c][int(d)];
            }
        for (const SimdLevel simd :
             {SimdLevel::scalar, SimdLevel::sse4, SimdLevel::avx2, SimdLevel::avx512}) {
            const std::size_t count = 1 + std::size_t(round) % at_once;
            std::array<double, 4 * at_once> widest{};
            detail::bezier_cones(points.data(), by_axis.data(), &normals[0].x, count, widest.data(),
                                 simd);
            for (std::size_t p = 0; p < count; ++p) {
                EXPECT_EQ(widest[p], cone_of(patches[p], axes[p])) << round << ' ' << p;
                unbounded += std::isinf(widest[p]);
                for (std::size_t k = 0; k < 3; ++k)
                    EXPECT_EQ(widest[(k + 1) * at_once + p], cone_of(patches[p], normals[k]));
            }
        }
    }
    EXPECT_GT(unbounded, 0u);
}

// Of control points: by way of the patch's Bézier points, without a margin.
TEST(TessellationLimit, ConesOfControlPointsAreThoseOfTheirPatches) {
    constexpr std::size_t at_once = detail::patches_at_once;
    std::mt19937 random(23);
    std::uniform_real_distribution<double> part(-0.3, 0.3);
    const detail::CubicWeights whole = detail::bezier_weights(0, 1);
    const auto& loop = detail::loop_bezier_weights();
    for (int round = 0; round < 50; ++round) {
        const glm::dvec3 e = glm::normalize(glm::dvec3(part(random), part(random), 1));
        const auto patches = random_patches(random);
        std::array<double, 48 * at_once> controls{};
        std::array<double, at_once> widest{};
        for (std::size_t p = 0; p < at_once; ++p)
            for (std::size_t c = 0; c < 16; ++c)
                for (std::size_t d = 0; d < 3; ++d)
                    controls[(3 * c + d) * at_once + p] = patches[p].p[c][int(d)];
        detail::bicubic_cones(controls.data(), whole[0].data(), &e.x, widest.data(),
                              SimdLevel::automatic);
        for (std::size_t p = 0; p < at_once; ++p) {
            const detail::BezierPatch patch{
                detail::transformed(patches[p].p, whole, whole), {}, {}};
            EXPECT_EQ(widest[p], widest_tangent(detail::normal_net(patch).n, e, 0)) << p;
        }
        detail::quartic_cones(controls.data(), loop[0].data(), &e.x, widest.data(),
                              SimdLevel::automatic);
        for (std::size_t p = 0; p < at_once; ++p) {
            std::array<glm::dvec3, 12> points;
            std::copy_n(patches[p].p.begin(), 12, points.begin());
            detail::QuarticPatch patch;
            patch.p = detail::quartic_points(points);
            patch.corners = {glm::dvec2(0, 0), glm::dvec2(1, 0), glm::dvec2(0, 1)};
            const double expected = widest_tangent(detail::normal_net(patch).n, e, 0);
            if (std::isinf(expected))
                EXPECT_EQ(widest[p], expected) << p;
            else
                EXPECT_NEAR(widest[p], expected, 1e-12 * expected) << p;
        }
    }
}

TEST(TessellationLimit, ConesOfRingsAreTheSameForEveryInstructionSet) {
    std::set<SubdivisionScheme> schemes;
    for (const Cage& cage : cages()) {
        const auto surface = channel_surface(cage);
        ASSERT_TRUE(surface);
        const detail::RingCones plain(*surface, 1, SimdLevel::scalar);
        for (const SimdLevel simd : {SimdLevel::sse4, SimdLevel::avx2, SimdLevel::avx512}) {
            const detail::RingCones cones(*surface, 1, simd);
            for (std::uint32_t r = 0; r < surface->tree.rings.size(); ++r)
                for (std::uint32_t j = 0; j < surface->tree.rings[r].shape.sectors; ++j)
                    for (int k = detail::tip_levels; k < 50; ++k) {
                        ASSERT_EQ(cones.from_level(r, j, k), plain.from_level(r, j, k));
                        schemes.insert(cage.scheme);
                    }
        }
    }
    EXPECT_GE(schemes.size(), 2u);
}

double farthest(const glm::dvec3& from, const std::array<glm::dvec3, 3>& to) {
    return std::max(
        {glm::length(from - to[0]), glm::length(from - to[1]), glm::length(from - to[2])});
}

// Of the patches in a triangle the one whose normals may be farthest from the corners'.
TEST(TessellationLimit, DirectionsAtVerticesAreThoseOfTheirPatchesCones) {
    std::size_t compared = 0;
    for (const Cage& cage : cages()) {
        if (cage.scheme != SubdivisionScheme::catmark) continue;
        const auto surface = channel_surface(cage);
        ASSERT_TRUE(surface);
        const detail::RingCones cones(*surface, 1);
        detail::PatchEvaluator evaluator(surface->pieces(), SimdLevel::automatic);
        detail::LimitPieces pieces;
        const auto compare = [&](std::uint32_t root, const glm::dvec2& corner) {
            const glm::dvec2 to = 0.125 * (1.0 - 2.0 * corner);
            detail::LimitTriangle triangle;
            triangle.root = root;
            triangle.parameters = {corner, corner + glm::dvec2(to.x, 0),
                                   corner + glm::dvec2(0, to.y)};
            for (std::size_t k = 0; k < 3; ++k) {
                const glm::dvec2 at = triangle.parameters[k] + 0.03 * to;
                glm::dvec3 du, dv;
                evaluator.point(root, at.x, at.y, &triangle.positions[k].x, &du.x, &dv.x);
                triangle.normals[k] = glm::normalize(glm::cross(du, dv));
            }
            detail::collect_pieces(*surface, root, detail::box_of(triangle.parameters), pieces);
            if (pieces.tips.empty()) return;
            double expected = 0;
            for (const detail::BezierPatch& patch : pieces.patches) {
                if (detail::is_apart(patch.box, triangle)) continue;
                const auto net = detail::normal_net(patch);
                const auto middle = detail::middle_derivatives(patch);
                const auto about = [&](const glm::dvec3& e) {
                    return detail::chord_of_tangent(widest_tangent(net.n, e, net.error));
                };
                const glm::dvec3 e =
                    detail::unit_or(glm::cross(middle[0], middle[1]), triangle.normals[0]);
                double from_corners = 0;
                for (const glm::dvec3& normal : triangle.normals)
                    from_corners = std::max(from_corners, about(normal));
                expected = std::max(
                    expected, std::min(from_corners, about(e) + farthest(e, triangle.normals)));
            }
            for (const detail::LimitTip& tip : pieces.tips)
                if (!detail::is_apart(tip.box, triangle))
                    expected = std::max(
                        expected,
                        cones.from_level(tip.ring, tip.sector, tip.level) +
                            farthest(surface->rings.normal(tip.ring).normal, triangle.normals));
            EXPECT_EQ(detail::limit_deviation(*surface, &cones, triangle).direction,
                      std::min(expected, 2.0));
            ++compared;
        };
        for (std::uint32_t root = 0; root < surface->tree.roots.size(); ++root)
            for (const glm::dvec2 corner : {glm::dvec2(0, 0), {1, 0}, {0, 1}, {1, 1}})
                compare(root, corner);
    }
    EXPECT_GT(compared, 100u);
}

// Also where three of Loop's triangles meet, and where a crease has one face on a side: there
// normals are those of rounding errors before others are.
TEST(TessellationLimit, NormalsComeTogetherTowardsEveryVertex) {
    std::mt19937 random(18);
    std::uniform_real_distribution<float> part(-0.05F, 0.05F);
    std::set<std::pair<SubdivisionScheme, int>> thin;
    for (Cage& cage : cages())
        for (int round = 0; round < 3; ++round) {
            for (glm::vec3& p : cage.mesh.positions)
                p += glm::vec3(part(random), part(random), part(random));
            const auto surface = channel_surface(cage);
            ASSERT_TRUE(surface);
            const detail::RingCones cones(*surface, 1);
            for (std::uint32_t r = 0; r < surface->tree.rings.size(); ++r) {
                const detail::RingShape& shape = surface->tree.rings[r].shape;
                if (shape.deepest_level() < 50) thin.emplace(cage.scheme, shape.sectors);
                for (std::uint32_t sector = 0; sector < shape.sectors; ++sector) {
                    EXPECT_LE(cones.from_level(r, sector, 24), 0.01);
                    EXPECT_EQ(cones.from_level(r, sector, shape.deepest_level()), 0);
                }
            }
        }
    EXPECT_EQ(thin.size(), 3u);
}

}  // namespace
}  // namespace prep
