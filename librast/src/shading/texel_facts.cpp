// What a texture's texels are like.
#include <algorithm>
#include <atomic>
#include <cmath>

#include "base/parallel.h"
#include "shading/texture.h"

namespace rast {
namespace {

// As bits: what is still open.
constexpr std::uint32_t constant_bit = 1, not_negative_bit = 2, alpha_bit = 4, all_bits = 7;

std::uint32_t bits_of(const TexelQuestions& asked) {
    return (asked.constant ? constant_bit : 0) | (asked.not_negative ? not_negative_bit : 0) |
           (asked.alpha ? alpha_bit : 0);
}

// The questions that a texel answers with no.
std::uint32_t denied_by(const glm::vec4& texel, const glm::vec4& first,
                        const TexelQuestions& asked) {
    for (int k = 0; k < 4; ++k)
        if (!std::isfinite(texel[k])) return all_bits;
    std::uint32_t denied = 0;
    if (texel != first || texel.z != 1) denied |= constant_bit;
    if (!(texel.x >= 0 && texel.y >= 0 && texel.z >= 0)) denied |= not_negative_bit;
    if (!(texel.a >= asked.least_alpha)) denied |= alpha_bit;
    return denied;
}

}  // namespace

TexelFacts MipTexture::facts(const TexelQuestions& asked, int threads) const {
    // Packed texels are 0 to 1, whatever they are.
    TexelFacts coarse;
    coarse.known = !floats_;
    coarse.high = glm::vec4(1.0f);
    std::uint32_t questions = bits_of(asked);
    if (!floats_) questions &= ~not_negative_bit;
    if (questions == 0) return coarse;

    const bool border =
        sampler_.wrap_u == prep::Wrap::border || sampler_.wrap_v == prep::Wrap::border;
    const glm::vec4 first = border ? glm::vec4(0.0f) : texel(levels_[0], 0, 0);
    TexelFacts facts;
    facts.known = true;
    facts.low = facts.high = first;
    std::atomic<std::uint32_t> open{questions & ~denied_by(first, first, asked)};
    const auto look_at = [&](const Level& level) {
        constexpr std::uint32_t texels_a_block = 1u << 14;
        const std::uint32_t rows = std::max(texels_a_block / level.width, 1u);
        std::vector<std::pair<glm::vec4, glm::vec4>> blocks((level.height + rows - 1) / rows,
                                                            {first, first});
        prep::detail::parallel_tasks(blocks.size(), threads, [&](std::size_t b) {
            auto [low, high] = blocks[b];
            const auto begin = std::uint32_t(b) * rows;
            for (std::uint32_t y = begin; y < std::min(begin + rows, level.height); ++y) {
                if (open.load(std::memory_order_relaxed) == 0) return;
                std::uint32_t denied = 0;
                for (std::uint32_t x = 0; x < level.width; ++x) {
                    const glm::vec4 t = texel(level, x, y);
                    denied |= denied_by(t, first, asked);
                    low = glm::min(low, t);
                    high = glm::max(high, t);
                }
                if (denied != 0) open.fetch_and(~denied, std::memory_order_relaxed);
            }
            blocks[b] = {low, high};
        });
        for (const auto& [low, high] : blocks) {
            facts.low = glm::min(facts.low, low);
            facts.high = glm::max(facts.high, high);
        }
    };
    if (open != 0) look_at(levels_[0]);
    // Means of equal texels are rounded: they need not be that texel.
    if ((open & constant_bit) != 0) {
        make_all_levels();
        for (const Level& level : levels_) look_at(level);
        for (const Level& level : rip_) look_at(level);
    }
    if (open == 0) return coarse;  // whichever texels were looked at by then
    facts.constant = (open & constant_bit) != 0;
    return facts;
}

}  // namespace rast
