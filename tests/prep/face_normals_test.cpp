#include "prep/face_normals.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "exact.h"
#include "normals/triangle_areas.h"
#include "shapes.h"

namespace {

using prep::FaceState;
using prep::Mesh;
using prep::MeshView;
using prep::Precision;
using prep::SimdLevel;

prep::FaceNormals normals_of(const Mesh& mesh, Precision precision = Precision::accurate,
                             int threads = 0) {
    return prep::face_normals(MeshView(mesh), precision, threads);
}

Mesh triangle(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    return shapes::polygon({a, b, c});
}

// Random triangles: well-shaped ones, needles down to 1e-12, all far off or not, at any scale.
Mesh hostile_triangles(std::mt19937_64& random, int count) {
    std::uniform_real_distribution<double> unit(-1, 1);
    std::uniform_int_distribution<int> thinness(0, 12), scale(-120, 110), offset(-4, 20);
    std::vector<glm::vec3> positions;
    shapes::Faces faces;
    for (int i = 0; i < count; ++i) {
        const auto vector = [&] { return glm::dvec3(unit(random), unit(random), unit(random)); };
        const glm::dvec3 base = vector() * std::ldexp(1.0, offset(random)), along = vector();
        const glm::dvec3 aside = vector() * std::pow(10.0, -thinness(random));
        const double size = std::ldexp(1.0, scale(random) - 20);
        for (const glm::dvec3& p : {base, base + along, base + along * 0.3 + aside})
            positions.emplace_back(p * size);
        const std::uint32_t v = std::uint32_t(3 * i);
        faces.push_back({v, v + 1, v + 2});
    }
    return shapes::mesh_of(std::move(positions), faces);
}

TEST(FaceNormals, EmptyMesh) {
    EXPECT_TRUE(normals_of(Mesh{}).area_vectors.empty());
}

TEST(FaceNormals, CubeHasAxesOfLengthTwiceTheArea) {
    for (const Precision p : {Precision::fast, Precision::accurate, Precision::exact}) {
        const prep::FaceNormals n = normals_of(shapes::cube(), p);
        const std::vector<glm::dvec3> expected{{0, 0, -8}, {0, 0, 8},  {0, -8, 0},
                                               {0, 8, 0},  {-8, 0, 0}, {8, 0, 0}};
        EXPECT_EQ(n.area_vectors, expected);
    }
}

TEST(FaceNormals, NonPlanarPolygonIsNewellsSum) {
    const Mesh mesh = shapes::polygon({{0, 0, 0}, {2, 0, 1}, {3, 2, -1}, {1, 4, 2}, {-1, 1, 0}});
    const exact::Vector truth = exact::area_vector(mesh, 0);
    for (const Precision p : {Precision::accurate, Precision::exact}) {
        const prep::FaceNormals n = normals_of(mesh, p);
        EXPECT_EQ(exact::vector(n.area_vectors[0]), truth);
    }
}

TEST(FaceNormals, NewellsSumIsThatOfAnyTriangulation) {
    std::mt19937_64 random(3);
    Mesh mesh = shapes::cylinder(9);
    shapes::jitter(mesh, 0.2f, random);
    for (std::uint32_t first = 0; first < 4; ++first) {
        const Mesh cut = shapes::fan_triangulated(mesh, first);
        const prep::FaceNormals whole = normals_of(mesh), parts = normals_of(cut);
        std::size_t t = 0;
        for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
            glm::dvec3 sum(0.0);
            for (std::uint32_t k = 2; k < mesh.face_offsets[f + 1] - mesh.face_offsets[f]; ++k)
                sum += parts.area_vectors[t++];
            EXPECT_LT(glm::length(sum - whole.area_vectors[f]), 1e-14);
        }
    }
}

TEST(FaceNormals, StatesAreExact) {
    const float next = std::nextafter(1.0f, 2.0f), nan = std::numeric_limits<float>::quiet_NaN();
    const float inf = std::numeric_limits<float>::infinity(), least = 1e-45f;
    const struct {
        Mesh mesh;
        FaceState state;
    } cases[] = {
        {triangle({0, 0, 0}, {1, 1, 1}, {2, 2, 2}), FaceState::zero_area},
        {triangle({0, 0, 0}, {1, 1, 1}, {next, 1, 1}), FaceState::regular},
        {triangle({0, 0, 0}, {1, 1, 0}, {2, 2, least}), FaceState::regular},
        {triangle({0, 0, 0}, {0, 0, 0}, {1, 0, 0}), FaceState::zero_area},
        {triangle({0, 0, 0}, {least, 0, 0}, {0, least, 0}), FaceState::regular},
        {triangle({0, 0, 0}, {3e38f, 0, 0}, {0, 3e38f, 0}), FaceState::regular},
        {triangle({-3e38f, 0, 0}, {3e38f, 0, 0}, {0, 3e38f, 0}), FaceState::regular},
        {triangle({1e30f, 0, 0}, {1e30f, 1e-30f, 0}, {0, 1, 0}), FaceState::regular},
        {triangle({0, 0, 0}, {1, 0, 0}, {0, nan, 0}), FaceState::non_finite},
        {triangle({0, 0, 0}, {inf, 0, 0}, {0, 1, 0}), FaceState::non_finite},
        {triangle({0, 0, inf}, {1, 0, -inf}, {0, 1, 0}), FaceState::non_finite},
        // A figure of eight: the halves cancel.
        {shapes::polygon({{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}}), FaceState::zero_area},
    };
    for (const Precision p : {Precision::fast, Precision::accurate, Precision::exact})
        for (const auto& c : cases) {
            const prep::FaceNormals n = normals_of(c.mesh, p);
            EXPECT_EQ(n.states[0], c.state) << &c - cases;
            EXPECT_EQ(n.area_vectors[0] == glm::dvec3(0.0), c.state != FaceState::regular);
        }
}

TEST(FaceNormals, AnyCoordinateThatIsNotFiniteIsSeen) {
    constexpr float inf = std::numeric_limits<float>::infinity();
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), inf, -inf})
        for (int vertex = 0; vertex < 3; ++vertex)
            for (int axis = 0; axis < 3; ++axis)
                for (const Precision p : {Precision::fast, Precision::accurate, Precision::exact}) {
                    Mesh mesh = triangle({0, 0, 0.5f}, {1, 0.25f, 0}, {0, 1, 0});
                    mesh.positions[vertex][axis] = bad;
                    const prep::FaceNormals n = normals_of(mesh, p);
                    EXPECT_EQ(n.states[0], FaceState::non_finite) << bad << vertex << axis;
                    EXPECT_EQ(n.area_vectors[0], glm::dvec3(0.0));
                }
}

TEST(FaceNormals, ErrorsStayBelowTheirBounds) {
    std::mt19937_64 random(11);
    const Mesh mesh = hostile_triangles(random, 3000);
    for (const Precision p : {Precision::fast, Precision::accurate, Precision::exact}) {
        const prep::FaceNormals n = normals_of(mesh, p);
        double worst = 0;
        for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
            const exact::Vector truth = exact::area_vector(mesh, f);
            if (n.states[f] == FaceState::zero_area) {
                EXPECT_EQ(truth, (exact::Vector{0, 0, 0}));
                continue;
            }
            const exact::Vector off = exact::vector(n.area_vectors[f]) - truth;
            worst = std::max(
                worst, (exact::dot(off, off) / exact::dot(truth, truth)).convert_to<double>());
        }
        EXPECT_LE(std::sqrt(worst), n.relative_error) << int(p);
        RecordProperty("worst_relative_error", std::to_string(std::sqrt(worst)));
    }
}

TEST(FaceNormals, PowerOfTwoScalesChangeNoMantissaBit) {
    std::mt19937_64 random(12);
    const Mesh mesh = shapes::random_triangles(100, 200, random);
    for (const Precision p : {Precision::fast, Precision::accurate, Precision::exact}) {
        const prep::FaceNormals base = normals_of(mesh, p);
        for (const int scale : {-40, -7, 1, 30}) {
            Mesh scaled = mesh;
            for (glm::vec3& v : scaled.positions) v *= std::ldexp(1.0f, scale);
            const prep::FaceNormals n = normals_of(scaled, p);
            for (std::size_t f = 0; f < mesh.face_count(); ++f)
                EXPECT_EQ(n.area_vectors[f], base.area_vectors[f] * std::ldexp(1.0, 2 * scale));
        }
    }
}

TEST(FaceNormals, SignedPermutationsOfTheAxesChangeNoBit) {
    std::mt19937_64 random(13);
    const Mesh mesh = hostile_triangles(random, 500);
    const auto turned = [](const auto& v) { return decltype(v + v)(-v.y, v.x, v.z); };
    const auto cycled = [](const auto& v) { return decltype(v + v)(v.z, v.x, v.y); };
    for (const Precision p : {Precision::fast, Precision::accurate, Precision::exact}) {
        const prep::FaceNormals base = normals_of(mesh, p);
        Mesh a = mesh, b = mesh;
        for (glm::vec3& v : a.positions) v = turned(v);
        for (glm::vec3& v : b.positions) v = cycled(v);
        const prep::FaceNormals na = normals_of(a, p), nb = normals_of(b, p);
        for (std::size_t f = 0; f < mesh.face_count(); ++f) {
            EXPECT_EQ(na.area_vectors[f], turned(base.area_vectors[f]));
            EXPECT_EQ(nb.area_vectors[f], cycled(base.area_vectors[f]));
        }
    }
}

TEST(FaceNormals, ThreadsChangeNothing) {
    std::mt19937_64 random(14);
    const Mesh mesh = hostile_triangles(random, 40'000);
    for (const Precision p : {Precision::fast, Precision::accurate}) {
        const prep::FaceNormals one = normals_of(mesh, p, 1);
        for (const int threads : {2, 3, 8}) {
            const prep::FaceNormals many = normals_of(mesh, p, threads);
            EXPECT_EQ(one.area_vectors, many.area_vectors);
            EXPECT_EQ(one.states, many.states);
        }
    }
}

TEST(FaceNormals, EveryInstructionSetGivesTheSameBits) {
    std::mt19937_64 random(15);
    const Mesh mesh = hostile_triangles(random, 20'000);
    const auto areas = [&](SimdLevel level) {
        std::pair<std::vector<glm::dvec3>, std::vector<std::uint32_t>> made;
        made.first.resize(mesh.face_count());
        prep::detail::triangle_areas(mesh.positions, mesh.corner_vertices, 0,
                                     std::uint32_t(mesh.face_count()), made.first, made.second,
                                     level);
        return made;
    };
    const auto scalar = areas(SimdLevel::scalar);
    EXPECT_GT(scalar.second.size(), 100U);
    EXPECT_LT(scalar.second.size(), mesh.face_count() - 1000);
    int tried = 0;
    for (const SimdLevel level : {SimdLevel::sse4, SimdLevel::avx2, SimdLevel::avx512}) {
        if (!prep::simd_available(level)) continue;
        EXPECT_EQ(areas(level), scalar) << to_string(level);
        ++tried;
    }
    if (tried == 0) GTEST_SKIP() << "this machine runs none beside the baseline";
}

}  // namespace
