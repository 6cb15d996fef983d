#include "limit_surface/face_varying.h"

#include <algorithm>

namespace prep::detail {
namespace {

// Faces with one value, all around a vertex.
struct Span {
    std::uint32_t value = 0, size = 0;
    bool disjoint = false;  // several runs of faces, or a sharp edge or the end of a seam inside
    float semi_sharp = 0;   // the sharpest edge inside
};

class Builder {
  public:
    Builder(const SurfaceCage& positions, const RefinedCage& refined, FaceVaryingRule rule)
        : positions_(positions), refined_(refined), base_(refined.levels[0]), rule_(rule) {}

    FaceVaryingCage build(const std::vector<std::uint32_t>& corner_values) {
        sort_corners();
        name_values(corner_values);
        find_seams();
        SurfaceCage& cage = made_.cage;
        cage.scheme = positions_.scheme;
        cage.creasing = positions_.creasing;
        cage.smooth_triangles = positions_.smooth_triangles;
        cage.linear = positions_.linear || rule_ == FaceVaryingRule::all;
        cage.boundary = BoundaryRule::edge_only;  // corners: sharp below where they are
        cage.face_offsets = positions_.face_offsets;
        cage.vertex_count = std::uint32_t(made_.first_corner.size());
        for (std::size_t f = 0; f < positions_.face_count(); ++f)
            cage.holes.push_back(refined_.has_surface[f] ? 0 : 1);
        if (cage.linear) return std::move(made_);
        for (std::uint32_t c = 0; c < cage.corner_vertices.size(); ++c)
            if (const float sharpness = refined_.edge_sharpness(c); sharpness > 0)
                cage.creases.push_back(
                    {cage.corner_vertices[c], cage.corner_vertices[next(c)], sharpness});
        for (std::uint32_t v = 0; v < positions_.vertex_count; ++v) {
            sharpen(v);
            as_channel_ |= has_mixed_averages(v);
        }
        if (as_channel_) cage.channel_of = &positions_, cage.rule = rule_;
        return std::move(made_);
    }

  private:
    std::uint32_t next(std::uint32_t c) const {
        const std::uint32_t f = corner_faces_[c];
        return c + 1 == positions_.face_offsets[f + 1] ? positions_.face_offsets[f] : c + 1;
    }

    void sort_corners() {
        const auto& vertices = positions_.corner_vertices;
        offsets_.assign(positions_.vertex_count + 1, 0);
        for (const std::uint32_t v : vertices) ++offsets_[v + 1];
        for (std::uint32_t v = 0; v < positions_.vertex_count; ++v) offsets_[v + 1] += offsets_[v];
        corners_.resize(vertices.size());
        std::vector<std::uint32_t> at(offsets_.begin(), offsets_.end() - 1);
        for (std::uint32_t c = 0; c < vertices.size(); ++c) corners_[at[vertices[c]]++] = c;
        corner_faces_.reserve(vertices.size());
        for (std::uint32_t f = 0; f < positions_.face_count(); ++f)
            corner_faces_.insert(corner_faces_.end(), positions_.face_size(f), f);
    }
    std::span<const std::uint32_t> corners_of(std::uint32_t v) const {
        return std::span(corners_).subspan(offsets_[v], offsets_[v + 1] - offsets_[v]);
    }

    // OpenSubdiv takes the second of two values for a new one where it comes back after the first,
    // and only there. So do we, that results agree.
    void name_values(const std::vector<std::uint32_t>& corner_values) {
        auto& names = made_.cage.corner_vertices;
        names.resize(corner_values.size());
        std::vector<std::uint32_t> around, values;
        for (std::uint32_t v = 0; v < positions_.vertex_count; ++v) {
            refined_.corners_around(v, around);
            const auto first = std::uint32_t(made_.first_corner.size());
            values.clear();
            const bool manifold = refined_.is_manifold(v);
            for (std::size_t k = 0; k < around.size(); ++k) {
                const std::uint32_t value = corner_values[around[k]];
                if (k > 0 && value == corner_values[around[k - 1]]) {
                    names[around[k]] = names[around[k - 1]];
                    continue;
                }
                const bool fresh = values.size() == 2 && values[0] != value && manifold;
                const auto known =
                    fresh ? values.end() : std::find(values.begin(), values.end(), value);
                names[around[k]] = first + std::uint32_t(known - values.begin());
                if (known != values.end()) continue;
                values.push_back(value);
                made_.first_corner.push_back(around[k]);
            }
        }
    }

    // Edges over which values differ at one end at least.
    void find_seams() {
        const auto& names = made_.cage.corner_vertices;
        const auto& vertices = positions_.corner_vertices;
        struct Ends {
            std::uint32_t low = no_index, high = no_index;
        };
        std::vector<Ends> ends(refined_.edge_count);
        seams_.assign(refined_.edge_count, 0);
        for (std::uint32_t c = 0; c < names.size(); ++c) {
            const std::uint32_t to = next(c);
            Ends own{names[c], names[to]};
            if (vertices[c] > vertices[to]) std::swap(own.low, own.high);
            Ends& known = ends[base_.edges[c]];
            if (known.low == no_index) known = own;
            if (known.low != own.low || known.high != own.high) seams_[base_.edges[c]] = 1;
        }
        mismatch_.assign(positions_.vertex_count, 0);
        for (std::uint32_t c = 0; c < names.size(); ++c)
            if (seams_[base_.edges[c]]) mismatch_[vertices[c]] = mismatch_[vertices[next(c)]] = 1;
    }

    void sharpen(std::uint32_t v) {
        const auto corners = corners_of(v);
        if (corners.empty()) return;
        const bool border = base_.vertex_flags[v] & VertexFlags::border;
        const bool linear_borders = rule_ == FaceVaryingRule::boundaries;
        const bool depends =
            rule_ == FaceVaryingRule::corners_plus1 || rule_ == FaceVaryingRule::corners_plus2;
        const bool sharp_corners = rule_ != FaceVaryingRule::none;
        const float sharpness = refined_.vertex_sharpness(v);
        std::vector<Span> spans = spans_of(v);
        const auto set = [&](const Span& span, float s) {
            if (s > 0) made_.cage.corners.push_back({span.value, s});
        };
        const bool mismatch = mismatch_[v] || (border && linear_borders) ||
                              (border && corners.size() == 1 && sharp_corners &&
                               positions_.boundary != BoundaryRule::edge_and_corner);
        if (!mismatch) {  // several values: regions that meet at a non-manifold vertex alone
            for (const Span& span : spans) set(span, sharpness);
            return;
        }
        bool all_sharp = linear_borders || sharpness >= infinitely_sharp ||
                         !refined_.is_manifold(v) || (depends && spans.size() > 2);
        // Darts: the only value of a vertex where a seam ends.
        all_sharp |= rule_ == FaceVaryingRule::corners_plus2 && spans.size() == 1 && !border;
        float dependent[2] = {0, 0};
        if (depends && spans.size() == 2) {
            all_sharp |= spans[0].disjoint || spans[1].disjoint;
            if (rule_ == FaceVaryingRule::corners_plus2)
                all_sharp |= spans[0].size == 1 || spans[1].size == 1;
            // A vertex that is semi-sharp itself makes both sides so, for as long as it is.
            if (sharpness <= 0 && (spans[0].semi_sharp > 0) != (spans[1].semi_sharp > 0)) {
                dependent[0] = spans[1].semi_sharp;
                dependent[1] = spans[0].semi_sharp;
                as_channel_ |= !all_sharp && !are_alike(v);
            }
        }
        for (std::size_t k = 0; k < spans.size(); ++k) {
            const bool sharp =
                all_sharp || spans[k].disjoint || (spans[k].size == 1 && sharp_corners);
            set(spans[k], sharp ? infinitely_sharp : std::max(sharpness, k < 2 ? dependent[k] : 0));
        }
    }

    // Whether all semi-sharp edges at a vertex, those on seams too, wear off together. Where they
    // do not, a value that is sharp because of the other side has no fractional step of that
    // side's.
    bool are_alike(std::uint32_t v) const {
        float known = 0;
        for (const std::uint32_t c : corners_of(v)) {  // each such edge leaves v once
            const float sharpness = refined_.edge_sharpness(c);
            if (sharpness <= 0 || sharpness >= infinitely_sharp) continue;
            if (known > 0 && sharpness != known) return false;
            known = sharpness;
        }
        return true;
    }

    // Chaikin's averages are of all semi-sharp edges at a vertex of the mesh: here they are not of
    // those inside one span alone. By the rules for vertices they would be.
    bool has_mixed_averages(std::uint32_t v) const {
        if (positions_.creasing != CreasingMethod::chaikin) return false;
        const auto& names = made_.cage.corner_vertices;
        std::uint32_t inside = no_index;
        bool elsewhere = false;
        for (const std::uint32_t c : corners_of(v)) {
            const float sharpness = refined_.edge_sharpness(c);
            if (sharpness <= 0 || sharpness >= infinitely_sharp) continue;
            if (!seams_[base_.edges[c]] && (inside == no_index || inside == names[c]))
                inside = names[c];
            else
                elsewhere = true;
        }
        return elsewhere && inside != no_index;
    }

    std::vector<Span> spans_of(std::uint32_t v) const {
        const auto& names = made_.cage.corner_vertices;
        std::vector<Span> spans;
        for (const std::uint32_t c : corners_of(v)) {
            auto span = std::find_if(spans.begin(), spans.end(),
                                     [&](const Span& s) { return s.value == names[c]; });
            if (span == spans.end()) span = spans.insert(spans.end(), {names[c], 0, false, 0});
            ++span->size;
        }
        // Inside a span are the edges that both faces with its value share. A run of k faces has
        // k − 1 of them, or k where it goes all around.
        for (Span& span : spans) {
            std::uint32_t inside = 0, seam_ends = 0;
            for (const std::uint32_t c : corners_of(v)) {
                if (names[c] != span.value) continue;
                const std::uint32_t opposite =
                    base_.opposite[c];  // each inner edge once: leaving v
                if (opposite == no_index || names[next(opposite)] != span.value) continue;
                const float sharpness = refined_.edge_sharpness(c);
                ++inside;
                if (seams_[base_.edges[c]])
                    ++seam_ends;
                else if (sharpness >= infinitely_sharp)
                    span.disjoint = true;
                else
                    span.semi_sharp = std::max(span.semi_sharp, sharpness);
            }
            // One seam that ends here is the border of a dart; otherwise it is in the way.
            const std::uint32_t joined = inside - seam_ends;
            if (spans.size() == 1 ? seam_ends > 1 : seam_ends > 0) span.disjoint = true;
            if (joined + 1 < span.size) span.disjoint = true;
        }
        return spans;
    }

    const SurfaceCage& positions_;
    const RefinedCage& refined_;
    const RefinedLevel& base_;
    FaceVaryingRule rule_;
    FaceVaryingCage made_;
    std::vector<std::uint32_t> offsets_, corners_, corner_faces_;
    std::vector<std::uint8_t> seams_, mismatch_;
    bool as_channel_ = false;
};

}  // namespace

FaceVaryingCage face_varying_cage(const SurfaceCage& positions, const RefinedCage& refined,
                                  const std::vector<std::uint32_t>& corner_values,
                                  FaceVaryingRule rule) {
    return Builder(positions, refined, rule).build(corner_values);
}

}  // namespace prep::detail
