// Maps of a draw through filters that read several times: anisotropic, ripmap, EWA, bicubic. What
// is out of range is left to MipTexture::sample, lane by lane.
// Included once per instruction set, inside the namespace that has its lanes.

template <int part = 0, class Body>
RAST_INLINE void for_each_part(const Body& body) {
    body(std::integral_constant<int, part>());
    if constexpr (part + 1 < part_count) for_each_part<part + 1>(body);
}

// Beyond these footprints, MipTexture's doubles decide.
RAST_INLINE M are_footprints(const Coordinates& at) {
    const F most = set(1.0e9f);
    return ((abs(at.u_x) < most) & (abs(at.v_x) < most)) &
           ((abs(at.u_y) < most) & (abs(at.v_y) < most));
}

// Of `count` textures on the same texels, both levels mixed.
template <int count>
RAST_INLINE void mix_maps(const TextureView* const views[], const Reads& reads,
                          Quads out[][part_count]) {
    if (views[0]->pair != nullptr) {
        Quads both[2][part_count];
        mix_pair(views[0]->pair, reads, both);
        for (int i = 0; i < count; ++i)
            for (int p = 0; p < part_count; ++p) out[i][p] = both[views[i]->is_second()][p];
    } else if (views[0]->packed != nullptr) {
        const std::int16_t* texels[count];
        for (int i = 0; i < count; ++i) texels[i] = views[i]->packed;
        mix_levels<count>(texels, reads, out);
    } else {
        const float* texels[count];
        for (int i = 0; i < count; ++i) texels[i] = views[i]->floats;
        mix_levels<count>(texels, reads, out);
    }
}
template <int count>
RAST_INLINE void finish_maps(const TextureView* const views[], const Quads parts[][part_count],
                             Texel out[]) {
    for (int i = 0; i < count; ++i)
        out[i] = views[i]->packed != nullptr ? finished_texel<std::int16_t>(parts[i])
                                             : finished_texel<float>(parts[i]);
}

// The axes of footprints' ellipses in texels of the first level, as MipTexture has them.
struct FootprintAxes {
    D major, minor;              // lengths
    D direction_u, direction_v;  // of the major one
    M stretched;                 // longer than a texel, and no extremes
};
RAST_INLINE FootprintAxes axes_of(const TextureView& view, const Coordinates& at) {
    const D width = set_double(double(view.widths[0])),
            height = set_double(double(view.heights[0]));
    const D p_x = to_double(at.u_x) * width, p_y = to_double(at.v_x) * height;
    const D q_x = to_double(at.u_y) * width, q_y = to_double(at.v_y) * height;
    const D zero = set_double(0.0), one = set_double(1.0), middle = set_double(0.5);
    const D a = p_x * p_x + q_x * q_x, b = p_x * p_y + q_x * q_y, c = p_y * p_y + q_y * q_y;
    const D half = (a - c) * middle, root = sqrt(half * half + b * b);
    FootprintAxes axes;
    axes.major = sqrt((a + c) * middle + root);
    const D area = p_x * q_y - p_y * q_x;
    axes.minor = max(area, zero - area) / max(axes.major, set_double(1e-30));
    const D least = set_double(1e-300), turn = (half + least) / (root + least);
    const D sign = one - to_double(less(b, zero)) * set_double(2.0);
    axes.direction_u = sqrt(max(middle + turn * middle, zero));
    axes.direction_v = sqrt(max(middle - turn * middle, zero)) * sign;
    axes.stretched = are_footprints(at) & (less(one, axes.major) > set(0));
    return axes;
}

// As MipTexture::anisotropic has them.
struct Probes {
    F along_u, along_v, lod;
    I count;
    M good;
};
RAST_INLINE Probes find_probes(const BoundMap& map, const Coordinates& at) {
    const TextureView& view = map.texture->view();
    const F none = set(0.0f), last = set(float(view.level_count - 1));
    Probes p{none, none, none, set(1), set(0) < set(1)};
    if (view.level_count == 1) return p;
    const FootprintAxes s = axes_of(view, at);
    p.good = are_footprints(at);
    if (any(p.good & !s.stretched)) p.lod = level_of_detail(view, at);
    if (!any(s.stretched)) return p;
    const D width = set_double(double(view.widths[0])),
            height = set_double(double(view.heights[0]));
    p.along_u = select(s.stretched, to_float(s.major * s.direction_u / width), none);
    p.along_v = select(s.stretched, to_float(s.major * s.direction_v / height), none);
    const D zero = set_double(0.0);
    const D ratio = s.major / max(s.minor, set_double(1e-30)) - set_double(1e-6);
    const D most = set_double(map.most > 1 ? double(map.most) : 1.0);
    p.count = select(s.stretched, to_int(min(zero - floor(zero - ratio), most)), p.count);
    const F lod = log2(to_float(s.major / to_double(p.count)));
    p.lod = select(s.stretched, min(max(lod, none), last), p.lod);
    return p;
}

template <int count>
inline void read_probes(const BoundMap* const maps[], const Coordinates& at, Texel out[]) {
    const BoundMap& map = *maps[0];
    const TextureView* views[count];
    for (int i = 0; i < count; ++i) views[i] = &maps[i]->texture->view();
    const Probes p = find_probes(map, at);
    const F number = to_float(p.count), none = set(0.0f), one = set(1.0f);
    const std::int32_t most = largest(p.count);
    M good = p.good;
    Quads first[count][part_count], sum[count][part_count], now[count][part_count];
    const auto read = [&](std::int32_t n, Quads to[][part_count]) {
        const M reads_on = set(n) < p.count;  // the others read their middle, for nothing
        const F step = select(reads_on, set(float(n) + 0.5f) / number - set(0.5f), none);
        Reads reads;
        reads.between = p.lod;
        find_texels(map, at.u + p.along_u * step, at.v + p.along_v * step, reads);
        good = good & (reads.good | !reads_on);
        for (int i = 0; n == 0 && i < count; ++i) make_levels(*maps[i], reads);
        mix_maps<count>(views, reads, to);
        return select(reads_on, one, none);
    };
    read(0, first);
    for (int i = 0; i < count; ++i)
        for (int k = 0; k < part_count; ++k) sum[i][k] = first[i][k] - first[i][k];
    for (std::int32_t n = 1; n < most; ++n) {
        const F counts = read(n, now);
        for (int i = 0; i < count; ++i)
            for_each_part([&](auto part) {
                constexpr int k = decltype(part)::value;
                Quads& s = sum[i][k];
                s = select_positive(spread<k>(counts), s + (now[i][k] - first[i][k]), s);
            });
    }
    for (int i = 0; i < count; ++i)
        for_each_part([&](auto part) {
            constexpr int k = decltype(part)::value;
            now[i][k] = first[i][k] + sum[i][k] / spread<k>(number);
        });
    finish_maps<count>(views, now, out);
    if (all(good)) return;
    for (int i = 0; i < count; ++i) sample_each(*maps[i], at, bits_of(good), out[i]);
}

// As MipTexture::ripmap has it, of one axis.
struct RipAxis {
    I level[2];
    F part;
    bool two;
};
RAST_INLINE RipAxis rip_axis(F right, F down, std::int32_t size, std::uint32_t levels) {
    const F one = set(1.0f), none = set(0.0f), last = set(float(levels - 1));
    const F longest = max(abs(right), abs(down)) * set(float(size));
    const M minified = longest > one;
    const F lod = select(minified, min(log2(select(minified, longest, one)), last), none);
    const F whole = floor(lod);
    RipAxis out;
    out.level[0] = to_int(whole);
    out.part = lod - whole;
    const M between = out.part > none;
    out.two = any(between);
    out.level[1] = select(between, out.level[0] + set(1), out.level[0]);
    return out;
}

// A level of its own for each lane.
template <int count>
RAST_INLINE void mix_rips(const BoundMap* const maps[], const TextureView* const views[], F u, F v,
                          I column, I row, Quads out[][part_count]) {
    const TextureView& view = *views[0];
    const I index = row * set(std::int32_t(view.rip_columns)) + column;
    std::int32_t each[vector_size];
    store(index, each);
    for (std::size_t lane = 0; lane < vector_size; ++lane)
        for (int i = 0; i < count; ++i) maps[i]->texture->make_rip(std::size_t(each[lane]));
    Reads reads;
    reads.two = false;
    place_taps(view, u, v,
               {gather(view.rip_widths, column), gather(view.rip_heights, row),
                gather(view.rip_pitches, column), gather(view.rip_firsts, index)},
               reads.near);
    mix_maps<count>(views, reads, out);
}
template <int count>
inline void read_rips(const BoundMap* const maps[], const Coordinates& at, Texel out[]) {
    const TextureView* views[count];
    for (int i = 0; i < count; ++i) views[i] = &maps[i]->texture->view();
    const TextureView& view = *views[0];
    const F none = set(0.0f);
    const M good = are_texels(view, at.u, at.v) & are_footprints(at);
    const auto kept = [&](F x) { return select(good, x, none); };
    const F u = kept(at.u), v = kept(at.v);
    const RipAxis across = rip_axis(kept(at.u_x), kept(at.u_y), view.widths[0], view.rip_columns);
    const RipAxis down = rip_axis(kept(at.v_x), kept(at.v_y), view.heights[0], view.rip_rows);
    Quads rows[2][count][part_count], beside[count][part_count];
    const auto mix = [&](Quads to[][part_count], const Quads with[][part_count], F by) {
        for (int i = 0; i < count; ++i)
            for_each_part([&](auto part) {
                constexpr int p = decltype(part)::value;
                const Quads share = spread<p>(by);
                Quads& q = to[i][p];
                q = select_positive(share, q + (with[i][p] - q) * share, q);
            });
    };
    for (int r = 0; r < (down.two ? 2 : 1); ++r) {
        mix_rips<count>(maps, views, u, v, across.level[0], down.level[r], rows[r]);
        if (!across.two) continue;
        mix_rips<count>(maps, views, u, v, across.level[1], down.level[r], beside);
        mix(rows[r], beside, across.part);
    }
    if (down.two) mix(rows[0], rows[1], down.part);
    finish_maps<count>(views, rows[0], out);
    if (all(good)) return;
    for (int i = 0; i < count; ++i) sample_each(*maps[i], at, bits_of(good), out[i]);
}

// Of `count` textures, on the two levels around each lane's; `read` gives codes or floats of one.
template <int count, class Read>
RAST_INLINE void between_levels(const BoundMap* const maps[], F lod, const Read& read, F out[][4]) {
    const F whole = floor(lod), between = lod - whole;
    const I fine = to_int(whole);
    const M two = between > set(0.0f);
    Reads reads;
    reads.last = select(two, fine + set(1), fine);
    for (int i = 0; i < count; ++i) make_levels(*maps[i], reads);
    read(fine, out);
    if (!any(two)) return;
    F coarse[count][4];
    read(reads.last, coarse);
    for (int i = 0; i < count; ++i)
        for (int k = 0; k < 4; ++k)
            out[i][k] = select(two, out[i][k] + (coarse[i][k] - out[i][k]) * between, out[i][k]);
}
template <int count>
RAST_INLINE void finish_values(const TextureView* const views[], const F values[][4], Texel out[]) {
    for (int i = 0; i < count; ++i) {
        const auto finished = [&](int k) {
            return views[i]->packed != nullptr ? finished_code(values[i][k]) : values[i][k];
        };
        out[i] = {finished(0), finished(1), finished(2), finished(3)};
    }
}

// As MipTexture::ellipse: of `count` textures on one level for each lane. Results are codes or
// floats.
struct EllipseAxes {
    F major_u, major_v, minor_u, minor_v;
};
template <int count>
RAST_INLINE void read_ellipses(const TextureView* const views[], F at_u, F at_v,
                               const EllipseAxes& axes, int most, I level, F out[][4]) {
    const TextureView& view = *views[0];
    const Sizes size = sizes_of(view, level);
    const F one = set(1.0f), half = set(0.5f), none = set(0.0f);
    const F width = to_float(size.width), height = to_float(size.height);
    const F scale_u = width / set(float(view.widths[0]));
    const F scale_v = height / set(float(view.heights[0]));
    const F longest = set((most > 1 ? float(most) : 1.0f) * 2.0f + 1.0f);
    const F shortest = none - longest;
    const auto kept = [&](F x) { return min(max(x, shortest), longest); };
    const F p_x = kept(axes.major_u * scale_u), p_y = kept(axes.major_v * scale_v);
    const F q_x = kept(axes.minor_u * scale_u), q_y = kept(axes.minor_v * scale_v);
    const F area = p_x * q_y - p_y * q_x;
    const F a = (p_y * p_y + q_y * q_y) + one, c = (p_x * p_x + q_x * q_x) + one;
    const F reach = sqrt(a);
    const F inverse = one / (area * area + ((a + c) - one));
    const F A = a * inverse, B = set(-2.0f) * (p_x * p_y + q_x * q_y) * inverse, C = c * inverse;
    const F per = half / A;
    const F u = at_u * width - half, v = at_v * height - half;
    const F whole_x = floor(u + half), whole_y = floor(v + half);
    const F from_x = u - whole_x, from_y = v - whole_y;
    const I middle_x = to_int(whole_x), middle_y = to_int(whole_y);
    const bool powers_u = is_power(view.widths[0]), powers_v = is_power(view.heights[0]);
    const auto row_of = [&](I y) {
        return wrapped(view.wrap_v, powers_v, middle_y + y, size.height) * size.pitch + size.first;
    };
    const auto column_of_x = [&](I x) {
        return wrapped(view.wrap_u, powers_u, middle_x + x, size.width);
    };
    const auto ceiling = [&](F x) { return to_int(none - floor(none - x)); };
    const float* const weights = ellipse_weights();
    F base[count][4], sum[count][4], total = none;
    for (int i = 0; i < count; ++i) {
        gather_texels(*views[i], row_of(set(0)) + column_of_x(set(0)), base[i]);
        for (int k = 0; k < 4; ++k) sum[i][k] = none;
    }
    const I top = ceiling(from_y - reach), zero = set(0);
    const I rows = to_int(floor(from_y + reach)) - top + set(1);
    for (std::int32_t r = 0, last_row = largest(rows); r < last_row; ++r) {
        const I y = top + set(r);
        const F dy = to_float(y) - from_y;
        const F shift = B * dy, above = C * dy * dy;
        const F root = shift * shift - set(4.0f) * A * (above - one);
        const M there = (set(r) < rows) & (root > none);
        const F middle = from_x - shift * per, extent = sqrt(select(there, root, none)) * per;
        const I left = ceiling(middle - extent);
        const I columns = select(there, to_int(floor(middle + extent)) - left + set(1), zero);
        const I row = row_of(select(there, y, zero));
        for (std::int32_t n = 0, last = largest(columns); n < last; ++n) {
            const I x = left + set(n);
            const F dx = to_float(x) - from_x;
            const F r2 = (A * dx * dx + shift * dx) + above;
            const M in = (set(n) < columns) & (r2 < one);
            if (!any(in)) continue;
            const F entry = max(select(in, r2, none), none) * set(float(weight_entries));
            const F w = select(in, gather(weights, to_int(entry)), none);
            const I texel = row + column_of_x(select(in, x, zero));
            for (int i = 0; i < count; ++i) {
                F t[4];
                gather_texels(*views[i], texel, t);
                for (int k = 0; k < 4; ++k)
                    sum[i][k] = select(in, sum[i][k] + (t[k] - base[i][k]) * w, sum[i][k]);
            }
            total = total + w;
        }
    }
    const F middle = set(view.packed != nullptr ? float(texel_middle) : 0.0f);
    for (int i = 0; i < count; ++i)
        for (int k = 0; k < 4; ++k)
            out[i][k] = (base[i][k] + middle) + sum[i][k] / select(total > none, total, one);
}

// As MipTexture::ewa.
template <int count>
inline void read_ewa(const BoundMap* const maps[], const Coordinates& coordinates, Texel out[]) {
    const BoundMap& map = *maps[0];
    const TextureView* views[count];
    for (int i = 0; i < count; ++i) views[i] = &maps[i]->texture->view();
    const TextureView& view = *views[0];
    const F none = set(0.0f), one = set(1.0f), last = set(float(view.level_count - 1));
    M good = are_texels(view, coordinates.u, coordinates.v) & are_footprints(coordinates);
    const auto kept = [&](F x) { return select(good, x, none); };
    const Coordinates at{kept(coordinates.u),   kept(coordinates.v),   kept(coordinates.u_x),
                         kept(coordinates.v_x), kept(coordinates.u_y), kept(coordinates.v_y)};
    const FootprintAxes s = axes_of(view, at);
    F values[count][4];
    if (!all(s.stretched)) {
        Reads reads;
        reads.between = level_of_detail(view, at);
        find_texels(map, at.u, at.v, reads);
        for (int i = 0; i < count; ++i) make_levels(*maps[i], reads);
        Quads parts[count][part_count];
        mix_maps<count>(views, reads, parts);
        for (int i = 0; i < count; ++i) {
            channels_of(parts[i], values[i]);
            for (int k = 0; view.packed != nullptr && k < 4; ++k)
                values[i][k] = values[i][k] * set(mixed_scale) + set(mixed_middle);
        }
    } else {
        for (int i = 0; i < count; ++i)
            for (int k = 0; k < 4; ++k) values[i][k] = none;
    }
    const F length = select(s.stretched, to_float(s.major), one);
    const F least = length / set(map.most > 1 ? float(map.most) : 1.0f);
    const F narrow = max(select(s.stretched, to_float(s.minor), one), least);
    const F along_u = select(s.stretched, to_float(s.direction_u), one);
    const F along_v = select(s.stretched, to_float(s.direction_v), none);
    EllipseAxes e{along_u * length, along_v * length, (none - along_v) * narrow, along_u * narrow};
    const F lod = max(log2(select(s.stretched, narrow, one)), none);
    // On the last level an ellipse would have no largest size: lane by lane.
    good = good & ((lod < last) | !s.stretched);
    const M reads_ellipse = s.stretched & good;
    if (any(reads_ellipse)) {
        // The others read a small one, for nothing.
        const auto drawn = [&](F x) { return select(reads_ellipse, x, none); };
        e = {drawn(e.major_u), drawn(e.major_v), drawn(e.minor_u), drawn(e.minor_v)};
        F ellipses[count][4];
        between_levels<count>(
            maps, drawn(lod),
            [&](I level, F to[][4]) {
                read_ellipses<count>(views, at.u, at.v, e, map.most, level, to);
            },
            ellipses);
        for (int i = 0; i < count; ++i)
            for (int k = 0; k < 4; ++k)
                values[i][k] = select(reads_ellipse, ellipses[i][k], values[i][k]);
    }
    finish_values<count>(views, values, out);
    if (all(good)) return;
    for (int i = 0; i < count; ++i) sample_each(*maps[i], coordinates, bits_of(good), out[i]);
}

// As MipTexture::bicubic, on one level for each lane.
struct Keys {
    F weight[4];
};
RAST_INLINE Keys keys_of(F t) {
    const F t2 = t * t, t3 = t2 * t, half = set(0.5f);
    return {{set(-0.5f) * t3 + t2 - half * t, set(1.5f) * t3 - set(2.5f) * t2 + set(1.0f),
             set(-1.5f) * t3 + set(2.0f) * t2 + half * t, half * t3 - half * t2}};
}
template <int count>
RAST_INLINE void read_keys(const TextureView* const views[], F at_u, F at_v, I level, F out[][4]) {
    const TextureView& view = *views[0];
    const Sizes size = sizes_of(view, level);
    const F half = set(0.5f), none = set(0.0f);
    const F u = at_u * to_float(size.width) - half, v = at_v * to_float(size.height) - half;
    const F whole_x = floor(u), whole_y = floor(v);
    const Keys across = keys_of(u - whole_x), down = keys_of(v - whole_y);
    I columns[4], rows[4];
    for (int i = 0; i < 4; ++i) {
        const I offset = set(i - 1);
        columns[i] =
            wrapped(view.wrap_u, is_power(view.widths[0]), to_int(whole_x) + offset, size.width);
        rows[i] =
            wrapped(view.wrap_v, is_power(view.heights[0]), to_int(whole_y) + offset, size.height) *
                size.pitch +
            size.first;
    }
    F base[count][4], sum[count][4];
    for (int i = 0; i < count; ++i) {
        gather_texels(*views[i], rows[1] + columns[1], base[i]);
        for (int k = 0; k < 4; ++k) sum[i][k] = none;
    }
    for (int r = 0; r < 4; ++r)
        for (int i = 0; i < count; ++i) {
            F row[4] = {none, none, none, none};
            for (int c = 0; c < 4; ++c) {
                F t[4];
                gather_texels(*views[i], rows[r] + columns[c], t);
                for (int k = 0; k < 4; ++k)
                    row[k] = row[k] + (t[k] - base[i][k]) * across.weight[c];
            }
            for (int k = 0; k < 4; ++k) sum[i][k] = sum[i][k] + row[k] * down.weight[r];
        }
    const F middle = set(view.packed != nullptr ? float(texel_middle) : 0.0f);
    for (int i = 0; i < count; ++i)
        for (int k = 0; k < 4; ++k) out[i][k] = (base[i][k] + middle) + sum[i][k];
}
template <int count>
inline void read_bicubic(const BoundMap* const maps[], const Coordinates& at, Texel out[]) {
    const TextureView* views[count];
    for (int i = 0; i < count; ++i) views[i] = &maps[i]->texture->view();
    const TextureView& view = *views[0];
    const F none = set(0.0f);
    const M good = are_texels(view, at.u, at.v);
    const F u = select(good, at.u, none), v = select(good, at.v, none);
    F values[count][4];
    between_levels<count>(
        maps, view.level_count > 1 ? level_of_detail(view, at) : none,
        [&](I level, F to[][4]) { read_keys<count>(views, u, v, level, to); }, values);
    finish_values<count>(views, values, out);
    if (all(good)) return;
    for (int i = 0; i < count; ++i) sample_each(*maps[i], at, bits_of(good), out[i]);
}

// `count` maps on the same texels, all floats, all packed and alone, or all of one pair, through a
// filter that does not read by lanes.
template <int count>
RAST_INLINE void sample_maps(const BoundMap* const maps[], const Coordinates& at, Texel out[]) {
    const TextureView& view = maps[0]->texture->view();
    if (view.by_lanes && maps[0]->filter == TextureFilter::anisotropic) {
        read_probes<count>(maps, at, out);
        return;
    }
    if (view.rip_columns > 0 && maps[0]->filter == TextureFilter::ripmap) {
        read_rips<count>(maps, at, out);
        return;
    }
    if (view.by_lanes && maps[0]->filter == TextureFilter::bicubic) {
        read_bicubic<count>(maps, at, out);
        return;
    }
    if (view.by_lanes && view.level_count > 1 && maps[0]->filter == TextureFilter::ewa) {
        read_ewa<count>(maps, at, out);
        return;
    }
    for (int i = 0; i < count; ++i) {
        out[i] = no_texel();
        sample_each(*maps[i], at, 0, out[i]);
    }
}

// One vector by itself.
inline Texel sample_map(const BoundMap& map, const Coordinates& at) {
    Texel t = no_texel();
    const BoundMap* const one = &map;
    if (!reads_by_lanes(map)) {
        sample_maps<1>(&one, at, &t);
        return t;
    }
    Reads reads;
    find_level(map, at, reads);
    find_texels(map, at.u, at.v, reads);
    make_levels(map, reads);
    read_maps_at<1>(&one, at, reads, &t);
    return t;
}
