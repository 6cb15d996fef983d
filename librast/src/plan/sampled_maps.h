// Which of a material's maps a picture reads, whatever the meshes have: one rule for the plan and
// the draws.
#pragma once

#include "prep/material.h"
#include "rast/render.h"

namespace rast::detail {

inline bool is_sampled(const prep::MaterialMap& map, const prep::Material& material,
                       Shading shading) {
    switch (map.use) {
        case prep::MapUse::always:
            return true;
        case prep::MapUse::lit:
            return !material.unlit;
        case prep::MapUse::metallic_roughness:
            return !material.unlit && material.metallic_roughness;
        case prep::MapUse::normals:
            return !material.unlit && shading == Shading::normal_mapped;
        case prep::MapUse::not_drawn:
            break;
    }
    return false;
}

}  // namespace rast::detail
