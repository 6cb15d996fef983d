// Textures as the shader samples them: linear-light mip pyramids.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "prep/image.h"
#include "prep/scene.h"
#include "rast/render.h"

namespace rast {

// A texture footprint: the change of UV per pixel to the right and down.
struct Footprint {
    glm::vec2 dx{0.0f}, dy{0.0f};
};

class MipTexture {
  public:
    // `colour`: decode RGB from sRGB before anything is averaged. Missing channels: grey is spread
    // to RGB, alpha is 1.
    MipTexture(const prep::Image& image, const prep::Texture& sampler, bool colour, bool mipped);

    // UV origin top left, repeated, mirrored or clamped as the sampler says. NaN coordinates read
    // texel (0, 0).
    glm::vec4 sample(const glm::vec2& uv, const Footprint& footprint, TextureFilter filter) const;

    std::uint32_t level_count() const { return std::uint32_t(levels_.size()); }
    // Level of detail as Vulkan and OpenGL define it: log2 of the longer footprint side in texels.
    float level_of_detail(const Footprint& footprint) const;

    struct Level {
        std::uint32_t width = 0, height = 0;
        std::vector<glm::vec4> texels;
    };
    const Level& level(std::uint32_t index) const { return levels_[index]; }

  private:
    glm::vec4 nearest(const Level& level, const glm::vec2& uv) const;
    glm::vec4 bilinear(const Level& level, const glm::vec2& uv) const;
    std::vector<Level> levels_;
    prep::Wrap wrap_u_, wrap_v_;
};

// For the kernels: at = u, v, then their change per pixel right (u, v) and down (u, v).
void sample_texture(const MipTexture& texture, TextureFilter filter, const float at[6],
                    float out[4]);

// Texel index in [0, size) for a texel coordinate of any size; −1 for border (Wrap::border
// outside).
std::int64_t wrap_texel(std::int64_t i, std::int64_t size, prep::Wrap wrap);

}  // namespace rast
