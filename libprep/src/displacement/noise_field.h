// Noise in space as a source of heights, with analytic gradients and proved bounds.
#pragma once

#include <array>
#include <glm/glm.hpp>

#include "displacement/height_field.h"
#include "prep/displacement/sources.h"
#include "prep/result.h"

namespace prep::detail {

struct NoiseSample {
    double value = 0;
    glm::dvec3 gradient{0.0};
};

class NoiseField {
  public:
    // Errors: invalid (numbers that are not finite, octaves out of 1 … 32, frequencies or
    // amplitudes that leave the range of doubles).
    static Result<NoiseField> make(const NoiseOptions& options = {});

    NoiseSample sample(const glm::dvec3& p) const;
    double value(const glm::dvec3& p) const { return sample(p).value; }
    glm::dvec3 gradient(const glm::dvec3& p) const { return sample(p).gradient; }

    // Everywhere: of values, of the gradient's length, of the spectral norm of the second
    // derivatives.
    Interval range() const;
    double steepest() const;
    double curvature() const;
    // No value is changed by more by the spacing of samples; infinite where no double holds that.
    double left_out() const;
    // No two values of points so far apart differ by more: each octave's by no more than twice its
    // largest, however steep it is.
    double change(double distance) const;

    // No |value(Σ λ p) − Σ λ value(p)| over the triangle is larger. By its size alone: no value is
    // computed.
    double deviation(const std::array<glm::dvec3, 3>& p) const;

  private:
    explicit NoiseField(const NoiseOptions& options) : options_(options) {}
    NoiseOptions options_;
};

}  // namespace prep::detail
