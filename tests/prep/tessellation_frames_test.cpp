// Vector maps in tangent space: where they move points to, that no point is farther off than
// proved, normals, and that a surface without seams has no gaps. The oracle is a cube whose faces
// are charts of their own, turned by quarters and some of them mirrored: its directions and
// MikkTSpace's tangents at its corners have closed forms.
#include <gtest/gtest.h>

#include "prep/displacement/tessellate.h"
#include "prep/load.h"
#include "prep/subdivide.h"
#include "shared_data.h"
#include "tessellation_checks.h"

namespace prep {
namespace {

using namespace tessellation_checks;

constexpr std::uint32_t cells = 16;  // texels along a side of a chart: corners are their centres
constexpr glm::uvec2 atlas(128, 64);

// A face's chart: uv = origin + s · along_s + t · along_t, where a point of the face is
// p0 + s (p1 − p0) + t (p3 − p0).
struct Chart {
    std::array<glm::dvec3, 4> p;
    glm::dvec2 origin, along_s, along_t;
    glm::dvec2 uv(const glm::dvec2& st) const { return origin + st.x * along_s + st.y * along_t; }
    glm::dvec2 st(const glm::dvec2& uv) const {
        return glm::inverse(glm::dmat2(along_s, along_t)) * (uv - origin);
    }
    glm::dvec3 point(const glm::dvec2& st) const {
        return p[0] + st.x * (p[1] - p[0]) + st.y * (p[3] - p[0]);
    }
    // Steps of the point by u and by v.
    glm::dmat2x3 by_uv() const {
        const glm::dmat2x3 by_st(p[1] - p[0], p[3] - p[0]);
        return by_st * glm::inverse(glm::dmat2(along_s, along_t));
    }
};

struct Atlas {
    Mesh mesh;
    std::vector<Chart> charts;
};

Atlas charted_cube() {
    Atlas out{cube(), {}};
    Mesh& mesh = out.mesh;
    mesh.uvs.resize(1);
    for (std::uint32_t f = 0; f < 6; ++f) {
        Chart chart;
        for (std::uint32_t k = 0; k < 4; ++k)
            chart.p[k] = glm::dvec3(mesh.positions[mesh.corner_vertices[4 * f + k]]);
        constexpr std::array<glm::dvec2, 4> quarters{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};
        const glm::dvec2 s = quarters[f % 4], t = quarters[(f + (f % 2 ? 1 : 3)) % 4];
        const glm::dvec2 low(8.5 + 40 * (f % 3), 6.5 + 30 * (f / 3));
        const glm::dvec2 first = low + double(cells) * -glm::min(glm::dvec2(0.0), s + t);
        chart.origin = first / glm::dvec2(atlas);
        chart.along_s = double(cells) * s / glm::dvec2(atlas);
        chart.along_t = double(cells) * t / glm::dvec2(atlas);
        for (const glm::dvec2 st : {glm::dvec2(0, 0), {1, 0}, {1, 1}, {0, 1}}) {
            mesh.uvs[0].indices.push_back(std::uint32_t(mesh.uvs[0].values.size()));
            mesh.uvs[0].values.push_back(glm::vec2(chart.uv(st)));
        }
        out.charts.push_back(chart);
    }
    return out;
}

glm::dvec3 mean(const std::array<glm::dvec3, 4>& v) {
    return (v[0] + v[1] + v[2] + v[3]) / 4.0;
}

// As a polygon has it: linear over the triangle of the face's fan that the point is in. `corners`
// in the order of the face.
glm::dvec3 over_fan(const std::array<glm::dvec3, 4>& corners, const glm::dvec3& centre,
                    const glm::dvec2& st) {
    constexpr std::array<glm::dvec2, 4> square{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
    for (std::size_t k = 0; k < 4; ++k) {
        const std::size_t l = (k + 1) % 4;
        const glm::dvec2 a = square[k] - 0.5, b = square[l] - 0.5, x = st - 0.5;
        const glm::dvec2 w = glm::inverse(glm::dmat2(a, b)) * x;
        if (w.x >= -1e-12 && w.y >= -1e-12)
            return w.x * corners[k] + w.y * corners[l] + (1 - w.x - w.y) * centre;
    }
    ADD_FAILURE();
    return centre;
}

// Columns: tangent, bitangent, normal, where the direction at the face's corners is towards them.
glm::dmat3 frame(const Chart& chart, const glm::dvec2& st, const glm::dvec3& n) {
    const glm::dmat2x3 by_uv = chart.by_uv();
    std::array<glm::dvec3, 4> tangents;
    for (std::size_t k = 0; k < 4; ++k) {
        const glm::dvec3 corner = glm::normalize(chart.p[k]);
        tangents[k] = glm::normalize(by_uv[0] - glm::dot(by_uv[0], corner) * corner);
    }
    const glm::dvec3 tangent = over_fan(tangents, mean(tangents), st);
    const glm::dvec3 t = glm::normalize(tangent - glm::dot(tangent, n) * n);
    glm::dvec3 b = glm::cross(n, t);
    if (glm::dot(b, by_uv[1]) > 0) b = -b;  // against growing v
    return {t, b, n};
}

glm::dvec3 polygon_direction(const Chart& chart, const glm::dvec2& st) {
    std::array<glm::dvec3, 4> corners;
    for (std::size_t k = 0; k < 4; ++k) corners[k] = glm::normalize(chart.p[k]);
    return glm::normalize(over_fan(corners, glm::normalize(mean(corners)), st));
}

Image picture(const std::function<glm::dvec3(std::uint32_t, std::uint32_t)>& f) {
    Image image{.width = atlas.x, .height = atlas.y, .channels = 3, .pixels = {}, .floating = true};
    for (std::uint32_t y = 0; y < atlas.y; ++y)
        for (std::uint32_t x = 0; x < atlas.x; ++x) {
            const glm::dvec3 value = f(x, y);
            for (int k = 0; k < 3; ++k) image.pixels.push_back(float(value[k]));
        }
    return image;
}

VectorMapOptions in_frame(VectorAxes axes) {
    VectorMapOptions options;
    options.axes = axes;
    options.map.midlevel = 0;
    return options;
}

TessellateOptions moved_by(const Image& image, const VectorMapOptions& options,
                           const Mesh* charts) {
    const auto map = vector_function(image, options, charts, 0);
    EXPECT_TRUE(map);
    TessellateOptions how;
    how.displacements = {{.height = nullptr, .vector = *map, .tangent_space = true}};
    return how;
}

// Per face and point of the grid: the limit surface's direction, of the refined cage.
std::vector<std::vector<glm::dvec3>> limit_directions(const Atlas& of) {
    SubdivideOptions options;
    options.level = 4;
    options.face_varying = FaceVaryingRule::all;
    const auto fine = subdivide(of.mesh, options);
    EXPECT_TRUE(fine);
    const Mesh& mesh = fine->mesh;
    std::vector<std::vector<glm::dvec3>> out(
        6, std::vector<glm::dvec3>((cells + 1) * (cells + 1), glm::dvec3(0.0)));
    for (std::size_t c = 0; c < mesh.corner_count(); ++c) {
        const glm::dvec2 uv(mesh.uvs[0].values[mesh.uvs[0].indices[c]]);
        for (std::size_t f = 0; f < 6; ++f) {
            const glm::dvec2 st = double(cells) * of.charts[f].st(uv), at = glm::round(st);
            if (glm::length(st - at) > 1e-3 || glm::min(at.x, at.y) < 0 ||
                glm::max(at.x, at.y) > cells)
                continue;
            out[f][std::size_t(at.y) * (cells + 1) + std::size_t(at.x)] =
                glm::dvec3(mesh.normals.values[mesh.normals.indices[c]]);
        }
    }
    return out;
}

// Every texel holds the same translation, as its own frame has it; there are 10⁶ beside the charts.
TEST(TessellationFrames, TranslationMovesEveryVertexByItselfAcrossSeams) {
    const glm::dvec3 step(0.25, -0.5, 0.125);
    const Atlas of = charted_cube();
    const auto limits = limit_directions(of);
    for (const bool limit : {false, true})
        for (const VectorAxes axes :
             {VectorAxes::tangent_normal_bitangent, VectorAxes::tangent_bitangent_normal}) {
            const Image image = picture([&](std::uint32_t x, std::uint32_t y) {
                for (std::size_t f = 0; f < 6; ++f) {
                    const glm::dvec2 uv((x + 0.5) / atlas.x, (y + 0.5) / atlas.y);
                    const glm::dvec2 at = glm::round(double(cells) * of.charts[f].st(uv));
                    if (glm::min(at.x, at.y) < 0 || glm::max(at.x, at.y) > cells) continue;
                    const glm::dvec2 st = at / double(cells);
                    const glm::dvec3 n =
                        limit ? limits[f][std::size_t(at.y) * (cells + 1) + std::size_t(at.x)]
                              : polygon_direction(of.charts[f], st);
                    const glm::dvec3 m = glm::transpose(frame(of.charts[f], st, n)) * step;
                    if (axes == VectorAxes::tangent_bitangent_normal) return m;
                    return glm::dvec3(m.x, m.z, m.y);
                }
                return glm::dvec3(1e6);
            });
            TessellateOptions how = moved_by(image, in_frame(axes), &of.mesh);
            if (limit) how.scheme = SubdivisionScheme::catmark;
            // As coarse as texels: all of its vertices lie at their centres.
            how.edge_length = limit ? 0.3 : 0.27;
            const auto moved = tessellate(of.mesh, how);
            how.displacements.clear();
            const auto rest = tessellate(of.mesh, how);
            ASSERT_TRUE(rest && moved);
            ASSERT_EQ(moved->mesh.vertex_count(), rest->mesh.vertex_count());
            ASSERT_GT(rest->mesh.vertex_count(), 300U);
            double most = 0;
            for (std::size_t v = 0; v < rest->mesh.vertex_count(); ++v)
                most = std::max(most, glm::length(glm::dvec3(moved->mesh.positions[v]) - step -
                                                  glm::dvec3(rest->mesh.positions[v])));
            EXPECT_LE(most, 1e-6) << limit;
        }
}

glm::dvec3 bilinear(const Image& image, const glm::dvec2& uv) {
    const double x = uv.x * image.width - 0.5, y = uv.y * image.height - 0.5;
    const double i = std::floor(x), j = std::floor(y), s = x - i, t = y - j;
    const auto at = [&](double a, double b) {
        const float* p = image.at(std::uint32_t(std::clamp(a, 0.0, image.width - 1.0)),
                                  std::uint32_t(std::clamp(b, 0.0, image.height - 1.0)));
        return glm::dvec3(p[0], p[1], p[2]);
    };
    return glm::mix(glm::mix(at(i, j), at(i + 1, j), s),
                    glm::mix(at(i, j + 1), at(i + 1, j + 1), s), t);
}

// A cube's polygons, whose directions turn by 109° along a diagonal, and vectors that are long
// beside what they differ by: the frame is most of the error. Noisy ones make it little.
TEST(TessellationFrames, NoPointIsFartherOffThanProved) {
    const Atlas of = charted_cube();
    std::mt19937 random(7);
    std::uniform_real_distribution<double> value(-1, 1);
    for (const double noise : {0.0, 0.02, 0.2}) {
        const Image image = picture([&](auto, auto) {
            return glm::dvec3(0.4, 0.2, -0.3) +
                   noise * glm::dvec3(value(random), value(random), value(random));
        });
        for (const double asked : {0.1, 0.02, 0.004}) {
            if (noise > 0.1 && asked < 0.02) continue;
            // Unconfined: the bilinear map as it stands.
            TessellateOptions how =
                moved_by(image, in_frame(VectorAxes::tangent_bitangent_normal), nullptr);
            how.chord_error = asked;
            const auto made = tessellate(of.mesh, how);
            ASSERT_TRUE(made) << to_string(made.error());
            const Mesh& mesh = made->mesh;
            double error = 0;
            std::size_t inside = 0;
            for (std::size_t t = 0; t < mesh.face_count(); ++t) {
                const Chart& chart = of.charts[made->cage_faces[t]];
                // What charts differ by at seams would hide all else.
                bool at_seam = false;
                for (std::size_t c = 3 * t; c < 3 * t + 3; ++c) {
                    const glm::dvec2 st =
                        chart.st(glm::dvec2(mesh.uvs[0].values[mesh.uvs[0].indices[c]]));
                    const glm::dvec2 off = glm::abs(st - 0.5);
                    at_seam = at_seam || std::max(off.x, off.y) > 0.5 - 1e-6;
                }
                if (at_seam) continue;
                ++inside;
                for (int j = 0; j <= 8; ++j)
                    for (int i = 0; i + j <= 8; ++i) {
                        glm::dvec3 p(0.0);
                        glm::dvec2 uv(0.0);
                        const double w[3] = {(8 - i - j) / 8.0, i / 8.0, j / 8.0};
                        for (std::size_t k = 0; k < 3; ++k) {
                            const std::size_t c = 3 * t + k;
                            p += w[k] * glm::dvec3(mesh.positions[mesh.corner_vertices[c]]);
                            uv += w[k] * glm::dvec2(mesh.uvs[0].values[mesh.uvs[0].indices[c]]);
                        }
                        const glm::dvec2 st = chart.st(uv);
                        const glm::dvec3 truth =
                            chart.point(st) +
                            frame(chart, st, polygon_direction(chart, st)) * bilinear(image, uv);
                        error = std::max(error, glm::length(truth - p));
                    }
            }
            EXPECT_LE(error, asked) << noise;
            EXPECT_GE(error, asked / 12) << noise;
            EXPECT_GT(inside, mesh.face_count() / 8);
            const auto& c = made->certificate;
            EXPECT_LE(c.proved_refinable, asked);
            EXPECT_LE(c.measured, c.proved);
        }
    }
}

// Without seams, where refinement alone decides: the error falls with the square of edges, and
// so do the bounds.
TEST(TessellationFrames, BoundsAreOfSecondOrder) {
    // A part of a torus, of one chart.
    const Mesh whole = torus(6, 6);
    Mesh sheet;
    sheet.positions = whole.positions;
    sheet.uvs.resize(1);
    for (std::uint32_t f = 0; f < 36; ++f) {
        if (f / 6 == 5 || f % 6 == 5) continue;
        std::vector<std::uint32_t> corners;
        for (std::uint32_t k = 0; k < 4; ++k) {
            const std::uint32_t v = whole.corner_vertices[4 * f + k];
            corners.push_back(v);
            sheet.uvs[0].indices.push_back(std::uint32_t(sheet.uvs[0].values.size()));
            sheet.uvs[0].values.emplace_back(float(v / 6) / 6, float(v % 6) / 6);
        }
        add_face(sheet, corners);
    }
    const Image image = picture([](auto, auto) { return glm::dvec3(0.4, 0.2, -0.3); });
    for (const bool limit : {false, true}) {
        std::vector<std::uint64_t> triangles;
        for (const double asked : {0.04, 0.01, 0.0025}) {
            TessellateOptions how =
                moved_by(image, in_frame(VectorAxes::tangent_bitangent_normal), nullptr);
            how.max_triangles = 1 << 20;
            how.chord_error = asked;
            if (limit) how.scheme = SubdivisionScheme::catmark;
            const auto made = tessellate(sheet, how);
            ASSERT_TRUE(made);
            triangles.push_back(made->mesh.face_count());
            EXPECT_LE(made->certificate.measured, made->certificate.proved);
            EXPECT_LE(made->certificate.proved, asked);
            // Faces share their frames where they meet.
            EXPECT_LE(made->certificate.largest_shared_gap, 1e-6);
            EXPECT_EQ(made->certificate.over_budget, 0U);
        }
        // A quarter of the error takes four times the triangles; by bounds of first order sixteen.
        EXPECT_LE(triangles[1], 6 * triangles[0]) << limit;
        EXPECT_LE(triangles[2], 6 * triangles[1]) << limit;
    }
}

// Linear over the UV plane.
class Slope final : public VectorFunction {
  public:
    Slope(const glm::dvec3& value, const glm::dvec3& du, const glm::dvec3& dv)
        : value_(value), du_(du), dv_(dv) {}
    Sample at(const glm::dvec2& uv) const override {
        return {value_ + uv.x * du_ + uv.y * dv_, du_, dv_};
    }
    double deviation(const std::array<glm::dvec2, 3>&, const std::array<glm::dvec3, 3>&,
                     double) const override {
        return 1e-12;
    }

  private:
    glm::dvec3 value_, du_, dv_;
};

// On a plane whose UVs turn from vertex to vertex neither the surface nor the map is off its
// linear interpolant, and of two parts one is nothing: that of the frame, or that of what the frame
// and the vectors change by together.
TEST(TessellationFrames, TangentsThatTurnOnAPlaneAreBounded) {
    Mesh sheet;
    sheet.uvs.resize(1);
    for (std::uint32_t y = 0; y < 4; ++y)
        for (std::uint32_t x = 0; x < 4; ++x) sheet.positions.emplace_back(x, y, 0);
    for (std::uint32_t y = 0; y < 3; ++y)
        for (std::uint32_t x = 0; x < 3; ++x) {
            add_face(sheet, {4 * y + x, 4 * y + x + 1, 4 * y + x + 5, 4 * y + x + 4});
            for (const glm::dvec2 at : {glm::dvec2(x, y), {x + 1, y}, {x + 1, y + 1}, {x, y + 1}}) {
                // Circles about a point beside the sheet: half a round.
                const double angle = 0.8 * at.x, radius = 1 + 0.3 * at.y;
                sheet.uvs[0].indices.push_back(std::uint32_t(sheet.uvs[0].values.size()));
                sheet.uvs[0].values.emplace_back(float(radius * std::cos(angle)),
                                                 float(radius * std::sin(angle)));
            }
        }
    for (const bool constant : {true, false}) {
        TessellateOptions how;
        const glm::dvec3 steep = constant ? glm::dvec3(0.0) : glm::dvec3(0.5, 0.25, 0);
        how.displacements = {
            {.height = nullptr,
             .vector = std::make_shared<Slope>(constant ? glm::dvec3(1, 0.5, 0) : glm::dvec3(0.0),
                                               steep, glm::dvec3(-steep.y, steep.x, 0)),
             .tangent_space = true}};
        for (const double asked : {0.2, 0.02, 0.002}) {
            how.chord_error = asked;
            const auto made = tessellate(sheet, how);
            ASSERT_TRUE(made) << to_string(made.error());
            const auto& c = made->certificate;
            EXPECT_LE(c.measured, c.proved) << constant;
            EXPECT_LE(c.proved, asked) << constant;
            EXPECT_GE(c.measured, c.proved / 8) << constant;
            EXPECT_LE(c.largest_shared_gap, 1e-6);
        }
    }
}

// By differences of the closed form, away from the edges of fans, where derivatives jump.
TEST(TessellationFrames, NormalsAreThoseOfTheMovedSurface) {
    const Atlas of = charted_cube();
    const Image image = picture([](std::uint32_t x, std::uint32_t y) {
        return glm::dvec3(0.2 + 0.004 * x, 0.1 - 0.004 * y, -0.1 + 0.003 * x + 0.005 * y);
    });
    TessellateOptions how =
        moved_by(image, in_frame(VectorAxes::tangent_bitangent_normal), nullptr);
    how.chord_error = 0.004;
    how.max_triangles = 20000;
    const auto made = tessellate(of.mesh, how);
    ASSERT_TRUE(made);
    const Mesh& mesh = made->mesh;
    double most = 0;
    int looked_at = 0;
    for (std::size_t c = 0; c < mesh.corner_count(); ++c) {
        const Chart& chart = of.charts[made->cage_faces[c / 3]];
        const glm::dvec2 at = chart.st(glm::dvec2(mesh.uvs[0].values[mesh.uvs[0].indices[c]]));
        if (std::abs(std::abs(at.x - 0.5) - std::abs(at.y - 0.5)) < 0.01 ||
            std::max(std::abs(at.x - 0.5), std::abs(at.y - 0.5)) > 0.49)
            continue;
        const auto point = [&](double s, double t) {
            const glm::dvec2 st = at + glm::dvec2(s, t);
            return chart.point(st) +
                   frame(chart, st, polygon_direction(chart, st)) * bilinear(image, chart.uv(st));
        };
        constexpr double h = 1e-5;
        const glm::dvec3 n =
            glm::normalize(glm::cross(point(h, 0) - point(-h, 0), point(0, h) - point(0, -h)));
        most = std::max(most,
                        glm::length(n - glm::dvec3(mesh.normals.values[mesh.normals.indices[c]])));
        ++looked_at;
    }
    EXPECT_GT(looked_at, 1000);
    EXPECT_LE(most, 2e-5);
}

// Faces without a UV gradient have a frame all the same: the same for any number of threads.
TEST(TessellationFrames, ChartsWithoutAreaAreMoved) {
    Atlas of = charted_cube();
    for (std::size_t c = 0; c < 8; ++c) of.mesh.uvs[0].values[of.mesh.uvs[0].indices[c]] = {};
    const Image image = picture([](auto, auto) { return glm::dvec3(0.1, 0.2, 0.3); });
    std::vector<glm::vec3> first;
    for (const int threads : {1, 4}) {
        TessellateOptions how =
            moved_by(image, in_frame(VectorAxes::tangent_normal_bitangent), nullptr);
        how.chord_error = 0.01;
        how.triangle_limit = 5000;
        how.threads = threads;
        const auto made = tessellate(of.mesh, how);
        ASSERT_TRUE(made) << to_string(made.error());
        EXPECT_LE(made->certificate.measured, made->certificate.proved);
        if (first.empty()) first = made->mesh.positions;
        EXPECT_EQ(made->mesh.positions, first);
        for (const glm::vec3& p : first) EXPECT_TRUE(glm::length(p) < 3);
    }
}

// A plane of three squares: that in the middle has no chart, those beside it are turned by 180°, so
// that its corners' tangents cancel along a line.
TEST(TessellationFrames, TangentsThatCancelHaveAnEnd) {
    Mesh mesh;
    for (int x = 0; x < 4; ++x)
        for (int y = 0; y < 2; ++y) mesh.positions.emplace_back(x, y, 0);
    mesh.face_offsets = {0};
    mesh.uvs.resize(1);
    for (std::uint32_t q = 0; q < 3; ++q) {
        const std::array<std::uint32_t, 4> quad{2 * q, 2 * q + 2, 2 * q + 3, 2 * q + 1};
        for (const std::uint32_t v : quad) {
            const glm::vec2 at(mesh.positions[v]);
            mesh.corner_vertices.push_back(v);
            mesh.uvs[0].indices.push_back(std::uint32_t(mesh.uvs[0].values.size()));
            mesh.uvs[0].values.push_back(q == 0   ? 0.2F * at
                                         : q == 2 ? glm::vec2(1) - 0.2F * at
                                                  : glm::vec2(0.5F));
        }
        mesh.face_offsets.push_back(std::uint32_t(mesh.corner_vertices.size()));
    }
    const Image image = picture([](auto, auto) { return glm::dvec3(0.1, 0, 0); });
    for (const bool by_length : {false, true}) {
        TessellateOptions how =
            moved_by(image, in_frame(VectorAxes::tangent_normal_bitangent), nullptr);
        (by_length ? how.edge_length : how.chord_error) = by_length ? 0.3 : 0.01;
        how.triangle_limit = 5000;
        const auto made = tessellate(mesh, how);
        ASSERT_TRUE(made) << by_length << " " << to_string(made.error());
        EXPECT_LE(made->certificate.measured, made->certificate.proved);
        EXPECT_GT(made->certificate.largest_shared_gap, 0.05);
    }
}

// Faces whose direction turns so far that it meets the tangent between the corners, though these
// have tangents that lean to one another: some of spot's.
TEST(TessellationFrames, DirectionsThatTurnIntoTheTangentHaveAnEnd) {
    MESHPREP_REQUIRE_SHARED(shared);
    auto scene = load_scene(shared / "corpus/spot_control_mesh.obj");
    ASSERT_TRUE(scene) << to_string(scene.error());
    Image image;
    image.width = image.height = 16;
    image.channels = 3;
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x)
            for (const double v : {0.3 + 0.1 * std::cos(0.4 * x), 0.2 * std::sin(0.4 * y), 0.1})
                image.pixels.push_back(float(v));
    VectorMapOptions options = in_frame(VectorAxes::tangent_bitangent_normal);
    options.map.scale = 0.1;
    for (const bool limit : {false, true}) {
        TessellateOptions how = moved_by(image, options, nullptr);
        if (limit) how.scheme = SubdivisionScheme::catmark;
        how.chord_error = 0.02;
        how.triangle_limit = 30'000;
        const auto made = tessellate(scene->meshes[0], how);
        ASSERT_TRUE(made) << to_string(made.error());
        EXPECT_LE(made->certificate.proved_refinable, 0.02);
        EXPECT_LE(made->certificate.measured, made->certificate.proved);
    }
}

// Charts that are moved along their directions by 0.5 or not at all: along their seams edges stay
// longer than what is asked for, however fine the triangles are, and are counted.
TEST(TessellationFrames, EdgesAcrossGapsAreNotHalvedForEver) {
    const Atlas of = charted_cube();
    const Image image =
        picture([](std::uint32_t x, auto) { return glm::dvec3(0, x < 36 ? 0.5 : 0.0, 0); });
    TessellateOptions how =
        moved_by(image, in_frame(VectorAxes::tangent_normal_bitangent), nullptr);
    how.edge_length = 0.2;
    how.triangle_limit = 50000;
    const auto moved = tessellate(of.mesh, how);
    how.displacements.clear();
    const auto rest = tessellate(of.mesh, how);
    ASSERT_TRUE(rest && moved);
    EXPECT_EQ(rest->certificate.unresolved, 0U);
    EXPECT_GT(moved->certificate.unresolved, 20U);
    EXPECT_GT(moved->certificate.largest_shared_gap, 0.2);
    // Two of six charts have wider faces, and neighbours' triangles are halved along.
    EXPECT_LT(moved->certificate.triangles, 4 * rest->certificate.triangles);
    const Mesh& mesh = moved->mesh;
    std::size_t longer = 0;
    for (std::size_t c = 0; c < mesh.corner_count(); ++c) {
        const std::size_t next = c % 3 == 2 ? c - 2 : c + 1;
        const glm::dvec3 edge(mesh.positions[mesh.corner_vertices[next]] -
                              mesh.positions[mesh.corner_vertices[c]]);
        longer += glm::length(edge) > 0.2000001;
    }
    EXPECT_GT(longer, 0U);
    EXPECT_LE(longer, 3 * moved->certificate.unresolved);
}

}  // namespace
}  // namespace prep
