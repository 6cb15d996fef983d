// Which triangles are worth drawing, and the tiles that they may reach.
// Included once per instruction set, inside the namespace that has its lanes.

// The corners of as many triangles as there are lanes.
RAST_INLINE void load_corners(const VertexRecord* records, const std::uint32_t* indices, I x[3],
                              I y[3], F z[3]) {
    for (int k = 0; k < 3; ++k) {
        I w, depth;
        load_each4<3>(&records->x, indices + k, x[k], y[k], w, depth);
        z[k] = from_bits(depth);
    }
}

inline std::uint32_t cull(const CullTask& task, CullResult& result, CullCounts& counts) {
    const Window& window = task.window;
    const std::int32_t low_bias = task.every_touched_pixel ? subpixels / 2 : subpixels - 1;
    const std::int32_t high_bias = task.every_touched_pixel ? subpixels / 2 : 0;
    std::uint32_t kept = 0;
    const auto population = [](std::uint32_t b) { return std::uint32_t(__builtin_popcount(b)); };
    for (std::uint32_t first = 0; first < task.count; first += lane_count) {
        const std::uint32_t lanes = task.count - first < std::uint32_t(lane_count)
                                        ? task.count - first
                                        : std::uint32_t(lane_count);
        // Lanes past the end repeat the last triangle and are not counted.
        I x[3], y[3];
        F z[3];
        const std::uint32_t* indices = task.indices + std::size_t(first) * 3;
        std::uint32_t copy[3 * lane_count];
        if (lanes < std::uint32_t(lane_count)) {
            for (std::uint32_t k = 0; k < 3 * std::uint32_t(lane_count); ++k)
                copy[k] = indices[k < 3 * lanes ? k : 3 * (lanes - 1) + k % 3];
            indices = copy;
        }
        load_corners(task.records, indices, x, y, z);
        const std::uint32_t there = std::uint32_t((1ull << lanes) - 1);
        const auto is_mark = [&](std::int32_t mark) {
            return bits_of(((x[0] == set(mark)) | (x[1] == set(mark))) | (x[2] == set(mark))) &
                   there;
        };
        const std::uint32_t broken = is_mark(mark_non_finite);
        const std::uint32_t crossing = is_mark(mark_unsnapped) & ~broken;
        std::uint32_t left = there & ~broken & ~crossing;
        counts.non_finite += population(broken);
        counts.crossing += population(crossing);
        const auto drop = [&](std::uint32_t dropped, std::uint32_t& counter) {
            counter += population(dropped & left);
            left &= ~dropped;
        };
        // Differences have 23 bits, products 46: exact in double.
        const D area = to_double(x[1] - x[0]) * to_double(y[2] - y[0]) -
                       to_double(y[1] - y[0]) * to_double(x[2] - x[0]);
        const std::uint32_t positive = bits_of(less(set_double(0.0), area) > set(0));
        const std::uint32_t negative = bits_of(less(area, set_double(0.0)) > set(0));
        drop(~(positive | negative), counts.degenerate);
        const std::uint32_t back = task.mirrored ? negative : positive;
        drop((task.drop_back ? back : 0u) | (task.drop_front ? ~back : 0u), counts.facing_away);
        const auto range = [&](const I* v, std::int32_t start, I& from, I& to) {
            const I low = min(min(v[0], v[1]), v[2]), high = max(max(v[0], v[1]), v[2]);
            from = shift_right<subpixel_bits>(low + set(low_bias - start));
            to = shift_right<subpixel_bits>(high + set(high_bias - start));
        };
        I from_x, to_x, from_y, to_y;
        range(x, window.first_x, from_x, to_x);
        range(y, window.first_y, from_y, to_y);
        drop(bits_of((from_x > to_x) | (from_y > to_y)), counts.between_samples);
        const F none = set(0.0f);
        const M off = (((from_x > set(window.width - 1)) | (to_x < set(0))) |
                       ((from_y > set(window.height - 1)) | (to_y < set(0)))) |
                      (((z[0] < none) & (z[1] < none)) & (z[2] < none));
        drop(bits_of(off), counts.outside);
        const std::uint32_t stay = left | crossing;
        if (stay == 0) continue;
        const M kept_lanes = mask_of(stay);
        const I flags = select(mask_of(back), set(entry_back_face), set(0)) |
                        select(mask_of(crossing), set(entry_crossing), set(0));
        const auto tiles = [](I from, I to, std::int32_t extent) {
            static_assert(tile_size == 64);
            const I low = shift_right<6>(max(from, set(0)));
            return low | shift_left<16>(shift_right<6>(min(to, set(extent - 1))));
        };
        const I columns = tiles(from_x, to_x, window.width);
        const I rows = tiles(from_y, to_y, window.height);
        const I first_column = columns & set(0xffff), first_row = rows & set(0xffff);
        const M single =
            (first_column == shift_right<16>(columns)) & (first_row == shift_right<16>(rows));
        const I tile = select(single, first_row * set(window.tiles_x) + first_column,
                              set(CullResult::several_tiles));
        compress_store(kept_lanes, (iota() + set(std::int32_t(first))) | flags,
                       result.entries + kept);
        compress_store(kept_lanes, tile, result.tile + kept);
        compress_store(kept_lanes, columns, result.columns + kept);
        kept += std::uint32_t(compress_store(kept_lanes, rows, result.rows + kept));
    }
    return kept;
}
