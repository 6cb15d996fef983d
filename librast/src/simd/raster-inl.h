// Coverage and depth inside one tile.
// Included once per instruction set, inside the namespace that has its lanes.
//
// All samples of one kind share their low 8 bits, so after the bias for the top-left rule
// (e + bias) >> 8 has the exact sign at every sample and steps by whole slopes. A triangle less
// than 64 pixels wide and high that reaches the tile has edge functions below 2 · 2^14 · 2^15 =
// 2^30 all over it, so 32 bits hold them before the shift. Larger triangles' are set up in 64 bits;
// over a tile one that is neither all inside nor all outside stays below 2 · 63 · 2^23 < 2^30.

// False: the triangle misses the tile.
inline bool wide_edges(const SetupTriangle& t, const TilePlace& place, TriangleBatch& out,
                       int lane) {
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
        if (high < 0) return false;
        // Where the whole tile is inside: 0 + 0 · x + 0 · y is inside as well.
        const bool crosses = low < 0;
        out.edge[k][lane] = crosses ? std::int32_t(e) : 0;
        out.right[k][lane] = crosses ? std::int32_t(dx) : 0;
        out.down[k][lane] = crosses ? std::int32_t(dy) : 0;
    }
    return true;
}

inline void raster(float* depths, std::uint32_t* ids, const TilePlace& place,
                   const SetupTriangle* triangles, const TileEntry* entries, std::size_t count,
                   const ShadeDraw* masked) {
    static_assert(sizeof(SetupTriangle) == 48 && sizeof(TileEntry) == 8);
    static_assert(FarthestDepths::triangles_between % lane_count == 0);
    FarthestDepths farthest;
    const bool skip_hidden = place.skip_hidden && count > FarthestDepths::triangles_between / 2;
    const I one = set(1);
    for (std::size_t n = 0; n < count; n += lane_count) {
        if (skip_hidden && n % FarthestDepths::triangles_between == 0) farthest.look(depths);
        // Lanes past the end repeat the last entry and are left out.
        const std::int32_t left = std::int32_t(count - n < lane_count ? count - n : lane_count);
        const I entry = shift_left<1>(min(iota(), set(left - 1)));
        const I what = gather(&entries[n].what, entry);
        const I at = shift_left<2>(shift_left<1>(what) + what);
        I x[3], y[3];
        for (int k = 0; k < 3; ++k) {
            x[k] = gather(&triangles->x[k], at);
            y[k] = gather(&triangles->y[k], at);
        }
        TriangleLanes t;
        const I low_x = min(min(x[0], x[1]), x[2]), high_x = max(max(x[0], x[1]), x[2]);
        const I low_y = min(min(y[0], y[1]), y[2]), high_y = max(max(y[0], y[1]), y[2]);
        const auto first_pixel = [](I v, std::int32_t from) {
            return max(shift_right<subpixel_bits>(v + set(subpixels - 1 - from)), set(0));
        };
        const auto last_pixel = [](I v, std::int32_t from, std::int32_t extent) {
            return min(shift_right<subpixel_bits>(v - set(from)), set(extent - 1));
        };
        t.i0 = first_pixel(low_x, place.x);
        t.j0 = first_pixel(low_y, place.y);
        t.i1 = last_pixel(high_x, place.x, place.width);
        t.j1 = last_pixel(high_y, place.y, place.height);
        const I across = (t.i1 - t.i0) + one, downwards = (t.j1 - t.j0) + one;
        M there = ((across > set(0)) & (downwards > set(0))) & (iota() < set(left));
        if (!any(there)) continue;
        t.z_low = gather(&triangles->z_low, at);
        t.z_high = gather(&triangles->z_high, at);
        if (skip_hidden) there = there & !farthest.hide(t, place.grid, there);
        if (!any(there)) continue;

        const I limit = set(tile_size * subpixels);
        const M wide = ((high_x - low_x) > limit) | ((high_y - low_y) > limit);
        for (int k = 0; k < 3; ++k) {
            const int a = k == 2 ? 0 : k + 1, b = a == 2 ? 0 : a + 1;
            const I dx = y[a] - y[b], dy = x[b] - x[a];
            // Samples on a left or top edge are inside, on the others outside (y down).
            const M inclusive = (dx > set(0)) | ((dx == set(0)) & (dy > set(0)));
            const I e = (dx * (set(place.x) - x[a]) + dy * (set(place.y) - y[a])) +
                        select(inclusive, set(0), set(-1));
            t.edge[k] = shift_right<subpixel_bits>(e);
            t.right[k] = dx;
            t.down[k] = dy;
        }
        t.from_x = set(place.x) - x[0];
        t.from_y = set(place.y) - y[0];
        t.z0 = gather(&triangles->z0, at);
        t.dzdx = gather(&triangles->dzdx, at);
        t.dzdy = gather(&triangles->dzdy, at);
        t.number = gather(&entries[n].number, entry);

        M few = set(1) < set(0);
        if (masked == nullptr) {
            const I most = set(points_across + 1);
            few = (there & !wide) & ((across < most) & (downwards < most)) &
                  (across * downwards < set(points_in_box + 1));
            if (any(few)) raster_points(depths, ids, place.grid, t, few);
        }
        const std::uint32_t others = bits_of(there & !few);
        if (others == 0) continue;
        TriangleBatch batch;
        batch.keep(t);
        const std::uint32_t huge = bits_of(wide), narrow = bits_of(across < set(17));
        for (std::uint32_t rest = others; rest != 0; rest &= rest - 1) {
            const int lane = __builtin_ctz(rest);
            const SetupTriangle& s = triangles[entries[n + std::size_t(lane)].what];
            const TileTarget target{
                depths, ids, &place, masked, set(std::int32_t(s.id)), set(batch.number[lane])};
            if ((huge >> lane & 1u) != 0 && !wide_edges(s, place, batch, lane)) continue;
            if ((narrow >> lane & 1u) != 0)
                raster_rows(target, batch, lane);
            else
                raster_blocks(target, batch, lane, skip_hidden ? &farthest : nullptr);
        }
    }
}
