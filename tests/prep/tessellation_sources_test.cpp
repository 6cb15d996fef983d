// Vector maps and noise in tessellation: where they move points to, that no point is farther off
// than proved, and normals.
#include <gtest/gtest.h>

#include "displacement/noise_field.h"
#include "prep/displacement/tessellate.h"
#include "prep/prepare.h"
#include "tessellation_checks.h"

namespace prep {
namespace {

using namespace tessellation_checks;

Image vectors(std::uint32_t size,
              const std::function<glm::dvec3(std::uint32_t, std::uint32_t)>& f) {
    Image image{.width = size, .height = size, .channels = 3, .pixels = {}, .floating = true};
    for (std::uint32_t y = 0; y < size; ++y)
        for (std::uint32_t x = 0; x < size; ++x)
            for (int k = 0; k < 3; ++k) image.pixels.push_back(float(f(x, y)[k]));
    return image;
}

VectorMapOptions object_space() {
    VectorMapOptions options;
    options.axes = VectorAxes::object;
    options.map.midlevel = 0;
    return options;
}

// Two charts, one of them turned and mirrored, of two quads that share an edge; and a third face
// across two of its edges, so that seams meet at a point.
Mesh seamed() {
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0.1F}, {2, 0, 0}, {2, 1, 0.3F}, {1, 1, 0}, {0, 1, 0.2F}};
    add_face(mesh, {0, 1, 4, 5});
    add_face(mesh, {1, 2, 3, 4});
    mesh.uvs.resize(1);
    const std::vector<glm::vec2> uvs{{0.1F, 0.2F}, {0.4F, 0.2F}, {0.4F, 0.5F}, {0.1F, 0.5F},
                                     {0.9F, 0.5F}, {0.9F, 0.2F}, {0.6F, 0.2F}, {0.6F, 0.5F}};
    for (const glm::vec2& uv : uvs) {
        mesh.uvs[0].indices.push_back(std::uint32_t(mesh.uvs[0].values.size()));
        mesh.uvs[0].values.push_back(uv);
    }
    return mesh;
}

// Whatever the file's form, and whatever lies one texel outside of the charts.
TEST(TessellationSources, TranslationMovesEveryVertexByItself) {
    constexpr std::uint32_t size = 64;
    const glm::dvec3 step(0.25, -0.5, 0.125);
    const Mesh mesh = seamed();
    for (const bool limit : {false, true})
        for (const int bits : {0, 16}) {
            Image image = vectors(size, [&](std::uint32_t x, std::uint32_t y) {
                const double u = (x + 0.5) / size, v = (y + 0.5) / size;
                const bool covered =
                    v >= 0.2 && v <= 0.5 && ((u >= 0.1 && u <= 0.4) || (u >= 0.6 && u <= 0.9));
                if (!covered) return bits == 0 ? glm::dvec3(1e6) : glm::dvec3(1.0);
                // 0.5 is the code 32768 in integers; steps of 1/65535 times 4.
                return bits == 0 ? step
                                 : (glm::dvec3(32768) + glm::round(step / 4.0 * 65535.0)) / 65535.0;
            });
            VectorMapOptions options = object_space();
            glm::dvec3 expected = step;
            if (bits == 16) {
                image.integer_bits = 16;
                image.floating = false;
                options.map.midlevel = 0.5;
                options.map.scale = 4;
                expected = glm::round(step / 4.0 * 65535.0) / 65535.0 * 4.0;
            }
            const auto map = vector_function(image, options, &mesh, 0);
            ASSERT_TRUE(map) << to_string(map.error());
            TessellateOptions how;
            how.edge_length = 0.2;
            if (limit) how.scheme = SubdivisionScheme::catmark;
            const auto rest = tessellate(mesh, how);
            how.displacements = {{.height = nullptr, .vector = *map}};
            const auto moved = tessellate(mesh, how);
            ASSERT_TRUE(rest && moved);
            ASSERT_EQ(moved->mesh.vertex_count(), rest->mesh.vertex_count());
            for (std::size_t v = 0; v < rest->mesh.vertex_count(); ++v)
                EXPECT_LE(glm::length(glm::dvec3(moved->mesh.positions[v]) - expected -
                                      glm::dvec3(rest->mesh.positions[v])),
                          1e-6);
            // A translation turns nothing.
            for (std::size_t n = 0; n < rest->mesh.normals.values.size(); ++n)
                EXPECT_LE(glm::length(moved->mesh.normals.values[n] - rest->mesh.normals.values[n]),
                          1e-5F);
            // Unconfined, the gutters' vectors reach into the charts.
            how.displacements[0].vector = *vector_function(image, options);
            how.edge_length.reset();
            how.max_triangles = 2000;
            const auto poisoned = tessellate(mesh, how);
            ASSERT_TRUE(poisoned) << to_string(poisoned.error());
            double most = 0;
            for (const glm::vec3& p : poisoned->mesh.positions) most = std::max(most, double(p.z));
            EXPECT_GT(most, 1);
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

// Of |truth − triangle| at equal UVs, over a grid in each triangle.
template <class Truth>
double largest_error(const Mesh& mesh, const Truth& truth) {
    double most = 0;
    for (std::size_t t = 0; t < mesh.face_count(); ++t)
        for (int j = 0; j <= 10; ++j)
            for (int i = 0; i + j <= 10; ++i) {
                glm::dvec3 p(0.0);
                glm::dvec2 uv(0.0);
                const double w[3] = {(10 - i - j) / 10.0, i / 10.0, j / 10.0};
                for (std::size_t k = 0; k < 3; ++k) {
                    p += w[k] * glm::dvec3(mesh.positions[mesh.corner_vertices[3 * t + k]]);
                    uv += w[k] * glm::dvec2(mesh.uvs[0].values[mesh.uvs[0].indices[3 * t + k]]);
                }
                most = std::max(most, glm::length(truth(uv) - p));
            }
    return most;
}

TEST(TessellationSources, NoPointOfAVectorMapIsFartherOffThanProved) {
    std::mt19937 random(23);
    std::uniform_real_distribution<double> value(-1, 1);
    for (const std::uint32_t size : {4u, 11u, 40u}) {
        const Image image = vectors(size, [&](auto, auto) {
            return glm::dvec3(value(random), value(random), value(random));
        });
        VectorMapOptions options = object_space();
        options.map.scale = 0.1;
        options.map.wrap_u = options.map.wrap_v = Wrap::clamp;
        const auto map = vector_function(image, options);
        ASSERT_TRUE(map);
        for (const double asked : {0.05, 0.01}) {
            TessellateOptions how;
            how.displacements = {{.height = nullptr, .vector = *map}};
            how.chord_error = asked;
            const auto made = tessellate(unit_quad(), how);
            ASSERT_TRUE(made) << to_string(made.error());
            const double error = largest_error(made->mesh, [&](const glm::dvec2& uv) {
                return glm::dvec3(uv, 0) + 0.1 * bilinear(image, uv);
            });
            EXPECT_LE(error, made->certificate.proved);
            EXPECT_LE(made->certificate.proved, asked);
            EXPECT_LE(made->certificate.proved, 4 * error);
        }
    }
}

detail::NoiseField field_of(const NoiseOptions& options) {
    auto made = detail::NoiseField::make(options);
    EXPECT_TRUE(made);
    return *made;
}

TEST(TessellationSources, NoPointOfNoiseIsFartherOffThanProved) {
    for (const NoiseKind kind : {NoiseKind::perlin, NoiseKind::simplex})
        for (const int octaves : {1, 4}) {
            NoiseOptions noise{.kind = kind, .frequency = 3, .octaves = octaves, .seed = 5};
            noise.scale = 0.1;
            const detail::NoiseField field = field_of(noise);
            const auto heights = noise_function(noise);
            ASSERT_TRUE(heights);
            for (const double asked : {0.02, 0.004}) {
                TessellateOptions how;
                how.displacements = {{.height = nullptr, .noise = *heights}};
                how.chord_error = asked;
                const auto made = tessellate(unit_quad(), how);
                ASSERT_TRUE(made) << to_string(made.error());
                const double error = largest_error(made->mesh, [&](const glm::dvec2& uv) {
                    return glm::dvec3(uv, field.value({uv.x, uv.y, 0}));
                });
                EXPECT_LE(error, made->certificate.proved);
                EXPECT_LE(made->certificate.proved, asked);
                EXPECT_LE(made->certificate.proved, 4 * error);
            }
        }
}

// On a curved surface: along the limit normals, from the limit points; what is measured is proved.
TEST(TessellationSources, NoiseMovesLimitPointsAlongTheirNormals) {
    NoiseOptions noise{.frequency = 2, .octaves = 3, .seed = 9};
    noise.scale = 0.2;
    const detail::NoiseField field = field_of(noise);
    TessellateOptions how;
    how.scheme = SubdivisionScheme::catmark;
    how.chord_error = 0.01;
    how.samples = 100'000;
    const auto rest = tessellate(cube(), how);
    how.displacements = {{.height = nullptr, .noise = *noise_function(noise)}};
    const auto made = tessellate(cube(), how);
    ASSERT_TRUE(rest && made);
    EXPECT_LE(made->certificate.measured, made->certificate.proved);
    EXPECT_LE(made->certificate.proved, 0.01);
    EXPECT_LE(made->certificate.proved, 12 * made->certificate.measured);
    const auto at = [](const TessellatedMesh& of, std::uint32_t cage) {
        for (std::uint32_t v = 0; v < of.cage_vertices.size(); ++v)
            if (of.cage_vertices[v] == cage) return v;
        return no_index;
    };
    for (std::uint32_t v = 0; v < 8; ++v) {
        const std::uint32_t from = at(*rest, v), to = at(*made, v);
        ASSERT_NE(from, no_index);
        ASSERT_NE(to, no_index);
        const glm::dvec3 p(rest->mesh.positions[from]);
        // The cube's own symmetry: the normal at a corner is the direction from the middle.
        const glm::dvec3 expected = p + field.value(p) * glm::normalize(p);
        EXPECT_LE(glm::length(glm::dvec3(made->mesh.positions[to]) - expected), 1e-6);
    }
}

// Heights that are linear in space leave nothing over a plane triangle: all comes from the
// surface's own way through its parameters. A plane cage of uneven quads: the normal is one
// everywhere.
class Slope final : public SpaceFunction {
  public:
    static constexpr double k = 20;
    Sample at(const glm::dvec3& p) const override { return {k * p.x, {k, 0, 0}}; }
    double deviation(const std::array<glm::dvec3, 3>&) const override { return 0; }
    double steepest() const override { return k; }
};

TEST(TessellationSources, HeightsInSpaceFollowTheSurfaceThroughItsParameters) {
    Mesh mesh;
    const std::array<float, 5> steps{0, 0.1F, 0.8F, 0.9F, 2};
    for (const float y : steps)
        for (const float x : steps) mesh.positions.emplace_back(x, y, 0);
    for (std::uint32_t j = 0; j < 4; ++j)
        for (std::uint32_t i = 0; i < 4; ++i)
            add_face(mesh, {5 * j + i, 5 * j + i + 1, 5 * j + i + 6, 5 * j + i + 5});
    for (const std::uint64_t most : {64u, 200u, 1000u}) {
        TessellateOptions how;
        how.scheme = SubdivisionScheme::catmark;
        how.max_triangles = most;
        how.samples = 50'000;
        how.displacements = {{.height = nullptr, .noise = std::make_shared<Slope>()}};
        const auto made = tessellate(mesh, how);
        ASSERT_TRUE(made) << to_string(made.error());
        EXPECT_GT(made->certificate.measured, 0);
        EXPECT_LE(made->certificate.measured, made->certificate.proved);
    }
}

// However steep noise is, it adds no more to an error than its values span: 2.2 times its scale.
TEST(TessellationSources, SteepNoiseCostsWhatItsValuesSpan) {
    const auto made_of = [](double frequency, double scale, double asked) {
        NoiseOptions noise;
        noise.frequency = frequency;
        noise.scale = scale;
        noise.octaves = 1;
        TessellateOptions how;
        how.scheme = SubdivisionScheme::catmark;
        how.chord_error = asked;
        how.samples = 10'000;
        if (scale > 0) how.displacements = {{.height = nullptr, .noise = *noise_function(noise)}};
        return tessellate(cube(), how);
    };
    constexpr double scale = 0.001, span = 2.2 * scale;
    for (const double asked : {0.005, 0.02}) {
        const auto smooth = made_of(1, 0, asked - 1.01 * span);
        ASSERT_TRUE(smooth) << to_string(smooth.error());
        for (const double frequency : {1e3, 1e6}) {
            const auto steep = made_of(frequency, scale, asked);
            ASSERT_TRUE(steep) << to_string(steep.error());
            const TessellationCertificate& c = steep->certificate;
            EXPECT_LE(c.proved, asked);
            EXPECT_LE(c.measured, c.proved);
            EXPECT_LE(c.triangles, smooth->certificate.triangles) << frequency << " " << asked;
        }
    }
}

// Where charts hold different vectors a shared point has the middle of them, whatever the order of
// faces.
TEST(TessellationSources, SeamsHaveTheMiddleOfTheirSidesVectors) {
    constexpr std::uint32_t size = 64;
    const Image image = vectors(size, [](std::uint32_t x, std::uint32_t) {
        return x < size / 2 ? glm::dvec3(0.25, 0, 1) : glm::dvec3(0, -0.5, 3);
    });
    for (const bool turned : {false, true}) {
        Mesh mesh = seamed();
        if (turned) {
            std::rotate(mesh.corner_vertices.begin(), mesh.corner_vertices.begin() + 4,
                        mesh.corner_vertices.end());
            std::rotate(mesh.uvs[0].indices.begin(), mesh.uvs[0].indices.begin() + 4,
                        mesh.uvs[0].indices.end());
        }
        TessellateOptions how;
        how.edge_length = 3;
        how.displacements = {
            {.height = nullptr, .vector = *vector_function(image, object_space(), &mesh, 0)}};
        const auto moved = tessellate(mesh, how);
        ASSERT_TRUE(moved) << to_string(moved.error());
        int found = 0;
        for (std::size_t v = 0; v < moved->cage_vertices.size(); ++v) {
            const std::uint32_t cage = moved->cage_vertices[v];
            if (cage == no_index) continue;
            const glm::dvec3 step =
                glm::dvec3(moved->mesh.positions[v]) - glm::dvec3(mesh.positions[cage]);
            const bool seam = cage == 1 || cage == 4, left = cage == 0 || cage == 5;
            const glm::dvec3 expected = seam   ? glm::dvec3(0.125, -0.25, 2)
                                        : left ? glm::dvec3(0.25, 0, 1)
                                               : glm::dvec3(0, -0.5, 3);
            EXPECT_LE(glm::length(step - expected), 1e-6) << cage;
            found += seam;
        }
        EXPECT_EQ(found, 2);
        EXPECT_NEAR(moved->certificate.largest_shared_gap, glm::length(glm::dvec3(0.125, 0.25, 1)),
                    1e-5);
    }
}

// A vector field and a noise together: the normal of the sum by differences of the closed form.
class Swirl final : public VectorFunction {
  public:
    Sample at(const glm::dvec2& uv) const override {
        const double s = std::sin(5 * uv.x + 1), c = std::cos(4 * uv.y);
        return {{0.05 * s, 0.04 * s * c, 0.1 * c},
                {0.25 * std::cos(5 * uv.x + 1), 0.2 * std::cos(5 * uv.x + 1) * c, 0},
                {0, -0.16 * s * std::sin(4 * uv.y), -0.4 * std::sin(4 * uv.y)}};
    }
    double deviation(const std::array<glm::dvec2, 3>& uv, const std::array<glm::dvec3, 3>&,
                     double) const override {
        double most = 0;
        for (std::size_t k = 0; k < 3; ++k)
            most = std::max(most, glm::length(uv[k] - uv[(k + 1) % 3]));
        return 0.5 * 5 * most * most;  // second derivatives are below 4 in all directions
    }
};

TEST(TessellationSources, NormalsAreThoseOfTheSum) {
    NoiseOptions noise{.frequency = 2, .octaves = 2, .seed = 3};
    noise.scale = 0.1;
    const detail::NoiseField field = field_of(noise);
    const Swirl swirl;
    TessellateOptions how;
    how.displacements = {
        {.height = nullptr, .noise = *noise_function(noise), .vector = std::make_shared<Swirl>()}};
    how.edge_length = 0.1;
    const auto made = tessellate(unit_quad(), how);
    ASSERT_TRUE(made);
    const auto point = [&](const glm::dvec2& uv) {
        return glm::dvec3(uv, field.value({uv.x, uv.y, 0})) + swirl.at(uv).value;
    };
    double most = 0;
    for (std::size_t c = 0; c < made->mesh.corner_count(); ++c) {
        const glm::dvec2 uv(made->mesh.uvs[0].values[made->mesh.uvs[0].indices[c]]);
        constexpr double h = 1e-5;
        const glm::dvec3 n =
            glm::normalize(glm::cross(point(uv + glm::dvec2(h, 0)) - point(uv - glm::dvec2(h, 0)),
                                      point(uv + glm::dvec2(0, h)) - point(uv - glm::dvec2(0, h))));
        most = std::max(
            most,
            glm::length(n - glm::dvec3(made->mesh.normals.values[made->mesh.normals.indices[c]])));
        EXPECT_LE(glm::length(point(uv) -
                              glm::dvec3(made->mesh.positions[made->mesh.corner_vertices[c]])),
                  1e-6);
    }
    EXPECT_LE(most, 1e-5);
}

// What moves later would not fit: the mesh stays, and a warning says so; others are displaced.
TEST(TessellationSources, MovingMeshesStayAsTheyAre) {
    for (const bool skin : {false, true}) {
        Scene scene;
        scene.meshes = {unit_quad(), unit_quad()};
        if (skin)
            scene.meshes[0].skin_influences.push_back(unweighted(scene.meshes[0]));
        else
            scene.meshes[0].morph_targets.emplace_back();
        PrepareOptions options;
        options.tessellate = true;
        options.displacement.noise = NoiseOptions{};
        options.tessellation.edge_length = 0.2;
        options.displacement.residual = ResidualMapOptions{.size = 16};
        const auto made = prepare(scene, options);
        ASSERT_TRUE(made) << to_string(made.error());
        EXPECT_EQ(made->meshes[0].positions, scene.meshes[0].positions);
        EXPECT_EQ(made->meshes[0].triangle_count(), 2U);
        EXPECT_FALSE(made->tessellated[0]);
        EXPECT_GT(made->meshes[1].triangle_count(), 50U);
        const auto found =
            std::find_if(made->findings.begin(), made->findings.end(),
                         [](const Finding& f) { return f.kind == "moving-mesh-kept"; });
        ASSERT_NE(found, made->findings.end());
        EXPECT_EQ(found->severity, Severity::warning);
        EXPECT_EQ(found->mesh, 0U);
        EXPECT_EQ(found->count, 1U);
        EXPECT_NE(found->text.find(skin ? "skin" : "morph"), std::string::npos);
    }
}

Scene noisy_quads(std::size_t meshes, PrepareOptions& options) {
    Scene scene;
    scene.materials.resize(1);
    scene.materials[0].name = "common";
    scene.meshes.assign(meshes, unit_quad());
    for (Mesh& mesh : scene.meshes) mesh.face_materials.assign(mesh.face_count(), 0);
    options.tessellate = true;
    options.tessellation.edge_length = 0.2;
    options.displacement.noise = NoiseOptions{.scale = 0.1};
    options.displacement.residual = ResidualMapOptions{.size = 16};
    return scene;
}

const Finding* finding_of(const PreparedScene& made, const std::string& kind) {
    const auto found = std::find_if(made.findings.begin(), made.findings.end(),
                                    [&](const Finding& f) { return f.kind == kind; });
    return found == made.findings.end() ? nullptr : &*found;
}

// Its normals would be those of another mesh, and it has no tangents to read them by.
TEST(TessellationSources, MaterialsOfMeshesThatAreNotBakedGetNoResidual) {
    PrepareOptions options;
    const Scene both = noisy_quads(2, options);
    const auto shared = prepare(both, options);
    ASSERT_TRUE(shared) << to_string(shared.error());
    EXPECT_EQ(shared->residual_maps.size(), 1U);
    EXPECT_TRUE(shared->scene.materials[0].normal_map);
    EXPECT_EQ(finding_of(*shared, "no-residual-map"), nullptr);
    enum Case : int { skin, without_uvs, repeated, variant };
    for (const Case which : {skin, without_uvs, repeated, variant})
        for (const std::size_t odd : {std::size_t(0), std::size_t(1)}) {
            Scene scene = both;
            Mesh& mesh = scene.meshes[odd];
            mesh.name = "odd";
            if (which == skin) mesh.skin_influences.push_back(unweighted(mesh));
            if (which == without_uvs) mesh.uvs.clear();
            if (which == repeated)
                for (glm::vec2& uv : mesh.uvs[0].values) uv *= 100.0F;
            if (which == variant) {
                scene.materials.resize(2);
                mesh.face_materials.assign(mesh.face_count(), 1);
                mesh.variant_materials = {0, 1};
            }
            const auto made = prepare(std::move(scene), options);
            ASSERT_TRUE(made) << to_string(made.error());
            EXPECT_FALSE(made->scene.materials[0].normal_map) << which;
            EXPECT_EQ(made->residual_maps.size(), which == variant ? 1U : 0U) << which;
            bool told = false;
            for (const Finding& f : made->findings)
                told = told || (f.kind == "no-residual-map" && f.count > 0 &&
                                f.text.find("'common'") != std::string::npos &&
                                f.text.find("'odd'") != std::string::npos);
            EXPECT_TRUE(told) << which;
        }
}

// Two sets of tangents there are not: the material's own normal map keeps its own.
TEST(TessellationSources, TangentsOfOwnNormalMapsAreNotTakenForResiduals) {
    PrepareOptions options;
    Scene scene = noisy_quads(1, options);
    Mesh& mesh = scene.meshes[0];
    mesh = seamed();
    mesh.uvs.push_back(mesh.uvs[0]);
    mesh.face_materials = {0, 1};
    scene.materials.resize(2);
    scene.textures.resize(1);
    scene.materials[1].normal_map = {.texture = 0, .uv_set = 1};
    const auto made = prepare(scene, options);
    ASSERT_TRUE(made) << to_string(made.error());
    EXPECT_EQ(made->requirements[0].tangent_uv_set, 1U);
    EXPECT_TRUE(made->residual_maps.empty());
    EXPECT_NE(finding_of(*made, "no-residual-map"), nullptr);
    scene.materials[1].normal_map.uv_set = 0;
    const auto same = prepare(scene, options);
    ASSERT_TRUE(same) << to_string(same.error());
    EXPECT_EQ(same->requirements[0].tangent_uv_set, 0U);
    ASSERT_EQ(same->residual_maps.size(), 1U);
    EXPECT_EQ(same->residual_maps[0].material, 0U);
    // A bump map is light's as well, and would count the same detail twice.
    scene.materials[1].normal_map = {};
    scene.materials[0].bump_map = {.texture = 0};
    const auto bumped = prepare(scene, options);
    ASSERT_TRUE(bumped) << to_string(bumped.error());
    ASSERT_EQ(bumped->residual_maps.size(), 1U);
    EXPECT_EQ(bumped->residual_maps[0].material, 1U);
}

TEST(TessellationSources, ResidualsThatFillTheMemoryAreRefusedBefore) {
    PrepareOptions options;
    Scene scene = noisy_quads(2, options);
    Mesh grid;
    for (int k = 0; k < 18; ++k) grid.positions.emplace_back(k / 2, k % 2, 0);
    grid.uvs.resize(1);
    for (std::uint32_t k = 0; k < 8; ++k) add_face(grid, {2 * k, 2 * k + 2, 2 * k + 3, 2 * k + 1});
    for (const std::uint32_t v : grid.corner_vertices) {
        grid.uvs[0].indices.push_back(v);
        grid.face_materials.resize(grid.face_count());
    }
    for (const glm::vec3& p : grid.positions) grid.uvs[0].values.emplace_back(p.x / 8, p.y);
    for (std::uint32_t k = 0; k < 8; ++k) grid.face_materials[k] = k;
    scene.materials.resize(8);
    scene.meshes = {grid, grid};
    EXPECT_TRUE(prepare(scene, options));
    options.displacement.residual->size = max_residual_size;
    const auto refused = prepare(scene, options);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::limit);
    EXPECT_NE(refused.error().text.find("8192"), std::string::npos);
}

// What a file's coordinates are about is no matter of the noise.
TEST(TessellationSources, NoiseDoesNotFollowTheMeshesOrigin) {
    PrepareOptions options;
    Scene scene = noisy_quads(2, options);
    options.displacement.residual.reset();
    options.displacement.noise->frequency = 2.3;
    const glm::vec3 origin(4, -2.25F, 8);
    scene.meshes[1].origin = glm::dvec3(origin);
    for (glm::vec3& p : scene.meshes[1].positions) p -= origin;
    const auto made = prepare(std::move(scene), options);
    ASSERT_TRUE(made) << to_string(made.error());
    const VertexMesh &here = made->meshes[0], &there = made->meshes[1];
    ASSERT_EQ(here.positions.size(), there.positions.size());
    double highest = 0;
    for (std::size_t v = 0; v < here.positions.size(); ++v) {
        EXPECT_LE(glm::length(here.positions[v] - (there.positions[v] + origin)), 1e-6F);
        highest = std::max(highest, std::abs(double(here.positions[v].z)));
    }
    EXPECT_GT(highest, 0.02);
    for (const auto& certificate : made->tessellated)
        EXPECT_LE(certificate->measured, certificate->proved);
}

// Floats as well have the mid-level of their material; who was left as it is keeps its map.
TEST(TessellationSources, MaterialsMapsHaveTheirMidlevelAndStayWhereTheyAreNeeded) {
    const std::filesystem::path file =
        std::filesystem::path(testing::TempDir()) / "sources_vectors.exr";
    ASSERT_TRUE(save_image(file, vectors(4, [](auto, auto) { return glm::dvec3(0.5, 0.75, 1.5); }),
                           PixelType::f32));
    PrepareOptions options;
    Scene scene = noisy_quads(2, options);
    options.displacement = {};
    options.displacement.from_materials = true;
    scene.images.resize(1);
    scene.images[0].path = file;
    scene.textures.resize(1);
    scene.textures[0].image = 0;
    scene.materials[0].displacement_map = {.texture = 0};
    scene.materials[0].displacement_kind = DisplacementKind::vector_object;
    const auto made = prepare(scene, options);
    ASSERT_TRUE(made) << to_string(made.error());
    for (const glm::vec3& p : made->meshes[1].positions) EXPECT_NEAR(p.z, 1, 1e-6);
    EXPECT_FALSE(made->scene.materials[0].displacement_map);
    EXPECT_EQ(finding_of(*made, "displacement-map-kept"), nullptr);
    scene.meshes[0].skin_influences.push_back(unweighted(scene.meshes[0]));
    const auto kept = prepare(scene, options);
    ASSERT_TRUE(kept) << to_string(kept.error());
    for (const glm::vec3& p : kept->meshes[0].positions) EXPECT_EQ(p.z, 0);
    for (const glm::vec3& p : kept->meshes[1].positions) EXPECT_NEAR(p.z, 1, 1e-6);
    EXPECT_TRUE(kept->scene.materials[0].displacement_map);
    const Finding* told = finding_of(*kept, "displacement-map-kept");
    ASSERT_NE(told, nullptr);
    EXPECT_EQ(told->mesh, 0U);
    EXPECT_EQ(told->count, 1U);
    // In the frame of the surface the normal is the second or the third.
    scene.materials[0].displacement_kind = DisplacementKind::vector_tangent;
    for (const VectorAxes axes :
         {VectorAxes::tangent_normal_bitangent, VectorAxes::tangent_bitangent_normal}) {
        options.displacement.axes = axes;
        const auto tangent = prepare(scene, options);
        ASSERT_TRUE(tangent) << to_string(tangent.error());
        const double along = axes == VectorAxes::tangent_normal_bitangent ? 0.25 : 1;
        for (const glm::vec3& p : tangent->meshes[1].positions) EXPECT_NEAR(p.z, along, 1e-6);
    }
    options.displacement.axes = VectorAxes::object;
    EXPECT_EQ(prepare(scene, options).error().code, ErrorCode::invalid);
    options.displacement.axes = VectorAxes::tangent_normal_bitangent;
    // Noise is not added to them.
    options.displacement.noise.emplace();
    EXPECT_EQ(prepare(scene, options).error().code, ErrorCode::invalid);
    std::filesystem::remove(file);
}

TEST(TessellationSources, WhatIsNoSourceIsRefused) {
    const Image image = vectors(2, [](auto, auto) { return glm::dvec3(0.5); });
    Image narrow = image;
    narrow.channels = 1;
    narrow.pixels.resize(4);
    EXPECT_EQ(vector_function(narrow, object_space()).error().code, ErrorCode::invalid);
    EXPECT_EQ(noise_function({.octaves = 0}).error().code, ErrorCode::invalid);
}

}  // namespace
}  // namespace prep
