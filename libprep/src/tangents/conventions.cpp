#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <vector>

#include "prep/tangent_conventions.h"
#include "prep/tangents.h"

namespace prep {
namespace {

constexpr std::uint64_t fewest_corners = 12;

bool frame(const glm::vec4& t) {
    const glm::vec3 d(t);
    const float length2 = glm::dot(d, d);
    return std::isfinite(length2) && length2 > 0 && std::isfinite(t.w) && t.w != 0;
}

double angle_degrees(const glm::vec4& a, const glm::vec4& b) {
    const glm::dvec3 p = glm::normalize(glm::dvec3(a)), q = glm::normalize(glm::dvec3(b));
    return 2 * std::atan2(glm::length(p - q), glm::length(p + q)) * 180 / std::numbers::pi;
}

}  // namespace

TangentConventions tangent_conventions(const Mesh& mesh, std::size_t uv_set, int threads) {
    return uv_set < mesh.uvs.size() ? tangent_conventions(mesh, mesh.uvs[uv_set], threads)
                                    : TangentConventions{};
}

TangentConventions tangent_conventions(const Mesh& mesh, const CornerLayerView<glm::vec2>& uvs,
                                       int threads) {
    TangentConventions out;
    if (mesh.tangents.empty() || mesh.normals.empty() || uvs.empty()) return out;
    TangentOptions options;
    options.threads = threads;
    MeshView view(mesh);
    view.uv = uvs;
    const auto computed = corner_tangents(TangentInput(view), options);
    if (!computed) return out;
    std::vector<bool> mute(mesh.corner_count(), false);
    for (const auto& f : computed->fallbacks) mute[f.corner] = true;
    std::vector<double> angles;
    for (std::size_t c = 0; c < mesh.corner_count(); ++c) {
        const std::uint32_t i = mesh.tangents.indices[c];
        if (i == no_index || mute[c] || !frame(mesh.tangents.values[i])) continue;
        const glm::vec4& own = mesh.tangents.values[i];
        const glm::vec4& made = computed->tangents.values[computed->tangents.indices[c]];
        const double angle = angle_degrees(own, made);
        angles.push_back(angle);
        out.identical += std::memcmp(&own, &made, sizeof(glm::vec3)) == 0;
        out.within_1 += angle <= 1;
        out.within_5 += angle <= 5;
        out.opposite += angle > 175;
        out.same_sign += (own.w < 0) == (made.w < 0);
    }
    out.compared = angles.size();
    if (angles.empty()) return out;
    std::sort(angles.begin(), angles.end());
    out.median_degrees = angles[angles.size() / 2];
    out.largest_degrees = angles.back();
    if (out.compared < fewest_corners) return out;
    const auto share = [&](std::uint64_t count) { return double(count) / double(out.compared); };
    out.method = share(out.within_1) >= 0.99   ? TangentMethod::mikktspace
                 : share(out.within_5) >= 0.95 ? TangentMethod::similar
                                               : TangentMethod::other;
    out.sign = share(out.same_sign) >= 0.9   ? TangentSign::as_gltf
               : share(out.same_sign) <= 0.1 ? TangentSign::inverted
                                             : TangentSign::mixed;
    return out;
}

}  // namespace prep
