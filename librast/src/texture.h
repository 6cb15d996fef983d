// Textures as the shader samples them: linear-light mip pyramids.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <mutex>
#include <vector>

#include "prep/image.h"
#include "prep/scene.h"
#include "rast/render.h"

namespace rast {

// A texture footprint: the change of UV per pixel to the right and down.
struct Footprint {
    glm::vec2 dx{0.0f}, dy{0.0f};
};

// What is made of a texture beside its first level: half sizes down to one texel, or every
// combination of half widths and half heights (four times the memory).
enum class TextureLevels : std::uint8_t { base, mipmap, ripmap };
TextureLevels levels_for(TextureFilter filter);

// The pyramid as the kernels read it. `by_lanes`: without borders, and no axis that repeats has a
// length other than a power of two.
struct TextureAxis {
    prep::Wrap wrap = prep::Wrap::repeat;
};
struct TextureView {
    static constexpr std::size_t most_levels = 17;  // of 65,536 texels a side
    std::int32_t widths[most_levels] = {}, heights[most_levels] = {}, pitches[most_levels] = {};
    std::array<const float*, most_levels> texels{};
    std::uint32_t level_count = 0;
    TextureAxis u, v;
    bool by_lanes = false;
};

class MipTexture {
  public:
    MipTexture(MipTexture&&) = default;
    MipTexture& operator=(MipTexture&&) = default;

    // The first level alone: the others follow as they are read.
    // `colour`: decode RGB from sRGB before anything is averaged. Missing channels: grey is spread
    // to RGB, alpha is 1.
    MipTexture(const prep::Image& image, const prep::Texture& sampler, bool colour,
               TextureLevels levels);

    // UV origin top left, repeated, mirrored or clamped as the sampler says. NaN coordinates read
    // texel (0, 0).
    // `most`: probes of the anisotropic filter, and the longest ellipse of EWA, as a ratio of its
    // sides. Filters:
    //   bicubic      Keys (1981), a = −½, on the two levels that trilinear reads; overshoots.
    //   anisotropic  as EXT_texture_filter_anisotropic describes it: trilinear probes along the
    //                longer side, at the level of that side over their number.
    //   ewa          Heckbert (1989): Gaussian over the footprint's ellipse, on the two levels that
    //                the shorter side asks for.
    //   ripmap       the two levels of either axis, by the larger change of either coordinate.
    // Footprints of at most a texel are read as by trilinear. A constant texture comes out with its
    // own bits from all of them (but the mip levels' rounding).
    glm::vec4 sample(const glm::vec2& uv, const Footprint& footprint, TextureFilter filter,
                     int most = 8) const;

    std::uint32_t level_count() const { return std::uint32_t(levels_.size()); }
    // Levels are made when they are first read, each from the one before, whichever thread asks.
    // How many of the pyramid's there are now, from the first on: the kernels read no more of them
    // than that before they ask for more.
    std::uint32_t pyramid_made() const { return lazy_->pyramid.load(std::memory_order_acquire); }
    void make_pyramid(std::uint32_t last) const;  // up to this level, at least
    void make_all_levels() const;
    std::uint64_t levels_made() const;  // of pyramid and ripmap together
    // Level of detail as Vulkan and OpenGL define it: log2 of the longer footprint side in texels.
    float level_of_detail(const Footprint& footprint) const;

    struct Level {
        // Rows of a multiple of 4,096 bytes are a cache line longer: a column of texels would
        // otherwise share a few sets of the caches and push itself out.
        Level(std::uint32_t across, std::uint32_t down)
            : width(across), height(down), pitch(across % 256 == 0 ? across + 4 : across) {}
        void allocate() { texels.resize(std::size_t(pitch) * height); }
        std::uint32_t width = 0, height = 0, pitch = 0;  // pitch: texels from row to row
        std::vector<glm::vec4> texels;
        std::size_t at(std::size_t x, std::size_t y) const { return y * pitch + x; }
    };
    const Level& level(std::uint32_t index) const {
        if (index >= pyramid_made()) make_pyramid(index);
        return levels_[index];
    }
    const TextureView& view() const { return view_; }

  private:
    glm::vec4 texel(const Level& level, std::int64_t x, std::int64_t y) const;
    glm::vec4 nearest(const Level& level, const glm::vec2& uv) const;
    glm::vec4 bilinear(const Level& level, const glm::vec2& uv) const;
    glm::vec4 bicubic(const Level& level, const glm::vec2& uv) const;
    glm::vec4 bicubic(const glm::vec2& uv, const Footprint& footprint) const;
    glm::vec4 anisotropic(const glm::vec2& uv, const Footprint& footprint, int most) const;
    glm::vec4 ellipse(const Level& level, const glm::vec2& uv, const glm::dvec2& a,
                      const glm::dvec2& b) const;
    glm::vec4 ewa(const glm::vec2& uv, const Footprint& footprint, int most) const;
    glm::vec4 ripmap(const glm::vec2& uv, const Footprint& footprint) const;
    template <class Read>
    glm::vec4 between_levels(float lod, const Read& read) const;

    const Level& rip_level(std::size_t index) const;
    void make_rip(std::size_t index) const;

    // Made so far; apart, so that textures can move.
    struct Lazy {
        std::mutex mutex;
        std::atomic<std::uint32_t> pyramid{1};
        std::vector<std::atomic<bool>> rip;
    };
    std::unique_ptr<Lazy> lazy_;
    // Sizes are there from the start, texels once they are made.
    mutable std::vector<Level> levels_;
    mutable std::vector<Level> rip_;  // rows of ever lower height, rip_columns_ widths each
    std::size_t rip_columns_ = 0;
    prep::Wrap wrap_u_, wrap_v_;
    mutable TextureView view_;
};

// For the kernels: at = u, v, then their change per pixel right (u, v) and down (u, v).
void sample_texture(const MipTexture& texture, TextureFilter filter, int most, const float at[6],
                    float out[4]);

// Texel index in [0, size) for a texel coordinate of any size; −1 for border (Wrap::border
// outside).
std::int64_t wrap_texel(std::int64_t i, std::int64_t size, prep::Wrap wrap);

}  // namespace rast
