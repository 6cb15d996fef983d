// Grids of bicubic patches, a vector of numbers at a time: along v each number of a row is the same
// sum of four, whatever it belongs to.
#include "base/simd_targets.h"
#include "limit_surface/bicubic.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "limit_surface/bicubic_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace prep::detail::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
// The scalar sum is the same expression: bits do not depend on what a vector holds.
HWY_INLINE double sum_of_four(const double* w, double p0, double p1, double p2, double p3) {
    return ((w[0] * p0 + w[1] * p1) + w[2] * p2) + w[3] * p3;
}
template <class D, class V = hn::Vec<D>>
HWY_INLINE V sum_of_four(D d, const double* w, V p0, V p1, V p2, V p3) {
    const V first = hn::Add(hn::Mul(hn::Set(d, w[0]), p0), hn::Mul(hn::Set(d, w[1]), p1));
    return hn::Add(hn::Add(first, hn::Mul(hn::Set(d, w[2]), p2)), hn::Mul(hn::Set(d, w[3]), p3));
}

// Four rows of control points, `count` numbers each at `pitch`, become rows j = 0 … n of `count`
// numbers at `stride`.
struct Rows {
    const double* numbers;
    std::size_t count, pitch, stride;
    std::uint32_t n;
};

// out[j · stride + k] = Σ weights[4 j + b] rows[b · pitch + k], in this order; so many k at once as
// a vector holds, the last ones once more where they are fewer.
template <class D>
HWY_INLINE void sum_rows_of(D d, const Rows& rows, const double* weights, double* out) {
    const std::size_t lanes = hn::Lanes(d);
    for (std::size_t block = 0; block < rows.count; block += lanes) {
        const std::size_t k = HWY_MIN(block, rows.count - lanes);
        const double* const p = rows.numbers + k;
        const auto p0 = hn::LoadU(d, p), p1 = hn::LoadU(d, p + rows.pitch),
                   p2 = hn::LoadU(d, p + 2 * rows.pitch), p3 = hn::LoadU(d, p + 3 * rows.pitch);
        for (std::uint32_t j = 0; j <= rows.n; ++j)
            hn::StoreU(sum_of_four(d, weights + 4 * std::size_t(j), p0, p1, p2, p3), d,
                       out + j * rows.stride + k);
    }
}

HWY_INLINE void sum_rows(const Rows& rows, const double* weights, double* out) {
    const hn::ScalableTag<double> wide;
    if (rows.count >= hn::Lanes(wide)) return sum_rows_of(wide, rows, weights, out);
    const hn::CappedTag<double, bicubic_lanes> narrow;
    if (rows.count >= hn::Lanes(narrow)) return sum_rows_of(narrow, rows, weights, out);
    const double* const p = rows.numbers;
    for (std::uint32_t j = 0; j <= rows.n; ++j)
        for (std::size_t k = 0; k < rows.count; ++k)
            out[j * rows.stride + k] =
                sum_of_four(weights + 4 * std::size_t(j), p[k], p[rows.pitch + k],
                            p[2 * rows.pitch + k], p[3 * rows.pitch + k]);
}

// Along u: rows[b · pitch + i · width + d] for the four rows b, i = 0 … n. A point of no more
// numbers than a vector has is stored as one: what is beyond it is written again with the next
// point, or is not part of the row.
template <class D>
HWY_INLINE void along_u_narrow(D d, const double* weights, double scale, std::uint32_t n,
                               std::uint32_t width, const double* controls, std::size_t pitch,
                               double* rows) {
    hn::Vec<D> p[16];
    for (std::size_t k = 0; k < 16; ++k) p[k] = hn::LoadU(d, controls + k * width);
    for (std::uint32_t i = 0; i <= n; ++i, weights += 4, rows += width) {
        const double w[4] = {weights[0] * scale, weights[1] * scale, weights[2] * scale,
                             weights[3] * scale};
        for (std::size_t b = 0; b < 4; ++b)
            hn::StoreU(sum_of_four(d, w, p[4 * b], p[4 * b + 1], p[4 * b + 2], p[4 * b + 3]), d,
                       rows + b * pitch);
    }
}

HWY_INLINE void along_u(const double* weights, double scale, std::uint32_t n, std::uint32_t width,
                        const double* controls, std::size_t pitch, double* rows) {
    const hn::CappedTag<double, bicubic_lanes> d;
    if (width <= hn::Lanes(d))
        return along_u_narrow(d, weights, scale, n, width, controls, pitch, rows);
    for (std::uint32_t i = 0; i <= n; ++i, weights += 4, rows += width) {
        const double w[4] = {weights[0] * scale, weights[1] * scale, weights[2] * scale,
                             weights[3] * scale};
        for (std::size_t b = 0; b < 4; ++b) {
            const double* const c = controls + 4 * b * width;
            for (std::size_t k = 0; k < width; ++k)
                rows[b * pitch + k] =
                    sum_of_four(w, c[k], c[width + k], c[2 * width + k], c[3 * width + k]);
        }
    }
}

void grid_kernel(const double* value_u, const double* derivative_u, const double* value,
                 const double* derivative, std::uint32_t n, std::uint32_t width,
                 const double* controls, const GridOutput* out, double* scratch) {
    const std::size_t count = (std::size_t(n) + 1) * width, pitch = count + bicubic_spare;
    const Rows rows{scratch, count, pitch, out->stride, n};
    along_u(value_u, 1, n, width, controls, pitch, scratch);
    sum_rows(rows, value, out->value);
    if (out->du == nullptr) return;
    double *const slopes = scratch + 4 * pitch, *const scaled = slopes + 4 * pitch;
    along_u(derivative_u, out->scale, n, width, controls, pitch, slopes);
    sum_rows({slopes, count, pitch, out->stride, n}, value, out->du);
    for (std::size_t k = 0; k < 4 * (std::size_t(n) + 1); ++k)
        scaled[k] = derivative[k] * out->scale;
    sum_rows(rows, scaled, out->dv);
}

}  // namespace prep::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace prep::detail {

void bicubic_grid(const BicubicTable& u, const BicubicTable& v, bool control_points,
                  std::uint32_t width, const double* controls, const GridOutput& out,
                  double* scratch, SimdLevel simd) {
    SIMD_KERNEL(simd, grid_kernel)
    (control_points ? u.control.data() : u.value.data(), u.derivative.data(),
     control_points ? v.control.data() : v.value.data(), v.derivative.data(), u.n, width, controls,
     &out, scratch);
}

}  // namespace prep::detail
#endif
