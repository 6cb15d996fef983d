// Triangles of a few pixels: one in each lane, all of them pixel by pixel of their boxes. What is
// covered is listed first and held against the tile's depths afterwards, one point at a time, so
// that triangles of one batch may share pixels.
// Included once per instruction set, inside the namespace that has its lanes.

// Boxes of at most so many pixels.
inline constexpr std::int32_t points_across = 8, points_in_box = 20;

// `chosen`: lanes to be drawn; their boxes are within the limits above.
RAST_INLINE void raster_points(float* depths, std::uint32_t* ids, const DepthGrid& grid,
                               const TriangleLanes& t, M chosen) {
    constexpr float to_pixels = 1.0f / float(subpixels);
    constexpr std::size_t most = std::size_t(points_across) * points_across * lane_count;
    std::int32_t places[most + lane_count], numbers[most + lane_count];
    float nearness[most + lane_count];
    std::size_t found = 0;
    const I nothing = set(-1);
    const I across = select(chosen, t.i1 - t.i0, nothing);
    const I downwards = select(chosen, t.j1 - t.j0, nothing);
    const std::int32_t most_across = largest(across), most_down = largest(downwards);
    I row[3];
    for (int k = 0; k < 3; ++k) row[k] = t.edge[k] + (t.right[k] * t.i0 + t.down[k] * t.j0);
    const I first = shift_left<6>(t.j0) + t.i0;
    const I first_run = shift_left<subpixel_bits>(t.i0) + t.from_x;
    const I first_rise = shift_left<subpixel_bits>(t.j0) + t.from_y;
    for (std::int32_t j = 0; j <= most_down; ++j) {
        I e[3] = {row[0], row[1], row[2]};
        const F rise = t.dzdy * (to_float(first_rise + set(j << subpixel_bits)) * set(to_pixels));
        // Lanes whose box has no such row have no such column either.
        const I columns = select(downwards < set(j), nothing, across);
        for (std::int32_t i = 0; i <= most_across; ++i) {
            M hit = (((e[0] | e[1]) | e[2]) > nothing) & (columns > set(i - 1));
            for (int k = 0; k < 3; ++k) e[k] = e[k] + t.right[k];
            if (!any(hit)) continue;
            const F run = to_float(first_run + set(i << subpixel_bits)) * set(to_pixels);
            F z = min(max(t.z0 + (t.dzdx * run + rise), t.z_low), t.z_high);
            if (grid) z = on_grid(grid, z);
            hit = hit & (z >= set(0.0f));
            compress_store(hit, first + set(j * tile_size + i), places + found);
            compress_store(hit, t.number, numbers + found);
            found += compress_store(hit, z, nearness + found);
        }
        for (int k = 0; k < 3; ++k) row[k] = row[k] + t.down[k];
    }
    for (std::size_t f = 0; f < found; ++f) {
        float& depth = depths[places[f]];
        std::uint32_t& id = ids[places[f]];
        const float z = nearness[f];
        const std::uint32_t number = std::uint32_t(numbers[f]);
        const bool nearer = (z > depth) | ((z == depth) & (number < id));
        depth = nearer ? z : depth;
        id = nearer ? number : id;
    }
}
