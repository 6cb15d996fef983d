#include "formats/assimp/key_tracks.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <numeric>

namespace prep::detail {
namespace {

glm::dvec3 between(const glm::dvec3& a, const glm::dvec3& b, double t) {
    return a + (b - a) * t;
}
double between(double a, double b, double t) {
    return a + (b - a) * t;
}
glm::dquat between(const glm::dquat& a, const glm::dquat& b, double t) {
    return glm::normalize(glm::slerp(a, b, t));
}

template <class T>
T sample(const KeyTrack<T>& track, double time) {
    const auto behind = std::upper_bound(track.times.begin(), track.times.end(), time);
    if (behind == track.times.begin()) return track.values.front();
    if (behind == track.times.end()) return track.values.back();
    const std::size_t i = std::size_t(behind - track.times.begin());
    const double span = track.times[i] - track.times[i - 1];
    if (!(span > 0)) return track.values[i];
    return between(track.values[i - 1], track.values[i], (time - track.times[i - 1]) / span);
}

template <class T>
void put_in_order(KeyTrack<T>& track, KeyCounts& counts) {
    if (!std::is_sorted(track.times.begin(), track.times.end())) {
        std::vector<std::size_t> order(track.times.size());
        std::iota(order.begin(), order.end(), std::size_t(0));
        std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
            return track.times[a] < track.times[b];
        });
        KeyTrack<T> sorted;
        for (std::size_t i = 0; i < order.size(); ++i) {
            counts.unsorted += order[i] != i;
            sorted.times.push_back(track.times[order[i]]);
            sorted.values.push_back(track.values[order[i]]);
        }
        track = std::move(sorted);
    }
    // Of several at one time the first and the last: where the way there ends, where it goes on.
    KeyTrack<T> kept;
    for (std::size_t i = 0; i < track.times.size(); ++i) {
        const std::size_t n = kept.times.size();
        const bool same = n > 0 && kept.times[n - 1] == track.times[i];
        if (same && kept.values[n - 1] == track.values[i]) continue;
        if (same && n > 1 && kept.times[n - 2] == track.times[i]) {
            kept.values[n - 1] = track.values[i];
            ++counts.repeated;
            continue;
        }
        kept.times.push_back(track.times[i]);
        kept.values.push_back(track.values[i]);
    }
    track = std::move(kept);
}

template <class T>
void cut_before_zero(KeyTrack<T>& track, KeyCounts& counts) {
    if (track.empty() || track.times.front() >= 0) return;
    const T value = sample(track, 0);
    const auto first = std::lower_bound(track.times.begin(), track.times.end(), 0.0);
    const auto cut = first - track.times.begin();
    counts.negative += std::uint64_t(cut);
    track.values.erase(track.values.begin(), track.values.begin() + cut);
    track.times.erase(track.times.begin(), first);
    if (track.empty() || track.times.front() > 0) {
        track.times.insert(track.times.begin(), 0.0);
        track.values.insert(track.values.begin(), value);
    }
}

}  // namespace

VectorTrack vector_track(const aiVectorKey* keys, unsigned count, double ticks_per_second,
                         KeyCounts& counts) {
    VectorTrack track;
    for (unsigned k = 0; k < count; ++k) {
        const glm::dvec3 value(keys[k].mValue.x, keys[k].mValue.y, keys[k].mValue.z);
        const double time = keys[k].mTime / ticks_per_second;
        if (!std::isfinite(float(time)) || !std::isfinite(value.x + value.y + value.z)) {
            ++counts.not_finite;
            continue;
        }
        track.times.push_back(time);
        track.values.push_back(value);
    }
    put_in_order(track, counts);
    return track;
}

RotationTrack rotation_track(const aiQuatKey* keys, unsigned count, double ticks_per_second,
                             KeyCounts& counts) {
    RotationTrack track;
    for (unsigned k = 0; k < count; ++k) {
        const aiQuaternion& q = keys[k].mValue;
        const glm::dquat value(q.w, q.x, q.y, q.z);
        const double time = keys[k].mTime / ticks_per_second;
        const double length = glm::length(value);
        if (!std::isfinite(float(time)) || !std::isfinite(length) || !(length > 0)) {
            ++counts.not_finite;
            continue;
        }
        track.times.push_back(time);
        track.values.push_back(value / length);
    }
    put_in_order(track, counts);
    for (std::size_t k = 1; k < track.values.size(); ++k)
        if (glm::dot(track.values[k - 1], track.values[k]) < 0) track.values[k] = -track.values[k];
    return track;
}

void clean(NumberTrack& track, KeyCounts& counts) {
    put_in_order(track, counts);
}

glm::dvec3 at(const VectorTrack& track, double time) {
    return sample(track, time);
}
glm::dquat at(const RotationTrack& track, double time) {
    return sample(track, time);
}
double at(const NumberTrack& track, double time) {
    return sample(track, time);
}

FloatTimes float_times(const std::vector<double>& times, KeyCounts& counts) {
    FloatTimes out;
    for (std::size_t k = 0; k < times.size(); ++k) {
        float time = float(times[k]);
        if (!out.times.empty() && time <= out.times.back()) {
            // A jump takes the shortest step there is; keys that only floats put together are one.
            if (times[k] > times[k - 1]) {
                ++counts.repeated;
                continue;
            }
            time = std::nextafter(out.times.back(), std::numeric_limits<float>::max());
        }
        out.times.push_back(time);
        out.keys.push_back(k);
    }
    return out;
}

void start_at_zero(VectorTrack& track, KeyCounts& counts) {
    cut_before_zero(track, counts);
}
void start_at_zero(RotationTrack& track, KeyCounts& counts) {
    cut_before_zero(track, counts);
}
void start_at_zero(NumberTrack& track, KeyCounts& counts) {
    cut_before_zero(track, counts);
}

}  // namespace prep::detail
