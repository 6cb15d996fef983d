#include "meshprep/output/step_costs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "meshprep/output/console.h"
#include "rast/view.h"

namespace meshprep {
namespace {

using rast::Counters;
using Kind = rast::PlanStepKind;

// Prices: nanoseconds each, one thread, as bench/step_prices prints
// them; 0: none.
struct CountedStep {
    Kind step;
    std::uint64_t Counters::*count;
    const char* of;
    double price;
};
constexpr CountedStep counted_steps[] = {
    {Kind::lights, &Counters::light_points, "points by lights", 0.17},
    {Kind::highlights, &Counters::highlight_points, "points by lights", 0.8},
    {Kind::normal_maps, &Counters::normal_map_points, "points", 0.6},
    {Kind::vertex_lighting, &Counters::vertices_lit, "vertices", 9.0},
    {Kind::textures, &Counters::texture_samples, "samples", 3.8},
    {Kind::shading, &Counters::pixels_shaded, "points", 4.4},
    {Kind::multisampling, &Counters::sample_points, "samples", 1.2},
    {Kind::alpha_mask, &Counters::masked_triangles, "triangles in tiles", 0},
    {Kind::culling, &Counters::facing_away, "triangles left out", 0},
};

struct KeptBuffer {
    Kind step;
    std::uint64_t bytes;  // a pixel
};
constexpr KeptBuffer kept_buffers[] = {
    {Kind::depth_output, 4}, {Kind::triangle_numbers_output, 8}, {Kind::normal_output, 12},
    {Kind::uv_output, 8},    {Kind::barycentric_output, 12},     {Kind::position_output, 12}};

StepCost priced(const CountedStep& row, std::uint64_t count) {
    StepCost cost{count, row.of, 0, {}};
    if (row.price > 0) cost.milliseconds = double(count) * row.price * 1e-6;
    return cost;
}

std::uint64_t pixels_of(const rast::RenderRequest& r) {
    return r.crop ? std::uint64_t(r.crop->width) * r.crop->height
                  : std::uint64_t(r.width) * r.height;
}

std::optional<StepCost> buffer_of(const rast::PlanStep& step, const rast::RenderPlan& plan) {
    const std::uint64_t pixels = pixels_of(plan.request);
    for (const KeptBuffer& row : kept_buffers)
        if (step.kind == row.step && step.run)
            return StepCost{pixels, "pixels", pixels * row.bytes, {}};
    return std::nullopt;
}

// Light at vertices has a row of its own, highlights and all.
bool is_counted_elsewhere(const rast::PlanStep& step, const rast::RenderPlan& plan) {
    return step.run && plan.request.shading == rast::Shading::gouraud &&
           (step.kind == Kind::lights || step.kind == Kind::highlights);
}

using rast::DrawingPart;

// Parts of drawing that are a step's, as bits.
constexpr std::uint32_t bit_of(DrawingPart part) {
    return 1u << unsigned(part);
}
// A name that is no stage's does not compile.
consteval std::uint32_t bit_of(std::string_view stage) {
    for (std::size_t k = 0; k < rast::shade_stages; ++k)
        if (rast::shade_stage_names[k] == stage) return 1u << k;
    throw "no such stage";
}
static_assert(rast::drawing_parts <= 32);

struct TimedStep {
    Kind step;
    std::uint32_t parts;
    bool at_points;  // of several steps at a point, which exact areas run as one
};
constexpr TimedStep timed_steps[] = {
    {Kind::camera, bit_of(DrawingPart::vertices), false},
    {Kind::lights, bit_of("light") | bit_of("light without highlights"), true},
    {Kind::highlights, bit_of("eye") | bit_of("exponents") | bit_of("highlights"), true},
    {Kind::normal_maps, bit_of(DrawingPart::normal_mapping), true},
    {Kind::vertex_lighting, bit_of(DrawingPart::vertex_light), false},
    {Kind::vertex_normals, bit_of("normals"), true},
    {Kind::textures, bit_of(DrawingPart::textures), false},
    {Kind::srgb_decoding, bit_of(DrawingPart::levels), false},
    {Kind::texture_filter, bit_of("maps"), true},
    // The first level with the decoding, others when a point first asks for them.
    {Kind::mip_levels, bit_of(DrawingPart::levels) | bit_of("maps"), false},
    {Kind::ripmap_levels, bit_of(DrawingPart::levels) | bit_of("maps"), false},
    {Kind::shading, bit_of("interpolation") | bit_of("color") | bit_of(DrawingPart::sorting), true},
    {Kind::multisampling, bit_of(DrawingPart::resolving), false},
    {Kind::exact_areas, bit_of(DrawingPart::areas), false},
    {Kind::supersampling, bit_of(DrawingPart::reducing), false},
    {Kind::depth_test, bit_of(DrawingPart::visibility), false},
    {Kind::culling, bit_of(DrawingPart::culling), false},
    {Kind::alpha_mask, bit_of(DrawingPart::visibility), false},
    {Kind::depth_output, bit_of(DrawingPart::buffers), false},
    {Kind::triangle_numbers_output, bit_of(DrawingPart::buffers), false},
    {Kind::normal_output, bit_of(DrawingPart::buffers), false},
    {Kind::uv_output, bit_of(DrawingPart::buffers), false},
    {Kind::barycentric_output, bit_of(DrawingPart::buffers), false},
    {Kind::position_output, bit_of(DrawingPart::buffers), false},
};

std::uint32_t parts_of(const rast::PlanStep& step, const rast::RenderPlan& plan) {
    if (!step.run) return 0;
    if (is_counted_elsewhere(step, plan)) return bit_of(DrawingPart::vertex_light);
    for (const TimedStep& row : timed_steps) {
        if (step.kind != row.step) continue;
        const bool areas = plan.request.coverage == rast::Coverage::area;
        return areas && row.at_points ? bit_of(DrawingPart::areas) : row.parts;
    }
    return 0;
}

// How many of a step's things there are at each shaded point, in the mean over the triangles.
double things_a_point(Kind step, const rast::RenderPlan& plan) {
    double lights = 0;
    for (std::size_t l = 0; l < plan.lights.size(); ++l)
        lights += plan.lights[l].kind != prep::LightKind::ambient && !plan.skips.light(l);
    double sum = 0, triangles = 0;
    for (const rast::PlanVariant& v : plan.variants) {
        const double things = step == Kind::lights        ? v.lit * lights
                              : step == Kind::highlights  ? v.highlights * lights
                              : step == Kind::normal_maps ? v.bends_normals
                              : step == Kind::textures    ? v.maps
                                                          : 1;
        sum += double(v.triangles) * things;
        triangles += double(v.triangles);
    }
    return triangles > 0 ? sum / triangles : 0;
}

}  // namespace

std::optional<StepCost> cost_of(const rast::PlanStep& step, const rast::RenderPlan& plan,
                                const Counters& counters) {
    for (const CountedStep& row : counted_steps) {
        if (step.kind != row.step) continue;
        // One sample a pixel is none beside the points that are shaded.
        if (!step.run && step.kind == Kind::multisampling) return std::nullopt;
        if (is_counted_elsewhere(step, plan)) return std::nullopt;
        StepCost cost = priced(row, counters.*row.count);
        if (step.kind == Kind::culling) cost.bytes = counters.list_bytes;
        return cost;
    }
    return buffer_of(step, plan);
}

std::optional<StepCost> estimate_of(const rast::PlanStep& step, const rast::RenderPlan& plan,
                                    std::uint64_t points) {
    if (!step.run || is_counted_elsewhere(step, plan)) return std::nullopt;
    for (const CountedStep& row : counted_steps) {
        if (step.kind != row.step || row.price == 0) continue;
        if (step.kind == Kind::vertex_lighting) return priced(row, plan.vertices);
        const double things = step.kind == Kind::multisampling ? plan.request.samples
                                                               : things_a_point(step.kind, plan);
        return priced(row, std::uint64_t(std::llround(double(points) * things)));
    }
    return buffer_of(step, plan);
}

std::uint64_t expected_points(const prep::PreparedScene& scene, const rast::RenderPlan& plan) {
    const rast::RenderRequest& r = plan.request;
    const std::optional<rast::Bounds> box = rast::world_bounds(scene);
    if (!box) return 0;
    const std::uint64_t factor = std::uint64_t(r.supersample) * std::uint64_t(r.supersample);
    const std::uint64_t all = pixels_of(r) * factor;
    const rast::View& view = plan.view;
    const double half_height = view.perspective ? std::tan(view.yfov / 2) : view.half_height;
    glm::dvec2 low(HUGE_VAL), high(-HUGE_VAL);
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 at((corner & 1) != 0 ? box->high.x : box->low.x,
                            (corner & 2) != 0 ? box->high.y : box->low.y,
                            (corner & 4) != 0 ? box->high.z : box->low.z);
        const glm::dvec3 seen(view.world_to_view * glm::dvec4(at, 1.0));
        if (view.perspective && !(-seen.z > view.znear)) return all;  // the eye may be in the box
        const double size = half_height * (view.perspective ? -seen.z : 1.0);
        const glm::dvec2 place((seen.x / (size * view.aspect) + 1) / 2 * r.width,
                               (1 - seen.y / size) / 2 * r.height);
        low = glm::min(low, place);
        high = glm::max(high, place);
    }
    glm::dvec2 first(0), end(r.width, r.height);
    if (r.crop) {
        first = {r.crop->x, r.crop->y};
        end = first + glm::dvec2(r.crop->width, r.crop->height);
    }
    const glm::dvec2 part = glm::max(glm::min(high, end) - glm::max(low, first), glm::dvec2(0));
    const double pixels = part.x * part.y;
    return std::isfinite(pixels) ? std::uint64_t(std::llround(pixels * double(factor))) : all;
}

std::optional<MeasuredStep> time_of(const rast::PlanStep& step, const rast::RenderPlan& plan,
                                    const rast::Frame& drawn) {
    const std::uint32_t parts = parts_of(step, plan);
    if (parts == 0) return std::nullopt;
    MeasuredStep out;
    for (std::size_t p = 0; p < rast::drawing_parts; ++p) {
        if ((parts >> p & 1u) == 0) continue;
        out.parts.push_back(DrawingPart(p));
        out.milliseconds += drawn.part_ms[p];
    }
    for (const rast::PlanStep& other : plan.steps)
        if (other.kind != step.kind && (parts_of(other, plan) & parts) != 0)
            out.with.emplace_back(prep::name_of(other.kind));
    return out;
}

std::string text_of(const std::optional<StepCost>& cost, const std::optional<StepCost>& estimate,
                    const std::optional<MeasuredStep>& measured) {
    std::string text;
    if (cost) {
        text = fmt::format("{} {}", with_commas(cost->count), cost->of);
        if (cost->bytes > 0) text += ", " + byte_size(cost->bytes);
        if (cost->milliseconds && cost->count > 0)
            text += ", about " + duration(*cost->milliseconds);
        if (cost->bytes == 0 && estimate)
            text += fmt::format("; expected {}", with_commas(estimate->count));
    }
    if (!measured) return text;
    if (!text.empty()) text += "; ";
    text += "took " + duration(measured->milliseconds);
    if (!measured->with.empty()) text += fmt::format(" with {}", fmt::join(measured->with, ", "));
    return text;
}

}  // namespace meshprep
