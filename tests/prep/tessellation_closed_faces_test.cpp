// Where tessellation starts: a triangle as one, a quad as two along the diagonal that the
// surface and its shape ask for, whatever the order of corners, faces and vertices; as closed as
// the cage; with bounds that hold.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <set>

#include "prep/displacement/tessellate.h"
#include "tessellation_checks.h"

namespace prep {
namespace {

using namespace tessellation_checks;

// The triangles of a mesh as sets of three positions.
using Triangle = std::array<std::array<float, 3>, 3>;
std::multiset<Triangle> triangles_of(const Mesh& mesh) {
    std::multiset<Triangle> all;
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
        Triangle t;
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::vec3& p = mesh.positions[mesh.corner_vertices[3 * f + k]];
            t[k] = {p.x, p.y, p.z};
        }
        std::sort(t.begin(), t.end());
        all.insert(t);
    }
    return all;
}

TessellatedMesh coarsest(const Mesh& mesh, std::optional<SubdivisionScheme> scheme = {}) {
    TessellateOptions options;
    options.max_triangles = 1;
    options.scheme = scheme;
    auto made = tessellate(mesh, options);
    EXPECT_TRUE(made) << to_string(made.error());
    return *std::move(made);
}

// Rows of quads over a plane, parallelograms of any shape.
Mesh sheared_grid(std::uint32_t n, const glm::vec3& along, const glm::vec3& up) {
    Mesh mesh;
    for (std::uint32_t j = 0; j <= n; ++j)
        for (std::uint32_t i = 0; i <= n; ++i)
            mesh.positions.push_back(float(i) * along + float(j) * up);
    for (std::uint32_t j = 0; j < n; ++j)
        for (std::uint32_t i = 0; i < n; ++i) {
            const std::uint32_t a = j * (n + 1) + i;
            add_face(mesh, {a, a + 1, a + n + 2, a + n + 1});
        }
    return mesh;
}

TEST(TessellationClosedFaces, FlatOnesTakeAsFewTrianglesAsTheyMay) {
    TessellateOptions options;
    options.chord_error = 1e-4;
    const auto grid = tessellate(sheared_grid(8, {1, 0, 0}, {0.25F, 1, 0.5F}), options);
    ASSERT_TRUE(grid);
    EXPECT_EQ(grid->mesh.face_count(), 2U * 8 * 8);
    EXPECT_LE(grid->certificate.proved, 1e-6);  // roundings of corners
    Mesh triangle;
    triangle.positions = {{0, 0, 0}, {3, 0, 1}, {1, 2, 0}};
    add_face(triangle, {0, 1, 2});
    const auto one = tessellate(triangle, options);
    ASSERT_TRUE(one);
    EXPECT_EQ(one->mesh.face_count(), 1U);
    EXPECT_EQ(triangles_of(one->mesh), triangles_of(triangle));
}

// The shorter diagonal; of a square's the one at the corner that is the least.
TEST(TessellationClosedFaces, QuadsAreCutAlongTheirShorterDiagonal) {
    for (const auto scheme :
         {std::optional<SubdivisionScheme>(), std::optional(SubdivisionScheme::bilinear)}) {
        const Mesh slanted = sheared_grid(1, {1, 0, 0}, {0.5F, 1, 0});
        const std::multiset<Triangle> cut = triangles_of(coarsest(slanted, scheme).mesh);
        EXPECT_EQ(cut.count({{{0, 0, 0}, {0.5F, 1, 0}, {1, 0, 0}}}), 1U);
        EXPECT_EQ(cut.count({{{0.5F, 1, 0}, {1, 0, 0}, {1.5F, 1, 0}}}), 1U);
        const Mesh square = sheared_grid(1, {1, 0, 0}, {0, 1, 0});
        const std::multiset<Triangle> halves = triangles_of(coarsest(square, scheme).mesh);
        EXPECT_EQ(halves.count({{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}}), 1U);
        EXPECT_EQ(halves.count({{{0, 0, 0}, {0, 1, 0}, {1, 1, 0}}}), 1U);
    }
}

// Of parallelograms in a plane both diagonals are on the surface, but for roundings.
TEST(TessellationClosedFaces, RoundingsDoNotChooseDiagonals) {
    const glm::vec3 along(0.7F, 0.1F, 0.3F), up(0.2F, 0.9F, 0.1F);
    constexpr std::uint32_t n = 12;
    for (const auto scheme :
         {std::optional<SubdivisionScheme>(), std::optional(SubdivisionScheme::bilinear)}) {
        const TessellatedMesh made = coarsest(sheared_grid(n, along, up), scheme);
        ASSERT_EQ(made.mesh.face_count(), std::size_t(2 * n * n));
        const float shorter = glm::length(up - along);
        ASSERT_LT(1.2F * shorter, glm::length(up + along));
        for (std::size_t f = 0; f < made.mesh.face_count(); ++f) {
            float longest = 0;
            for (std::size_t k = 0; k < 3; ++k) {
                const auto at = [&](std::size_t c) {
                    return made.mesh.positions[made.mesh.corner_vertices[3 * f + c % 3]];
                };
                longest = std::max(longest, glm::length(at(k + 1) - at(k)));
            }
            EXPECT_NEAR(longest, shorter, 1e-4F) << f;
        }
    }
}

// Two corners up, two down, the centre between them: which diagonal is nearer to the surface is for
// the height to say.
TEST(TessellationClosedFaces, QuadsAreCutAlongTheDiagonalNearerToTheSurface) {
    Mesh saddle;
    saddle.positions = {{0, 0, 1}, {1, 0, 0}, {1, 1, 1}, {0, 1, 0}};
    add_face(saddle, {0, 1, 2, 3});
    saddle.uvs.assign(1, {});
    saddle.uvs[0].values = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    saddle.uvs[0].indices = {0, 1, 2, 3};
    const auto bump = std::make_shared<Spike>(31, 15, 15, 0.25);  // 0 but about the centre
    for (const double scale : {1.0, -1.0}) {
        TessellateOptions options;
        options.max_triangles = 2;
        options.displacements = {{.height = bump, .scale = scale}};
        const auto made = tessellate(saddle, options);
        ASSERT_TRUE(made) << to_string(made.error());
        const std::multiset<Triangle> cut = triangles_of(made->mesh);
        EXPECT_EQ(cut.size(), 2U);
        // The last corner of one, the first of the other.
        EXPECT_EQ(cut.count({{{0, 0, 1}, {0, 1, 0}, {1, 1, 1}}}), scale > 0 ? 1U : 0U) << scale;
        EXPECT_EQ(cut.count({{{0, 0, 1}, {0, 1, 0}, {1, 0, 0}}}), scale < 0 ? 1U : 0U) << scale;
    }
}

// This arrow's longer diagonal is the one within it.
TEST(TessellationClosedFaces, QuadsThatAreNotConvexAreCutWithin) {
    Mesh arrow;
    arrow.positions = {{0, 0, 0}, {-2, -1, 0}, {9, 0, 0}, {-2, 1, 0}};
    add_face(arrow, {0, 1, 2, 3});
    Mesh turned;
    turned.positions = arrow.positions;
    add_face(turned, {1, 2, 3, 0});
    for (const Mesh& mesh : {arrow, turned}) {
        const TessellatedMesh made = coarsest(mesh);
        for (std::size_t f = 0; f < made.mesh.face_count(); ++f) {
            std::array<glm::vec3, 3> p;
            for (std::size_t k = 0; k < 3; ++k)
                p[k] = made.mesh.positions[made.mesh.corner_vertices[3 * f + k]];
            EXPECT_GT(glm::cross(p[1] - p[0], p[2] - p[0]).z, 0) << f;
        }
    }
}

// The same quads with other numbers of corners, faces and vertices.
struct Renumbered {
    Mesh mesh;
    std::vector<std::uint32_t> number;  // by vertex of the original
};
Renumbered renumbered(const Mesh& cage, std::mt19937& random) {
    std::vector<std::uint32_t> faces(cage.face_count());
    std::iota(faces.begin(), faces.end(), 0U);
    std::shuffle(faces.begin(), faces.end(), random);
    Renumbered other;
    other.number.resize(cage.vertex_count());
    std::iota(other.number.begin(), other.number.end(), 0U);
    std::shuffle(other.number.begin(), other.number.end(), random);
    other.mesh.positions.resize(cage.positions.size());
    for (std::uint32_t v = 0; v < cage.vertex_count(); ++v)
        other.mesh.positions[other.number[v]] = cage.positions[v];
    for (const std::uint32_t f : faces) {
        const std::uint32_t turn = std::uint32_t(random() % 4);
        std::vector<std::uint32_t> face;
        for (std::uint32_t k = 0; k < 4; ++k)
            face.push_back(other.number[cage.corner_vertices[4 * f + (k + turn) % 4]]);
        add_face(other.mesh, face);
    }
    return other;
}

TEST(TessellationClosedFaces, NumbersOfCornersFacesAndVerticesDoNotMatter) {
    std::mt19937 random(31);
    std::uniform_int_distribution<int> step(-3, 3);  // many diagonals of equal length
    int differ = 0;
    for (int round = 0; round < 40; ++round) {
        Mesh cage = torus(5, 4);
        for (glm::vec3& p : cage.positions)
            p = glm::round(4.0F * p) + glm::vec3(step(random), step(random), step(random)) / 3.0F;
        const Mesh other = renumbered(cage, random).mesh;
        const std::multiset<Triangle> one = triangles_of(coarsest(cage).mesh);
        EXPECT_EQ(one.size(), 2 * cage.face_count());
        EXPECT_EQ(one, triangles_of(coarsest(other).mesh)) << round;
        std::multiset<Triangle> as_numbered;
        for (std::size_t f = 0; f < cage.face_count(); ++f)
            for (const std::array<std::uint32_t, 3> half : {std::array{0U, 1U, 2U}, {0U, 2U, 3U}}) {
                Triangle t;
                for (std::size_t k = 0; k < 3; ++k) {
                    const glm::vec3& p = cage.positions[cage.corner_vertices[4 * f + half[k]]];
                    t[k] = {p.x, p.y, p.z};
                }
                std::sort(t.begin(), t.end());
                as_numbered.insert(t);
            }
        differ += one != as_numbered;
    }
    EXPECT_EQ(differ, 40);
}

// Nor where the surface chooses the diagonals.
TEST(TessellationClosedFaces, NumbersDoNotMatterToDiagonalsNearerToTheSurface) {
    using Edge = std::pair<std::uint32_t, std::uint32_t>;
    const auto edges = [](const TessellatedMesh& made, const std::vector<std::uint32_t>& number) {
        std::vector<std::uint32_t> original(number.size());
        for (std::uint32_t v = 0; v < number.size(); ++v) original[number[v]] = v;
        std::set<Edge> result;
        for (std::size_t c = 0; c < made.mesh.corner_count(); ++c) {
            const std::size_t next = c % 3 == 2 ? c - 2 : c + 1;
            const auto at = [&](std::size_t k) {
                return original.at(made.cage_vertices[made.mesh.corner_vertices[k]]);
            };
            result.insert(std::minmax(at(c), at(next)));
        }
        return result;
    };
    std::mt19937 random(32);
    std::uniform_real_distribution<float> step(-0.3F, 0.3F);
    NoiseOptions noise{.frequency = 2, .octaves = 2, .seed = 5};
    noise.scale = 0.3;
    const auto function = noise_function(noise);
    ASSERT_TRUE(function);
    std::size_t by_surface = 0;
    for (int round = 0; round < 20; ++round) {
        Mesh cage = torus(5, 4);
        for (glm::vec3& p : cage.positions)
            p += glm::vec3(step(random), step(random), step(random));
        const Renumbered other = renumbered(cage, random);
        std::vector<std::uint32_t> same(cage.vertex_count());
        std::iota(same.begin(), same.end(), 0U);
        TessellateOptions options;
        options.max_triangles = 2 * cage.face_count();
        const auto flat = tessellate(cage, options);
        if (round % 2 == 0) options.scheme = SubdivisionScheme::catmark;
        options.displacements = {{.height = nullptr, .noise = *function}};
        const auto one = tessellate(cage, options), two = tessellate(other.mesh, options);
        ASSERT_TRUE(flat && one && two);
        for (const auto* made : {&*flat, &*one, &*two})
            ASSERT_EQ(made->mesh.face_count(), 2 * cage.face_count());
        EXPECT_EQ(edges(*one, same), edges(*two, other.number)) << round;
        by_surface += edges(*one, same) != edges(*flat, same);
    }
    EXPECT_GT(by_surface, 15U);
}

std::size_t most_at_an_edge(const Mesh& mesh) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::size_t> edges;
    std::size_t most = 0;
    for (std::size_t c = 0; c < mesh.corner_count(); ++c) {
        const std::uint32_t a = mesh.corner_vertices[c];
        const std::uint32_t b = mesh.corner_vertices[c % 3 == 2 ? c - 2 : c + 1];
        most = std::max(most, ++edges[std::minmax(a, b)]);
    }
    return most;
}

// Diagonals that are edges of other faces, or of two faces, would be edges of four triangles.
TEST(TessellationClosedFaces, DiagonalsAreNobodyElsesEdges) {
    Mesh pillow = unit_quad();
    pillow.uvs.clear();
    pillow.positions[1].z = pillow.positions[3].z = 0.25F;
    add_face(pillow, {3, 2, 1, 0});
    EXPECT_EQ(most_at_an_edge(coarsest(pillow).mesh), 2U);
    // A tetrahedron two of whose faces are one quad: its diagonals are edges of the others.
    Mesh bent;
    bent.positions = {{0, 0, 0}, {1, 0, 0}, {0.9F, 0.9F, 0.25F}, {0, 1, 0}};
    add_face(bent, {0, 1, 2, 3});
    add_face(bent, {0, 2, 1});
    add_face(bent, {0, 3, 2});
    const Mesh made = coarsest(bent).mesh;
    EXPECT_EQ(most_at_an_edge(made), 2U);
    EXPECT_EQ(made.face_count(), 4U + 1 + 1);
}

// Charts of many sizes, so that some faces are halved often: their neighbours are closed, opened
// and halved as it asks, and all of it stays closed.
TEST(TessellationClosedFaces, MeetFinerFacesWithoutGaps) {
    std::mt19937 random(8);
    for (int round = 0; round < 12; ++round) {
        Mesh cage = round % 3 == 0 ? cube() : round % 3 == 1 ? torus(7, 5) : prism(5);
        if (round % 2 == 1) {  // half of the quads as triangles
            Mesh mixed;
            mixed.positions = cage.positions;
            for (std::size_t f = 0; f < cage.face_count(); ++f) {
                const auto at = [&](std::uint32_t k) {
                    return cage.corner_vertices[cage.face_offsets[f] + k];
                };
                const std::uint32_t n = cage.face_offsets[f + 1] - cage.face_offsets[f];
                std::vector<std::uint32_t> all;
                for (std::uint32_t k = 0; k < n; ++k) all.push_back(at(k));
                if (n == 4 && random() % 2 == 0) {
                    add_face(mixed, {at(0), at(1), at(2)});
                    add_face(mixed, {at(0), at(2), at(3)});
                } else {
                    add_face(mixed, all);
                }
            }
            cage = std::move(mixed);
        }
        add_charts(cage, random);
        for (const bool limit : {false, true}) {
            TessellateOptions options;
            options.displacements = {{std::make_shared<Waves>(0.3, 9, 7, round), 1, 0, 0}};
            options.chord_error = 0.15;
            if (limit) options.scheme = SubdivisionScheme::catmark;
            options.samples = 5000;
            const auto made = tessellate(cage, options);
            ASSERT_TRUE(made) << to_string(made.error());
            const Closedness closed = closedness(made->mesh), of_cage = closedness(cage);
            EXPECT_EQ(closed.open_edges, 0U) << round;
            EXPECT_EQ(closed.euler, of_cage.euler) << round;
            EXPECT_LE(made->certificate.measured, made->certificate.proved) << round;
            options.threads = 1;
            const auto alone = tessellate(cage, options);
            options.threads = 3;
            const auto three = tessellate(cage, options);
            ASSERT_TRUE(alone && three);
            EXPECT_TRUE(same_bytes(alone->mesh, three->mesh)) << round;
        }
    }
}

// Closed faces under noise, which are bounded by parts: all of their roots at once, beside what
// their centre bends.
TEST(TessellationClosedFaces, BoundsByPartsHoldAndAreClose) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> number(-0.15, 0.15);
    std::vector<double> ratios;
    for (int round = 0; round < 10; ++round) {
        Mesh cage = round % 2 == 0 ? torus(5, 4) : prism(5);
        for (glm::vec3& p : cage.positions)
            p += glm::vec3(number(random), number(random), number(random));
        for (const bool limit : {false, true}) {
            NoiseOptions noise{.frequency = 0.7, .octaves = 3, .seed = std::uint32_t(round)};
            noise.scale = 0.2;
            const auto function = noise_function(noise);
            ASSERT_TRUE(function);
            TessellateOptions options;
            options.displacements = {{.height = nullptr, .noise = *function}};
            options.max_triangles = 1;
            if (limit) options.scheme = SubdivisionScheme::catmark;
            options.samples = 100000;
            const auto made = tessellate(cage, options);
            ASSERT_TRUE(made) << to_string(made.error());
            EXPECT_LE(made->certificate.measured, made->certificate.proved) << round << limit;
            ratios.push_back(made->certificate.proved / made->certificate.measured);
        }
    }
    std::sort(ratios.begin(), ratios.end());
    std::printf("proved over measured: median %.3f, largest %.3f\n", ratios[ratios.size() / 2],
                ratios.back());
    EXPECT_LE(ratios[ratios.size() / 2], 1.5);
}

// The coarsest triangles of quads that are neither plane nor parallelograms, with UVs that are not
// affine either, under heights: far off, and never farther than is proved.
TEST(TessellationClosedFaces, BoundsHoldAndAreClose) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> number(-1, 1);
    std::vector<double> ratios;
    for (int round = 0; round < 60; ++round) {
        Mesh cage = round % 2 == 0 ? torus(5, 4) : prism(3);
        for (glm::vec3& p : cage.positions)
            p += glm::vec3(0.3 * number(random), 0.3 * number(random), 0.3 * number(random));
        add_charts(cage, random);
        for (glm::vec2& uv : cage.uvs[0].values)
            uv += glm::vec2(0.2 * number(random), 0.2 * number(random));
        for (const bool limit : {false, true}) {
            TessellateOptions options;
            options.displacements = {{std::make_shared<Waves>(0.2, 1.5, 1, round), 1, 0, 0}};
            options.max_triangles = 1;
            if (limit) options.scheme = SubdivisionScheme::catmark;
            options.samples = 50000;
            const auto made = tessellate(cage, options);
            ASSERT_TRUE(made) << to_string(made.error());
            if (round % 2 == 0) {
                EXPECT_EQ(made->mesh.face_count(), 2 * cage.face_count());
            }
            EXPECT_LE(made->certificate.measured, made->certificate.proved) << round << limit;
            ratios.push_back(made->certificate.proved / made->certificate.measured);
        }
    }
    std::sort(ratios.begin(), ratios.end());
    const double median = ratios[ratios.size() / 2];
    std::printf("proved over measured: median %.2f, largest %.2f\n", median, ratios.back());
    EXPECT_LE(median, 4);
}

// Layers, marks and names of cage vertices at corners of closed faces are the cage's own.
TEST(TessellationClosedFaces, CarryWhatTheirCageHas) {
    std::mt19937 random(3);
    Mesh cage = prism(3);
    add_charts(cage, random);
    for (const glm::uvec2 mark : {glm::uvec2(0, 1), glm::uvec2(3, 1), glm::uvec2(2, 4)})
        cage.hard_marks.push_back(mark);
    const TessellatedMesh made = coarsest(cage);
    EXPECT_EQ(made.mesh.face_count(), 2U + 3 * 2);
    std::set<std::pair<std::uint32_t, std::uint32_t>> marked;
    for (const glm::uvec2& m : made.mesh.hard_marks)
        marked.insert(std::minmax(made.cage_vertices[m.x], made.cage_vertices[m.y]));
    EXPECT_EQ(marked, (std::set<std::pair<std::uint32_t, std::uint32_t>>{{0, 1}, {1, 3}, {2, 4}}));
    for (std::size_t c = 0; c < made.mesh.corner_count(); ++c) {
        const std::uint32_t face = made.cage_faces[c / 3];
        const std::uint32_t vertex = made.cage_vertices[made.mesh.corner_vertices[c]];
        bool found = false;
        for (std::uint32_t k = cage.face_offsets[face]; k < cage.face_offsets[face + 1]; ++k) {
            if (cage.corner_vertices[k] != vertex) continue;
            found = true;
            EXPECT_EQ(made.mesh.uvs[0].values[made.mesh.uvs[0].indices[c]],
                      cage.uvs[0].values[cage.uvs[0].indices[k]]);
        }
        EXPECT_TRUE(found) << c;
    }
}

}  // namespace
}  // namespace prep
