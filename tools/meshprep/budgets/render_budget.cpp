#include "meshprep/budgets/render_budget.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace meshprep {
namespace {

using prep::Result;

constexpr std::uint64_t most_measured = std::uint64_t(1) << 20;
// Of a large picture, how long a side, how many along the shorter side of the picture, and in all.
constexpr std::uint32_t square = 64, squares_across = 16, squares = 256;

// What of the picture is measured: squares that do not overlap.
std::vector<rast::Crop> measured_parts(const rast::RenderRequest& request) {
    const rast::Crop whole = request.crop.value_or(rast::Crop{0, 0, request.width, request.height});
    const std::uint64_t pixels = std::uint64_t(whole.width) * whole.height;
    if (pixels <= most_measured || whole.width < square || whole.height < square) return {whole};
    std::uint32_t columns = whole.width / square, rows = whole.height / square;
    std::uint32_t& fewer = columns < rows ? columns : rows;
    std::uint32_t& more = columns < rows ? rows : columns;
    fewer = std::min(fewer, squares_across);
    more = std::min(more, squares / fewer);
    const auto first = [](std::uint32_t extent, std::uint32_t i, std::uint32_t count) {
        if (count == 1) return (extent - square) / 2;
        return std::uint32_t(std::uint64_t(extent - square) * i / (count - 1));
    };
    std::vector<rast::Crop> parts;
    for (std::uint32_t j = 0; j < rows; ++j)
        for (std::uint32_t i = 0; i < columns; ++i)
            parts.push_back({whole.x + first(whole.width, i, columns),
                             whole.y + first(whole.height, j, rows), square, square});
    return parts;
}

double levels_apart(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
    std::uint64_t squares_sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const int d = int(a[i]) - int(b[i]);
        squares_sum += std::uint64_t(d * d);
    }
    return std::sqrt(double(squares_sum) / double(a.size()));
}

class SamplingSearch {
  public:
    SamplingSearch(rast::SceneRenderer& renderer, const rast::RenderRequest& request,
                   std::size_t views,
                   const std::function<Result<rast::RenderPlan>(const rast::RenderRequest&,
                                                                std::size_t)>& plan_for,
                   int truth)
        : renderer_(renderer),
          request_(request),
          plan_for_(plan_for),
          truth_(truth),
          parts_(measured_parts(request)),
          measured_(views, 0) {
        for (const SamplingRung& rung : sampling_rungs())
            // The truth is no setting to choose: nothing would be known of its error.
            if (rung.supersample * 2 <= truth || rung.supersample == 1)
                errors_.push_back({rung, 0, 0});
    }

    // The error of each rung up to the one after the first that keeps `levels` in every view. One
    // view's pictures are held at a time: where a later view calls for more rungs, the truth of
    // the earlier ones is drawn again.
    Result<void> measure(double levels) {
        bool again = true;
        while (std::exchange(again, false))
            for (std::size_t v = 0; v < measured_.size(); ++v) {
                if (measured_[v] >= wanted(levels)) continue;
                if (const Result<void> done = measure_view(v, levels); !done) return done;
                again = measured_.size() > 1;
            }
        return {};
    }

    // In the order of the rungs; those that were measured.
    std::vector<SamplingErrors> errors(double levels) const {
        return {errors_.begin(), errors_.begin() + std::ptrdiff_t(wanted(levels))};
    }

    std::uint64_t measured_pixels() const {
        std::uint64_t sum = 0;
        for (const rast::Crop& part : parts_) sum += std::uint64_t(part.width) * part.height;
        return sum * measured_.size();
    }

  private:
    // How many rungs every view has to be drawn with, as far as the views so far say.
    std::size_t wanted(double levels) const {
        const std::size_t known = *std::max_element(measured_.begin(), measured_.end());
        std::size_t first = 0;
        while (first < known && errors_[first].levels > levels) ++first;
        return std::min(first + 2, errors_.size());
    }

    Result<void> measure_view(std::size_t view, double levels) {
        const auto truth = drawn({1, truth_}, view);
        if (!truth) return truth.error();
        for (std::size_t& n = measured_[view]; n < wanted(levels); ++n) {
            SamplingErrors& errors = errors_[n];
            const Clock::time_point start = Clock::now();
            const auto picture = drawn(errors.rung, view);
            if (!picture) return picture.error();
            errors.milliseconds += milliseconds_since(start);
            errors.levels = std::max(errors.levels, levels_apart(*picture, *truth));
        }
        return {};
    }

    // 8-bit values as a picture of them has.
    Result<std::vector<std::uint8_t>> drawn(const SamplingRung& rung, std::size_t view) {
        std::vector<std::uint8_t> out;
        rast::RenderRequest request = request_;
        request.coverage = prep::Coverage::samples;
        request.samples = rung.samples;
        request.supersample = rung.supersample;
        request.keep_depth = request.keep_ids = request.keep_normals = request.keep_uvs = false;
        request.keep_barycentrics = request.keep_positions = false;
        for (const rast::Crop& part : parts_) {
            request.crop = part;
            const Result<rast::RenderPlan> plan = plan_for_(request, view);
            if (!plan) return plan.error();
            rast::Frame frame;
            if (const Result<void> done = renderer_.render(*plan, frame); !done)
                return done.error();
            const prep::Image image = rast::to_srgb(frame, plan->request, plan->request.threads);
            for (const float value : image.pixels)
                out.push_back(std::uint8_t(std::clamp(value, 0.0f, 1.0f) * 255.0f + 0.5f));
        }
        return out;
    }

    rast::SceneRenderer& renderer_;
    const rast::RenderRequest& request_;
    const std::function<Result<rast::RenderPlan>(const rast::RenderRequest&, std::size_t)>&
        plan_for_;
    int truth_;
    std::vector<rast::Crop> parts_;
    std::vector<std::size_t> measured_;   // rungs, by view
    std::vector<SamplingErrors> errors_;  // by rung, the worst of the views that have it
};

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
    const std::uint32_t side = std::max(request.width, request.height);
    if (side > rast::max_picture_extent / 2)
        return prep::Error{
            prep::ErrorCode::limit,
            "an error of edges is measured against a picture at least twice as fine, "
            "of at most " +
                std::to_string(rast::max_picture_extent) + " pixels a side; this one has " +
                std::to_string(side),
            ""};
    ImageCertificate out;
    out.truth = std::min(rast::max_supersample, int(rast::max_picture_extent / side));
    SamplingSearch search(renderer, request, views, plan_for, out.truth);
    out.asked = levels;
    out.measured = search.measured_pixels();
    const rast::Crop whole = request.crop.value_or(rast::Crop{0, 0, request.width, request.height});
    out.pixels = std::uint64_t(whole.width) * whole.height * views;
    if (const Result<void> done = search.measure(levels); !done) return done.error();
    for (const SamplingErrors& errors : search.errors(levels)) {
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
