#include "formats/assimp/pivot_motion.h"

#include <algorithm>
#include <cmath>

#include "model/trs.h"

namespace prep::detail {
namespace {

// Of the pivots' distances, and of 1 for scales; a tenth of a float's step in a mesh of theirs.
constexpr double tolerance = 3e-6;
// Halvings between two keys, and keys to a node: a hundred full turns.
constexpr int most_halvings = 12;
constexpr std::size_t most_keys = std::size_t(1) << 17;

Trs factor_at(const MovingFactor& factor, double time) {
    Trs trs = factor.rest;
    if (!factor.translation.empty()) trs.translation = at(factor.translation, time);
    if (!factor.rotation.empty()) trs.rotation = at(factor.rotation, time);
    if (!factor.scale.empty()) trs.scale = at(factor.scale, time);
    return trs;
}

bool product_at(const std::vector<MovingFactor>& factors, double time, Trs& product) {
    product = Trs{};
    for (const MovingFactor& factor : factors) {
        Trs next;
        if (!multiply(product, factor_at(factor, time), next)) return false;
        product = next;
    }
    return true;
}

void append_times(const std::vector<double>& from, std::vector<double>& to) {
    to.insert(to.end(), from.begin(), from.end());
}

// What a track's straight way between two keys misses.
template <class Value, class Difference>
class Refinement {
  public:
    Refinement(const Value& value, const Difference& difference, double allowed, KeyCounts& counts)
        : value_(value), difference_(difference), allowed_(allowed), counts_(counts) {}

    template <class Track>
    void run(const std::vector<double>& times, Track& track) {
        for (std::size_t i = 0; i < times.size(); ++i) {
            if (i > 0) between(times[i - 1], times[i], most_halvings, track);
            push(times[i], track);
        }
    }

  private:
    template <class Track>
    void push(double time, Track& track) {
        track.times.push_back(time);
        track.values.push_back(value_(time));
    }

    template <class Track>
    void between(double from, double to, int depth, Track& track) {
        if (depth == 0 || track.times.size() >= most_keys || !off(from, to, track)) return;
        const double middle = from + (to - from) / 2;
        if (!(middle > from && middle < to)) return;
        between(from, middle, depth - 1, track);
        push(middle, track);
        ++counts_.added;
        between(middle, to, depth - 1, track);
    }

    template <class Track>
    bool off(double from, double to, const Track&) {
        Track straight;
        straight.times = {from, to};
        straight.values = {value_(from), value_(to)};
        for (const double part : {0.25, 0.5, 0.75}) {
            const double time = from + (to - from) * part;
            if (difference_(at(straight, time), value_(time)) > allowed_) return true;
        }
        return false;
    }

    const Value& value_;
    const Difference& difference_;
    double allowed_;
    KeyCounts& counts_;
};

template <class Track, class Value, class Difference>
Track refined(const std::vector<double>& times, const Value& value, const Difference& difference,
              double allowed, KeyCounts& counts) {
    Track track;
    Refinement<Value, Difference>(value, difference, allowed, counts).run(times, track);
    return track;
}

}  // namespace

std::optional<TrsTracks> product_tracks(const std::vector<MovingFactor>& factors,
                                        KeyCounts& counts) {
    std::vector<double> moves, turns, scales;  // times that matter to each
    double arm = 0, farthest = 0;              // of what turns, and of all
    for (const MovingFactor& factor : factors) {
        double length = glm::length(factor.rest.translation);
        for (const glm::dvec3& t : factor.translation.values)
            length = std::max(length, glm::length(t));
        farthest = std::max(farthest, length);
        if (!turns.empty() || !scales.empty()) arm = std::max(arm, length);
        append_times(factor.translation.times, moves);
        append_times(factor.rotation.times, turns);
        append_times(factor.scale.times, scales);
    }
    // What turns or scales may move the origin, too.
    append_times(turns, moves);
    append_times(scales, moves);
    for (std::vector<double>* list : {&moves, &turns, &scales}) {
        std::sort(list->begin(), list->end());
        list->erase(std::unique(list->begin(), list->end()), list->end());
    }
    if (moves.empty()) return TrsTracks{};
    Trs product;
    for (const double time : moves)
        if (!product_at(factors, time, product)) return std::nullopt;
    const auto product_of = [&](double time) {
        Trs trs;
        product_at(factors, time, trs);
        return trs;
    };
    const auto far = [](const glm::dvec3& a, const glm::dvec3& b) { return glm::length(a - b); };
    const auto apart = [](const glm::dquat& a, const glm::dquat& b) {
        return std::min(glm::length(a - b), glm::length(a + b));
    };
    TrsTracks out;
    out.translation = refined<VectorTrack>(
        moves, [&](double t) { return product_of(t).translation; }, far,
        std::max(tolerance * arm, 1e-12 * farthest), counts);
    const double any = moves.front();
    if (turns.empty()) turns.push_back(any);
    if (scales.empty()) scales.push_back(any);
    out.rotation = refined<RotationTrack>(
        turns, [&](double t) { return product_of(t).rotation; }, apart, tolerance, counts);
    out.scale = refined<VectorTrack>(
        scales, [&](double t) { return product_of(t).scale; }, far,
        tolerance * std::max(1e-6, glm::length(product_of(any).scale)), counts);
    for (std::size_t k = 1; k < out.rotation.values.size(); ++k)
        if (glm::dot(out.rotation.values[k - 1], out.rotation.values[k]) < 0)
            out.rotation.values[k] = -out.rotation.values[k];
    return out;
}

}  // namespace prep::detail
