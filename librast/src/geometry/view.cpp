#include "rast/view.h"

#include <algorithm>
#include <cmath>

#include "base/finite.h"

namespace rast {
namespace {

glm::dvec3 safe_unit(const glm::dvec3& v, const glm::dvec3& otherwise) {
    const double length = glm::length(v);
    return length > 0 && std::isfinite(length) ? v / length : otherwise;
}

// Nearest and farthest place along the view's direction that the box reaches.
struct DepthRange {
    double nearest = 0, farthest = 0;
};
DepthRange depths_of(const Bounds& bounds, const View& view) {
    DepthRange range{INFINITY, -INFINITY};
    const glm::dmat3 rotation(view.world_to_view);
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 p(corner & 1 ? bounds.high.x : bounds.low.x,
                           corner & 2 ? bounds.high.y : bounds.low.y,
                           corner & 4 ? bounds.high.z : bounds.low.z);
        const double depth = -(rotation * (p - view.eye())).z;
        range.nearest = std::min(range.nearest, depth);
        range.farthest = std::max(range.farthest, depth);
    }
    return range;
}

// Axes of a view that looks along −back.
glm::dmat3 axes_of(const glm::dvec3& back, const glm::dvec3& up) {
    glm::dvec3 right = glm::cross(safe_unit(up, {0, 1, 0}), back);
    if (!(glm::length(right) > 1e-6))
        right = glm::cross(
            std::abs(back.y) > 0.9 ? glm::dvec3(0, 0, back.y > 0 ? -1 : 1) : glm::dvec3(0, 1, 0),
            back);
    right = glm::normalize(right);
    return glm::transpose(glm::dmat3(right, glm::cross(back, right), back));
}

void put(View& view, const glm::dmat3& rotation, const glm::dvec3& eye) {
    view.world_to_view = glm::dmat4(rotation);
    view.world_to_view[3] = glm::dvec4(-(rotation * eye), 1.0);
}

constexpr double margin = 1.08;  // of the picture's half extent, around what is framed
constexpr double degree = 3.14159265358979323846 / 180;

}  // namespace

glm::dvec3 View::eye() const {
    // Rigid: the inverse is the transpose.
    const glm::dmat3 rotation(world_to_view);
    return -(glm::transpose(rotation) * glm::dvec3(world_to_view[3]));
}

glm::dvec3 View::forward() const {
    return -(glm::transpose(glm::dmat3(world_to_view)) * glm::dvec3(0, 0, 1));
}

double Bounds::radius() const {
    const glm::dvec3 half = high * 0.5 - low * 0.5;
    return std::hypot(half.x, half.y, half.z);
}

std::vector<bool> drawn_vertices(const prep::VertexMesh& mesh) {
    if (mesh.lines.empty() && mesh.points.empty()) return {};
    std::vector<bool> drawn(mesh.vertex_count(), false);
    for (const std::uint32_t v : mesh.indices) drawn[v] = true;
    return drawn;
}

std::optional<Bounds> world_bounds(const prep::PreparedScene& prepared) {
    const std::vector<glm::dmat4> world = prep::world_transforms(prepared.scene);
    Bounds bounds;
    bool any = false;
    for (std::size_t n = 0; n < prepared.scene.nodes.size(); ++n) {
        const std::uint32_t m = prepared.scene.nodes[n].mesh;
        if (m == prep::no_index) continue;
        const prep::VertexMesh& mesh = prepared.meshes[m];
        const std::vector<bool> drawn = drawn_vertices(mesh);
        for (std::size_t v = 0; v < mesh.vertex_count(); ++v) {
            if (!drawn.empty() && !drawn[v]) continue;
            const glm::dvec3 p(mesh.positions[v]);
            const glm::dvec3 w(world[n] * glm::dvec4(p + mesh.origin, 1.0));
            if (!prep::detail::is_finite(w)) continue;
            bounds.low = any ? glm::min(bounds.low, w) : w;
            bounds.high = any ? glm::max(bounds.high, w) : w;
            any = true;
        }
    }
    if (!any) return std::nullopt;
    return bounds;
}

View orbit_view(const prep::PreparedScene& scene, const OrbitOptions& options) {
    const std::optional<Bounds> bounds = world_bounds(scene);
    const glm::dvec3 centre = bounds ? bounds->centre() : glm::dvec3(0.0);
    double radius = bounds ? bounds->radius() : 0.5;
    if (!(radius > 0)) radius = std::max(0.5, glm::length(centre) * 1e-6);  // a single point
    const double azimuth = options.azimuth_degrees * degree;
    const double elevation = options.elevation_degrees * degree;
    const glm::dvec3 direction(std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
                               std::cos(azimuth) * std::cos(elevation));
    View view;
    view.yfov = options.yfov;
    const glm::dvec3 back = safe_unit(direction, {0, 0, 1});
    // From the azimuth alone, so that a view from straight above turns with it.
    const glm::dvec3 right = safe_unit({std::cos(azimuth), 0, -std::sin(azimuth)}, {1, 0, 0});
    const glm::dvec3 up = glm::cross(back, right);
    const glm::dmat3 rotation = glm::transpose(glm::dmat3(right, up, back));

    // The nearest distance from which all corners of the box are inside the frustum, with a margin.
    const double tangent_v = std::tan(options.yfov / 2), tangent_h = tangent_v * options.aspect;
    const glm::dvec3 half = bounds ? bounds->high * 0.5 - bounds->low * 0.5 : glm::dvec3(0.0);
    double fitting = 0, nearest = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 p =
            rotation * glm::dvec3(corner & 1 ? half.x : -half.x, corner & 2 ? half.y : -half.y,
                                  corner & 4 ? half.z : -half.z);
        fitting = std::max({fitting, p.z + margin * std::abs(p.x) / tangent_h,
                            p.z + margin * std::abs(p.y) / tangent_v});
        nearest = std::max(nearest, p.z);
    }
    if (!(fitting > 0)) fitting = radius / std::sin(std::atan(std::min(tangent_h, tangent_v)));
    const double distance = options.distance > 0 ? options.distance : fitting;
    const glm::dvec3 eye = centre + back * distance;
    view.world_to_view = glm::dmat4(rotation);
    view.world_to_view[3] = glm::dvec4(-(rotation * eye), 1.0);
    view.znear = std::max(0.99 * (distance - nearest), distance * 1e-3);
    return view;
}

View look_at_view(const prep::PreparedScene& scene, const LookAtOptions& options) {
    View view;
    view.yfov = options.yfov;
    const glm::dvec3 back = safe_unit(options.eye - options.target, {0, 0, 1});
    put(view, axes_of(back, options.up), options.eye);
    const std::optional<Bounds> bounds = world_bounds(scene);
    const double way = glm::length(options.eye - options.target);
    view.znear = way > 0 ? way * 1e-2 : 1e-2;
    if (!bounds) return view;
    const DepthRange range = depths_of(*bounds, view);
    const double farthest = range.farthest > 0 ? range.farthest : way;
    // Never so far that it cuts what lies between the eye and a hundredth of the way to the target:
    // depth's relative steps do not depend on it.
    view.znear = std::max(0.99 * range.nearest, std::min(farthest * 1e-4, way * 1e-2));
    if (!(view.znear > 0)) view.znear = 1e-2;
    return view;
}

View orthographic_view(const prep::PreparedScene& scene, const View& view, double height,
                       double aspect) {
    View out = view;
    out.perspective = false;
    out.half_height = height / 2;
    out.znear = 0;
    out.zfar = 1;
    const std::optional<Bounds> bounds = world_bounds(scene);
    if (bounds) {
        const DepthRange range = depths_of(*bounds, view);
        // A hundredth more on both sides: what lies in the box's sides is not to be cut.
        const double more = std::max(range.farthest - range.nearest, bounds->radius()) * 0.01;
        out.znear = std::max(range.nearest - more, 0.0);
        out.zfar = std::max(range.farthest + more, out.znear + 1e-30);
    }
    if (!(out.zfar > out.znear)) out.zfar = out.znear + 1;
    if (height > 0) return out;
    out.half_height = 1;
    if (!bounds) return out;
    double half = 0;
    const glm::dmat3 rotation(view.world_to_view);
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 p(corner & 1 ? bounds->high.x : bounds->low.x,
                           corner & 2 ? bounds->high.y : bounds->low.y,
                           corner & 4 ? bounds->high.z : bounds->low.z);
        const glm::dvec3 q = rotation * (p - view.eye());
        half = std::max({half, std::abs(q.y), std::abs(q.x) / aspect});
    }
    if (half > 0) out.half_height = margin * half;
    return out;
}

View bounded_view(const prep::PreparedScene& scene, const View& view) {
    View out = view;
    if (view.perspective) return out;
    const bool has_far = view.zfar != 0 && std::isfinite(view.zfar);
    out.zfar = std::max(2 * view.znear, 1e-30);
    if (const std::optional<Bounds> bounds = world_bounds(scene)) {
        const DepthRange range = depths_of(*bounds, view);
        const double more = std::max(range.farthest - range.nearest, bounds->radius()) * 0.01;
        out.zfar = std::max(out.zfar, range.farthest + more);
    }
    // Depths without perspective are as fine as the far plane is near. One that is a few times as
    // far as all that there is takes nothing that can be seen, and stays.
    constexpr double few = 64;
    if (has_far && view.zfar <= few * out.zfar) out.zfar = view.zfar;
    return out;
}

View turned_view(const View& view, const glm::dvec3& centre, double radians) {
    const double c = std::cos(radians), s = std::sin(radians);
    const glm::dmat3 turn(glm::dvec3(c, 0, -s), glm::dvec3(0, 1, 0), glm::dvec3(s, 0, c));
    View out = view;
    put(out, glm::dmat3(view.world_to_view) * glm::transpose(turn),
        centre + turn * (view.eye() - centre));
    return out;
}

View camera_view(const prep::Scene& scene, std::uint32_t camera_node, double aspect) {
    const glm::dmat4 world = prep::world_transforms(scene)[camera_node];
    const prep::Camera& camera = scene.cameras[scene.nodes[camera_node].camera];
    // Scale and shear have no meaning for a camera: the axes are made orthonormal again.
    const glm::dvec3 back = safe_unit(glm::dvec3(world[2]), {0, 0, 1});
    const glm::dvec3 up_axis = safe_unit(glm::dvec3(world[1]), {0, 1, 0});
    glm::dvec3 right = glm::cross(up_axis, back);
    right = safe_unit(right, std::abs(back.x) < 0.9 ? glm::cross(glm::dvec3(1, 0, 0), back)
                                                    : glm::cross(glm::dvec3(0, 1, 0), back));
    right = glm::normalize(right);
    const glm::dmat3 rotation = glm::transpose(glm::dmat3(right, glm::cross(back, right), back));
    View view;
    view.world_to_view = glm::dmat4(rotation);
    view.world_to_view[3] = glm::dvec4(-(rotation * glm::dvec3(world[3])), 1.0);
    view.perspective = camera.perspective;
    view.yfov = camera.yfov;
    view.half_height = std::abs(camera.ymag);
    view.aspect = aspect;
    const double own = camera.perspective ? camera.aspect : std::abs(camera.xmag / camera.ymag);
    if (own > aspect && std::isfinite(own)) {
        view.yfov = 2 * std::atan(std::tan(camera.yfov / 2) * (own / aspect));
        view.half_height *= own / aspect;
    }
    view.znear = camera.znear;
    view.zfar = camera.zfar;
    return view;
}

std::vector<LightInstance> three_light_setup(const View& view) {
    const glm::dmat3 to_world = glm::transpose(glm::dmat3(view.world_to_view));
    const auto directional = [&](const glm::dvec3& from_view, float intensity, glm::vec3 tint) {
        LightInstance light;
        light.kind = prep::LightKind::directional;
        light.direction = to_world * -glm::normalize(from_view);
        light.color = tint * intensity;
        return light;
    };
    LightInstance ambient;
    ambient.kind = prep::LightKind::ambient;
    ambient.color = glm::vec3(0.08f);
    return {directional({-0.55, 0.65, 0.75}, 0.85f, {1.0f, 0.98f, 0.94f}),
            directional({0.9, 0.15, 0.6}, 0.28f, {0.9f, 0.95f, 1.0f}),
            directional({0.3, 0.7, -0.9}, 0.45f, {1.0f, 1.0f, 1.0f}), ambient};
}

std::vector<LightInstance> scene_lights(const prep::Scene& scene) {
    const std::vector<glm::dmat4> world = prep::world_transforms(scene);
    std::vector<LightInstance> lights;
    for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
        if (scene.nodes[n].light == prep::no_index) continue;
        const prep::Light& source = scene.lights[scene.nodes[n].light];
        LightInstance light;
        light.kind = source.kind;
        light.position = glm::dvec3(world[n][3]);
        light.direction = safe_unit(-glm::dvec3(world[n][2]), {0, 0, -1});
        light.color = source.color * source.intensity;
        light.range = source.range;
        light.inner_cone = source.inner_cone;
        light.outer_cone = source.outer_cone;
        light.node = std::uint32_t(n);
        lights.push_back(light);
    }
    return lights;
}

glm::dmat4 projection(const View& view, double aspect) {
    glm::dmat4 p(0.0);
    const double n = view.znear, f = view.zfar;
    if (view.perspective) {
        const double scale = 1.0 / std::tan(view.yfov / 2);
        p[0][0] = scale / aspect;
        p[1][1] = scale;
        p[2][3] = -1;
        // depth · w = a·z + b with depth 1 at z = −n and 0 at z = −f.
        if (f > 0 && std::isfinite(f)) {
            p[2][2] = n / (f - n);
            p[3][2] = n * f / (f - n);
        } else {
            p[3][2] = n;
        }
    } else {
        p[0][0] = 1.0 / (view.half_height * aspect);
        p[1][1] = 1.0 / view.half_height;
        p[2][2] = 1.0 / (f - n);
        p[3][2] = f / (f - n);
        p[3][3] = 1;
    }
    return p;
}

Projected project(const View& view, std::uint32_t width, std::uint32_t height,
                  const glm::dvec3& world) {
    const double aspect = view.aspect > 0 ? view.aspect : double(width) / height;
    const glm::dvec3 in_view = glm::dmat3(view.world_to_view) * (world - view.eye());
    const glm::dvec4 clip = projection(view, aspect) * glm::dvec4(in_view, 1.0);
    Projected result;
    if (!(clip.w > 0)) return result;
    result.x = (clip.x / clip.w * 0.5 + 0.5) * width;
    result.y = (0.5 - clip.y / clip.w * 0.5) * height;
    result.depth = clip.z / clip.w;
    result.visible = result.depth <= 1 && result.depth >= 0;
    return result;
}

}  // namespace rast
