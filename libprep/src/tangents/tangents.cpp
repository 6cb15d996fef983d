// Tangents by MikkTSpace (Mikkelsen 2008, "Simulation of Wrinkled Surfaces Revisited"; the
// definition whose steps the comments name is docs/tangents.md's), in six steps:
//
//   cut_triangles   quads and larger polygons are cut                          triangles.h
//   weld            equal positions become one vertex                          surface/weld.h
//   stream          contributions are accumulated while triangles go by        accumulate.h
//   make_worklist   the vertices that need more, and their one-rings           one_rings.h
//   group           their triangles are paired over edges, grouped, summed     groups.h
//   complete        degenerate triangles copy; no corner is left without       fallback.h
//
// There are two paths. The streaming path gives a vertex its tangent as soon as all its triangles
// went by, where these are one fan of up to eight, all healthy and of one orientation, with one
// normal and one UV, and with all S, and all T, in one half-space: then MikkTSpace's group is all
// of them and its tangent their sum. Of a usual mesh these are nineteen vertices of twenty, and a
// triangle takes 20 ns and no memory. The one-ring path makes lists of triangles for all other
// vertices, and takes about five times as long for each. Where triangles are in random order, the
// streaming path sorts contributions by vertex before it adds them (corner_buckets.h).
//
// The streaming path is left out where the angular threshold parts more than opposite directions,
// and given up where most vertices have several normals or UVs (after the first 4096 triangles),
// where something is NaN, and where a vertex has degenerate triangles alone: then all vertices are
// on the worklist. Both paths give the same bits wherever both could run.
#include "prep/tangents.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "base/parallel.h"
#include "surface/weld.h"
#include "tangents/accumulate.h"
#include "tangents/fallback.h"
#include "tangents/groups.h"

namespace prep {
namespace {

using Index = std::uint32_t;
using detail::CornerReader;
using detail::TangentTriangles;

Error invalid(std::string text) {
    return {ErrorCode::invalid, std::move(text), ""};
}

Result<void> check_input(const TangentInput& in, const TangentOptions& options) {
    const std::size_t corners = in.corner_vertices.size();
    if (in.normals.indices.size() != corners || in.uv.indices.size() != corners)
        return invalid("tangents need a normal and a UV layer with one index per corner (" +
                       std::to_string(corners) + "), found " +
                       std::to_string(in.normals.indices.size()) + " and " +
                       std::to_string(in.uv.indices.size()));
    if (!in.face_offsets.empty() && in.face_offsets.back() != corners)
        return invalid("the faces have " + std::to_string(in.face_offsets.back()) +
                       " corners, the mesh has " + std::to_string(corners));
    if (in.face_offsets.empty() && corners != 0)
        return invalid("the mesh has corners but no faces");
    if (!(options.angular_threshold >= 0 && options.angular_threshold <= std::numbers::pi))
        return invalid("the angular threshold must be between 0 and π radians, found " +
                       std::to_string(options.angular_threshold));
    // Of polygons of k corners k − 2 triangles at most, whose corners get names behind the
    // positions'.
    const std::size_t faces = in.face_offsets.empty() ? 0 : in.face_offsets.size() - 1;
    const std::size_t triangles = corners > 2 * faces ? corners - 2 * faces : 0;
    if (triangles > (std::size_t(1) << 30) || corners + in.positions.size() >= no_index ||
        3 * triangles + in.positions.size() >= no_index)
        return Error{ErrorCode::limit,
                     "at most 2^30 triangles, whose corners and the positions together are at most "
                     "2^32, found " +
                         std::to_string(corners) + " corners; split the mesh",
                     ""};
    return {};
}

// Equal positions (equal_positions()), found when first asked for: UV sets share them.
using SharedWeld = std::optional<std::vector<Index>>;

class TangentComputation {
  public:
    TangentComputation(const TangentInput& input, SharedWeld& weld, const TangentOptions& options)
        : in_(input),
          weld_(weld),
          options_(options),
          robust_(options.mode == TangentMode::mikktspace),
          positive_(options.uv_origin == UvOrigin::top_left ? -1.0f : 1.0f) {
        read_.unit_normals = robust_;
    }

    CornerTangents operator()() {
        cut_triangles();
        if (triangles_.count > 0) {
            weld();
            const detail::BlockContributions contributions(read_, triangles_, options_);
            stream(contributions);
            make_worklist(contributions);
            if (any_listed_) group();
        }
        complete();
        return std::move(result_);
    }

  private:
    void cut_triangles() { triangles_ = detail::tangent_triangles(in_, robust_, options_.threads); }

    void weld() {
        if (options_.mode == TangentMode::mikktspace_exact) {
            welds_ = detail::c_reference_welds(in_, triangles_);
            read_.welds = welds_;
        }
        rings_ = detail::welded_vertices(in_, triangles_, lowest(), options_.threads);
    }

    void stream(const detail::BlockContributions& contributions) {
        streamed_ = detail::opposites_only(options_.angular_threshold);
        std::vector<Index>& indices = result_.tangents.indices;
        indices.reserve(in_.corner_vertices.size());
        detail::advise_large_pages(indices.data(), indices.capacity() * sizeof(Index));
        const bool scattered = detail::are_scattered(rings_.vertices, rings_.positions);
        const bool at_once = options_.threads == 1 && triangles_.implicit();
        detail::parallel_both(
            options_.threads,
            [&] {
                if (streamed_)
                    valences_ = scattered ? detail::uncounted_valences(triangles_, rings_.positions,
                                                                       options_.threads)
                                          : detail::count_valences(
                                                triangles_, rings_.vertices, rings_.positions,
                                                options_.threads, at_once ? &indices : nullptr);
            },
            [&] { reserve_values(); });
        if (streamed_)
            streamed_ = (scattered ? detail::accumulate_scattered : detail::accumulate)(
                read_, triangles_, rings_.vertices, contributions, {positive_, robust_}, options_,
                valences_, store_, result_.tangents.values);
        valences_.words = {};
        if (streamed_) return;
        valences_ = {};
        detail::compute_all_contributions(contributions, triangles_, options_.threads, store_);
    }

    // The result's memory, touched here rather than later because another thread has work then.
    void reserve_values() {
        std::vector<Index>& indices = result_.tangents.indices;
        // Most vertices' values have the vertex' number.
        if (!triangles_.implicit())
            indices.assign(in_.corner_vertices.size(), no_index);
        else if (indices.empty())
            indices.assign(rings_.vertices.begin(), rings_.vertices.end());
        const std::size_t firsts = std::min(rings_.positions, 3 * triangles_.count);
        std::vector<glm::vec4>& values = result_.tangents.values;
        // For as many seams as most meshes have, and a default.
        values.reserve(firsts + firsts / 16 + 1);
        detail::advise_large_pages(values.data(), values.capacity() * sizeof(glm::vec4));
        values.resize(firsts);
    }

    void make_worklist(const detail::BlockContributions& contributions) {
        if (options_.mode == TangentMode::mikktspace_exact)
            overrides_ = detail::c_reference_pairs(welds_, triangles_, store_);
        if (!triangles_.implicit())
            own_values_.assign(rings_.vertices.begin(), rings_.vertices.end());
        if (streamed_) {
            for (const auto& entry : overrides_.entries)
                for (const Index m : {entry.half_edge, detail::next_corner(entry.half_edge)})
                    valences_.states[rings_.vertex(m)] = detail::worklist_vertex;
        }
        detail::Worklist worklist =
            detail::make_worklist(triangles_, store_, rings_.vertices, valences_.states,
                                  valences_.places, options_.threads, corner_values());
        any_listed_ = worklist.any || !streamed_;
        if (!any_listed_) {
            result_.tangents.values.resize(valences_.used);
            return;
        }
        detail::parallel_both(
            options_.threads,
            [&] {
                if (!store_.complete)
                    detail::compute_chosen(contributions, std::move(worklist.triangles),
                                           options_.threads, store_);
            },
            [&] { detail::fill_rings(in_, triangles_, worklist.lists, rings_); });
        worklist = {};
        valences_.states = {};
        detail::split_rings(read_, triangles_, store_, options_.threads, rings_);
        overrides_.name_vertices(rings_);
    }

    void group() {
        const detail::GroupInput input{
            read_,
            triangles_,
            store_,
            rings_,
            overrides_,
            {.angular_threshold = options_.angular_threshold,
             .positive = positive_,
             .review = robust_,
             .bounded_effort = robust_,
             .threads = options_.threads},
            {streamed_ ? valences_.used : rings_.count, !streamed_, valences_.places},
            corner_values()};
        detail::GroupTangents groups =
            detail::group_tangents(input, std::move(result_.tangents.values));
        result_.tangents.values = std::move(groups.values);
        suspects_ = std::move(groups.suspects);
    }

    void complete() {
        std::vector<Index>& indices = result_.tangents.indices;
        if (triangles_.count == 0) indices.assign(in_.corner_vertices.size(), no_index);
        for (std::size_t i = 0; i < own_values_.size(); ++i) {
            // The halves of a quad agree by now; larger polygons keep their first triangle's.
            Index& index = indices[triangles_.corners[i]];
            if (index == no_index) index = own_values_[i];
        }
        detail::release(own_values_);
        std::vector<Index> moved = detail::copy_to_degenerate(read_, triangles_, store_, indices);
        if (robust_) {
            add_fallbacks(moved);
        } else {
            add_default();
        }
        count_triangles();
    }

    void add_default() {
        CornerLayer<glm::vec4>& layer = result_.tangents;
        const Index none = Index(layer.values.size());
        bool any = false;
        for (Index& index : layer.indices) {
            if (index != no_index) continue;
            index = none;
            any = true;
        }
        if (any) layer.values.push_back({1, 0, 0, -positive_});
    }

    void add_fallbacks(std::vector<Index>& suspects) {
        for (const Index m : suspects_) suspects.push_back(triangles_.corner(m >> 2, m & 3));
        const std::vector<Index>& indices = result_.tangents.indices;
        const bool all_set =
            triangles_.count > 0 && triangles_.implicit() && store_.counts.degenerate == 0;
        if (!all_set) {
            for (Index c = 0; c < indices.size(); ++c)
                if (indices[c] == no_index) suspects.push_back(c);
            if (store_.counts.degenerate > 0) {
                // Their corners copy values of others, which may be no frames.
                for (std::size_t t = 0; t < triangles_.count; ++t) {
                    if (!(store_.flags(t) & detail::degenerate_triangle)) continue;
                    for (std::size_t k = 0; k < 3; ++k) suspects.push_back(triangles_.corner(t, k));
                }
            }
        }
        if (suspects.empty()) return;
        std::sort(suspects.begin(), suspects.end());
        suspects.erase(std::unique(suspects.begin(), suspects.end()), suspects.end());
        detail::apply_fallbacks({read_, lowest(), suspects, positive_}, result_);
    }

    void count_triangles() {
        result_.degenerate_triangles = store_.counts.degenerate;
        result_.mirrored_triangles = store_.counts.mirrored;
        if (!triangles_.any_quad) return;
        // The halves of quads have come to an agreement since.
        result_.mirrored_triangles = 0;
        for (std::size_t t = 0; t < triangles_.count; ++t)
            result_.mirrored_triangles +=
                !(store_.flags(t) & (detail::orientation_preserving | detail::group_with_anything |
                                     detail::degenerate_triangle));
    }

    const std::vector<Index>& lowest() {
        if (!weld_) weld_ = detail::equal_positions(in_.positions, options_.threads, options_.simd);
        return *weld_;
    }

    // By triangle corner: the value's place. The mesh's own where all faces are triangles.
    std::span<Index> corner_values() {
        return triangles_.implicit() ? std::span(result_.tangents.indices) : std::span(own_values_);
    }

    TangentInput in_;
    SharedWeld& weld_;
    const TangentOptions& options_;
    bool robust_;
    float positive_;            // w where the definition's sign is +1
    std::vector<Index> welds_;  // mode mikktspace_exact
    CornerReader read_{in_};
    TangentTriangles triangles_;
    detail::OneRings rings_;
    detail::Valences valences_;
    detail::ContributionStore store_;
    detail::EdgeOverrides overrides_;
    bool streamed_ = false;    // the streaming path ran to its end
    bool any_listed_ = false;  // the worklist is not empty
    std::vector<Index> own_values_, suspects_;
    CornerTangents result_;
};

// Of fewer corners a thread saves little, and what it works in is much beside the mesh.
constexpr std::size_t corners_of_thread = 30000;

int useful_threads(const TangentInput& input, const TangentOptions& options) {
    const int asked = options.threads == 0 ? detail::parallel_width() : options.threads;
    const std::size_t most =
        std::max<std::size_t>(input.corner_vertices.size() / corners_of_thread, 1);
    return std::size_t(asked) <= most ? options.threads : int(most);
}

// Inputs that differ in their UVs alone.
std::vector<CornerTangents> tangents_of_all(std::span<const TangentInput> inputs,
                                            const TangentOptions& options) {
    std::vector<CornerTangents> results;
    if (inputs.empty()) return results;
    detail::with_threads(useful_threads(inputs[0], options), [&](int threads) {
        TangentOptions here = options;
        here.threads = threads;
        SharedWeld weld;
        for (const TangentInput& one : inputs)
            results.push_back(TangentComputation(one, weld, here)());
    });
    return results;
}

}  // namespace

Result<CornerTangents> corner_tangents(const TangentInput& input, const TangentOptions& options) {
    if (auto valid = check_input(input, options); !valid) return std::move(valid).error();
    return std::move(tangents_of_all({&input, 1}, options)[0]);
}

Result<std::vector<CornerTangents>> corner_tangents(
    const TangentInput& input, std::span<const CornerLayerView<glm::vec2>> uv_sets,
    const TangentOptions& options) {
    std::vector<TangentInput> inputs(uv_sets.size(), input);
    for (std::size_t set = 0; set < uv_sets.size(); ++set) {
        inputs[set].uv = uv_sets[set];
        if (auto valid = check_input(inputs[set], options); !valid) {
            Error error = std::move(valid).error();
            error.place = "UV set " + std::to_string(set);
            return error;
        }
    }
    return tangents_of_all(inputs, options);
}

}  // namespace prep
