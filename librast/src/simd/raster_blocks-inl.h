// One large triangle, by blocks of a tile: those that it misses or that hide it are left out, and
// where it fills a block its edges are not looked at.
// Included once per instruction set, inside the namespace that has its lanes.

template <bool edges>
RAST_INLINE void raster_block(const TileTarget& target, const TriangleBatch& t, int lane,
                              std::int32_t left, std::int32_t top) {
    constexpr float to_pixels = 1.0f / float(subpixels);
    constexpr std::int32_t size = FarthestDepths::block;
    const F z0 = set(t.z0[lane]), dzdx = set(t.dzdx[lane]);
    const F z_low = set(t.z_low[lane]), z_high = set(t.z_high[lane]);
    const std::int32_t j0 = t.j0[lane] > top ? t.j0[lane] : top;
    const std::int32_t j1 = t.j1[lane] < top + size - 1 ? t.j1[lane] : top + size - 1;
    for (std::int32_t i = left; i < left + size; i += lane_count) {
        const I column = iota() + set(i);
        const M inside_box = column < set(t.i1[lane] + 1);
        const F run = dzdx * (to_float(shift_left<subpixel_bits>(column) + set(t.from_x[lane])) *
                              set(to_pixels));
        I e[3];
        for (int k = 0; edges && k < 3; ++k)
            e[k] = set(t.edge[k][lane] + t.down[k][lane] * j0) + set(t.right[k][lane]) * column;
        for (std::int32_t j = j0; j <= j1; ++j) {
            M hit = inside_box;
            if (edges) {
                hit = hit & (((e[0] | e[1]) | e[2]) > set(-1));
                for (int k = 0; k < 3; ++k) e[k] = e[k] + set(t.down[k][lane]);
                if (!any(hit)) continue;
            }
            const F rise = set(t.dzdy[lane] * (float(t.from_y[lane] + j * subpixels) * to_pixels));
            const F z = min(max(z0 + (run + rise), z_low), z_high);
            target.draw(hit, z, column, j, std::size_t(j) * tile_size + std::size_t(i));
        }
    }
}

// `farthest`: null where hidden blocks are not to be looked for.
RAST_INLINE void raster_blocks(const TileTarget& target, const TriangleBatch& t, int lane,
                               const FarthestDepths* farthest) {
    constexpr float to_pixels = 1.0f / float(subpixels);
    constexpr std::int32_t size = FarthestDepths::block, across = FarthestDepths::across,
                           blocks = across * across, reach = size - 1;
    const float dzdx = t.dzdx[lane], dzdy = t.dzdy[lane];
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
            const I x = left + set(dzdx > 0 ? reach : 0), y = top + set(dzdy > 0 ? reach : 0);
            const F run =
                to_float(shift_left<subpixel_bits>(x) + set(t.from_x[lane])) * set(to_pixels);
            const F rise =
                to_float(shift_left<subpixel_bits>(y) + set(t.from_y[lane])) * set(to_pixels);
            const F z = set(t.z0[lane]) + (set(dzdx) * run + set(dzdy) * rise);
            const F z_low = set(t.z_low[lane]), z_high = set(t.z_high[lane]);
            F nearest = select(z < z_high, max(z, z_low), z_high);  // NaN: z_high
            if (target.place->grid) nearest = on_grid(target.place->grid, nearest);
            there = there & !(nearest < load(farthest->least + first));
        }
        const M whole = ((left > set(t.i0[lane] - 1)) & (left < set(t.i1[lane] + 2 - size))) &
                        ((top > set(t.j0[lane] - 1)) & (top < set(t.j1[lane] + 2 - size)));
        const std::uint32_t full = bits_of(whole & (least > set(-1)));
        for (std::uint32_t rest = bits_of(there); rest != 0; rest &= rest - 1) {
            const std::int32_t b = first + __builtin_ctz(rest);
            const std::int32_t x = b % across * size, y = b / across * size;
            if (full & rest & (~rest + 1))
                raster_block<false>(target, t, lane, x, y);
            else
                raster_block<true>(target, t, lane, x, y);
        }
    }
}
