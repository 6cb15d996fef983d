#include "meshprep/budgets/render_budget.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace meshprep {
namespace {

using prep::Result;

constexpr std::uint64_t most_measured = std::uint64_t(1) << 20;
constexpr std::uint32_t square = 64, squares = 16;  // of a large picture, and how many a side

// What of the picture is measured.
std::vector<rast::Crop> measured_parts(const rast::RenderRequest& request) {
    const rast::Crop whole = request.crop.value_or(rast::Crop{0, 0, request.width, request.height});
    const std::uint64_t pixels = std::uint64_t(whole.width) * whole.height;
    if (pixels <= most_measured || whole.width < square || whole.height < square) return {whole};
    std::vector<rast::Crop> parts;
    for (std::uint32_t j = 0; j < squares; ++j)
        for (std::uint32_t i = 0; i < squares; ++i)
            parts.push_back(
                {whole.x + std::uint32_t(std::uint64_t(whole.width - square) * i / (squares - 1)),
                 whole.y + std::uint32_t(std::uint64_t(whole.height - square) * j / (squares - 1)),
                 square, square});
    return parts;
}

class SamplingSearch {
  public:
    SamplingSearch(rast::SceneRenderer& renderer, const rast::RenderRequest& request,
                   std::size_t views,
                   const std::function<Result<rast::RenderPlan>(const rast::RenderRequest&,
                                                                std::size_t)>& plan_for)
        : renderer_(renderer),
          request_(request),
          views_(views),
          plan_for_(plan_for),
          parts_(measured_parts(request)) {}

    // 8-bit values as a picture of them has, view after view.
    Result<std::vector<std::vector<std::uint8_t>>> drawn(const SamplingRung& rung, double* ms) {
        std::vector<std::vector<std::uint8_t>> out(views_);
        rast::RenderRequest request = request_;
        request.coverage = prep::Coverage::samples;
        request.samples = rung.samples;
        request.supersample = rung.supersample;
        request.keep_depth = request.keep_ids = request.keep_normals = request.keep_uvs = false;
        request.keep_barycentrics = request.keep_positions = false;
        const Clock::time_point start = Clock::now();
        for (std::size_t v = 0; v < views_; ++v)
            for (const rast::Crop& part : parts_) {
                request.crop = part;
                const Result<rast::RenderPlan> plan = plan_for_(request, v);
                if (!plan) return plan.error();
                rast::Frame frame;
                if (const Result<void> done = renderer_.render(*plan, frame); !done)
                    return done.error();
                const prep::Image image =
                    rast::to_srgb(frame, plan->request, plan->request.threads);
                for (const float value : image.pixels)
                    out[v].push_back(std::uint8_t(std::clamp(value, 0.0f, 1.0f) * 255.0f + 0.5f));
            }
        if (ms != nullptr) *ms = milliseconds_since(start);
        return out;
    }

    std::uint64_t measured() const {
        std::uint64_t sum = 0;
        for (const rast::Crop& part : parts_) sum += std::uint64_t(part.width) * part.height;
        return sum * views_;
    }

  private:
    rast::SceneRenderer& renderer_;
    const rast::RenderRequest& request_;
    std::size_t views_;
    const std::function<Result<rast::RenderPlan>(const rast::RenderRequest&, std::size_t)>&
        plan_for_;
    std::vector<rast::Crop> parts_;
};

double levels_apart(const std::vector<std::vector<std::uint8_t>>& a,
                    const std::vector<std::vector<std::uint8_t>>& b) {
    double worst = 0;
    for (std::size_t v = 0; v < a.size(); ++v) {
        std::uint64_t squares_sum = 0;
        for (std::size_t i = 0; i < a[v].size(); ++i) {
            const int d = int(a[v][i]) - int(b[v][i]);
            squares_sum += std::uint64_t(d * d);
        }
        worst = std::max(worst, std::sqrt(double(squares_sum) / double(a[v].size())));
    }
    return worst;
}

Json errors_json(const SamplingErrors& e) {
    return {{"setting", e.rung.words()}, {"levels", e.levels}, {"milliseconds", e.milliseconds}};
}

}  // namespace

std::string SamplingRung::words() const {
    return fmt::format("--coverage samples --samples {} --supersample {}", samples, supersample);
}

std::vector<SamplingRung> sampling_rungs() {
    return {{1, 1}, {2, 1}, {1, 2}, {4, 1}, {1, 3}, {8, 1}, {1, 4}, {16, 1}, {1, 6}, {1, 8}};
}

std::string ImageCertificate::scope() const {
    return fmt::format("measured on {}{} pixels, against {} shaded points a pixel",
                       measured == pixels ? "all " : "",
                       measured == pixels ? with_commas(pixels)
                                          : with_commas(measured) + " of " + with_commas(pixels),
                       truth * truth);
}

Result<ImageCertificate> choose_sampling(
    rast::SceneRenderer& renderer, const rast::RenderRequest& request, std::size_t views,
    const std::function<Result<rast::RenderPlan>(const rast::RenderRequest&, std::size_t)>&
        plan_for,
    double levels) {
    SamplingSearch search(renderer, request, views, plan_for);
    ImageCertificate out;
    out.asked = levels;
    out.measured = search.measured();
    const rast::Crop whole = request.crop.value_or(rast::Crop{0, 0, request.width, request.height});
    out.pixels = std::uint64_t(whole.width) * whole.height * views;
    const int most = int(rast::max_picture_extent / std::max(request.width, request.height));
    out.truth = std::min(rast::max_supersample, most);
    const auto truth = search.drawn({1, out.truth}, nullptr);
    if (!truth) return truth.error();
    for (const SamplingRung& rung : sampling_rungs()) {
        // The truth is no setting to choose: nothing would be known of its error.
        if (rung.supersample * 2 > out.truth && rung.supersample > 1) continue;
        SamplingErrors errors{rung, 0, 0};
        const auto picture = search.drawn(rung, &errors.milliseconds);
        if (!picture) return picture.error();
        errors.levels = levels_apart(*picture, *truth);
        if (out.met) {
            out.next = errors;
            break;
        }
        if (out.tried.empty() || errors.levels < out.chosen.levels) out.chosen = errors;
        out.tried.push_back(errors);
        if (errors.levels <= levels) {
            out.met = true;
            out.chosen = errors;
        }
    }
    return out;
}

Json to_json(const ImageCertificate& c, const std::string& command) {
    Json json;
    json["asked"] = c.asked;
    json["achieved"] = c.chosen.levels;
    json["unit"] = "levels of 8 bits, RMSE";
    json["met"] = c.met;
    json["scope"] = c.scope();
    json["measured"] = c.measured;
    json["pixels"] = c.pixels;
    json["truth_supersample"] = c.truth;
    json["chosen"] = errors_json(c.chosen);
    json["next"] = c.next ? errors_json(*c.next) : Json(nullptr);
    json["tried"] = Json::array();
    for (const SamplingErrors& e : c.tried) json["tried"].push_back(errors_json(e));
    json["command"] = command;
    return json;
}

}  // namespace meshprep
