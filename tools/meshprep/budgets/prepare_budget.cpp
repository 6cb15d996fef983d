#include "meshprep/budgets/prepare_budget.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <thread>

#include "meshprep/budgets/stopwatch.h"

namespace meshprep {
namespace {

using prep::Precision;
using prep::Result;

constexpr std::array<Precision, 3> precisions = {Precision::fast, Precision::accurate,
                                                 Precision::exact};
constexpr std::size_t whole_faces = 4096, part_faces = 1024, most_parts = 4;
constexpr int most_sample_runs = 5;
constexpr double enough_sample_ms = 20;
constexpr double long_run_ms = 4000;  // is not made again
constexpr double most_level_faces = double(std::uint64_t(1) << 24);

struct Prepared {
    prep::PreparedScene scene;
    double milliseconds = 0;
    double cold = 0;  // what the printed command takes besides, which finds memory untouched
};

Result<Prepared> timed(prep::Scene scene, const prep::PrepareOptions& options) {
    Stopwatch watch(options.threads);
    Result<prep::PreparedScene> prepared = prep::prepare(std::move(scene), options);
    if (!prepared) return prepared.error();
    const double milliseconds = watch.milliseconds();
    return Prepared{*std::move(prepared), milliseconds, 0};
}

// What the first run of a process takes beyond the least of those that follow: it touches memory
// for the first time. On virtual machines that may take any time once: a quarter and 5 ms at most,
// as small meshes of bench/measure_budgets take.
double cold_ms(double first, double least) {
    constexpr double most_part = 0.25, most = 5;
    return std::min({first - least, most_part * least, most});
}

// Twice, short ones up to six times, long ones once. The least and what is cold are what the
// setting takes.
struct Pilot {
    Prepared last;
    double milliseconds = 0;
};
Result<Pilot> pilot_of(const prep::Scene& scene, const prep::PrepareOptions& options) {
    Result<Prepared> run = timed(scene, options);
    if (!run) return run.error();
    const double first = run->milliseconds;
    double least = first;
    for (int again = 1; first <= long_run_ms && again <= most_sample_runs &&
                        (again == 1 || again * least < enough_sample_ms);
         ++again) {
        run->scene = {};
        run = timed(scene, options);
        if (!run) return run.error();
        least = std::min(least, run->milliseconds);
    }
    run->cold = cold_ms(first, least);
    const double milliseconds = least + run->cold;
    return Pilot{*std::move(run), milliseconds};
}

prep::PrepareOptions with_precision(prep::PrepareOptions options, Precision precision) {
    options.normal.precision = precision;
    return options;
}

// The faces `faces` of `mesh` with the vertices that they have.
prep::Mesh part_of(const prep::Mesh& mesh, const std::vector<std::uint32_t>& faces) {
    prep::Mesh part;
    part.indexed_by_vertex = mesh.indexed_by_vertex;
    std::vector<std::uint32_t> used;
    for (const std::uint32_t f : faces)
        for (std::uint32_t c = mesh.face_offsets[f]; c < mesh.face_offsets[f + 1]; ++c)
            used.push_back(mesh.corner_vertices[c]);
    std::vector<std::uint32_t> vertices = used;
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    for (const std::uint32_t v : vertices) part.positions.push_back(mesh.positions[v]);
    for (const std::uint32_t v : used)
        part.corner_vertices.push_back(std::uint32_t(
            std::lower_bound(vertices.begin(), vertices.end(), v) - vertices.begin()));
    for (const std::uint32_t f : faces)
        part.face_offsets.push_back(part.face_offsets.back() + mesh.face_offsets[f + 1] -
                                    mesh.face_offsets[f]);
    return part;
}

// Those whose first corners are nearest to that of `face`, in the mesh's order.
std::vector<std::uint32_t> faces_about(const prep::Mesh& mesh, std::uint32_t face,
                                       std::size_t count) {
    const auto place = [&mesh](std::uint32_t f) {
        return glm::dvec3(mesh.positions[mesh.corner_vertices[mesh.face_offsets[f]]]);
    };
    const glm::dvec3 middle = place(face);
    std::vector<std::uint32_t> faces(mesh.face_count());
    std::iota(faces.begin(), faces.end(), 0u);
    std::vector<double> away(faces.size());
    for (const std::uint32_t f : faces) {
        const glm::dvec3 d = place(f) - middle;
        const double squared = glm::dot(d, d);
        away[f] = std::isnan(squared) ? std::numeric_limits<double>::infinity() : squared;
    }
    std::nth_element(faces.begin(), faces.begin() + std::ptrdiff_t(count), faces.end(),
                     [&away](std::uint32_t a, std::uint32_t b) {
                         return away[a] < away[b] || (away[a] == away[b] && a < b);
                     });
    faces.resize(count);
    std::sort(faces.begin(), faces.end());
    return faces;
}

void add_mesh(prep::Scene& scene, prep::Mesh mesh) {
    scene.nodes.emplace_back().mesh = std::uint32_t(scene.meshes.size());
    scene.meshes.push_back(std::move(mesh));
}

// The least of a few runs, on one thread; the first run touches memory for the first time, and
// counts only where it is long.
Result<double> sampled_ms(const prep::Scene& scene, const prep::PrepareOptions& options) {
    double least = std::numeric_limits<double>::infinity(), spent = 0;
    for (int run = 0; run <= most_sample_runs && spent < enough_sample_ms; ++run) {
        const Result<Prepared> done = timed(scene, options);
        if (!done) return done.error();
        spent += done->milliseconds;
        if (run > 0 || spent >= enough_sample_ms) least = std::min(least, done->milliseconds);
    }
    return least;
}

void set_result(Prepared prepared, PreparedWithin& out) {
    out.prepared = std::move(prepared.scene);
    out.milliseconds = prepared.milliseconds;
    out.times.taken = prepared.milliseconds + prepared.cold;
}

Result<PreparedWithin> precision_within(prep::Scene scene, const prep::PrepareOptions& options,
                                        double asked) {
    const Clock::time_point start = Clock::now();
    Result<Pilot> pilot = pilot_of(scene, with_precision(options, Precision::fast));
    if (!pilot) return pilot.error();
    Prepared last = std::move(pilot->last);
    const SampledFaces some = sampled_faces(scene, last.scene.normals_made);
    prep::PrepareOptions alone = options;
    alone.threads = 1;
    std::array<double, 3> sampled{};
    for (std::size_t p = 0; p < precisions.size() && some.corners > 0; ++p) {
        const Result<double> ms = sampled_ms(some.scene, with_precision(alone, precisions[p]));
        if (!ms) return ms.error();
        sampled[p] = *ms;
    }
    const int threads = options.threads > 0 ? options.threads
                                            : std::max(1, int(std::thread::hardware_concurrency()));
    PreparedWithin out;
    out.times =
        chosen_in_time(asked, precision_predictions(pilot->milliseconds, sampled, some.corners,
                                                    some.corners_of_all / threads));
    out.times.pilot_ms = milliseconds_since(start);
    if (out.times.index > 0) {
        last.scene = {};
        Result<Prepared> chosen =
            timed(std::move(scene), with_precision(options, precisions[out.times.index]));
        if (!chosen) return chosen.error();
        chosen->cold = last.cold;
        last = *std::move(chosen);
    }
    set_result(std::move(last), out);
    return out;
}

Result<PreparedWithin> level_within(prep::Scene scene, prep::PrepareOptions options, double asked) {
    const Clock::time_point start = Clock::now();
    std::uint64_t corners = 0;
    for (const prep::Mesh& mesh : scene.meshes) corners += mesh.corner_count();
    const int most = finest_level(corners);
    const std::string scheme(prep::name_of(options.subdivision.scheme));
    std::vector<double> taken, cold;
    std::vector<TimePrediction> tried;
    Prepared last;
    for (int level = 0; level <= most; ++level) {
        if (level == 1 && taken[0] > asked) break;
        if (level > 1 && tried[std::size_t(level)].milliseconds > asked) {
            // Where a level is little more than what is fixed, nothing is known of those after it:
            // it took at most twice what the one before did, and four times of it would fit.
            const double before = taken[taken.size() - 2], now = taken.back();
            if (now > 2 * before || 4 * now > asked) break;
        }
        options.subdivision.level = level;
        last.scene = {};
        Result<Pilot> pilot = pilot_of(scene, options);
        if (!pilot) return pilot.error();
        last = std::move(pilot->last);
        cold.push_back(last.cold);
        taken.push_back(pilot->milliseconds);
        tried = level_predictions(taken, most, scheme);
    }
    PreparedWithin out;
    out.times = chosen_in_time(asked, std::move(tried));
    out.times.pilot_ms = milliseconds_since(start);
    if (out.times.index + 1 != taken.size()) {
        options.subdivision.level = int(out.times.index);
        last.scene = {};
        Result<Prepared> chosen = timed(std::move(scene), options);
        if (!chosen) return chosen.error();
        last = *std::move(chosen);
        last.cold = cold[std::min(out.times.index, cold.size() - 1)];
    }
    set_result(std::move(last), out);
    return out;
}

}  // namespace

SampledFaces sampled_faces(const prep::Scene& scene, const std::vector<bool>& made) {
    SampledFaces out;
    std::uint64_t faces = 0;
    for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
        if (!made[m]) continue;
        const prep::Mesh& mesh = scene.meshes[m];
        faces += mesh.face_count();
        out.corners_of_all += double(mesh.corner_count()) * double(1 + mesh.morph_targets.size());
    }
    std::vector<bool> taken(scene.meshes.size());
    for (std::size_t part = 0; part < most_parts && faces > 0; ++part) {
        // The middle of a fourth of all faces.
        std::uint64_t at = faces * (2 * part + 1) / (2 * most_parts);
        std::size_t m = 0;
        for (; !made[m] || at >= scene.meshes[m].face_count(); ++m)
            if (made[m]) at -= scene.meshes[m].face_count();
        const prep::Mesh& mesh = scene.meshes[m];
        if (mesh.face_count() > whole_faces) {
            add_mesh(out.scene, part_of(mesh, faces_about(mesh, std::uint32_t(at), part_faces)));
        } else if (!taken[m]) {
            std::vector<std::uint32_t> all(mesh.face_count());
            std::iota(all.begin(), all.end(), 0u);
            add_mesh(out.scene, part_of(mesh, all));
            taken[m] = true;
        }
    }
    for (const prep::Mesh& mesh : out.scene.meshes) out.corners += double(mesh.corner_count());
    return out;
}

std::vector<TimePrediction> precision_predictions(double fast, const std::array<double, 3>& sampled,
                                                  double corners, double corners_of_all) {
    std::vector<TimePrediction> out;
    for (std::size_t p = 0; p < precisions.size(); ++p) {
        const double more =
            corners > 0 ? (sampled[p] - sampled[0]) * (corners_of_all / corners) : 0;
        out.push_back({fmt::format("--precision={}", prep::name_of(precisions[p])),
                       std::max(fast + more, 0.0), p == 0});
    }
    return out;
}

std::vector<TimePrediction> level_predictions(const std::vector<double>& milliseconds, int most,
                                              const std::string& scheme) {
    std::vector<TimePrediction> out;
    const std::size_t last = milliseconds.size() - 1;
    // In units of those of level 0; a single level says nothing of what is fixed.
    const auto faces = [](std::size_t level) { return std::ldexp(1.0, 2 * int(level)); };
    // What took no longer than the level before says that all of it is its faces': rather too slow
    // than too fast.
    double of_face = milliseconds[last] / faces(last);
    if (last > 0 && milliseconds[last] > milliseconds[last - 1])
        of_face = std::min(of_face, (milliseconds[last] - milliseconds[last - 1]) /
                                        (faces(last) - faces(last - 1)));
    for (std::size_t level = 0; level <= std::size_t(most); ++level)
        out.push_back({fmt::format("--subdivide={}:{}", scheme, level),
                       level <= last ? milliseconds[level]
                                     : milliseconds[last] + of_face * (faces(level) - faces(last)),
                       level <= last});
    return out;
}

int finest_level(std::uint64_t corners) {
    int level = 0;
    // The first level has a face for each corner, the next four times as many.
    while (level < prep::max_subdivision_level &&
           double(corners) * std::ldexp(1.0, 2 * level) <= most_level_faces)
        ++level;
    return level;
}

Result<PreparedWithin> prepare_within(prep::Scene scene, const prep::PrepareOptions& options,
                                      double asked) {
    return options.subdivide ? level_within(std::move(scene), options, asked)
                             : precision_within(std::move(scene), options, asked);
}

}  // namespace meshprep
