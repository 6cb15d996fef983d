// One large triangle, by blocks of a tile: those that it misses or that hide it are left out, and
// where it fills a block its edges are not looked at.
// Included once per instruction set, inside the namespace that has its lanes.

// `farthest`: null where hidden blocks are not to be looked for.
template <bool plain>
RAST_INLINE void draw_blocks(const OneTriangle<plain>& one, const FarthestDepths* farthest) {
    const TriangleBatch& t = one.batch;
    const int lane = one.lane;
    constexpr float to_pixels = 1.0f / float(subpixels);
    constexpr std::int32_t size = FarthestDepths::block, across = FarthestDepths::across,
                           blocks = across * across, reach = size - 1;
    for (std::int32_t first = 0; first < blocks; first += lane_count) {
        const I block = iota() + set(first);
        const I left = shift_left<4>(block & set(across - 1));
        const I top = shift_left<2>(block & set(blocks - across));
        const M in_box = ((left > set(t.i0[lane] - size)) & (left < set(t.i1[lane] + 1))) &
                         ((top > set(t.j0[lane] - size)) & (top < set(t.j1[lane] + 1)));
        // Of the samples that are farthest inside and farthest outside of each edge.
        I most = set(-1), least = set(0);
        for (int k = 0; k < 3; ++k) {
            const std::int32_t right = t.right[k][lane], down = t.down[k][lane];
            const I e = set(t.edge[k][lane]) + (set(right) * left + set(down) * top);
            const std::int32_t low =
                (right < 0 ? right * reach : 0) + (down < 0 ? down * reach : 0);
            const std::int32_t high =
                (right > 0 ? right * reach : 0) + (down > 0 ? down * reach : 0);
            const I nearest = e + set(high);
            most = k == 0 ? nearest : most | nearest;
            least = least | (e + set(low));
        }
        M there = in_box & (most > set(-1));
        if (farthest != nullptr) {
            // Depth's roundings keep its order, so that no sample is nearer than its corner's.
            const I x = left + select(one.dzdx > set(0.0f), set(reach), set(0));
            const I y = top + set(one.dzdy > 0 ? reach : 0);
            const F run = to_float(shift_left<subpixel_bits>(x) + set(one.from_x)) * set(to_pixels);
            const F rise =
                to_float(shift_left<subpixel_bits>(y) + set(one.from_y)) * set(to_pixels);
            const F z = one.z0 + (one.dzdx * run + set(one.dzdy) * rise);
            F nearest = select(z < one.z_high, max(z, one.z_low), one.z_high);  // NaN: z_high
            if (!plain && one.target.place->grid)
                nearest = on_grid(one.target.place->grid, nearest);
            there = there & !(nearest < load(farthest->least + first));
        }
        const M whole = ((left > set(t.i0[lane] - 1)) & (left < set(t.i1[lane] + 2 - size))) &
                        ((top > set(t.j0[lane] - 1)) & (top < set(t.j1[lane] + 2 - size)));
        const std::uint32_t full = bits_of(whole & (least > set(-1)));
        for (std::uint32_t rest = bits_of(there); rest != 0; rest &= rest - 1) {
            const std::int32_t b = first + __builtin_ctz(rest);
            const std::int32_t x = b % across * size, y = b / across * size;
            const std::int32_t j0 = t.j0[lane] > y ? t.j0[lane] : y;
            const std::int32_t j1 = t.j1[lane] < y + reach ? t.j1[lane] : y + reach;
            const bool inside = (full & rest & (~rest + 1)) != 0;
            for (std::int32_t i = x; i < x + size; i += lane_count)
                if (inside)
                    one.template draw_column<false>(i, j0, j1);
                else
                    one.template draw_column<true>(i, j0, j1);
        }
    }
}
