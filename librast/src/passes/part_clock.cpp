#include "passes/part_clock.h"

#include <algorithm>

namespace rast {

std::string_view name_of(DrawingPart part) {
    if (std::size_t(part) < shade_stages) return shade_stage_names[std::size_t(part)];
    switch (part) {
        case DrawingPart::normal_mapping:
            return "normal mapping";
        case DrawingPart::buffers:
            return "buffers";
        case DrawingPart::textures:
            return "reading textures";
        case DrawingPart::levels:
            return "texture levels";
        case DrawingPart::vertices:
            return "vertices";
        case DrawingPart::vertex_light:
            return "light at vertices";
        case DrawingPart::culling:
            return "culling";
        case DrawingPart::clearing:
            return "clearing";
        case DrawingPart::visibility:
            return "visibility";
        case DrawingPart::sorting:
            return "sorting points";
        case DrawingPart::resolving:
            return "resolving samples";
        case DrawingPart::areas:
            return "exact areas";
        case DrawingPart::reducing:
            return "reducing";
        case DrawingPart::passes:
            return "passes";
        case DrawingPart::count:
            break;
    }
    return {};
}

namespace detail {

void PartClock::after_stage(StageWatch& self, const StageList& list, std::size_t stage, float*,
                            std::size_t) {
    auto& clock = static_cast<PartClock&>(self);
    const StageKind kind = list.stages[stage].kind;
    if (list.stages.back().kind == StageKind::attributes)
        clock.lap(DrawingPart::buffers);
    else if (kind == StageKind::normals && list.normal_maps)
        clock.lap(DrawingPart::normal_mapping);
    else
        clock.lap(DrawingPart(kind));
}

void PartClock::tell(double ns_a_reading, PartTimes& times) {
    for (std::size_t p = 0; p < sums_.size(); ++p)
        times[p] +=
            std::max(double(sums_[p].ns) - double(sums_[p].laps) * ns_a_reading, 0.0) * 1e-6;
    sums_ = {};
}

double PartClock::reading() {
    constexpr int readings = 64;
    std::chrono::nanoseconds least = std::chrono::nanoseconds::max();
    Clock::time_point before = Clock::now();
    for (int i = 0; i < readings; ++i) {
        const Clock::time_point now = Clock::now();
        least = std::min(least, std::chrono::duration_cast<std::chrono::nanoseconds>(now - before));
        before = now;
    }
    return double(least.count());
}

void add_times(PartTimes& to, const PartTimes& from) {
    for (std::size_t p = 0; p < to.size(); ++p) {
        const bool shared =
            p == std::size_t(DrawingPart::textures) || p == std::size_t(DrawingPart::levels);
        to[p] = shared ? std::max(to[p], from[p]) : to[p] + from[p];
    }
}

}  // namespace detail
}  // namespace rast
