#include "normals/crease_fans.h"

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <vector>

#include "base/parallel.h"
#include "base/scratch_buffer.h"
#include "base/step_count.h"
#include "normals/edge_decider.h"
#include "normals/fan_normal.h"
#include "normals/gathered_terms.h"
#include "surface/corner_steps.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;
constexpr std::size_t point_grain = 8192;
static_assert(point_grain % GatheredTerms::block_points == 0);
// Corners of a point that are matched by comparing all with all.
constexpr std::size_t small_ring = 8;
constexpr Index none = no_index;

// A bit for each place of a small ring that holds `value`.
unsigned places_of(Index value, const std::array<Index, small_ring>& ring) {
#if defined(__SSE2__)
    static_assert(small_ring == 8);
    const __m128i wanted = _mm_set1_epi32(int(value));
    const auto equal = [&](std::size_t first) {
        const auto* const four = reinterpret_cast<const __m128i*>(ring.data() + first);
        return _mm_cmpeq_epi32(_mm_loadu_si128(four), wanted);
    };
    return unsigned(_mm_movemask_ps(_mm_castsi128_ps(equal(0)))) |
           unsigned(_mm_movemask_ps(_mm_castsi128_ps(equal(4)))) << 4;
#else
    unsigned places = 0;
    for (unsigned i = 0; i < small_ring; ++i) places |= unsigned(ring[i] == value) << i;
    return places;
#endif
}

// What a block of points brings beside the first fan of each.
struct Block {
    struct Extra {  // a later fan
        Index point;
        glm::vec3 value;
    };
    struct Place {  // a corner of a later fan: the how many-th of its point
        Index corner, fan;
    };
    std::vector<Extra> extras;
    std::vector<Place> places;
    FanReport report;
    std::uint64_t hard = 0, exact = 0;
    Index points = 0;  // with corners
};

// The corners around one point, and how its faces hang together there.
struct Ring {
    std::vector<Index> corners, next, previous;
    // Per corner the one across the edge that leaves the point here, and across the one that
    // enters it; none: no face there, or a hard edge.
    std::vector<Index> leaving, entering;

    void resize(std::size_t n) {
        for (auto* list : {&corners, &next, &previous, &leaving, &entering}) list->resize(n);
    }
    std::size_t size() const { return corners.size(); }
};

// Sums that are made unit many at a time: divisions and roots then go by vectors. The same bits as
// unit_of().
class UnitBatch {
  public:
    explicit UnitBatch(std::span<glm::vec3> values) : values_(values) {
        for (auto* list : {&x_, &y_, &z_}) list->fill(1);
    }
    ~UnitBatch() { flush(); }
    UnitBatch(const UnitBatch&) = delete;
    UnitBatch& operator=(const UnitBatch&) = delete;

    // values[place] becomes the sum's direction, by the time of the destructor at the latest.
    void add(const glm::dvec3& sum, std::size_t place) {
        x_[count_] = sum.x;
        y_[count_] = sum.y;
        z_[count_] = sum.z;
        places_[count_] = place;
        if (++count_ == size) flush();
    }

  private:
    static constexpr std::size_t size = 64;

    void flush() {
        for (std::size_t i = 0; i < size; ++i) {
            const double largest =
                std::max(std::max(std::abs(x_[i]), std::abs(y_[i])), std::abs(z_[i]));
            const double x = x_[i] / largest, y = y_[i] / largest, z = z_[i] / largest;
            const double length = std::sqrt(x * x + y * y + z * z);
            x_[i] = x / length;
            y_[i] = y / length;
            z_[i] = z / length;
        }
        for (std::size_t i = 0; i < count_; ++i)
            values_[places_[i]] = glm::vec3(glm::dvec3(x_[i], y_[i], z_[i]));
        count_ = 0;
    }

    std::span<glm::vec3> values_;
    std::array<double, size> x_, y_, z_;
    std::array<std::size_t, size> places_;
    std::size_t count_ = 0;
};

// Whether a sum may do that order_free_sum() makes of the faces' own doubles.
bool sums_areas(const FaceNormals& faces, const NormalOptions& options) {
    return options.weight == NormalWeight::area && options.precision != Precision::exact &&
           (options.precision == Precision::fast || faces.relative_error <= accurate_face_error);
}

class PointWalk {
  public:
    PointWalk(const MeshView& mesh, std::span<const Index> corner_points, const FaceNormals& faces,
              const EdgeDecider& decider, const NormalOptions& options, std::uint8_t* reasons,
              std::span<glm::vec3> firsts, Block& block)
        : corner_points_(corner_points),
          faces_(faces),
          decider_(decider),
          normal_of_(mesh, faces, options, TriangleSteps{}, {}),
          reasons_(reasons),
          firsts_(firsts),
          units_(firsts),
          block_(block) {
        // A turn that is smaller by far than the threshold is smooth without a second look.
        const double cosine = std::max(decider.cosine() + quick_margin, quick_margin);
        quick_cosine_squared_ = cosine * cosine;
        quick_ = sums_areas(faces, options);
        edges_ = decider.never_hard()       ? Edges::never_hard
                 : decider.by_angle_alone() ? Edges::by_angle
                                            : Edges::by_attributes;
        const bool fast = options.precision == Precision::fast;
        relative_error_ = fast ? fast_face_error + accurate_face_error : 2 * accurate_face_error;
        allowed_error_ = fast ? fast_normal_error : accurate_normal_error;
    }

    ~PointWalk() { count_steps(decided_); }
    PointWalk(const PointWalk&) = delete;
    PointWalk& operator=(const PointWalk&) = delete;

    // False: not for this walk. The point has corners. firsts[point] is the first fan's normal once
    // this object is gone. `gathered`: the corners' terms; null: they are where the faces are.
    bool run(Index point, std::span<const Index> corners, const CornerTerm* gathered) {
        if (quick_ && corners.size() <= small_ring) {
            const Small small =
                gathered != nullptr
                    ? match_small(corners, [&](std::size_t i) { return term_in(gathered[i]); })
                    : match_small(corners, [&](std::size_t i) { return term_of(corners[i]); });
            if (small.bad) return false;
            if (small.one_smooth_fan) {
                const glm::dvec3 sum = trusted_area_sum({terms_.data(), corners.size()},
                                                        relative_error_, allowed_error_);
                if (sum != glm::dvec3(0.0)) {
                    block_.exact += small.exact;
                    units_.add(sum, point);
                    return true;
                }
            }
        }
        return run_ring(point, corners);
    }

    // Whether the point is for this walk; its ring is matched then.
    bool matches(std::span<const Index> corners) {
        ring_.resize(corners.size());
        const Index* const points = corner_points_.data();
        const TriangleSteps steps;
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const Index c = corners[i];
            ring_.corners[i] = c;
            ring_.next[i] = points[steps.next(c)];
            ring_.previous[i] = points[steps.previous(c)];
        }
        return match();
    }

  private:
    static constexpr double quick_margin = 1e-3;

    // What makes edges hard.
    enum class Edges { never_hard, by_angle, by_attributes };
    struct Small {
        bool bad = false, one_smooth_fan = false;
        std::uint64_t exact = 0;  // decisions, where one_smooth_fan
    };

    // A corner's neighbours along its face, and the face's area.
    struct Term {
        const glm::dvec3* area;
        Index next, previous;
    };
    static Term term_in(const CornerTerm& term) { return {&term.area, term.next, term.previous}; }
    Term term_of(Index c) const {
        // Which corner of its triangle it is cannot be foreseen: no branch.
        const Index f = c / 3, k = c - 3 * f;
        return {&faces_.area_vectors[f], corner_points_[c + 1 - 3 * Index(k == 2)],
                corner_points_[c - 1 + 3 * Index(k == 0)]};
    }

    // Matches all with all without a branch; `terms_` get the faces' areas. `term`: of the i-th
    // corner.
    template <class Terms>
    Small match_small(std::span<const Index> corners, const Terms& term) {
        const std::size_t n = corners.size();
        std::array<Index, small_ring> next, previous, to;
        std::array<const glm::dvec3*, small_ring> areas;
        std::array<double, small_ring> squares;
        previous.fill(none);
        for (std::size_t i = 0; i < n; ++i) {
            const Term of = term(i);
            areas[i] = of.area;
            next[i] = of.next;
            previous[i] = of.previous;
        }
        // In between: vectors are not to be loaded of numbers that were just stored.
        for (std::size_t i = 0; i < n; ++i) {
            const glm::dvec3& a = *areas[i];
            terms_[i] = glm::dvec4(a, std::abs(a.x) + std::abs(a.y) + std::abs(a.z));
            squares[i] = glm::dot(a, a);
        }
        unsigned entered = 0;
        bool closed = true;
        for (std::size_t i = 0; i < n; ++i) {
            const unsigned mates = places_of(next[i], previous);
            if ((mates & (mates - 1)) != 0 || (mates & entered) != 0) return {true, false};
            entered |= mates;
            closed &= mates != 0;
            to[i] = Index(std::countr_zero(mates | 1u << small_ring));
        }
        if (!closed) return {};  // a border: looked at once more
        std::uint64_t exact = 0;
        const bool smooth = edges_ == Edges::never_hard ? is_one_ring({to.data(), n})
                            : edges_ == Edges::by_angle
                                ? turns_little({to.data(), n}, {squares.data(), n})
                                : is_smooth(corners, {to.data(), n}, exact);
        return {false, smooth, exact};
    }

    // `to`: per corner around a point the next across an edge. Each of these: whether that comes by
    // all of them, over smooth edges alone.
    static bool is_one_ring(std::span<const Index> to) {
        std::size_t steps = 0;
        Index i = 0;
        do {
            i = to[i];
            ++steps;
        } while (i != 0);
        return steps == to.size();
    }
    // Edges that are smooth by far.
    bool turns_little(std::span<const Index> to, std::span<const double> squares) const {
        if (!is_one_ring(to)) return false;
        bool smooth = true;
        for (std::size_t i = 0; i < to.size(); ++i) {
            const Index j = to[i];
            const glm::dvec4 &a = terms_[i], &b = terms_[j];
            const double dot = a.x * b.x + a.y * b.y + a.z * b.z;
            const double product = squares[i] * squares[j];
            // Also false where squares leave the range of doubles.
            smooth &= (dot > 0) & (product > smallest_product) & (product < largest_product) &
                      (dot * dot > quick_cosine_squared_ * product);
        }
        return smooth;
    }
    bool is_smooth(std::span<const Index> corners, std::span<const Index> to,
                   std::uint64_t& exact) {
        const TriangleSteps steps;
        for (Index i = 0; i < corners.size(); ++i) {
            const Index c = corners[i], other = steps.previous(corners[to[i]]);
            std::uint64_t open = 0;
            ++decided_;
            if (decider_.reasons(c, steps.face(c), other, steps.face(other), open) != hard_none)
                return false;
            if (c < other) exact += open;  // told once of both ends
        }
        return is_one_ring(to);
    }
    static constexpr double smallest_product = 0x1p-900, largest_product = 0x1p900;

    bool run_ring(Index point, std::span<const Index> corners) {
        if (!matches(corners)) return false;
        decide();
        sum_fans(point);
        return true;
    }

    // Which corner lies across each edge. False where one is not two faces' that run against each
    // other, nor one face's.
    bool match() {
        const std::size_t n = ring_.size();
        leaving_.clear();
        entering_.clear();
        for (std::size_t i = 0; i < n; ++i) {
            leaving_.push_back(std::uint64_t(ring_.next[i]) << 32 | i);
            entering_.push_back(std::uint64_t(ring_.previous[i]) << 32 | i);
        }
        std::sort(leaving_.begin(), leaving_.end());
        std::sort(entering_.begin(), entering_.end());
        std::fill(ring_.leaving.begin(), ring_.leaving.end(), none);
        std::fill(ring_.entering.begin(), ring_.entering.end(), none);
        const auto repeated = [](std::uint64_t a, std::uint64_t b) { return a >> 32 == b >> 32; };
        for (const auto* list : {&leaving_, &entering_})
            if (std::adjacent_find(list->begin(), list->end(), repeated) != list->end())
                return false;
        for (std::size_t l = 0, e = 0; l < n && e < n;) {
            const Index leaving_to = Index(leaving_[l] >> 32);
            const Index entering_from = Index(entering_[e] >> 32);
            if (leaving_to == entering_from) {
                const Index i = Index(leaving_[l]), j = Index(entering_[e]);
                ring_.leaving[i] = j;
                ring_.entering[j] = i;
            }
            l += leaving_to <= entering_from;
            e += entering_from <= leaving_to;
        }
        return true;
    }

    // Takes hard edges out of the ring.
    void decide() {
        const TriangleSteps steps;
        decided_ += ring_.size();
        for (Index i = 0; i < ring_.size(); ++i) {
            const Index c = ring_.corners[i], j = ring_.leaving[i];
            if (j == none) {
                reasons_[c] = hard_border;
                continue;
            }
            const Index other = steps.previous(ring_.corners[j]);
            std::uint64_t exact = 0;
            const std::uint8_t reasons =
                decider_.reasons(c, steps.face(c), other, steps.face(other), exact);
            if (c < other) {  // told once of both ends
                block_.exact += exact;
                block_.hard += reasons != hard_none;
            }
            if (reasons == hard_none) continue;
            reasons_[c] = reasons;
            ring_.leaving[i] = ring_.entering[j] = none;
        }
    }

    void sum_fans(Index point) {
        seen_.assign(ring_.size(), 0);
        Index fans = 0;
        for (Index start = 0; start < ring_.size(); ++start) {
            if (seen_[start]) continue;
            fan_.clear();
            Index i = start;
            for (; i != none && !seen_[i]; i = ring_.leaving[i]) add(i);
            if (i == none)
                for (i = ring_.entering[start]; i != none && !seen_[i]; i = ring_.entering[i])
                    add(i);
            const auto value = glm::vec3(normal_of_(fan_, block_.report));
            if (fans == 0) {
                firsts_[point] = value;
            } else {
                block_.extras.push_back({point, value});
                for (const Index c : fan_) block_.places.push_back({c, fans});
            }
            ++fans;
        }
    }
    void add(Index i) {
        seen_[i] = 1;
        fan_.push_back(ring_.corners[i]);
    }

    std::span<const Index> corner_points_;
    const FaceNormals& faces_;
    const EdgeDecider& decider_;
    FanNormal<TriangleSteps> normal_of_;
    std::uint8_t* reasons_;
    std::span<glm::vec3> firsts_;
    UnitBatch units_;
    Block& block_;
    bool quick_ = false;
    Edges edges_ = Edges::by_attributes;
    std::uint64_t decided_ = 0;  // edges, for tests
    double quick_cosine_squared_ = 0, relative_error_ = 0, allowed_error_ = 0;
    std::array<glm::dvec4, small_ring> terms_;
    Ring ring_;
    std::vector<std::uint64_t> leaving_, entering_;  // a point's neighbour and a place in the ring
    std::vector<std::uint8_t> seen_;
    std::vector<Index> fan_;
};

// Values by point and fan, and what corners have of them: one for each point, up to now.
void number_values(std::span<const Index> corner_points, const VertexCorners& around,
                   const std::vector<Block>& blocks, int threads, CornerLayer<glm::vec3>& layer) {
    const std::size_t points = around.offsets.size() - 1;
    std::vector<Index> bases(blocks.size() + 1, 0);
    for (std::size_t b = 0; b < blocks.size(); ++b)
        bases[b + 1] = bases[b] + blocks[b].points + Index(blocks[b].extras.size());
    if (bases.back() == points &&
        std::all_of(blocks.begin(), blocks.end(), [](auto& b) { return b.extras.empty(); }))
        return;  // one value for each point
    const std::vector<glm::vec3> firsts = std::move(layer.values);
    layer.values = std::vector<glm::vec3>(bases.back());
    ScratchBuffer<Index> numbers(points);
    parallel_blocks(points, point_grain, threads, [&](std::size_t begin, std::size_t end) {
        const Block& block = blocks[begin / point_grain];
        Index number = bases[begin / point_grain];
        auto extra = block.extras.begin();
        for (std::size_t v = begin; v < end; ++v) {
            numbers[v] = number;
            if (around.offsets[v] == around.offsets[v + 1]) continue;
            layer.values[number++] = firsts[v];
            for (; extra != block.extras.end() && extra->point == v; ++extra)
                layer.values[number++] = extra->value;
        }
    });
    parallel_blocks(corner_points.size(), 16 * point_grain, threads,
                    [&](std::size_t begin, std::size_t end) {
                        for (std::size_t c = begin; c < end; ++c)
                            layer.indices[c] = numbers[corner_points[c]];
                    });
    parallel_blocks(blocks.size(), 1, threads, [&](std::size_t b, std::size_t) {
        for (const Block::Place& place : blocks[b].places) layer.indices[place.corner] += place.fan;
    });
}

}  // namespace

bool may_have_crease_fans(const MeshView& mesh, const NormalOptions& options) {
    return all_triangles(mesh) && !options.keep_doubles;
}

std::optional<CreaseNormals> crease_fans(const MeshView& mesh, std::span<const Index> corner_points,
                                         std::span<const Index> welded, const VertexCorners& around,
                                         const FaceNormals& faces,
                                         const HardEdgeOptions& hard_options,
                                         const NormalOptions& options) {
    const auto& angle = hard_options.angle_degrees;
    if (angle && !(*angle >= 0 && *angle <= 180)) return {};
    for (const FaceState state : faces.states)
        if (state != FaceState::regular) return {};
    const std::size_t points = around.offsets.size() - 1;
    const EdgeDecider decider(mesh, welded, faces, hard_options, {});
    CreaseNormals result;
    CornerLayer<glm::vec3>& layer = result.normals.normals;
    std::vector<glm::vec3>& values = layer.values;
    parallel_both(
        options.threads, [&] { layer.indices.assign(corner_points.begin(), corner_points.end()); },
        [&] {
            values.resize(points);
            result.hard.reasons.assign(mesh.corner_count(), hard_none);
        });
    std::vector<Block> blocks((points + point_grain - 1) / point_grain);
    std::atomic<bool> bad = false;
    std::optional<GatheredTerms> gathered;
    const auto walk_all = [&](const auto& visit) {
        parallel_blocks(
            points, point_grain, options.threads, [&](std::size_t begin, std::size_t end) {
                Block& block = blocks[begin / point_grain];
                PointWalk walk(mesh, corner_points, faces, decider, options,
                               result.hard.reasons.data(), values, block);
                ScratchBuffer<CornerTerm> terms;
                const auto walk_some = [&](std::size_t from, std::size_t to) {
                    const std::size_t base = around.offsets[from];
                    if (gathered) {
                        const std::size_t count = around.offsets[to] - base;
                        if (terms.size() < count) terms = ScratchBuffer<CornerTerm>(count);
                        gathered->put_in_order(from, around, terms);
                    }
                    for (std::size_t v = from; v < to && !bad.load(std::memory_order_relaxed);
                         ++v) {
                        const std::size_t first = around.offsets[v], last = around.offsets[v + 1];
                        if (first == last) continue;
                        if (!visit(walk, block, Index(v),
                                   std::span(around.corners.data() + first, last - first),
                                   terms.empty() ? nullptr : terms.data() + (first - base)))
                            bad = true;
                    }
                };
                for (std::size_t v = begin; v < end; v += GatheredTerms::block_points)
                    walk_some(v, std::min(end, v + GatheredTerms::block_points));
            });
    };
    // Exact sums are not made in vain.
    if (options.precision == Precision::exact)
        walk_all([](PointWalk& walk, Block&, Index, std::span<const Index> corners,
                    const CornerTerm*) { return walk.matches(corners); });
    if (bad) return {};
    if (sums_areas(faces, options) && GatheredTerms::pays(corner_points))
        gathered.emplace(corner_points, around, faces.area_vectors, options.threads);
    walk_all([](PointWalk& walk, Block& block, Index v, std::span<const Index> corners,
                const CornerTerm* terms) {
        ++block.points;
        return walk.run(v, corners, terms);
    });
    gathered.reset();
    if (bad) return {};
    number_values(corner_points, around, blocks, options.threads, layer);
    for (const Block& block : blocks) {
        result.hard.hard_count += block.hard;
        result.hard.exact_decisions += block.exact;
        result.normals.exact_sums += block.report.exact_sums;
        result.normals.fallbacks.insert(result.normals.fallbacks.end(),
                                        block.report.fallbacks.begin(),
                                        block.report.fallbacks.end());
    }
    std::sort(result.normals.fallbacks.begin(), result.normals.fallbacks.end(),
              [](const auto& a, const auto& b) { return a.corner < b.corner; });
    return result;
}

}  // namespace prep::detail
