// Random scenes of everything that drawing can meet, the odd included: meshes, materials, maps,
// lights, cameras. The same seed gives the same scene on every machine. What the scenes hold is
// told by a table of predicates that look at the scene alone, not by who made it.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "prep/scene.h"

namespace test {

// Numbers of its own (Steele, Lea, Flood 2014: SplitMix64): those of <random> differ by library.
class RandomNumbers {
  public:
    // Neighbouring seeds begin far apart: the state only counts on.
    explicit RandomNumbers(std::uint64_t seed) : state_(seed) { state_ = bits() ^ (bits() << 1); }
    std::uint64_t bits();
    std::uint32_t below(std::uint32_t count) { return std::uint32_t(bits() >> 33) % count; }
    bool chance(double p) { return unit() < p; }
    double unit() { return double(bits() >> 11) * 0x1p-53; }
    float between(double low, double high) { return float(low + (high - low) * unit()); }

  private:
    std::uint64_t state_;
};

// Small: at most some thousand triangles and pictures of 16 texels a side. Pictures are embedded.
// The same whatever compiles it: no two numbers are drawn for the arguments of one call.
prep::Scene random_scene(std::uint32_t seed);

// A picture of floats in memory, as a file that keeps them.
prep::ImageRef float_picture(std::uint32_t width, std::uint32_t height, std::uint32_t channels,
                             std::span<const float> values);

// Something that a scene may hold: a row of the table of features and scenes.
struct SceneFeature {
    const char* name;
    bool (*in)(const prep::Scene& scene);
};
std::span<const SceneFeature> scene_features();

// A line for each feature: its name, how many of the scenes have it, and the first few that do.
std::string coverage_table(std::span<const prep::Scene> scenes);

}  // namespace test
