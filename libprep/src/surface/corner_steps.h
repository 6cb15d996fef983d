// Stepping from corner to corner of a face: by arithmetic where every face is a triangle, by the
// offsets elsewhere. Hot loops take one of the two as a template argument.
#pragma once

#include <cstdint>
#include <span>

#include "prep/mesh.h"

namespace prep::detail {

struct TriangleSteps {
    std::uint32_t face(std::uint32_t c) const { return c / 3; }
    std::uint32_t next(std::uint32_t c) const { return c % 3 == 2 ? c - 2 : c + 1; }
    std::uint32_t previous(std::uint32_t c) const { return c % 3 == 0 ? c + 2 : c - 1; }
    std::uint32_t begin(std::uint32_t face) const { return 3 * face; }
    std::uint32_t end(std::uint32_t face) const { return 3 * face + 3; }
};

struct PolygonSteps {
    std::span<const std::uint32_t> offsets, corner_faces;
    std::uint32_t face(std::uint32_t c) const { return corner_faces[c]; }
    std::uint32_t next(std::uint32_t c) const {
        const std::uint32_t f = corner_faces[c];
        return c + 1 == offsets[f + 1] ? offsets[f] : c + 1;
    }
    std::uint32_t previous(std::uint32_t c) const {
        const std::uint32_t f = corner_faces[c];
        return c == offsets[f] ? offsets[f + 1] - 1 : c - 1;
    }
    std::uint32_t begin(std::uint32_t face) const { return offsets[face]; }
    std::uint32_t end(std::uint32_t face) const { return offsets[face + 1]; }
};

// Faces have three corners at least, so that the totals tell.
inline bool all_triangles(const MeshView& mesh) {
    return mesh.corner_count() == 3 * mesh.face_count();
}

// work(steps) with the steps that fit the mesh.
template <class Work>
auto with_steps(const MeshView& mesh, std::span<const std::uint32_t> corner_faces,
                const Work& work) {
    if (all_triangles(mesh)) return work(TriangleSteps{});
    return work(PolygonSteps{mesh.face_offsets, corner_faces});
}

}  // namespace prep::detail
