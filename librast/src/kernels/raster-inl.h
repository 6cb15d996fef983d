// Coverage and depth inside one tile.
// Included once per instruction set, inside the namespace that has its lanes.
//
// All samples of one kind share their low 8 bits, so after the bias for the top-left rule
// (e + bias) >> 8 has the exact sign at every sample and steps by whole slopes. A triangle less
// than 64 pixels wide and high that reaches the tile has edge functions below 2 · 2^14 · 2^15 =
// 2^30 all over it, so 32 bits hold them before the shift. Larger triangles' are set up in 64 bits;
// over a tile one that is neither all inside nor all outside stays below 2 · 63 · 2^23 < 2^30.

// Of the block's triangle n; false: it misses the tile.
inline bool wide_edges(const SetupBlock& t, std::size_t n, const TilePlace& place,
                       TriangleBatch& out, int lane) {
    constexpr std::int64_t reach = tile_size - 1;
    for (int k = 0; k < 3; ++k) {
        const int a = k == 2 ? 0 : k + 1, b = a == 2 ? 0 : a + 1;
        const std::int64_t x = t.x[a][n], y = t.y[a][n];
        const std::int64_t dx = y - t.y[b][n], dy = t.x[b][n] - x;
        // Samples on a left or top edge are inside, on the others outside (y down).
        const std::int64_t bias = dx > 0 || (dx == 0 && dy > 0) ? 0 : -1;
        const std::int64_t e = (dx * (place.x - x) + dy * (place.y - y) + bias) >> subpixel_bits;
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

template <bool plain>
inline void draw_one(const OneTriangle<plain>& one, bool rows, const FarthestDepths* farthest) {
    if (rows)
        one.draw_rows();
    else
        draw_blocks(one, farthest);
}

inline void raster(float* depths, std::uint32_t* ids, const TilePlace& place,
                   const SetupBlock& block, std::size_t count, std::uint32_t first_number,
                   const ShadeDraw* masked) {
    // Looking costs about as much as so many triangles.
    const bool skip_hidden = place.skip_hidden && count > SetupBlock::capacity / 2;
    FarthestDepths farthest;
    if (skip_hidden) farthest.look(depths);
    const TileTarget target{depths, ids, &place, masked};
    const bool simple = !place.grid && masked == nullptr;
    const I zero = set(0);
    for (std::size_t n = 0; n < count; n += lane_count) {
        const std::int32_t left = std::int32_t(count - n < lane_count ? count - n : lane_count);
        I x[3], y[3];
        for (int k = 0; k < 3; ++k) {
            x[k] = load(block.x[k] + n);
            y[k] = load(block.y[k] + n);
        }
        TriangleLanes t;
        const I low_x = min(min(x[0], x[1]), x[2]), high_x = max(max(x[0], x[1]), x[2]);
        const I low_y = min(min(y[0], y[1]), y[2]), high_y = max(max(y[0], y[1]), y[2]);
        const auto first_pixel = [&](I v, std::int32_t from) {
            return max(shift_right<subpixel_bits>(v + set(subpixels - 1 - from)), zero);
        };
        const auto last_pixel = [](I v, std::int32_t from, std::int32_t extent) {
            return min(shift_right<subpixel_bits>(v - set(from)), set(extent - 1));
        };
        t.i0 = first_pixel(low_x, place.x);
        t.j0 = first_pixel(low_y, place.y);
        t.i1 = last_pixel(high_x, place.x, place.width);
        t.j1 = last_pixel(high_y, place.y, place.height);
        const I across = (t.i1 - t.i0) + set(1), downwards = (t.j1 - t.j0) + set(1);
        M there = ((across > zero) & (downwards > zero)) & (iota() < set(left));
        t.z_high = load(block.z_high + n);
        if (skip_hidden) there = there & !farthest.hide(t, place.grid, there);
        if (!any(there)) continue;

        const I limit = set(tile_size * subpixels);
        const M wide = ((high_x - low_x) > limit) | ((high_y - low_y) > limit);
        for (int k = 0; k < 3; ++k) {
            const int a = k == 2 ? 0 : k + 1, b = a == 2 ? 0 : a + 1;
            const I dx = y[a] - y[b], dy = x[b] - x[a];
            // Samples on a left or top edge are inside, on the others outside (y down).
            const M inclusive = (dx > zero) | ((dx == zero) & (dy > zero));
            const I e = (dx * (set(place.x) - x[a]) + dy * (set(place.y) - y[a])) +
                        select(inclusive, zero, set(-1));
            t.edge[k] = shift_right<subpixel_bits>(e);
            t.right[k] = dx;
            t.down[k] = dy;
        }
        t.z_low = load(block.z_low + n);
        const std::uint32_t number = first_number + std::uint32_t(n);
        const I most = set(points_across + 1);
        const M few = ((there & !wide) & ((across < most) & (downwards < most))) &
                      (across * downwards < set(points_in_box + 1));
        const std::uint32_t points = masked == nullptr ? bits_of(few) : 0;
        const std::uint32_t others = bits_of(there) & ~points;
        if (others != 0) {
            TriangleBatch batch(t);
            const std::uint32_t huge = bits_of(wide), narrow = bits_of(across < set(17));
            const std::uint32_t near = bits_of(!(t.z_low < set(0.0f)));
            for (std::uint32_t rest = others; rest != 0; rest &= rest - 1) {
                const int lane = __builtin_ctz(rest);
                const std::size_t at = n + std::size_t(lane);
                if ((huge >> lane & 1u) != 0 && !wide_edges(block, at, place, batch, lane))
                    continue;
                const FarthestDepths* hiding = skip_hidden ? &farthest : nullptr;
                const bool rows = (narrow >> lane & 1u) != 0;
                const std::uint32_t its_number = number + std::uint32_t(lane);
                if (simple && (near >> lane & 1u) != 0)
                    draw_one(OneTriangle<true>(target, batch, lane, block, at, its_number), rows,
                             hiding);
                else
                    draw_one(OneTriangle<false>(target, batch, lane, block, at, its_number), rows,
                             hiding);
            }
        }
        if (points == 0) continue;
        t.from_x = set(place.x) - x[0];
        t.from_y = set(place.y) - y[0];
        t.z0 = load(block.z0 + n);
        t.dzdx = load(block.dzdx + n);
        t.dzdy = load(block.dzdy + n);
        t.number = set(std::int32_t(number)) + iota();
        // After the others: these look at numbers where depths are equal.
        raster_points(depths, ids, place.grid, t, few);
    }
}
