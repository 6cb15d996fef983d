// The meshes that tests, benchmarks and the self-test are made of, against what is known of their
// shapes: a case that is not what it says proves nothing.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <set>

#include "exact_dihedrals.h"
#include "hard_cases.h"
#include "shapes.h"

namespace {

using Index = std::uint32_t;

struct Facts {
    std::size_t edges = 0, open = 0, mixed = 0, more = 0;
    double volume = 0, area = 0;
    std::int64_t euler = 0;
};
Facts facts(const prep::Mesh& mesh) {
    Facts out;
    std::map<std::pair<Index, Index>, std::pair<int, int>> edges;
    std::set<Index> used;
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
        const Index begin = mesh.face_offsets[f], end = mesh.face_offsets[f + 1];
        glm::dvec3 vector(0);
        const glm::dvec3 first(mesh.positions[mesh.corner_vertices[begin]]);
        for (Index c = begin; c < end; ++c) {
            const Index a = mesh.corner_vertices[c],
                        b = mesh.corner_vertices[c + 1 < end ? c + 1 : begin];
            used.insert(a);
            auto& ways = edges[std::minmax(a, b)];
            ++(a < b ? ways.first : ways.second);
            const glm::dvec3 p(mesh.positions[a]), q(mesh.positions[b]);
            vector += glm::cross(p - first, q - first) / 2.0;
            out.volume += glm::dot(first, glm::cross(p, q)) / 6;
        }
        out.area += glm::length(vector);
    }
    for (const auto& [edge, ways] : edges) {
        out.open += ways.first + ways.second == 1;
        out.mixed += ways.first + ways.second == 2 && ways.first != 1;
        out.more += ways.first + ways.second > 2;
    }
    out.edges = edges.size();
    out.euler =
        std::int64_t(used.size()) - std::int64_t(edges.size()) + std::int64_t(mesh.face_count());
    return out;
}

TEST(MeshCases, ClosedShapesAreClosedAndFaceOutwards) {
    const double pi = std::numbers::pi;
    const struct {
        const char* name;
        prep::Mesh mesh;
        std::int64_t euler;
        double volume, off;  // by at most so much, relatively: they are polyhedra
    } shapes[] = {{"cube", shapes::cube(), 2, 8, 1e-6},
                  {"UV sphere", shapes::uv_sphere(64, 32), 2, 4 * pi / 3, 0.01},
                  {"icosphere", shapes::icosphere(3), 2, 4 * pi / 3, 0.02},
                  {"cylinder", shapes::cylinder(12), 2, 12 * std::sin(2 * pi / 12), 1e-5},
                  {"torus", shapes::torus(64, 32), 0, 2 * pi * pi * 0.16, 0.01},
                  // Two tetrahedra over triangles of 1/2 · base 2 · height 2 that meet in a point.
                  {"bow tie", shapes::bow_tie(), 3, 2 * (2.0 * 1 / 3), 1e-6}};
    for (const auto& s : shapes) {
        const Facts f = facts(s.mesh);
        EXPECT_EQ(f.open + f.mixed + f.more, 0u) << s.name;
        EXPECT_EQ(f.euler, s.euler) << s.name;
        EXPECT_NEAR(f.volume / s.volume, 1, s.off) << s.name;
    }
    for (const prep::Mesh& ball : {shapes::icosphere(2), shapes::uv_sphere(7, 5)})
        for (const glm::vec3& p : ball.positions) EXPECT_NEAR(glm::length(glm::dvec3(p)), 1, 1e-6);
}

TEST(MeshCases, OpenShapesAreWhatTheySay) {
    const Facts grid = facts(shapes::grid(5, 3));
    EXPECT_EQ(grid.area, 15.0);
    EXPECT_EQ(grid.open, 16u);
    const Facts fan = facts(shapes::fan(9, 0.25));
    EXPECT_EQ(fan.open, 9u);
    EXPECT_EQ(fan.edges, 18u);
    for (std::size_t f = 0; f < 9; ++f) {
        const prep::Mesh mesh = shapes::fan(9, 0.25);
        const auto at = [&](std::size_t k) {
            return glm::dvec3(mesh.positions[mesh.corner_vertices[3 * f + k]]);
        };
        EXPECT_GT(glm::cross(at(1) - at(0), at(2) - at(0)).z, 0) << f;
    }
    const Facts moebius = facts(shapes::moebius(13));
    EXPECT_EQ(moebius.mixed, 1u);  // one-sided: no turning of faces mends that
    EXPECT_EQ(moebius.open, 26u);
    EXPECT_EQ(moebius.euler, 0);
    for (const Index faces : {3u, 8u}) {
        const Facts book = facts(shapes::book(faces, false));
        EXPECT_EQ(book.more, 1u);
        EXPECT_EQ(book.open, 2 * faces);
    }
    const prep::Mesh alternating = shapes::book(4, true);
    for (Index f = 0; f < 4; ++f) EXPECT_EQ(alternating.corner_vertices[3 * f], f % 2) << f;
}

TEST(MeshCases, ChangesOfOrderChangeNothingElse) {
    std::mt19937_64 random(1);
    prep::Mesh mesh = hard_cases::with_uvs(shapes::torus(6, 4));
    mesh.face_materials.resize(24);
    for (Index f = 0; f < 24; ++f) mesh.face_materials[f] = f;
    const auto order = shapes::random_order(24, random), numbers = shapes::random_order(24, random);
    EXPECT_EQ(std::set<Index>(order.begin(), order.end()).size(), 24u);
    const prep::Mesh turned = shapes::with_face_order(mesh, order);
    for (Index f = 0; f < 24; ++f) {
        EXPECT_EQ(turned.face_materials[f], order[f]);
        for (Index k = 0; k < 4; ++k) {
            EXPECT_EQ(turned.corner_vertices[4 * f + k], mesh.corner_vertices[4 * order[f] + k]);
            EXPECT_EQ(turned.uvs[0].indices[4 * f + k], mesh.uvs[0].indices[4 * order[f] + k]);
        }
    }
    const prep::Mesh renumbered = shapes::with_vertex_order(mesh, numbers);
    for (Index c = 0; c < mesh.corner_count(); ++c)
        EXPECT_EQ(renumbered.positions[renumbered.corner_vertices[c]],
                  mesh.positions[mesh.corner_vertices[c]]);
    const prep::Mesh soup = shapes::soup(mesh);
    EXPECT_EQ(soup.vertex_count(), mesh.corner_count());
    for (Index c = 0; c < mesh.corner_count(); ++c)
        EXPECT_EQ(soup.positions[soup.corner_vertices[c]], mesh.positions[mesh.corner_vertices[c]]);
    const prep::Mesh both = shapes::joined(shapes::cube(), shapes::grid(1, 1));
    EXPECT_EQ(both.face_count(), 7u);
    EXPECT_EQ(facts(both).volume, 8.0);
    EXPECT_EQ(facts(both).area, 25.0);
    EXPECT_EQ(both.corner_vertices[24], 8u);
    const Facts fans = facts(shapes::fan_triangulated(shapes::cube(), 1));
    EXPECT_EQ(fans.volume, 8.0);
    EXPECT_EQ(fans.edges, 18u);
    EXPECT_EQ(fans.open, 0u);
}

// Of integers: what the angle says holds without rounding.
TEST(MeshCases, ExactDihedralsAreExact) {
    std::mt19937_64 random(2);
    const auto dot = [](const glm::dvec3& a, const glm::dvec3& b) { return glm::dot(a, b); };
    for (const hard_cases::ExactAngle& angle : hard_cases::exact_angles()) {
        SCOPED_TRACE(angle.degrees);
        const glm::dvec3 n0(angle.n0), n1(angle.n1);
        const double cosine = std::cos(angle.degrees * std::numbers::pi / 180);
        EXPECT_NEAR(dot(n0, n1) / std::sqrt(dot(n0, n0) * dot(n1, n1)), cosine, 1e-15);
        EXPECT_NEAR(
            angle.sign * std::sqrt(double(angle.squared_numerator) / angle.squared_denominator),
            cosine, 1e-15);
        const prep::Mesh mesh = hard_cases::exact_dihedrals(angle, 20, random);
        ASSERT_EQ(mesh.face_count(), 40u);
        for (std::size_t f = 0; f < 40; ++f) {
            const auto at = [&](std::size_t k) {
                return glm::dvec3(mesh.positions[mesh.corner_vertices[3 * f + k]]);
            };
            const glm::dvec3 n = glm::cross(at(1) - at(0), at(2) - at(0)), m = f % 2 ? n1 : n0;
            EXPECT_EQ(glm::cross(n, m), glm::dvec3(0)) << f;
            EXPECT_GT(dot(n, m), 0) << f;
            // Both faces have the edge, in opposite directions.
            if (f % 2 == 0) {
                EXPECT_EQ(mesh.corner_vertices[3 * f], mesh.corner_vertices[3 * f + 4]);
                EXPECT_EQ(mesh.corner_vertices[3 * f + 1], mesh.corner_vertices[3 * f + 3]);
            }
        }
    }
}

TEST(MeshCases, ExactRotationsTurnAndScaleAndNothingElse) {
    std::mt19937_64 random(3);
    for (int i = 0; i < 50; ++i) {
        const glm::dmat3 m = hard_cases::exact_rotation(25, random);
        const glm::dmat3 square = m * glm::transpose(m);
        for (int k = 0; k < 3; ++k)
            for (int l = 0; l < 3; ++l) EXPECT_EQ(square[k][l], k == l ? square[0][0] : 0.0);
        EXPECT_GT(glm::determinant(m), 0);
    }
    prep::Mesh mesh = shapes::cube();
    EXPECT_TRUE(hard_cases::transform_exactly(mesh, glm::dmat3(3.0), -5));
    EXPECT_EQ(mesh.positions[7], glm::vec3(3.0f / 32));
    // 2^24 + 1 is no float.
    mesh = shapes::cube();
    EXPECT_FALSE(hard_cases::transform_exactly(mesh, glm::dmat3(16777217.0), 0));
    mesh = shapes::cube();
    EXPECT_FALSE(hard_cases::transform_exactly(mesh, glm::dmat3(1.0), 200));
}

TEST(MeshCases, CasesCoverTheRangesTheyName) {
    std::map<std::string, std::set<double>> values;
    for (const hard_cases::Case& c : hard_cases::measured()) {
        values[c.axis].insert(c.value);
        if (c.axis == "valence") {
            std::map<Index, std::size_t> valence;
            std::size_t most = 0;
            for (const Index v : c.mesh.corner_vertices) most = std::max(most, ++valence[v]);
            EXPECT_EQ(double(most), c.value);
        }
        if (c.axis == "thickness") {
            EXPECT_EQ(facts(c.mesh).open, 0u) << c.value;
            // Sheets of 36 cells, the middle ones apart by twice the thickness.
            EXPECT_GT(facts(c.mesh).volume, c.value < 1e-30 ? -1 : 20 * c.value) << c.value;
        }
        if (c.axis == "scale") {
            float most = 0;
            for (const glm::vec3& p : c.mesh.positions) most = std::max(most, std::abs(p.x));
            EXPECT_NEAR(double(most) / c.value, 1.4, 0.1);
        }
        if (c.axis == "aspect") {
            EXPECT_NEAR(facts(c.mesh).area * c.value / 64, 1, c.value > 1 ? 0.5 : 0.7) << c.value;
        }
    }
    EXPECT_EQ(*values["scale"].begin(), std::pow(10.0, -44));
    EXPECT_EQ(*values["scale"].rbegin(), 1e38);
    EXPECT_EQ(*values["offset"].rbegin(), 1e7);
    EXPECT_EQ(*values["valence"].rbegin(), 1e5);
    std::map<std::string, const hard_cases::Case*> odd;
    const std::vector<hard_cases::Case> cases = hard_cases::odd();
    for (const hard_cases::Case& c : cases) odd[c.axis] = &c;
    EXPECT_EQ(facts(odd.at("repeated faces")->mesh).more, facts(shapes::torus(12, 8)).edges);
    EXPECT_EQ(odd.at("repeated faces")->mesh.face_count(), 2 * 96u);
    EXPECT_NEAR(facts(odd.at("opposite faces")->mesh).volume, 0, 1e-12);
    EXPECT_GT(facts(odd.at("mixed orientation")->mesh).mixed, 50u);
    EXPECT_EQ(facts(odd.at("concave polygon")->mesh).open, 24u);
    EXPECT_LT(facts(odd.at("figure of eight")->mesh).area, 1e-6);  // its halves cancel
    EXPECT_EQ(odd.at("transform: mirrored")->transform[0][0], -1.0);
    EXPECT_LT(glm::determinant(odd.at("transform: mirrored")->transform), 0);
    EXPECT_EQ(glm::determinant(odd.at("transform: flat")->transform), 0.0);
    EXPECT_TRUE(std::isnan(odd.at("NaN position")->mesh.positions[7].x));
    EXPECT_TRUE(std::isinf(odd.at("infinite position")->mesh.positions[7].y));
    EXPECT_EQ(odd.at("empty")->mesh.face_count(), 0u);
    for (const hard_cases::Case& c : cases) {
        if (c.axis != "UVs: none") continue;
        EXPECT_TRUE(c.mesh.uvs.empty());
        const prep::Mesh mapped = hard_cases::with_uvs(c.mesh);
        glm::vec2 low(9), high(-9);
        for (const glm::vec2& uv : mapped.uvs[0].values) {
            low = glm::min(low, uv);
            high = glm::max(high, uv);
        }
        EXPECT_EQ(low, glm::vec2(0));
        EXPECT_EQ(high, glm::vec2(1));
    }
}

}  // namespace
