// Filters that read more than a mip pyramid's bilinear taps.
#include <algorithm>
#include <array>
#include <cmath>

#include "shading/portable_math.h"
#include "shading/texture.h"

namespace rast {
namespace {

float rest(float x, std::int64_t i) {
    return std::abs(x) < 1e12f ? x - float(i) : 0.0f;
}

// Most texels need no wrapping, which divides.
std::int64_t place(std::int64_t i, std::int64_t size, prep::Wrap wrap) {
    return i >= 0 && i < size ? i : wrap_texel(i, size, wrap);
}

// Keys (1981), a = −½: interpolates, exact for quadratics.
std::array<float, 4> keys_weights(float t) {
    const float t2 = t * t, t3 = t2 * t;
    return {-0.5f * t3 + t2 - 0.5f * t, 1.5f * t3 - 2.5f * t2 + 1.0f,
            -1.5f * t3 + 2.0f * t2 + 0.5f * t, 0.5f * t3 - 0.5f * t2};
}

// The axes of a footprint's ellipse in texels of the first level: singular values and the first
// singular vector of its derivatives. In double: products of float's extremes overflow float. The
// kernels' operations in their order (axes_of).
struct Axes {
    double major = 0, minor = 0;  // lengths
    glm::dvec2 direction{1, 0};   // of the major one
    bool usable = false;
};
Axes axes_of(const Footprint& f, const MipTexture::Level& level) {
    const glm::dvec2 size(level.width, level.height);
    const glm::dvec2 p = glm::dvec2(f.dx) * size, q = glm::dvec2(f.dy) * size;
    const double a = p.x * p.x + q.x * q.x, b = p.x * p.y + q.x * q.y, c = p.y * p.y + q.y * q.y;
    const double half = (a - c) * 0.5, root = std::sqrt(half * half + b * b);
    Axes axes;
    axes.major = std::sqrt((a + c) * 0.5 + root);
    axes.minor = std::abs(p.x * q.y - p.y * q.x) / std::max(axes.major, 1e-30);
    // Cosine of twice the angle; of a circle the axis is along u.
    const double turn = (half + 1e-300) / (root + 1e-300);
    axes.direction = {std::sqrt(std::max(0.5 + turn * 0.5, 0.0)),
                      std::sqrt(std::max(0.5 - turn * 0.5, 0.0)) * (b < 0 ? -1.0 : 1.0)};
    axes.usable = axes.major < 1e15 && axes.minor >= 0;
    return axes;
}

}  // namespace

const float* ellipse_weights() {
    static const std::array<float, weight_entries> table = [] {
        std::array<float, weight_entries> t{};
        for (int i = 0; i < weight_entries; ++i)
            t[std::size_t(i)] =
                float(exp_portable(-2.0 * (i + 0.5) / weight_entries) - exp_portable(-2.0));
        return t;
    }();
    return table.data();
}

glm::vec4 MipTexture::bicubic(const Level& level, const glm::vec2& uv) const {
    const float u = uv.x * float(level.width) - 0.5f, v = uv.y * float(level.height) - 0.5f;
    const std::int64_t x = whole_texel(u), y = whole_texel(v);
    const std::array<float, 4> across = keys_weights(rest(u, x)), down = keys_weights(rest(v, y));
    std::array<std::int64_t, 4> columns, rows;
    for (int i = 0; i < 4; ++i) {
        columns[std::size_t(i)] = place(x + i - 1, level.width, sampler_.wrap_u);
        rows[std::size_t(i)] = place(y + i - 1, level.height, sampler_.wrap_v);
    }
    // Differences to one texel: a constant texture stays bit-constant.
    const Quad base = placed(level, columns[1], rows[1]);
    Quad sum{};
    for (std::size_t j = 0; j < 4; ++j) {
        Quad row{};
        for (std::size_t i = 0; i < 4; ++i)
            row += (placed(level, columns[i], rows[j]) - base) * across[i];
        sum += row * down[j];
    }
    return to_vec4(base + sum);
}

template <class Read>
glm::vec4 MipTexture::between_levels(float lod, const Read& read) const {
    lod = std::min(std::max(lod, 0.0f), float(levels_.size() - 1));
    const std::size_t fine = std::size_t(lod);
    const glm::vec4 a = read(level(std::uint32_t(fine)));
    const float part = lod - float(fine);
    if (part == 0) return a;
    return a + (read(level(std::uint32_t(fine) + 1)) - a) * part;
}

glm::vec4 MipTexture::bicubic(const glm::vec2& uv, const Footprint& footprint) const {
    return between_levels(level_of_detail(footprint),
                          [&](const Level& level) { return bicubic(level, uv); });
}

glm::vec4 MipTexture::trilinear(const glm::vec2& uv, float lod) const {
    return unmixed(between_levels(lod, [&](const Level& level) { return mixed(level, uv); }));
}

glm::vec4 MipTexture::anisotropic(const glm::vec2& uv, const Footprint& footprint, int most) const {
    const Axes axes = axes_of(footprint, levels_[0]);
    if (!axes.usable || !(axes.major > 1))
        return filtered(uv, footprint, TextureFilter::trilinear, most);
    // Rounding shall not make two of one.
    const double ratio = axes.major / std::max(axes.minor, 1e-30) - 1e-6;
    const int probes = int(std::min(std::ceil(ratio), double(std::max(most, 1))));
    const float lod = std::max(0.0f, log2_portable(float(axes.major / probes)));
    const glm::vec2 along(axes.major * axes.direction /
                          glm::dvec2(levels_[0].width, levels_[0].height));
    glm::vec4 first(0.0f), sum(0.0f);
    for (int i = 0; i < probes; ++i) {
        const glm::vec2 at = uv + along * ((float(i) + 0.5f) / float(probes) - 0.5f);
        const glm::vec4 probe =
            between_levels(lod, [&](const Level& level) { return mixed(level, at); });
        if (i == 0) first = probe;
        sum += probe - first;
    }
    return unmixed(first + sum / float(probes));
}

// The kernels' operations in their order (read_ellipses).
glm::vec4 MipTexture::ellipse(const Level& level, const glm::vec2& uv, const glm::vec2& major,
                              const glm::vec2& minor, int most) const {
    // Axes in texels of this level; one texel more in each direction keeps the ellipse from
    // falling between texels (Heckbert 1989, section 3.5.8).
    const float width = float(level.width), height = float(level.height);
    const glm::vec2 scale(width / float(levels_[0].width), height / float(levels_[0].height));
    // On levels of half the size each the narrow axis is below two texels, and the long one below
    // `most` times that. Along an axis that is down to a single texel they would grow without end.
    const glm::vec2 longest(float(std::max(most, 1)) * 2 + 1);  // 1: far above rounding
    const glm::vec2 p = glm::clamp(major * scale, -longest, longest);
    const glm::vec2 q = glm::clamp(minor * scale, -longest, longest);
    const float area = p.x * q.y - p.y * q.x;
    const float a = (p.y * p.y + q.y * q.y) + 1, c = (p.x * p.x + q.x * q.x) + 1;
    const float reach = std::sqrt(a);
    const float inverse = 1 / (area * area + ((a + c) - 1));
    const float A = a * inverse, B = -2 * (p.x * p.y + q.x * q.y) * inverse, C = c * inverse;
    const float per = 0.5f / A;
    // From the texel in the middle.
    const float u = uv.x * width - 0.5f, v = uv.y * height - 0.5f;
    const std::int64_t middle_x = whole_texel(u + 0.5f), middle_y = whole_texel(v + 0.5f);
    const float from_x = rest(u, middle_x), from_y = rest(v, middle_y);
    const float* const weights = ellipse_weights();
    const Quad base = placed(level, place(middle_x, level.width, sampler_.wrap_u),
                             place(middle_y, level.height, sampler_.wrap_v));
    Quad sum{};
    float total = 0;
    const int bottom = int(std::floor(from_y + reach));
    for (int y = int(std::ceil(from_y - reach)); y <= bottom; ++y) {
        const float dy = float(y) - from_y;
        // The row's part of the ellipse: A x² + B x y + C y² < 1.
        const float shift = B * dy, above = C * dy * dy;
        const float root = shift * shift - 4 * A * (above - 1);
        if (!(root > 0)) continue;
        const std::int64_t row = place(middle_y + y, level.height, sampler_.wrap_v);
        const float middle = from_x - shift * per, half = std::sqrt(root) * per;
        const int right = int(std::floor(middle + half));
        for (int x = int(std::ceil(middle - half)); x <= right; ++x) {
            const float dx = float(x) - from_x;
            const float r2 = (A * dx * dx + shift * dx) + above;
            if (!(r2 < 1)) continue;
            const float w = weights[int(std::max(r2, 0.0f) * float(weight_entries))];
            sum +=
                (placed(level, place(middle_x + x, level.width, sampler_.wrap_u), row) - base) * w;
            total += w;
        }
    }
    return to_vec4(base + sum / total);  // the middle is half a texel from the centre at most
}

glm::vec4 MipTexture::ewa(const glm::vec2& uv, const Footprint& footprint, int most) const {
    const Axes axes = axes_of(footprint, levels_[0]);
    if (!axes.usable || !(axes.major > 1))
        return filtered(uv, footprint, TextureFilter::trilinear, most);
    // The narrow axis is widened where the ellipse would be longer than is paid for.
    const float length = float(axes.major);
    const float narrow = std::max(float(axes.minor), length / float(std::max(most, 1)));
    const glm::vec2 direction(axes.direction);
    const glm::vec2 major = direction * length;
    const glm::vec2 minor = glm::vec2(-direction.y, direction.x) * narrow;
    const float lod = std::max(0.0f, log2_portable(narrow));
    // On the last level an ellipse would have no largest size.
    if (!(lod < float(levels_.size() - 1))) return bilinear(level(level_count() - 1), uv);
    return between_levels(
        lod, [&](const Level& level) { return ellipse(level, uv, major, minor, most); });
}

glm::vec4 MipTexture::ripmap(const glm::vec2& uv, const Footprint& f) const {
    const auto lod = [](float right, float down, std::uint32_t size, std::size_t levels) {
        const float longest = std::max(std::abs(right), std::abs(down)) * float(size);
        if (!(longest > 1)) return 0.0f;
        if (!(longest < 1e15f)) return float(levels - 1);
        return std::min(log2_portable(longest), float(levels - 1));
    };
    const float lu = lod(f.dx.x, f.dy.x, levels_[0].width, rip_columns_);
    const float lv = lod(f.dx.y, f.dy.y, levels_[0].height, rip_.size() / rip_columns_);
    const std::size_t cu = std::size_t(lu), cv = std::size_t(lv);
    const float pu = lu - float(cu), pv = lv - float(cv);
    const auto read = [&](std::size_t column, std::size_t row) {
        return mixed(rip_level(row * rip_columns_ + column), uv);
    };
    const auto across = [&](std::size_t row) {
        const glm::vec4 a = read(cu, row);
        return pu == 0 ? a : a + (read(cu + 1, row) - a) * pu;
    };
    const glm::vec4 a = across(cv);
    return unmixed(pv == 0 ? a : a + (across(cv + 1) - a) * pv);
}

std::uint32_t MipTexture::nearest_level(float lod) const {
    lod = std::min(std::max(lod, 0.0f), float(levels_.size() - 1));
    const std::uint32_t fine = std::uint32_t(lod);
    return lod - float(fine) > 0.5f ? fine + 1 : fine;
}

glm::vec4 MipTexture::by_sampler(const glm::vec2& uv, const Footprint& footprint) const {
    const float lod = level_of_detail(footprint);
    const bool smooth = (lod > 0 ? sampler_.min : sampler_.mag) == prep::Filter::linear;
    const auto read = [&](const Level& level) {
        return smooth ? bilinear(level, uv) : nearest(level, uv);
    };
    switch (sampler_.mip) {
        case prep::MipFilter::none:
            break;
        case prep::MipFilter::nearest:
            return read(level(nearest_level(lod)));
        case prep::MipFilter::linear:
            return between_levels(lod, read);
    }
    return read(levels_[0]);
}

glm::vec4 MipTexture::sample(const glm::vec2& uv, const Footprint& footprint, TextureFilter filter,
                             int most) const {
    return finished(filtered(uv, footprint, filter, most));
}

glm::vec4 MipTexture::filtered(const glm::vec2& uv, const Footprint& footprint,
                               TextureFilter filter, int most) const {
    filter = filter_for(filter);
    if (filter == TextureFilter::by_sampler) return by_sampler(uv, footprint);
    if (filter == TextureFilter::nearest) return nearest(levels_[0], uv);
    if (filter == TextureFilter::ripmap && !rip_.empty()) return ripmap(uv, footprint);
    if (filter == TextureFilter::bicubic) return bicubic(uv, footprint);
    if (filter == TextureFilter::bilinear || levels_.size() == 1) return bilinear(levels_[0], uv);
    if (filter == TextureFilter::nearest_mip)
        return bilinear(level(nearest_level(level_of_detail(footprint))), uv);
    if (filter == TextureFilter::anisotropic) return anisotropic(uv, footprint, most);
    if (filter == TextureFilter::ewa) return ewa(uv, footprint, most);
    return trilinear(uv, level_of_detail(footprint));
}

}  // namespace rast
