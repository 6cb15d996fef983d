#include "texture.h"

#include <algorithm>
#include <cmath>

#include "color.h"
#include "elementary.h"

namespace rast {
namespace {

MipTexture::Level base_level(const prep::Image& image, bool colour) {
    MipTexture::Level level(image.width, image.height);
    level.allocate();
    // 8-bit files have 256 values: the table saves a pow per channel and changes no bit.
    float table[256];
    for (int i = 0; i < 256; ++i) table[i] = srgb_to_linear(float(i) / 255.0f);
    const auto decode = [&](float x) {
        if (!colour) return x;
        if (!(x >= 0 && x <= 1)) return srgb_to_linear(x);
        const int i = int(x * 255.0f + 0.5f);
        return float(i) / 255.0f == x ? table[i] : srgb_to_linear(x);
    };
    for (std::size_t i = 0; i < std::size_t(image.width) * image.height; ++i) {
        const float* p = image.pixels.data() + i * image.channels;
        glm::vec4& t = level.texels[level.at(i % image.width, i / image.width)];
        if (image.channels >= 3)
            t = {decode(p[0]), decode(p[1]), decode(p[2]), image.channels > 3 ? p[3] : 1.0f};
        else
            t = glm::vec4(glm::vec3(decode(p[0])), image.channels == 2 ? p[1] : 1.0f);
    }
    return level;
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

// Half the texels along the axes that are asked for.
MipTexture::Level next_level(const MipTexture::Level& fine, bool halve_x, bool halve_y) {
    MipTexture::Level coarse(halve_x ? std::max(1u, fine.width / 2) : fine.width,
                             halve_y ? std::max(1u, fine.height / 2) : fine.height);
    if (fine.texels.empty()) return coarse;  // its size is asked for
    coarse.allocate();
    const std::vector<Tap> across = taps(fine.width, coarse.width);
    const std::vector<Tap> down = taps(fine.height, coarse.height);
    for (std::uint32_t y = 0; y < coarse.height; ++y)
        for (std::uint32_t x = 0; x < coarse.width; ++x) {
            glm::vec4 sum(0.0f);
            for (std::uint32_t j = 0; j < down[y].count; ++j)
                for (std::uint32_t i = 0; i < across[x].count; ++i)
                    sum += fine.texels[fine.at(across[x].first + i, down[y].first + j)] *
                           (down[y].weight[j] * across[x].weight[i]);
            coarse.texels[coarse.at(x, y)] = sum;
        }
    return coarse;
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

MipTexture::MipTexture(const prep::Image& image, const prep::Texture& sampler, bool colour,
                       TextureLevels levels)
    : lazy_(std::make_unique<Lazy>()), wrap_u_(sampler.wrap_u), wrap_v_(sampler.wrap_v) {
    const Level sizes(image.width, image.height);
    levels_.push_back(sizes);
    if (levels == TextureLevels::mipmap)
        while (levels_.back().width > 1 || levels_.back().height > 1)
            levels_.push_back(next_level(levels_.back(), true, true));
    if (levels == TextureLevels::ripmap) {
        rip_.push_back(sizes);
        while (rip_.back().width > 1) rip_.push_back(next_level(rip_.back(), true, false));
        rip_columns_ = rip_.size();
        for (std::size_t above = 0; rip_[above].height > 1; above += rip_columns_)
            for (std::size_t c = 0; c < rip_columns_; ++c)
                rip_.push_back(next_level(rip_[above + c], false, true));
        lazy_->rip = std::vector<std::atomic<bool>>(rip_.size());
    }
    levels_[0] = base_level(image, colour);
    view_.level_count = std::uint32_t(levels_.size());
    const auto by_lanes = [](prep::Wrap wrap, std::uint32_t size) {
        return wrap == prep::Wrap::clamp ||
               (wrap != prep::Wrap::border && (size & (size - 1)) == 0);
    };
    view_.by_lanes = levels_.size() <= TextureView::most_levels &&
                     by_lanes(wrap_u_, levels_[0].width) && by_lanes(wrap_v_, levels_[0].height);
    view_.u.wrap = wrap_u_;
    view_.v.wrap = wrap_v_;
    for (std::size_t l = 0; view_.by_lanes && l < levels_.size(); ++l) {
        view_.widths[l] = std::int32_t(levels_[l].width);
        view_.pitches[l] = std::int32_t(levels_[l].pitch);
        view_.heights[l] = std::int32_t(levels_[l].height);
    }
    view_.texels[0] = &levels_[0].texels[0].x;
}

void MipTexture::make_pyramid(std::uint32_t last) const {
    const std::lock_guard lock(lazy_->mutex);
    for (std::uint32_t l = lazy_->pyramid; l <= last && l < levels_.size(); ++l) {
        levels_[l] = next_level(levels_[l - 1], true, true);
        if (l < TextureView::most_levels) view_.texels[l] = &levels_[l].texels[0].x;
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
    rip_[index] = next_level(from == 0 ? levels_[0] : rip_[from], first_row, !first_row);
    lazy_->rip[index].store(true, std::memory_order_release);
}

const MipTexture::Level& MipTexture::rip_level(std::size_t index) const {
    make_rip(index);
    return index == 0 ? levels_[0] : rip_[index];
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
    return level.texels[level.at(std::size_t(x), std::size_t(y))];
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
        return i < 0 || j < 0 ? glm::vec4(0.0f)
                              : level.texels[level.at(std::size_t(i), std::size_t(j))];
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
