// The exposure that a picture asks for.
//
// Lights come in units that their file does not say (candela, watts of a lamp, numbers about 1),
// and Blinn-Phong knows no camera. The picture itself tells: drawn once, small, its brightest
// surfaces (but for the 2 % that are highlights) are put at 0.8 of white. A picture that needs
// nothing keeps exposure 1, bit for bit.
#pragma once

#include <cstdint>

#include "rast/render.h"

namespace rast {

struct FoundExposure {
    float exposure = 1;  // three decimal digits, so that it can be given by hand
    float bright = 0;    // luminance (Rec. 709) that 98 % of the surfaces' pixels do not exceed
    std::uint64_t pixels = 0;  // that show a surface
};

// Of request.view and its lights, whatever crop, bands, samples and buffers the request has: parts
// and views of one picture share it if it is asked once. `bright` from 0.25 to 1 is left alone; 0
// (nothing is seen, or lit) gives 1. Errors: those of plan() for that small
// picture.
prep::Result<FoundExposure> find_exposure(SceneRenderer& renderer, const prep::PreparedScene& scene,
                                          RenderRequest request);

// With this exposure, above 0. Light is multiplied by it; what is behind the scene is not lit, and
// is seen as the choices had it.
void expose(prep::RenderChoices& choices, float exposure);

}  // namespace rast
