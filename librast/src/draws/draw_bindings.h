// From materials and lights to the plain numbers that the shading kernels read.
#pragma once

#include <memory>
#include <vector>

#include "draws/instance.h"
#include "kernels/kernels.h"
#include "prep/prepared_scene.h"
#include "rast/render.h"

namespace rast::detail {

// A run of one instance's triangles with one material.
struct Draw {
    std::uint32_t instance = 0, material = prep::no_index;
    std::uint32_t first_triangle = 0, triangle_count = 0;
};

// By texture_slot(); null: not read, or not readable.
using TextureSet = std::vector<std::shared_ptr<const MipTexture>>;

// Where nothing is to be left out, neutral textures end a TextureSet: so far from its end.
inline constexpr std::size_t white_map = 3, flat_map = 2, no_slopes = 1;
void add_neutral_maps(TextureSet& textures, TextureLevels levels);

struct FrameInputs {
    ShadeFrame frame;  // points into `lights`
    std::vector<ShadeLight> lights;
};
void set_up_frame(const RenderPlan& plan, FrameInputs& out);

// The instance's records and the scene's meshes must stay where they are.
ShadeDraw shade_draw(const RenderPlan& plan, const prep::PreparedScene& scene, const Draw& draw,
                     const RenderInstance& instance, const TextureSet& textures);

}  // namespace rast::detail
