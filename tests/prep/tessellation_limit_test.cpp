// Limit surfaces, tessellated: closed cages, normals, errors that are reached.
#include <gtest/gtest.h>

#include <limits>
#include <optional>

#include "limit_cages.h"
#include "prep/displacement/tessellate.h"
#include "prep/subdivide.h"
#include "tessellation/tessellation.h"

namespace prep {
namespace {

using namespace tessellation_checks;
// Against differences of the directions themselves. Points that come together, piece after piece
// and back, are those that come alone.
TEST(TessellationLimit, FramesTurnAsDirectionsDo) {
    std::mt19937 random(17);
    const auto part = [&] { return 0.1 + 0.3 * double(random()) / 4294967296.0; };
    for (const Cage& cage : cages()) {
        auto base = base_of(cage);
        ASSERT_TRUE(base) << to_string(base.error());
        const detail::Domain domain = domain_of(cage, *base);
        base->set_domain(domain);
        std::vector<detail::RootPoint> at;
        for (int k = 0; k < 200; ++k) {
            const auto root = std::uint32_t(random() % domain.roots.size());
            // Towards a corner of the cage, or away from all; then once more.
            const double y = k % 3 == 0 ? 0.01 * part() : part(), z = part() * (k % 3 == 0 ? y : 1);
            at.push_back({root, {1 - y - z, y, z}});
            if (k % 2 == 1) at.push_back(at[at.size() - 2]);
        }
        std::vector<detail::BaseFrame> frames(at.size());
        base->frames(at, frames);
        for (std::size_t k = 0; k < at.size(); ++k) {
            detail::BaseFrame alone;
            base->frames({&at[k], 1}, {&alone, 1});
            ASSERT_EQ(alone.point.position, frames[k].point.position) << k;
            ASSERT_EQ(alone.direction_steps, frames[k].direction_steps) << k;
            for (glm::length_t s = 0; s < 2; ++s) {
                constexpr double step = 1e-6;
                std::array<detail::RootPoint, 2> beside{at[k], at[k]};
                for (std::size_t side = 0; side < 2; ++side) {
                    const double by = side == 0 ? -step : step;
                    beside[side].weights[0] -= by;
                    beside[side].weights[s + 1] += by;
                }
                std::array<detail::BasePoint, 2> points;
                base->evaluate(beside, points);
                const glm::dvec3 turn = (points[1].direction - points[0].direction) / (2 * step);
                EXPECT_LE(glm::length(turn - frames[k].direction_steps[std::size_t(s)]),
                          2e-3 * (1 + glm::length(turn)))
                    << k;
            }
        }
    }
}

// Two squares side by side of which the second lacks UVs, all or one, or has one that is no number:
// its triangles have none, the first's theirs; so with the limit surface as with polygons, and with
// colours. Where no face has all of them there are none.
TEST(TessellationLimit, FacesWithoutUvsHaveNoneAndTheOthersTheirs) {
    Mesh sheet;
    sheet.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, 0, 0}, {2, 1, 0}};
    sheet.corner_vertices = {0, 1, 2, 3, 1, 4, 5, 2};
    sheet.face_offsets = {0, 4, 8};
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const std::vector<glm::vec2> values{{0, 0}, {1, 0}, {1, 1}, {0, 1}, {nan, 0}};
    constexpr std::uint32_t none = no_index;
    using Indices = std::vector<std::uint32_t>;
    for (const auto& [second, torn] :
         {std::pair(Indices{none, none, none, none}, 0u), std::pair(Indices{1, none, 3, 2}, 1u),
          std::pair(Indices{1, 0, 4, 2}, 1u)})
        for (const auto scheme :
             {std::optional<SubdivisionScheme>(), std::optional(SubdivisionScheme::catmark)}) {
            Mesh mesh = sheet;
            mesh.uvs.resize(1);
            mesh.uvs[0].values = values;
            mesh.uvs[0].indices = {0, 1, 2, 3};
            mesh.uvs[0].indices.insert(mesh.uvs[0].indices.end(), second.begin(), second.end());
            mesh.colors.resize(1);
            mesh.colors[0].indices = mesh.uvs[0].indices;
            for (const glm::vec2& uv : values) mesh.colors[0].values.emplace_back(uv, 0.5f, 1);
            TessellateOptions options;
            options.scheme = scheme;
            options.edge_length = 0.2;
            const auto made = tessellate(mesh, options);
            ASSERT_TRUE(made) << to_string(made.error());
            EXPECT_EQ(made->uv_sets_left_out, torn);
            EXPECT_EQ(made->color_sets_left_out, torn);
            const CornerLayer<glm::vec2>& uvs = made->mesh.uvs.at(0);
            const CornerLayer<glm::vec4>& colors = made->mesh.colors.at(0);
            std::vector<std::uint32_t> used(uvs.values.size(), 0);
            std::array<std::uint32_t, 2> corners{};
            for (std::size_t c = 0; c < made->mesh.corner_count(); ++c) {
                const std::uint32_t face = made->cage_faces[c / 3];
                ++corners[face];
                if (face == 1) {
                    ASSERT_EQ(uvs.indices[c], no_index);
                    ASSERT_EQ(colors.indices[c], no_index);
                    continue;
                }
                ASSERT_LT(uvs.indices[c], uvs.values.size());
                ++used[uvs.indices[c]];
                const glm::vec2 uv = uvs.values[uvs.indices[c]];
                const glm::vec3 at = made->mesh.positions[made->mesh.corner_vertices[c]];
                if (!scheme) {
                    EXPECT_LT(glm::length(uv - glm::vec2(at)), 1e-6f);
                }
                EXPECT_EQ(colors.values[colors.indices[c]], glm::vec4(uv, 0.5f, 1));
            }
            EXPECT_GT(corners[0], 100u);
            EXPECT_GT(corners[1], 100u);
            EXPECT_EQ(std::count(used.begin(), used.end(), 0u), 0);
        }
    // The other way round.
    Mesh second = sheet;
    second.uvs = {{values, {none, none, none, none, 0, 1, 2, 3}}};
    TessellateOptions fine;
    fine.edge_length = 0.2;
    const auto of_second = tessellate(second, fine);
    ASSERT_TRUE(of_second) << to_string(of_second.error());
    for (std::size_t c = 0; c < of_second->mesh.corner_count(); ++c) {
        const std::uint32_t index = of_second->mesh.uvs[0].indices[c];
        ASSERT_EQ(index == no_index, of_second->cage_faces[c / 3] == 0) << c;
        if (index == no_index) continue;
        const glm::vec3 at = of_second->mesh.positions[of_second->mesh.corner_vertices[c]];
        ASSERT_LT(glm::length(of_second->mesh.uvs[0].values[index] - glm::vec2(at.x - 1, at.y)),
                  1e-6f);
    }
    sheet.uvs = {{values, {0, 1, 2, none, none, 1, 2, 3}}};
    TessellateOptions options;
    options.edge_length = 0.2;
    const auto made = tessellate(sheet, options);
    ASSERT_TRUE(made) << to_string(made.error());
    EXPECT_EQ(made->uv_sets_left_out, 1u);
    EXPECT_TRUE(made->mesh.uvs.at(0).empty());
    // Nothing is left out of faces that had none, as beside lines that have some.
    sheet.uvs[0].indices.assign(8, no_index);
    const auto bare = tessellate(sheet, options);
    ASSERT_TRUE(bare) << to_string(bare.error());
    EXPECT_EQ(bare->uv_sets_left_out, 0u);
    const auto refined = subdivide(sheet);
    ASSERT_TRUE(refined) << to_string(refined.error());
    EXPECT_EQ(refined->uv_sets_left_out, 0u);
}

TEST(TessellationLimit, PointsAreThoseOfTheLimitSurface) {
    for (const Cage& cage : cages()) {
        const Mesh& mesh = cage.mesh;
        SubdivideOptions subdivision;
        subdivision.scheme = cage.scheme;
        const auto limit = LimitSurface::make(mesh, subdivision);
        ASSERT_TRUE(limit);
        TessellateOptions options;
        options.scheme = cage.scheme;
        options.edge_length = 0.3;
        const auto made = tessellate(mesh, options);
        ASSERT_TRUE(made) << to_string(made.error());
        // Corners of the cage, by another way.
        std::vector<SurfaceLocation> at(1);
        std::vector<SurfacePoint> points(1);
        std::vector<glm::dvec3> expected(mesh.vertex_count());
        for (std::uint32_t f = 0; f < mesh.face_count(); ++f) {
            const std::uint32_t first = mesh.face_offsets[f], n = mesh.face_offsets[f + 1] - first;
            for (std::uint32_t k = 0; k < n; ++k) {
                const std::uint32_t columns = 1 + std::uint32_t(std::sqrt(double(n - 1)));
                if (cage.scheme == SubdivisionScheme::loop)
                    at[0] = {f, double(k == 1), double(k == 2)};
                else if (n == 4)
                    at[0] = {f, k == 1 || k == 2 ? 1.0 : 0.0, k >= 2 ? 1.0 : 0.0};
                else
                    at[0] = {f, double(k % columns), double(k / columns)};
                limit->evaluate(at, points);
                expected[mesh.corner_vertices[first + k]] = points[0].position;
            }
        }
        for (std::size_t v = 0; v < made->mesh.vertex_count(); ++v) {
            if (made->cage_vertices[v] == no_index) continue;
            EXPECT_NEAR(glm::distance(glm::dvec3(made->mesh.positions[v]),
                                      expected[made->cage_vertices[v]]),
                        0, 1e-6);
        }
    }
}

TEST(TessellationLimit, ErrorAskedForIsProvedAndMeasured) {
    for (const Cage& cage : cages())
        for (const double asked : {0.03, 0.003, 0.0005}) {
            TessellateOptions options;
            options.scheme = cage.scheme;
            options.chord_error = asked;
            options.samples = 20000;
            const auto made = tessellate(cage.mesh, options);
            ASSERT_TRUE(made) << to_string(made.error());
            const TessellationCertificate& c = made->certificate;
            EXPECT_LE(c.measured, c.proved);
            EXPECT_LE(c.proved, asked);
            EXPECT_LE(c.proved, 4 * c.measured);
            EXPECT_EQ(c.unresolved, 0u);
        }
}

TEST(TessellationLimit, DisplacedErrorIsProvedAndMeasured) {
    for (auto& [cage, scheme] : cages()) {
        cage.uvs.resize(1);
        for (std::size_t c = 0; c < cage.corner_count(); ++c) {
            const glm::vec3 p = cage.positions[cage.corner_vertices[c]];
            cage.uvs[0].indices.push_back(std::uint32_t(c));
            cage.uvs[0].values.emplace_back(p.x + 0.3F * p.z, p.y - 0.4F * p.z);
        }
        for (const double asked : {0.03, 0.005}) {
            TessellateOptions options;
            options.scheme = scheme;
            options.chord_error = asked;
            options.samples = 20000;
            options.displacements = {{std::make_shared<Waves>(0.1, 4, 3, 0.5), 1, 0, 0}};
            const auto made = tessellate(cage, options);
            ASSERT_TRUE(made) << to_string(made.error());
            const TessellationCertificate& c = made->certificate;
            EXPECT_LE(c.measured, c.proved);
            EXPECT_LE(c.proved_refinable, asked);
            EXPECT_EQ(c.unresolved, 0u);
        }
    }
}

Mesh bipyramid(std::uint32_t n, const glm::vec3& at) {
    Mesh mesh;
    mesh.positions = {{0, 0, 1}, {0, 0, -1}};
    for (std::uint32_t k = 0; k < n; ++k) {
        const double a = 2 * std::numbers::pi * k / n;
        mesh.positions.emplace_back(std::cos(a), std::sin(a), 0);
    }
    for (glm::vec3& p : mesh.positions) p += at;
    for (std::uint32_t k = 0; k < n; ++k) {
        add_face(mesh, {0, 2 + k, 2 + (k + 1) % n});
        add_face(mesh, {1, 2 + (k + 1) % n, 2 + k});
    }
    return mesh;
}

class Constant final : public HeightFunction {
  public:
    explicit Constant(double value) : value_(value) {}
    Sample at(const glm::dvec2&) const override { return {value_, {}}; }
    double deviation(const std::array<glm::dvec2, 3>&, const std::array<double, 3>&,
                     double) const override {
        return 0;
    }

  private:
    double value_;
};

// Around a vertex of three triangles what there is shrinks to a quarter with each level, and is as
// exact far from the mesh's origin.
TEST(TessellationLimit, SmallErrorsAreReachedAroundEveryVertex) {
    for (const std::uint32_t n : {3u, 4u, 5u, 8u})
        for (const float far : {0.0F, 100.0F}) {
            Cage cage{bipyramid(n, glm::vec3(far, -far, far)), SubdivisionScheme::loop};
            cage.mesh.uvs.resize(1);
            cage.mesh.uvs[0].values.emplace_back(0, 0);
            cage.mesh.uvs[0].indices.resize(cage.mesh.corner_count());
            TessellateOptions options;
            options.scheme = cage.scheme;
            options.chord_error = 0.0005;
            options.triangle_limit = 300'000;
            options.samples = 20000;
            options.displacements = {{std::make_shared<Constant>(0.5), 0.2, 0, 0}};
            const auto made = tessellate(cage.mesh, options);
            ASSERT_TRUE(made) << n << ' ' << far << ": " << to_string(made.error());
            EXPECT_EQ(made->certificate.unresolved, 0u);
            EXPECT_LE(made->certificate.proved_refinable, *options.chord_error);
            EXPECT_LE(made->certificate.measured, made->certificate.proved);
            auto base = base_of(cage);
            const detail::Domain domain = domain_of(cage, *base);
            base->set_domain(domain);
            double before = 2;
            std::uint64_t path = 1;  // of the triangle at the tip
            for (int depth = 1; depth <= 32; ++depth) {
                const auto first = detail::path_weights(2 * path);
                const bool has_tip = first[0].x == 1 || first[1].x == 1 || first[2].x == 1;
                path = 2 * path + (has_tip ? 0 : 1);
                if (depth < 8 || depth % 4 != 0) continue;  // each time a quarter of the side
                const double bound = SampledTriangle(*base, 0, path).bound().direction;
                EXPECT_LE(bound, std::max(0.6 * before, 1e-6)) << n << ' ' << far << ' ' << depth;
                before = bound;
            }
        }
}

// At a vertex whose normal jumps no error is reached: what is halved towards it ends before
// vertices fall on each other.
TEST(TessellationLimit, JumpsAreHalvedToDifferentPoints) {
    for (const SubdivisionScheme scheme : {SubdivisionScheme::catmark, SubdivisionScheme::loop}) {
        Mesh cage = scheme == SubdivisionScheme::loop ? in_triangles(cube()) : cube();
        // Two creases that meet at a vertex, sharp corners at others.
        cage.subdivision.creases = {{0, 1, 10}, {1, 3, 10}, {3, 2, 10}, {2, 0, 10}, {4, 5, 10}};
        cage.subdivision.corners = {{0, 10}, {6, 10}};
        cage.uvs.resize(1);
        cage.uvs[0].values.emplace_back(0, 0);
        cage.uvs[0].indices.resize(cage.corner_count());
        TessellateOptions options;
        options.scheme = scheme;
        options.chord_error = 0.001;
        options.max_triangles = 40'000;
        options.displacements = {{std::make_shared<Constant>(0.5), 0.5, 0, 0}};
        const auto made = tessellate(cage, options);
        ASSERT_TRUE(made) << to_string(made.error());
        std::printf("%s: %llu triangles, %llu unresolved\n",
                    scheme == SubdivisionScheme::loop ? "loop" : "catmark",
                    (unsigned long long)made->certificate.triangles,
                    (unsigned long long)made->certificate.unresolved);
        const Closedness after = closedness(made->mesh);
        EXPECT_EQ(after.open_edges, 0u);
        EXPECT_EQ(after.zero_edges, 0u);
    }
}

TEST(TessellationLimit, ClosedCagesStayClosed) {
    std::mt19937 random(12);
    std::vector<Mesh> closed = {cube(), torus(6, 5), creased_cube(10), creased_cube(2.5F)};
    for (std::uint32_t n = 3; n <= 9; ++n) closed.push_back(prism(n));
    const std::size_t polygons = closed.size();
    for (std::size_t k = 0; k < polygons; ++k) closed.push_back(in_triangles(closed[k]));
    for (std::size_t k = 0; k < closed.size(); ++k) {
        Mesh& cage = closed[k];
        add_charts(cage, random);
        TessellateOptions options;
        options.scheme = k < polygons ? SubdivisionScheme::catmark : SubdivisionScheme::loop;
        options.edge_length = 0.15;
        options.displacements = {{std::make_shared<Waves>(0.1, 9, 7, 0.5), 1, 0, 0}};
        const auto made = tessellate(cage, options);
        ASSERT_TRUE(made) << to_string(made.error());
        const Closedness before = closedness(cage), after = closedness(made->mesh);
        EXPECT_EQ(after.open_edges, 0u);
        EXPECT_EQ(after.zero_edges, 0u);
        EXPECT_EQ(after.euler, before.euler);
        detail::TessellationHooks hooks;
        hooks.share_positions = false;
        const auto torn = detail::tessellate(cage, options, hooks);
        ASSERT_TRUE(torn);
        EXPECT_GT(closedness(torn->mesh).open_edges, 100u);
    }
}

TEST(TessellationLimit, ConstantOffsetKeepsTheLimitNormals) {
    std::mt19937 random(13);
    for (auto& [cage, scheme] : cages()) {
        add_charts(cage, random);
        TessellateOptions options;
        options.scheme = scheme;
        options.edge_length = 0.1;
        const auto plain = tessellate(cage, options);
        options.displacements = {{std::make_shared<Constant>(0.5), 0.1, 0.5, 0}};
        const auto at_midlevel = tessellate(cage, options);
        ASSERT_TRUE(plain && at_midlevel);
        EXPECT_TRUE(same_bytes(plain->mesh, at_midlevel->mesh));
        options.displacements[0].midlevel = 0;
        const auto offset = tessellate(cage, options);
        ASSERT_TRUE(offset);
        // Points moved by 0.05 along the normal that is written, except on creases.
        const auto normal_at = [](const Mesh& mesh, std::size_t c) {
            return glm::dvec3(mesh.normals.values[mesh.normals.indices[c]]);
        };
        std::map<std::uint32_t, std::set<std::uint32_t>> normals_of_vertex;
        for (std::size_t c = 0; c < plain->mesh.corner_count(); ++c)
            normals_of_vertex[plain->mesh.corner_vertices[c]].insert(
                plain->mesh.normals.indices[c]);
        std::map<std::array<float, 3>, glm::dvec3> by_base;
        for (std::size_t c = 0; c < plain->mesh.corner_count(); ++c) {
            const std::uint32_t v = plain->mesh.corner_vertices[c];
            if (normals_of_vertex[v].size() > 1) continue;
            const glm::vec3 moved =
                plain->mesh.positions[v] + glm::vec3(0.05 * normal_at(plain->mesh, c));
            by_base[{moved.x, moved.y, moved.z}] = normal_at(plain->mesh, c);
        }
        std::size_t found = 0;
        for (std::size_t c = 0; c < offset->mesh.corner_count(); ++c) {
            const glm::vec3 p = offset->mesh.positions[offset->mesh.corner_vertices[c]];
            const auto at = by_base.lower_bound({p.x - 1e-6F, -1e9F, -1e9F});
            for (auto near = at; near != by_base.end() && near->first[0] <= p.x + 1e-6F; ++near) {
                const glm::vec3 q(near->first[0], near->first[1], near->first[2]);
                if (glm::distance(p, q) > 1e-6F) continue;
                ++found;
                // 1e-4 degrees, and what floats leave of a unit vector.
                EXPECT_LE(glm::length(normal_at(offset->mesh, c) - near->second), 1.8e-6);
                break;
            }
        }
        EXPECT_GT(found, offset->mesh.corner_count() / 4);
    }
}

TEST(TessellationLimit, SameBytesWithAnyNumberOfThreads) {
    std::mt19937 random(14);
    for (const SubdivisionScheme scheme : {SubdivisionScheme::catmark, SubdivisionScheme::loop}) {
        Mesh cage = scheme == SubdivisionScheme::loop ? in_triangles(prism(7)) : prism(7);
        add_charts(cage, random);
        TessellateOptions options;
        options.scheme = scheme;
        options.chord_error = 0.01;
        options.displacements = {{std::make_shared<Waves>(0.1, 9, 7, 0.5), 1, 0, 0}};
        options.threads = 1;
        const auto one = tessellate(cage, options);
        ASSERT_TRUE(one);
        for (const int threads : {2, 8}) {
            options.threads = threads;
            const auto more = tessellate(cage, options);
            ASSERT_TRUE(more);
            EXPECT_TRUE(same_bytes(one->mesh, more->mesh)) << threads;
            EXPECT_EQ(one->certificate.proved, more->certificate.proved);
        }
    }
}

TEST(TessellationLimit, LoopTakesTrianglesOnly) {
    TessellateOptions options;
    options.scheme = SubdivisionScheme::loop;
    options.chord_error = 0.1;
    const auto made = tessellate(cube(), options);
    ASSERT_FALSE(made);
    EXPECT_NE(to_string(made.error()).find("triangle"), std::string::npos)
        << to_string(made.error());
}

}  // namespace
}  // namespace prep
