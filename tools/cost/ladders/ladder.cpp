#include "cost/ladders/ladder.h"

#include <algorithm>
#include <cmath>

namespace cost {

Look look_of(const Pixels& picture, const Pixels& truth) {
    const std::uint32_t width = std::min(look_width, picture.width),
                        height = std::min(look_height, picture.height);
    const std::uint32_t x = (picture.width - width) / 2, y = (picture.height - height) / 2;
    Look look{{width, height, 1, {}}, {width, height, 1, {}}};
    for (std::uint32_t j = y; j < y + height; ++j)
        for (std::uint32_t i = x; i < x + width; ++i) {
            const std::size_t at = (std::size_t(j) * picture.width + i) * picture.channels;
            look.picture.values.push_back(picture.values[at]);
            look.difference.values.push_back(look_gain *
                                             std::abs(picture.values[at] - truth.values[at]));
        }
    return look;
}

std::span<const LadderRow> ladder_rows() {
    static constexpr LadderRow rows[] = {
        {"normal-precision", "arithmetic of corner normals: fast, accurate, exact", true,
         normal_precision_ladder},
        {"weld-distance", "how far vertices may be apart that become one", false,
         weld_distance_ladder},
        {"normal-weight", "what a face counts in a corner's normal", false, normal_weight_ladder},
        {"hard-angle", "threshold of hard edges: normals against vertices", false,
         hard_angle_ladder},
        {"tangent-mode", "how tangents are found, and where they are kept apart", false,
         tangent_mode_ladder},
        {"subdivision-level", "levels of subdivision against the limit surface", false,
         subdivision_level_ladder},
        {"chord-error", "error asked of adaptive triangles against the error they have", false,
         chord_error_ladder},
        {"displacement-error", "error asked of displaced triangles against the error they have",
         false, displacement_error_ladder},
        {"height-filter", "sizes and filters of height maps against the surface they are of", false,
         height_filter_ladder},
        {"shading-frequency", "flat, Gouraud and Phong shading over rising tessellation", false,
         shading_frequency_ladder},
        {"anti-aliasing", "samples, supersampling and exact areas", true, anti_aliasing_ladder},
        {"scene-sampling", "the same of a scene with its camera, lights and materials", true,
         scene_sampling_ladder},
        {"texture-filter", "texture filters and anisotropy", false, texture_filter_ladder},
        {"depth-format", "how depths are kept: surfaces close behind each other", false,
         depth_format_ladder},
        {"quantized-positions", "bits of positions in glTF files", false,
         quantized_positions_ladder},
        {"quantized-normals", "bits of normals in glTF files", false, quantized_normals_ladder},
        {"quantized-tangents", "bits of tangents in glTF files", false, quantized_tangents_ladder},
        {"quantized-uvs", "bits of UVs in glTF files", false, quantized_uvs_ladder},
    };
    return rows;
}

}  // namespace cost
