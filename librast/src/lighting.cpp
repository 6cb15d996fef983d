#include "lighting.h"

#include <algorithm>
#include <cmath>

#include "elementary.h"

namespace rast {

std::vector<ShadingLight> shading_lights(std::span<const LightInstance> lights,
                                         const glm::dvec3& eye) {
    std::vector<ShadingLight> result;
    for (const LightInstance& light : lights) {
        ShadingLight s{light.kind, glm::vec3(light.position - eye), glm::vec3(light.direction),
                       light.color};
        if (light.range > 0) s.inverse_range = 1 / light.range;
        if (light.kind == prep::LightKind::spot) {
            // KHR_lights_punctual's falloff between the cones.
            const float inner = float(std::cos(double(light.inner_cone)));
            const float outer = float(std::cos(double(light.outer_cone)));
            s.cone_scale = 1 / std::max(0.001f, inner - outer);
            s.cone_offset = -outer * s.cone_scale;
        }
        result.push_back(s);
    }
    return result;
}

float specular_power(const glm::vec3& normal, const glm::vec3& half, float shininess) {
    const glm::dvec3 n(normal), h(half);
    const double cosine = glm::dot(n, h);
    if (!(cosine > 0)) return shininess == 0 ? 1.0f : 0.0f;
    // Unit in float is not unit: the lengths' 1e-7 would come out multiplied by the logarithm.
    const double lengths2 = glm::dot(n, n) * glm::dot(h, h);
    const glm::dvec3 cross = glm::cross(n, h);
    const double sine2 = glm::dot(cross, cross) / lengths2;
    const double logarithm =
        sine2 < 0.5 ? log1m_portable(sine2) : log_portable(cosine * cosine / lengths2);
    return float(exp_portable(0.5 * double(shininess) * logarithm));
}

LightSum illuminate(std::span<const ShadingLight> lights, const glm::vec3& position,
                    const glm::vec3& normal, const glm::vec3& to_eye, float shininess) {
    LightSum sum;
    for (const ShadingLight& light : lights) {
        if (light.kind == prep::LightKind::ambient) {
            sum.ambient += light.color;
            continue;
        }
        glm::vec3 to_light = -light.direction;
        glm::vec3 color = light.color;
        if (light.kind != prep::LightKind::directional) {
            const glm::vec3 offset = light.position - position;
            const float squared = glm::dot(offset, offset);
            // A light exactly on the surface would be infinitely bright: it adds nothing.
            if (!(squared > 0)) continue;
            const float distance = std::sqrt(squared);
            to_light = offset / distance;
            color /= squared;
            if (light.inverse_range > 0) {
                const float r = distance * light.inverse_range, r2 = r * r;
                color *= std::clamp(1 - r2 * r2, 0.0f, 1.0f);
            }
            if (light.kind == prep::LightKind::spot) {
                const float cosine = -glm::dot(light.direction, to_light);
                const float t =
                    std::clamp(cosine * light.cone_scale + light.cone_offset, 0.0f, 1.0f);
                color *= t * t;
            }
        }
        const float facing = glm::dot(normal, to_light);
        if (!(facing > 0)) continue;
        sum.diffuse += color * facing;
        const glm::vec3 half = to_light + to_eye;
        const float length = std::sqrt(glm::dot(half, half));
        if (length > 0) sum.specular += color * specular_power(normal, half / length, shininess);
    }
    return sum;
}

}  // namespace rast
