#include "texture.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <new>
#if defined(__linux__)
#include <sys/mman.h>
#endif

#include "color.h"
#include "elementary.h"

namespace rast {
namespace {

// The number of a 16-bit file that a value is (8-bit ones are among them); below 0: none.
std::int32_t code_of(float x) {
    if (!(x >= 0 && x <= 1)) return -1;
    const float scaled = x * 65535.0f;
    const auto code = std::int32_t(scaled + 0.5f);
    return std::abs(scaled - float(code)) <= float(code) * 0x1p-22f ? code : -1;
}

bool fits_packed(const prep::Image& image) {
    const std::size_t colours = image.channels >= 3 ? 3 : 1, channels = image.channels;
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
        if (i % channels < colours && code_of(image.pixels[i]) < 0) return false;
    return true;
}

// One axis of the next level: which texels of the finer one a texel covers, with weights. Box
// filter; odd sizes weigh the shared texels by the part that is covered, so that the mean is kept
// exactly.
struct Tap {
    std::uint32_t first = 0, count = 0;
    float weight[3] = {0, 0, 0};
};

std::vector<Tap> taps(std::uint32_t from, std::uint32_t to) {
    std::vector<Tap> result(to);
    for (std::uint32_t i = 0; i < to; ++i) {
        const double begin = double(i) * from / to, end = double(i + 1) * from / to;
        Tap& tap = result[i];
        tap.first = std::uint32_t(begin);
        for (std::uint32_t k = tap.first; k < from && double(k) < end && tap.count < 3; ++k) {
            const double covered = std::min(end, double(k + 1)) - std::max(begin, double(k));
            tap.weight[tap.count++] = float(covered / (end - begin));
        }
    }
    return result;
}

// Whole texel and the rest, for coordinates of any size (beyond 2^40 texels the rest is lost, and
// NaN is 0).
std::int64_t whole(float x) {
    if (!(std::abs(x) < 1e12f)) return 0;
    return std::int64_t(std::floor(x));
}

}  // namespace

std::int64_t wrap_texel(std::int64_t i, std::int64_t size, prep::Wrap wrap) {
    switch (wrap) {
        case prep::Wrap::repeat: {
            const std::int64_t r = i % size;
            return r < 0 ? r + size : r;
        }
        case prep::Wrap::mirror: {
            std::int64_t r = i % (2 * size);
            if (r < 0) r += 2 * size;
            return r < size ? r : 2 * size - 1 - r;
        }
        case prep::Wrap::clamp:
            return std::clamp<std::int64_t>(i, 0, size - 1);
        case prep::Wrap::border:
            return i < 0 || i >= size ? -1 : i;
    }
    return 0;
}

TextureLevels levels_for(TextureFilter filter) {
    switch (filter) {
        case TextureFilter::nearest:
        case TextureFilter::bilinear:
            return TextureLevels::base;
        case TextureFilter::ripmap:
            return TextureLevels::ripmap;
        case TextureFilter::bicubic:
        case TextureFilter::trilinear:
        case TextureFilter::anisotropic:
        case TextureFilter::ewa:
            break;
    }
    return TextureLevels::mipmap;
}

void MipTexture::add_level(std::vector<Level>& to, std::uint32_t width, std::uint32_t height) {
    // Rows of a power of two of bytes, or nearly, are a little longer: a column of texels would
    // otherwise share a few sets of the caches and push itself out.
    const std::uint32_t pitch = width % 256 == 0 ? width + 8 : width;
    to.push_back({width, height, pitch, texel_count_});
    texel_count_ += std::size_t(pitch) * height;
}

MipTexture::MipTexture(const prep::Image& image, const prep::Texture& sampler, bool colour,
                       TextureLevels levels)
    : lazy_(std::make_unique<Lazy>()), wrap_u_(sampler.wrap_u), wrap_v_(sampler.wrap_v) {
    const auto half = [](std::uint32_t size) { return std::max(1u, size / 2); };
    add_level(levels_, image.width, image.height);
    if (levels == TextureLevels::mipmap)
        while (levels_.back().width > 1 || levels_.back().height > 1)
            add_level(levels_, half(levels_.back().width), half(levels_.back().height));
    if (levels == TextureLevels::ripmap) {
        rip_.push_back(levels_[0]);
        while (rip_.back().width > 1) add_level(rip_, half(rip_.back().width), image.height);
        rip_columns_ = rip_.size();
        for (std::size_t above = 0; rip_[above].height > 1; above += rip_columns_)
            for (std::size_t c = 0; c < rip_columns_; ++c)
                add_level(rip_, rip_[c].width, half(rip_[above].height));
        lazy_->rip = std::vector<std::atomic<bool>>(rip_.size());
    }
    allocate(image);
    make_first(image, colour);
    view_.level_count = std::uint32_t(levels_.size());
    view_.wrap_u = wrap_u_;
    view_.wrap_v = wrap_v_;
    view_.by_lanes = levels_.size() <= TextureView::most_levels &&
                     texel_count_ < (std::size_t(1) << 29);  // four floats each: below 2^31
    for (std::size_t l = 0; view_.by_lanes && l < levels_.size(); ++l) {
        view_.widths[l] = std::int32_t(levels_[l].width);
        view_.heights[l] = std::int32_t(levels_[l].height);
        view_.pitches[l] = std::int32_t(levels_[l].pitch);
        view_.firsts[l] = std::int32_t(levels_[l].first);
    }
}

void FreeTexels::operator()(std::byte* memory) const {
    std::free(memory);
}

void MipTexture::allocate(const prep::Image& image) {
    // Not initialised: levels that nobody reads shall take no memory.
    const bool packed = fits_packed(image);
    const bool alpha = packed && (image.channels == 2 || image.channels > 3);
    const std::size_t texel_bytes = packed ? sizeof(std::uint64_t) : 4 * sizeof(float);
    const std::size_t bytes = texel_count_ * (texel_bytes + (alpha ? sizeof(float) : 0));
    // Neighbours in a column are a row apart: with small pages, each of them is a page of its own,
    // and looking pages up takes longer than reading texels.
    constexpr std::size_t large_page = std::size_t(1) << 21;
    const std::size_t unit = bytes < large_page ? 64 : large_page;
    memory_.reset(
        static_cast<std::byte*>(std::aligned_alloc(unit, (bytes + unit - 1) / unit * unit)));
    if (!memory_) throw std::bad_alloc();
#if defined(__linux__)
    if (unit == large_page) madvise(memory_.get(), bytes, MADV_HUGEPAGE);
#endif
    if (packed)
        packed_ = reinterpret_cast<std::uint64_t*>(memory_.get());
    else
        floats_ = reinterpret_cast<float*>(memory_.get());
    if (alpha) alpha_ = reinterpret_cast<float*>(memory_.get() + texel_count_ * texel_bytes);
    view_.packed = packed_;
    view_.floats = floats_;
    view_.alpha = alpha_;
}

glm::vec4 MipTexture::finished(const glm::vec4& filtered) const {
    if (floats_) return filtered;
    glm::vec4 out = filtered;
    for (int k = 0; k < 3; ++k) out[k] = filtered[k] * unpack_high + filtered[k] * unpack_low;
    return out;
}

void MipTexture::write(std::size_t index, const glm::vec4& value) const {
    if (floats_) {
        for (std::size_t k = 0; k < 4; ++k) floats_[index * 4 + k] = value[int(k)];
        return;
    }
    std::uint32_t code[3];
    for (int k = 0; k < 3; ++k)
        code[k] = std::uint32_t(std::clamp(value[k] + 0.5f, 0.0f, float(texel_scale)));
    constexpr std::uint32_t low_green = (1u << 11) - 1;
    packed_[index] = std::uint64_t(code[0] | (code[1] & low_green) << packed_bits) |
                     std::uint64_t(code[2] | code[1] >> 11 << packed_bits) << 32;
    if (alpha_) alpha_[index] = value.a;
}

void MipTexture::make_first(const prep::Image& image, bool colour) {
    std::vector<std::int32_t> decoded;  // of the codes that came, times texel_scale
    if (packed_ && colour) decoded.assign(65536, -1);
    const auto decode = [&](float x) {
        if (!packed_) return colour ? srgb_to_linear(x) : x;
        const std::int32_t code = code_of(x);
        if (!colour) return float(code * (texel_scale / 65535));
        std::int32_t& known = decoded[std::size_t(code)];
        if (known < 0)
            known =
                std::int32_t(double(srgb_to_linear(float(code) / 65535.0f)) * texel_scale + 0.5);
        return float(known);
    };
    for (std::size_t i = 0; i < std::size_t(image.width) * image.height; ++i) {
        const float* p = image.pixels.data() + i * image.channels;
        const std::size_t at = levels_[0].at(i % image.width, i / image.width);
        if (image.channels >= 3)
            write(at, {decode(p[0]), decode(p[1]), decode(p[2]), image.channels > 3 ? p[3] : 1.0f});
        else
            write(at, glm::vec4(glm::vec3(decode(p[0])), image.channels == 2 ? p[1] : 1.0f));
    }
}

void MipTexture::make_next(const Level& fine, const Level& coarse) const {
    const std::vector<Tap> across = taps(fine.width, coarse.width);
    const std::vector<Tap> down = taps(fine.height, coarse.height);
    for (std::uint32_t y = 0; y < coarse.height; ++y)
        for (std::uint32_t x = 0; x < coarse.width; ++x) {
            glm::vec4 sum(0.0f);
            for (std::uint32_t j = 0; j < down[y].count; ++j)
                for (std::uint32_t i = 0; i < across[x].count; ++i)
                    sum += raw(fine.at(across[x].first + i, down[y].first + j)) *
                           (down[y].weight[j] * across[x].weight[i]);
            write(coarse.at(x, y), sum);
        }
}

void MipTexture::make_pyramid(std::uint32_t last) const {
    const std::lock_guard lock(lazy_->mutex);
    for (std::uint32_t l = lazy_->pyramid; l <= last && l < levels_.size(); ++l) {
        make_next(levels_[l - 1], levels_[l]);
        lazy_->pyramid.store(l + 1, std::memory_order_release);
    }
}

void MipTexture::make_rip(std::size_t index) const {
    if (index == 0 || lazy_->rip[index].load(std::memory_order_acquire)) return;
    const bool first_row = index < rip_columns_;
    const std::size_t from = first_row ? index - 1 : index - rip_columns_;
    make_rip(from);
    const std::lock_guard lock(lazy_->mutex);
    if (lazy_->rip[index]) return;
    make_next(rip_[from], rip_[index]);
    lazy_->rip[index].store(true, std::memory_order_release);
}

const MipTexture::Level& MipTexture::rip_level(std::size_t index) const {
    make_rip(index);
    return rip_[index];
}

void MipTexture::make_all_levels() const {
    make_pyramid(level_count() - 1);
    for (std::size_t i = 0; i < rip_.size(); ++i) make_rip(i);
}

std::uint64_t MipTexture::levels_made() const {
    std::uint64_t made = pyramid_made();
    for (const std::atomic<bool>& level : lazy_->rip) made += level;
    return made;
}

glm::vec4 MipTexture::nearest(const Level& level, const glm::vec2& uv) const {
    const std::int64_t x = wrap_texel(whole(uv.x * float(level.width)), level.width, wrap_u_);
    const std::int64_t y = wrap_texel(whole(uv.y * float(level.height)), level.height, wrap_v_);
    if (x < 0 || y < 0) return glm::vec4(0.0f);
    return raw(level.at(std::size_t(x), std::size_t(y)));
}

glm::vec4 MipTexture::bilinear(const Level& level, const glm::vec2& uv) const {
    const float u = uv.x * float(level.width) - 0.5f, v = uv.y * float(level.height) - 0.5f;
    const std::int64_t x = whole(u), y = whole(v);
    const float fx = std::abs(u) < 1e12f ? u - float(x) : 0,
                fy = std::abs(v) < 1e12f ? v - float(y) : 0;
    const std::int64_t x0 = wrap_texel(x, level.width, wrap_u_);
    const std::int64_t x1 = wrap_texel(x + 1, level.width, wrap_u_);
    const std::int64_t y0 = wrap_texel(y, level.height, wrap_v_);
    const std::int64_t y1 = wrap_texel(y + 1, level.height, wrap_v_);
    const auto at = [&](std::int64_t i, std::int64_t j) {
        return i < 0 || j < 0 ? glm::vec4(0.0f) : raw(level.at(std::size_t(i), std::size_t(j)));
    };
    // a + f·(b − a): a constant texture stays bit-constant.
    const glm::vec4 a = at(x0, y0), c = at(x0, y1);
    const glm::vec4 top = a + (at(x1, y0) - a) * fx, bottom = c + (at(x1, y1) - c) * fx;
    return top + (bottom - top) * fy;
}

float MipTexture::level_of_detail(const Footprint& f) const {
    const glm::vec2 size(float(levels_[0].width), float(levels_[0].height));
    const glm::vec2 x = f.dx * size, y = f.dy * size;
    const float longest = std::max(x.x * x.x + x.y * x.y, y.x * y.x + y.y * y.y);
    if (!(longest > 1)) return 0;  // magnified, or NaN
    if (!(longest < 1e30f)) return float(levels_.size() - 1);
    return 0.5f * log2_portable(longest);
}

void sample_texture(const MipTexture& texture, TextureFilter filter, int most, const float at[6],
                    float out[4]) {
    const glm::vec4 c =
        texture.sample({at[0], at[1]}, {{at[2], at[3]}, {at[4], at[5]}}, filter, most);
    for (int k = 0; k < 4; ++k) out[k] = c[k];
}

}  // namespace rast
