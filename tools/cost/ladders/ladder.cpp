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

void make_grid(Ladder& ladder, GridSetting first, GridSetting second,
               const std::function<Rung(std::size_t, std::size_t)>& rung) {
    for (std::size_t i = 0; i < first.values.size(); ++i)
        for (std::size_t j = 0; j < second.values.size(); ++j) {
            ladder.rungs.push_back(rung(i, j));
            ladder.rungs.back().name = first.values[i] + ", " + second.values[j];
        }
    ladder.grid = {std::move(first), std::move(second)};
}

std::span<const LadderRow> ladder_rows() {
    static constexpr LadderRow rows[] = {
        {"normal-precision", "arithmetic of corner normals: fast, accurate, exact", true, false,
         normal_precision_ladder},
        {"weld-distance", "how far vertices may be apart that become one", false, false,
         weld_distance_ladder},
        {"normal-weight", "what a face counts in a corner's normal", true, false,
         normal_weight_ladder},
        {"weight-by-precision", "what a face counts and the arithmetic of it, together", false,
         true, weight_by_precision_grid},
        {"hard-angle", "threshold of hard edges: normals against vertices", false, false,
         hard_angle_ladder},
        {"tangent-mode", "how tangents are found, and where they are kept apart", false, false,
         tangent_mode_ladder},
        {"subdivision-level", "levels of subdivision against the limit surface", false, false,
         subdivision_level_ladder},
        {"chord-error", "error asked of adaptive triangles against the error they have", false,
         false, chord_error_ladder},
        {"displacement-error", "error asked of displaced triangles against the error they have",
         false, false, displacement_error_ladder},
        {"height-filter", "sizes and filters of height maps against the surface they are of", false,
         true, height_filter_ladder},
        {"chord-error-by-height-filter",
         "error asked of displaced triangles and the filter of the map, together", false, true,
         chord_error_by_height_filter_grid},
        {"band-limit", "what is left out of heights, against what edges of a length can carry",
         false, false, band_limit_ladder},
        {"relief", "the same heights as bump maps, as normal maps and as displaced triangles",
         false, false, relief_ladder},
        {"shading-frequency", "flat, Gouraud and Phong shading over rising tessellation", false,
         true, shading_frequency_ladder},
        {"anti-aliasing", "samples, supersampling and exact areas", true, false,
         anti_aliasing_ladder},
        {"samples-by-supersampling", "samples and supersampling, together", false, true,
         samples_by_supersampling_grid},
        {"scene-sampling", "the same of a scene with its camera, lights and materials", true, false,
         scene_sampling_ladder},
        {"texture-filter", "texture filters and anisotropy", false, false, texture_filter_ladder},
        {"depth-format", "how depths are kept: surfaces close behind each other", false, false,
         depth_format_ladder},
        {"quantized-positions", "bits of positions in glTF files", false, false,
         quantized_positions_ladder},
        {"quantized-normals", "bits of normals in glTF files", false, false,
         quantized_normals_ladder},
        {"quantized-tangents", "bits of tangents in glTF files", false, false,
         quantized_tangents_ladder},
        {"quantized-uvs", "bits of UVs in glTF files", false, false, quantized_uvs_ladder},
    };
    return rows;
}

}  // namespace cost
