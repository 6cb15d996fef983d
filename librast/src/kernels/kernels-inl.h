// All kernels, in the order in which they use each other, and the table of them.
// Included once per instruction set, inside the namespace that has its lanes.

// clang-format off
#include "kernels/transform-inl.h"
#include "kernels/cull-inl.h"
#include "kernels/setup-inl.h"
#include "kernels/math-inl.h"
#include "kernels/surface-inl.h"
#include "kernels/texture-inl.h"
#include "kernels/probes-inl.h"
#include "kernels/light-inl.h"
#include "kernels/points-inl.h"
#include "kernels/point_setup-inl.h"
#include "kernels/point_maps-inl.h"
#include "kernels/point_surface-inl.h"
#include "kernels/point_lights-inl.h"
#include "kernels/shade-inl.h"
#include "kernels/attributes-inl.h"
#include "kernels/alpha_mask-inl.h"
#include "kernels/tile_depths-inl.h"
#include "kernels/raster_points-inl.h"
#include "kernels/raster_rows-inl.h"
#include "kernels/raster_blocks-inl.h"
#include "kernels/raster-inl.h"
#include "kernels/collect-inl.h"
// clang-format on

inline constexpr Kernels kernel_table{transform, cull,  set_up,         raster,         collect,
                                      expand,    shade, attributes,     light_vertices, covers,
                                      pack,      fill,  specular_powers};
