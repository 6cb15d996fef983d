// Area vectors of triangles added up at their vertices, as triangles go by.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>

#include "prep/simd.h"

namespace prep::detail {

// Vertices come in pages of neighbours in number; sums are kept page by page.
inline constexpr std::size_t page_vertices = 64;

// Twice the areas' vectors, and the products that they were made of: with terms u − w in each
// component, `size` is the sum of all |u| + |w|. The order of the components is how a cross product
// comes out of vectors.
template <class T>
struct alignas(4 * sizeof(T)) AreaSum {
    T z = 0, x = 0, y = 0, size = 0;
};

// What a vertex has got.
template <class T>
struct SumTable {
    const std::uint32_t* page_places;  // per page of the mesh, where it begins in what follows
    AreaSum<T>* sums;
    std::uint32_t* counts;  // corners
};

// Bits of a component: u or w of any triangle is not zero; and these times `differs`: their
// difference is not zero.
enum Component : unsigned { component_z = 1, component_x = 2, component_y = 4, differs = 8 };
inline constexpr unsigned all_components = component_z | component_x | component_y;

// Adds triangles, three vertices each. Gives the components that are more than sums of zeros.
// reads_behind: there is a float behind each of the positions. The same bits from every level.
template <class T>
using SumKernel = unsigned (*)(const glm::vec3* positions, const std::uint32_t* vertices,
                               std::size_t triangles, bool reads_behind, const SumTable<T>& table);
SumKernel<double> double_sum_kernel(SimdLevel level);
SumKernel<float> float_sum_kernel(SimdLevel level);

// Writes the unit normals of `count` vertices, up to a page, (0, 0, 1) where no corner was counted.
// Gives a bit for each that the sum does not determine. `components`: as above, of all triangles at
// these vertices.
//
// Doubles: set where corner_normals' accurate way could give another float. Its sum and this one
// are of the same terms but where doubles did not do for a face, and differ by
//     2⁻⁴⁵ of the sum       its order-free rounding, at most
//     2⁻⁴⁵ of `size`        its faces' errors
//     (count + 5) · 2⁻⁵³ of `size`   the roundings here: products, differences, additions
// of which twice at most, over the length, comes to the unit vector. A component without products
// is zero in both. One whose products are equal is where the faces' own doubles are these (the
// caller sets the bits of others), and their sum is good enough: `size` at most 32 lengths (beyond
// some 70 the accurate way sums exactly). Floats: set where the bound on the error is above
// fast_normal_error, or floats left their range.
template <class T>
using FinishKernel = std::uint64_t (*)(const AreaSum<T>* sums, const std::uint32_t* counts,
                                       std::size_t count, unsigned components, glm::vec3* normals);
FinishKernel<double> double_finish_kernel(SimdLevel level);
FinishKernel<float> float_finish_kernel(SimdLevel level);

}  // namespace prep::detail
