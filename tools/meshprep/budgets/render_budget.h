// The cheapest anti-aliasing that keeps a picture within an error: `render --image-error`.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "meshprep/output/report_json.h"
#include "rast/render.h"

namespace meshprep {

struct SamplingRung {
    int samples = 1, supersample = 1;
    std::string words() const;  // "--coverage samples --samples 4 --supersample 1"
};

// Cheapest first, by the times of docs/accuracy.md: fixed, so that the choice depends on no clock.
std::vector<SamplingRung> sampling_rungs();

struct SamplingErrors {
    SamplingRung rung;
    double levels = 0;        // RMSE of sRGB-encoded 8-bit values, the worst view's
    double milliseconds = 0;  // to draw what was measured
};

struct ImageCertificate {
    double asked = 0;  // levels
    bool met = false;
    SamplingErrors chosen;               // else the best found
    std::optional<SamplingErrors> next;  // what the next rung would give
    std::vector<SamplingErrors> tried;
    std::uint64_t measured = 0, pixels = 0;  // of all pictures' pixels
    int truth = 0;                           // supersampling that it was held against
    std::string scope() const;
};

// Draws as `plan_for` says (view by view; a request that differs in sampling and crop alone). The
// truth is supersampling by 16 or as much as the picture's size leaves; of pictures over 2^20
// pixels up to 256 evenly spread squares of 64 are measured. `views` is at least 1. Errors: limit
// (a picture that leaves no finer one to compare with), those of planning and drawing.
prep::Result<ImageCertificate> choose_sampling(
    rast::SceneRenderer& renderer, const rast::RenderRequest& request, std::size_t views,
    const std::function<prep::Result<rast::RenderPlan>(const rast::RenderRequest&, std::size_t)>&
        plan_for,
    double levels);

Json to_json(const ImageCertificate& certificate, const std::string& command);

}  // namespace meshprep
