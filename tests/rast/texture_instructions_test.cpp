// Textured pictures on every instruction set: texels of 8 bits, 16 bits and floats, every way to
// wrap, sizes that are no power of two, every filter, with and without an alpha mask.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <random>
#include <string>

#include "builders.h"
#include "prep/files.h"
#include "prep/image.h"
#include "prep/simd.h"
#include "shading/texture.h"

namespace {

prep::ImageRef noise(std::uint32_t width, std::uint32_t height, std::uint32_t channels,
                     prep::PixelType type) {
    std::mt19937 random(width * 7 + channels);
    const int steps = type == prep::PixelType::u8 ? 255 : 65535;
    prep::Image image{width, height, channels, {}, type == prep::PixelType::u8};
    for (std::uint32_t i = 0; i < width * height * channels; ++i) {
        const float value = float(random() % std::uint32_t(steps + 1)) / float(steps);
        image.pixels.push_back(type == prep::PixelType::f32 ? value * 1.7f - 0.1f : value);
    }
    prep::ImageRef ref;
    if (type == prep::PixelType::f32) {  // beside what it is tested with, as a file
        const auto path = std::filesystem::temp_directory_path() /
                          ("meshprep-texture-instructions-" + std::to_string(::getpid()) + ".exr");
        EXPECT_TRUE(prep::save_image(path, image, type).has_value());
        ref.bytes = *prep::read_file(path);
        std::filesystem::remove(path);
        ref.name = "memory.exr";
    } else {
        ref.bytes = *prep::encode_png(image, type);
        ref.name = "memory.png";
    }
    return ref;
}

// A square that leaves its texture on all sides, close on the left and far on the right.
prep::VertexMesh receding_square() {
    prep::VertexMesh mesh;
    mesh.positions = {{-1, -1, 0}, {3, -1, -6}, {3, 1, -6}, {-1, 1, 0}};
    mesh.normals.assign(4, glm::vec3(0, 0, 1));
    mesh.uvs = {{{-1.3f, -0.7f}, {3.1f, -0.9f}, {2.9f, 2.2f}, {-1.1f, 1.8f}}};
    mesh.indices = {0, 1, 2, 0, 2, 3};
    return mesh;
}

// The square with that image, of one of the 16 pairs of wraps.
prep::PreparedScene textured_square(const prep::ImageRef& image, int wrap,
                                    prep::Material material = {}) {
    using prep::Wrap;
    static constexpr Wrap wraps[] = {Wrap::repeat, Wrap::mirror, Wrap::clamp, Wrap::border};
    material.unlit = material.double_sided = true;
    material.diffuse_map.texture = 0;
    prep::PreparedScene scene = test::scene_of(receding_square(), material);
    scene.scene.images.push_back(image);
    prep::Texture texture;
    texture.image = 0;
    texture.wrap_u = wraps[wrap % 4];
    texture.wrap_v = wraps[wrap / 4];
    scene.scene.textures.push_back(texture);
    return scene;
}

// The scalar code's frame, which that of every other instruction set has to equal in every byte.
rast::Frame draw_on_all(const prep::PreparedScene& scene, rast::RenderRequest request) {
    request.simd = prep::SimdLevel::scalar;
    rast::Frame scalar = test::draw(scene, request);
    for (const auto level :
         {prep::SimdLevel::sse4, prep::SimdLevel::avx2, prep::SimdLevel::avx512}) {
        if (!prep::simd_available(level)) continue;
        request.simd = level;
        const rast::Frame other = test::draw(scene, request);
        EXPECT_EQ(std::memcmp(scalar.color.data(), other.color.data(),
                              scalar.color.size() * sizeof(glm::vec4)),
                  0)
            << to_string(level) << ", filter " << int(request.filter);
    }
    return scalar;
}

class TextureInstructions : public testing::TestWithParam<prep::PixelType> {};

TEST_P(TextureInstructions, GiveTheSameBytesForEveryWrapFilterAndMask) {
    for (const bool masked : {false, true}) {
        const prep::ImageRef image = noise(37, 23, masked ? 4 : 3, GetParam());
        for (int wrap = 0; wrap < 16; ++wrap) {
            prep::Material material;
            if (masked) material.alpha_mode = prep::AlphaMode::mask;
            prep::PreparedScene scene = textured_square(image, wrap, material);
            scene.scene.textures[0].mag = prep::Filter::nearest;  // as no filter has it
            for (const rast::TextureFilter filter :
                 {rast::TextureFilter::by_sampler, rast::TextureFilter::nearest,
                  rast::TextureFilter::bilinear, rast::TextureFilter::nearest_mip,
                  rast::TextureFilter::trilinear, rast::TextureFilter::anisotropic,
                  rast::TextureFilter::ripmap, rast::TextureFilter::ewa,
                  rast::TextureFilter::bicubic}) {
                // The costly ones not with every wrap.
                if (filter == rast::TextureFilter::by_sampler && wrap % 5 != 0) continue;
                if (filter >= rast::TextureFilter::bicubic && wrap % 5 != 0) continue;
                rast::RenderRequest request;
                request.width = 123;
                request.height = 95;
                request.filter = filter;
                request.view = test::look_at({-0.4, 0.3, 1.2}, {0.6, 0, -1.5});
                SCOPED_TRACE("wrap " + std::to_string(wrap) + (masked ? ", masked" : ""));
                std::size_t seen = 0;
                for (const glm::vec4& c : draw_on_all(scene, request).color) seen += c.a > 0;
                EXPECT_GT(seen, 50u);
            }
        }
    }
}

// The scalar reference reads one texel after the other; texture_test holds it against double.
TEST_P(TextureInstructions, GiveTheBitsOfOneTexelAfterTheOther) {
    for (const std::uint32_t side : {1u, 16u, 23u})
        for (int wrap = 0; wrap < 16; ++wrap) {
            const prep::ImageRef image = noise(side, side + wrap % 3, 3, GetParam());
            prep::Material material;
            material.diffuse = glm::vec4(1);
            material.emissive = glm::vec3(0);
            const prep::PreparedScene scene = textured_square(image, wrap, material);
            for (const auto filter :
                 {rast::TextureFilter::nearest, rast::TextureFilter::bilinear}) {
                rast::RenderRequest request;
                request.width = 61;
                request.height = 47;
                request.filter = filter;
                request.keep_uvs = request.keep_ids = true;
                request.view = test::look_at({-0.4, 0.3, 1.2}, {0.6, 0, -1.5});
                const rast::Frame frame = test::draw(scene, request);
                const bool encoded = GetParam() != prep::PixelType::f32;  // floats are linear
                const rast::MipTexture reference(*prep::load_image(image), scene.scene.textures[0],
                                                 encoded, rast::levels_for(filter));
                std::size_t compared = 0;
                for (std::size_t i = 0; i < frame.color.size(); ++i) {
                    if (frame.triangle[i] == prep::no_index) continue;
                    const glm::vec4 expected = reference.sample(frame.uv[i], {}, filter);
                    ASSERT_EQ(glm::vec3(frame.color[i]), glm::vec3(expected))
                        << side << ", wrap " << wrap << ", filter " << int(filter);
                    ++compared;
                }
                EXPECT_GT(compared, 50u);
            }
        }
}

// Two maps of one size lie side by side where their texels are packed. One triangle reads them in
// that order, the other one in the opposite order, or one of them alone or twice.
TEST_P(TextureInstructions, ReadTwoMapsAsEachAlone) {
    const prep::ImageRef images[] = {noise(23, 21, 3, GetParam()), noise(23, 21, 4, GetParam())};
    for (int wrap = 0; wrap < 16; wrap += 5)
        for (const auto& [diffuse, emissive] :
             {std::pair(1u, 0u), {1u, prep::no_index}, {1u, 1u}, {0u, 0u}}) {
            prep::Material material;
            material.diffuse = glm::vec4(1);
            material.emissive = glm::vec3(1);
            material.emissive_map.texture = 1;
            prep::PreparedScene scene = textured_square(images[0], wrap, material);
            prep::Texture sampler = scene.scene.textures[0];
            sampler.image = 1;
            scene.scene.images.push_back(images[1]);
            scene.scene.textures.push_back(sampler);
            // Lit by nothing but ambient light of 1: a sum of both texels.
            scene.scene.materials[0].unlit = false;
            scene.scene.materials[0].ambient = glm::vec3(1);
            material = scene.scene.materials[0];
            material.diffuse_map.texture = diffuse;
            material.emissive_map.texture = emissive;
            scene.scene.materials.push_back(material);
            scene.meshes[0].ranges = {{0, 1, 0, prep::no_index}, {1, 1, 1, prep::no_index}};
            for (const auto filter : {rast::TextureFilter::nearest, rast::TextureFilter::bilinear,
                                      rast::TextureFilter::trilinear,
                                      rast::TextureFilter::anisotropic, rast::TextureFilter::ripmap,
                                      rast::TextureFilter::ewa, rast::TextureFilter::bicubic}) {
                rast::RenderRequest request;
                request.width = 61;
                request.height = 47;
                request.filter = filter;
                request.keep_uvs = request.keep_ids = true;
                request.view = test::look_at({-0.4, 0.3, 1.2}, {0.6, 0, -1.5});
                rast::LightInstance everywhere;
                everywhere.kind = prep::LightKind::ambient;
                everywhere.color = glm::vec3(1);
                request.lights = {everywhere};
                SCOPED_TRACE("wrap " + std::to_string(wrap));
                const rast::Frame frame = draw_on_all(scene, request);
                if (filter >= rast::TextureFilter::trilinear) continue;  // footprints are not kept
                const bool encoded = GetParam() != prep::PixelType::f32;
                std::vector<rast::MipTexture> alone;
                for (const prep::ImageRef& image : images)
                    alone.emplace_back(*prep::load_image(image), sampler, encoded,
                                       rast::levels_for(filter));
                std::size_t compared[2] = {};
                for (std::size_t i = 0; i < frame.color.size(); ++i) {
                    if (frame.triangle[i] == prep::no_index) continue;
                    const auto read = [&](std::size_t t) {
                        return glm::vec3(alone[t].sample(frame.uv[i], {}, filter));
                    };
                    const bool second = frame.triangle[i] == 1;
                    const std::uint32_t light = second ? emissive : 1;
                    const glm::vec3 emitted = light == prep::no_index ? glm::vec3(1) : read(light);
                    ASSERT_EQ(glm::vec3(frame.color[i]), read(second ? diffuse : 0) + emitted)
                        << int(filter);
                    ++compared[second];
                }
                EXPECT_GT(compared[0], 50u);
                EXPECT_GT(compared[1], 50u);
            }
        }
}

// A plane seen from the front has one footprint everywhere: up to the roundings of its derivatives,
// pictures show what MipTexture, by itself, reads through the filters of many texels.
TEST_P(TextureInstructions, ReadWhatOneTextureReadsThroughEveryFootprint) {
    using rast::TextureFilter;
    std::mt19937_64 random(5);
    std::uniform_real_distribution<float> unit(0, 1);
    const prep::ImageRef image = noise(37, 23, 4, GetParam());
    constexpr float half = 1, step = 2 * half / 31;
    for (const TextureFilter filter :
         {TextureFilter::by_sampler, TextureFilter::nearest_mip, TextureFilter::trilinear,
          TextureFilter::anisotropic, TextureFilter::ripmap, TextureFilter::ewa,
          TextureFilter::bicubic})
        for (int n = 0; n < 24; ++n) {
            prep::Material material;
            material.diffuse = glm::vec4(1);
            prep::PreparedScene scene = textured_square(image, n % 16, material);
            scene.scene.textures[0].mag = prep::Filter::nearest;  // as no filter has it
            // From a fifth of a texel to twelve texels a pixel, along axes that are turned.
            const auto length = [&] { return std::exp2(6 * unit(random) - 2.3f) / 30 / step; };
            const float along = length(), across = n % 6 == 5 ? 0 : length();
            const float turn = 6.28f * unit(random), sin = std::sin(turn), cos = std::cos(turn);
            const glm::vec2 right = glm::vec2(cos, sin) * along,
                            up = glm::vec2(-sin, cos) * across + right * (n % 2 == 1 ? 0.4f : 0.0f);
            prep::VertexMesh& mesh = scene.meshes[0];
            mesh.positions = {{-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}};
            for (std::size_t i = 0; i < 4; ++i)
                mesh.uvs[0][i] = right * mesh.positions[i].x + up * mesh.positions[i].y;
            rast::RenderRequest request;
            request.width = 45;
            request.height = 31;
            request.filter = filter;
            request.max_anisotropy = 1 << n % 5;
            request.keep_uvs = request.keep_ids = true;
            request.view = test::flat_view(half);
            const rast::Frame frame = test::draw(scene, request);
            const rast::MipTexture texture(*prep::load_image(image), scene.scene.textures[0],
                                           GetParam() != prep::PixelType::f32,
                                           rast::levels_for(filter));
            // A step of the Gaussian's table changes one of a few weights by 0.4 %.
            const double bound = filter == TextureFilter::ewa ? 4e-3 : 2e-4;
            for (std::size_t i = 0; i < frame.color.size(); ++i) {
                ASSERT_NE(frame.triangle[i], prep::no_index);
                const glm::vec4 expected = texture.sample(frame.uv[i], {right * step, -up * step},
                                                          filter, request.max_anisotropy);
                for (int c = 0; c < 3; ++c)
                    ASSERT_NEAR(frame.color[i][c], expected[c], bound)
                        << int(filter) << ", footprint " << n << ", pixel " << i;
            }
        }
}

INSTANTIATE_TEST_SUITE_P(Texels, TextureInstructions,
                         testing::Values(prep::PixelType::u8, prep::PixelType::u16,
                                         prep::PixelType::f32));

}  // namespace
