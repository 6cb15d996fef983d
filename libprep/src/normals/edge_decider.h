// Whether one edge between two faces is hard, and why.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <utility>
#include <vector>

#include "exact/exact_normals.h"
#include "normals/area_vector.h"
#include "prep/hard_edges.h"
#include "surface/edge_key.h"

namespace prep::detail {

class EdgeDecider {
    using Index = std::uint32_t;

  public:
    // `welded`: Topology's, or empty where every vertex is its own point; `stand_ins`:
    // stand_in_faces().
    EdgeDecider(const MeshView& mesh, std::span<const Index> welded, const FaceNormals& faces,
                const HardEdgeOptions& options, std::vector<Index> stand_ins)
        : mesh_(mesh),
          welded_(welded),
          faces_(faces),
          options_(options),
          stand_ins_(std::move(stand_ins)),
          exact_(mesh) {
        if (options.angle_degrees) threshold_ = threshold_of(*options.angle_degrees);
        if (options.marks) mark_edges();
        grouped_ = options.smoothing_groups && !mesh.face_smoothing.empty();
    }

    // Of half-edge `corner` of face f, whose opposite is `other` of face g; the same from either
    // side. `exact` counts decisions that the filter left open.
    std::uint8_t reasons(Index corner, Index f, Index other, Index g, std::uint64_t& exact) const {
        if (faces_.states[f] == FaceState::non_finite || faces_.states[g] == FaceState::non_finite)
            return hard_border;
        unsigned found = hard_none;
        bool use_angle = options_.angle_degrees.has_value();
        if (grouped_) {
            if (!in_common_group(mesh_.face_smoothing[f], mesh_.face_smoothing[g]))
                found |= hard_smoothing_group;
            use_angle &= options_.angle_inside_groups;
        }
        if (use_angle && turn_exceeds(f, g, exact)) found |= hard_angle;
        if (!marks_.empty() && is_marked(corner, f)) found |= hard_mark;
        if (options_.material_borders && !mesh_.face_materials.empty() &&
            mesh_.face_materials[f] != mesh_.face_materials[g])
            found |= hard_material;
        if (options_.uv_borders && !mesh_.uv.empty() && uv_differs(corner, f, other, g))
            found |= hard_uv_border;
        return std::uint8_t(found);
    }

    // No edge is hard but by its angle, nor smooth but by it.
    bool by_angle_alone() const { return options_.angle_degrees && !by_attributes(); }
    // No edge between two finite faces is hard.
    bool never_hard() const { return !options_.angle_degrees && !by_attributes(); }
    double cosine() const { return threshold_.cosine.cosine; }

  private:
    static constexpr float infinitely_sharp = 10.0f;  // OpenSubdiv's SHARPNESS_INFINITE

    bool by_attributes() const {
        return grouped_ || !marks_.empty() ||
               (options_.material_borders && !mesh_.face_materials.empty()) ||
               (options_.uv_borders && !mesh_.uv.empty());
    }

    bool in_common_group(std::uint32_t a, std::uint32_t b) const {
        if (mesh_.smoothing_kind == SmoothingKind::bit_mask) return (a & b) != 0;
        return a == b && a != 0;
    }

    bool turn_exceeds(Index f, Index g, std::uint64_t& exact) const {
        if (!stand_ins_.empty()) {
            f = stand_ins_[f];
            g = stand_ins_[g];
            if (f == g || f == no_index || g == no_index) return false;
        }
        const Verdict verdict =
            classify(faces_.area_vectors[f], faces_.area_vectors[g], faces_.relative_error);
        if (verdict != Verdict::open) return verdict == Verdict::exceeds;
        // Of many corners: the exact ones are made once.
        if (faces_.relative_error > accurate_face_error && !has_many_corners(mesh_, f) &&
            !has_many_corners(mesh_, g)) {
            const Verdict closer = classify(accurate_area_vector(mesh_, f),
                                            accurate_area_vector(mesh_, g), accurate_face_error);
            if (closer != Verdict::open) return closer == Verdict::exceeds;
        }
        ++exact;
        return exact_.turn_exceeds(f, g, threshold_);
    }

    enum class Verdict { exceeds, stays, open };
    Verdict classify(const glm::dvec3& a, const glm::dvec3& b, double relative_error) const {
        const double product = glm::length(a) * glm::length(b);
        const double gap = glm::dot(a, b) - threshold_.cosine.cosine * product;
        // Rounding of the dot product, the lengths and the cosine: under 8 ulps of |a||b|; the
        // vectors' own errors enter through the dot product and through the lengths.
        const double error = (8 * 0x1p-52 + 5 * relative_error) * product;
        return gap < -error ? Verdict::exceeds : gap > error ? Verdict::stays : Verdict::open;
    }

    Index point(Index vertex) const { return welded_.empty() ? vertex : welded_[vertex]; }
    std::uint64_t key(Index a, Index b) const { return edge_key(point(a), point(b)); }
    void mark_edges() {
        const auto add = [&](Index a, Index b) {
            if (a < mesh_.positions.size() && b < mesh_.positions.size())
                marks_.push_back(key(a, b));
        };
        for (const glm::uvec2& e : mesh_.hard_marks) add(e.x, e.y);
        for (const EdgeMark& e : mesh_.creases)
            if (e.sharpness >= infinitely_sharp) add(e.v0, e.v1);
        std::sort(marks_.begin(), marks_.end());
    }
    bool is_marked(Index corner, Index face) const {
        const Index next = next_corner(mesh_.face_offsets, face, corner);
        return std::binary_search(marks_.begin(), marks_.end(),
                                  key(mesh_.corner_vertices[corner], mesh_.corner_vertices[next]));
    }

    bool uv_differs(Index corner, Index f, Index other, Index g) const {
        const auto same = [&](Index c, Index d) {
            const Index i = mesh_.uv.indices[c], j = mesh_.uv.indices[d];
            if (i == j) return true;
            if (i == no_index || j == no_index) return false;
            return mesh_.uv.values[i] == mesh_.uv.values[j];
        };
        return !same(corner, next_corner(mesh_.face_offsets, g, other)) ||
               !same(next_corner(mesh_.face_offsets, f, corner), other);
    }

    const MeshView& mesh_;
    std::span<const Index> welded_;
    const FaceNormals& faces_;
    const HardEdgeOptions& options_;
    std::vector<Index> stand_ins_;
    ExactFaces exact_;
    Threshold threshold_;
    std::vector<std::uint64_t> marks_;  // pairs of points, packed, ascending
    bool grouped_ = false;
};

}  // namespace prep::detail
