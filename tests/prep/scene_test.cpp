#include "prep/scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_inverse.hpp>
#include <limits>
#include <numbers>
#include <random>

namespace {

using prep::blinn_phong;

// What the lobe reflects of light that falls straight onto the surface, all directions together:
// the integral of (n·h)^shininess over the hemisphere, where n·h = cos(θ/2), by the midpoint rule;
// divided by π, because the shading model leaves 1/π out.
double reflected(double specular, double shininess) {
    constexpr int steps = 20000;
    double sum = 0;
    for (int i = 0; i < steps; ++i) {
        const double theta = (i + 0.5) / steps * std::numbers::pi / 2;
        sum += std::pow(std::cos(theta / 2), shininess) * std::sin(theta);
    }
    return specular * sum * (std::numbers::pi / 2 / steps) * 2;
}

TEST(BlinnPhong, DielectricReflectsFourPercentAtAnyRoughness) {
    for (const float roughness : {0.0f, 0.1f, 0.2f, 0.35f, 0.5f, 0.65f, 0.75f, 0.8f, 0.9f, 1.0f}) {
        const auto made = blinn_phong(glm::vec3(0.5f), 0.0f, roughness);
        const double share = reflected(made.specular.x, made.shininess) / 0.04;
        // The factor stands for the integral's inverse: with m = shininess/2 + 1 the ratio is
        // (1 + m⁻²)(1 − 2⁻ᵐ), which lies between 0.9316 and 1.0125.
        EXPECT_GE(share, 0.9316) << "roughness " << roughness;
        EXPECT_LE(share, 1.0125) << "roughness " << roughness;
        EXPECT_EQ(made.diffuse, glm::vec3(0.5f));
    }
}

TEST(BlinnPhong, MetalReflectsItsColourAndScattersNothing) {
    const auto made = blinn_phong({0.9f, 0.6f, 0.3f}, 1.0f, 0.5f);
    EXPECT_EQ(made.diffuse, glm::vec3(0.0f));
    EXPECT_FLOAT_EQ(made.shininess, 30.0f);  // 2/0.25² − 2
    EXPECT_FLOAT_EQ(made.specular.x, 0.9f * (32.0f / 8 + 0.5f / 32));
    EXPECT_FLOAT_EQ(made.specular.z, 0.3f * (32.0f / 8 + 0.5f / 32));
}

TEST(BlinnPhong, RoughestHasAFlatLobe) {
    EXPECT_EQ(blinn_phong(glm::vec3(1.0f), 0.0f, 1.0f).shininess, 0.0f);
}

TEST(WorldTransforms, ParentsComeFirstWhateverTheOrder) {
    prep::Scene scene;
    scene.nodes.resize(3);
    scene.nodes[0].parent = 2;  // a child listed before its parent
    scene.nodes[0].transform[3] = {1, 0, 0, 1};
    scene.nodes[2].parent = 1;
    scene.nodes[2].transform[3] = {0, 10, 0, 1};
    scene.nodes[1].transform = glm::dmat4(2.0);
    scene.nodes[1].transform[3] = {0, 0, 100, 1};
    const auto world = prep::world_transforms(scene);
    EXPECT_EQ(world[0][3], glm::dvec4(2, 20, 100, 1));
    EXPECT_EQ(world[2][3], glm::dvec4(0, 20, 100, 1));
}

// What a program may get wrong when it fills lists by hand, each named by the list.
TEST(RequireConsistent, NamesTheListThatIsNot) {
    const auto sound = [] {
        prep::Scene scene;
        prep::Mesh mesh;
        mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
        mesh.face_offsets = {0, 3};
        mesh.corner_vertices = {0, 1, 2};
        mesh.uvs.resize(1);
        mesh.uvs[0].values = {{0, 0}};
        mesh.uvs[0].indices = {0, 0, prep::no_index};
        scene.meshes = {mesh, prep::Mesh()};
        scene.meshes[1].face_offsets.clear();
        scene.nodes.resize(2);
        scene.nodes[0].mesh = 1;
        scene.nodes[1].parent = 0;
        return scene;
    };
    EXPECT_TRUE(prep::require_consistent(sound()));
    EXPECT_TRUE(prep::require_consistent({}));
    const struct {
        const char* name;
        void (*change)(prep::Scene&);
    } cases[] = {
        {"corner", [](prep::Scene& s) { s.meshes[0].corner_vertices[1] = 3; }},
        {"face",
         [](prep::Scene& s) {
             s.meshes[0].face_offsets = {0, 2};
         }},
        {"face",
         [](prep::Scene& s) {
             s.meshes[0].face_offsets = {0, 3, 3000000};
         }},
        {"face", [](prep::Scene& s) { s.meshes[0].face_offsets.clear(); }},
        {"UV", [](prep::Scene& s) { s.meshes[0].uvs[0].indices[1] = 1; }},
        {"UV", [](prep::Scene& s) { s.meshes[0].uvs[0].indices.pop_back(); }},
        {"line",
         [](prep::Scene& s) {
             s.meshes[0].line_vertices = {0, 7};
         }},
        {"attribute",
         [](prep::Scene& s) {
             s.meshes[0].vertex_attributes = {{"_A", 3, {1}}};
         }},
        {"node", [](prep::Scene& s) { s.nodes[0].parent = 1; }},
        {"node", [](prep::Scene& s) { s.nodes[0].mesh = 2; }},
        {"node", [](prep::Scene& s) { s.nodes[0].camera = 0; }},
        {"node", [](prep::Scene& s) { s.nodes[0].light = 0; }},
        {"texture", [](prep::Scene& s) { s.textures.resize(1), s.textures[0].image = 5; }}};
    for (const auto& c : cases) {
        prep::Scene scene = sound();
        c.change(scene);
        const auto checked = prep::require_consistent(scene);
        ASSERT_FALSE(checked) << c.name << ", case " << &c - cases;
        EXPECT_EQ(checked.error().code, prep::ErrorCode::invalid);
        EXPECT_NE(checked.error().text.find(c.name), std::string::npos) << checked.error().text;
    }
}

TEST(BlinnPhong, ExponentIsThatOfTheMicrofacetsWidthUpToItsLimit) {
    for (const double roughness : {0.2, 0.3, 0.5, 0.7, 0.9}) {
        const double alpha = roughness * roughness, expected = 2 / (alpha * alpha) - 2;
        EXPECT_NEAR(double(blinn_phong(glm::vec3(1), 0, float(roughness)).shininess), expected,
                    1e-5 * expected + 1e-5);
    }
    // α is at least 0.02: 2/0.0004 − 2
    EXPECT_NEAR(double(blinn_phong(glm::vec3(1), 0, 0.1f).shininess), 4998, 0.01);
    EXPECT_NEAR(double(blinn_phong(glm::vec3(1), 0, 0.0f).shininess), 4998, 0.01);
}

TEST(Scenes, MeshesThatNoNodeShowsGetOneEach) {
    prep::Scene scene;
    scene.meshes.resize(3);
    scene.meshes[0].name = "first";
    scene.meshes[2].name = "third";
    scene.nodes.resize(2);
    scene.nodes[1].mesh = 1;
    prep::instance_unused_meshes(scene);
    ASSERT_EQ(scene.nodes.size(), 4u);
    EXPECT_EQ(scene.nodes[0].mesh, prep::no_index);
    EXPECT_EQ(scene.nodes[1].mesh, 1u);
    EXPECT_EQ(scene.nodes[2].mesh, 0u);
    EXPECT_EQ(scene.nodes[2].name, "first");
    EXPECT_EQ(scene.nodes[3].mesh, 2u);
    EXPECT_EQ(scene.nodes[3].name, "third");
}

// The largest element of m over that of `like`, and m and it as directions.
double off_from_direction_of(const glm::dmat3& m, const glm::dmat3& like) {
    double size = 0, of_like = 0, off = 0;
    for (int k = 0; k < 9; ++k) {
        size = std::max(size, std::abs(m[k / 3][k % 3]));
        of_like = std::max(of_like, std::abs(like[k / 3][k % 3]));
    }
    for (int k = 0; k < 9; ++k)
        off = std::max(off, std::abs(m[k / 3][k % 3] / size - like[k / 3][k % 3] / of_like));
    return off;
}

TEST(NormalMatrix, IsTheTransposedInverseAtAnyScale) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform(-1, 1);
    int mirrored = 0;
    for (int n = 0; n < 200; ++n) {
        glm::dmat3 m(0.0);
        do
            for (int k = 0; k < 9; ++k) m[k / 3][k % 3] = uniform(random);
        while (std::abs(glm::determinant(m)) < 0.02);
        const bool turned = glm::determinant(m) < 0;
        mirrored += turned;
        const glm::dmat3 expected = glm::inverseTranspose(m);
        for (const double scale : {1.0, 3e-5, 1e-140, 1e-300, 1e150, 1e300}) {
            EXPECT_LT(off_from_direction_of(prep::normal_matrix(m * scale), expected), 1e-12)
                << scale;
            EXPECT_EQ(prep::mirrors(m * scale), turned) << scale;
        }
        double most = 0;
        for (int k = 0; k < 9; ++k)
            most = std::max(most, std::abs(prep::normal_matrix(m * 1e-140)[k / 3][k % 3]));
        EXPECT_GE(most, 1.0);
        EXPECT_LT(most, 2.0);
    }
    EXPECT_GT(mirrored, 50);
}

TEST(NormalMatrix, OfFlatTransformsKeepsTheNormalOfThePlane) {
    const glm::dmat3 flat(glm::dvec3(2, 0, 0), glm::dvec3(0, 3, 0), glm::dvec3(0.0));
    EXPECT_FALSE(prep::mirrors(flat));
    const glm::dvec3 n = prep::normal_matrix(flat) * glm::dvec3(0.3, 0.4, 0.5);
    EXPECT_GT(n.z, 0);
    EXPECT_EQ(glm::dvec2(n), glm::dvec2(0.0));
    const glm::dmat3 line(glm::dvec3(1, 2, 3), glm::dvec3(0.0), glm::dvec3(0.0));
    EXPECT_EQ(prep::normal_matrix(line), glm::dmat3(0.0));
    glm::dmat3 broken(1.0);
    broken[1][2] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(prep::mirrors(broken));
}

}  // namespace
