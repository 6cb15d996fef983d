// The measuring object as a scene with maps, a view and light.
#pragma once

#include "prep/image.h"
#include "prep/prepare.h"
#include "rast/render.h"

namespace bench {

inline constexpr std::uint32_t width = 1920, height = 1080;

// 1024 × 1024 texels: tiles of two colours with blotches of 4 × 4 texels, sRGB; smooth bumps.
prep::Image diffuse_image();
prep::Image normal_image();

// The bumpy torus with a Blinn-Phong material that has both maps. Ends the program where it cannot
// be prepared.
prep::PreparedScene torus_scene(std::uint64_t triangles, const prep::Image& diffuse,
                                const prep::Image& normals);

// The torus filling the picture a little beyond its top and bottom, a directional light, then
// ambient light, back faces culled, 8-bit colours. `mapped`: both maps, trilinear; else Phong.
rast::RenderRequest torus_request(const prep::PreparedScene& scene, bool mapped);

}  // namespace bench
