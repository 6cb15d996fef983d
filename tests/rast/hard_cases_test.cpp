// Every hard case of tools/cases through every stage: hard edges against rationals, tangents as
// frames, splits against their definition, pictures whole and the same on any threads and
// instructions. Normals: Stability.* of tests/prep.
#include "hard_cases.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "exact.h"
#include "prep/prepare.h"
#include "prep/tangents.h"
#include "rast/render.h"
#include "sanitized.h"
#include "split_oracle.h"

namespace {

using hard_cases::Case;
using prep::Mesh;
using prep::MeshView;
using prep::no_index;

// Rationals are slow, in the library's decisions too, and fifty times slower where every allocation
// is watched.
constexpr std::size_t edges_looked_at = test::sanitized ? 10 : 150;
constexpr std::size_t most_corners_decided = test::sanitized ? 2000 : std::size_t(-1);

std::vector<Case> all_cases() {
    std::vector<Case> cases = hard_cases::measured();
    std::vector<Case> odd = hard_cases::odd();
    std::move(odd.begin(), odd.end(), std::back_inserter(cases));
    return cases;
}

template <class Check>
void for_all(const Check& check) {
    std::size_t number = 0;
    for (const Case& c : all_cases()) {
        if (test::sanitized && number++ % 3 != 0) continue;
        SCOPED_TRACE(c.axis + " " + std::to_string(c.value));
        check(c);
    }
}

prep::PreparedScene prepared(const Case& c, bool tangents) {
    Case with = c;
    if (tangents) with.mesh = hard_cases::with_uvs(std::move(with.mesh));
    prep::PrepareOptions options;
    if (tangents) options.request.tangents = prep::Request::Level::always;
    auto result = prep::prepare(hard_cases::scene_of(with), options);
    EXPECT_TRUE(result.has_value());
    return *std::move(result);
}

TEST(HardCases, EdgesAreDecidedAsRationalsDecideThem) {
    for_all([](const Case& c) {
        const Mesh& mesh = c.mesh;
        if (mesh.corner_count() > most_corners_decided) return;
        const MeshView view(mesh);
        const prep::Topology topology = prep::build_topology(view);
        std::vector<std::uint32_t> faces_of_corners;
        for (std::uint32_t f = 0; f < mesh.face_count(); ++f)
            faces_of_corners.insert(faces_of_corners.end(),
                                    mesh.face_offsets[f + 1] - mesh.face_offsets[f], f);
        const prep::FaceNormals exact_faces = prep::face_normals(view);
        struct Edge {
            std::uint32_t corner;
            bool over_60, over_90;
        };
        std::vector<Edge> edges;
        const std::size_t stride = 1 + mesh.corner_count() / edges_looked_at;
        for (std::size_t k = 0; k < mesh.corner_count(); k += stride) {
            if (topology.opposite[k] == no_index) continue;
            const std::uint32_t f = faces_of_corners[k], g = faces_of_corners[topology.opposite[k]];
            if (exact_faces.states[f] != prep::FaceState::regular ||
                exact_faces.states[g] != prep::FaceState::regular)
                continue;  // slits: HardEdges.SlitGoesByTheFaceAcrossItsLongestEdge
            const exact::Vector a = exact::area_vector(mesh, f), b = exact::area_vector(mesh, g);
            edges.push_back({std::uint32_t(k), exact::turn_exceeds(a, b, 1, exact::Rational(1, 4)),
                             exact::turn_exceeds(a, b, 0, exact::Rational(0))});
        }
        for (const prep::Precision p : {prep::Precision::fast, prep::Precision::accurate}) {
            const prep::FaceNormals faces = prep::face_normals(view, p);
            for (const double degrees : {60.0, 90.0}) {
                prep::HardEdgeOptions options;
                options.angle_degrees = degrees;
                const auto hard = prep::hard_edges(view, topology, faces, options);
                ASSERT_TRUE(hard.has_value());
                for (const Edge& edge : edges) {
                    EXPECT_EQ((hard->reasons[edge.corner] & prep::hard_angle) != 0,
                              degrees == 60 ? edge.over_60 : edge.over_90)
                        << edge.corner << " at " << degrees;
                    EXPECT_EQ(hard->reasons[edge.corner],
                              hard->reasons[topology.opposite[edge.corner]]);
                }
            }
        }
    });
}

TEST(HardCases, TangentsAreFrames) {
    for_all([](const Case& c) {
        const prep::PreparedScene scene = prepared(c, true);
        const prep::VertexMesh& mesh = scene.meshes[0];
        if (mesh.indices.empty()) return;
        ASSERT_EQ(mesh.normals.size(), mesh.vertex_count());
        ASSERT_EQ(mesh.tangents.size(), mesh.vertex_count());
        int bad = 0;
        for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
            const glm::dvec3 n(mesh.normals[v]), t(glm::vec3(mesh.tangents[v]));
            bad += !(std::abs(glm::length(n) - 1) < 1e-6) ||
                   !(std::abs(glm::length(t) - 1) < 1e-6) || !(std::abs(glm::dot(n, t)) < 1e-6) ||
                   std::abs(mesh.tangents[v].w) != 1;
        }
        EXPECT_EQ(bad, 0);
    });
}

TEST(HardCases, TangentsAreTheDefinitionsWhereItHasAny) {
    for_all([](const Case& c) {
        if (c.mesh.corner_count() > 10'000) return;  // the definition is quadratic at a pole
        Mesh mesh = prepared(c, true).scene.meshes[0];
        if (mesh.corner_count() == 0) return;
        prep::TangentOptions options;
        const prep::TangentInput input{MeshView(mesh)};
        const auto ours = prep::corner_tangents(input, options);
        options.mode = prep::TangentMode::definition;
        const auto theirs = prep::corner_tangents(input, options);
        ASSERT_TRUE(ours && theirs);
        std::vector<char> differs(mesh.corner_count());
        for (const auto& fallback : ours->fallbacks) differs[fallback.corner] = 1;
        int wrong = 0;
        for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
            if (mesh.face_offsets[f + 1] - mesh.face_offsets[f] > 4) return;  // it skips polygons
        }
        for (std::uint32_t k = 0; k < mesh.corner_count(); ++k)
            wrong += differs[k] == 0 &&
                     std::memcmp(&ours->tangents.values[ours->tangents.indices[k]],
                                 &theirs->tangents.values[theirs->tangents.indices[k]], 16) != 0;
        EXPECT_EQ(wrong, 0);
    });
}

TEST(HardCases, SplitsAreByTheirDefinition) {
    for_all([](const Case& c) {
        for (const bool tangents : {false, true}) {
            if (tangents && c.mesh.corner_count() > 100'000) continue;  // the oracle takes seconds
            const prep::PreparedScene scene = prepared(c, tangents);
            split_oracle::expect_right(scene.scene.meshes[0], scene.meshes[0]);
        }
    });
}

bool same_picture(const rast::Frame& a, const rast::Frame& b) {
    return a.color.size() == b.color.size() &&
           std::memcmp(a.color.data(), b.color.data(), a.color.size() * sizeof(glm::vec4)) == 0 &&
           a.depth == b.depth && a.triangle == b.triangle;
}

// Triangles with a vertex that is no point of space.
std::uint64_t non_finite_triangles(const prep::PreparedScene& scene) {
    const prep::VertexMesh& mesh = scene.meshes[0];
    std::uint64_t count = 0;
    for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
        bool finite = true;
        for (int k = 0; k < 3; ++k) {
            const glm::dvec4 p(glm::dvec3(mesh.positions[mesh.indices[3 * t + k]]), 1);
            const glm::dvec4 w = scene.scene.nodes[0].transform * p;
            finite = finite && std::isfinite(w.x) && std::isfinite(w.y) && std::isfinite(w.z);
        }
        count += !finite;
    }
    return count;
}

TEST(HardCases, PicturesAreWholeAndCountEveryTriangle) {
    for_all([](const Case& c) {
        const prep::PreparedScene scene = prepared(c, true);
        for (const rast::Shading shading : {rast::Shading::flat, rast::Shading::gouraud,
                                            rast::Shading::phong, rast::Shading::normal_mapped}) {
            rast::RenderRequest request;
            request.width = 60;
            request.height = 40;
            request.shading = shading;
            request.samples = shading == rast::Shading::phong ? 4 : 1;
            request.keep_depth = request.keep_ids = request.keep_normals = true;
            request.threads = 1;
            request.simd = prep::SimdLevel::scalar;
            const auto draw = [&] {
                const auto plan = rast::plan(scene, request);
                EXPECT_TRUE(plan.has_value());
                return *rast::render(scene, *plan);
            };
            const rast::Frame frame = draw();
            int bad = 0;
            for (const glm::vec4& p : frame.color)
                bad += !(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z) &&
                         p.w >= 0 && p.w <= 1);
            for (std::size_t i = 0; i < frame.normal.size(); ++i) {
                const double length = glm::length(glm::dvec3(frame.normal[i]));
                bad += frame.triangle[i] != no_index && !(std::abs(length - 1) < 1e-3);
            }
            for (const float d : frame.depth) bad += !(d >= 0 && d <= 1);
            EXPECT_EQ(bad, 0) << int(shading);
            const rast::Counters& n = frame.counters;
            EXPECT_EQ(n.triangles, scene.meshes[0].triangle_count());
            EXPECT_EQ(n.non_finite, non_finite_triangles(scene));
            EXPECT_LE(n.non_finite + n.degenerate + n.facing_away + n.outside + n.between_samples,
                      n.triangles);
            request.threads = 2;
            request.simd = prep::SimdLevel::automatic;
            EXPECT_TRUE(same_picture(frame, draw())) << int(shading);
        }
    });
}

// A torus of any size fills the same pixels of a view that frames it. (Denormal coordinates, below
// 1e-38, count as zero in the renderer.)
TEST(HardCases, ScalesShowTheSamePicture) {
    std::size_t expected = 0;
    for (const double scale : {1.0, 1e-30, 1e-20, 1e-10, 1e10, 1e20, 1e30, 1e38}) {
        SCOPED_TRACE(scale);
        for (const Case& c : hard_cases::measured()) {
            if (c.axis != "scale" || std::abs(c.value / scale - 1) > 1e-6) continue;
            const prep::PreparedScene scene = prepared(c, false);
            rast::RenderRequest request;
            request.width = request.height = 128;
            const auto plan = rast::plan(scene, request);
            const rast::Frame frame = *rast::render(scene, *plan);
            std::size_t covered = 0;
            for (const glm::vec4& p : frame.color) covered += p.w > 0;
            if (expected == 0) expected = covered;
            EXPECT_GT(covered, 2000u);
            // The coordinates differ by roundings, which may move an edge over a pixel centre.
            EXPECT_NEAR(double(covered), double(expected), 2.0);
        }
    }
}

}  // namespace
