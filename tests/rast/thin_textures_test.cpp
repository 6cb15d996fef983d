// EWA on textures of a texel across, whose levels get shorter and no narrower: what comes out, and
// that it ends soon.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <vector>

#include "builders.h"
#include "prep/simd.h"
#include "textures.h"

namespace {

using rast::Footprint;
using rast::MipTexture;
using rast::TextureFilter;

constexpr int longest = 16;  // ellipse

// One texel across, so many down.
MipTexture column_of(const prep::Image& image) {
    return test::texture_of(image, prep::Wrap::repeat, prep::Wrap::repeat, true);
}

// The share of a row in the ellipse's Gaussian, exp(−2r²) − exp(−2), of which t = r² in its middle:
// the integral along the row, in units of half the ellipse's length.
double row_weight(double t) {
    if (t >= 1) return 0;
    const double half = std::sqrt(1 - t);
    constexpr double pi = 3.14159265358979323846;
    return std::exp(-2 * t) * std::sqrt(pi / 2) * std::erf(std::sqrt(2.0) * half) -
           2 * std::exp(-2.0) * half;
}

// Across there is one texel only: a row's weight is all that counts.
TEST(ThinTextures, RowsHaveTheirShareOfTheEllipse) {
    constexpr std::uint32_t height = 1024, step = 8;  // of the fourth level
    const prep::Image image = test::random_image(1, height, 3);
    std::vector<double> rows;
    for (std::uint32_t j = 0; j < height / step; ++j) {
        double sum = 0;
        for (std::uint32_t k = 0; k < step; ++k) sum += double(image.at(0, step * j + k)[0]);
        rows.push_back(sum / step);
    }
    const MipTexture texture = column_of(image);
    // Sixteen times as long as wide, and wide enough for that level alone.
    const Footprint footprint{{double(longest) * step, 0}, {0, double(step) / height}};
    for (int n = 0; n < 200; ++n) {
        const float v = 0.1f + 0.004f * float(n);
        const double at = double(v) * double(rows.size()) - 0.5;
        double sum = 0, total = 0;
        for (int j = int(at) - 3; j <= int(at) + 4; ++j) {
            // A texel wide, widened by one: 1 + 1.
            const double w = row_weight((j - at) * (j - at) / 2);
            sum += rows[std::size_t(j)] * w;
            total += w;
        }
        // The row's texels are a sum for the integral, its weights steps of a table.
        EXPECT_NEAR(texture.sample({0.3f, v}, footprint, TextureFilter::ewa, longest).r,
                    sum / total, 1e-2);
    }
}

// With all of the footprint's repeats each sample would read a million texels a row: an hour.
TEST(ThinTextures, FootprintsOfManyRepeatsEnd) {
    for (const bool down : {true, false}) {
        const prep::Image image =
            down ? test::random_image(1, 32768, 5) : test::random_image(32768, 1, 5);
        const MipTexture texture = column_of(image);
        for (int n = 0; n < 50'000; ++n) {
            const glm::vec2 across(5e5f, 40.0f / 32768), along(3.0f * float(n % 7), 0.9f);
            const Footprint footprint = down ? Footprint{across, along}
                                             : Footprint{{across.y, across.x}, {along.y, along.x}};
            const glm::vec4 c = texture.sample({0.3f, 0.001f * float(n % 1000)}, footprint,
                                               TextureFilter::ewa, longest);
            for (int k = 0; k < 4; ++k) ASSERT_TRUE(c[k] >= 0 && c[k] <= 1);
        }
    }
}

// In pictures, the same bytes on every instruction set.
TEST(ThinTextures, GiveTheSameBytesOnEveryInstructionSet) {
    for (const bool down : {true, false}) {
        prep::VertexMesh mesh;
        mesh.positions = {{-1, -1, 0}, {3, -1, -6}, {3, 1, -6}, {-1, 1, 0}};
        mesh.uvs = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
        mesh.indices = {0, 1, 2, 0, 2, 3};
        prep::Material material;
        material.unlit = true;
        material.diffuse_map.texture = 0;
        material.diffuse_map.scale = down ? glm::vec2(1e6f, 30) : glm::vec2(30, 1e6f);
        prep::PreparedScene scene = test::scene_of(mesh, material);
        prep::ImageRef ref;
        ref.name = "thin.png";
        ref.bytes = *prep::encode_png(down ? test::random_image(1, 4096, 7)
                                           : test::random_image(4096, 1, 7));
        scene.scene.images.push_back(ref);
        scene.scene.textures.emplace_back().image = 0;
        rast::RenderRequest request;
        request.width = 61;
        request.height = 47;
        request.filter = TextureFilter::ewa;
        request.max_anisotropy = longest;
        request.view = test::look_at({-0.4, 0.3, 1.2}, {0.6, 0, -1.5});
        request.simd = prep::SimdLevel::scalar;
        const rast::Frame scalar = test::draw(scene, request);
        EXPECT_GT(scalar.counters.pixels_shaded, 500u);
        for (const auto level :
             {prep::SimdLevel::sse4, prep::SimdLevel::avx2, prep::SimdLevel::avx512}) {
            if (!prep::simd_available(level)) continue;
            request.simd = level;
            const rast::Frame other = test::draw(scene, request);
            EXPECT_EQ(std::memcmp(scalar.color.data(), other.color.data(),
                                  scalar.color.size() * sizeof(glm::vec4)),
                      0)
                << to_string(level);
        }
    }
}

}  // namespace
