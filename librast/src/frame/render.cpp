#include "rast/render.h"

#include <algorithm>
#include <optional>

#include "base/parallel.h"
#include "frame/supersampled_renderer.h"
#include "plan/memory_estimate.h"
#include "shading/color.h"

namespace rast {
SceneRenderer::SceneRenderer(const prep::PreparedScene& scene)
    : painter_(std::make_unique<detail::Painter>(scene)) {}
SceneRenderer::SceneRenderer(SceneRenderer&&) noexcept = default;
SceneRenderer& SceneRenderer::operator=(SceneRenderer&&) noexcept = default;
SceneRenderer::~SceneRenderer() = default;

prep::Result<void> SceneRenderer::render(const RenderPlan& plan, Frame& frame) {
    // The stages share their threads: each would wait for its own to start.
    prep::detail::with_threads(plan.request.threads, [&](int) {
        painter_->begin(plan);
        const Crop part = detail::picture_part(plan.request);
        painter_->place(part);
        painter_->draw_rows(0, part.height, frame);
    });
    frame.warnings = painter_->warnings();
    return {};
}

std::shared_ptr<const std::vector<TexelFacts>> SceneRenderer::texel_facts(const RenderPlan& plan) {
    const std::vector<TexelQuestions>& asked = plan.texel_questions;
    if (std::none_of(asked.begin(), asked.end(), [](const TexelQuestions& q) { return bool(q); }))
        return nullptr;
    return std::make_shared<const std::vector<TexelFacts>>(painter_->texel_facts(plan));
}

prep::Result<Frame> render(const prep::PreparedScene& scene, const RenderPlan& plan) {
    Frame frame;
    if (auto done = SceneRenderer(scene).render(plan, frame); !done) return done.error();
    return frame;
}

prep::Result<Frame> render_bands(const prep::PreparedScene& scene, const RenderPlan& plan,
                                 const BandSink& take) {
    return SceneRenderer(scene).render_bands(plan, take);
}

prep::Result<Frame> SceneRenderer::render_bands(const RenderPlan& plan, const BandSink& take) {
    painter_->begin(plan);
    const Crop part = detail::picture_part(plan.request);
    Frame all, band;
    all.width = part.width;
    all.height = part.height;
    // Bands of whole tiles share what was sorted by tile; thinner ones do without.
    const std::uint32_t step = std::max(plan.band_rows, 1u);
    const bool share = step % std::uint32_t(detail::tile_size) == 0 || step >= part.height;
    if (share) painter_->place(part);
    for (std::uint32_t row = 0; row < part.height;) {
        const std::uint32_t rows = std::min(step, part.height - row);
        if (!share) painter_->place({part.x, part.y + row, part.width, rows});
        painter_->draw_rows(share ? row : 0, rows, band);
        detail::add_counters(all.counters, band.counters);
        all.geometry_ms += band.geometry_ms;
        all.raster_ms += band.raster_ms;
        detail::add_times(all.part_ms, band.part_ms);
        if (prep::Result<void> taken = take(band, row); !taken) return taken.error();
        row += rows;
    }
    all.warnings = painter_->warnings();
    return all;
}

// Linear. What is behind the scene is not lit, and so not mapped: it is what was asked for wherever
// it is seen.
static glm::vec3 displayed(const glm::vec4& color, const prep::RenderChoices& choices) {
    glm::vec3 shown = glm::vec3(color) * choices.exposure;
    if (choices.tone_map != ToneMap::reinhard) return shown;
    const float share = glm::clamp(color.a, 0.0f, 1.0f);
    const glm::vec3 behind = (1 - share) * choices.background * choices.exposure;
    for (int k = 0; k < 3; ++k) {
        // Of the surfaces in the pixel.
        const float x = share > 0 ? (shown[k] - behind[k]) / share : 0.0f;
        shown[k] = (x > 0 ? x / (1 + x) : x) * share + behind[k];
    }
    return shown;
}

prep::Image to_srgb(const Frame& frame, const prep::RenderChoices& choices, int threads) {
    prep::Image image;
    image.width = frame.width;
    image.height = frame.height;
    image.channels = 3;
    image.srgb = true;
    image.pixels.resize(frame.color.size() * 3);
    constexpr std::size_t grain = 16384;
    prep::detail::parallel_blocks(frame.color.size(), grain, threads,
                                  [&](std::size_t begin, std::size_t end) {
                                      for (std::size_t i = begin; i < end; ++i) {
                                          float* const out = image.pixels.data() + 3 * i;
                                          const glm::vec4& color = frame.color[i];
                                          // What is behind the scene is one color in most pictures.
                                          if (i > begin && color == frame.color[i - 1]) {
                                              std::copy_n(out - 3, 3, out);
                                              continue;
                                          }
                                          const glm::vec3 shown = displayed(color, choices);
                                          for (int k = 0; k < 3; ++k)
                                              out[k] = linear_to_srgb(shown[k]);
                                      }
                                  });
    return image;
}

}  // namespace rast
