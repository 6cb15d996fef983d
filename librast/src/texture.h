// Textures as the shader samples them: linear-light mip pyramids.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
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

// How texels lie in memory, all levels one after the other. Files whose colours are all values of 8
// or 16 bits are packed: red, green and blue of 21 bits each in 8 bytes, texel_scale being 1, which
// holds every such value exactly. What is decoded from sRGB is off by half a step at most, 2^-22,
// and every coarser level by half a step more; steps are absolute, so that dark colours keep fewer
// digits. Alpha, where there is one, lies apart. Anything else stays floats.
inline constexpr std::int32_t texel_scale = 65535 * 32;  // of 2^21 − 1
inline constexpr int packed_bits = 21;
// Filters work on the packed numbers; the sum of both products is then correctly rounded k / 255
// and k / 65535 where the filtered texels are all alike.
inline constexpr float unpack_high = 0x1p-21f, unpack_low = 0x1.0001p-37f;

// The pyramid as the kernels read it. Index of a texel: firsts[level] + y · pitches[level] + x.
// A packed texel: red and the low 11 bits of green, then blue and the high 10 bits of green.
struct TextureView {
    static constexpr std::size_t most_levels = 17;  // of 65,536 texels a side
    std::int32_t widths[most_levels] = {}, heights[most_levels] = {};
    std::int32_t pitches[most_levels] = {}, firsts[most_levels] = {};
    std::uint32_t level_count = 0;
    const std::uint64_t* packed = nullptr;  // or
    const float* floats = nullptr;          // four a texel
    const float* alpha = nullptr;           // of packed texels; null: 1
    prep::Wrap wrap_u = prep::Wrap::repeat, wrap_v = prep::Wrap::repeat;
    bool by_lanes = false;  // texels can be told apart by 32 bits
};

struct FreeTexels {
    void operator()(std::byte* memory) const;
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
        std::uint32_t width = 0, height = 0, pitch = 0;  // pitch: texels from row to row
        std::size_t first = 0;                           // where its texels start
        std::size_t at(std::size_t x, std::size_t y) const { return first + y * pitch + x; }
    };
    const Level& level(std::uint32_t index) const {
        if (index >= pyramid_made()) make_pyramid(index);
        return levels_[index];
    }
    // A texel of a level that has been made.
    glm::vec4 texel(const Level& level, std::uint32_t x, std::uint32_t y) const {
        return finished(raw(level.at(x, y)));
    }
    const TextureView& view() const { return view_; }

  private:
    // As filters read them: packed colours times texel_scale. finished() undoes that.
    glm::vec4 raw(std::size_t index) const {
        if (floats_) {
            const float* const t = &floats_[index * 4];
            return {t[0], t[1], t[2], t[3]};
        }
        constexpr std::uint32_t mask = (1u << packed_bits) - 1;
        const std::uint32_t low = std::uint32_t(packed_[index]),
                            high = std::uint32_t(packed_[index] >> 32);
        return {float(low & mask), float(low >> packed_bits | high >> packed_bits << 11),
                float(high & mask), alpha_ ? alpha_[index] : 1.0f};
    }
    glm::vec4 finished(const glm::vec4& filtered) const;
    void write(std::size_t index, const glm::vec4& raw_value) const;
    void add_level(std::vector<Level>& to, std::uint32_t width, std::uint32_t height);
    void allocate(const prep::Image& image);
    void make_first(const prep::Image& image, bool colour);
    void make_next(const Level& fine, const Level& coarse) const;
    glm::vec4 wrapped(const Level& level, std::int64_t x, std::int64_t y) const;
    glm::vec4 filtered(const glm::vec2& uv, const Footprint& footprint, TextureFilter filter,
                       int most) const;
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
    std::vector<Level> levels_, rip_;  // rip_: rows of ever lower height, rip_columns_ widths each
    std::size_t rip_columns_ = 0, texel_count_ = 0;
    // Room for all levels; the system gives memory as they are written.
    std::unique_ptr<std::byte, FreeTexels> memory_;
    std::uint64_t* packed_ = nullptr;
    float *floats_ = nullptr, *alpha_ = nullptr;
    prep::Wrap wrap_u_, wrap_v_;
    TextureView view_;
};

// For the kernels: at = u, v, then their change per pixel right (u, v) and down (u, v).
void sample_texture(const MipTexture& texture, TextureFilter filter, int most, const float at[6],
                    float out[4]);

// Texel index in [0, size) for a texel coordinate of any size; −1 for border (Wrap::border
// outside).
std::int64_t wrap_texel(std::int64_t i, std::int64_t size, prep::Wrap wrap);

}  // namespace rast
