// Which class the validation sheet gives each edge.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <tuple>

#include "sheets/edges.h"

namespace {

using report::EdgeClass;

// Two triangles over the edge 0–1 that turn by `degrees`; the far ends are 2 and 3.
prep::Mesh wedge(double degrees) {
    const double a = degrees * std::numbers::pi / 180;
    prep::Mesh mesh;
    mesh.positions = {{0, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {std::cos(a), 0, -std::sin(a)}};
    mesh.corner_vertices = {0, 1, 2, 1, 0, 3};
    mesh.face_offsets = {0, 3, 6};
    return mesh;
}

// Triangles between few places, so that many meet along an edge; where `repeated`, each corner is a
// vertex of its own, as in STL files.
prep::Mesh soup(std::mt19937& random, bool repeated) {
    const auto pick = [&](int n) { return int(random() % unsigned(n)); };
    prep::Mesh mesh;
    std::vector<glm::vec3> places;
    for (int i = 0; i < 9; ++i) places.push_back({pick(3), pick(3), pick(3)});
    std::sort(places.begin(), places.end(), [](const glm::vec3& a, const glm::vec3& b) {
        return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
    });
    places.erase(std::unique(places.begin(), places.end()), places.end());
    if (!repeated) mesh.positions = places;
    for (int f = 0; f < 8; ++f) {
        std::uint32_t corners[3];
        for (std::uint32_t& c : corners) c = std::uint32_t(pick(int(places.size())));
        if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0])
            continue;
        for (std::uint32_t c : corners) {
            if (repeated) {
                mesh.positions.push_back(places[c]);
                c = std::uint32_t(mesh.positions.size() - 1);
            }
            mesh.corner_vertices.push_back(c);
        }
        mesh.face_offsets.push_back(std::uint32_t(mesh.corner_vertices.size()));
    }
    mesh.indexed_by_vertex = repeated;
    return mesh;
}

// The class of the edge between two vertices, after preparing.
struct Classes {
    std::map<std::pair<std::uint32_t, std::uint32_t>, EdgeClass> of;
    explicit Classes(prep::Mesh mesh, const prep::PrepareOptions& options = {}) {
        prep::Scene scene;
        scene.meshes.push_back(std::move(mesh));
        scene.nodes.push_back({});
        scene.nodes[0].mesh = 0;
        const auto prepared = prep::prepare(std::move(scene), options);
        EXPECT_TRUE(prepared);
        for (const report::ClassedEdge& e : report::classify_edges(*prepared, 0, options)) {
            EXPECT_LT(e.v0, e.v1);
            EXPECT_TRUE(of.emplace(std::pair(e.v0, e.v1), e.kind).second) << "twice";
        }
    }
    std::string at(std::uint32_t a, std::uint32_t b) const {
        const auto found = of.find({a, b});
        return found == of.end() ? "none" : report::style_of(found->second).name;
    }
};

TEST(EdgeClasses, AnglesAreThoseAboveTheThreshold) {
    const Classes smooth(wedge(50)), hard(wedge(70));
    EXPECT_EQ(smooth.at(0, 1), "smooth");
    EXPECT_EQ(hard.at(0, 1), "angle");
    EXPECT_EQ(hard.of.size(), 5u);
    for (const std::uint32_t far : {2u, 3u})
        for (const std::uint32_t near : {0u, 1u}) EXPECT_EQ(hard.at(near, far), "open border");
    prep::PrepareOptions options;
    options.hard_edges.angle_degrees = 40;
    EXPECT_EQ(Classes(wedge(50), options).at(0, 1), "angle");
}

TEST(EdgeClasses, TheFilesWishesAreNamed) {
    prep::Mesh mesh = wedge(30);
    mesh.face_smoothing = {1, 2};
    EXPECT_EQ(Classes(mesh).at(0, 1), "smoothing group");
    mesh.hard_marks = {{1, 0}};
    EXPECT_EQ(Classes(mesh).at(0, 1), "marked");  // more than a group
    mesh = wedge(70);
    mesh.face_smoothing = {1, 1};
    EXPECT_EQ(Classes(mesh).at(0, 1), "smooth");
    mesh = wedge(30);
    mesh.normals.values = {{0, 0, 1}, {std::sqrt(0.5f), 0, std::sqrt(0.5f)}};
    mesh.normals.indices = {0, 0, 0, 1, 1, 1};
    EXPECT_EQ(Classes(mesh).at(0, 1), "authored normals");
    // Apart at one end alone is apart.
    mesh.normals.indices = {0, 0, 0, 0, 1, 1};
    EXPECT_EQ(Classes(mesh).at(0, 1), "authored normals");
    mesh.normals.indices = {0, 0, 0, 1, 0, 1};
    EXPECT_EQ(Classes(mesh).at(0, 1), "authored normals");
    // By less than the eye can tell: 0.4° and 0.6°.
    for (const auto& [degrees, name] : {std::pair{0.4, "smooth"}, {0.6, "authored normals"}}) {
        const double a = degrees * std::numbers::pi / 180;
        mesh.normals.values[1] = {std::sin(a), 0, std::cos(a)};
        mesh.normals.indices = {0, 0, 0, 1, 1, 1};
        EXPECT_EQ(Classes(mesh).at(0, 1), name);
    }
}

TEST(EdgeClasses, SeamsAndBordersOfMaterialsBreakWhereAskedFor) {
    prep::Mesh mesh = wedge(30);
    mesh.uvs.resize(1);
    mesh.uvs[0].values = {{0, 0}, {0, 1}, {1, 0}, {5, 5}, {5, 6}, {6, 5}};
    mesh.uvs[0].indices = {0, 1, 2, 4, 3, 5};
    EXPECT_EQ(Classes(mesh).at(0, 1), "UV seam (smooth)");
    prep::PrepareOptions options;
    options.hard_edges.uv_borders = true;
    EXPECT_EQ(Classes(mesh, options).at(0, 1), "UV border");
    mesh.uvs[0].indices = {0, 1, 2, 1, 0, 5};
    EXPECT_EQ(Classes(mesh, options).at(0, 1), "smooth");
    mesh.uvs[0].indices = {0, 1, 2, 4, 0, 5};  // parted at one end
    EXPECT_EQ(Classes(mesh).at(0, 1), "UV seam (smooth)");
    mesh = wedge(30);
    mesh.face_materials = {0, 1};
    EXPECT_EQ(Classes(mesh).at(0, 1), "smooth");
    options = {};
    options.hard_edges.material_borders = true;
    EXPECT_EQ(Classes(mesh, options).at(0, 1), "material border");
}

TEST(EdgeClasses, BadEdgesAreNamedWhateverElseTheyAre) {
    prep::Mesh mesh = wedge(70);
    mesh.positions.push_back({0, 0, 5});
    mesh.corner_vertices.insert(mesh.corner_vertices.end(), {0, 1, 4});
    mesh.face_offsets.push_back(9);
    EXPECT_EQ(Classes(mesh).at(0, 1), "non-manifold");
    mesh = wedge(10);
    mesh.corner_vertices = {0, 1, 2, 0, 1, 3};  // both run the same way
    EXPECT_EQ(Classes(mesh).at(0, 1), "inconsistent orientation");
}

// Of a file without normals no edge is called authored, whatever its corners came to.
TEST(EdgeClasses, WithoutNormalsInTheFileNoneAreAuthored) {
    std::mt19937 random(5);
    for (int round = 0; round < 40; ++round) {
        const prep::Mesh mesh = soup(random, round % 2 == 0);
        for (const auto& [ends, kind] : Classes(mesh).of) EXPECT_NE(kind, EdgeClass::authored);
    }
}

// Against the plainest count there is: how many triangles have both ends, and which way round.
TEST(EdgeClasses, BadAndOpenEdgesAreThoseThatTheirFacesSay) {
    std::mt19937 random(6);
    std::size_t bad = 0, against = 0, open = 0;
    for (int round = 0; round < 400; ++round) {
        const bool repeated = round % 2 == 0;
        const prep::Mesh mesh = soup(random, repeated);
        using Place = std::tuple<float, float, float>;
        const auto place = [&](std::uint32_t c) {
            const glm::vec3 p = mesh.positions[mesh.corner_vertices[c]];
            return Place(p.x, p.y, p.z);
        };
        std::map<std::pair<Place, Place>, std::vector<bool>> uses;
        for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
            for (std::uint32_t k = 0; k < 3; ++k) {
                const Place a = place(3 * f + k), b = place(3 * f + (k + 1) % 3);
                if (a != b) uses[std::minmax(a, b)].push_back(a < b);
            }
        std::map<EdgeClass, std::size_t> expected, found;
        for (const auto& [ends, ways] : uses) {
            if (ways.size() == 1) ++expected[EdgeClass::border];
            if (ways.size() == 2 && ways[0] == ways[1]) ++expected[EdgeClass::inconsistent];
            if (ways.size() > 2) ++expected[EdgeClass::non_manifold];
        }
        const Classes classes(mesh);
        EXPECT_EQ(classes.of.size(), uses.size()) << "round " << round;
        for (const auto& [ends, kind] : classes.of) ++found[kind];
        for (const EdgeClass kind :
             {EdgeClass::border, EdgeClass::inconsistent, EdgeClass::non_manifold})
            EXPECT_EQ(found[kind], expected[kind])
                << report::style_of(kind).name << ", round " << round;
        bad += expected[EdgeClass::non_manifold];
        against += expected[EdgeClass::inconsistent];
        open += expected[EdgeClass::border];
    }
    EXPECT_GT(std::min({bad, against, open}), 100u);
}

// Vertices at one point are one, unless they are to stay apart; edges without length are none.
TEST(EdgeClasses, PointsAreWeldedUnlessTheyAreToStayApart) {
    prep::Mesh mesh = wedge(30);
    mesh.positions.push_back(mesh.positions[0]);
    mesh.positions.push_back(mesh.positions[1]);
    mesh.corner_vertices = {0, 1, 2, 5, 4, 3};
    mesh.normals.values = {{0, 0, 1}, {1, 0, 0}};
    mesh.normals.indices = {0, 0, 0, 1, 1, 1};
    EXPECT_EQ(Classes(mesh).at(0, 1), "authored normals");
    EXPECT_EQ(Classes(mesh).at(4, 5), "none");
    prep::PrepareOptions apart;
    apart.weld = prep::WeldMode::none;
    EXPECT_EQ(Classes(mesh, apart).at(0, 1), "open border");
    EXPECT_EQ(Classes(mesh, apart).at(4, 5), "open border");
}

}  // namespace
