// Textures as the shader samples them: linear-light mip pyramids.
#pragma once

#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <mutex>
#include <vector>

#include "prep/image.h"
#include "prep/scene.h"
#include "rast/render.h"
#include "shading/quad.h"

namespace rast {

// A texture footprint: the change of UV per pixel to the right and down.
struct Footprint {
    glm::vec2 dx{0.0f}, dy{0.0f};
};

// What is made of a texture beside its first level: half sizes down to one texel, or every
// combination of half widths and half heights (four times the memory).
enum class TextureLevels : std::uint8_t { base, mipmap, ripmap };
TextureLevels levels_for(TextureFilter filter, prep::MipFilter mip = prep::MipFilter::linear);
// What is left of a filter for a texture: `by_sampler` only where the sampler is no filter's like,
// as one that magnifies to the nearest texel and minifies smoothly.
TextureFilter filter_for(TextureFilter asked, const prep::Texture& sampler);

// The whole texel of a coordinate of any size (0 beyond 10^12 texels, where floats have no parts of
// one, and of NaN).
inline std::int64_t whole_texel(float x) {
    return std::abs(x) < 1e12f ? std::int64_t(std::floor(x)) : 0;
}

// How texels lie in memory: red, green, blue and alpha side by side, all levels one after the
// other. Files of 8 bits, and files of 16 bits that are not decoded from sRGB, take 8 bytes a
// texel: 16 bits a channel, kept with their highest bit turned over, as the kernels multiply signed
// numbers. They hold every value of such a file exactly. What is decoded from sRGB is off by half a
// step at most, 2^-17, a fortieth of the darkest step of sRGB's 8 bits, and every coarser level by
// half a step more. Anything else takes four floats.
//
// Bilinear filters mix such codes c downwards in integers, by 32768ths of a texel:
// −32768 (c − 32768), exactly where all four are alike; from there on in float.
inline constexpr std::int32_t texel_scale = 65535, texel_middle = 32768;
inline constexpr std::int32_t down_steps = 32768;
inline constexpr float mixed_scale = -1.0f / float(down_steps), mixed_middle = float(texel_middle);
// The sum of both products is the correctly rounded code / 65535.
inline constexpr float unpack_high = 0x1p-16f, unpack_low = 0x1.0001p-32f;

// Levels have texels around them as the wrapping has it, so that neighbours always lie side by
// side: two before each row and each column, which only Wrap::border needs, and one behind.
inline constexpr std::int32_t margin_before = 2, margin_behind = 1;

// The pyramid as the kernels read it. Index of a texel: firsts[level] + y · pitches[level] + x.
// Two packed textures that are read at the same places may lie together, a texel of the one and
// then one of the other: both come with one load, and with half as many lines of the caches.
struct TextureView {
    static constexpr std::size_t most_levels = 17;  // of 65,536 texels a side
    // Of each level; readable as a vector.
    std::int32_t widths[most_levels] = {}, heights[most_levels] = {};
    std::int32_t pitches[most_levels] = {}, firsts[most_levels] = {};
    std::uint32_t level_count = 0;
    const std::int16_t* packed = nullptr;  // or
    const float* floats = nullptr;         // four a texel
    const std::int16_t* pair = nullptr;    // `packed` of the first one of two that lie together
    std::uint32_t step = 1;                // packed texels from one to the next
    prep::Wrap wrap_u = prep::Wrap::repeat, wrap_v = prep::Wrap::repeat;
    bool by_lanes = false;  // texels can be told apart by 32 bits
    // Of the ripmap: columns, rows, and for each of its levels, row by row, the first texel.
    std::uint32_t rip_columns = 0, rip_rows = 0;
    const std::int32_t *rip_widths = nullptr, *rip_heights = nullptr, *rip_pitches = nullptr;
    const std::int32_t* rip_firsts = nullptr;

    bool is_second() const { return pair != packed; }
};

// Whether both have texels at the same places, as far as these are read.
bool have_same_texels(const TextureView& a, const TextureView& b);

// Where a filter of two texels along one axis reads: texels `first` and first + 1, which may be in
// the margins, `part` of the second.
struct OnAxis {
    std::int64_t first = 0;
    float part = 0;
};

class MipTexture {
  public:
    MipTexture(MipTexture&&) = default;
    MipTexture& operator=(MipTexture&&) = default;

    // The first level alone: the others follow as they are read. `units`: how many of u and of v
    // the picture holds, for those who read it: sample() takes coordinates of one. `colour`: decode
    // RGB from sRGB before anything is averaged. Missing channels: grey is spread to RGB, alpha
    // is 1.
    MipTexture(const prep::Image& image, const prep::Texture& sampler, bool colour,
               TextureLevels levels, const glm::vec2& units = glm::vec2(1.0f));

    const glm::vec2& units() const { return units_; }

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
    //   nearest_mip  half way between two levels the finer one, as OpenGL and Vulkan round.
    //   by_sampler   magnified to a texel a pixel or more as the sampler's `mag`, else as its `min`
    //                on the levels of its `mip`.
    // Footprints of at most a texel are read as by trilinear, except by bicubic, nearest and
    // by_sampler. A constant texture comes out with its own bits from all of them (but the mip
    // levels' rounding).
    glm::vec4 sample(const glm::vec2& uv, const Footprint& footprint, TextureFilter filter,
                     int most = 8) const;

    // From now on the texels of both lie together. Returns whether they do: textures must be
    // packed, have the same texels, no ripmaps, and not lie with others. No other thread may read
    // them now.
    static bool put_together(MipTexture& a, MipTexture& b);

    std::uint32_t level_count() const { return std::uint32_t(levels_.size()); }
    // Levels are made when they are first read, each from the one before, whichever thread asks.
    // How many of the pyramid's there are now, from the first on: the kernels read no more of them
    // than that before they ask for more.
    std::uint32_t pyramid_made() const { return lazy_->pyramid.load(std::memory_order_acquire); }
    void make_pyramid(std::uint32_t last) const;  // up to this level, at least
    void make_all_levels() const;
    void make_rip(std::size_t index) const;  // of the ripmap, unless it is there
    std::uint64_t levels_made() const;       // of pyramid and ripmap together
    // Level of detail as Vulkan and OpenGL define it: log2 of the longer footprint side in texels.
    float level_of_detail(const Footprint& footprint) const;

    struct Level {
        std::uint32_t width = 0, height = 0, pitch = 0;  // pitch: texels from row to row
        std::size_t first = 0;                           // texel (0, 0)
        // Margins have negative coordinates.
        std::size_t at(std::int64_t x, std::int64_t y) const {
            return std::size_t(std::int64_t(first) + y * std::int64_t(pitch) + x);
        }
    };
    const Level& level(std::uint32_t index) const {
        if (index >= pyramid_made()) make_pyramid(index);
        return levels_[index];
    }
    // A texel of a level that has been made.
    glm::vec4 texel(const Level& level, std::uint32_t x, std::uint32_t y) const {
        return finished(raw(level.at(x, y)));
    }
    // Of the first level; where that may be constant, of all levels, which are made for it. Ends
    // as soon as every question is answered with no. The same for any number of threads.
    TexelFacts facts(const TexelQuestions& asked, int threads) const;
    const TextureView& view() const { return view_; }
    // For the kernels, which know no `by_sampler` that filter_for() can name.
    TextureFilter filter_for(TextureFilter asked) const {
        return rast::filter_for(asked, sampler_);
    }

  private:
    // As filters read them: packed channels times texel_scale. finished() undoes that.
    Quad raw_quad(std::size_t index) const {
        return floats_ ? load_quad(&floats_[index * 4])
                       : to_quad(load_codes(code_at(index)) + texel_middle);
    }
    glm::vec4 raw(std::size_t index) const { return to_vec4(raw_quad(index)); }
    glm::vec4 finished(const glm::vec4& filtered) const;
    void write(std::size_t index, const glm::vec4& raw_value) const;
    std::int16_t* code_at(std::size_t index) const { return &packed_[index * 4 * view_.step]; }
    std::size_t end_of(const Level& level) const;
    void move_to(const std::shared_ptr<std::byte>& pair, bool second);
    void add_level(std::vector<Level>& to, std::uint32_t width, std::uint32_t height);
    void allocate(bool packed);
    void make_first(const prep::Image& image, bool colour);
    void make_next(const Level& fine, const Level& coarse) const;
    void make_margins(const Level& level) const;
    void copy_texels(std::size_t from, std::size_t to, std::size_t count) const;
    void clear_texels(std::size_t first, std::size_t count) const;
    // Of a texel that wrapping has placed; below 0 is the border.
    Quad placed(const Level& level, std::int64_t x, std::int64_t y) const {
        return x < 0 || y < 0 ? Quad{} : raw_quad(level.at(x, y));
    }
    glm::vec4 filtered(const glm::vec2& uv, const Footprint& footprint, TextureFilter filter,
                       int most) const;
    glm::vec4 nearest(const Level& level, const glm::vec2& uv) const;
    glm::vec4 mixed(const Level& level, const glm::vec2& uv) const;
    glm::vec4 unmixed(const glm::vec4& mixed) const;
    glm::vec4 bilinear(const Level& level, const glm::vec2& uv) const {
        return unmixed(mixed(level, uv));
    }
    glm::vec4 trilinear(const glm::vec2& uv, float lod) const;
    glm::vec4 bicubic(const Level& level, const glm::vec2& uv) const;
    glm::vec4 bicubic(const glm::vec2& uv, const Footprint& footprint) const;
    glm::vec4 anisotropic(const glm::vec2& uv, const Footprint& footprint, int most) const;
    glm::vec4 ellipse(const Level& level, const glm::vec2& uv, const glm::vec2& major,
                      const glm::vec2& minor, int most) const;
    glm::vec4 ewa(const glm::vec2& uv, const Footprint& footprint, int most) const;
    glm::vec4 ripmap(const glm::vec2& uv, const Footprint& footprint) const;
    glm::vec4 by_sampler(const glm::vec2& uv, const Footprint& footprint) const;
    std::uint32_t nearest_level(float lod) const;
    template <class Read>
    glm::vec4 between_levels(float lod, const Read& read) const;

    const Level& rip_level(std::size_t index) const;
    void list_rips();

    // Made so far; apart, so that textures can move.
    struct Lazy {
        std::mutex mutex;
        std::atomic<std::uint32_t> pyramid{1};
        std::vector<std::atomic<bool>> rip;
    };
    std::unique_ptr<Lazy> lazy_;
    std::vector<Level> levels_, rip_;  // rip_: rows of ever lower height, rip_columns_ widths each
    std::size_t rip_columns_ = 0, texel_count_ = 0;
    std::vector<std::int32_t> rip_list_;  // what the view shows of rip_
    // Room for all levels; the system gives memory as they are written.
    std::shared_ptr<std::byte> memory_;  // of both, if there are two
    std::int16_t* packed_ = nullptr;
    float* floats_ = nullptr;
    prep::Texture sampler_;
    glm::vec2 units_;
    TextureView view_;
};

// For the kernels: at = u, v, then their change per pixel right (u, v) and down (u, v).
void sample_texture(const MipTexture& texture, TextureFilter filter, int most, const float at[6],
                    float out[4]);

// exp(−2 r²) − exp(−2) over r² in [0, 1): Heckbert's Gaussian, cut off at the ellipse.
inline constexpr int weight_entries = 256;
const float* ellipse_weights();

// Texel index in [0, size) for a texel coordinate of any size; −1 for border (Wrap::border
// outside).
std::int64_t wrap_texel(std::int64_t i, std::int64_t size, prep::Wrap wrap);

}  // namespace rast
