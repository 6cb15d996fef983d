#include "meshprep/budgets/sampling_costs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <thread>

#include "cost/ladders/meshes.h"
#include "cost/ladders/scenes.h"
#include "cost/pages/cost_table.h"
#include "prep/simd.h"
#include "prep/version.h"

namespace meshprep {
namespace {

using prep::Result;

constexpr std::uint32_t calibration_size = 192;
static_assert(calibration_pixels == calibration_size * calibration_size);
// Of the empty picture: as wide as pictures are, so that its rows leave the caches as theirs do.
constexpr std::uint32_t empty_width = 1024, empty_height = 64;
constexpr double most_empty = 1e6;  // nanoseconds
constexpr int least_rounds = 3, most_rounds = 8;
constexpr double least_factor = 1, most_factor = 1000;

// What makes one build of a version faster than another.
std::string build_name() {
    std::string name;
#ifdef __OPTIMIZE__
    name += "optimised";
#else
    name += "not optimised";
#endif
#ifndef NDEBUG
    name += ", checked";
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    name += ", sanitised";
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || \
    __has_feature(memory_sanitizer)
    name += ", sanitised";
#endif
#endif
    for (const prep::SimdLevel level :
         {prep::SimdLevel::sse4, prep::SimdLevel::avx2, prep::SimdLevel::avx512})
        if (prep::simd_available(level)) name += ", " + std::string(prep::to_string(level));
    return name;
}

std::shared_ptr<const prep::PreparedScene> lit_torus(int around, int across) {
    const cost::KnownMesh known = cost::known_torus(around, across, 0);
    prep::VertexMesh mesh;
    mesh.positions = known.mesh.positions;
    mesh.indices = known.mesh.corner_vertices;
    for (const cost::SurfaceSample& at : known.at) mesh.normals.emplace_back(at.normal);
    prep::Material material;
    material.specular = glm::vec3(0.4f);
    material.shininess = 40;
    return std::make_shared<const prep::PreparedScene>(cost::scene_of(std::move(mesh), material));
}

rast::RenderRequest calibration_request(const SamplingRung& rung, int threads) {
    rast::RenderRequest request;
    request.width = request.height = calibration_size;
    request.samples = rung.samples;
    request.supersample = rung.supersample;
    request.shading = prep::Shading::phong;
    request.threads = threads;
    request.view = cost::flat_view(1.5);
    return request;
}

rast::RenderRequest empty_request(const SamplingRung& rung, int threads) {
    rast::RenderRequest request = calibration_request(rung, threads);
    request.width = empty_width;
    request.height = empty_height;
    request.view->world_to_view[3].x += 1000;  // the torus is out of it
    return request;
}

// Of a picture of calibration_pixels, of as many in a row as make a time that a clock can tell.
Result<double> empty_milliseconds(const std::shared_ptr<const prep::PreparedScene>& scene,
                                  const SamplingRung& rung, int threads) {
    const int points = rung.samples * rung.supersample * rung.supersample;
    const int pictures = std::max(1, 64 / points);
    cost::Drawing drawing(scene, empty_request(rung, threads));
    Stopwatch watch(threads);
    for (int k = 0; k < pictures; ++k)
        if (const Result<void> done = drawing.draw(); !done) return done.error();
    return watch.milliseconds() / pictures * calibration_pixels /
           (double(empty_width) * empty_height);
}

}  // namespace

SamplingCost cost_from_times(const SamplingRung& rung, const CalibrationTimes& times,
                             const CalibrationTimes& of_one) {
    const auto factor = [](double time, double time_of_one) {
        if (!(time_of_one > 0) || !(time > 0)) return 1.0;
        return std::clamp(time / time_of_one, least_factor, most_factor);
    };
    return {rung, factor(times.many - times.few, of_one.many - of_one.few),
            factor(times.few - times.empty, of_one.few - of_one.empty),
            std::clamp(times.empty * 1e6 / calibration_pixels, 0.0, most_empty)};
}

Result<MeasuredCosts> measured_sampling_costs(int threads) {
    const std::shared_ptr<const prep::PreparedScene> scenes[] = {lit_torus(32, 16),
                                                                 lit_torus(320, 160)};
    const std::vector<SamplingRung> rungs = sampling_rungs();
    std::vector<std::array<LeastTimes, 3>> least(rungs.size());
    MeasuredCosts out;
    // The first round touches memory for the first time: it does not count.
    for (int round = 0; round <= most_rounds && !(round > least_rounds && out.steady); ++round) {
        for (std::size_t s = 0; s < 2; ++s)
            for (std::size_t r = 0; r < rungs.size(); ++r) {
                if (round == 0 && rungs[r].supersample > 2) continue;
                cost::Drawing drawing(scenes[s], calibration_request(rungs[r], threads));
                Stopwatch watch(threads);
                if (const Result<void> done = drawing.draw(); !done) return done.error();
                if (round > 0) least[r][s].add(watch.milliseconds());
            }
        for (std::size_t r = 0; r < rungs.size(); ++r) {
            const Result<double> empty = empty_milliseconds(scenes[0], rungs[r], threads);
            if (!empty) return empty.error();
            if (round > 0) least[r][2].add(*empty);
        }
        out.steady = std::all_of(least.begin(), least.end(), [](const auto& times) {
            return std::all_of(times.begin(), times.end(),
                               [](const LeastTimes& t) { return t.steady(); });
        });
    }
    const auto times = [&](std::size_t r) {
        return CalibrationTimes{least[r][0].first, least[r][1].first, least[r][2].first};
    };
    for (std::size_t r = 0; r < rungs.size(); ++r)
        out.costs.push_back(cost_from_times(rungs[r], times(r), times(0)));
    return out;
}

Json to_json(const std::vector<SamplingCost>& costs) {
    Json json = Json::array();
    for (const SamplingCost& cost : costs)
        json.push_back({{"samples", cost.rung.samples},
                        {"supersample", cost.rung.supersample},
                        {"triangles", cost.triangles},
                        {"pixels", cost.pixels},
                        {"empty", cost.empty}});
    return json;
}

std::optional<std::vector<SamplingCost>> sampling_costs_from(const Json& json) {
    const std::vector<SamplingRung> rungs = sampling_rungs();
    if (!json.is_array() || json.size() != rungs.size()) return std::nullopt;
    std::vector<SamplingCost> costs;
    for (std::size_t r = 0; r < rungs.size(); ++r) {
        const Json& one = json[r];
        if (!one.is_object() || one.value("samples", Json()) != rungs[r].samples ||
            one.value("supersample", Json()) != rungs[r].supersample)
            return std::nullopt;
        SamplingCost cost{rungs[r]};
        for (const auto& [name, factor] :
             {std::pair("triangles", &cost.triangles), std::pair("pixels", &cost.pixels)}) {
            const auto value = one.find(name);
            if (value == one.end() || !value->is_number()) return std::nullopt;
            *factor = value->get<double>();
            if (!(*factor >= least_factor && *factor <= most_factor)) return std::nullopt;
        }
        const auto empty = one.find("empty");
        if (empty == one.end() || !empty->is_number()) return std::nullopt;
        cost.empty = empty->get<double>();
        if (!(cost.empty >= 0 && cost.empty <= most_empty)) return std::nullopt;
        costs.push_back(cost);
    }
    return costs;
}

CostKey sampling_key(int threads) {
    const int used = threads > 0 ? threads : std::max(1, int(std::thread::hardware_concurrency()));
    return {"sampling", std::string(prep::version()), build_name(), cost::processor_name(), used};
}

Result<FoundCosts> sampling_costs(int threads, bool keep) {
    const CostKey key = sampling_key(threads);
    const auto file = keep ? cost_cache_file() : std::nullopt;
    FoundCosts found;
    if (file)
        if (const auto kept = cached_costs(*file, key))
            if (auto costs = sampling_costs_from(*kept)) {
                found.costs = *std::move(costs);
                found.cached = true;
                return found;
            }
    auto measured = measured_sampling_costs(key.threads);
    if (!measured) return measured.error();
    found.costs = std::move(measured->costs);
    if (!keep) return found;
    if (!file)
        found.not_kept = "there is no directory for caches (XDG_CACHE_HOME, HOME)";
    else if (key.processor == "unknown")
        found.not_kept = "the processor has no name that tells it from others";
    else if (!measured->steady)
        found.not_kept = "the machine is busy, and they differ from round to round";
    else if (const Result<void> kept = keep_costs(*file, key, to_json(found.costs)); !kept)
        found.not_kept = to_string(kept.error());
    return found;
}

}  // namespace meshprep
