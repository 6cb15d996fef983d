// Coverage and depth inside one tile.
// Included once per instruction set, inside the namespace that has its lanes.
//
// Edge functions are set up in 64 bits at the tile's first sample. All samples of one kind share
// their low 8 bits, so after the bias for the top-left rule (e + bias) >> 8 has the exact sign at
// every sample and steps by whole slopes. Over a tile an edge that is neither all inside nor all
// outside stays below 2 · 63 · 2^23 < 2^30, so 32 bits hold it.

struct TileEdges {
    std::int32_t at[3], dx[3], dy[3];
    bool missed;
};

inline TileEdges tile_edges(const SetupTriangle& t, const TilePlace& place) {
    TileEdges out{};
    constexpr std::int64_t reach = tile_size - 1;
    for (int k = 0; k < 3; ++k) {
        const int a = k == 2 ? 0 : k + 1, b = a == 2 ? 0 : a + 1;
        const std::int64_t dx = std::int64_t(t.y[a]) - t.y[b];
        const std::int64_t dy = std::int64_t(t.x[b]) - t.x[a];
        // Samples on a left or top edge are inside, on the others outside (y down).
        const std::int64_t bias = dx > 0 || (dx == 0 && dy > 0) ? 0 : -1;
        const std::int64_t e =
            (dx * (place.x - t.x[a]) + dy * (place.y - t.y[a]) + bias) >> subpixel_bits;
        const std::int64_t low = e + (dx < 0 ? dx * reach : 0) + (dy < 0 ? dy * reach : 0);
        const std::int64_t high = e + (dx > 0 ? dx * reach : 0) + (dy > 0 ? dy * reach : 0);
        if (high < 0) {
            out.missed = true;
            return out;
        }
        if (low >= 0) continue;  // the whole tile is inside: 0 + 0 · x + 0 · y is inside as well
        out.at[k] = std::int32_t(e);
        out.dx[k] = std::int32_t(dx);
        out.dy[k] = std::int32_t(dy);
    }
    return out;
}

// DepthGrid, lane by lane. What is beyond the far plane stays there.
inline F on_grid(const DepthGrid& grid, F z) {
    const F low = min(z, set(grid.half));
    const F on = ((low + set(grid.shift)) - set(grid.shift)) + (z - low);
    return select(z >= set(0.0f), min(on, set(grid.top)), z);
}

inline void raster(float* depths, std::uint32_t* ids, const TilePlace& place,
                   const SetupTriangle* triangles, const TileEntry* entries, std::size_t count,
                   const ShadeDraw* masked) {
    constexpr float to_pixels = 1.0f / float(subpixels);
    const auto low = [](const std::int32_t* v) {
        const std::int32_t m = v[0] < v[1] ? v[0] : v[1];
        return m < v[2] ? m : v[2];
    };
    const auto high = [](const std::int32_t* v) {
        const std::int32_t m = v[0] > v[1] ? v[0] : v[1];
        return m > v[2] ? m : v[2];
    };
    const auto first_pixel = [](std::int32_t v, std::int32_t from) {
        return v <= from ? 0 : (v - from + subpixels - 1) >> subpixel_bits;
    };
    for (std::size_t n = 0; n < count; ++n) {
        const SetupTriangle& t = triangles[entries[n].what];
        const TileEdges edges = tile_edges(t, place);
        if (edges.missed) continue;
        // Pixels of the tile in the triangle's box.
        const std::int32_t i0 = first_pixel(low(t.x), place.x);
        const std::int32_t j0 = first_pixel(low(t.y), place.y);
        std::int32_t i1 = (high(t.x) - place.x) >> subpixel_bits;
        std::int32_t j1 = (high(t.y) - place.y) >> subpixel_bits;
        i1 = i1 < place.width - 1 ? i1 : place.width - 1;
        j1 = j1 < place.height - 1 ? j1 : place.height - 1;

        // Differences of snapped coordinates are exact in float.
        const F z0 = set(t.z0), dzdx = set(t.dzdx), z_low = set(t.z_low), z_high = set(t.z_high);
        const I id = set(std::int32_t(t.id)), number = set(std::int32_t(entries[n].number));
        const std::int32_t from_x = place.x - t.x[0], from_y = place.y - t.y[0];
        for (std::int32_t j = j0; j <= j1; ++j) {
            const F rise = set(t.dzdy * (float(from_y + j * subpixels) * to_pixels));
            I row[3];
            for (int k = 0; k < 3; ++k) row[k] = set(edges.at[k] + edges.dy[k] * j);
            for (std::int32_t i = i0; i <= i1; i += lane_count) {
                const I column = iota() + set(i);
                const I e =
                    ((row[0] + set(edges.dx[0]) * column) | (row[1] + set(edges.dx[1]) * column)) |
                    (row[2] + set(edges.dx[2]) * column);
                M hit = (e > set(-1)) & (column < set(i1 + 1));
                if (!any(hit)) continue;
                const std::size_t at = std::size_t(j) * tile_size + std::size_t(i);
                const F run =
                    to_float(shift_left<subpixel_bits>(column) + set(from_x)) * set(to_pixels);
                F z = min(max(z0 + (dzdx * run + rise), z_low), z_high);
                if (place.grid) z = on_grid(place.grid, z);
                const F depth = load(depths + at);
                const I before = load(ids + at);
                hit = hit & (((z > depth) | ((z == depth) & (number < before))) & (z >= set(0.0f)));
                if (!any(hit)) continue;
                if (masked != nullptr)
                    hit = hit & alpha_passes(*masked,
                                             shift_left<subpixel_bits>(column) + set(place.x),
                                             set(place.y + j * subpixels), id);
                store(select(hit, z, depth), depths + at);
                store(select(hit, number, before), ids + at);
            }
        }
    }
}
