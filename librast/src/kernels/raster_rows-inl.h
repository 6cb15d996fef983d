// One triangle at a time, row by row.
// Included once per instruction set, inside the namespace that has its lanes.

// What changes from tile to tile of TriangleLanes, in memory.
struct TriangleBatch {
    std::int32_t edge[3][lane_count], right[3][lane_count], down[3][lane_count];
    std::int32_t i0[lane_count], j0[lane_count], i1[lane_count], j1[lane_count];

    explicit TriangleBatch(const TriangleLanes& t) {
        for (int k = 0; k < 3; ++k) {
            store(t.edge[k], edge[k]);
            store(t.right[k], right[k]);
            store(t.down[k], down[k]);
        }
        store(t.i0, i0);
        store(t.j0, j0);
        store(t.i1, i1);
        store(t.j1, j1);
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
    float dzdy;
    std::int32_t from_x, from_y;         // from the first corner to the tile's first sample
    float rise[tile_size + lane_count];  // what depth adds in every row

    // The block's triangle n, lane `which` of a batch.
    OneTriangle(const TileTarget& where, const TriangleBatch& t, int which, const SetupBlock& block,
                std::size_t n, std::uint32_t its_number)
        : target(where),
          batch(t),
          lane(which),
          number(set(std::int32_t(its_number))),
          id(set(block.id[n])),
          z0(set(block.z0[n])),
          dzdx(set(block.dzdx[n])),
          z_low(set(block.z_low[n])),
          z_high(set(block.z_high[n])),
          dzdy(block.dzdy[n]),
          from_x(where.place->x - block.x[0][n]),
          from_y(where.place->y - block.y[0][n]) {
        constexpr float to_pixels = 1.0f / float(subpixels);
        for (std::int32_t j = t.j0[lane]; j <= t.j1[lane]; j += lane_count) {
            const I from = shift_left<subpixel_bits>(iota() + set(j)) + set(from_y);
            store(set(dzdy) * (to_float(from) * set(to_pixels)), rise + j);
        }
    }

    // A column of vectors from row j0 to j1, its lanes within the triangle's box.
    template <bool edges>
    RAST_INLINE void draw_column(std::int32_t i, std::int32_t j0, std::int32_t j1) const {
        constexpr float to_pixels = 1.0f / float(subpixels);
        const I column = iota() + set(i), nothing = set(-1);
        const M in_box = column < set(batch.i1[lane] + 1);
        const F run =
            dzdx * (to_float(shift_left<subpixel_bits>(column) + set(from_x)) * set(to_pixels));
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
            // Looking would be guessed wrong more often than it spares anything.
            if (!plain && !any(hit)) continue;
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
