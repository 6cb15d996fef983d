// Where a picture is taken from, and how light falls on it.
//
// Right-handed; the view looks along −Z of its own space, +Y up. Pixel (0, 0) is the top left one.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "prep/prepared_scene.h"

namespace rast {

// plan() refuses what is not as it says here, or not finite, of what the projection reads.
struct View {
    glm::dmat4 world_to_view{1.0};  // rigid: rotation and translation
    bool perspective = true;
    double yfov = 0.7;         // radians, perspective: between 0 and pi
    double half_height = 1.0;  // world units, orthographic: above 0
    double aspect = 0;         // width / height; 0: the picture's
    double znear = 0.01;       // perspective: above 0
    double zfar = 0;           // beyond znear; 0 or infinite: none (see bounded_view())

    glm::dvec3 eye() const;
    glm::dvec3 forward() const;
};

struct LightInstance {
    prep::LightKind kind = prep::LightKind::directional;
    glm::dvec3 position{0.0};        // world; point and spot
    glm::dvec3 direction{0, 0, -1};  // world, unit, the way the light travels; directional and spot
    glm::vec3 color{1.0f};           // linear, times intensity
    float range = 0;                 // 0: no limit
    float inner_cone = 0, outer_cone = 0.785398163f;  // spot: radians from the direction
    std::uint32_t node = prep::no_index;              // of the scene that it stands at
};

// The box of everything that is drawn, in world space; nothing when there is no finite position.
struct Bounds {
    glm::dvec3 low{0.0}, high{0.0};
    glm::dvec3 centre() const { return low * 0.5 + high * 0.5; }
    double radius() const;  // of the sphere about the centre
};
std::optional<Bounds> world_bounds(const prep::PreparedScene& scene);

struct OrbitOptions {
    double azimuth_degrees = 30, elevation_degrees = 20;  // 0, 0: from +Z, looking along −Z
    double distance = 0;  // from the centre of the box; 0: as near as all of the box fits in
    double yfov = 0.6;    // radians, from bottom to top
    double aspect = 4.0 / 3.0;
};
// By vertex whether a triangle has it; empty: all vertices count, as there are no lines or points,
// which are not drawn. O(triangles), or O(1).
std::vector<bool> drawn_vertices(const prep::VertexMesh& mesh);

// A perspective view of the whole scene. An empty scene gives a view of the origin.
View orbit_view(const prep::PreparedScene& scene, const OrbitOptions& options = {});

struct LookAtOptions {
    glm::dvec3 eye{0, 0, 1}, target{0.0};  // world
    glm::dvec3 up{0, 1, 0};                // along or against the gaze: another axis is taken
    double yfov = 0.6;                     // radians, from bottom to top
};
// A perspective view from one place towards another, with a near plane as far as the scene allows
// (never nearer than 1/10,000 of the way to its farthest corner, nor than a hundredth of the way to
// the target, whichever is less). The eye upon the target: looks along −Z.
View look_at_view(const prep::PreparedScene& scene, const LookAtOptions& options);

// The same place and direction without perspective, `height` world units from bottom to top of the
// picture (0: as many as show all of the scene), near and far planes around the scene.
View orthographic_view(const prep::PreparedScene& scene, const View& view, double height,
                       double aspect);

// The camera carried around the vertical axis (+Y) through `centre`, eastwards: an orbit's azimuth
// grows.
View turned_view(const View& view, const glm::dvec3& centre, double radians);

// The same view, but that an orthographic one without a far plane (zfar 0 or infinite, which depth
// in equal steps cannot have), or with one far beyond the scene (which leaves no steps for the
// scene itself), gets one just behind the scene.
View bounded_view(const prep::PreparedScene& scene, const View& view);

// The view of a camera node, for a picture of that aspect. Where the camera names another one, the
// picture shows all that the camera frames, undistorted, and more above and below or at the sides.
// Orthographic extents below 0, which glTF advises against, count as those above: nothing is
// mirrored.
View camera_view(const prep::Scene& scene, std::uint32_t camera_node, double aspect);

// A key, a fill and a rim light that stand with the view (from above on the left, from the right
// and from behind above it: 0.85, 0.28 and 0.45, the first two with a tint), and ambient light of
// 0.08.
std::vector<LightInstance> three_light_setup(const View& view);

// The scene's own lights in world space.
std::vector<LightInstance> scene_lights(const prep::Scene& scene);

// World position → pixel coordinates (x right, y down, in pixels) and depth (reversed z, 1 at the
// near plane, as in Frame::depth). Nothing in front of the near plane or behind the eye is visible.
struct Projected {
    double x = 0, y = 0, depth = 0;
    bool visible = false;
};
Projected project(const View& view, std::uint32_t width, std::uint32_t height,
                  const glm::dvec3& world);

// Clip-space matrix with reversed z: depth = z / w runs from 1 at the near plane to 0 at the far
// one.
glm::dmat4 projection(const View& view, double aspect);

}  // namespace rast
