// The sample machine part as the command tells of it and draws it, against its file's own text:
// counted, and hit by rays.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <glm/glm.hpp>
#include <map>
#include <numbers>
#include <sstream>

#include "command_runner.h"
#include "prep/image.h"
#include "shared_data.h"

namespace {

struct Part {
    std::vector<glm::dvec3> vertices;
    std::vector<std::vector<std::size_t>> faces;
    std::vector<glm::dvec3> normals;  // by face, Newell's
    Part() {
        std::istringstream text(
            test::file_text(test::source_dir() / "samples/machine_part/machine_part.obj"));
        std::string line, word;
        while (std::getline(text, line)) {
            std::istringstream words(line);
            words >> word;
            if (word == "v") {
                glm::dvec3 v(0);
                words >> v.x >> v.y >> v.z;
                vertices.push_back(v);
            } else if (word == "f") {
                faces.emplace_back();
                while (words >> word) faces.back().push_back(std::stoul(word) - 1);
            }
            word.clear();
        }
        for (const auto& face : faces) {
            glm::dvec3 n(0);
            for (std::size_t k = 0; k < face.size(); ++k)
                n += glm::cross(vertices[face[k]], vertices[face[(k + 1) % face.size()]]);
            normals.push_back(glm::normalize(n));
        }
    }
    // The nearest face that the ray meets: its plane, and a count of crossings within it.
    std::pair<std::size_t, double> hit(const glm::dvec3& from, const glm::dvec3& ray) const {
        std::pair<std::size_t, double> best(faces.size(), HUGE_VAL);
        for (std::size_t f = 0; f < faces.size(); ++f) {
            const double along = glm::dot(ray, normals[f]);
            if (along == 0) continue;
            const double t = glm::dot(vertices[faces[f][0]] - from, normals[f]) / along;
            if (!(t > 0 && t < best.second)) continue;
            const glm::dvec3 p = from + t * ray, n = glm::abs(normals[f]);
            const int u = n.x > n.y && n.x > n.z ? 1 : 0, v = n.z >= n.x && n.z >= n.y ? 1 : 2;
            bool inside = false;
            const auto& face = faces[f];
            for (std::size_t k = 0; k < face.size(); ++k) {
                const glm::dvec3 &a = vertices[face[k]], &b = vertices[face[(k + 1) % face.size()]];
                if ((a[v] > p[v]) == (b[v] > p[v])) continue;
                inside ^= a[u] + (p[v] - a[v]) / (b[v] - a[v]) * (b[u] - a[u]) > p[u];
            }
            if (inside) best = {f, t};
        }
        return best;
    }
};

TEST(Samples, TheMachinePartIsWhatItsFileSays) {
    const Part part;
    std::map<std::pair<std::size_t, std::size_t>, int> edges;
    for (const auto& face : part.faces)
        for (std::size_t k = 0; k < face.size(); ++k)
            ++edges[std::minmax(face[k], face[(k + 1) % face.size()])];
    const nlohmann::json document =
        test::run_here({"inspect",
                        (test::source_dir() / "samples/machine_part/machine_part.obj").string(),
                        "--json"})
            .json();
    const nlohmann::json& mesh = document["files"][0]["meshes"][0];
    EXPECT_EQ(mesh["vertices"], part.vertices.size());
    EXPECT_EQ(mesh["faces"], part.faces.size());
    EXPECT_EQ(mesh["edges"], edges.size());
    EXPECT_EQ(mesh["closed"], true);
    // Four solids; 2 − 2 · genus is the sum of their Euler numbers: one has seven holes.
    EXPECT_EQ(mesh["components"], 4);
    EXPECT_EQ(mesh["genus"], 7);
    EXPECT_EQ(std::int64_t(part.vertices.size()) - std::int64_t(edges.size()) +
                  std::int64_t(part.faces.size()),
              2 * 4 - 2 * 7);
}

TEST(Samples, TheMachinePartIsDrawnWhereRaysMeetIt) {
    const Part part;
    const test::TempDir dir;
    const std::uint32_t width = 44, height = 33;
    const test::Ran ran = test::run_here(
        {"render", (test::source_dir() / "samples/machine_part/machine_part.obj").string(), "-o",
         (dir / "a.png").string(), "--size", "44x33", "--look-from", "3,4,5", "--look-at",
         "0,0.5,0", "--fov", "40", "--shading", "flat", "--buffers", "depth,normal,position"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    const auto depth = prep::load_image(dir / "a.depth.exr"),
               normal = prep::load_image(dir / "a.normal.exr"),
               position = prep::load_image(dir / "a.position.exr");
    ASSERT_TRUE(depth && normal && position);
    const glm::dvec3 eye(3, 4, 5), back = glm::normalize(eye - glm::dvec3(0, 0.5, 0)),
                                   right = glm::normalize(glm::cross(glm::dvec3(0, 1, 0), back)),
                                   up = glm::cross(back, right);
    const double half = std::tan(20 * std::numbers::pi / 180);
    const auto cast = [&](double x, double y) {
        return part.hit(eye, right * ((2 * x / width - 1) * half * width / height) +
                                 up * ((1 - 2 * y / height) * half) - back);
    };
    int hits = 0, misses = 0;
    for (std::uint32_t y = 0; y < height; ++y)
        for (std::uint32_t x = 0; x < width; ++x) {
            // Corners lie on the grid of 1/256 pixels; near edges, rays beside the centre differ.
            const auto centre = cast(x + 0.5, y + 0.5);
            bool sure = true;
            for (const auto& [dx, dy] :
                 {std::pair{0.49, 0.49}, {0.51, 0.49}, {0.49, 0.51}, {0.51, 0.51}})
                sure = sure && cast(x + dx, y + dy).first == centre.first;
            if (!sure) continue;
            const bool hit = centre.first < part.faces.size();
            ++(hit ? hits : misses);
            const double z = double(depth->at(x, y)[0]);
            ASSERT_EQ(std::isfinite(z), hit) << x << " " << y;
            if (!hit) continue;
            EXPECT_NEAR(z, centre.second, 5e-3) << x << " " << y;
            glm::dvec3 n, p;
            for (int k = 0; k < 3; ++k) {
                n[k] = double(normal->at(x, y)[k]);
                p[k] = double(position->at(x, y)[k]);
            }
            // Quads of the fillet are not quite planar: halves lean by a few degrees.
            EXPECT_GT(glm::dot(n, part.normals[centre.first]), 0.995) << x << " " << y;
            EXPECT_NEAR(glm::dot(eye - p, back), centre.second, 5e-3);
        }
    EXPECT_GT(hits, 300);
    EXPECT_GT(misses, 300);
}

}  // namespace
