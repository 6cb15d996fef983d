// One normal a vertex: against corner normals without hard edges wherever a vertex' faces are one
// fan, bit for bit, and against exact sums everywhere.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "hard_cases.h"
#include "normal_oracle.h"
#include "normals/vertex_normals_path.h"
#include "prep/corner_normals.h"
#include "shapes.h"
#include "simd_levels.h"

#if defined(__linux__)
#include <sys/mman.h>
#include <unistd.h>
#endif

namespace {

using prep::Mesh;
using prep::MeshView;
using prep::Precision;
using prep::VertexNormalOptions;
using prep::VertexNormals;

std::array<std::uint32_t, 3> bits(const glm::vec3& v) {
    return {std::bit_cast<std::uint32_t>(v.x), std::bit_cast<std::uint32_t>(v.y),
            std::bit_cast<std::uint32_t>(v.z)};
}
std::vector<std::array<std::uint32_t, 3>> bits(const std::vector<glm::vec3>& values) {
    std::vector<std::array<std::uint32_t, 3>> result;
    for (const glm::vec3& v : values) result.push_back(bits(v));
    return result;
}

VertexNormals vertex_normals_of(const Mesh& mesh, Precision precision = Precision::accurate) {
    VertexNormalOptions options;
    options.precision = precision;
    return prep::vertex_normals(MeshView(mesh), options).value();
}

// How many vertices are one fan.
std::size_t expect_corner_normals(const Mesh& mesh, Precision precision = Precision::accurate) {
    prep::HardEdgeOptions smooth;
    smooth.angle_degrees.reset();
    prep::NormalOptions options;
    options.precision = precision;
    const auto truth = prep::crease_normals(MeshView(mesh), {}, smooth, options);
    const prep::CornerLayer<glm::vec3>& layer = truth->normals.normals;
    constexpr std::uint32_t unused = ~0u, several = unused - 1;
    std::vector<std::uint32_t> values(mesh.vertex_count(), unused);
    for (std::size_t c = 0; c < mesh.corner_count(); ++c) {
        std::uint32_t& value = values[mesh.corner_vertices[c]];
        value = value == unused || value == layer.indices[c] ? layer.indices[c] : several;
    }
    const VertexNormals ours = vertex_normals_of(mesh, precision);
    EXPECT_EQ(ours.normals.size(), mesh.vertex_count());
    std::size_t fans = 0, different = 0;
    for (std::size_t v = 0; v < values.size(); ++v) {
        if (values[v] == several) continue;
        const glm::vec3 expected =
            values[v] == unused ? glm::vec3(0, 0, 1) : layer.values[values[v]];
        different += bits(ours.normals[v]) != bits(expected);
        ++fans;
    }
    EXPECT_EQ(different, 0u);
    return fans;
}

Mesh bumpy_torus(std::uint32_t rings, std::uint32_t segments) {
    std::mt19937_64 random(31);
    Mesh mesh = shapes::fan_triangulated(shapes::torus(rings, segments));
    shapes::jitter(mesh, 0.002f, random);
    return mesh;
}

TEST(VertexNormals, AreCornerNormalsWhereFacesAreOneFan) {
    // Several ranges of triangles, whose last comes back to the first vertices.
    const Mesh torus = bumpy_torus(260, 190);
    EXPECT_EQ(expect_corner_normals(torus), torus.vertex_count());
    for (const Mesh& mesh :
         {shapes::icosphere(4), shapes::fan_triangulated(shapes::cube()), shapes::cube(),
          shapes::fan_triangulated(shapes::cylinder(40)), shapes::cylinder(9),
          shapes::fan_triangulated(shapes::uv_sphere(40, 30)), shapes::fan(5), shapes::fan(20'000),
          shapes::soup(shapes::icosphere(2))})
        EXPECT_EQ(expect_corner_normals(mesh), mesh.vertex_count());
    for (const Precision precision : {Precision::exact, Precision::accurate})
        EXPECT_EQ(expect_corner_normals(bumpy_torus(20, 30), precision), 600u);
}

// Whole meshes of components that are sums of zeros are not left to the slow way, and nothing is
// taken for zero that is not.
// Hundreds in a row before, among and behind the others.
TEST(VertexNormals, OfUnusedVerticesPointUp) {
    const Mesh torus = bumpy_torus(60, 50);
    Mesh mesh = torus;
    mesh.positions.clear();
    const std::size_t half = torus.vertex_count() / 2;
    const auto place = [&](std::size_t v) { return 200 + v + (v < half ? 0 : 333); };
    mesh.positions.assign(torus.vertex_count() + 200 + 333 + 77, glm::vec3(5));
    for (std::size_t v = 0; v < torus.vertex_count(); ++v)
        mesh.positions[place(v)] = torus.positions[v];
    for (std::uint32_t& v : mesh.corner_vertices) v = std::uint32_t(place(v));
    for (const Precision precision : {Precision::fast, Precision::accurate, Precision::exact}) {
        std::vector<glm::vec3> expected(mesh.vertex_count(), glm::vec3(0, 0, 1));
        const VertexNormals alone = vertex_normals_of(torus, precision);
        for (std::size_t v = 0; v < torus.vertex_count(); ++v)
            expected[place(v)] = alone.normals[v];
        std::size_t different = 0;
        const VertexNormals ours = vertex_normals_of(mesh, precision);
        for (std::size_t v = 0; v < expected.size(); ++v)
            different += bits(ours.normals[v]) != bits(expected[v]);
        EXPECT_EQ(different, 0u) << int(precision);
    }
}

TEST(VertexNormals, OfFlatMeshes) {
    Mesh flat = shapes::fan_triangulated(shapes::grid(90, 70));
    EXPECT_EQ(expect_corner_normals(flat), flat.vertex_count());
    for (glm::vec3& p : flat.positions) std::swap(p.x, p.z);
    EXPECT_EQ(expect_corner_normals(flat), flat.vertex_count());
    for (glm::vec3& p : flat.positions) std::swap(p.x, p.y);
    EXPECT_EQ(expect_corner_normals(flat), flat.vertex_count());
}

prep::detail::VertexNormalsPath path_of(const Mesh& mesh,
                                        Precision precision = Precision::accurate) {
    VertexNormalOptions options;
    options.precision = precision;
    prep::detail::VertexNormalsPath path;
    EXPECT_TRUE(prep::detail::vertex_normals(MeshView(mesh), options, path));
    return path;
}

// A tube upright, its plan a polygon that is parallel to no axis.
Mesh extrusion(std::uint32_t segments, std::uint32_t rows, float row_height) {
    std::vector<glm::vec3> positions;
    for (std::uint32_t r = 0; r < rows; ++r)
        for (std::uint32_t s = 0; s < segments; ++s) {
            const double angle = 0.1 + 6.283185307179586 * s / segments;
            positions.emplace_back(3 * std::cos(angle), 2 * std::sin(angle), row_height * float(r));
        }
    shapes::Faces faces;
    for (std::uint32_t r = 0; r + 1 < rows; ++r)
        for (std::uint32_t s = 0; s < segments; ++s) {
            const std::uint32_t a = r * segments + s, b = r * segments + (s + 1) % segments;
            faces.push_back({a, b, b + segments});
            faces.push_back({a, b + segments, a + segments});
        }
    return shapes::mesh_of(std::move(positions), faces);
}

// Vertices by rows, triangles by columns.
Mesh tall_grid(std::uint32_t width, std::uint32_t height) {
    std::vector<glm::vec3> positions;
    for (std::uint32_t y = 0; y < height; ++y)
        for (std::uint32_t x = 0; x < width; ++x)
            positions.emplace_back(x, y, std::sin(0.1f * float(x)) + std::cos(0.07f * float(y)));
    Mesh mesh;
    mesh.positions = std::move(positions);
    mesh.face_offsets = {0};
    for (std::uint32_t x = 0; x + 1 < width; ++x)
        for (std::uint32_t y = 0; y + 1 < height; ++y) {
            const std::uint32_t a = y * width + x, d = a + width;
            for (const std::uint32_t v : {a, a + 1, d + 1, a, d + 1, d})
                mesh.corner_vertices.push_back(v);
            for (int k = 0; k < 2; ++k) mesh.face_offsets.push_back(mesh.face_offsets.back() + 3);
        }
    return mesh;
}

// Needles too, whose accurate area vectors are not plain doubles.
TEST(VertexNormals, OfExtrusionsAreToldByTheirSums) {
    for (const float height : {0.02f, 5.0f}) {
        Mesh tube = extrusion(1000, 12, height);
        for (int turn = 0; turn < 3; ++turn) {
            EXPECT_EQ(expect_corner_normals(tube), tube.vertex_count());
            EXPECT_LE(path_of(tube).open_vertices, tube.vertex_count() / 100);
            EXPECT_FALSE(path_of(tube).by_corners);
            for (glm::vec3& p : tube.positions) p = {p.z, p.x, p.y};
        }
    }
}

TEST(VertexNormals, OfFlatAndCurvedMeshesAreToldByTheirSums) {
    const Mesh torus = bumpy_torus(260, 190);
    for (const Precision precision : {Precision::accurate, Precision::fast}) {
        EXPECT_LE(path_of(torus, precision).open_vertices, torus.vertex_count() / 500);
        EXPECT_FALSE(path_of(torus, precision).by_corners);
    }
    Mesh flat = shapes::fan_triangulated(shapes::grid(90, 70));
    EXPECT_EQ(path_of(flat).open_vertices, 0u);
    EXPECT_TRUE(path_of(torus, Precision::exact).by_corners);
    EXPECT_TRUE(path_of(shapes::torus(9, 7)).by_corners);
}

// Sums by ranges would be of every page in every range.
TEST(VertexNormals, OfGridsAcrossTheirRowsGoByCorners) {
    const Mesh tall = tall_grid(448, 256), wide = tall_grid(64, 2000);
    EXPECT_TRUE(path_of(tall).by_corners);
    EXPECT_EQ(expect_corner_normals(tall), tall.vertex_count());
    EXPECT_EQ(expect_corner_normals(wide), wide.vertex_count());
}

// A range that uses more pages than its corners pay for, and ranges that use the same pages.
TEST(VertexNormals, OfFewTrianglesAPageGoByCorners) {
    const Mesh soup = shapes::soup(shapes::fan_triangulated(shapes::torus(128, 128)));
    EXPECT_FALSE(path_of(soup).by_corners);
    Mesh twice = soup;
    for (const std::uint32_t v : soup.corner_vertices) {
        twice.corner_vertices.push_back(v);
        if (twice.corner_count() % 3 == 0)
            twice.face_offsets.push_back(std::uint32_t(twice.corner_count()));
    }
    EXPECT_TRUE(path_of(twice).by_corners);
    EXPECT_EQ(bits(vertex_normals_of(twice).normals), bits(vertex_normals_of(soup).normals));
    for (const std::uint32_t triangles : {3000u, 3200u}) {
        Mesh sparse;
        sparse.positions.assign(std::size_t(triangles) * 64, glm::vec3(0));
        sparse.face_offsets = {0};
        for (std::uint32_t t = 0; t < triangles; ++t) {
            sparse.positions[64 * t + 1].x = sparse.positions[64 * t + 2].y = 1;
            for (std::uint32_t k = 0; k < 3; ++k) sparse.corner_vertices.push_back(64 * t + k);
            sparse.face_offsets.push_back(3 * t + 3);
        }
        EXPECT_EQ(path_of(sparse).by_corners, triangles > 3072);
    }
}

// More than a few vertices that sums do not tell: both sides of a sheet.
TEST(VertexNormals, OfManyThatCancelGoByCorners) {
    Mesh folded = shapes::fan_triangulated(shapes::grid(90, 70));
    const Mesh once = folded;
    for (std::size_t c = 0; c < once.corner_count(); c += 3)
        for (const std::size_t k : {c, c + 2, c + 1}) {
            folded.corner_vertices.push_back(once.corner_vertices[k]);
            if (k == c + 1) folded.face_offsets.push_back(std::uint32_t(folded.corner_count()));
        }
    EXPECT_TRUE(path_of(folded).by_corners);
    EXPECT_GT(path_of(folded).open_vertices, 1024u);
    EXPECT_EQ(vertex_normals_of(folded).fallbacks.size(), folded.vertex_count());
    // Few vertices, many corners.
    Mesh cone = shapes::fan(20'000);
    for (glm::vec3& p : cone.positions)
        if (p.z != 0) p.z = 1e-12f;
    const auto path = path_of(cone);
    EXPECT_GE(path.open_vertices, 1u);
    EXPECT_TRUE(path.by_corners);
}

TEST(VertexNormals, RefuseWhatIsNoMesh) {
    for (const Precision precision : {Precision::fast, Precision::accurate, Precision::exact})
        for (Mesh good : {shapes::cube(), shapes::icosphere(3)}) {
            VertexNormalOptions options;
            options.precision = precision;
            const auto error_of = [&](const Mesh& mesh) {
                const auto normals = prep::vertex_normals(MeshView(mesh), options);
                return normals ? std::string() : to_string(normals.error());
            };
            Mesh bad = good;
            const std::uint32_t last = bad.face_offsets[1] - 1;
            for (const std::uint32_t vertex : {std::uint32_t(bad.vertex_count()), ~0u}) {
                bad.corner_vertices[last] = vertex;
                EXPECT_EQ(error_of(bad), "face 0: vertex " + std::to_string(vertex) + " of " +
                                             std::to_string(bad.vertex_count()));
            }
            bad = good;
            bad.face_offsets[1] = 2;
            EXPECT_NE(error_of(bad), "");
            bad.face_offsets[1] = bad.face_offsets[2];
            EXPECT_EQ(error_of(bad), "face 1: a face has fewer than 3 corners");
            bad = good;
            bad.face_offsets.pop_back();
            EXPECT_NE(error_of(bad).find("face offsets"), std::string::npos);
            bad.face_offsets.clear();
            EXPECT_NE(error_of(bad).find("face offsets"), std::string::npos);
            EXPECT_EQ(error_of(good), "");
        }
}

// A face from just below 2³² to 1 would have three corners; all others have, but the first.
TEST(VertexNormals, RefuseOffsetsThatWrapAround) {
    Mesh mesh;
    mesh.positions.assign(3, glm::vec3(1));
    mesh.face_offsets = {0, 0xfffffffeu - 3 * 40'000};
    for (int f = 0; f < 60'000; ++f) mesh.face_offsets.push_back(mesh.face_offsets.back() + 3);
    mesh.corner_vertices.assign(mesh.face_offsets.back(), 0);
    ASSERT_LT(mesh.corner_count(), 60'000u);
    for (const Precision precision : {Precision::fast, Precision::accurate, Precision::exact}) {
        VertexNormalOptions options;
        options.precision = precision;
        const auto normals = prep::vertex_normals(MeshView(mesh), options);
        ASSERT_FALSE(normals.has_value());
        EXPECT_EQ(to_string(normals.error()), "face 40001: a face has fewer than 3 corners");
    }
}

// x is 1 − 1 + 2⁻⁶⁰ in any order, beside a large z.
TEST(VertexNormals, DoNotDependOnTheOrderOfWhatCancels) {
    Mesh mesh = shapes::mesh_of({{0, 0, 0},
                                 {0, 1, 0},
                                 {-9, 0, 1},
                                 {9, 0, -1},
                                 {0, 0x1p-30f, 0},
                                 {-8, 0, 0x1p-30f},
                                 {1, 0, 0}},
                                {{0, 1, 2}, {0, 1, 3}, {0, 4, 5}, {0, 6, 1}});
    std::vector<std::uint32_t> order(mesh.face_count());
    std::iota(order.begin(), order.end(), 0u);
    const auto first = bits(vertex_normals_of(mesh).normals);
    do EXPECT_EQ(bits(vertex_normals_of(shapes::with_face_order(mesh, order)).normals), first);
    while (std::next_permutation(order.begin(), order.end()));
}

// Products are equal in doubles and not in truth, by 2⁻⁶⁰: of two faces that nearly cancel, and of
// a needle beside a large face.
TEST(VertexNormals, KeepWhatDoublesTakeForEqual) {
    const Mesh folded =
        shapes::mesh_of({{0, -0x1p-60f, 0}, {1, 1, 1}, {0, 2, 2}, {1 - 0x1p-12f, 0.5f, 0.5f}},
                        {{0, 1, 2}, {0, 2, 3}});
    EXPECT_EQ(expect_corner_normals(folded), 4u);
    EXPECT_NE(vertex_normals_of(folded).normals[0].x, 0);
    const Mesh needle = shapes::mesh_of(
        {{0, -0x1p-60f, 0}, {1, 1, 1}, {2 - 0x1p-6f, 2, 2}, {10, 0, 0}}, {{0, 1, 2}, {0, 2, 3}});
    EXPECT_EQ(expect_corner_normals(needle), 4u);
}

double bound_of(Precision precision) {
    return precision == Precision::fast       ? prep::fast_normal_error
           : precision == Precision::accurate ? prep::accurate_normal_error
                                              : prep::exact_normal_error;
}

void expect_exact_sums(const Mesh& mesh) {
    const exact::NormalOracle oracle(mesh);
    std::vector<std::vector<std::uint32_t>> corners(mesh.vertex_count());
    for (std::uint32_t c = 0; c < mesh.corner_count(); ++c)
        corners[mesh.corner_vertices[c]].push_back(c);
    for (const auto& precision : names_of(Precision{})) {
        SCOPED_TRACE(precision.name);
        const VertexNormals ours = vertex_normals_of(mesh, precision.value);
        for (std::size_t v = 0; v < corners.size(); ++v) {
            EXPECT_NEAR(glm::length(glm::dvec3(ours.normals[v])), 1, 1e-7);
            if (corners[v].empty()) continue;
            const auto truth = oracle.sums(corners[v], false)[0];
            if (!truth.determined) continue;
            EXPECT_LE(angle_between(truth, ours.normals[v]), bound_of(precision.value) + 8e-8);
        }
    }
}

TEST(VertexNormals, AreTheExactSums) {
    for (const auto& cases : {hard_cases::measured(), hard_cases::odd()})
        for (const hard_cases::Case& one : cases) {
            SCOPED_TRACE(one.axis + " " + std::to_string(one.value));
            const Mesh mesh = shapes::fan_triangulated(one.mesh);
            const auto finite = [](const glm::vec3& p) {
                return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
            };
            if (!std::all_of(mesh.positions.begin(), mesh.positions.end(), finite)) continue;
            if (mesh.face_count() <= 300) expect_exact_sums(mesh);
        }
    std::mt19937_64 random(3);
    for (int n = 0; n < 30; ++n)
        expect_exact_sums(
            shapes::random_triangles(4 + std::size_t(n) % 40, 1 + std::size_t(n) % 12, random));
    expect_exact_sums(shapes::bow_tie());
    expect_exact_sums(shapes::book(5));
    expect_exact_sums(shapes::cube());
    // Floats leave their range.
    for (const float scale : {1e-18f, 1e-25f, 1e19f, 1e30f}) {
        Mesh mesh = shapes::icosphere(2);
        for (glm::vec3& p : mesh.positions) p *= scale;
        expect_exact_sums(mesh);
    }
}

TEST(VertexNormals, SayWhereNothingIsDetermined) {
    // Both sides of one triangle.
    const Mesh leaf =
        shapes::mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 5, 5}}, {{0, 1, 2}, {0, 2, 1}});
    for (const auto& precision : names_of(Precision{})) {
        const VertexNormals ours = vertex_normals_of(leaf, precision.value);
        ASSERT_EQ(ours.fallbacks.size(), 3u);
        for (std::uint32_t k = 0; k < 3; ++k) {
            EXPECT_EQ(ours.fallbacks[k].corner, k);
            EXPECT_EQ(ours.fallbacks[k].kind, prep::NormalFallback::largest_face);
        }
        EXPECT_EQ(ours.normals[3], glm::vec3(0, 0, 1));  // no face uses it
        EXPECT_EQ(ours.exact_sums, 3u);
    }
    // Among others, by the corners of the whole.
    const Mesh sphere = shapes::icosphere(2);
    const VertexNormals some = vertex_normals_of(shapes::joined(sphere, leaf));
    ASSERT_EQ(some.fallbacks.size(), 3u);
    for (std::uint32_t k = 0; k < 3; ++k)
        EXPECT_EQ(some.fallbacks[k].corner, sphere.corner_count() + k);
    const Mesh line = shapes::mesh_of({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}});
    const VertexNormals ours = vertex_normals_of(line);
    ASSERT_EQ(ours.fallbacks.size(), 3u);
    EXPECT_EQ(ours.fallbacks[0].kind, prep::NormalFallback::none_defined);
    EXPECT_EQ(ours.normals[1], glm::vec3(0, 0, 1));
    EXPECT_TRUE(vertex_normals_of(Mesh()).normals.empty());
}

#if defined(__linux__)
// Positions up to the end of what can be read at all.
TEST(VertexNormals, ReadNothingBehindThePositions) {
    const Mesh mesh = shapes::icosphere(2);
    const std::size_t page = std::size_t(sysconf(_SC_PAGESIZE));
    const std::size_t bytes = mesh.positions.size() * sizeof(glm::vec3);
    const std::size_t pages = (bytes + page - 1) / page * page;
    void* const memory =
        mmap(nullptr, pages + page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    ASSERT_NE(memory, MAP_FAILED);
    ASSERT_EQ(mprotect(static_cast<char*>(memory) + pages, page, PROT_NONE), 0);
    auto* const positions =
        reinterpret_cast<glm::vec3*>(static_cast<char*>(memory) + (pages - bytes));
    std::copy(mesh.positions.begin(), mesh.positions.end(), positions);
    MeshView view(mesh);
    view.positions = {positions, mesh.positions.size()};
    for (const Precision precision : {Precision::accurate, Precision::fast}) {
        VertexNormalOptions options;
        options.precision = precision;
        EXPECT_EQ(bits(prep::vertex_normals(view, options)->normals),
                  bits(vertex_normals_of(mesh, precision).normals));
    }
    munmap(memory, pages + page);
}
#endif

// What is not finite is as if it were not there.
TEST(VertexNormals, LeaveOutFacesThatAreNotFinite) {
    for (const float value :
         {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        Mesh broken = shapes::icosphere(3);
        broken.positions[7].y = value;
        Mesh without = broken;
        without.corner_vertices.clear();
        without.face_offsets = {0};
        for (std::size_t c = 0; c < broken.corner_count(); c += 3) {
            const std::span corners(broken.corner_vertices.data() + c, 3);
            if (std::find(corners.begin(), corners.end(), 7u) != corners.end()) continue;
            without.corner_vertices.insert(without.corner_vertices.end(), corners.begin(),
                                           corners.end());
            without.face_offsets.push_back(std::uint32_t(without.corner_vertices.size()));
        }
        EXPECT_EQ(bits(vertex_normals_of(broken).normals),
                  bits(vertex_normals_of(without).normals));
    }
}

// Fallbacks at the seam of ranges among them, and vertices that sums do not tell.
Mesh torus_with_leaves() {
    Mesh mesh = bumpy_torus(260, 190);
    for (const std::uint32_t v : {0u, 20'000u, 40'000u})
        for (const std::uint32_t corner : {0u, 1u, 2u, 0u, 2u, 1u}) {
            if (mesh.corner_count() % 6 == 0)
                for (const glm::vec3& p : {glm::vec3(0), glm::vec3(1, 2, 3), glm::vec3(3, 1, 2)})
                    mesh.positions.push_back(p + float(v));
            mesh.corner_vertices.push_back(std::uint32_t(mesh.positions.size()) - 3 + corner);
            if (mesh.corner_count() % 3 == 0)
                mesh.face_offsets.push_back(std::uint32_t(mesh.corner_count()));
        }
    return mesh;
}

TEST(VertexNormals, AreTheSameOnAnyThreadsAndInstructions) {
    for (const Mesh& mesh : {torus_with_leaves(), extrusion(1000, 40, 0.5f), tall_grid(448, 256)})
        for (const Precision precision : {Precision::accurate, Precision::fast}) {
            VertexNormalOptions options;
            options.precision = precision;
            options.threads = 1;
            options.simd = prep::SimdLevel::scalar;
            prep::detail::VertexNormalsPath first_path;
            const auto first = *prep::detail::vertex_normals(MeshView(mesh), options, first_path);
            for (const prep::SimdLevel level : test::every_level()) {
                for (const int threads : {1, 2, 8}) {
                    options.simd = level;
                    options.threads = threads;
                    prep::detail::VertexNormalsPath path;
                    const auto ours = *prep::detail::vertex_normals(MeshView(mesh), options, path);
                    EXPECT_EQ(bits(ours.normals), bits(first.normals));
                    EXPECT_TRUE(std::equal(ours.fallbacks.begin(), ours.fallbacks.end(),
                                           first.fallbacks.begin(), first.fallbacks.end(),
                                           [](const auto& a, const auto& b) {
                                               return a.corner == b.corner && a.kind == b.kind;
                                           }));
                    EXPECT_EQ(ours.exact_sums, first.exact_sums);
                    EXPECT_EQ(path.open_vertices, first_path.open_vertices);
                    EXPECT_EQ(path.by_corners, first_path.by_corners);
                }
            }
        }
    EXPECT_EQ(vertex_normals_of(torus_with_leaves()).fallbacks.size(), 9u);
}

// Accurate ones not at all; fast ones in their last bits.
TEST(VertexNormals, DependLittleOnTheOrderOfTriangles) {
    const Mesh mesh = bumpy_torus(200, 120);
    std::vector<std::uint32_t> order(mesh.face_count());
    std::iota(order.begin(), order.end(), 0u);
    std::vector<std::vector<std::uint32_t>> orders;
    orders.emplace_back(order.rbegin(), order.rend());
    std::mt19937_64 random(7);
    for (std::size_t i = 0; i + 20 < order.size(); i += 20)
        std::shuffle(order.begin() + std::ptrdiff_t(i), order.begin() + std::ptrdiff_t(i + 20),
                     random);
    orders.push_back(order);
    std::shuffle(order.begin(), order.end(), random);
    orders.push_back(order);
    const VertexNormals accurate = vertex_normals_of(mesh),
                        fast = vertex_normals_of(mesh, Precision::fast);
    for (const auto& one : orders) {
        const Mesh other = shapes::with_face_order(mesh, one);
        EXPECT_EQ(bits(vertex_normals_of(other).normals), bits(accurate.normals));
        const VertexNormals changed = vertex_normals_of(other, Precision::fast);
        for (std::size_t v = 0; v < mesh.vertex_count(); ++v)
            EXPECT_LT(glm::length(changed.normals[v] - fast.normals[v]),
                      2 * float(prep::fast_normal_error));
    }
}

}  // namespace
