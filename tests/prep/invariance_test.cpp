// What must not change the result: rotations that are exact, powers of two, the order of faces and
// vertices, a second copy, the diagonal of a flat quad. Whole preparation, random meshes; the seed
// is printed where one fails.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <stdexcept>

#include "hard_cases.h"
#include "prep/prepare.h"
#include "shapes.h"

namespace {

using prep::Mesh;
using prep::no_index;

constexpr std::uint64_t seeds = 20;

// A bumpy torus of quads or triangles with UVs all around (seams included).
Mesh random_mesh(std::uint64_t seed) {
    std::mt19937_64 random(seed);
    // Drawn one after the other: the order of arguments is the compiler's.
    const std::uint32_t sides = 6 + std::uint32_t(random() % 6);
    const std::uint32_t rings = 10 + std::uint32_t(random() % 8);
    Mesh mesh = shapes::torus(rings, sides);
    shapes::jitter(mesh, 0.15f, random);
    if (seed % 2 == 1) mesh = shapes::fan_triangulated(mesh);
    std::uniform_real_distribution<float> any(0, 1);
    mesh.uvs.resize(1);
    for (const glm::vec3& p : mesh.positions)
        mesh.uvs[0].values.push_back({p.x + 0.3f * p.z + 0.1f * any(random), p.y + 0.2f * p.z});
    mesh.uvs[0].indices = mesh.corner_vertices;
    return mesh;
}

struct Corners {  // by corner
    std::vector<glm::vec3> normals;
    std::vector<glm::vec4> tangents;
    std::size_t vertices = 0;
};

Corners prepared(const Mesh& mesh, double angle = 50) {
    prep::PrepareOptions options;
    options.request.tangents = prep::Request::Level::always;
    options.hard_edges.angle_degrees = angle;
    prep::Scene scene;
    scene.meshes.push_back(mesh);
    auto result = prep::prepare(std::move(scene), options);
    EXPECT_TRUE(result.has_value());
    const Mesh& out = result->scene.meshes[0];
    Corners corners;
    for (std::uint32_t c = 0; c < out.corner_count(); ++c) {
        corners.normals.push_back(out.normals.values[out.normals.indices[c]]);
        if (out.tangents.empty()) throw std::logic_error("no tangents were made");
        corners.tangents.push_back(out.tangents.values[out.tangents.indices[c]]);
    }
    corners.vertices = result->meshes[0].vertex_count();
    return corners;
}

template <class T>
std::size_t differing(const std::vector<T>& a, const std::vector<T>& b, std::size_t first = 0) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        count += std::memcmp(&a[i], &b[first + i], sizeof(T)) != 0;
    return count;
}

double angle(const glm::vec3& a, const glm::vec3& b) {
    const glm::dvec3 x(a), y(b);
    return std::atan2(glm::length(glm::cross(x, y)), glm::dot(x, y));
}

TEST(Invariance, HalfTurnsAboutTheAxesTurnEveryBit) {
    for (std::uint64_t seed = 0; seed < seeds; ++seed) {
        SCOPED_TRACE(seed);
        const Mesh mesh = random_mesh(seed);
        const Corners base = prepared(mesh);
        for (const glm::vec3 turn : {glm::vec3(1, -1, -1), {-1, 1, -1}, {-1, -1, 1}}) {
            Mesh other = mesh;
            for (glm::vec3& p : other.positions) p *= turn;
            const Corners got = prepared(other);
            EXPECT_EQ(got.vertices, base.vertices);
            std::size_t wrong = 0;  // by value: −0 and 0 are the same direction
            for (std::size_t c = 0; c < base.normals.size(); ++c)
                wrong += got.normals[c] != base.normals[c] * turn ||
                         got.tangents[c] != base.tangents[c] * glm::vec4(turn, 1);
            EXPECT_EQ(wrong, 0u);
        }
    }
}

// Normals turn to the last bits: the sum of three squares is rounded in another order. Tangents sum
// in floats, in the order of the definition. Gradients that are opposite to 3e-4 do not share a
// tangent or do, as their product rounds to -1 or not; none of these meshes has such a pair.
TEST(Invariance, TurnsOfTheAxesAndOfIntegerQuaternionsTurnTheResult) {
    for (std::uint64_t seed = 0; seed < seeds; ++seed) {
        SCOPED_TRACE(seed);
        Mesh mesh = random_mesh(seed);
        for (glm::vec3& p : mesh.positions) p = glm::round(p * 1024.0f);  // exact under integers
        const Corners base = prepared(mesh);
        std::mt19937_64 random(seed);
        const glm::dmat3 cyclic{{0, 1, 0}, {0, 0, 1}, {1, 0, 0}};
        const glm::dmat3 quaternion{{9, 12, 20}, {-20, 15, 0}, {-12, -16, 15}};  // times 25
        for (const glm::dmat3& turn : {cyclic, quaternion}) {
            ASSERT_NEAR(glm::determinant(turn / glm::length(turn[0])), 1.0, 1e-12);
            Mesh other = mesh;
            for (glm::vec3& p : other.positions) {
                const glm::dvec3 q = turn * glm::dvec3(p);
                p = glm::vec3(q);
                ASSERT_EQ(glm::dvec3(p), q);
            }
            const glm::mat3 rotation(turn / glm::length(turn[0]));
            const Corners got = prepared(other);
            EXPECT_EQ(got.vertices, base.vertices);
            for (std::size_t c = 0; c < base.normals.size(); ++c) {
                // Three floats rounded twice, and the rotation's own.
                EXPECT_LT(angle(got.normals[c], rotation * base.normals[c]), 3e-7);
                // Float sums of up to a dozen terms that partly cancel.
                EXPECT_LT(angle(glm::vec3(got.tangents[c]), rotation * glm::vec3(base.tangents[c])),
                          1e-4);
                EXPECT_EQ(got.tangents[c].w, base.tangents[c].w);
            }
        }
    }
}

TEST(Invariance, PowersOfTwoOfPositionsAndUvsChangeNoBit) {
    for (std::uint64_t seed = 0; seed < seeds; ++seed) {
        SCOPED_TRACE(seed);
        const Mesh mesh = random_mesh(seed);
        const Corners base = prepared(mesh);
        for (const int exponent : {-20, -3, 5, 20}) {
            Mesh other = mesh;
            for (glm::vec3& p : other.positions) p *= std::ldexp(1.0f, exponent);
            for (glm::vec2& uv : other.uvs[0].values) uv *= std::ldexp(1.0f, -exponent / 2);
            const Corners got = prepared(other);
            EXPECT_EQ(got.vertices, base.vertices);
            EXPECT_EQ(differing(base.normals, got.normals), 0u) << exponent;
            EXPECT_EQ(differing(base.tangents, got.tangents), 0u) << exponent;
        }
    }
}

// Normals: no bit. Tangents are summed in the order of the triangles, as their definition says.
TEST(Invariance, OrderOfFacesAndVerticesPermutesTheResult) {
    for (std::uint64_t seed = 0; seed < seeds; ++seed) {
        SCOPED_TRACE(seed);
        const Mesh mesh = random_mesh(seed);
        const Corners base = prepared(mesh);
        std::mt19937_64 random(seed);
        const auto order = shapes::random_order(mesh.face_count(), random);
        const auto numbers = shapes::random_order(mesh.vertex_count(), random);
        const Corners got =
            prepared(shapes::with_vertex_order(shapes::with_face_order(mesh, order), numbers));
        EXPECT_EQ(got.vertices, base.vertices);
        std::size_t normals = 0, c = 0;
        for (const std::uint32_t f : order)
            for (std::uint32_t k = mesh.face_offsets[f]; k < mesh.face_offsets[f + 1]; ++k, ++c) {
                normals += got.normals[c] != base.normals[k];
                EXPECT_LT(angle(glm::vec3(got.tangents[c]), glm::vec3(base.tangents[k])), 1e-4);
                EXPECT_EQ(got.tangents[c].w, base.tangents[k].w);
            }
        EXPECT_EQ(normals, 0u);
    }
}

TEST(Invariance, ASecondCopyChangesNoBitOfTheFirst) {
    for (std::uint64_t seed = 0; seed < seeds; ++seed) {
        SCOPED_TRACE(seed);
        const Mesh mesh = random_mesh(seed);
        const Corners base = prepared(mesh);
        Mesh apart = mesh;  // elsewhere, so that no two corners are one to the tangents
        for (glm::vec3& p : apart.positions) p += glm::vec3(8, 0, 0);
        Mesh both = shapes::joined(mesh, apart);
        both.uvs = mesh.uvs;
        both.uvs[0].values.insert(both.uvs[0].values.end(), mesh.uvs[0].values.begin(),
                                  mesh.uvs[0].values.end());
        both.uvs[0].indices = both.corner_vertices;
        const Corners got = prepared(both);
        const Corners second = prepared(apart);
        EXPECT_EQ(got.vertices, base.vertices + second.vertices);
        EXPECT_EQ(differing(base.normals, got.normals), 0u);
        EXPECT_EQ(differing(base.tangents, got.tangents), 0u);
        EXPECT_EQ(differing(second.normals, got.normals, base.normals.size()), 0u);
        EXPECT_EQ(differing(second.tangents, got.tangents, base.normals.size()), 0u);
    }
}

// On a plane with an affine UV map, either diagonal gives the one normal and the one tangent there
// is.
TEST(Invariance, EitherDiagonalOfFlatQuadsGivesTheSame) {
    for (std::uint64_t seed = 0; seed < seeds; ++seed) {
        SCOPED_TRACE(seed);
        std::mt19937_64 random(seed);
        Mesh grid = shapes::grid(6, 5);
        std::uniform_int_distribution<int> step(-1, 1);
        for (glm::vec3& p : grid.positions)  // integers: the plane z = x + 2y is exact
            p = {p.x * 8 + float(step(random)), p.y * 8 + float(step(random)), 0};
        for (glm::vec3& p : grid.positions) p.z = p.x + 2 * p.y;
        const glm::dvec3 normal = glm::normalize(glm::dvec3(-1, -2, 1));
        const glm::dvec3 tangent = glm::normalize(glm::dvec3(1, 0, 1));
        for (Mesh mesh :
             {grid, shapes::fan_triangulated(grid, 0), shapes::fan_triangulated(grid, 1)}) {
            mesh.uvs.resize(1);
            for (const glm::vec3& p : mesh.positions)
                mesh.uvs[0].values.push_back({p.x / 64, p.y / 64});
            mesh.uvs[0].indices = mesh.corner_vertices;
            const Corners got = prepared(mesh);
            EXPECT_EQ(got.vertices, grid.vertex_count());
            for (std::size_t c = 0; c < got.normals.size(); ++c) {
                EXPECT_EQ(got.normals[c], glm::vec3(normal));
                EXPECT_LT(angle(glm::vec3(got.tangents[c]), glm::vec3(tangent)), 1e-6);
            }
        }
    }
}

}  // namespace
