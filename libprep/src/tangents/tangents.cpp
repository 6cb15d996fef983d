#include "prep/tangents.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "surface/weld.h"
#include "tangents/accumulate.h"
#include "tangents/c_reference_quirks.h"
#include "tangents/degenerate.h"
#include "tangents/fallback.h"
#include "tangents/fans.h"
#include "tangents/groups.h"
#include "tangents/subgroups.h"
#include "tangents/worklist.h"

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

// What does not depend on the UVs: made when first asked for.
class Shared {
  public:
    const std::vector<Index>& lowest(const TangentInput& in, const TangentOptions& options) {
        if (!made_) lowest_ = detail::equal_positions(in.positions, options.threads, options.simd);
        made_ = true;
        return lowest_;
    }

  private:
    std::vector<Index> lowest_;
    bool made_ = false;
};

class Run {
  public:
    Run(const TangentInput& input, Shared& shared, const TangentOptions& options)
        : in_(input),
          shared_(shared),
          options_(options),
          robust_(options.mode == TangentMode::mikktspace),
          positive_(options.uv_origin == UvOrigin::top_left ? -1.0f : 1.0f) {
        read_.unit_normals = robust_;
    }

    CornerTangents operator()() {
        triangles_ = detail::tangent_triangles(in_, robust_, options_.threads);
        if (triangles_.count == 0) return without_triangles();
        const bool as_reference = options_.mode == TangentMode::mikktspace_exact;
        std::vector<Index> representatives;
        if (as_reference) {
            representatives = detail::reference_representatives(in_, triangles_);
            read_.representatives = representatives;
        }
        const detail::TermMaker maker(read_, triangles_, options_);
        detail::TangentStars stars = detail::named_vertices(
            in_, triangles_, shared_.lowest(in_, options_), options_.threads);
        detail::VertexCounts counts;
        bool fans_told = detail::opposites_only(options_.angular_threshold);
        std::vector<Index>& indices = result_.tangents.indices;
        indices.reserve(in_.corner_vertices.size());
        detail::advise_large_pages(indices.data(), indices.capacity() * sizeof(Index));
        const bool at_once = options_.threads == 1 && triangles_.implicit();
        detail::parallel_both(
            options_.threads,
            [&] {
                if (fans_told)
                    counts =
                        detail::count_triangles(triangles_, stars.vertices, stars.positions,
                                                options_.threads, at_once ? &indices : nullptr);
            },
            [&] { make_room(stars); });
        if (fans_told) {
            const detail::FanMaker fans(read_, {positive_, robust_, options_.simd});
            fans_told = detail::add_up_vertices(in_, triangles_, stars.vertices, maker, fans,
                                                options_, counts, terms_, result_.tangents.values);
        }
        counts.words = {};
        if (!fans_told) {
            counts = {};
            detail::compute_all_terms(maker, triangles_, options_.threads, terms_);
        }
        detail::EdgeOverrides overrides;
        if (as_reference) overrides = detail::reference_pairs(representatives, triangles_, terms_);
        make_tangents(maker, fans_told, counts, stars, overrides);
        count_triangles();
        return std::move(result_);
    }

  private:
    // No face, or only such as the definition does not know (polygons of five corners and more).
    CornerTangents without_triangles() {
        result_.tangents.indices.assign(in_.corner_vertices.size(), no_index);
        if (robust_) {
            std::vector<Index> none;
            add_fallbacks({}, none);
        } else {
            add_default();
        }
        return std::move(result_);
    }

    // The result's memory, touched here rather than later because another thread has work then.
    void make_room(const detail::TangentStars& stars) {
        std::vector<Index>& indices = result_.tangents.indices;
        // Most vertices' values have the vertex' number.
        if (!triangles_.implicit())
            indices.assign(in_.corner_vertices.size(), no_index);
        else if (indices.empty())
            indices.assign(stars.vertices.begin(), stars.vertices.end());
        const std::size_t firsts = std::min(stars.positions, 3 * triangles_.count);
        std::vector<glm::vec4>& values = result_.tangents.values;
        // For as many seams as most meshes have, and a default.
        values.reserve(firsts + firsts / 16 + 1);
        detail::advise_large_pages(values.data(), values.capacity() * sizeof(glm::vec4));
        values.resize(firsts);
    }

    void make_tangents(const detail::TermMaker& maker, bool fans_told, detail::VertexCounts& counts,
                       detail::TangentStars& stars, detail::EdgeOverrides& overrides) {
        std::vector<Index>& indices = result_.tangents.indices;
        std::vector<Index> own_values;  // where triangles' corners are not the mesh's
        if (!triangles_.implicit()) own_values.assign(stars.vertices.begin(), stars.vertices.end());
        const std::span<Index> corner_values = triangles_.implicit() ? indices : own_values;

        if (fans_told) {
            for (const auto& entry : overrides.entries)
                for (const Index m : {entry.half_edge, detail::next_corner(entry.half_edge)})
                    counts.states[stars.vertex(m)] = detail::listed_vertex;
        }
        detail::ListedCorners listed =
            detail::place_corners(triangles_, terms_, stars.vertices, counts.states, counts.places,
                                  options_.threads, corner_values);
        std::vector<Index> suspects;
        if (listed.any || !fans_told) {
            detail::parallel_both(
                options_.threads,
                [&] {
                    if (!terms_.complete)
                        detail::compute_terms(maker, std::move(listed.triangles), options_.threads,
                                              terms_);
                },
                [&] { detail::list_members(in_, triangles_, listed.lists, stars); });
            listed = {};
            counts.states = {};
            detail::split_stars(read_, triangles_, terms_, options_.threads, stars);
            overrides.name_vertices(stars);
            detail::GroupOptions options;
            options.angular_threshold = options_.angular_threshold;
            options.positive = positive_;
            options.review = options.bounded_effort = robust_;
            options.threads = options_.threads;
            detail::FirstValues firsts{fans_told ? counts.used : stars.count, !fans_told,
                                       counts.places};
            detail::GroupTangents groups =
                detail::group_tangents(read_, triangles_, terms_, stars, overrides, options, firsts,
                                       std::move(result_.tangents.values), corner_values);
            result_.tangents.values = std::move(groups.values);
            suspects = std::move(groups.suspects);
        } else {
            result_.tangents.values.resize(counts.used);
        }
        for (std::size_t i = 0; i < own_values.size(); ++i) {
            // The halves of a quad agree by now; larger polygons keep their first triangle's.
            Index& index = indices[triangles_.corners[i]];
            if (index == no_index) index = own_values[i];
        }
        std::vector<Index> moved = detail::copy_to_degenerate(read_, triangles_, terms_, indices);
        if (robust_) {
            add_fallbacks(suspects, moved);
        } else {
            add_default();
        }
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

    void add_fallbacks(const std::vector<Index>& members, std::vector<Index>& suspects) {
        for (const Index m : members) suspects.push_back(triangles_.corner(m >> 2, m & 3));
        const std::vector<Index>& indices = result_.tangents.indices;
        const bool all_set =
            triangles_.count > 0 && triangles_.implicit() && terms_.counts.degenerate == 0;
        if (!all_set) {
            for (Index c = 0; c < indices.size(); ++c)
                if (indices[c] == no_index) suspects.push_back(c);
            if (terms_.counts.degenerate > 0) {
                // Their corners copy values of others, which may be no frames.
                for (std::size_t t = 0; t < triangles_.count; ++t) {
                    if (!(terms_.flags(t) & detail::degenerate_triangle)) continue;
                    for (std::size_t k = 0; k < 3; ++k) suspects.push_back(triangles_.corner(t, k));
                }
            }
        }
        if (suspects.empty()) return;
        std::sort(suspects.begin(), suspects.end());
        suspects.erase(std::unique(suspects.begin(), suspects.end()), suspects.end());
        detail::apply_fallbacks({read_, shared_.lowest(in_, options_), suspects, positive_},
                                result_);
    }

    void count_triangles() {
        result_.degenerate_triangles = terms_.counts.degenerate;
        result_.mirrored_triangles = terms_.counts.mirrored;
        if (!triangles_.any_quad) return;
        // The halves of quads have come to an agreement since.
        result_.mirrored_triangles = 0;
        for (std::size_t t = 0; t < triangles_.count; ++t)
            result_.mirrored_triangles +=
                !(terms_.flags(t) & (detail::orientation_preserving | detail::group_with_anything |
                                     detail::degenerate_triangle));
    }

    TangentInput in_;
    Shared& shared_;
    const TangentOptions& options_;
    bool robust_;
    float positive_;  // w where the definition's sign is +1
    CornerReader read_{in_};
    TangentTriangles triangles_;
    detail::Terms terms_;
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

}  // namespace

Result<CornerTangents> corner_tangents(const TangentInput& input, const TangentOptions& options) {
    if (auto valid = check_input(input, options); !valid) return std::move(valid).error();
    CornerTangents result;
    detail::with_threads(useful_threads(input, options), [&](int threads) {
        TangentOptions here = options;
        here.threads = threads;
        Shared shared;
        result = Run(input, shared, here)();
    });
    return result;
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
    std::vector<CornerTangents> results;
    detail::with_threads(useful_threads(input, options), [&](int threads) {
        TangentOptions here = options;
        here.threads = threads;
        Shared shared;
        for (const TangentInput& one : inputs) results.push_back(Run(one, shared, here)());
    });
    return results;
}

}  // namespace prep
