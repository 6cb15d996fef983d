#include "tangents/triangles.h"

#include <atomic>

#include "base/parallel.h"
#include "prep/triangulate.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;

bool all_triangles(std::span<const Index> offsets, int threads) {
    std::atomic<bool> all = true;
    parallel_blocks(offsets.size(), 1 << 17, threads, [&](std::size_t begin, std::size_t end) {
        // In 32 bits, as many at once as vectors hold; there are no more than 2^32 corners.
        Index other = 0, expected = Index(3 * begin);
        for (std::size_t f = begin; f < end; ++f, expected += 3) other |= offsets[f] ^ expected;
        if (other != 0) all = false;
    });
    return all;
}

// The shorter UV diagonal, then the shorter position diagonal, then 0–2.
bool cut_along_02(const CornerReader& read, Index begin) {
    const auto squared = [](const glm::vec2& d) { return d.x * d.x + d.y * d.y; };
    const float uv02 = squared(read.uv(begin + 2) - read.uv(begin));
    const float uv13 = squared(read.uv(begin + 3) - read.uv(begin + 1));
    if (uv02 < uv13) return true;
    if (uv13 < uv02) return false;
    const float p02 = mikk::length_squared(read.position(begin + 2) - read.position(begin));
    const float p13 = mikk::length_squared(read.position(begin + 3) - read.position(begin + 1));
    return !(p13 < p02);
}

}  // namespace

TangentTriangles tangent_triangles(const TangentInput& in, bool polygons, int threads) {
    TangentTriangles result;
    const std::size_t faces = in.face_offsets.empty() ? 0 : in.face_offsets.size() - 1;
    if (in.corner_vertices.size() == 3 * faces && all_triangles(in.face_offsets, threads)) {
        result.count = faces;
        return result;
    }
    const CornerReader read{in};
    const auto add = [&](Index a, Index b, Index c, std::uint8_t half) {
        result.corners.insert(result.corners.end(), {a, b, c});
        result.halves.push_back(half);
    };
    Triangulation cut;  // made only when there is a larger polygon
    std::size_t next = 0;
    result.corners.reserve(in.corner_vertices.size() * 3 / 2);
    result.halves.reserve(in.corner_vertices.size() / 2);
    for (Index f = 0; f < faces; ++f) {
        const Index begin = in.face_offsets[f], count = in.face_offsets[f + 1] - begin;
        if (count == 3) {
            add(begin, begin + 1, begin + 2, 0);
        } else if (count == 4) {
            result.any_quad = true;
            if (cut_along_02(read, begin)) {
                add(begin, begin + 1, begin + 2, 1);
                add(begin, begin + 2, begin + 3, 2);
            } else {
                add(begin, begin + 1, begin + 3, 1);
                add(begin + 1, begin + 2, begin + 3, 2);
            }
        } else if (count > 4 && polygons) {
            if (cut.triangle_faces.empty()) {
                MeshView view;
                view.positions = in.positions;
                view.face_offsets = in.face_offsets;
                view.corner_vertices = in.corner_vertices;
                cut = triangulate(view, threads);
            }
            while (cut.triangle_faces[next] < f) ++next;
            for (Index k = 0; k + 2 < count; ++k) {
                const Index* c = cut.corners.data() + 3 * (next + k);
                add(c[0], c[1], c[2], 0);
            }
        }
    }
    result.count = result.halves.size();
    return result;
}

}  // namespace prep::detail
