#include "prep/topology.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "shapes.h"
#include "steps.h"

namespace {

using prep::EdgeKind;
using prep::Mesh;
using prep::MeshView;
using prep::no_index;
using prep::Topology;
using Indices = std::vector<std::uint32_t>;

Topology topology_of(const Mesh& mesh, bool weld = false, int threads = 0) {
    const MeshView view(mesh);
    return prep::build_topology(view, weld ? prep::weld_exact(view.positions, threads) : Indices{},
                                threads);
}

std::size_t count(const Topology& t, EdgeKind kind) {
    return std::size_t(std::count(t.kinds.begin(), t.kinds.end(), kind));
}

// Every opposite is mutual, joins the same two points in the other direction, and only interior
// edges have one.
void expect_consistent(const Mesh& mesh, const Topology& t) {
    for (std::uint32_t c = 0; c < mesh.corner_count(); ++c) {
        const std::uint32_t o = t.opposite[c];
        ASSERT_EQ(o != no_index, t.kinds[c] == EdgeKind::interior) << c;
        if (o == no_index) continue;
        EXPECT_EQ(t.opposite[o], c);
        const auto point = [&](std::uint32_t k) { return t.welded[mesh.corner_vertices[k]]; };
        EXPECT_EQ(point(c), point(prep::next_corner(mesh.face_offsets, t.corner_faces[o], o)));
        EXPECT_EQ(point(o), point(prep::next_corner(mesh.face_offsets, t.corner_faces[c], c)));
    }
    ASSERT_EQ(t.point_offsets.size(), mesh.vertex_count() + 1);
    Indices seen;
    for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v)
        for (std::uint32_t i = t.point_offsets[v]; i < t.point_offsets[v + 1]; ++i) {
            EXPECT_EQ(t.welded[mesh.corner_vertices[t.point_corners[i]]], v);
            if (i > t.point_offsets[v]) {
                EXPECT_LT(t.point_corners[i - 1], t.point_corners[i]);
            }
            seen.push_back(t.point_corners[i]);
        }
    std::sort(seen.begin(), seen.end());
    ASSERT_EQ(seen.size(), mesh.corner_count());
    for (std::uint32_t c = 0; c < seen.size(); ++c) EXPECT_EQ(seen[c], c);
}

TEST(Topology, EmptyMesh) {
    const Topology t = topology_of(Mesh{});
    EXPECT_TRUE(t.opposite.empty());
    EXPECT_EQ(t.point_offsets, Indices{0});
}

TEST(Topology, OneTriangleIsAllBorder) {
    const Mesh mesh = shapes::polygon({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    const Topology t = topology_of(mesh);
    EXPECT_EQ(count(t, EdgeKind::border), 3u);
    expect_consistent(mesh, t);
}

TEST(Topology, CubeIsClosed) {
    const Mesh mesh = shapes::cube();
    const Topology t = topology_of(mesh);
    EXPECT_EQ(count(t, EdgeKind::interior), 24u);
    EXPECT_EQ(t.point_corners.size(), 24u);
    EXPECT_EQ(t.corner_faces[23], 5u);
    expect_consistent(mesh, t);
}

TEST(Topology, WeldedSoupHasTheSameEdges) {
    const Mesh soup = shapes::soup(shapes::cube());
    EXPECT_EQ(count(topology_of(soup), EdgeKind::border), 24u);
    const Topology t = topology_of(soup, true);
    EXPECT_EQ(t.opposite, topology_of(shapes::cube()).opposite);
    expect_consistent(soup, t);
}

TEST(Topology, ThreeFacesOnAnEdgeAreNonManifold) {
    for (const bool alternating : {false, true})
        for (const std::uint32_t faces : {3u, 4u, 64u}) {
            const Mesh mesh = shapes::book(faces, alternating);
            const Topology t = topology_of(mesh);
            EXPECT_EQ(count(t, EdgeKind::non_manifold), faces);
            EXPECT_EQ(count(t, EdgeKind::border), 2 * faces);
            expect_consistent(mesh, t);
        }
}

TEST(Topology, TwoFacesOfTheSameDirectionAreInconsistent) {
    const Topology t = topology_of(shapes::book(2, false));
    EXPECT_EQ(count(t, EdgeKind::inconsistent), 2u);
    EXPECT_EQ(t.opposite[0], no_index);
}

TEST(Topology, MoebiusStripHasOneInconsistentEdge) {
    const Mesh mesh = shapes::moebius(10);
    const Topology t = topology_of(mesh);
    EXPECT_EQ(count(t, EdgeKind::inconsistent), 2u);
    EXPECT_EQ(count(t, EdgeKind::interior), 18u);
    EXPECT_EQ(count(t, EdgeKind::border), 20u);
    expect_consistent(mesh, t);
}

TEST(Topology, FileVerticesPairBeforeWeldedOnes) {
    // Two coincident sheets back to back, each with vertices of its own: every sheet's inner edge
    // stays its own, the rims meet.
    Mesh front = shapes::grid(2, 1), back = front;
    for (std::uint32_t f = 0; f < 2; ++f)
        std::reverse(back.corner_vertices.begin() + 4 * f,
                     back.corner_vertices.begin() + 4 * f + 4);
    const Mesh mesh = shapes::joined(front, back);
    const Topology t = topology_of(mesh, true);
    EXPECT_EQ(count(t, EdgeKind::interior), 16u);
    for (std::uint32_t c = 0; c < 8; ++c)
        if (t.corner_faces[t.opposite[c]] < 2) {
            EXPECT_NE(t.corner_faces[t.opposite[c]], c / 4);
        }
    EXPECT_LT(t.opposite[1], 8u);  // face 0's edge to face 1
    EXPECT_GE(t.opposite[0], 8u);  // a rim edge
    expect_consistent(mesh, t);
}

TEST(Topology, EmptyTriangleBetweenTwoFacesIsASlitNotAnObstacle) {
    // 0–1 is used by a face on either side and there and back by the empty triangle (0, 1, 1).
    const Mesh mesh = shapes::mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}},
                                      {{0, 1, 2}, {1, 0, 3}, {0, 1, 1}});
    const Topology t = topology_of(mesh);
    expect_consistent(mesh, t);
    EXPECT_EQ(t.corner_faces[t.opposite[0]], 2u);
    EXPECT_EQ(t.corner_faces[t.opposite[3]], 2u);
    EXPECT_EQ(t.kinds[7], EdgeKind::degenerate);
    EXPECT_EQ(count(t, EdgeKind::non_manifold), 0u);
}

TEST(Topology, ManyEmptyTrianglesFormAChain) {
    shapes::Faces faces{{0, 1, 2}, {1, 0, 3}};
    for (int i = 0; i < 5; ++i) faces.push_back({1, 0, 0});
    const Mesh mesh = shapes::mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}}, faces);
    const Topology t = topology_of(mesh);
    expect_consistent(mesh, t);
    EXPECT_EQ(count(t, EdgeKind::non_manifold), 0u);
    EXPECT_EQ(count(t, EdgeKind::degenerate), 5u);
    EXPECT_EQ(count(t, EdgeKind::interior), 12u);
    // From face 0 over the chain, entering by one side and leaving by the other, to face 1.
    std::uint32_t c = t.opposite[0];
    int empty = 0;
    while (t.corner_faces[c] >= 2 && empty < 10) {
        ++empty;
        do c = prep::next_corner(mesh.face_offsets, t.corner_faces[c], c);
        while (t.kinds[c] == EdgeKind::degenerate);
        c = t.opposite[c];
    }
    EXPECT_EQ(empty, 5);
    EXPECT_EQ(t.corner_faces[c], 1u);
}

TEST(Topology, EmptyTrianglesOpenNoSurface) {
    // On an edge of one direction, on one of four faces, and where nothing else is: each is closed
    // in itself, and the edge is what it is without them.
    for (const std::uint32_t pages : {2u, 4u, 0u})
        for (const int empties : {1, 2, 3}) {
            SCOPED_TRACE(testing::Message() << pages << " faces, " << empties << " empty ones");
            shapes::Faces faces;
            std::vector<glm::vec3> points{{0, 0, 0}, {1, 0, 0}};
            for (std::uint32_t f = 0; f < pages; ++f) {
                points.emplace_back(0, f + 1, f * f);
                faces.push_back({0, 1, f + 2});
            }
            for (int i = 0; i < empties; ++i) faces.push_back({1, 0, 0});
            const Mesh mesh = shapes::mesh_of(points, faces);
            const Topology t = topology_of(mesh);
            expect_consistent(mesh, t);
            EXPECT_EQ(count(t, EdgeKind::border), 2 * pages);
            EXPECT_EQ(count(t, EdgeKind::interior), 2u * empties);
            EXPECT_EQ(count(t, EdgeKind::inconsistent), pages == 2 ? 2u : 0u);
            EXPECT_EQ(count(t, EdgeKind::non_manifold), pages == 4 ? 4u : 0u);
        }
}

TEST(Topology, FaceOfOnePointIsAllDegenerate) {
    const Mesh mesh = shapes::mesh_of({{0, 0, 0}}, {{0, 0, 0}});
    const Topology t = topology_of(mesh);
    EXPECT_EQ(count(t, EdgeKind::degenerate), 3u);
    expect_consistent(mesh, t);
}

TEST(Topology, NanPositionsWeldWithNothing) {
    Mesh mesh = shapes::soup(shapes::cube());
    for (auto& p : mesh.positions) p.x = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(count(topology_of(mesh, true), EdgeKind::border), 24u);
}

TEST(Topology, RandomTrianglesAreConsistentForAnyThreadCount) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        SCOPED_TRACE(seed);
        std::mt19937_64 random(seed);
        const Mesh mesh = shapes::random_triangles(3 + seed * 5, 200, random);
        expect_consistent(mesh, topology_of(mesh));
    }
    std::mt19937_64 random(99);
    const Mesh large = shapes::random_triangles(50'000, 100'000, random);
    const Topology one = topology_of(large, true, 1);
    for (const int threads : {2, 3, 8}) {
        const Topology many = topology_of(large, true, threads);
        EXPECT_EQ(one.opposite, many.opposite);
        EXPECT_EQ(one.kinds, many.kinds);
        EXPECT_EQ(one.point_corners, many.point_corners);
        EXPECT_EQ(one.point_offsets, many.point_offsets);
    }
}

TEST(Topology, PermutedFacesAndVerticesGiveThePermutedAdjacency) {
    std::mt19937_64 random(5);
    const Mesh mesh = shapes::torus(20, 10);
    const Topology t = topology_of(mesh);
    const Indices order = shapes::random_order(mesh.face_count(), random);
    const Indices numbers = shapes::random_order(mesh.vertex_count(), random);
    const Mesh other = shapes::with_vertex_order(shapes::with_face_order(mesh, order), numbers);
    const Topology u = topology_of(other);
    for (std::uint32_t f = 0; f < order.size(); ++f)
        for (std::uint32_t k = 0; k < 4; ++k) {
            const std::uint32_t o = u.opposite[4 * f + k];
            EXPECT_EQ(4 * order[o / 4] + o % 4, t.opposite[4 * order[f] + k]);
        }
}

// At the middle there are two half-edges a face to be sorted, in order, against it or in none. The
// library sorts with up to 2 n log n comparisons, and if that led nowhere begins again with as
// many. All pairs would be 10¹⁰.
TEST(Topology, ValenceOfHundredThousandTakesAsManyStepsAsSorting) {
    std::mt19937_64 random(8);
    constexpr std::uint32_t faces = 100'000;
    const Mesh fan = shapes::fan(faces);
    Indices backwards(faces);
    for (std::uint32_t f = 0; f < faces; ++f) backwards[f] = faces - 1 - f;
    for (const Mesh& mesh : {fan, shapes::with_face_order(fan, backwards),
                             shapes::with_face_order(fan, shapes::random_order(faces, random))}) {
        Topology t;
        const double steps = double(test::steps_of([&] { t = topology_of(mesh); }));
        EXPECT_GE(steps, 2.0 * faces);
        EXPECT_LE(steps, 4 * test::n_log_n(2.0 * faces));
        EXPECT_EQ(count(t, EdgeKind::interior), 2 * faces);
    }
}

}  // namespace
