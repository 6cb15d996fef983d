// One triangle at a time, row by row.
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

// Where triangles are drawn, and what decides beside their edges and depths.
struct TileTarget {
    float* depths;
    std::uint32_t* ids;
    const TilePlace* place;
    const ShadeDraw* masked;  // or null
};

// One triangle of a batch. `plain`: its depths stay as they are, none is beyond the far plane, and
// no mask decides.
//
// Triangles are drawn by ascending numbers, so that of equal depths the one that is there wins.
template <bool plain>
struct OneTriangle {
    const TileTarget& target;
    const TriangleBatch& batch;
    int lane;
    I number, id;  // in the tile; for the mask
    F z0, dzdx, z_low, z_high;
    float rise[tile_size + lane_count];  // what depth adds in every row

    OneTriangle(const TileTarget& where, const TriangleBatch& t, int which, std::uint32_t its_id)
        : target(where),
          batch(t),
          lane(which),
          number(set(t.number[which])),
          id(set(std::int32_t(its_id))),
          z0(set(t.z0[which])),
          dzdx(set(t.dzdx[which])),
          z_low(set(t.z_low[which])),
          z_high(set(t.z_high[which])) {
        constexpr float to_pixels = 1.0f / float(subpixels);
        const F dzdy = set(t.dzdy[lane]);
        for (std::int32_t j = t.j0[lane]; j <= t.j1[lane]; j += lane_count) {
            const I from = shift_left<subpixel_bits>(iota() + set(j)) + set(t.from_y[lane]);
            store(dzdy * (to_float(from) * set(to_pixels)), rise + j);
        }
    }

    // A column of vectors from row j0 to j1, its lanes within the triangle's box.
    template <bool edges>
    RAST_INLINE void draw_column(std::int32_t i, std::int32_t j0, std::int32_t j1) const {
        constexpr float to_pixels = 1.0f / float(subpixels);
        const I column = iota() + set(i), nothing = set(-1);
        const M in_box = column < set(batch.i1[lane] + 1);
        const F run =
            dzdx * (to_float(shift_left<subpixel_bits>(column) + set(batch.from_x[lane])) *
                    set(to_pixels));
        I e[3], down[3];
        for (int k = 0; edges && k < 3; ++k) {
            down[k] = set(batch.down[k][lane]);
            e[k] = set(batch.edge[k][lane] + batch.down[k][lane] * j0) +
                   set(batch.right[k][lane]) * column;
        }
        float* depths = target.depths + std::size_t(j0) * tile_size + std::size_t(i);
        std::uint32_t* ids = target.ids + std::size_t(j0) * tile_size + std::size_t(i);
        for (std::int32_t j = j0; j <= j1; ++j, depths += tile_size, ids += tile_size) {
            M hit = in_box;
            if (edges) {
                hit = hit & (((e[0] | e[1]) | e[2]) > nothing);
                for (int k = 0; k < 3; ++k) e[k] = e[k] + down[k];
            }
            F z = min(max(z0 + (run + set(rise[j])), z_low), z_high);
            if (!plain) {
                if (target.place->grid) z = on_grid(target.place->grid, z);
                hit = hit & (z >= set(0.0f));
            }
            hit = hit & (z > load(depths));
            if (!any(hit)) continue;
            if (!plain && target.masked != nullptr)
                hit = hit & alpha_passes(*target.masked,
                                         shift_left<subpixel_bits>(column) + set(target.place->x),
                                         set(target.place->y + j * subpixels), id);
            store_where(hit, z, depths);
            store_where(hit, number, ids);
        }
    }

    RAST_INLINE void draw_rows() const {
        for (std::int32_t i = batch.i0[lane]; i <= batch.i1[lane]; i += lane_count)
            draw_column<true>(i, batch.j0[lane], batch.j1[lane]);
    }
};
