// Vertex transform and triangle culling.
// Included once per instruction set, inside the namespace that has its lanes.

inline void transform(const TransformTask& task, std::size_t begin, std::size_t end) {
    const auto& m = task.rows;
    const D zero = set_double(0.0), guard = set_double(guard_band), one = set_double(1.0);
    float copy[3 * lane_count];
    for (std::size_t first = begin; first < end; first += lane_count) {
        const std::size_t count = end - first < lane_count ? end - first : lane_count;
        const float* source = task.positions + first * 3;
        if (count < lane_count) {
            for (std::size_t k = 0; k < 3 * lane_count; ++k)
                copy[k] = k < 3 * count ? source[k] : 0.0f;
            source = copy;
        }
        F fx, fy, fz;
        load3(source, fx, fy, fz);
        const D px = to_double(fx), py = to_double(fy), pz = to_double(fz);
        const auto row = [&](int r) {
            return ((set_double(m[r][0]) * px + set_double(m[r][1]) * py) +
                    set_double(m[r][2]) * pz) +
                   set_double(m[r][3]);
        };
        const D x = row(0), y = row(1), z = row(2), w = row(3);
        // Infinity minus itself is NaN, and NaN is neither above nor below.
        const D d = ((x - x) + (y - y)) + ((z - z) + (w - w));
        const I finite = less(d, one);
        const D reach = guard * w;
        const I in_front = less(zero, w) & (set(1) - less(w, z));
        const I in_guard =
            (less(x, reach) & less(zero - reach, x)) & (less(y, reach) & less(zero - reach, y));
        const M usable = (in_front & in_guard & finite) > set(0);
        const auto snap = [&](D v) {
            const D scaled = floor(v / w * set_double(double(subpixels)) + set_double(0.5));
            return to_int(min(max(scaled, set_double(-0x1p30)), set_double(0x1p30)));
        };
        const I mark = select(finite > set(0), set(mark_unsnapped), set(mark_non_finite));
        std::int32_t xs[lane_count], ys[lane_count];
        float ws[lane_count], depths[lane_count];
        store(select(usable, snap(x), mark), xs);
        store(select(usable, snap(y), set(0)), ys);
        store(to_float(w), ws);
        store(to_float(z / w), depths);
        for (std::size_t k = 0; k < count; ++k)
            task.out[first + k] = VertexRecord{xs[k], ys[k], ws[k], depths[k]};
    }
}

inline std::uint32_t cull(const CullTask& task, std::uint16_t* survivors, CullCounts& counts) {
    const std::int32_t* records = &task.records->x;
    const float* depths = &task.records->depth;
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
        const I number = min(iota() + set(std::int32_t(first)), set(std::int32_t(task.count - 1)));
        const I at = number * set(3);
        I x[3], y[3];
        F z[3];
        for (int k = 0; k < 3; ++k) {
            const I vertex = shift_left<2>(gather(task.indices + k, at));
            x[k] = gather(records, vertex);
            y[k] = gather(records + 1, vertex);
            z[k] = gather(depths, vertex);
        }
        const std::uint32_t there = std::uint32_t((1ull << lanes) - 1);
        const auto is_mark = [&](std::int32_t mark) {
            return bits_of(((x[0] == set(mark)) | (x[1] == set(mark))) | (x[2] == set(mark))) &
                   there;
        };
        const std::uint32_t broken = is_mark(mark_non_finite);
        const std::uint32_t crossing = is_mark(mark_unsnapped) & ~broken;
        std::uint32_t left = there & ~broken & ~crossing;
        counts.non_finite += population(broken);
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
        for (std::uint32_t rest = left | crossing; rest != 0; rest &= rest - 1)
            survivors[kept++] = std::uint16_t(first + std::uint32_t(__builtin_ctz(rest)));
    }
    return kept;
}
