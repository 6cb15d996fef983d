// Residual normal maps of curved surfaces against the facets of a far denser mesh at equal UVs, or
// of points of the surface at equal faces and parameters: positions alone, nothing of how normals
// are computed.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <numbers>

#include "command_runner.h"
#include "prep/image.h"
#include "prep/load.h"
#include "prep/prepare.h"
#include "prep/prepared_scene.h"
#include "prep/subdivide.h"
#include "shared_data.h"

namespace {

using test::run_here;
using test::TempDir;
using test::write_text;

constexpr int side = 4;  // samples along a texel's sides

// body(x, y, weights) for each point ((x + ½)/size, (y + ½)/size) in the triangle.
template <class Body>
void over_samples(const std::array<glm::dvec2, 3>& uv, double size, const Body& body) {
    const glm::dmat2 edges(uv[1] - uv[0], uv[2] - uv[0]);
    if (glm::determinant(edges) == 0) return;
    const glm::dmat2 inverse = glm::inverse(edges);
    const glm::dvec2 low = glm::min(uv[0], glm::min(uv[1], uv[2])) * size;
    const glm::dvec2 high = glm::max(uv[0], glm::max(uv[1], uv[2])) * size;
    for (double y = std::max(0.0, std::ceil(low.y - 0.5)); y + 0.5 <= high.y; ++y)
        for (double x = std::max(0.0, std::ceil(low.x - 0.5)); x + 0.5 <= high.x; ++x) {
            const glm::dvec2 w = inverse * (glm::dvec2(x + 0.5, y + 0.5) / size - uv[0]);
            if (w.x < 0 || w.y < 0 || w.x + w.y > 1 || x >= size || y >= size) continue;
            body(std::size_t(x), std::size_t(y), glm::dvec3(1 - w.x - w.y, w.x, w.y));
        }
}

struct Corners {
    std::array<glm::dvec2, 3> uv;
    std::array<glm::dvec3, 3> position, normal, tangent;
    double sign = 1;
};
Corners corners_of(const prep::Mesh& mesh, std::size_t f, bool with_tangents) {
    Corners c;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t at = mesh.face_offsets[f] + k;
        c.uv[k] = glm::dvec2(mesh.uvs[0].values[mesh.uvs[0].indices[at]]);
        c.position[k] = glm::dvec3(mesh.positions[mesh.corner_vertices[at]]);
        if (!with_tangents) continue;
        c.normal[k] = glm::dvec3(mesh.normals.values[mesh.normals.indices[at]]);
        const glm::vec4 t = mesh.tangents.values[mesh.tangents.indices[at]];
        c.tangent[k] = glm::dvec3(glm::vec3(t));
        c.sign = double(t.w);
    }
    return c;
}

// What the dense mesh has in each texel that it covers wholly.
struct Truth {
    std::vector<glm::dvec3> sums;
    std::vector<int> counts;
};
Truth truth_of(const prep::Scene& dense, std::size_t size) {
    Truth truth{std::vector<glm::dvec3>(size * size, glm::dvec3(0.0)),
                std::vector<int>(size * size, 0)};
    for (const prep::Mesh& mesh : dense.meshes)
        for (std::size_t f = 0; f < mesh.face_count(); ++f) {
            const Corners c = corners_of(mesh, f, false);
            const glm::dvec3 n =
                glm::cross(c.position[1] - c.position[0], c.position[2] - c.position[0]);
            if (glm::length(n) == 0) continue;
            over_samples(c.uv, double(size * side), [&](std::size_t x, std::size_t y, auto) {
                const std::size_t texel = y / side * size + x / side;
                truth.sums[texel] += glm::normalize(n);
                ++truth.counts[texel];
            });
        }
    return truth;
}

struct Angles {
    double p99 = 180, p99_without = 180;
    std::size_t count = 0;
};
double degrees_between(const glm::dvec3& a, const glm::dvec3& b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * 180 / std::numbers::pi;
}
Angles angles_of(std::vector<double>& found, std::vector<double>& without) {
    Angles angles;
    angles.count = found.size();
    if (found.empty()) return angles;
    const auto at = std::ptrdiff_t(found.size() * 99 / 100);
    std::nth_element(found.begin(), found.begin() + at, found.end());
    std::nth_element(without.begin(), without.begin() + at, without.end());
    angles.p99 = found[std::size_t(at)];
    angles.p99_without = without[std::size_t(at)];
    return angles;
}

Angles compare(const prep::Scene& coarse, const prep::Scene& dense) {
    Angles angles;
    if (coarse.materials.empty() || !coarse.materials[0].normal_map) return angles;
    const auto image = prep::load_image(
        coarse.images[coarse.textures[coarse.materials[0].normal_map.texture].image]);
    if (!image || image->channels != 3) return angles;
    const std::size_t size = image->width;
    const Truth truth = truth_of(dense, size);
    // What a reader shows, over the same points: smaller triangles than a texel are seen as well.
    std::vector<glm::dvec3> shown(size * size, glm::dvec3(0.0)), bare = shown;
    for (const prep::Mesh& mesh : coarse.meshes)
        for (std::size_t f = 0; f < mesh.face_count(); ++f) {
            const Corners c = corners_of(mesh, f, true);
            over_samples(
                c.uv, double(size * side), [&](std::size_t x, std::size_t y, glm::dvec3 w) {
                    const glm::dvec3 n = w.x * c.normal[0] + w.y * c.normal[1] + w.z * c.normal[2];
                    const glm::dvec3 t =
                        w.x * c.tangent[0] + w.y * c.tangent[1] + w.z * c.tangent[2];
                    const glm::dvec3 b = c.sign * glm::cross(n, t);
                    const float* m = image->at(std::uint32_t(x / side), std::uint32_t(y / side));
                    const std::size_t texel = y / side * size + x / side;
                    shown[texel] +=
                        glm::normalize((2 * double(m[0]) - 1) * t + (2 * double(m[1]) - 1) * b +
                                       (2 * double(m[2]) - 1) * n);
                    bare[texel] += glm::normalize(n);
                });
        }
    std::vector<double> found, without;
    for (std::size_t i = 0; i < truth.counts.size(); ++i) {
        if (truth.counts[i] != side * side) continue;
        found.push_back(degrees_between(shown[i], truth.sums[i]));
        without.push_back(degrees_between(bare[i], truth.sums[i]));
    }
    return angles_of(found, without);
}

// Each face in a cell of its own of the picture, with room around it.
std::string in_cells(const prep::Mesh& mesh) {
    std::string text;
    for (const glm::vec3& p : mesh.positions) text += fmt::format("v {} {} {}\n", p.x, p.y, p.z);
    const double across = std::ceil(std::sqrt(double(mesh.face_count())));
    std::string faces;
    std::size_t count = 0;
    for (std::size_t f = 0; f < mesh.face_count(); ++f) {
        const std::size_t first = mesh.face_offsets[f], n = mesh.face_offsets[f + 1] - first;
        const glm::dvec2 middle(std::fmod(double(f), across) + 0.5,
                                std::floor(double(f) / across) + 0.5);
        faces += "f";
        for (std::size_t k = 0; k < n; ++k) {
            const double turn = 2 * std::numbers::pi * (double(k) + 0.5) / double(n);
            const glm::dvec2 uv =
                (middle + 0.5 * glm::dvec2(std::cos(turn), std::sin(turn))) / across;
            text += fmt::format("vt {} {}\n", uv.x, uv.y);
            faces += fmt::format(" {}/{}", mesh.corner_vertices[first + k] + 1, ++count);
        }
        faces += "\n";
    }
    return text + faces;
}

class ResidualSurface : public testing::Test {
  protected:
    prep::Scene prepared(const std::string& name, const std::string& obj,
                         std::vector<std::string> options) {
        write_text(dir_ / "in.obj", obj);
        options.insert(options.begin(), {"prepare", (dir_ / "in.obj").string(), "-o",
                                         (dir_ / name).string(), "--quiet"});
        const test::Ran ran = run_here(options);
        EXPECT_EQ(ran.exit_code, 0) << ran.err;
        auto scene = prep::load_scene(dir_ / name);
        EXPECT_TRUE(scene) << to_string(scene.error());
        return *std::move(scene);
    }
    // p99 of `triangles` triangles with a map of `size` texels, against `dense` ones, which do
    // without the last options.
    void check(const char* what, const std::string& obj, std::vector<std::string> options,
               const char* triangles, const char* size, const char* dense, double gain,
               const std::vector<std::string>& of_the_coarse = {}) {
        options.insert(options.end(), {"--max-triangles", dense});
        const prep::Scene truth = prepared("dense.glb", obj, options);
        options.back() = triangles;
        for (const auto& [bits, most] : {std::pair("16", 1.5), std::pair("8", 2.0)}) {
            std::vector<std::string> with = options;
            with.insert(with.end(), {"--residual-normal-map", size, "--residual-bits", bits});
            with.insert(with.end(), of_the_coarse.begin(), of_the_coarse.end());
            const Angles angles = compare(prepared("coarse.glb", obj, with), truth);
            std::printf(
                "%s, %s triangles, %s texels a side, %s bits: p99 %.2f, without %.1f, %zu\n", what,
                triangles, size, bits, angles.p99, angles.p99_without, angles.count);
            EXPECT_GT(angles.count, 2000U) << what;
            EXPECT_LE(angles.p99, most) << what;
            EXPECT_GT(angles.p99_without, gain * angles.p99) << what;
        }
    }
    // Level at the borders of the cube's cells, so that the sides of its seams agree.
    std::string waves(const std::string& name, std::uint32_t channels) {
        constexpr std::uint32_t size = 256;
        const auto window = [](double t) {
            const double from_border = 0.5 * std::sqrt(0.5) - std::abs(std::fmod(3 * t, 1.0) - 0.5);
            const double s = std::clamp(from_border / 0.15, 0.0, 1.0);
            return s * s * (3 - 2 * s);
        };
        prep::Image image{.width = size, .height = size, .channels = channels, .pixels = {}};
        for (std::uint32_t y = 0; y < size; ++y)
            for (std::uint32_t x = 0; x < size; ++x)
                for (std::uint32_t k = 0; k < channels; ++k)
                    image.pixels.push_back(float(std::sin(0.16 * x + k) * std::cos(0.13 * y + k) *
                                                 window((x + 0.5) / size) *
                                                 window((y + 0.5) / size)));
        EXPECT_TRUE(prep::save_image(dir_ / name, image, prep::PixelType::f32));
        return (dir_ / name).string();
    }
    TempDir dir_;
};

prep::Mesh cube() {
    prep::Mesh mesh;
    for (int k = 0; k < 8; ++k)
        mesh.positions.emplace_back(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1);
    mesh.corner_vertices = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5};
    for (std::uint32_t f = 1; f <= 6; ++f) mesh.face_offsets.push_back(4 * f);
    return mesh;
}

TEST_F(ResidualSurface, HeightsOfALimitSurface) {
    check("cube, heights", in_cells(cube()),
          {"--subdivide", "catmark", "--displace", waves("waves.exr", 1), "--height-midlevel", "0",
           "--height-scale", "0.04", "--height-filter", "bicubic"},
          "1500", "256", "150k", 5);
}

// What a band limit leaves out of the triangles is in the map.
TEST_F(ResidualSurface, HeightsBeyondABandLimit) {
    check("cube, heights with a band limit", in_cells(cube()),
          {"--subdivide", "catmark", "--displace", waves("waves.exr", 1), "--height-midlevel", "0",
           "--height-scale", "0.04", "--height-filter", "bicubic"},
          "1500", "256", "150k", 5, {"--band-limit", "0.3"});
}

TEST_F(ResidualSurface, VectorsOfALimitSurface) {
    check("cube, vectors", in_cells(cube()),
          {"--subdivide", "catmark", "--displace", waves("vectors.exr", 3), "--displace-kind",
           "vector-object", "--height-scale", "0.03", "--height-filter", "bicubic"},
          "1500", "256", "150k", 5);
}

TEST_F(ResidualSurface, NoiseOfALimitSurface) {
    check("cube, noise", in_cells(cube()),
          {"--subdivide", "catmark", "--displace", "noise", "--noise-scale", "0.05",
           "--noise-frequency", "2.5"},
          "1500", "256", "100k", 5);
}

// The limit surface alone: what its triangles lack.
TEST_F(ResidualSurface, LimitSurfacesWithoutDisplacement) {
    check("cube", in_cells(cube()), {"--subdivide", "catmark"}, "24", "256", "60k", 2);
}

// Of a model's own atlas, with seams, and quads whose UVs are no parallelograms: there equal UVs of
// two triangles and of a dense mesh are other places of the surface. The truth is that of equal
// faces and parameters, by the surface's own points: a second UV set says which those are.
// (Of quads: n-gons have other parameters.)
class OfFacesAndParameters {
  public:
    static constexpr std::size_t rate = 128;  // samples along the sides of a face

    OfFacesAndParameters(const prep::Mesh& cage, const prep::NoiseOptions& noise)
        : across_(std::size_t(std::ceil(std::sqrt(double(cage.face_count()))))) {
        const auto surface = prep::LimitSurface::make(cage);
        const auto heights = prep::noise_function(noise);
        if (!surface || !heights) return;
        const std::size_t points = surface->grid_size(int(rate));
        std::vector<glm::dvec3> p(points), du(points), dv(points);
        truth_.resize(cage.face_count() * rate * rate);
        for (std::size_t grid = 0; grid < surface->grid_count(); ++grid) {
            const std::size_t f = surface->grid_face(grid);
            if (!is_quad(cage, f)) continue;
            surface->evaluate_grids(int(rate), grid, 1, {p, du, dv});
            for (std::size_t k = 0; k < points; ++k)
                p[k] += (*heights)->at(p[k]).value * glm::normalize(glm::cross(du[k], dv[k]));
            for (std::size_t j = 0; j < rate; ++j)
                for (std::size_t i = 0; i < rate; ++i) {
                    const std::size_t at = j * (rate + 1) + i, above = at + rate + 1;
                    truth_[(f * rate + j) * rate + i] =
                        glm::normalize(glm::cross(p[above + 1] - p[at], p[above] - p[at + 1]));
                }
        }
    }
    bool is_there() const { return !truth_.empty(); }
    double size() const { return double(across_ * rate); }

    // Quad f is the square of row f / across and column f % across; others lie outside.
    prep::CornerLayer<glm::vec2> squares(const prep::Mesh& cage) const {
        constexpr glm::vec2 corners[] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
        prep::CornerLayer<glm::vec2> uv;
        for (std::size_t f = 0; f < cage.face_count(); ++f)
            for (std::uint32_t c = cage.face_offsets[f]; c < cage.face_offsets[f + 1]; ++c) {
                uv.indices.push_back(c);
                uv.values.push_back(is_quad(cage, f) ? (glm::vec2(f % across_, f / across_) +
                                                        corners[c - cage.face_offsets[f]]) /
                                                           float(across_)
                                                     : glm::vec2(-1));
            }
        return uv;
    }
    const glm::dvec3& normal(std::size_t x, std::size_t y) const {
        const std::size_t f = y / rate * across_ + x / rate;
        return truth_[(f * rate + y % rate) * rate + x % rate];
    }

  private:
    static bool is_quad(const prep::Mesh& cage, std::size_t f) {
        return cage.face_offsets[f + 1] - cage.face_offsets[f] == 4;
    }
    std::size_t across_;
    std::vector<glm::dvec3> truth_;
};

// What texels show beside what they should, over those whose 4 × 4 parts all have a sample.
Angles compare(const prep::VertexMesh& mesh, const prep::Image& map,
               const OfFacesAndParameters& truth) {
    struct Texel {
        glm::dvec3 truth{0.0}, shown{0.0}, bare{0.0};
        unsigned parts = 0;
    };
    std::vector<Texel> texels(std::size_t(map.width) * map.height);
    for (std::size_t t = 0; t < mesh.indices.size() / 3; ++t) {
        std::array<std::uint32_t, 3> v;
        std::array<glm::dvec2, 3> uv, place;
        for (std::size_t k = 0; k < 3; ++k) {
            v[k] = mesh.indices[3 * t + k];
            uv[k] = glm::dvec2(mesh.uvs[0][v[k]]);
            place[k] = glm::dvec2(mesh.uvs[1][v[k]]);
        }
        const auto mixed = [&](glm::dvec3 w, const auto& of) {
            return w.x * of(v[0]) + w.y * of(v[1]) + w.z * of(v[2]);
        };
        over_samples(place, truth.size(), [&](std::size_t x, std::size_t y, glm::dvec3 w) {
            const glm::dvec3 n =
                mixed(w, [&](std::uint32_t i) { return glm::dvec3(mesh.normals[i]); });
            const glm::dvec3 tangent =
                mixed(w, [&](std::uint32_t i) { return glm::dvec3(mesh.tangents[i]); });
            const glm::dvec3 b = double(mesh.tangents[v[0]].w) * glm::cross(n, tangent);
            const glm::dvec2 at = double(map.width) * (w.x * uv[0] + w.y * uv[1] + w.z * uv[2]);
            const glm::uvec2 whole(glm::clamp(at, 0.0, double(map.width - 1)));
            const glm::uvec2 part(glm::clamp(4.0 * (at - glm::dvec2(whole)), 0.0, 3.0));
            const float* m = map.at(whole.x, whole.y);
            Texel& texel = texels[std::size_t(whole.y) * map.width + whole.x];
            texel.parts |= 1U << (4 * part.y + part.x);
            texel.truth += truth.normal(x, y);
            texel.bare += glm::normalize(n);
            texel.shown += glm::normalize((2 * double(m[0]) - 1) * tangent +
                                          (2 * double(m[1]) - 1) * b + (2 * double(m[2]) - 1) * n);
        });
    }
    std::vector<double> found, without;
    for (const Texel& texel : texels) {
        if (texel.parts != 0xffff) continue;
        found.push_back(degrees_between(texel.shown, texel.truth));
        without.push_back(degrees_between(texel.bare, texel.truth));
    }
    return angles_of(found, without);
}

TEST_F(ResidualSurface, SpotsCage) {
    MESHPREP_REQUIRE_SHARED(shared);
    auto spot = prep::load_scene(shared / "corpus/spot_control_mesh.obj");
    ASSERT_TRUE(spot) << to_string(spot.error());
    prep::Mesh& cage = spot->meshes[0];
    prep::PrepareOptions options;
    options.subdivide = options.tessellate = true;
    prep::NoiseOptions& noise = options.displacement.noise.emplace();
    noise.scale = 0.02;
    noise.frequency = 4;
    const OfFacesAndParameters truth(cage, noise);
    ASSERT_TRUE(truth.is_there());
    cage.uvs.push_back(truth.squares(cage));
    ASSERT_EQ(cage.uvs.size(), 2U);
    options.tessellation.max_triangles = 5000;
    for (const auto& [bits, most] : {std::pair(16, 1.5), std::pair(8, 2.0)}) {
        options.displacement.residual = prep::ResidualMapOptions{256, bits};
        const auto coarse = prep::prepare(*spot, options);
        ASSERT_TRUE(coarse) << to_string(coarse.error());
        ASSERT_EQ(coarse->residual_maps.size(), 1U);
        const auto map = prep::load_image(coarse->scene.images[coarse->residual_maps[0].image]);
        ASSERT_TRUE(map) << to_string(map.error());
        const Angles angles = compare(coarse->meshes[0], *map, truth);
        std::printf(
            "spot's cage, noise, its own UVs, 5000 triangles, %d bits: p99 %.2f, without "
            "%.1f, %zu\n",
            bits, angles.p99, angles.p99_without, angles.count);
        EXPECT_GT(angles.count, 20000U);
        EXPECT_LE(angles.p99, most);
        EXPECT_GT(angles.p99_without, 5 * angles.p99);
    }
}

}  // namespace
