#include "surface/recover_quads.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "shapes.h"

namespace {

using prep::detail::recover_quads;
using prep::detail::RecoveredQuads;

std::size_t quads_of(const prep::Mesh& mesh) {
    std::size_t quads = 0;
    for (std::size_t f = 0; f < mesh.face_count(); ++f)
        quads += mesh.face_offsets[f + 1] - mesh.face_offsets[f] == 4;
    return quads;
}

// The same corners around each face, wherever it begins.
std::vector<std::vector<std::uint32_t>> faces_of(const prep::Mesh& mesh) {
    std::vector<std::vector<std::uint32_t>> faces;
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
        std::vector<std::uint32_t> face(mesh.corner_vertices.begin() + mesh.face_offsets[f],
                                        mesh.corner_vertices.begin() + mesh.face_offsets[f + 1]);
        std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
        faces.push_back(std::move(face));
    }
    std::sort(faces.begin(), faces.end());
    return faces;
}

TEST(RecoverQuads, TriangulatedGridsAndCubesAreQuadsAgainWhateverTheDiagonals) {
    std::mt19937_64 random(3);
    for (const prep::Mesh& quads : {shapes::grid(7, 5), shapes::cube(), shapes::torus(24, 12)})
        for (const std::uint32_t first : {0U, 1U, 2U}) {
            prep::Mesh mesh = shapes::fan_triangulated(quads, first);
            mesh = shapes::with_face_order(mesh, shapes::random_order(mesh.face_count(), random));
            const RecoveredQuads found = recover_quads(mesh);
            EXPECT_EQ(found.quads, quads.face_count());
            EXPECT_EQ(found.ambiguous + found.alone, 0U);
            EXPECT_EQ(faces_of(mesh), faces_of(quads));
        }
}

TEST(RecoverQuads, NetsOfEquilateralTrianglesStay) {
    prep::Mesh mesh = shapes::icosphere(0);
    const RecoveredQuads found = recover_quads(mesh);
    EXPECT_EQ(found.quads, 0U);
    EXPECT_EQ(found.ambiguous + found.alone, 20U);
    EXPECT_EQ(quads_of(mesh), 0U);
    EXPECT_FALSE(found.places.empty());
}

TEST(RecoverQuads, NothingIsJoinedAcrossSeamsMaterialsAndFolds) {
    const prep::Mesh grid = shapes::fan_triangulated(shapes::grid(1, 1));
    {
        prep::Mesh mesh = grid;
        mesh.face_materials = {0, 1};
        EXPECT_EQ(recover_quads(mesh).quads, 0U);
        mesh.face_materials = {1, 1};
        EXPECT_EQ(recover_quads(mesh).quads, 1U);
    }
    {
        prep::Mesh mesh = grid;
        mesh.uvs.resize(1);
        for (std::uint32_t c = 0; c < 6; ++c) {
            mesh.uvs[0].values.emplace_back(float(c), 0.0F);
            mesh.uvs[0].indices.push_back(c);
        }
        EXPECT_EQ(recover_quads(mesh).quads, 0U);
        for (std::uint32_t c = 0; c < 6; ++c)
            mesh.uvs[0].values[c] = glm::vec2(mesh.positions[mesh.corner_vertices[c]]);
        EXPECT_EQ(recover_quads(mesh).quads, 1U);
        // Layers follow their corners.
        for (std::uint32_t c = 0; c < 4; ++c)
            EXPECT_EQ(mesh.uvs[0].values[mesh.uvs[0].indices[c]],
                      glm::vec2(mesh.positions[mesh.corner_vertices[c]]));
    }
    {
        prep::Mesh mesh = grid;
        mesh.positions[3].z = 2;  // folded by more than 45 degrees
        EXPECT_EQ(recover_quads(mesh).quads, 0U);
    }
    {
        prep::Mesh dart = shapes::mesh_of({{0, 0, 0}, {2, 0, 0}, {0.2F, 0.2F, 0}, {0, 2, 0}},
                                          {{0, 1, 2}, {0, 2, 3}});  // a concave quad
        EXPECT_EQ(recover_quads(dart).quads, 0U);
    }
}

TEST(RecoverQuads, CreasesMarksHolesAndAttributesKeepTheirDiagonal) {
    const prep::Mesh grid = shapes::fan_triangulated(shapes::grid(1, 1));
    // The edge that both triangles have.
    std::vector<std::uint32_t> shared;
    for (std::uint32_t c = 0; c < 3; ++c)
        for (std::uint32_t d = 3; d < 6; ++d)
            if (grid.corner_vertices[c] == grid.corner_vertices[d])
                shared.push_back(grid.corner_vertices[c]);
    ASSERT_EQ(shared.size(), 2U);
    prep::Mesh creased = grid;
    creased.subdivision.creases.push_back({shared[1], shared[0], 2.0F});
    EXPECT_EQ(recover_quads(creased).quads, 0U);
    prep::Mesh marked = grid;
    marked.hard_marks.push_back({shared[0], shared[1]});
    EXPECT_EQ(recover_quads(marked).quads, 0U);
    prep::Mesh hole = grid;
    hole.subdivision.holes = {1};
    EXPECT_EQ(recover_quads(hole).quads, 0U);
    hole.subdivision.holes = {0, 1, 77};  // 77: out of range, which others tell
    EXPECT_EQ(recover_quads(hole).quads, 1U);
    // The file has vertices of its own for each triangle, which differ in a number of theirs.
    prep::Mesh heat = grid;
    heat.corner_file_vertices = {0, 1, 2, 3, 4, 5};
    heat.vertex_attributes.push_back({"_HEAT", 1, {0, 0, 0, 1, 1, 1}});
    EXPECT_EQ(recover_quads(heat).quads, 0U);
    heat = grid;
    heat.corner_file_vertices = {0, 1, 2, 3, 4, 5};
    heat.vertex_attributes.push_back({"_HEAT", 1, {5, 5, 5, 5, 5, 5}});
    EXPECT_EQ(recover_quads(heat).quads, 1U);
}

TEST(RecoverQuads, EmptyAndOtherFacesStay) {
    prep::Mesh nothing;
    EXPECT_EQ(recover_quads(nothing).quads, 0U);
    prep::Mesh prism = shapes::cylinder(6);
    const auto before = faces_of(prism);
    EXPECT_EQ(recover_quads(prism).quads, 0U);
    EXPECT_EQ(faces_of(prism), before);
}

}  // namespace
