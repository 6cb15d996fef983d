#include "prep/corner_normals.h"

#include <algorithm>
#include <cmath>

#include "difference_of_products.h"
#include "exact_normals.h"
#include "parallel.h"

namespace prep {
namespace {

using Index = std::uint32_t;
constexpr std::size_t point_grain = 8192;

// Order-free sum of vectors: each is rounded to a multiple of one quantum that depends only on the
// largest component and the number of vectors, and integers add up the same in any order.
class FanSum {
  public:
    void clear() { vectors_.clear(); }
    void add(const glm::dvec3& v) { vectors_.push_back(v); }
    std::size_t size() const { return vectors_.size(); }

    struct Sum {
        glm::dvec3 value{0.0};  // scaled by some power of two
        bool trusted = false;   // false: what is left is no larger than the terms' own rounding
    };

    Sum sum() const {
        double largest = 0;
        for (const glm::dvec3& v : vectors_)
            largest = std::max({largest, std::abs(v.x), std::abs(v.y), std::abs(v.z)});
        if (!(largest > 0)) return {};
        const int exponent = std::ilogb(largest) + 1;
        if (vectors_.size() <= small_fan) {
            // 56 bits a term and up to 64 terms fit 63 bits. Unless most of it cancels, half a
            // quantum a term is below 2^-44 of the sum.
            const glm::dvec3 s = quantised<std::int64_t>(56 - exponent);
            if (max_component(s) >= 0x1p50) return {s, true};
        }
        const glm::dvec3 s = quantised<__int128>(90 - exponent);
        // Terms carry 53 bits, so what is left below 2^-50 of the largest is noise.
        return {s, max_component(s) >= 0x1p40 * double(vectors_.size())};
    }

  private:
    static constexpr std::size_t small_fan = 64;

    static double max_component(const glm::dvec3& v) {
        return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    }

    template <class Integer>
    glm::dvec3 quantised(int shift) const {
        Integer sum[3] = {0, 0, 0};
        // Scaling in two steps: 2^shift alone can leave double's range.
        const double scale0 = std::ldexp(1.0, shift / 2),
                     scale1 = std::ldexp(1.0, shift - shift / 2);
        for (const glm::dvec3& v : vectors_)
            for (int k = 0; k < 3; ++k) sum[k] += Integer(std::rint(v[k] * scale0 * scale1));
        return {double(sum[0]), double(sum[1]), double(sum[2])};
    }

    std::vector<glm::dvec3> vectors_;
};

glm::dvec3 unit(const glm::dvec3& v) {
    const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    const glm::dvec3 scaled = v / largest;
    return scaled / std::sqrt(glm::dot(scaled, scaled));
}

// One block of points: fans found, normals computed, in order.
struct Block {
    std::vector<glm::vec3> values;
    std::vector<CornerNormals::Fallback> fallbacks;
};

class FanWalker {
  public:
    FanWalker(const MeshView& mesh, const Topology& topology, const HardEdges& hard)
        : mesh_(mesh), topology_(topology), hard_(hard) {}

    // All corners of the fan that `start` is in, each once, in no particular order.
    void collect(Index start, std::vector<Index>& corners) const {
        corners.clear();
        corners.push_back(start);
        for (Index c = across_outgoing(start); c != no_index; c = across_outgoing(c)) {
            if (c == start) return;  // once around
            corners.push_back(c);
        }
        for (Index c = across_incoming(start); c != no_index; c = across_incoming(c))
            corners.push_back(c);
    }

  private:
    // The next corner at the same point, over the edge that leaves this one; no_index at a hard
    // edge.
    Index across_outgoing(Index c) const {
        const Index face = topology_.corner_faces[c];
        if (topology_.kinds[c] == EdgeKind::degenerate)
            return next_corner(mesh_.face_offsets, face, c);
        const Index other = topology_.opposite[c];
        if (other == no_index || hard_.reasons[c] != hard_none) return no_index;
        return next_corner(mesh_.face_offsets, topology_.corner_faces[other], other);
    }
    Index across_incoming(Index c) const {
        const Index face = topology_.corner_faces[c];
        const Index incoming = previous_corner(mesh_.face_offsets, face, c);
        if (topology_.kinds[incoming] == EdgeKind::degenerate) return incoming;
        const Index other = topology_.opposite[incoming];
        if (other == no_index || hard_.reasons[incoming] != hard_none) return no_index;
        return other;
    }

    const MeshView& mesh_;
    const Topology& topology_;
    const HardEdges& hard_;
};

class Weigher {
  public:
    Weigher(const MeshView& mesh, const Topology& topology, const FaceNormals& faces,
            NormalWeight weight)
        : mesh_(mesh), topology_(topology), faces_(faces), weight_(weight) {}

    // The corner's term of the sum: its face's normal, weighted.
    glm::dvec3 term(Index corner) const {
        const Index face = topology_.corner_faces[corner];
        const glm::dvec3& area = faces_.area_vectors[face];
        if (weight_ == NormalWeight::area || faces_.states[face] != FaceState::regular) return area;
        const glm::dvec3 normal = unit(area);
        if (weight_ == NormalWeight::uniform) return normal;

        const auto at = [&](Index c) {
            return glm::dvec3(mesh_.positions[mesh_.corner_vertices[c]]);
        };
        const glm::dvec3 p = at(corner);
        const glm::dvec3 e1 = at(next_corner(mesh_.face_offsets, face, corner)) - p;
        const glm::dvec3 e2 = at(previous_corner(mesh_.face_offsets, face, corner)) - p;
        const glm::dvec3 cross = detail::accurate_cross(e1, e2);
        const double sine = glm::length(cross);  // times |e1||e2|
        if (weight_ == NormalWeight::edge_length) {
            const double l1 = glm::dot(e1, e1), l2 = glm::dot(e2, e2);
            return l1 > 0 && l2 > 0 ? normal * (sine / l1 / l2) : glm::dvec3(0.0);
        }
        // A concave corner turns the other way than its polygon: its angle is the reflex one.
        double angle = std::atan2(sine, glm::dot(e1, e2));
        if (glm::dot(cross, normal) < 0) angle = 2 * pi - angle;
        return (weight_ == NormalWeight::angle ? normal : area) * angle;
    }

  private:
    static constexpr double pi = 3.14159265358979323846;
    const MeshView& mesh_;
    const Topology& topology_;
    const FaceNormals& faces_;
    NormalWeight weight_;
};

class NormalMaker {
  public:
    NormalMaker(const MeshView& mesh, const Topology& topology, const FaceNormals& faces,
                const NormalOptions& options)
        : mesh_(mesh),
          topology_(topology),
          faces_(faces),
          options_(options),
          weigher_(mesh, topology, faces, options.weight) {}

    glm::vec3 normal_of(const std::vector<Index>& corners, Block& block) {
        sum_.clear();
        for (const Index c : corners) {
            const glm::dvec3 term = weigher_.term(c);
            if (term != glm::dvec3(0.0)) sum_.add(term);
        }
        const FanSum::Sum sum = sum_.sum();
        if (sum.trusted && options_.precision != Precision::exact)
            return glm::vec3(unit(sum.value));
        return hard_case(corners, sum, block);
    }

  private:
    // Cancelled to nothing, or the exact answer was asked for: exact area sums where the weight is
    // the area (the only rational one), else the documented ladder.
    glm::vec3 hard_case(const std::vector<Index>& corners, const FanSum::Sum& sum, Block& block) {
        if (options_.weight == NormalWeight::area && sum_.size() > 0) {
            faces_of(corners);
            const glm::dvec3 exact = detail::exact_area_sum(mesh_, fan_faces_);
            if (exact != glm::dvec3(0.0)) return glm::vec3(unit(exact));
        } else if (sum.trusted) {
            return glm::vec3(unit(sum.value));
        }
        const Index lowest = *std::min_element(corners.begin(), corners.end());
        return fallback(corners, lowest, block);
    }

    glm::vec3 fallback(const std::vector<Index>& corners, Index lowest, Block& block) {
        glm::dvec3 best(0.0);
        double largest = 0;
        for (const Index c : corners) {
            const glm::dvec3& area = faces_.area_vectors[topology_.corner_faces[c]];
            const double length = glm::length(area);
            // Ties go by value, not by index, so that the order of the faces does not matter.
            if (length > largest ||
                (length == largest && length > 0 && lexicographic(best, area))) {
                largest = length;
                best = area;
            }
        }
        if (!(largest > 0)) {
            block.fallbacks.push_back({lowest, NormalFallback::none_defined});
            return {0, 0, 1};
        }
        block.fallbacks.push_back({lowest, NormalFallback::largest_face});
        return glm::vec3(unit(best));
    }

    static bool lexicographic(const glm::dvec3& a, const glm::dvec3& b) {
        if (a.x != b.x) return a.x < b.x;
        if (a.y != b.y) return a.y < b.y;
        return a.z < b.z;
    }

    void faces_of(const std::vector<Index>& corners) {
        fan_faces_.clear();
        for (const Index c : corners)
            if (faces_.states[topology_.corner_faces[c]] == FaceState::regular)
                fan_faces_.push_back(topology_.corner_faces[c]);
    }

    const MeshView& mesh_;
    const Topology& topology_;
    const FaceNormals& faces_;
    const NormalOptions& options_;
    Weigher weigher_;
    FanSum sum_;
    std::vector<Index> fan_faces_;
};

}  // namespace

Result<CornerNormals> corner_normals(const MeshView& mesh, const Topology& topology,
                                     const FaceNormals& faces, const HardEdges& hard,
                                     const NormalOptions& options) {
    const std::size_t points = mesh.positions.size();
    CornerNormals result;
    std::vector<Index>& indices = result.normals.indices;
    indices.assign(mesh.corner_count(), no_index);

    const FanWalker walker(mesh, topology, hard);
    std::vector<Block> blocks((points + point_grain - 1) / point_grain);
    detail::parallel_blocks(
        points, point_grain, options.threads, [&](std::size_t begin, std::size_t end) {
            Block& block = blocks[begin / point_grain];
            NormalMaker maker(mesh, topology, faces, options);
            std::vector<Index> corners;
            for (std::size_t v = begin; v < end; ++v) {
                for (Index i = topology.point_offsets[v]; i < topology.point_offsets[v + 1]; ++i) {
                    const Index c = topology.point_corners[i];
                    if (indices[c] != no_index) continue;
                    walker.collect(c, corners);
                    const Index value = Index(block.values.size());
                    for (const Index k : corners) indices[k] = value;
                    block.values.push_back(maker.normal_of(corners, block));
                }
            }
        });

    // Values were numbered within their block; shift them by what the blocks before hold.
    std::vector<Index> bases(blocks.size() + 1, 0);
    for (std::size_t b = 0; b < blocks.size(); ++b)
        bases[b + 1] = bases[b] + Index(blocks[b].values.size());
    detail::parallel_blocks(
        points, point_grain, options.threads, [&](std::size_t begin, std::size_t end) {
            const Index base = bases[begin / point_grain];
            if (base == 0) return;
            for (Index i = topology.point_offsets[begin]; i < topology.point_offsets[end]; ++i)
                indices[topology.point_corners[i]] += base;
        });
    result.normals.values.reserve(bases.back());
    for (const Block& block : blocks) {
        result.normals.values.insert(result.normals.values.end(), block.values.begin(),
                                     block.values.end());
        result.fallbacks.insert(result.fallbacks.end(), block.fallbacks.begin(),
                                block.fallbacks.end());
    }
    std::sort(result.fallbacks.begin(), result.fallbacks.end(),
              [](const auto& a, const auto& b) { return a.corner < b.corner; });
    return result;
}

}  // namespace prep
