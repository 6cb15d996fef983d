// What a sheet shows of a subdivided mesh: its cage, the cage's edges on the limit surface, its
// curvature.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "command_runner.h"
#include "shapes.h"
#include "sheets/panels.h"
#include "sheets/surfaces/cage_lines.h"
#include "sheets/surfaces/curvature.h"
#include "subdivision_cages.h"

namespace {

// A patch of a surface over [-1, 1]², with its own normals.
struct Point {
    glm::dvec3 position, normal;
};
prep::VertexMesh patch(const std::function<Point(double, double)>& at) {
    constexpr std::uint32_t n = 40;
    prep::VertexMesh mesh;
    for (std::uint32_t j = 0; j <= n; ++j)
        for (std::uint32_t i = 0; i <= n; ++i) {
            const Point p = at(2.0 * i / n - 1, 2.0 * j / n - 1);
            mesh.positions.emplace_back(p.position);
            mesh.normals.emplace_back(glm::normalize(p.normal));
            const std::uint32_t v = j * (n + 1) + i;
            if (i < n && j < n)
                for (const std::uint32_t w : {v, v + 1, v + n + 2, v, v + n + 2, v + n + 1})
                    mesh.indices.push_back(w);
        }
    return mesh;
}
void expect_curvature(const prep::VertexMesh& mesh, double expected, double tolerance) {
    for (const double h : report::mean_curvature(mesh)) ASSERT_NEAR(h, expected, tolerance);
}

TEST(MeanCurvature, IsThatOfSpheresCylindersSaddlesAndPlanes) {
    const auto sphere = [](double x, double y) {
        const glm::dvec3 n(std::sin(x) * std::cos(y), std::sin(y), std::cos(x) * std::cos(y));
        return Point{2.0 * n, n};
    };
    expect_curvature(patch(sphere), 0.5, 1e-3);
    // Seen from inside it is hollow.
    expect_curvature(patch([&](double x, double y) {
                         Point p = sphere(x, y);
                         return Point{p.position, -p.normal};
                     }),
                     -0.5, 1e-3);
    expect_curvature(patch([](double x, double y) {
                         const glm::dvec3 n(std::sin(x), 0, std::cos(x));
                         return Point{0.25 * n + glm::dvec3(0, y, 0), n};
                     }),
                     2, 1e-2);
    const prep::VertexMesh saddle = patch([](double x, double y) {
        return Point{{x, y, x * y}, {-y, -x, 1}};
    });
    // In its middle; floats of normals are rounded by 6e-8, over edges of 1/20.
    EXPECT_NEAR(report::mean_curvature(saddle)[20 * 41 + 20], 0, 1e-6);
    expect_curvature(patch([](double x, double y) { return Point{{x, y, 3}, {0, 0, 1}}; }), 0, 0);
    prep::VertexMesh without = patch(sphere);
    without.normals.clear();
    expect_curvature(without, 0, 0);
}

TEST(MeanCurvature, UvSeamsDoNotShowAndHardEdgesDo) {
    const auto bowl = [](double x, double y) { return Point{{x, y, x * x}, {-2 * x, 0, 1}}; };
    const prep::VertexMesh whole = patch(bowl);
    prep::VertexMesh seamed = whole;  // each triangle has vertices of its own
    seamed.positions.clear();
    seamed.normals.clear();
    for (std::uint32_t& i : seamed.indices) {
        seamed.positions.push_back(whole.positions[i]);
        seamed.normals.push_back(whole.normals[i]);
        i = std::uint32_t(seamed.positions.size() - 1);
    }
    const auto a = report::mean_curvature(whole), b = report::mean_curvature(seamed);
    for (std::size_t k = 0; k < b.size(); ++k)
        ASSERT_NEAR(b[k], a[whole.indices[k]], 1e-12) << "corner " << k;
    // A box: sides are flat up to their edges.
    prep::PrepareOptions options;
    options.hard_edges.angle_degrees = 60;
    prep::Scene scene;
    scene.meshes.push_back(shapes::cube());
    prep::instance_unused_meshes(scene);
    const auto box = prep::prepare(std::move(scene), options);
    ASSERT_TRUE(box);
    for (const double h : report::mean_curvature(box->meshes[0])) EXPECT_EQ(h, 0);
}

// 16 segments of an edge of the cage are the limits of its vertices at level 4.
TEST(CageLines, EdgesOnTheLimitSurfaceAreTheRules) {
    for (const test::Cage& cage : test::own_cages()) {
        SCOPED_TRACE(cage.name);
        const auto lines = report::limit_edges(cage.mesh, cage.options);
        ASSERT_TRUE(lines) << lines.error().text;
        const test::SubdivisionOracle oracle(cage.mesh, rules_of(cage));
        const auto refined = oracle.refine_all(4);
        std::vector<glm::dvec3> truth;
        for (const auto& limit : refined.limits) truth.emplace_back(limit.position);
        std::sort(truth.begin(), truth.end(),
                  [](const glm::dvec3& a, const glm::dvec3& b) { return a.x < b.x; });
        const double near = 1e-8 * double(oracle.diagonal());  // as the oracle's own tests have it
        for (const report::CageLine& line : *lines) {
            ASSERT_EQ(line.points.size(), 17U);
            for (const glm::dvec3& p : line.points) {
                const auto first =
                    std::lower_bound(truth.begin(), truth.end(), p.x - near,
                                     [](const glm::dvec3& q, double x) { return q.x < x; });
                double best = 1e300;
                for (auto q = first; q != truth.end() && q->x <= p.x + near; ++q)
                    best = std::min(best, glm::length(*q - p));
                ASSERT_LE(best, near) << p.x << ", " << p.y << ", " << p.z;
            }
        }
        if (!oracle.is_hole(0)) {
            EXPECT_FALSE(lines->empty());
        }
    }
}

TEST(CageLines, EachEdgeOnceWithItsSharpness) {
    prep::Mesh mesh = shapes::cube();
    mesh.origin = {100, 0, 0};
    mesh.subdivision.creases = {{mesh.corner_vertices[1], mesh.corner_vertices[0], 2.5F}};
    const auto lines = report::cage_edges(mesh);
    EXPECT_EQ(lines.size(), 12U);
    double sharpness = 0;
    for (const report::CageLine& line : lines) {
        ASSERT_EQ(line.points.size(), 2U);
        EXPECT_NEAR(glm::length(line.points[0] - line.points[1]), 2, 1e-12);
        EXPECT_NEAR(line.points[0].x, 100, 1);
        sharpness += double(line.sharpness);
    }
    EXPECT_EQ(sharpness, 2.5);
}

report::PanelSet panels_of(prep::Mesh mesh, bool subdivide) {
    prep::Scene scene;
    scene.meshes.push_back(std::move(mesh));
    prep::instance_unused_meshes(scene);
    report::PanelOptions options;
    options.size = 96;
    options.prepare.subdivide = subdivide;
    options.prepare.keep_cages = true;
    options.prepare.subdivision.level = 3;
    const auto prepared = prep::prepare(std::move(scene), options.prepare);
    EXPECT_TRUE(prepared);
    const auto panels = report::make_panels(report::mesh_subject(*prepared, 0), options);
    EXPECT_TRUE(panels);
    return panels ? *panels : report::PanelSet{};
}
const report::Panel* panel(const report::PanelSet& set, const std::string& id) {
    for (const report::Panel& p : set.panels)
        if (p.id == id) return &p;
    return nullptr;
}
// Opaque pixels whose red is this much over their blue.
std::size_t reddish(const report::Panel& p, float by) {
    std::size_t count = 0;
    for (std::size_t i = 0; i + 3 < p.picture->pixels.size(); i += 4)
        count +=
            p.picture->pixels[i + 3] > 0.99F &&
            (p.picture->pixels[i] - p.picture->pixels[i + 2]) * (by > 0 ? 1 : -1) > std::abs(by);
    return count;
}

TEST(CagePanels, ShowCageLimitAndCurvatureOfSubdividedMeshesAlone) {
    prep::Mesh mesh = shapes::cube();
    mesh.subdivision.creases = {{mesh.corner_vertices[0], mesh.corner_vertices[1], 10},
                                {mesh.corner_vertices[1], mesh.corner_vertices[2], 2}};
    EXPECT_EQ(panel(panels_of(mesh, false), "cage"), nullptr);
    const report::PanelSet set = panels_of(mesh, true);
    for (const char* id : {"cage", "limit-wireframe", "curvature"}) {
        ASSERT_NE(panel(set, id), nullptr) << id;
        EXPECT_TRUE(panel(set, id)->picture) << id;
    }
    EXPECT_EQ(panel(set, "cage")->caption,
              "6 faces, 12 edges around the surface; 8 extraordinary vertices");
    EXPECT_EQ(panel(set, "cage")->legend.size(), 3U);  // semi-sharp, sharp, extraordinary
    EXPECT_EQ(panel(set, "limit-wireframe")->legend.size(), 2U);
    EXPECT_EQ(panel(set, "limit-wireframe")->caption,
              "12 edges of the cage as curves on its limit surface");
    // A smooth cube bulges everywhere: red, and no blue.
    const report::PanelSet smooth = panels_of(shapes::cube(), true);
    EXPECT_GT(reddish(*panel(smooth, "curvature"), 0.1F), 500U);
    EXPECT_EQ(reddish(*panel(smooth, "curvature"), -0.1F), 0U);
}

// Without a scheme there is no cage and no limit surface: the polygons themselves were displaced.
TEST(CagePanels, DisplacedPolygonsHaveNone) {
    const test::TempDir dir;
    test::write_text(dir / "cube.obj", test::textured_cube_obj());
    for (const bool residual : {false, true}) {
        std::vector<std::string> args = {"validate",
                                         (dir / "cube.obj").string(),
                                         "-o",
                                         dir.path().string(),
                                         "--panel",
                                         "64",
                                         "--displace",
                                         "noise",
                                         "--edge-length",
                                         "0.5",
                                         "--noise-scale",
                                         "0.1",
                                         "--json"};
        if (residual) args.insert(args.end(), {"--residual-normal-map", "16"});
        const test::Ran ran = test::run_here(args);
        ASSERT_EQ(ran.exit_code, 0) << ran.err;
        const nlohmann::json sheet = ran.json()["files"][0]["numbers"][0];
        std::vector<std::string> ids;
        for (const auto& p : sheet["panels"])
            if (p["drawn"]) ids.push_back(p["id"]);
        EXPECT_NE(std::find(ids.begin(), ids.end(), "polygons"), ids.end());
        for (const char* id : {"cage", "limit-wireframe"})
            EXPECT_EQ(std::find(ids.begin(), ids.end(), id), ids.end()) << id;
        const nlohmann::json& figures = sheet["figures"];
        EXPECT_EQ(figures["Normals and tangents"]["tangents called for"], residual);
        // The file has no normals: those that differ do so at its hard edges.
        EXPECT_GT(figures["Vertices"].value("split at hard edges", 0), 0);
        EXPECT_FALSE(figures["Vertices"].contains("split by authored normals"));
    }
    EXPECT_NE(test::file_text(dir / "cube.html").find("6 faces, 12 edges before they were moved"),
              std::string::npos);
}

// The whole cage is in the picture: its corners are the farthest there is.
TEST(CagePanels, ValidateWritesThem) {
    const test::TempDir dir;
    test::write_text(dir / "cube.obj", test::cube_obj());
    const test::Ran ran =
        test::run_here({"validate", (dir / "cube.obj").string(), "-o", dir.path().string(),
                        "--panel", "64", "--json", "--subdivide", "catmark:2"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    std::vector<std::string> ids;
    const nlohmann::json said = ran.json();
    for (const auto& p : said["files"][0]["numbers"][0]["panels"])
        if (p["drawn"]) ids.push_back(p["id"]);
    for (const char* id : {"cage", "limit-wireframe", "curvature"})
        EXPECT_NE(std::find(ids.begin(), ids.end(), id), ids.end()) << id;
    EXPECT_NE(test::file_text(dir / "cube.html").find("Limit wireframe"), std::string::npos);
}

}  // namespace
