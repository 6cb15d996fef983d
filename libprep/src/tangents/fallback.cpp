#include "tangents/fallback.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/finite.h"
#include "base/step_count.h"

namespace prep::detail {
namespace {

using Index = std::uint32_t;
constexpr double unit_tolerance = 1e-6;        // a float unit vector is unit to 1e-7
constexpr double orthogonal_tolerance = 1e-6;  // on the plane of its normal to 2e-7
// A direction of which less than this is left on the normal's plane says nothing any more: float
// rounding is 6e-8 of it.
constexpr double least_on_plane = 1e-5;

// Zero for what has no direction.
glm::dvec3 direction_or_zero(const glm::dvec3& v) {
    const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    if (!is_finite(v) || !(largest > 0)) return glm::dvec3(0.0);
    return glm::normalize(v / largest);
}

glm::dvec3 any_perpendicular(const glm::dvec3& n) {
    // Across the axis that n is least along: never shorter than √(2/3).
    const glm::dvec3 a = glm::abs(n);
    const glm::dvec3 axis = a.x <= a.y && a.x <= a.z ? glm::dvec3(1, 0, 0)
                            : a.y <= a.z             ? glm::dvec3(0, 1, 0)
                                                     : glm::dvec3(0, 0, 1);
    return glm::normalize(axis - glm::dot(axis, n) * n);
}

// On the plane of n and unit, or zero where hardly anything is left. Projects twice: the second
// time removes what rounding left of a direction close to n.
glm::dvec3 on_plane(const glm::dvec3& n, const glm::dvec3& v) {
    const glm::dvec3 direction = direction_or_zero(v);
    glm::dvec3 p = direction - glm::dot(direction, n) * n;
    if (!(glm::length(p) > least_on_plane)) return glm::dvec3(0.0);
    p = glm::normalize(p);
    return glm::normalize(p - glm::dot(p, n) * n);
}

// A face's gradients in double: directions of growing u and v, and the sign of its UV area.
struct FaceGradient {
    glm::dvec3 s{0.0}, t{0.0};
    double area = 0;
};

// Sums over a polygon's fan, so that a degenerate first triangle does not decide. UVs and edges
// are divided by their largest component: neither 1e-30 nor 1e30 vanishes or overflows.
FaceGradient face_gradient(const CornerReader& read, Index begin, Index end) {
    double largest_uv = 0, largest_edge = 0;
    const glm::dvec3 p0(read.position(begin));
    const glm::dvec2 t0(read.uv(begin));
    FaceGradient sum;
    for (Index c = begin + 1; c < end; ++c) {
        const glm::dvec2 uv = glm::abs(glm::dvec2(read.uv(c)) - t0);
        const glm::dvec3 p = glm::abs(glm::dvec3(read.position(c)) - p0);
        if (!std::isfinite(uv.x + uv.y + p.x + p.y + p.z)) return sum;
        largest_uv = std::max({largest_uv, uv.x, uv.y});
        largest_edge = std::max({largest_edge, p.x, p.y, p.z});
    }
    if (!(largest_uv > 0) || !(largest_edge > 0)) return sum;
    for (Index c = begin + 1; c + 1 < end; ++c) {
        const glm::dvec3 d1 = (glm::dvec3(read.position(c)) - p0) / largest_edge;
        const glm::dvec3 d2 = (glm::dvec3(read.position(c + 1)) - p0) / largest_edge;
        const glm::dvec2 a = (glm::dvec2(read.uv(c)) - t0) / largest_uv;
        const glm::dvec2 b = (glm::dvec2(read.uv(c + 1)) - t0) / largest_uv;
        const double area2 = a.x * b.y - a.y * b.x;
        // Collinear UVs: no gradient, and a direction would depend on rounding.
        if (std::abs(area2) <= 1e-15 * (std::abs(a.x * b.y) + std::abs(a.y * b.x))) continue;
        const double sign = area2 < 0 ? -1.0 : 1.0;
        sum.area += area2;
        sum.s += sign * (b.y * d1 - a.y * d2);
        sum.t += sign * (a.x * d2 - b.x * d1);
    }
    return sum;
}

class Fallbacks {
  public:
    Fallbacks(const FallbackInput& input, CornerTangents& out)
        : in_(input), read_(input.read), out_(out) {}

    void apply() {
        find_faults();
        if (out_.fallbacks.empty()) return;
        index_places();
        Index face = 0;
        const auto& offsets = read_.in.face_offsets;
        for (auto& fallback : out_.fallbacks) {
            const Index corner = fallback.corner;
            face = Index(std::upper_bound(offsets.begin() + face, offsets.end(), corner) -
                         offsets.begin() - 1);
            replace(face, fallback);
        }
        // Only now: neighbours are the definition's own tangents, whatever the order.
        for (std::size_t i = 0; i < made_.size(); ++i) {
            out_.tangents.indices[out_.fallbacks[i].corner] = Index(out_.tangents.values.size());
            out_.tangents.values.push_back(made_[i]);
        }
    }

  private:
    std::optional<glm::dvec3> normal(Index corner) const {
        const glm::dvec3 n = direction_or_zero(glm::dvec3(read_.normal(corner)));
        if (n == glm::dvec3(0.0)) return std::nullopt;
        return n;
    }

    void find_faults() {
        for (const Index c : in_.suspects)
            if (const auto fault = fault_of(c)) out_.fallbacks.push_back({c, *fault, {}});
    }

    std::optional<TangentFault> fault_of(Index corner) const {
        const auto n = normal(corner);
        if (!n) return TangentFault::no_normal;
        const Index value = out_.tangents.indices[corner];
        if (value == no_index) return TangentFault::no_gradient;
        const glm::dvec3 t{glm::vec3(out_.tangents.values[value])};
        if (!is_finite(t)) return TangentFault::not_finite;
        if (t == glm::dvec3(0.0)) return TangentFault::vanished;
        if (std::abs(glm::length(t) - 1.0) > unit_tolerance) return TangentFault::not_unit;
        const double along = std::abs(glm::dot(*n, t));
        if (along > 0.999) return TangentFault::along_normal;
        if (along > orthogonal_tolerance) return TangentFault::not_orthogonal;
        return std::nullopt;
    }

    Index place(Index corner) const {
        const Index p = read_.in.corner_vertices[corner];
        return in_.lowest.empty() ? p : in_.lowest[p];
    }

    bool faulty(Index corner) const {
        return std::binary_search(out_.fallbacks.begin(), out_.fallbacks.end(),
                                  CornerTangents::Fallback{corner, {}, {}},
                                  [](const auto& a, const auto& b) { return a.corner < b.corner; });
    }

    // Every position with a faulty corner.
    void index_places() {
        for (const auto& f : out_.fallbacks) places_.push_back({.position = place(f.corner)});
        std::sort(places_.begin(), places_.end(),
                  [](const Place& a, const Place& b) { return a.position < b.position; });
        places_.erase(
            std::unique(places_.begin(), places_.end(),
                        [](const Place& a, const Place& b) { return a.position == b.position; }),
            places_.end());
        wanted_.assign(read_.in.positions.size(), 0);
        for (const Place& p : places_) wanted_[p.position] = 1;
    }

    // The next corner at a place, but for those with the value of the last one there, whose sign
    // is known. Not inlined: the loop needs the registers.
    [[gnu::noinline]] Index next_wanted(Index c, Index last_position, Index last_value) const {
        const Index* const indices = out_.tangents.indices.data();
        const Index corners = Index(out_.tangents.indices.size());
        const Index* const vertices = read_.in.corner_vertices.data();
        const Index* const lowest = in_.lowest.empty() ? nullptr : in_.lowest.data();
        const std::uint8_t* const wanted = wanted_.data();
        for (; c < corners; ++c) {
            const Index position = lowest == nullptr ? vertices[c] : lowest[vertices[c]];
            if (wanted[position] == 0) continue;
            if (position != last_position || indices[c] != last_value) break;
        }
        return c;
    }

    // Goes on through the corners until what is looked for is known.
    template <class Known>
    void search(const Known& known) {
        if (known()) return;
        const auto& indices = out_.tangents.indices;
        const Index corners = Index(indices.size());
        Index last_position = no_index, last_value = no_index;
        for (Index c = next_corner_; c < corners; ++c) {
            c = next_wanted(c, last_position, last_value);
            if (c == corners) break;
            while (next_fault_ < out_.fallbacks.size() && out_.fallbacks[next_fault_].corner < c)
                ++next_fault_;
            if (next_fault_ < out_.fallbacks.size() && out_.fallbacks[next_fault_].corner == c)
                continue;
            last_position = place(c);
            last_value = indices[c];
            Index& good = find(last_position)->good[out_.tangents.values[last_value].w > 0];
            if (good == no_index) good = c;
            if (!known()) continue;
            next_corner_ = c + 1;
            return;
        }
        next_corner_ = corners;
    }
    struct Place {
        Index position;
        // Its lowest good corners of w = −1 and of w = +1, as far as the search has come.
        Index good[2] = {no_index, no_index};
    };
    Place* find(Index position) {
        return &*std::lower_bound(places_.begin(), places_.end(), position,
                                  [](const Place& p, Index wanted) { return p.position < wanted; });
    }

    // The sign of w that the face wants: of its UV area, else of its lowest good corner.
    std::optional<float> face_sign(const FaceGradient& gradient, Index begin, Index end) const {
        if (gradient.area != 0) return gradient.area > 0 ? in_.positive : -in_.positive;
        for (Index c = begin; c < end; ++c)
            if (!faulty(c)) return out_.tangents.values[out_.tangents.indices[c]].w;
        return std::nullopt;
    }

    void look_at(Index face) {
        const Index begin = read_.in.face_offsets[face], end = read_.in.face_offsets[face + 1];
        face_ = {.number = face, .gradient = face_gradient(read_, begin, end), .sign = {}};
        face_.sign = face_sign(face_.gradient, begin, end);
        count_steps(end - begin);
    }

    void replace(Index face, CornerTangents::Fallback& fallback) {
        const Index corner = fallback.corner;
        const glm::dvec3 n = normal(corner).value_or(glm::dvec3(0, 0, 1));
        if (fallback.fault == TangentFault::not_orthogonal) {
            const glm::vec4 value = out_.tangents.values[out_.tangents.indices[corner]];
            if (accept(fallback, TangentSource::reprojected, on_plane(n, glm::vec3(value)),
                       value.w))
                return;
        }
        if (face != face_.number) look_at(face);
        const FaceGradient& gradient = face_.gradient;
        const std::optional<float> wanted = face_.sign;

        const Place& at = *find(place(corner));
        if (!wanted) search([&] { return at.good[0] != at.good[1]; });
        const bool prefer = wanted ? *wanted > 0 : at.good[1] < at.good[0];
        for (const bool sign : {prefer, !prefer}) {
            search([&] { return at.good[sign] != no_index; });
            const Index good = at.good[sign];
            if (good == no_index) continue;
            const glm::vec4 value = out_.tangents.values[out_.tangents.indices[good]];
            if (accept(fallback, TangentSource::neighbour, on_plane(n, glm::vec3(value)),
                       wanted.value_or(value.w)))
                return;
        }
        const float sign = wanted.value_or(in_.positive);
        if (accept(fallback, TangentSource::gradient, on_plane(n, gradient.s), sign)) return;
        const glm::dvec3 bitangent = on_plane(n, gradient.t);
        const double turn = gradient.area < 0 ? -1.0 : 1.0;
        if (accept(fallback, TangentSource::bitangent, turn * glm::cross(bitangent, n), sign))
            return;
        accept(fallback, TangentSource::any, any_perpendicular(n), sign);
    }

    bool accept(CornerTangents::Fallback& fallback, TangentSource source, const glm::dvec3& tangent,
                float sign) {
        if (tangent == glm::dvec3(0.0)) return false;
        fallback.source = source;
        made_.push_back(glm::vec4(glm::vec3(tangent), sign));
        return true;
    }

    const FallbackInput& in_;
    const CornerReader& read_;
    CornerTangents& out_;
    // The face of the last fallback: a polygon's corners have it in common.
    struct {
        Index number = no_index;
        FaceGradient gradient;
        std::optional<float> sign;
    } face_;
    std::vector<Place> places_;
    std::vector<std::uint8_t> wanted_;  // by position: is it one of these?
    Index next_corner_ = 0;             // where the search goes on, and the next fault there
    std::size_t next_fault_ = 0;
    std::vector<glm::vec4> made_;
};

// The corners of degenerate triangles by value, to be met by the first good corner equal to them.
class Wanted {
  public:
    explicit Wanted(std::size_t corners) : table_(std::bit_ceil(2 * corners + 1), no_index) {
        entries_.reserve(corners);
    }
    Index add(const CornerKey& key) {
        if (!key.number) return no_index;
        Index& entry = table_[slot(key)];
        if (entry == no_index) {
            entry = Index(entries_.size());
            entries_.push_back({key, no_index});
        }
        return entry;
    }
    void offer(const CornerKey& key, Index corner) {
        if (!key.number) return;
        const Index entry = table_[slot(key)];
        if (entry != no_index && entries_[entry].good == no_index) entries_[entry].good = corner;
    }
    Index good(Index entry) const { return entry == no_index ? no_index : entries_[entry].good; }

  private:
    std::size_t slot(const CornerKey& key) const {
        const std::size_t mask = table_.size() - 1;
        std::size_t at = std::size_t(hash_of(key)) & mask;
        while (table_[at] != no_index && !(entries_[table_[at]].key == key)) at = (at + 1) & mask;
        return at;
    }
    struct Entry {
        CornerKey key;
        Index good;
    };
    std::vector<Index> table_;
    std::vector<Entry> entries_;
};

}  // namespace

void apply_fallbacks(const FallbackInput& input, CornerTangents& out) {
    Fallbacks(input, out).apply();
}

std::vector<Index> copy_to_degenerate(const CornerReader& read, const TangentTriangles& triangles,
                                      const ContributionStore& store, std::span<Index> indices) {
    if (store.counts.degenerate == 0) return {};
    Wanted wanted(3 * std::size_t(store.counts.degenerate));
    std::vector<Index> entries;  // three per degenerate triangle
    const auto takes_part = [&](std::size_t t) {
        return (store.flags(t) & (degenerate_triangle | half_degenerate_quad)) ==
               degenerate_triangle;
    };
    for (std::size_t t = 0; t < triangles.count; ++t) {
        if (!takes_part(t)) continue;
        for (std::size_t k = 0; k < 3; ++k)
            entries.push_back(wanted.add(corner_key(read, triangles.corner(t, k))));
    }
    for (std::size_t t = 0; t < triangles.count; ++t) {
        if (store.flags(t) & degenerate_triangle) continue;
        for (std::size_t k = 0; k < 3; ++k) {
            const Index corner = triangles.corner(t, k);
            wanted.offer(corner_key(read, corner), corner);
        }
    }
    std::size_t next = 0;
    for (std::size_t t = 0; t < triangles.count; ++t) {
        if (!takes_part(t)) continue;
        for (std::size_t k = 0; k < 3; ++k) {
            const Index good = wanted.good(entries[next++]);
            if (good != no_index) indices[triangles.corner(t, k)] = indices[good];
        }
    }

    std::vector<Index> by_position;
    for (std::size_t t = 0; t < triangles.count; ++t) {
        const std::uint32_t flags = store.flags(t);
        if (!(flags & half_degenerate_quad) || (flags & degenerate_triangle)) continue;
        // The other half's corner that this one does not have is missing.
        const std::size_t other = (flags & quad_first) ? t + 1 : t - 1;
        const Index have[3] = {triangles.corner(t, 0), triangles.corner(t, 1),
                               triangles.corner(t, 2)};
        Index missing = no_index;
        for (std::size_t k = 0; k < 3; ++k) {
            const Index c = triangles.corner(other, k);
            if (std::find(have, have + 3, c) == have + 3) missing = c;
        }
        for (const Index c : have) {
            if (read.position(c) != read.position(missing)) continue;
            indices[missing] = indices[c];
            by_position.push_back(missing);
            break;
        }
    }
    return by_position;
}

}  // namespace prep::detail
