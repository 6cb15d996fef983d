// One triangle of middling size, row by row of its box.
// Included once per instruction set, inside the namespace that has its lanes.

// TriangleLanes in memory, and one triangle of it.
struct TriangleBatch {
    std::int32_t edge[3][lane_count], right[3][lane_count], down[3][lane_count];
    std::int32_t i0[lane_count], j0[lane_count], i1[lane_count], j1[lane_count];
    std::int32_t from_x[lane_count], from_y[lane_count];
    float z0[lane_count], dzdx[lane_count], dzdy[lane_count];
    float z_low[lane_count], z_high[lane_count];
    std::int32_t number[lane_count];

    void keep(const TriangleLanes& t) {
        for (int k = 0; k < 3; ++k) {
            store(t.edge[k], edge[k]);
            store(t.right[k], right[k]);
            store(t.down[k], down[k]);
        }
        store(t.i0, i0);
        store(t.j0, j0);
        store(t.i1, i1);
        store(t.j1, j1);
        store(t.from_x, from_x);
        store(t.from_y, from_y);
        store(t.z0, z0);
        store(t.dzdx, dzdx);
        store(t.dzdy, dzdy);
        store(t.z_low, z_low);
        store(t.z_high, z_high);
        store(t.number, number);
    }
};

// What decides beside the edges, of one triangle.
struct TileTarget {
    float* depths;
    std::uint32_t* ids;
    const TilePlace* place;
    const ShadeDraw* masked;  // or null
    I id, number;             // of the triangle: for `masked`, in the tile

    // Where `hit`, and nearer than what is there.
    RAST_INLINE void draw(M hit, F z, I column, std::int32_t row, std::size_t at) const {
        if (place->grid) z = on_grid(place->grid, z);
        const F depth = load(depths + at);
        const I before = load(ids + at);
        hit = hit & (((z > depth) | ((z == depth) & (number < before))) & (z >= set(0.0f)));
        if (!any(hit)) return;
        if (masked != nullptr)
            hit = hit & alpha_passes(*masked, shift_left<subpixel_bits>(column) + set(place->x),
                                     set(place->y + row * subpixels), id);
        store(select(hit, z, depth), depths + at);
        store(select(hit, number, before), ids + at);
    }
};

RAST_INLINE void raster_rows(const TileTarget& target, const TriangleBatch& t, int lane) {
    constexpr float to_pixels = 1.0f / float(subpixels);
    const F z0 = set(t.z0[lane]), dzdx = set(t.dzdx[lane]);
    const F z_low = set(t.z_low[lane]), z_high = set(t.z_high[lane]);
    const std::int32_t i0 = t.i0[lane], i1 = t.i1[lane], j0 = t.j0[lane], j1 = t.j1[lane];
    for (std::int32_t i = i0; i <= i1; i += lane_count) {
        const I column = iota() + set(i);
        const M inside_box = column < set(i1 + 1);
        const F run = dzdx * (to_float(shift_left<subpixel_bits>(column) + set(t.from_x[lane])) *
                              set(to_pixels));
        I e[3];
        for (int k = 0; k < 3; ++k)
            e[k] = set(t.edge[k][lane] + t.down[k][lane] * j0) + set(t.right[k][lane]) * column;
        for (std::int32_t j = j0; j <= j1; ++j) {
            const M hit = (((e[0] | e[1]) | e[2]) > set(-1)) & inside_box;
            for (int k = 0; k < 3; ++k) e[k] = e[k] + set(t.down[k][lane]);
            if (!any(hit)) continue;
            const F rise = set(t.dzdy[lane] * (float(t.from_y[lane] + j * subpixels) * to_pixels));
            const F z = min(max(z0 + (run + rise), z_low), z_high);
            target.draw(hit, z, column, j, std::size_t(j) * tile_size + std::size_t(i));
        }
    }
}
