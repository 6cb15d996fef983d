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

// The farthest depth of every block of a tile: what lies behind all blocks that it can reach need
// not be drawn. Depths only ever come nearer, so that old values are safe; they are looked up again
// after as many triangles as cost about as much.
struct FarthestDepths {
    static constexpr std::int32_t block = 16, across = tile_size / block;
    static constexpr std::size_t triangles_between = 128;
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
    bool hide(float nearest, std::int32_t i0, std::int32_t j0, std::int32_t i1,
              std::int32_t j1) const {
        for (std::int32_t y = j0 / block; y <= j1 / block; ++y)
            for (std::int32_t x = i0 / block; x <= i1 / block; ++x)
                if (!(nearest < least[y * across + x])) return false;
        return true;
    }
};

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
    FarthestDepths farthest;
    const bool skip_hidden = place.skip_hidden && count > FarthestDepths::triangles_between / 2;
    for (std::size_t n = 0; n < count; ++n) {
        if (skip_hidden && n % FarthestDepths::triangles_between == 0) farthest.look(depths);
        const SetupTriangle& t = triangles[entries[n].what];
        // Pixels of the tile in the triangle's box.
        const std::int32_t i0 = first_pixel(low(t.x), place.x);
        const std::int32_t j0 = first_pixel(low(t.y), place.y);
        std::int32_t i1 = (high(t.x) - place.x) >> subpixel_bits;
        std::int32_t j1 = (high(t.y) - place.y) >> subpixel_bits;
        i1 = i1 < place.width - 1 ? i1 : place.width - 1;
        j1 = j1 < place.height - 1 ? j1 : place.height - 1;
        if (i0 > i1 || j0 > j1) continue;
        if (skip_hidden && farthest.hide(place.grid(t.z_high), i0, j0, i1, j1)) continue;
        const TileEdges edges = tile_edges(t, place);
        if (edges.missed) continue;

        // Differences of snapped coordinates are exact in float.
        const F z0 = set(t.z0), dzdx = set(t.dzdx), z_low = set(t.z_low), z_high = set(t.z_high);
        const I id = set(std::int32_t(t.id)), number = set(std::int32_t(entries[n].number));
        const std::int32_t from_x = place.x - t.x[0], from_y = place.y - t.y[0];
        I columns[3];
        for (int k = 0; k < 3; ++k) columns[k] = set(edges.dx[k]) * iota();
        for (std::int32_t j = j0; j <= j1; ++j) {
            const F rise = set(t.dzdy * (float(from_y + j * subpixels) * to_pixels));
            std::int32_t row[3];
            for (int k = 0; k < 3; ++k) row[k] = edges.at[k] + edges.dy[k] * j;
            for (std::int32_t i = i0; i <= i1; i += lane_count) {
                const I column = iota() + set(i);
                const auto edge = [&](int k) { return set(row[k] + edges.dx[k] * i) + columns[k]; };
                const I e = (edge(0) | edge(1)) | edge(2);
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

inline std::size_t collect(const std::uint32_t* numbers, const TilePlace& place,
                           std::uint32_t* counts, PixelRun* runs) {
    std::size_t found = 0;
    std::uint32_t before[tile_size + tile_padding + 1];
    for (std::int32_t y = 0; y < place.height; ++y) {
        const std::uint32_t* row = numbers + y * tile_size;
        // The row moved on by one pixel, after a number that is nobody's.
        before[0] = id_none - 1;
        std::uint64_t starts = 0;
        std::uint32_t any_drawn = 0;
        for (std::int32_t x = 0; x < tile_size; x += lane_count)
            store(load(row + x), before + 1 + x);
        for (std::int32_t x = 0; x < tile_size; x += lane_count) {
            const I here = load(row + x);
            starts |= std::uint64_t(bits_of(!(here == load(before + x)))) << x;
            any_drawn |= bits_of(here > set(-1));
        }
        if (any_drawn == 0) continue;
        if (place.width < tile_size) starts &= (std::uint64_t(1) << place.width) - 1;
        while (starts != 0) {
            const int x = __builtin_ctzll(starts);
            starts &= starts - 1;
            const int end = starts != 0 ? __builtin_ctzll(starts) : place.width;
            if (row[x] == id_none) continue;
            runs[found++] = {row[x], std::uint16_t(y * tile_size + x), std::uint16_t(end - x)};
            counts[row[x]] += std::uint32_t(end - x);
        }
    }
    return found;
}
