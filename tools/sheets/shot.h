// Square, anti-aliased, transparent pictures of a prepared scene for report sheets: librast's frame
// at several samples a pixel, averaged.
#pragma once

#include <optional>
#include <vector>

#include "prep/image.h"
#include "prep/prepared_scene.h"
#include "prep/result.h"
#include "rast/render.h"

namespace report {

struct ShotOptions {
    std::uint32_t size = 480;   // pixels, width and height
    std::uint32_t samples = 3;  // per pixel and axis
    rast::Shading shading = rast::Shading::phong;
    rast::Cull cull = rast::Cull::by_material;
    std::optional<std::vector<rast::LightInstance>> lights;  // unset: key, fill, rim and ambient
    bool data = false;  // colours are values 0…1, not light: no sRGB encoding
    int threads = 0;
};

struct Shot {
    rast::View view;
    rast::RenderPlan plan;
    rast::Frame frame;  // size · samples in each direction, with depth
    std::uint32_t size = 0, samples = 1;
    // RGBA, straight alpha (how much of the pixel is covered), sRGB-encoded unless `data`.
    prep::Image image;
};

prep::Result<Shot> take_shot(const prep::PreparedScene& scene, const rast::View& view,
                             const ShotOptions& options);

// The closest view from a direction (degrees, as in rast::OrbitOptions) that shows every finite
// vertex with `margin` (a fraction of the half width) to spare in a square picture. A scene without
// extent is framed as rast::orbit_view does. O(vertices).
rast::View fitted_view(const prep::PreparedScene& scene, double azimuth_degrees,
                       double elevation_degrees, double margin = 0.06);

// Lights whose sum is (1 + n) / 2 per axis for a surface of normal n, diffuse white: pictures of
// the normals themselves, as the renderer interpolates them.
std::vector<rast::LightInstance> normal_color_lights();

}  // namespace report
