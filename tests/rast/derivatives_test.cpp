// Derivatives of texture coordinates, read back from the level of detail that the renderer chose:
// where a trilinear sample is known and both of its levels are, the fraction between them is.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "shading/texture.h"
#include "snapped_triangle.h"

namespace {

using namespace test;

constexpr std::uint32_t extent = 256;

// Different means at every scale, so that neighbouring levels differ.
prep::Image noise_at_all_scales(std::mt19937_64& random) {
    prep::Image image{extent, extent, 3, std::vector<float>(extent * extent * 3, 0.5f)};
    for (std::uint32_t size = 1; size <= 32; size *= 2)
        for (std::uint32_t y = 0; y < extent; y += size)
            for (std::uint32_t x = 0; x < extent; x += size)
                for (int c = 0; c < 3; ++c) {
                    const float part = random() % 2 ? 1.0f / 12 : -1.0f / 12;
                    for (std::uint32_t j = y; j < y + size; ++j)
                        for (std::uint32_t i = x; i < x + size; ++i)
                            image.pixels[(j * extent + i) * 3 + std::uint32_t(c)] += part;
                }
    return image;
}

struct Measured {
    double worst_lod = 0, worst_relative = 0, sum = 0;
    std::size_t count = 0;
};

// Compares one picture's levels of detail with those of the derivatives in long double.
void measure(const prep::PreparedScene& scene, const rast::MipTexture& texture,
             const rast::RenderRequest& request, Measured& measured) {
    const rast::Frame frame = test::draw(scene, request);
    const prep::VertexMesh& mesh = scene.meshes[0];
    Corner corner[3];
    for (int k = 0; k < 3; ++k)
        corner[k] = corner_of(*request.view, request.width, request.height, mesh.positions[k]);
    for (std::uint32_t y = 0; y < request.height; ++y)
        for (std::uint32_t x = 0; x < request.width; ++x) {
            const std::size_t at = std::size_t(y) * request.width + x;
            if (frame.triangle[at] == prep::no_index) continue;
            const Weights w = weights_of(corner, centre_from_middle(x, request.width),
                                         centre_from_middle(y, request.height));
            Real right[2] = {}, down[2] = {};
            for (int k = 0; k < 3; ++k)
                for (int c = 0; c < 2; ++c) {
                    right[c] += w.right[k] * Real(mesh.uvs[0][k][c]);
                    down[c] += w.down[k] * Real(mesh.uvs[0][k][c]);
                }
            const Real lod = std::log2(Real(extent) * std::max(std::hypot(right[0], right[1]),
                                                               std::hypot(down[0], down[1])));
            const Real level = std::floor(lod);
            if (level < 0 || level > 4 || lod - level < 0.01L || lod - level > 0.99L) continue;
            const auto at_level = [&](Real l) {
                const float side = float(std::exp2(l)) / float(extent);
                return texture.sample(frame.uv[at], {{side, 0}, {0, side}},
                                      rast::TextureFilter::trilinear);
            };
            const glm::vec4 fine = at_level(level), coarse = at_level(level + 1);
            for (int c = 0; c < 3; ++c) {
                const Real step = Real(coarse[c]) - Real(fine[c]);
                if (std::abs(step) < 0.1L) continue;
                const Real found = level + (Real(frame.color[at][c]) - Real(fine[c])) / step;
                const double error = double(std::abs(found - lod));
                measured.worst_lod = std::max(measured.worst_lod, error);
                measured.worst_relative =
                    std::max(measured.worst_relative, std::abs(std::exp2(error) - 1));
                measured.sum += error;
                ++measured.count;
            }
        }
}

TEST(Derivatives, KeepAllButThreeBitsInTheLevelOfDetail) {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> unit(0, 1);
    prep::Material material = white();
    material.unlit = true;
    material.double_sided = true;
    material.diffuse_map.texture = 0;
    prep::PreparedScene scene = test::scene_of({}, material);
    scene.meshes[0].ranges = {{0, 1, 0, prep::no_index}};
    prep::ImageRef file;
    file.name = "memory.png";
    file.bytes = *prep::encode_png(noise_at_all_scales(random), prep::PixelType::u16);
    const auto image = prep::load_image(file);
    ASSERT_TRUE(image);
    scene.scene.images.push_back(file);
    prep::Texture sampler;
    sampler.image = 0;
    scene.scene.textures.push_back(sampler);
    const rast::MipTexture texture(*image, sampler, true, rast::TextureLevels::mipmap);
    Measured measured;
    for (int n = 0; n < 100; ++n) {
        rast::RenderRequest request;
        request.width = request.height = 128;
        request.view = perspective_view();
        request.filter = rast::TextureFilter::trilinear;
        request.keep_ids = request.keep_uvs = true;
        request.threads = 1;
        prep::VertexMesh& mesh = scene.meshes[0];
        mesh.positions.clear();
        place_corners(mesh, *request.view, request, {0, 0, 128, 128}, random);
        mesh.indices = {0, 1, 2};
        const double size = std::exp2(5 * unit(random) - 2);
        mesh.uvs = {{}};
        for (int k = 0; k < 3; ++k)
            mesh.uvs[0].push_back({float(size * unit(random)), float(size * unit(random))});
        measure(scene, texture, request, measured);
    }
    std::printf("%zu levels of detail: worst error %.2e, mean %.1e; of a derivative 2^%.1f\n",
                measured.count, measured.worst_lod, measured.sum / double(measured.count),
                std::log2(measured.worst_relative));
    EXPECT_GT(measured.count, 20000u);
    // Of 23 bits at most three are lost; the Vulkan and OpenGL conformance tests allow the same of
    // derivatives, and 1/64 of a level of detail.
    EXPECT_LT(measured.worst_relative, 0x1p-20);
}

}  // namespace
