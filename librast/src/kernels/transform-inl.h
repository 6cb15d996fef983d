// Vertex transform.
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
        const I xs = select(usable, snap(x), mark), ys = select(usable, snap(y), set(0));
        const I ws = bits(to_float(w)), depths = bits(to_float(z / w));
        if (count == lane_count) {
            store_interleaved4(xs, ys, ws, depths, &task.out[first].x);
            continue;
        }
        std::int32_t words[4 * lane_count];
        store_interleaved4(xs, ys, ws, depths, words);
        std::memcpy(task.out + first, words, count * sizeof(VertexRecord));
    }
}
