// How far the normals of patches are from directions, a vector of patches at a time.
#include "tessellation/limit/cone_kernels.h"

#include "base/simd_targets.h"
#include "tessellation/limit/bezier_patch.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tessellation/limit/cone_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace prep::detail::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Doubles = hn::CappedTag<double, patches_at_once>;
using V = hn::Vec<Doubles>;

// Three numbers of each patch.
struct Three {
    V x, y, z;
    Three() = default;
    HWY_INLINE explicit Three(double value)
        : x(hn::Set(Doubles(), value)),
          y(hn::Set(Doubles(), value)),
          z(hn::Set(Doubles(), value)) {}
    HWY_INLINE Three(V a, V b, V c) : x(a), y(b), z(c) {}
};
HWY_INLINE Three operator-(const Three& a, const Three& b) {
    return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE Three operator+(const Three& a, const Three& b) {
    return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
HWY_INLINE Three& operator+=(Three& a, const Three& b) {
    return a = a + b;
}
HWY_INLINE Three operator*(V times, const Three& a) {
    return {hn::Mul(times, a.x), hn::Mul(times, a.y), hn::Mul(times, a.z)};
}
HWY_INLINE Three operator*(double times, const Three& a) {
    return hn::Set(Doubles(), times) * a;
}
HWY_INLINE Three operator/(const Three& a, double by) {
    const V divisor = hn::Set(Doubles(), by);
    return {hn::Div(a.x, divisor), hn::Div(a.y, divisor), hn::Div(a.z, divisor)};
}
HWY_INLINE V dot(const Three& a, const Three& b) {
    return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE Three cross(const Three& a, const Three& b) {
    return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(b.y, a.z)),
            hn::Sub(hn::Mul(a.z, b.x), hn::Mul(b.z, a.x)),
            hn::Sub(hn::Mul(a.x, b.y), hn::Mul(b.x, a.y))};
}
HWY_INLINE Three load(const double* numbers) {
    const Doubles d;
    return {hn::LoadU(d, numbers), hn::LoadU(d, numbers + patches_at_once),
            hn::LoadU(d, numbers + 2 * patches_at_once)};
}

#include "tessellation/limit/normal_net-inl.h"

// The largest tangent of the angle to e among `count` directions, each of whose numbers may be off
// by `error`; infinity where one is a right angle or more away.
HWY_INLINE V widest_of(const Three* n, std::size_t count, const Three& e, V error) {
    const Doubles d;
    V widest = hn::Zero(d);
    auto bounded = hn::Ge(widest, widest);
    for (std::size_t k = 0; k < count; ++k) {
        const V by_e = dot(n[k], e);
        const Three rest = n[k] - by_e * e;
        const V along = hn::Sub(by_e, error);
        const V tangent = hn::Div(hn::Add(hn::Sqrt(dot(rest, rest)), error), along);
        bounded = hn::And(bounded, hn::Gt(along, hn::Zero(d)));
        widest = hn::IfThenElse(hn::Lt(widest, tangent), tangent, widest);
    }
    return hn::IfThenElse(bounded, widest, hn::Inf(d));
}

HWY_INLINE Three set(const double* three) {
    const Doubles d;
    return {hn::Set(d, three[0]), hn::Set(d, three[1]), hn::Set(d, three[2])};
}

// NormalNet::error.
HWY_INLINE V error_of_net(const Three* p) {
    const Doubles d;
    V size = hn::Zero(d), most_u = size, most_v = size;
    for (int k = 0; k < 16; ++k)
        size = hn::Max(hn::Max(size, hn::Abs(p[k].x)), hn::Max(hn::Abs(p[k].y), hn::Abs(p[k].z)));
    for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 3; ++i) {
            const Three u = 3.0 * (p[4 * j + i + 1] - p[4 * j + i]);
            const Three v = 3.0 * (p[4 * (i + 1) + j] - p[4 * i + j]);
            most_u = hn::Max(most_u, dot(u, u));
            most_v = hn::Max(most_v, dot(v, v));
        }
    const V lengths = hn::Add(hn::Sqrt(most_u), hn::Sqrt(most_v));
    return hn::Mul(lengths, hn::Add(hn::Mul(size, hn::Set(d, net_error_by_size)),
                                    hn::Mul(lengths, hn::Set(d, net_error_by_length))));
}

void bezier_cones_kernel(const double* points, const double* axes, const double* normals,
                         std::size_t count, double* widest) {
    const Doubles d;
    for (std::size_t lane = 0; lane < count; lane += hn::Lanes(d)) {
        Three p[16], net[36];
        for (std::size_t c = 0; c < 16; ++c) p[c] = load(points + 3 * patches_at_once * c + lane);
        const V error = error_of_net(p);
        bicubic_normal_net(p, net);
        hn::StoreU(widest_of(net, 36, load(axes + lane), error), d, widest + lane);
        for (std::size_t corner = 0; corner < 3; ++corner)
            hn::StoreU(widest_of(net, 36, set(normals + 3 * corner), error), d,
                       widest + (corner + 1) * patches_at_once + lane);
    }
}

void bicubic_cones_kernel(const double* controls, const double* weights, const double* normal,
                          double* widest) {
    const Doubles d;
    for (std::size_t lane = 0; lane < patches_at_once; lane += hn::Lanes(d)) {
        Three in[16], half[16], points[16], net[36];
        for (std::size_t c = 0; c < 16; ++c)
            in[c] = load(controls + 3 * patches_at_once * c + lane);
        for (std::size_t l = 0; l < 4; ++l)
            for (std::size_t i = 0; i < 4; ++i) {
                const double* const w = weights + 4 * i;
                half[4 * l + i] =
                    ((w[0] * in[4 * l] + w[1] * in[4 * l + 1]) + w[2] * in[4 * l + 2]) +
                    w[3] * in[4 * l + 3];
            }
        for (std::size_t j = 0; j < 4; ++j)
            for (std::size_t i = 0; i < 4; ++i) {
                const double* const w = weights + 4 * j;
                points[4 * j + i] = ((w[0] * half[i] + w[1] * half[4 + i]) + w[2] * half[8 + i]) +
                                    w[3] * half[12 + i];
            }
        bicubic_normal_net(points, net);
        hn::StoreU(widest_of(net, 36, set(normal), hn::Zero(d)), d, widest + lane);
    }
}

void quartic_cones_kernel(const double* controls, const double* weights, const double* normal,
                          double* widest) {
    const Doubles d;
    for (std::size_t lane = 0; lane < patches_at_once; lane += hn::Lanes(d)) {
        Three in[12], points[15], by_u[10], by_v[10], net[28];
        for (std::size_t c = 0; c < 12; ++c)
            in[c] = load(controls + 3 * patches_at_once * c + lane);
        for (std::size_t k = 0; k < 15; ++k) {
            points[k] = Three(0.0);
            for (std::size_t c = 0; c < 12; ++c) points[k] += weights[12 * k + c] * in[c];
        }
        for (std::size_t j = 0, k = 0, row = 0; j < 4; row += 5 - j, ++j)
            for (std::size_t i = 0; i + j < 4; ++i, ++k) {
                by_u[k] = points[row + i + 1] - points[row + i];
                by_v[k] = points[row + 5 - j + i] - points[row + i];
            }
        quartic_normal_net(by_u, by_v, net);
        hn::StoreU(widest_of(net, 28, set(normal), hn::Zero(d)), d, widest + lane);
    }
}

}  // namespace prep::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace prep::detail {

void bezier_cones(const double* points, const double* axes, const double* normals,
                  std::size_t count, double* widest, SimdLevel simd) {
    SIMD_KERNEL(simd, bezier_cones_kernel)(points, axes, normals, count, widest);
}

void bicubic_cones(const double* controls, const double* weights, const double* normal,
                   double* widest, SimdLevel simd) {
    SIMD_KERNEL(simd, bicubic_cones_kernel)(controls, weights, normal, widest);
}

void quartic_cones(const double* controls, const double* weights, const double* normal,
                   double* widest, SimdLevel simd) {
    SIMD_KERNEL(simd, quartic_cones_kernel)(controls, weights, normal, widest);
}

}  // namespace prep::detail
#endif
