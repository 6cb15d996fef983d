// Height maps in tessellation: the smallest detail is found, what lies between charts is not read.
#include <gtest/gtest.h>

#include <filesystem>
#include <numbers>
#include <random>

#include "prep/displacement/tessellate.h"
#include "prep/image.h"
#include "prep/prepare.h"
#include "temporary_files.h"
#include "tessellation_checks.h"

namespace prep {
namespace {

using namespace tessellation_checks;

Image flat_map(std::uint32_t size) {
    Image image;
    image.width = image.height = size;
    image.channels = 1;
    image.floating = true;
    image.pixels.assign(std::size_t(size) * size, 0.0F);
    return image;
}

Image random_map(unsigned seed) {
    std::mt19937 random(seed);
    Image image = flat_map(8);
    for (float& texel : image.pixels) texel = std::uniform_real_distribution<float>(0, 1)(random);
    return image;
}

HeightMapOptions as_stored() {
    HeightMapOptions options;
    options.midlevel = 0;
    options.wrap_u = options.wrap_v = Wrap::clamp;
    return options;
}

// Bilinear, by hand: texel centres at (i + ½)/size.
double bilinear(const Image& image, const glm::dvec2& uv) {
    const double x = uv.x * image.width - 0.5, y = uv.y * image.height - 0.5;
    const double i = std::floor(x), j = std::floor(y);
    const auto at = [&](double a, double b) {
        return double(*image.at(std::uint32_t(std::clamp(a, 0.0, image.width - 1.0)),
                                std::uint32_t(std::clamp(b, 0.0, image.height - 1.0))));
    };
    const double s = x - i, t = y - j;
    return (1 - t) * ((1 - s) * at(i, j) + s * at(i + 1, j)) +
           t * ((1 - s) * at(i, j + 1) + s * at(i + 1, j + 1));
}

// The largest error over a grid of each triangle, and at all texels' centres of the map that it
// covers; x and y of the unit quad are UVs.
double largest_error(const Mesh& mesh, const Image& image) {
    double most = 0;
    for (std::size_t t = 0; t < mesh.face_count(); ++t) {
        std::array<glm::dvec3, 3> p;
        for (std::size_t k = 0; k < 3; ++k)
            p[k] = glm::dvec3(mesh.positions[mesh.corner_vertices[3 * t + k]]);
        constexpr int n = 12;
        for (int j = 0; j <= n; ++j)
            for (int i = 0; i + j <= n; ++i) {
                const glm::dvec3 q =
                    (double(n - i - j) * p[0] + double(i) * p[1] + double(j) * p[2]) / double(n);
                most = std::max(most, std::abs(q.z - bilinear(image, glm::dvec2(q))));
            }
    }
    return most;
}

TEST(TessellationMaps, SpikesOfAMapOf4096AreFound) {
    constexpr std::uint32_t size = 4096;
    std::mt19937 random(17);
    std::uniform_int_distribution<std::uint32_t> texel(0, size - 1);
    Image image = flat_map(size);
    std::uint64_t most = 0;
    for (int trial = 0; trial < 3; ++trial) {
        const std::uint32_t x = texel(random), y = texel(random);
        image.pixels[std::size_t(y) * size + x] = 0.25F;
        const auto height = height_function(image, as_stored());
        ASSERT_TRUE(height) << to_string(height.error());
        TessellateOptions options;
        options.displacements = {{*height, 1, 0, 0}};
        options.chord_error = 0.25 / 4;
        const auto made = tessellate(unit_quad(), options);
        ASSERT_TRUE(made) << to_string(made.error());
        EXPECT_LE(made->certificate.proved, 0.25 / 4);
        const glm::vec2 top((float(x) + 0.5F) / size, (float(y) + 0.5F) / size);
        bool inside = false;
        for (const glm::vec3& p : made->mesh.positions)
            inside = inside || (p.z > 0 && std::abs(p.x - top.x) < 1.0F / size &&
                                std::abs(p.y - top.y) < 1.0F / size);
        EXPECT_TRUE(inside);
        most = std::max(most, made->certificate.triangles);
        image.pixels[std::size_t(y) * size + x] = 0;
    }
    EXPECT_LE(most, 5000u);
    std::printf("most triangles for a spike: %llu\n", (unsigned long long)most);
}

TEST(TessellationMaps, NoErrorAboveWhatIsProvedOnRoughMaps) {
    std::mt19937 random(18);
    for (const std::uint32_t size : {5u, 16u, 61u}) {
        Image image = flat_map(size);
        for (float& pixel : image.pixels) pixel = float(random() % 1000) / 1000.0F;
        for (const double asked : {0.1, 0.02}) {
            HeightMapOptions map = as_stored();
            map.scale = 0.2;
            map.midlevel = 0.25;
            const auto height = height_function(image, map);
            ASSERT_TRUE(height) << to_string(height.error());
            TessellateOptions options;
            options.displacements = {{*height, 1, 0, 0}};
            options.chord_error = asked * 0.2;
            const auto made = tessellate(unit_quad(), options);
            ASSERT_TRUE(made) << to_string(made.error());
            Image scaled = image;
            for (float& pixel : scaled.pixels) pixel = (pixel - 0.25F) * 0.2F;
            const double error = largest_error(made->mesh, scaled);
            EXPECT_LE(error, made->certificate.proved + 1e-7);
            EXPECT_LE(made->certificate.proved, asked * 0.2);
            EXPECT_LE(made->certificate.proved, 4 * error);
        }
    }
}

TEST(TessellationMaps, PoisonedGuttersMoveNothing) {
    // Two charts in an atlas, with 1e6 in all texels that neither has.
    constexpr std::uint32_t size = 64;
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {0, 1, 0}};
    add_face(mesh, {0, 1, 4, 5});
    add_face(mesh, {1, 2, 3, 4});
    mesh.uvs.resize(1);
    for (const double left : {0.1, 0.6})
        for (const glm::dvec2 corner :
             {glm::dvec2(0, 0), glm::dvec2(1, 0), glm::dvec2(1, 1), glm::dvec2(0, 1)}) {
            mesh.uvs[0].indices.push_back(std::uint32_t(mesh.uvs[0].values.size()));
            mesh.uvs[0].values.emplace_back(glm::dvec2(left, 0.2) + 0.3 * corner);
        }
    Image image = flat_map(size);
    for (std::uint32_t y = 0; y < size; ++y)
        for (std::uint32_t x = 0; x < size; ++x) {
            const double u = (x + 0.5) / size, v = (y + 0.5) / size;
            const bool covered =
                v >= 0.2 && v <= 0.5 && ((u >= 0.1 && u <= 0.4) || (u >= 0.6 && u <= 0.9));
            image.pixels[std::size_t(y) * size + x] = covered ? 0.5F : 1e6F;
        }
    TessellateOptions options;
    options.edge_length = 0.05;
    const auto plain = height_function(image, as_stored());
    const auto confined = height_function(image, as_stored(), &mesh, 0);
    ASSERT_TRUE(plain && confined);
    options.displacements = {{*plain, 1, 0, 0}};
    options.triangle_limit = 100000;
    EXPECT_FALSE(tessellate(mesh, options));  // mountains of a million
    options.displacements = {{*confined, 1, 0, 0}};
    const auto made = tessellate(mesh, options);
    ASSERT_TRUE(made) << to_string(made.error());
    for (const glm::vec3& p : made->mesh.positions) EXPECT_NEAR(p.z, 0.5, 1e-6);
}

// Four charts of a plane, turned, one of them mirrored and with half a texel's shift, a height that
// is continuous over all of them, and a thousand between the charts.
struct Atlas {
    static constexpr std::uint32_t size = 256;
    static double height(const glm::dvec2& p) {
        return 0.1 * std::sin(3 * p.x + 1) * std::cos(2 * p.y);
    }
    static glm::dvec2 slope(const glm::dvec2& p) {
        return {0.3 * std::cos(3 * p.x + 1) * std::cos(2 * p.y),
                -0.2 * std::sin(3 * p.x + 1) * std::sin(2 * p.y)};
    }
    static constexpr double chart_size = 0.4, steepest = 0.3;
    static constexpr double texel = 1 / (chart_size * size);  // on the plane

    Mesh mesh;
    Image image = flat_map(size);

    Atlas() {
        std::fill(image.pixels.begin(), image.pixels.end(), 1000.0F);
        for (const glm::dvec2 at :
             {glm::dvec2(0, 0), {1, 0}, {2, 0}, {0, 1}, {1, 1}, {2, 1}, {0, 2}, {1, 2}, {2, 2}})
            mesh.positions.emplace_back(at.x, at.y, 0);
        mesh.uvs.resize(1);
        for (std::uint32_t q = 0; q < 4; ++q) add_quad(q);
    }
    void add_quad(std::uint32_t q) {
        const std::uint32_t first = q % 2 + q / 2 * 3;
        add_face(mesh, {first, first + 1, first + 4, first + 3});
        const glm::dvec2 square[] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
        const glm::dvec2 low = glm::dvec2(0.5 * (q % 2) + 0.05, 0.5 * double(q / 2) + 0.05) +
                               (q == 3 ? 0.5 / size : 0.0);
        std::array<glm::dvec2, 4> corners;
        for (std::uint32_t k = 0; k < 4; ++k) {
            glm::dvec2 at = square[(k + q) % 4];
            if (q == 2) at.x = 1 - at.x;
            corners[k] = low + chart_size * at;
            mesh.uvs[0].indices.push_back(std::uint32_t(mesh.uvs[0].values.size()));
            mesh.uvs[0].values.emplace_back(corners[k]);
        }
        const glm::dvec2 x = corners[1] - corners[0], y = corners[3] - corners[0];
        for (std::uint32_t j = 0; j < size; ++j)
            for (std::uint32_t i = 0; i < size; ++i) {
                const glm::dvec2 d = glm::dvec2(i + 0.5, j + 0.5) / double(size) - corners[0];
                const glm::dvec2 p =
                    glm::dvec2(glm::dot(d, x), glm::dot(d, y)) / (chart_size * chart_size);
                if (p.x < 0 || p.y < 0 || p.x > 1 || p.y > 1) continue;
                image.pixels[std::size_t(j) * size + i] =
                    float(height(p + glm::dvec2(mesh.positions[first])));
            }
    }
};

TEST(TessellationMaps, SeamsOfAContinuousHeightAreFair) {
    const Atlas atlas;
    for (const HeightFilter filter : {HeightFilter::bilinear, HeightFilter::bicubic}) {
        HeightMapOptions as = as_stored();
        as.filter = filter;
        const auto map = height_function(atlas.image, as, &atlas.mesh);
        ASSERT_TRUE(map) << to_string(map.error());
        TessellateOptions options;
        options.edge_length = 0.05;
        options.triangle_limit = 100'000;  // cliffs of a thousand take more
        options.displacements = {{*map, 1, 0, 0}};
        const auto made = tessellate(atlas.mesh, options);
        ASSERT_TRUE(made) << to_string(made.error());
        const Mesh& mesh = made->mesh;
        int on_seams = 0;
        double farthest = 0, most_degrees = 0;
        for (std::size_t c = 0; c < mesh.corner_count(); ++c) {
            const glm::dvec3 p(mesh.positions[mesh.corner_vertices[c]]);
            if (std::min(std::abs(p.x - 1), std::abs(p.y - 1)) > 1e-6) continue;
            ++on_seams;
            const glm::dvec2 slope = Atlas::slope({p.x, p.y});
            const glm::dvec3 truth = glm::normalize(glm::dvec3(-slope.x, -slope.y, 1));
            const glm::dvec3 normal(mesh.normals.values[mesh.normals.indices[c]]);
            farthest = std::max(farthest, std::abs(p.z - Atlas::height({p.x, p.y})));
            most_degrees = std::max(
                most_degrees,
                180 / std::numbers::pi *
                    std::atan2(glm::length(glm::cross(normal, truth)), glm::dot(normal, truth)));
        }
        std::printf("%d corners on seams: at most %.2g of a texel's step, %.2g degrees\n", on_seams,
                    farthest / (Atlas::steepest * Atlas::texel), most_degrees);
        EXPECT_GT(on_seams, 300);
        EXPECT_LE(farthest, 0.05 * Atlas::steepest * Atlas::texel);
        EXPECT_LE(most_degrees, 0.5);
    }
}

TEST(TessellationMaps, BadMapsAreErrors) {
    Image image = flat_map(4);
    image.pixels[5] = NAN;
    EXPECT_EQ(height_function(image, as_stored()).error().code, ErrorCode::invalid);
    EXPECT_EQ(height_function(Image{}, as_stored()).error().code, ErrorCode::invalid);
}

// A chart goes on where the material changes, if the other has the same map: texels beyond the
// border are no gutter.
TEST(TessellationMaps, OnePictureOfTwoMaterialsIsOneMap) {
    const Image image = random_map(5);
    const ::test::TempDir dir;
    const std::filesystem::path file = dir / "one_map.exr";
    ASSERT_TRUE(save_image(file, image, PixelType::f32));
    Scene scene;
    Mesh& mesh = scene.meshes.emplace_back();
    CornerLayer<glm::vec2>& uvs = mesh.uvs.emplace_back();
    constexpr std::uint32_t n = 4;
    for (std::uint32_t j = 0; j <= n; ++j)
        for (std::uint32_t i = 0; i <= n; ++i) {
            mesh.positions.emplace_back(float(i) / n, float(j) / n, 0);
            uvs.values.emplace_back(float(i) / n, float(j) / n);
        }
    for (std::uint32_t j = 0; j < n; ++j)
        for (std::uint32_t i = 0; i < n; ++i) {
            const std::uint32_t v = j * (n + 1) + i;
            add_face(mesh, {v, v + 1, v + n + 2, v + n + 1});
            mesh.face_materials.push_back(i < n / 2 ? 0 : 1);
        }
    uvs.indices = mesh.corner_vertices;
    scene.images.emplace_back().path = file;
    scene.textures.emplace_back().image = 0;
    scene.textures[0].wrap_u = scene.textures[0].wrap_v = Wrap::clamp;
    scene.materials.resize(2);
    for (Material& material : scene.materials) {
        material.displacement_map = {.texture = 0};
        material.displacement_scale = 0.2F;
        material.displacement_midlevel = 0;
    }
    instance_unused_meshes(scene);
    PrepareOptions options;
    options.tessellate = true;
    options.tessellation.chord_error = 0.01;
    options.displacement.from_materials = true;
    const auto made = prepare(scene, options);
    ASSERT_TRUE(made) << to_string(made.error());
    EXPECT_GT(made->meshes[0].vertex_count(), 50U);
    for (const glm::vec3& p : made->meshes[0].positions)
        EXPECT_NEAR(p.z, 0.2 * bilinear(image, glm::dvec2(p)), 1e-6);
    // One that is read otherwise is a map of its own: it ends at the border.
    scene.materials[1].displacement_scale = 0.1F;
    const auto apart = prepare(scene, options);
    ASSERT_TRUE(apart) << to_string(apart.error());
    for (const glm::vec3& p : apart->meshes[0].positions)
        if (std::abs(p.x - 0.5F) > 0.13F) {
            EXPECT_NEAR(p.z, (p.x < 0.5F ? 0.2 : 0.1) * bilinear(image, glm::dvec2(p)), 1e-6);
        }
}

// Nor does it end where a mesh does: tiles of a ground that are meshes of their own join.
TEST(TessellationMaps, OnePictureOfTwoMeshesIsOneMap) {
    const Image image = random_map(6);
    const ::test::TempDir dir;
    const std::filesystem::path file = dir / "one_map.exr";
    ASSERT_TRUE(save_image(file, image, PixelType::f32));
    Scene scene;
    for (const float left : {0.0F, 0.5F}) {
        Mesh& mesh = scene.meshes.emplace_back();
        for (const glm::vec2 corner : {glm::vec2(0, 0), {0.5F, 0}, {0.5F, 1}, {0, 1}})
            mesh.positions.emplace_back(left + corner.x, corner.y, 0);
        add_face(mesh, {0, 1, 2, 3});
        CornerLayer<glm::vec2>& uvs = mesh.uvs.emplace_back();
        for (const glm::vec3& p : mesh.positions) uvs.values.emplace_back(p);
        uvs.indices = mesh.corner_vertices;
        const auto number = std::uint32_t(scene.materials.size());
        mesh.face_materials = {number};
        // As readers have a picture that two materials name.
        scene.images.emplace_back().path = file;
        scene.textures.emplace_back().image = number;
        scene.textures.back().wrap_u = scene.textures.back().wrap_v = Wrap::clamp;
        Material& material = scene.materials.emplace_back();
        material.displacement_map = {.texture = number};
        material.displacement_scale = 0.2F;
        material.displacement_midlevel = 0;
    }
    instance_unused_meshes(scene);
    PrepareOptions options;
    options.tessellate = true;
    options.tessellation.chord_error = 0.01;
    for (const bool from_materials : {true, false}) {
        options.displacement.from_materials = from_materials;
        if (!from_materials) {
            options.displacement.map = scene.images[0];
            options.displacement.midlevel = 0;
            options.displacement.heights.scale = 0.2;
            options.displacement.heights.wrap_u = options.displacement.heights.wrap_v = Wrap::clamp;
        }
        const auto made = prepare(scene, options);
        ASSERT_TRUE(made) << to_string(made.error());
        ASSERT_EQ(made->meshes.size(), 2U);
        std::size_t at_border = 0;
        for (const auto& mesh : made->meshes)
            for (const glm::vec3& p : mesh.positions) {
                EXPECT_NEAR(p.z, 0.2 * bilinear(image, glm::dvec2(p)), 1e-6);
                at_border += p.x == 0.5F;
            }
        EXPECT_GT(at_border, 10U);
    }
}

}  // namespace
}  // namespace prep
