#include "base/simd_targets.h"
#include "normals/vertex_sums.h"
#include "prep/corner_normals.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "normals/vertex_sum_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <array>
#include <cmath>

HWY_BEFORE_NAMESPACE();
namespace prep::detail::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// Vectors of four doubles are there from AVX2 on.
#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3
#define PREP_FOUR_LANES 1
#else
#define PREP_FOUR_LANES 0
#endif

// Where the three vertices of a triangle have their sums.
template <class T>
HWY_INLINE std::array<std::size_t, 3> places_of(const SumTable<T>& table,
                                                const std::uint32_t* vertices) {
    const auto place = [&](std::uint32_t v) {
        return table.page_places[v / page_vertices] + v % page_vertices;
    };
    return {place(vertices[0]), place(vertices[1]), place(vertices[2])};
}

HWY_INLINE unsigned components_of(bool z, bool x, bool y) {
    return (z ? component_z : 0u) | (x ? component_x : 0u) | (y ? component_y : 0u);
}

template <class T>
HWY_INLINE unsigned add_one_by_one(const glm::vec3* positions, const std::uint32_t* vertices,
                                   std::size_t triangles, const SumTable<T>& table) {
    bool any_z = false, any_x = false, any_y = false;
    bool differs_z = false, differs_x = false, differs_y = false;
    for (std::size_t t = 0; t < triangles; ++t, vertices += 3) {
        const glm::vec<3, T> p(positions[vertices[0]]);
        const glm::vec<3, T> a = glm::vec<3, T>(positions[vertices[1]]) - p;
        const glm::vec<3, T> b = glm::vec<3, T>(positions[vertices[2]]) - p;
        const T uz = a.x * b.y, wz = a.y * b.x, ux = a.y * b.z, wx = a.z * b.y, uy = a.z * b.x,
                wy = a.x * b.z;
        const T sz = std::abs(uz) + std::abs(wz), sx = std::abs(ux) + std::abs(wx),
                sy = std::abs(uy) + std::abs(wy);
        any_z |= sz != 0;
        any_x |= sx != 0;
        any_y |= sy != 0;
        differs_z |= uz != wz;
        differs_x |= ux != wx;
        differs_y |= uy != wy;
        for (const std::size_t place : places_of(table, vertices)) {
            AreaSum<T>& sum = table.sums[place];
            sum.z += uz - wz;
            sum.x += ux - wx;
            sum.y += uy - wy;
            sum.size += (sz + sx) + sy;
            ++table.counts[place];
        }
    }
    return components_of(any_z, any_x, any_y) |
           differs * components_of(differs_z, differs_x, differs_y);
}

#if PREP_FOUR_LANES
template <int a, int b, int c, int e, class D, class V>
HWY_INLINE V lanes_of(D d, V v) {
    constexpr hn::TFromD<hn::RebindToSigned<D>> lanes[4] = {a, b, c, e};
    return hn::TableLookupLanes(v, hn::SetTableIndices(d, lanes));
}
// y, z and x of a vector.
template <class D, class V>
HWY_INLINE V turned(D d, V v) {
    return lanes_of<1, 2, 0, 3>(d, v);
}

template <class D>
HWY_INLINE auto load_point(D d, const glm::vec3& point) {
    if constexpr (sizeof(hn::TFromD<D>) == sizeof(float))
        return hn::LoadU(d, &point.x);
    else
        return hn::PromoteTo(d, hn::LoadU(hn::Rebind<float, D>(), &point.x));
}

template <class T>
HWY_INLINE unsigned add_by_vectors(const glm::vec3* positions, const std::uint32_t* vertices,
                                   std::size_t triangles, const SumTable<T>& table) {
    const hn::FixedTag<T, 4> d;
    const auto first_three = hn::FirstN(d, 3);
    auto any = hn::Zero(d), any_difference = hn::Zero(d);
    for (std::size_t t = 0; t < triangles; ++t, vertices += 3) {
        // The fourth lanes are of the next position.
        const auto p = load_point(d, positions[vertices[0]]);
        const auto a = hn::Sub(load_point(d, positions[vertices[1]]), p);
        const auto b = hn::Sub(load_point(d, positions[vertices[2]]), p);
        const auto u = hn::Mul(a, turned(d, b)), w = hn::Mul(turned(d, a), b);
        const auto sizes = hn::Add(hn::Abs(u), hn::Abs(w));
        const auto difference = hn::Sub(u, w);
        any = hn::Or(any, sizes);
        any_difference = hn::Or(any_difference, difference);
        // The sum of three comes out in the first lane, and goes to the fourth.
        const auto second = turned(d, sizes);
        const auto size = hn::Add(hn::Add(sizes, second), turned(d, second));
        const auto term = hn::IfThenElse(first_three, difference, lanes_of<0, 0, 0, 0>(d, size));
        for (const std::size_t place : places_of(table, vertices)) {
            T* const sum = &table.sums[place].z;
            hn::Store(hn::Add(hn::Load(d, sum), term), d, sum);
            ++table.counts[place];
        }
    }
    const auto bits = [&](auto v) {
        alignas(64) T found[4];
        hn::Store(v, d, found);
        return components_of(found[0] != 0, found[1] != 0, found[2] != 0);
    };
    return bits(any) | differs * bits(any_difference);
}
#endif

template <class T>
HWY_INLINE unsigned add_triangles(const glm::vec3* positions, const std::uint32_t* vertices,
                                  std::size_t triangles, bool reads_behind,
                                  const SumTable<T>& table) {
#if PREP_FOUR_LANES
    if (reads_behind) return add_by_vectors(positions, vertices, triangles, table);
#else
    (void)reads_behind;
#endif
    return add_one_by_one(positions, vertices, triangles, table);
}

// NaN in any of a sum makes every comparison fail, and the vertex one of those that are open.
HWY_INLINE bool is_open(const AreaSum<double>& sum, std::uint32_t count, double length,
                        const glm::dvec3& normal, unsigned components) {
    constexpr double of_sum = 0x1p-43, of_size = 0x1p-43, of_count = 0x1p-51, of_unit = 0x1p-50;
    const double error =
        of_sum + of_unit + (of_size + double(count) * of_count) * (sum.size / length);
    const unsigned present = sum.size <= 32 * length ? components / differs : components;
    const auto told = [&](double x, unsigned component) {
        return int(float(x - error) == float(x + error)) | int((present & component) == 0);
    };
    return (told(normal.x, component_x) & told(normal.y, component_y) &
            told(normal.z, component_z) & int(length > 0)) == 0;
}

HWY_INLINE bool is_open(const AreaSum<float>& sum, std::uint32_t count, double length,
                        const glm::dvec3& /*normal*/, unsigned /*components*/) {
    const double error = (double(count) + 6) * 0x1p-24 * double(sum.size);
    // The range keeps what underflows far below the rest.
    return !((error <= fast_normal_error * 0.99 * length) & (sum.size >= 0x1p-90f) &
             (sum.size <= 0x1p120f));
}

// Normals of a page's vertices from number `i` on, and a bit for each that is open.
template <class T>
HWY_INLINE void finish_one_by_one(const AreaSum<T>* sums, const std::uint32_t* counts,
                                  std::size_t i, std::size_t count, unsigned components,
                                  glm::vec3* normals, std::uint64_t& open) {
    for (; i < count; ++i) {
        const AreaSum<T>& sum = sums[i];
        const glm::dvec3 total(sum.x, sum.y, sum.z);
        const double length = std::sqrt(total.x * total.x + total.y * total.y + total.z * total.z);
        const double scale = 1 / length;
        const glm::dvec3 normal(total.x * scale, total.y * scale, total.z * scale);
        normals[i] = glm::vec3(float(normal.x), float(normal.y), float(normal.z));
        open |= std::uint64_t(is_open(sum, counts[i], length, normal, components)) << i;
    }
}

#if HWY_TARGET != HWY_SCALAR && !HWY_HAVE_SCALABLE
#define PREP_MANY_LANES 1
#else
#define PREP_MANY_LANES 0
#endif

#if PREP_MANY_LANES
// Numbers below 2³², exactly.
template <class D>
HWY_INLINE auto counts_at(D d, const std::uint32_t* counts) {
    const hn::Rebind<std::uint32_t, D> du;
    const hn::RebindToSigned<decltype(du)> di;
    const auto number = hn::LoadU(du, counts);
    const auto low = hn::PromoteTo(d, hn::BitCast(di, hn::And(number, hn::Set(du, 0xffff))));
    const auto high = hn::PromoteTo(d, hn::BitCast(di, hn::ShiftRight<16>(number)));
    return hn::Add(hn::Mul(high, hn::Set(d, 65536.0)), low);
}

template <class D, class V>
struct Sums {
    V z, x, y, size;
};
template <class D>
HWY_INLINE auto sums_at(D d, const AreaSum<double>* sums) {
    hn::Vec<D> z, x, y, size;
    hn::LoadInterleaved4(d, &sums->z, z, x, y, size);
    return Sums<D, hn::Vec<D>>{z, x, y, size};
}
template <class D>
HWY_INLINE auto sums_at(D d, const AreaSum<float>* sums) {
    const hn::Rebind<float, D> df;
    hn::Vec<decltype(df)> z, x, y, size;
    hn::LoadInterleaved4(df, &sums->z, z, x, y, size);
    return Sums<D, hn::Vec<D>>{hn::PromoteTo(d, z), hn::PromoteTo(d, x), hn::PromoteTo(d, y),
                               hn::PromoteTo(d, size)};
}

// is_open(), the other way round, of several vertices at once.
template <class D, class V>
HWY_INLINE auto are_told(D d, const Sums<D, V>& sum, V count, V length, const Sums<D, V>& normal,
                         unsigned components, double) {
    const auto number = [&](double value) { return hn::Set(d, value); };
    const auto of_size = hn::Add(number(0x1p-43), hn::Mul(count, number(0x1p-51)));
    const auto error =
        hn::Add(number(0x1p-43 + 0x1p-50), hn::Mul(of_size, hn::Div(sum.size, length)));
    const auto differing = hn::Le(sum.size, hn::Mul(number(32), length));
    const hn::Rebind<float, D> df;
    const auto told = [&](V x, unsigned component) {
        const auto low = hn::PromoteTo(d, hn::DemoteTo(df, hn::Sub(x, error)));
        const auto high = hn::PromoteTo(d, hn::DemoteTo(df, hn::Add(x, error)));
        const auto none = hn::MaskFromVec(hn::Zero(d)), all = hn::Not(none);
        const auto absent = hn::IfThenElse(
            differing, hn::VecFromMask(d, (components / differs & component) == 0 ? all : none),
            hn::VecFromMask(d, (components & component) == 0 ? all : none));
        return hn::Or(hn::Eq(low, high), hn::MaskFromVec(absent));
    };
    return hn::And(hn::And(told(normal.x, component_x), told(normal.y, component_y)),
                   hn::And(told(normal.z, component_z), hn::Gt(length, hn::Zero(d))));
}
template <class D, class V>
HWY_INLINE auto are_told(D d, const Sums<D, V>& sum, V count, V length,
                         const Sums<D, V>& /*normal*/, unsigned /*components*/, float) {
    const auto number = [&](double value) { return hn::Set(d, value); };
    const auto error = hn::Mul(hn::Mul(hn::Add(count, number(6)), number(0x1p-24)), sum.size);
    return hn::And(hn::Le(error, hn::Mul(number(fast_normal_error * 0.99), length)),
                   hn::And(hn::Ge(sum.size, number(0x1p-90)), hn::Le(sum.size, number(0x1p120))));
}

// Whole vectors of the page; returns how many vertices that is.
template <class T>
HWY_INLINE std::size_t finish_by_vectors(const AreaSum<T>* sums, const std::uint32_t* counts,
                                         std::size_t count, unsigned components, glm::vec3* normals,
                                         std::uint64_t& open) {
    const hn::ScalableTag<double> d;
    const hn::Rebind<float, decltype(d)> df;
    constexpr std::size_t lanes = hn::MaxLanes(d);
    static_assert(lanes <= 8, "a byte of mask");
    std::size_t i = 0;
    for (; i + lanes <= count; i += lanes) {
        const auto sum = sums_at(d, sums + i);
        const auto length = hn::Sqrt(
            hn::Add(hn::Add(hn::Mul(sum.x, sum.x), hn::Mul(sum.y, sum.y)), hn::Mul(sum.z, sum.z)));
        const auto scale = hn::Div(hn::Set(d, 1.0), length);
        decltype(sum) normal{hn::Mul(sum.z, scale), hn::Mul(sum.x, scale), hn::Mul(sum.y, scale),
                             scale};
        hn::StoreInterleaved3(hn::DemoteTo(df, normal.x), hn::DemoteTo(df, normal.y),
                              hn::DemoteTo(df, normal.z), df, &normals[i].x);
        const auto told =
            are_told(d, sum, counts_at(d, counts + i), length, normal, components, T());
        std::uint8_t bits[8] = {};
        hn::StoreMaskBits(d, hn::Not(told), bits);
        open |= std::uint64_t(bits[0]) << i;
    }
    return i;
}
#endif

template <class T>
HWY_INLINE std::uint64_t finish(const AreaSum<T>* sums, const std::uint32_t* counts,
                                std::size_t count, unsigned components, glm::vec3* normals) {
    std::uint64_t open = 0;
    std::size_t done = 0;
#if PREP_MANY_LANES
    done = finish_by_vectors(sums, counts, count, components, normals, open);
#endif
    finish_one_by_one(sums, counts, done, count, components, normals, open);
    for (std::uint64_t rest = open; rest != 0; rest &= rest - 1) {
        const auto i = std::size_t(hwy::Num0BitsBelowLS1Bit_Nonzero64(rest));
        normals[i] = {0, 0, 1};
        if (counts[i] == 0) open &= ~(std::uint64_t(1) << i);
    }
    return open;
}

}  // namespace

unsigned add_doubles(const glm::vec3* positions, const std::uint32_t* vertices,
                     std::size_t triangles, bool reads_behind, const SumTable<double>& table) {
    return add_triangles(positions, vertices, triangles, reads_behind, table);
}
unsigned add_floats(const glm::vec3* positions, const std::uint32_t* vertices,
                    std::size_t triangles, bool reads_behind, const SumTable<float>& table) {
    return add_triangles(positions, vertices, triangles, reads_behind, table);
}
std::uint64_t finish_doubles(const AreaSum<double>* sums, const std::uint32_t* counts,
                             std::size_t count, unsigned components, glm::vec3* normals) {
    return finish(sums, counts, count, components, normals);
}
std::uint64_t finish_floats(const AreaSum<float>* sums, const std::uint32_t* counts,
                            std::size_t count, unsigned components, glm::vec3* normals) {
    return finish(sums, counts, count, components, normals);
}

#undef PREP_MANY_LANES
#undef PREP_FOUR_LANES

}  // namespace prep::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace prep::detail {

SumKernel<double> double_sum_kernel(SimdLevel level) {
    return SIMD_KERNEL(level, add_doubles);
}
SumKernel<float> float_sum_kernel(SimdLevel level) {
    return SIMD_KERNEL(level, add_floats);
}
FinishKernel<double> double_finish_kernel(SimdLevel level) {
    return SIMD_KERNEL(level, finish_doubles);
}
FinishKernel<float> float_finish_kernel(SimdLevel level) {
    return SIMD_KERNEL(level, finish_floats);
}

}  // namespace prep::detail
#endif
