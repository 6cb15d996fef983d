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

template <bool plain>
inline void draw_one(const TileTarget& target, const TriangleBatch& batch, int lane,
                     std::uint32_t id, bool rows, const FarthestDepths* farthest) {
    const OneTriangle<plain> one(target, batch, lane, id);
    if (rows)
        one.draw_rows();
    else
        draw_blocks(one, farthest);
}

// Records of the triangles after next: they lie wherever the chunk put them.
inline void prefetch_ahead(const SetupTriangle* triangles, const std::uint32_t* order,
                           std::size_t left) {
    constexpr std::size_t ahead = lane_count < 8 ? 16 : 2 * std::size_t(lane_count);
    if (left < ahead + lane_count) return;
    for (std::size_t k = 0; k < std::size_t(lane_count); ++k)
        __builtin_prefetch(triangles + (order[ahead + k] & ~order_crossing));
}

inline void raster(float* depths, std::uint32_t* ids, const TilePlace& place,
                   const SetupTriangle* triangles, const std::uint32_t* order, std::size_t count,
                   std::uint32_t first_number, const ShadeDraw* masked) {
    static_assert(sizeof(SetupTriangle) == 48);
    static_assert(FarthestDepths::triangles_between % lane_count == 0);
    FarthestDepths farthest;
    const bool skip_hidden = place.skip_hidden && count > FarthestDepths::triangles_between / 2;
    const I single = set(1);
    for (std::size_t n = 0; n < count; n += lane_count) {
        if (skip_hidden && n % FarthestDepths::triangles_between == 0) farthest.look(depths);
        const std::int32_t left = std::int32_t(count - n < lane_count ? count - n : lane_count);
        I what;
        if (left == lane_count) {
            what = load(order + n);
            prefetch_ahead(triangles, order + n, count - n);
        } else {
            std::uint32_t copy[lane_count];
            for (std::int32_t k = 0; k < lane_count; ++k) copy[k] = order[n + (k < left ? k : 0)];
            what = load(copy);
        }
        // Crossing triangles are drawn elsewhere, and lanes past the end are left out.
        const M mine = (what > set(-1)) & (iota() < set(left));
        what = max(what, set(0));
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
        const I across = (t.i1 - t.i0) + single, downwards = (t.j1 - t.j0) + single;
        M there = ((across > set(0)) & (downwards > set(0))) & mine;
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
        t.number = set(std::int32_t(first_number) + std::int32_t(n)) + iota();

        M few = mine & !mine;
        if (masked == nullptr) {
            const I most = set(points_across + 1);
            few = (there & !wide) & ((across < most) & (downwards < most)) &
                  (across * downwards < set(points_in_box + 1));
        }
        const std::uint32_t others = bits_of(there & !few);
        if (others != 0) {
            TriangleBatch batch;
            batch.keep(t);
            const TileTarget target{depths, ids, &place, masked};
            const std::uint32_t huge = bits_of(wide), narrow = bits_of(across < set(17));
            const std::uint32_t nearer = bits_of(t.z_low >= set(0.0f));
            const bool simple = !place.grid && masked == nullptr;
            for (std::uint32_t rest = others; rest != 0; rest &= rest - 1) {
                const int lane = __builtin_ctz(rest);
                const SetupTriangle& s = triangles[order[n + std::size_t(lane)]];
                if ((huge >> lane & 1u) != 0 && !wide_edges(s, place, batch, lane)) continue;
                const FarthestDepths* hiding = skip_hidden ? &farthest : nullptr;
                const bool rows = (narrow >> lane & 1u) != 0;
                if (simple && (nearer >> lane & 1u) != 0)
                    draw_one<true>(target, batch, lane, s.id, rows, hiding);
                else
                    draw_one<false>(target, batch, lane, s.id, rows, hiding);
            }
        }
        // After the others: these look at numbers where depths are equal.
        if (any(few)) raster_points(depths, ids, place.grid, t, few);
    }
}
