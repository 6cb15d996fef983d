// Uniform bicubic B-spline patches: values and derivatives at one point, and on whole grids as
// tensor products, first along u, then along v.
//
// Control points are 16 times `width` numbers, p[(4 j + i) · width …] at (i, j); the patch covers
// the square between (1, 1) and (2, 2), u along i.
#pragma once

#include <cstdint>
#include <vector>

#include "prep/simd.h"

namespace prep::detail {

// Weights of four control points in a row at t = i/n, i = 0 … n, n a power of two: of the curve, of
// its derivative, and of the control points after log2 n refinements (Lane and Riesenfeld 1980).
struct BicubicTable {
    std::uint32_t n = 0;
    std::vector<double> value, derivative, control;  // 4 (n + 1) each
    static BicubicTable make(std::uint32_t n);
    // Across a crease at the second control point that is that sharp: its point stays for as many
    // steps, and takes the fraction of the last one (DeRose, Kass and Truong 1998).
    static BicubicTable make_crease(std::uint32_t n, float sharpness);
    // t counted from the other end.
    BicubicTable reversed() const;
};

struct BicubicWeights {
    double value[4], derivative[4], second[4];
};
BicubicWeights bicubic_weights(double t);
BicubicWeights crease_weights(double t, float sharpness);
BicubicWeights reversed(const BicubicWeights& weights);  // of the other end's t

// Where second derivatives go, `width` numbers each.
struct SecondDerivatives {
    double *uu = nullptr, *uv = nullptr, *vv = nullptr;
};
// `second` may be null.
void bicubic_point(std::uint32_t width, const double* controls, const BicubicWeights& u,
                   const BicubicWeights& v, double* value, double* du, double* dv,
                   const SecondDerivatives* second = nullptr);

// Where a grid goes: (i, j) is `width` numbers at i · width + j · stride. Derivatives are times
// `scale`, a power of two; du and dv may both be null.
struct GridOutput {
    double *value = nullptr, *du = nullptr, *dv = nullptr;
    std::size_t stride = 0;
    double scale = 1;
    GridOutput at(std::uint32_t width, std::uint32_t i, std::uint32_t j) const {
        GridOutput moved = *this;
        const std::size_t by = std::size_t(i) * width + j * stride;
        moved.value += by;
        if (du) moved.du += by, moved.dv += by;
        return moved;
    }
};

// Points are read and kept in vectors of so many numbers: beyond the last one there is that much
// room.
inline constexpr std::size_t bicubic_lanes = 4, bicubic_spare = bicubic_lanes - 1;
inline std::size_t bicubic_controls(std::uint32_t width) {
    return 16 * std::size_t(width) + bicubic_spare;
}
inline std::size_t bicubic_scratch(std::uint32_t width, std::uint32_t n) {
    return 8 * ((std::size_t(n) + 1) * width + bicubic_spare) + 4 * (std::size_t(n) + 1);
}
// (n + 1)² points; `controls` has bicubic_controls(width) numbers, `scratch` bicubic_scratch(width,
// n). Bits are the same on every instruction set.
void bicubic_grid(const BicubicTable& along_u, const BicubicTable& along_v, bool control_points,
                  std::uint32_t width, const double* controls, const GridOutput& out,
                  double* scratch, SimdLevel simd);

}  // namespace prep::detail
