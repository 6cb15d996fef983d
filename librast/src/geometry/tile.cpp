#include "geometry/tile.h"

namespace rast::detail {

void TileSamples::clear() {
    depth.assign(tile_pixels + tile_padding, -1.0f);
    id.assign(tile_pixels + tile_padding, id_none);
}

}  // namespace rast::detail
