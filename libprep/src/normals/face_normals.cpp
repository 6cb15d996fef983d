#include "prep/face_normals.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "exact/exact_normals.h"
#include "normals/area_vector.h"
#include "normals/triangle_areas.h"
#include "surface/vertex_corners.h"

namespace prep {
namespace {

using Index = std::uint32_t;
constexpr std::size_t face_grain = 16384;

// The sum of finite floats in double is finite: it cannot overflow.
bool all_finite(const MeshView& mesh, Index begin, Index end) {
    double sum = 0;
    for (Index c = begin; c < end; ++c) {
        const glm::vec3& p = mesh.positions[mesh.corner_vertices[c]];
        sum += (double(p.x) + double(p.y)) + double(p.z);
    }
    return std::isfinite(sum);
}

class FaceMaker {
  public:
    // near: neighbours_are_near().
    FaceMaker(const MeshView& mesh, Precision precision, bool near, FaceNormals& result)
        : mesh_(mesh), precision_(precision), near_(near), result_(result) {}

    void compute(Index face) {
        const Index begin = mesh_.face_offsets[face], end = mesh_.face_offsets[face + 1];
        if (!all_finite(mesh_, begin, end)) {
            result_.states[face] = FaceState::non_finite;
            return;
        }
        const glm::dvec3 area = area_vector(face);
        result_.area_vectors[face] = area;
        if (area == glm::dvec3(0.0)) result_.states[face] = FaceState::zero_area;
    }

    // compute() for triangles, of which plain doubles can do nearly all.
    void compute_triangles(Index first, Index last) {
        const glm::vec3* const positions = mesh_.positions.data();
        const Index* corners = mesh_.corner_vertices.data() + 3 * std::size_t(first);
        // Far enough for memory, near enough for the first-level cache.
        constexpr std::size_t ahead = 24;
        const Index fetched = near_ || last - first <= ahead ? first : Index(last - ahead);
        for (Index face = first; face < last; ++face, corners += 3) {
            if (face < fetched)
                for (std::size_t k = 3 * ahead; k < 3 * ahead + 3; ++k)
                    __builtin_prefetch(positions + corners[k]);
            const detail::AreaVector area = detail::plain_triangle_area(
                positions[corners[0]], positions[corners[1]], positions[corners[2]]);
            const double length = detail::largest_component(area.value);
            // Where a position is not finite, the error is infinite or NaN, or the area's x is NaN
            // and with it the largest component: one of the comparisons fails.
            if (area.error <= accurate_face_error * length && length > 0 &&
                length <= std::numeric_limits<double>::max())
                result_.area_vectors[face] = area.value;
            else
                compute(face);
        }
    }

    // Many triangles at once, in floats; those that floats cannot do go the scalar way.
    void compute_fast(Index first, Index last) {
        std::vector<Index> left_over;
        detail::triangle_areas(mesh_.positions, mesh_.corner_vertices, first, last,
                               result_.area_vectors, left_over);
        for (const Index face : left_over) compute(face);
    }

    std::uint64_t exact_faces() const { return exact_faces_; }

  private:
    glm::dvec3 area_vector(Index face) {
        if (precision_ == Precision::exact) {
            ++exact_faces_;
            return detail::exact_area_vector(mesh_, face);
        }
        if (precision_ == Precision::fast) {
            const detail::AreaVector area = detail::plain_area_vector(mesh_, face);
            if (area.error <= fast_face_error * detail::largest_component(area.value))
                return area.value;
        }
        return detail::accurate_area_vector(mesh_, face, &exact_faces_);
    }

    const MeshView& mesh_;
    Precision precision_;
    bool near_;
    FaceNormals& result_;
    std::uint64_t exact_faces_ = 0;
};

}  // namespace

FaceNormals face_normals(const MeshView& mesh, Precision precision, int threads) {
    const std::size_t faces = mesh.face_count();
    FaceNormals result;
    result.area_vectors.assign(faces, glm::dvec3(0.0));
    result.states.assign(faces, FaceState::regular);
    result.relative_error = precision == Precision::fast       ? fast_face_error
                            : precision == Precision::accurate ? accurate_face_error
                                                               : exact_face_error;
    const bool triangles = mesh.corner_count() == 3 * mesh.face_count();
    const bool near = detail::neighbours_are_near(mesh.corner_vertices);
    std::atomic<std::uint64_t> exact_faces{0};
    detail::parallel_blocks(faces, face_grain, threads, [&](std::size_t first, std::size_t last) {
        FaceMaker maker(mesh, precision, near, result);
        if (triangles && precision == Precision::fast)
            maker.compute_fast(Index(first), Index(last));
        else if (triangles && precision == Precision::accurate)
            maker.compute_triangles(Index(first), Index(last));
        else
            for (std::size_t f = first; f < last; ++f) maker.compute(Index(f));
        exact_faces += maker.exact_faces();
    });
    result.exact_faces = exact_faces;
    return result;
}

}  // namespace prep
