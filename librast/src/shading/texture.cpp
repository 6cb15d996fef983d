#include "shading/texture.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <new>

#include "base/scratch_buffer.h"
#include "shading/color.h"
#include "shading/portable_math.h"

namespace rast {
namespace {

// The number of a 16-bit file that a value is (8-bit ones are among them); below 0: none.
std::int32_t code_of(float x) {
    if (!(x >= 0 && x <= 1)) return -1;
    const float scaled = x * 65535.0f;
    const auto code = std::int32_t(scaled + 0.5f);
    return std::abs(scaled - float(code)) <= float(code) * 0x1p-22f ? code : -1;
}

bool fits_packed(const prep::Image& image, bool colour) {
    const std::size_t colours = image.channels >= 3 ? 3 : 1, channels = image.channels;
    constexpr std::int32_t of_8_bits = 65535 / 255;
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        const std::int32_t code = code_of(image.pixels[i]);
        if (code < 0 || (colour && i % channels < colours && code % of_8_bits != 0)) return false;
    }
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

// Of a coordinate from texel centre to texel centre.
OnAxis on_axis(float t, std::int64_t size, prep::Wrap wrap) {
    OnAxis out{whole_texel(t), 0.0f};
    if (std::abs(t) < 1e12f) out.part = t - float(out.first);
    std::int64_t& i = out.first;
    switch (wrap) {
        case prep::Wrap::repeat:
            i = wrap_texel(i, size, wrap);
            break;
        case prep::Wrap::mirror:
            i = wrap_texel(i, 2 * size, prep::Wrap::repeat);
            if (i < size) break;
            i = 2 * size - 2 - i;
            out.part = 1 - out.part;
            break;
        case prep::Wrap::clamp:
            i = std::clamp<std::int64_t>(i, -1, size - 1);
            break;
        case prep::Wrap::border:
            if (i < -1 || i >= size) i = -2;
            break;
    }
    return out;
}

// Of a part below a texel, rounded.
std::int32_t down_steps_of(float part) {
    return std::int32_t(part * float(down_steps) + 0.5f);
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

TextureLevels levels_for(TextureFilter filter, prep::MipFilter mip) {
    switch (filter) {
        case TextureFilter::by_sampler:
            return mip == prep::MipFilter::none ? TextureLevels::base : TextureLevels::mipmap;
        case TextureFilter::nearest:
        case TextureFilter::bilinear:
            return TextureLevels::base;
        case TextureFilter::ripmap:
            return TextureLevels::ripmap;
        case TextureFilter::nearest_mip:
        case TextureFilter::bicubic:
        case TextureFilter::trilinear:
        case TextureFilter::anisotropic:
        case TextureFilter::ewa:
            break;
    }
    return TextureLevels::mipmap;
}

TextureFilter filter_for(TextureFilter asked, const prep::Texture& sampler) {
    if (asked != TextureFilter::by_sampler || sampler.mag != sampler.min) return asked;
    const bool linear = sampler.min == prep::Filter::linear;
    switch (sampler.mip) {
        case prep::MipFilter::none:
            return linear ? TextureFilter::bilinear : TextureFilter::nearest;
        case prep::MipFilter::nearest:
            return linear ? TextureFilter::nearest_mip : asked;
        case prep::MipFilter::linear:
            break;
    }
    return linear ? TextureFilter::trilinear : asked;
}

void MipTexture::add_level(std::vector<Level>& to, std::uint32_t width, std::uint32_t height) {
    constexpr std::uint32_t margins = margin_before + margin_behind;
    // Rows of a power of two of bytes are a little longer: a column of texels would otherwise share
    // a few sets of the caches and push itself out.
    const std::uint32_t row = width + margins, pitch = row % 256 == 0 ? row + 8 : row;
    to.push_back(
        {width, height, pitch, texel_count_ + std::size_t(margin_before) * pitch + margin_before});
    texel_count_ += std::size_t(pitch) * (height + margins);
}

MipTexture::MipTexture(const prep::Image& image, const prep::Texture& sampler, bool colour,
                       TextureLevels levels, const glm::vec2& units)
    : lazy_(std::make_unique<Lazy>()), sampler_(sampler), units_(units) {
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
    allocate(fits_packed(image, colour));
    make_first(image, colour);
    view_.level_count = std::uint32_t(levels_.size());
    view_.wrap_u = sampler_.wrap_u;
    view_.wrap_v = sampler_.wrap_v;
    view_.by_lanes = levels_.size() <= TextureView::most_levels &&
                     texel_count_ < (std::size_t(1) << 29);  // four floats each: below 2^31
    for (std::size_t l = 0; view_.by_lanes && l < levels_.size(); ++l) {
        view_.widths[l] = std::int32_t(levels_[l].width);
        view_.heights[l] = std::int32_t(levels_[l].height);
        view_.pitches[l] = std::int32_t(levels_[l].pitch);
        view_.firsts[l] = std::int32_t(levels_[l].first);
    }
    if (view_.by_lanes && !rip_.empty()) list_rips();
}

void MipTexture::list_rips() {
    const std::size_t rows = rip_.size() / rip_columns_;
    for (std::size_t c = 0; c < rip_columns_; ++c) rip_list_.push_back(std::int32_t(rip_[c].width));
    for (std::size_t c = 0; c < rip_columns_; ++c) rip_list_.push_back(std::int32_t(rip_[c].pitch));
    for (std::size_t r = 0; r < rows; ++r)
        rip_list_.push_back(std::int32_t(rip_[r * rip_columns_].height));
    for (const Level& level : rip_) rip_list_.push_back(std::int32_t(level.first));
    view_.rip_columns = std::uint32_t(rip_columns_);
    view_.rip_rows = std::uint32_t(rows);
    view_.rip_widths = rip_list_.data();
    view_.rip_pitches = view_.rip_widths + rip_columns_;
    view_.rip_heights = view_.rip_pitches + rip_columns_;
    view_.rip_firsts = view_.rip_heights + rows;
}

namespace {

// Not initialised: levels that nobody reads shall take no memory.
std::shared_ptr<std::byte> texel_memory(std::size_t bytes) {
    // Neighbours in a column are a row apart: with small pages, each of them is a page of its own,
    // and looking pages up takes longer than reading texels.
    constexpr std::size_t page = prep::detail::large_page;
    const std::size_t unit = bytes < page ? 64 : page;
    void* const memory = std::aligned_alloc(unit, (bytes + unit - 1) / unit * unit);
    if (memory == nullptr) throw std::bad_alloc();
    prep::detail::advise_large_pages(memory, bytes);
    return {static_cast<std::byte*>(memory), [](std::byte* p) { std::free(p); }};
}

}  // namespace

void MipTexture::allocate(bool packed) {
    memory_ = texel_memory(texel_count_ * 4 * (packed ? sizeof(std::int16_t) : sizeof(float)));
    if (packed)
        packed_ = reinterpret_cast<std::int16_t*>(memory_.get());
    else
        floats_ = reinterpret_cast<float*>(memory_.get());
    view_.packed = packed_;
    view_.floats = floats_;
}

std::size_t MipTexture::end_of(const Level& l) const {
    return l.at(-margin_before, std::int64_t(l.height) + margin_behind);
}

void MipTexture::move_to(const std::shared_ptr<std::byte>& pair, bool second) {
    const std::size_t made = end_of(levels_[pyramid_made() - 1]);
    const std::int16_t* const from = packed_;
    view_.step = 2;
    view_.pair = reinterpret_cast<std::int16_t*>(pair.get());
    packed_ = reinterpret_cast<std::int16_t*>(pair.get()) + (second ? 4 : 0);
    view_.packed = packed_;
    for (std::size_t i = 0; i < made; ++i) std::copy_n(from + i * 4, 4, code_at(i));
    memory_ = pair;
}

// Both are there twice while they are put together: not those beyond 4096 x 4096 and its levels.
constexpr std::size_t most_paired_texels = std::size_t(1) << 25;

bool MipTexture::put_together(MipTexture& a, MipTexture& b) {
    const auto alone = [](const MipTexture& t) {
        return t.packed_ != nullptr && t.view_.pair == nullptr && t.rip_.empty();
    };
    if (&a == &b || !alone(a) || !alone(b) || !have_same_texels(a.view_, b.view_)) return false;
    if (a.texel_count_ > most_paired_texels) return false;
    const std::shared_ptr<std::byte> pair =
        texel_memory(a.texel_count_ * 2 * 4 * sizeof(std::int16_t));
    a.move_to(pair, false);
    b.move_to(pair, true);
    return true;
}

bool have_same_texels(const TextureView& a, const TextureView& b) {
    return a.by_lanes && b.by_lanes && a.level_count == b.level_count &&
           a.widths[0] == b.widths[0] && a.heights[0] == b.heights[0] && a.wrap_u == b.wrap_u &&
           a.wrap_v == b.wrap_v;
}

glm::vec4 MipTexture::finished(const glm::vec4& filtered) const {
    return floats_ ? filtered : filtered * unpack_high + filtered * unpack_low;
}

glm::vec4 MipTexture::unmixed(const glm::vec4& mixed) const {
    return floats_ ? mixed : mixed * mixed_scale + mixed_middle;
}

void MipTexture::write(std::size_t index, const glm::vec4& value) const {
    for (std::size_t k = 0; k < 4; ++k) {
        const float v = value[int(k)];
        if (floats_)
            floats_[index * 4 + k] = v;
        else
            code_at(index)[k] = std::int16_t(
                std::int32_t(std::clamp(v + 0.5f, 0.0f, float(texel_scale))) - texel_middle);
    }
}

void MipTexture::copy_texels(std::size_t from, std::size_t to, std::size_t count) const {
    if (floats_)
        std::copy_n(floats_ + from * 4, count * 4, floats_ + to * 4);
    else
        for (std::size_t i = 0; i < count; ++i) std::copy_n(code_at(from + i), 4, code_at(to + i));
}

void MipTexture::clear_texels(std::size_t first, std::size_t count) const {
    for (std::size_t i = 0; i < count; ++i) write(first + i, glm::vec4(0.0f));
}

void MipTexture::make_margins(const Level& l) const {
    const auto fill = [&](std::int64_t extent, prep::Wrap wrap, const auto& index_of,
                          std::size_t count) {
        const auto one = [&](std::int64_t i) {
            const std::int64_t from = wrap_texel(i, extent, wrap);
            if (from < 0)
                clear_texels(index_of(i), count);
            else
                copy_texels(index_of(from), index_of(i), count);
        };
        for (std::int64_t i = -margin_before; i < 0; ++i) one(i);
        for (std::int64_t i = extent; i < extent + margin_behind; ++i) one(i);
    };
    for (std::int64_t y = 0; y < std::int64_t(l.height); ++y)
        fill(
            l.width, sampler_.wrap_u, [&](std::int64_t x) { return l.at(x, y); }, 1);
    fill(
        l.height, sampler_.wrap_v, [&](std::int64_t y) { return l.at(-margin_before, y); },
        l.pitch);
}

void MipTexture::make_first(const prep::Image& image, bool colour) {
    std::array<float, 256> decoded{};  // of 8 bits, times texel_scale
    for (std::size_t i = 0; i < decoded.size(); ++i)
        decoded[i] = std::floor(srgb_to_linear(float(i) / 255.0f) * float(texel_scale) + 0.5f);
    const auto plain = [&](float x) { return packed_ ? float(code_of(x)) : x; };
    const auto decode = [&](float x) {
        if (!colour) return plain(x);
        return packed_ ? decoded[std::size_t(code_of(x)) >> 8] : srgb_to_linear(x);
    };
    for (std::int64_t y = 0; y < std::int64_t(image.height); ++y)
        for (std::int64_t x = 0; x < std::int64_t(image.width); ++x) {
            const float* p = image.at(std::uint32_t(x), std::uint32_t(y));
            const float opaque = packed_ ? float(texel_scale) : 1.0f;
            if (image.channels >= 3)
                write(levels_[0].at(x, y), {decode(p[0]), decode(p[1]), decode(p[2]),
                                            image.channels > 3 ? plain(p[3]) : opaque});
            else
                write(levels_[0].at(x, y), glm::vec4(glm::vec3(decode(p[0])),
                                                     image.channels == 2 ? plain(p[1]) : opaque));
        }
    make_margins(levels_[0]);
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
    make_margins(coarse);
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
    const std::int64_t x =
        wrap_texel(whole_texel(uv.x * float(level.width)), level.width, sampler_.wrap_u);
    const std::int64_t y =
        wrap_texel(whole_texel(uv.y * float(level.height)), level.height, sampler_.wrap_v);
    if (x < 0 || y < 0) return glm::vec4(0.0f);
    return raw(level.at(x, y));
}

// The kernels' operations in their order (filter_texels).
glm::vec4 MipTexture::mixed(const Level& level, const glm::vec2& uv) const {
    const OnAxis x = on_axis(uv.x * float(level.width) - 0.5f, level.width, sampler_.wrap_u);
    const OnAxis y = on_axis(uv.y * float(level.height) - 0.5f, level.height, sampler_.wrap_v);
    const std::size_t top = level.at(x.first, y.first), bottom = top + level.pitch;
    const std::int32_t down = down_steps_of(y.part);
    const auto column = [&](std::size_t i) {
        if (floats_) {
            const Quad a = raw_quad(top + i);
            return a + (raw_quad(bottom + i) - a) * y.part;
        }
        return to_quad(load_codes(code_at(top + i)) * (down - down_steps) -
                       load_codes(code_at(bottom + i)) * down);
    };
    // a + f·(b − a): a constant texture stays bit-constant.
    const Quad left = column(0), right = column(1);
    return to_vec4(left + (right - left) * x.part);
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
