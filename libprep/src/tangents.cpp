#include "prep/tangents.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "parallel.h"
#include "tangent_groups.h"
#include "tangent_math.h"
#include "tangent_mesh.h"

namespace prep {
namespace {

using Index = std::uint32_t;
using detail::CornerReader;
using detail::TangentMesh;

Result<void> check_input(const TangentInput& in, const TangentOptions& options) {
    const std::size_t corners = in.corner_vertices.size();
    if (in.normals.indices.size() != corners || in.uv.indices.size() != corners)
        return Error{ErrorCode::invalid,
                     "tangents need a normal and a UV layer with one index per corner (" +
                         std::to_string(corners) + "), found " +
                         std::to_string(in.normals.indices.size()) + " and " +
                         std::to_string(in.uv.indices.size()),
                     ""};
    if (!(options.angular_threshold >= 0 && options.angular_threshold <= std::numbers::pi))
        return Error{ErrorCode::invalid, "the angular threshold must be between 0 and π", ""};
    return {};
}

// Steps 8 and 9: from triangle corners to face corners.
class Output {
  public:
    Output(const TangentInput& in, const TangentMesh& mesh, const detail::GroupTangents& groups)
        : mesh_(mesh), groups_(groups) {
        default_value_ = Index(groups.values.size());
        result_.values = groups.values;
        result_.values.push_back({1, 0, 0, -1});
        result_.indices.assign(in.corner_vertices.size(), default_value_);
    }

    CornerLayer<glm::vec4> make(const CornerReader& read) {
        for (std::size_t k = 0; k < 3 * mesh_.good; ++k) {
            const Index value = groups_.corner_values[k];
            if (value != no_index) contribute(mesh_.corners[k], k, value);
        }
        copy_to_degenerate(read);
        return std::move(result_);
    }

  private:
    void contribute(Index corner, std::size_t triangle_corner, Index value) {
        Index& at = result_.indices[corner];
        if (at == default_value_) {
            at = value;
        } else if (at != value && (mesh_.flags[triangle_corner / 3] & detail::quad_half)) {
            at = average(at, value);
        }
        // Corners of larger polygons keep what their first triangle gave.
    }

    Index average(Index a, Index b) {
        const glm::vec4 x = result_.values[a], y = result_.values[b];
        if (!groups_.frames.empty() &&
            std::memcmp(&groups_.frames[a], &groups_.frames[b], sizeof(detail::GroupFrame)) == 0)
            return std::max(a, b);
        glm::vec3 sum = glm::vec3(x) + glm::vec3(y);
        if (detail::mikk::not_zero(sum)) sum = detail::mikk::normalized(sum);
        // A half that groups with anything can have another orientation: the group that came later
        // (values are numbered in that order at a vertex) has the last word.
        result_.values.push_back(glm::vec4(sum, a < b ? y.w : x.w));
        return Index(result_.values.size() - 1);
    }

    void copy_to_degenerate(const CornerReader& read) {
        const std::size_t triangles = mesh_.faces.size();
        if (mesh_.good == triangles) return;
        std::vector<Index> first_good(mesh_.welded_count, no_index);
        for (std::size_t k = 3 * mesh_.good; k-- > 0;)
            first_good[mesh_.welded[mesh_.corners[k]]] = Index(k);
        for (std::size_t t = mesh_.good; t < triangles; ++t) {
            if (mesh_.flags[t] & detail::half_degenerate_quad) continue;
            for (int k = 0; k < 3; ++k) {
                const Index corner = mesh_.corners[3 * t + k];
                const Index source = first_good[mesh_.welded[corner]];
                if (source != no_index)
                    result_.indices[corner] = result_.indices[mesh_.corners[source]];
            }
        }
        for (std::size_t t = 0; t < mesh_.good; ++t) {
            if (!(mesh_.flags[t] & detail::half_degenerate_quad)) continue;
            const Index* have = &mesh_.corners[3 * t];
            // The quad's corners are consecutive; the one this half does not have is missing.
            const Index begin = read.in.face_offsets[mesh_.faces[t]];
            Index missing = begin;
            while (missing == have[0] || missing == have[1] || missing == have[2]) ++missing;
            for (int k = 0; k < 3; ++k) {
                if (read.position(have[k]) != read.position(missing)) continue;
                result_.indices[missing] = result_.indices[have[k]];
                break;
            }
        }
    }

    const TangentMesh& mesh_;
    const detail::GroupTangents& groups_;
    CornerLayer<glm::vec4> result_;
    Index default_value_;
};

bool finite(const glm::dvec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

glm::dvec3 any_perpendicular(const glm::dvec3& n) {
    // Across the axis that n is least along: never shorter than √(2/3).
    const glm::dvec3 a = glm::abs(n);
    const glm::dvec3 axis = a.x <= a.y && a.x <= a.z ? glm::dvec3(1, 0, 0)
                            : a.y <= a.z             ? glm::dvec3(0, 1, 0)
                                                     : glm::dvec3(0, 0, 1);
    return glm::normalize(axis - glm::dot(axis, n) * n);
}

glm::dvec3 unit_or_zero(const glm::dvec3& v) {
    const double largest = std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
    if (!(largest > 0) || !std::isfinite(largest)) return glm::dvec3(0.0);
    return glm::normalize(v / largest);
}

// Puts an orthonormal tangent wherever the definition's is none.
class Fallbacks {
  public:
    // `never_set` is the value index of corners that no group reached; `positive` is what w is for
    // a positive UV area.
    Fallbacks(const TangentInput& in, Index never_set, float positive, CornerTangents& out)
        : read_{in}, never_set_(never_set), positive_(positive), out_(out) {}

    void apply() {
        const TangentInput& in = read_.in;
        CornerLayer<glm::vec4>& layer = out_.tangents;
        for (Index f = 0; f + 1 < in.face_offsets.size(); ++f) {
            for (Index c = in.face_offsets[f]; c < in.face_offsets[f + 1]; ++c) {
                const glm::vec4 value = layer.values[layer.indices[c]];
                const glm::dvec3 n = unit_or_zero(glm::dvec3(read_.normal(c)));
                const glm::dvec3 t{glm::vec3(value)};
                const double along = glm::dot(n, t);
                const double length = glm::length(t);
                // A float unit vector is unit to 1e-7; ten times that is room for the definition's
                // own rounding and far from any real failure.
                const bool unit = std::abs(length - 1.0) <= 1e-6;
                const bool set = layer.indices[c] != never_set_;
                if (set && unit && std::abs(along) <= orthogonal_tolerance) continue;
                replace(f, c, value, n, t, set && unit, along);
            }
        }
    }

  private:
    static constexpr double orthogonal_tolerance = 1e-6;

    void replace(Index face, Index corner, const glm::vec4& value, const glm::dvec3& n,
                 const glm::dvec3& t, bool unit, double along) {
        TangentFallback kind;
        glm::dvec3 made(0.0);
        float sign = value.w;
        if (!finite(t) || n == glm::dvec3(0.0) || !finite(n)) {
            kind = TangentFallback::not_finite;
        } else if (!unit) {
            kind = TangentFallback::not_unit;
            made = from_face(face, n, sign);
        } else if (std::abs(along) > 0.999) {
            kind = TangentFallback::along_normal;
            made = from_face(face, n, sign);
        } else {
            kind = TangentFallback::not_orthogonal;
            made = unit_or_zero(t - along * n);
        }
        const glm::dvec3 base = n == glm::dvec3(0.0) || !finite(n) ? glm::dvec3(0, 0, 1) : n;
        if (made == glm::dvec3(0.0)) made = any_perpendicular(base);
        if (sign != 1.0f && sign != -1.0f) sign = 1.0f;
        out_.tangents.indices[corner] = Index(out_.tangents.values.size());
        out_.tangents.values.push_back(glm::vec4(glm::vec3(made), sign));
        out_.fallbacks.push_back({corner, kind});
    }

    // dP/du of the face in double, on the corner's plane; zero where the face has none. Sums over a
    // polygon's fan, so that a degenerate first triangle does not decide. UVs and edges are scaled
    // by their largest component: neither 1e-30 nor 1e30 vanishes.
    glm::dvec3 from_face(Index face, const glm::dvec3& n, float& sign) const {
        const Index begin = read_.in.face_offsets[face], end = read_.in.face_offsets[face + 1];
        double largest_uv = 0, largest_edge = 0;
        for (Index c = begin + 1; c < end; ++c) {
            const glm::dvec2 uv = glm::abs(glm::dvec2(read_.uv(c)) - glm::dvec2(read_.uv(begin)));
            const glm::dvec3 p =
                glm::abs(glm::dvec3(read_.position(c)) - glm::dvec3(read_.position(begin)));
            largest_uv = std::max({largest_uv, uv.x, uv.y});
            largest_edge = std::max({largest_edge, p.x, p.y, p.z});
        }
        if (!(largest_uv > 0) || !(largest_edge > 0) || !std::isfinite(largest_uv) ||
            !std::isfinite(largest_edge))
            return glm::dvec3(0.0);
        glm::dvec3 sum(0.0);
        double area = 0;
        for (Index c = begin + 1; c + 1 < end; ++c) {
            const glm::dvec3 p0(read_.position(begin));
            const glm::dvec2 t0(read_.uv(begin));
            const glm::dvec3 d1 = (glm::dvec3(read_.position(c)) - p0) / largest_edge;
            const glm::dvec3 d2 = (glm::dvec3(read_.position(c + 1)) - p0) / largest_edge;
            const glm::dvec2 a = (glm::dvec2(read_.uv(c)) - t0) / largest_uv;
            const glm::dvec2 b = (glm::dvec2(read_.uv(c + 1)) - t0) / largest_uv;
            const double area2 = a.x * b.y - a.y * b.x;
            area += area2;
            sum += (area2 < 0 ? -1.0 : 1.0) * (b.y * d1 - a.y * d2);
        }
        const glm::dvec3 on_plane = sum - glm::dot(sum, n) * n;
        // What is left of a gradient along the normal is rounding, not a direction.
        if (!finite(on_plane) || glm::length(on_plane) <= 1e-9 * glm::length(sum))
            return glm::dvec3(0.0);
        if (area != 0) sign = area > 0 ? positive_ : -positive_;
        return unit_or_zero(on_plane);
    }

    CornerReader read_;
    Index never_set_;
    float positive_;
    CornerTangents& out_;
};

}  // namespace

Result<CornerTangents> corner_tangents(const TangentInput& input, const TangentOptions& options) {
    if (auto valid = check_input(input, options); !valid) return std::move(valid).error();
    const CornerReader read{input};
    CornerTangents result;
    const TangentMesh mesh = detail::build_tangent_mesh(input, options);
    for (std::size_t t = 0; t < mesh.good; ++t)
        result.mirrored_triangles +=
            !(mesh.flags[t] & (detail::orientation_preserving | detail::group_with_anything));
    const detail::GroupTangents groups = detail::group_tangents(input, mesh, options);
    result.tangents = Output(input, mesh, groups).make(read);

    const float positive = options.uv_origin == UvOrigin::top_left ? -1.0f : 1.0f;
    for (glm::vec4& v : result.tangents.values) v.w *= positive;
    if (options.mode == TangentMode::mikktspace) {
        Fallbacks(input, Index(groups.values.size()), positive, result).apply();
    }
    return result;
}

}  // namespace prep
