// Pictures put on meshes to make UVs and tangents visible, made once in a program's life.
#pragma once

#include "prep/image.h"
#include "prep/result.h"
#include "prep/scene.h"

namespace report {

// 1024², 8 × 8 cells named A1 (top left) to H8, a hue per column: shows stretch, direction,
// mirroring (letters read backwards) and seams.
prep::Result<prep::ImageRef> uv_checker();

// 512², tangent-space normal map (green up) of 6 × 6 round bumps on a plane.
prep::Result<prep::ImageRef> bump_normal_map();

}  // namespace report
