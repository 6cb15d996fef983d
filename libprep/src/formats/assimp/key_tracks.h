// Key frames as Assimp has them, cleaned, and as glTF takes them: linear, seconds, strictly
// ascending, from 0 on.
#pragma once

#include <assimp/anim.h>

#include <cstdint>
#include <glm/ext/quaternion_double.hpp>
#include <glm/glm.hpp>
#include <memory>
#include <vector>

namespace prep::detail {

template <class T>
struct KeyTrack {
    std::vector<double> times;  // seconds, ascending; two may be equal: a jump
    std::vector<T> values;
    bool empty() const { return times.empty(); }
};
using VectorTrack = KeyTrack<glm::dvec3>;
using RotationTrack = KeyTrack<glm::dquat>;
using NumberTrack = KeyTrack<double>;

// What had to be done to keys.
struct KeyCounts {
    std::uint64_t not_finite = 0;  // left out; rotations of no length as well
    std::uint64_t unsorted = 0;    // put in order
    std::uint64_t repeated = 0;    // more than two at one time, or closer than floats can tell
    std::uint64_t negative = 0;    // before 0: cut there, at the value between
    std::uint64_t added = 0;       // so that pivots stay where they are between keys
};

VectorTrack vector_track(const aiVectorKey* keys, unsigned count, double ticks_per_second,
                         KeyCounts& counts);
// Unit, and each on the side of the one before it, so that the shorter way is the straight one.
RotationTrack rotation_track(const aiQuatKey* keys, unsigned count, double ticks_per_second,
                             KeyCounts& counts);

// Sorts, and leaves at most two keys at one time. Values go along.
void clean(NumberTrack& track, KeyCounts& counts);

// Before the first and after the last key: theirs. Rotations turn evenly (slerp) by the shorter
// way. The track is not empty.
glm::dvec3 at(const VectorTrack& track, double time);
glm::dquat at(const RotationTrack& track, double time);
double at(const NumberTrack& track, double time);

// Times that floats can tell apart, with the keys that have them.
struct FloatTimes {
    std::vector<float> times;
    std::vector<std::size_t> keys;
};
FloatTimes float_times(const std::vector<double>& times, KeyCounts& counts);

// Cuts what lies before 0.
void start_at_zero(VectorTrack& track, KeyCounts& counts);
void start_at_zero(RotationTrack& track, KeyCounts& counts);
void start_at_zero(NumberTrack& track, KeyCounts& counts);

}  // namespace prep::detail
