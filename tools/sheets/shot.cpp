#include "sheets/shot.h"

#include <algorithm>
#include <cmath>

namespace report {
namespace {

float encoded(float linear) {
    const float x = std::clamp(linear, 0.0f, 1.0f);
    return x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1 / 2.4f) - 0.055f;
}

prep::Image average(const rast::Frame& frame, std::uint32_t samples, bool data) {
    prep::Image image;
    image.width = frame.width / samples;
    image.height = frame.height / samples;
    image.channels = 4;
    image.srgb = true;
    image.pixels.resize(std::size_t(image.width) * image.height * 4);
    const auto total = static_cast<float>(samples * samples);
    for (std::uint32_t y = 0; y < image.height; ++y) {
        for (std::uint32_t x = 0; x < image.width; ++x) {
            glm::vec3 sum(0);
            float covered = 0;
            for (std::uint32_t j = 0; j < samples; ++j) {
                for (std::uint32_t i = 0; i < samples; ++i) {
                    const glm::vec4& c =
                        frame.color[std::size_t(y * samples + j) * frame.width + x * samples + i];
                    if (!(c.a > 0)) continue;
                    // Clipped before averaging, so that one bright sample makes no jagged edge.
                    sum += glm::clamp(glm::vec3(c), 0.0f, 1.0f);
                    covered += 1;
                }
            }
            float* p = image.pixels.data() + (std::size_t(y) * image.width + x) * 4;
            for (int k = 0; k < 3; ++k) {
                const float mean = covered > 0 ? sum[k] / covered : 0.0f;
                p[k] = data ? mean : encoded(mean);
            }
            p[3] = covered / total;
        }
    }
    return image;
}

bool finite(const glm::dvec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

}  // namespace

prep::Result<Shot> take_shot(const prep::PreparedScene& scene, const rast::View& view,
                             const ShotOptions& options) {
    rast::RenderRequest request;
    request.width = request.height = options.size * options.samples;
    request.shading = options.shading;
    request.cull = options.cull;
    request.view = view;
    request.lights = options.lights ? *options.lights : rast::three_light_setup(view);
    request.keep_depth = true;
    request.threads = options.threads;
    prep::Result<rast::RenderPlan> plan = rast::plan(scene, request);
    if (!plan) return plan.error();
    prep::Result<rast::Frame> frame = rast::render(scene, *plan);
    if (!frame) return frame.error();
    Shot shot;
    shot.view = plan->view;
    shot.plan = *std::move(plan);
    shot.frame = *std::move(frame);
    shot.size = options.size;
    shot.samples = options.samples;
    shot.image = average(shot.frame, options.samples, options.data);
    return shot;
}

rast::View fitted_view(const prep::PreparedScene& scene, double azimuth, double elevation,
                       double margin) {
    rast::OrbitOptions orbit;
    orbit.azimuth_degrees = azimuth;
    orbit.elevation_degrees = elevation;
    orbit.aspect = 1;
    rast::View view = rast::orbit_view(scene, orbit);
    view.aspect = 1;
    const glm::dmat3 rotation(view.world_to_view);
    const std::optional<rast::Bounds> bounds = rast::world_bounds(scene);
    if (!bounds || !(bounds->radius() > 0)) return view;

    // A vertex p (in axes of the view, z towards the eye) is inside when |p.x − e.x| ≤ t (e.z −
    // p.z) and likewise for y: four planes, each pushed out by its farthest vertex; their meeting
    // is the eye. About the centre, so that far-off scenes lose no digits.
    const glm::dvec3 centre = bounds->centre();
    const double t = std::tan(view.yfov / 2) / (1 + margin);
    constexpr double lowest = -1e300;
    double right = lowest, left = lowest, top = lowest, bottom = lowest, nearest = lowest;
    const std::vector<glm::dmat4> world = prep::world_transforms(scene.scene);
    for (std::size_t n = 0; n < scene.scene.nodes.size(); ++n) {
        const std::uint32_t m = scene.scene.nodes[n].mesh;
        if (m == prep::no_index) continue;
        const prep::VertexMesh& mesh = scene.meshes[m];
        const glm::dmat3 linear(world[n]);
        const glm::dvec3 offset = linear * mesh.origin + glm::dvec3(world[n][3]) - centre;
        const std::vector<bool> drawn = rast::drawn_vertices(mesh);
        for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
            if (!drawn.empty() && !drawn[v]) continue;
            const glm::dvec3 p = rotation * (linear * glm::dvec3(mesh.positions[v]) + offset);
            if (!finite(p)) continue;
            right = std::max(right, p.x + t * p.z);
            left = std::max(left, -p.x + t * p.z);
            top = std::max(top, p.y + t * p.z);
            bottom = std::max(bottom, -p.y + t * p.z);
            nearest = std::max(nearest, p.z);
        }
    }
    const double z = std::max((right + left) / (2 * t), (top + bottom) / (2 * t));
    const glm::dvec3 eye((right - left) / 2, (top - bottom) / 2, z);
    if (!finite(eye) || !(z > nearest)) return view;
    view.world_to_view = glm::dmat4(rotation);
    view.world_to_view[3] = glm::dvec4(-(rotation * centre) - eye, 1.0);
    view.znear = std::max(0.5 * (z - nearest), 1e-5 * z);
    view.zfar = 0;
    return view;
}

std::vector<rast::LightInstance> normal_color_lights() {
    std::vector<rast::LightInstance> lights;
    rast::LightInstance ambient;
    ambient.kind = prep::LightKind::ambient;
    ambient.color = glm::vec3(0.5f);
    lights.push_back(ambient);
    for (int axis = 0; axis < 3; ++axis) {
        for (const double sign : {1.0, -1.0}) {
            // Light from +axis adds n/2 where n > 0; darkness from −axis takes it where n < 0.
            rast::LightInstance light;
            light.kind = prep::LightKind::directional;
            light.direction = glm::dvec3(0);
            light.direction[axis] = -sign;
            light.color = glm::vec3(0);
            light.color[axis] = static_cast<float>(sign * 0.5);
            lights.push_back(light);
        }
    }
    return lights;
}

}  // namespace report
