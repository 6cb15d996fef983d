// Triangles about to be drawn into a tile, and the depths that it holds.
// Included once per instruction set, inside the namespace that has its lanes.

// DepthGrid, lane by lane. What is beyond the far plane stays there.
inline F on_grid(const DepthGrid& grid, F z) {
    const F low = min(z, set(grid.half));
    const F on = ((low + set(grid.shift)) - set(grid.shift)) + (z - low);
    return select(z >= set(0.0f), min(on, set(grid.top)), z);
}

// Set-up triangles in lanes. Edges are taken from the tile's first sample: value and steps per
// pixel, all shifted right by the sub-pixel bits.
struct TriangleLanes {
    I edge[3], right[3], down[3];
    I i0, j0, i1, j1;  // box in pixels of the tile
    I from_x, from_y;  // from the first corner to the tile's first sample, in 1/256 pixels
    F z0, dzdx, dzdy, z_low, z_high;
    I number;
};

// The farthest depth of every block of a tile: what lies behind all blocks that it can reach need
// not be drawn. Depths only ever come nearer, so that old values are safe.
struct FarthestDepths {
    static constexpr std::int32_t block = 16, across = tile_size / block;
    float least[across * across];

    void look(const float* depths) {
        for (std::int32_t b = 0; b < across * across; ++b) {
            const float* from = depths + b / across * block * tile_size + b % across * block;
            F low = load(from);
            for (std::int32_t y = 0; y < block; ++y)
                for (std::int32_t x = 0; x < block; x += lane_count)
                    low = min(low, load(from + y * tile_size + x));
            float lanes[lane_count];
            store(low, lanes);
            least[b] = lanes[0];
            for (int k = 1; k < lane_count; ++k)
                least[b] = lanes[k] < least[b] ? lanes[k] : least[b];
        }
    }
    // Whether the blocks around the corners of lanes' boxes hide them; boxes that reach others as
    // well are not looked at.
    M hide(const TriangleLanes& t, const DepthGrid& grid, M there) const {
        const I zero = set(0);
        const auto of = [&](I v) { return select(there, shift_right<4>(v), zero); };
        const I x0 = of(t.i0), x1 = of(t.i1), y0 = of(t.j0), y1 = of(t.j1);
        const M close = ((x1 - x0) < set(2)) & ((y1 - y0) < set(2));
        F low = gather(least, shift_left<2>(y0) + x0);
        low = min(low, gather(least, shift_left<2>(y0) + x1));
        low = min(low, gather(least, shift_left<2>(y1) + x0));
        low = min(low, gather(least, shift_left<2>(y1) + x1));
        const F nearest = grid ? on_grid(grid, t.z_high) : t.z_high;
        return close & (nearest < low);
    }
};
