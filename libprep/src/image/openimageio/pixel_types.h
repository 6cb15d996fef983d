// How pixel values are stored, shared by the writers.
#pragma once

#include <OpenImageIO/typedesc.h>

#include "prep/image.h"

namespace prep::detail {

inline OIIO::TypeDesc type_of(PixelType type) {
    switch (type) {
        case PixelType::u8:
            return OIIO::TypeDesc::UINT8;
        case PixelType::u16:
            return OIIO::TypeDesc::UINT16;
        case PixelType::f16:
            return OIIO::TypeDesc::HALF;
        case PixelType::f32:
            break;
    }
    return OIIO::TypeDesc::FLOAT;
}

}  // namespace prep::detail
