// Maps of a draw at visible points.
// Included once per instruction set, inside the namespace that has its lanes.

struct Texel {
    F r, g, b, a;
};

// Texel coordinates beyond this are left to MipTexture::sample: below, float has them to a quarter.
inline constexpr float most_texels = 1 << 21;

// Texel numbers of a bilinear pair along one axis of a level of `size` texels.
RAST_INLINE void wrap_pair(const TextureAxis& axis, I first, I size, I& low, I& high) {
    const I one = set(1), zero = set(0);
    low = first;
    high = first + one;
    if (axis.wrap == prep::Wrap::clamp) {
        const I last = size - one;
        low = min(max(low, zero), last);
        high = min(max(high, zero), last);
    } else if (axis.wrap == prep::Wrap::repeat) {
        low = low & (size - one);
        high = high & (size - one);
    } else {
        const I turn = size + size - one;
        const auto mirrored = [&](I v) {
            const I r = v & turn;
            return select(r < size, r, turn - r);
        };
        low = mirrored(low);
        high = mirrored(high);
    }
}

// What the four texels of a bilinear filter are, for each lane on a level of its own.
struct Taps {
    std::int32_t at[4][lane_count];
    F across, down;
};
RAST_INLINE void place_taps(const TextureView& view, F u, F v, I level, Taps& taps, M& good) {
    const I width = gather(view.widths, level), height = gather(view.heights, level);
    const F half = set(0.5f), most = set(most_texels);
    const F tu = u * to_float(width) - half, tv = v * to_float(height) - half;
    good = good & ((abs(tu) < most) & (abs(tv) < most));
    const F su = select(good, tu, set(0.0f)), sv = select(good, tv, set(0.0f));
    const F fu = floor(su), fv = floor(sv);
    taps.across = su - fu;
    taps.down = sv - fv;
    I x0, x1, y0, y1;
    wrap_pair(view.u, to_int(fu), width, x0, x1);
    wrap_pair(view.v, to_int(fv), height, y0, y1);
    const I pitch = gather(view.pitches, level), top = y0 * pitch, bottom = y1 * pitch;
    store(top + x0, taps.at[0]);
    store(top + x1, taps.at[1]);
    store(bottom + x0, taps.at[2]);
    store(bottom + x1, taps.at[3]);
}

// All lanes' rows are asked for before the first is used: one after the other, each would wait for
// memory by itself.
RAST_INLINE void prefetch(const TextureView& view, const std::int32_t* levels, const Taps& taps) {
    for (int lane = 0; lane < lane_count; ++lane) {
        const float* const texels = view.texels[levels[lane]];
        __builtin_prefetch(texels + std::size_t(taps.at[0][lane]) * 4);
        __builtin_prefetch(texels + std::size_t(taps.at[2][lane]) * 4);
    }
}

// The order of operations of MipTexture::bilinear: a + f·(b − a). For the lanes from `first` on.
RAST_INLINE Texels bilinear(const TextureView& view, const std::int32_t* levels, const Taps& taps,
                            int first) {
    const auto at = [&](int k) {
        const float* from[texels_at_once];
        for (int i = 0; i < texels_at_once; ++i)
            from[i] = view.texels[levels[first + i]] + std::size_t(taps.at[k][first + i]) * 4;
        return load_texels(from);
    };
    const Texels fx = spread(taps.across, first), fy = spread(taps.down, first);
    const Texels a = at(0), c = at(2);
    const Texels top = a + (at(1) - a) * fx, bottom = c + (at(3) - c) * fx;
    return top + (bottom - top) * fy;
}

// As MipTexture::level_of_detail.
RAST_INLINE F level_of_detail(const TextureView& view, F dux, F dvx, F duy, F dvy) {
    const F width = set(float(view.widths[0])), height = set(float(view.heights[0]));
    const F ax = dux * width, bx = dvx * height, ay = duy * width, by = dvy * height;
    const F longest = max(ax * ax + bx * bx, ay * ay + by * by);
    const M minified = longest > set(1.0f), in_range = longest < set(1.0e30f);
    const F lod = set(0.5f) * log2(select(minified & in_range, longest, set(1.0f)));
    const F most = set(float(view.level_count - 1));
    return select(minified, select(in_range, min(lod, most), most), set(0.0f));
}

// `values`: u, v, then their change per pixel right and down. Texels go to `out`, lane by lane.
inline void sample_lanes(const BoundMap& map, const F values[6], float* out) {
    const TextureView& view = map.texture->view();
    const bool several = map.filter == TextureFilter::trilinear && view.level_count > 1;
    M good = set(0.0f) == set(0.0f);
    I level = set(0);
    F between = set(0.0f);
    I next = level;
    std::uint32_t two = 0;
    if (several) {
        const F lod = level_of_detail(view, values[2], values[3], values[4], values[5]);
        const F whole = floor(lod);
        level = to_int(whole);
        between = lod - whole;
        next = select(between > set(0.0f), level + set(1), level);
        two = bits_of(between > set(0.0f));
    }
    std::int32_t levels[lane_count], next_levels[lane_count];
    store(level, levels);
    store(next, next_levels);
    if (any(next > set(std::int32_t(map.texture->pyramid_made()) - 1)))
        for (const std::int32_t l : next_levels) map.texture->make_pyramid(std::uint32_t(l));
    Taps near, far;
    place_taps(view, values[0], values[1], level, near, good);
    prefetch(view, levels, near);
    if (two != 0) {
        place_taps(view, values[0], values[1], next, far, good);
        prefetch(view, next_levels, far);
    }
    for (int first = 0; first < lane_count; first += texels_at_once) {
        Texels texels = bilinear(view, levels, near, first);
        if (two >> first & ((1u << texels_at_once) - 1)) {
            const Texels part = spread(between, first);
            const Texels mixed = texels + (bilinear(view, next_levels, far, first) - texels) * part;
            texels = where_positive(part, mixed, texels);
        }
        store(texels, out + 4 * first);
    }
    const std::uint32_t usable = bits_of(good);
    if (all(good)) return;
    float v[6][lane_count];
    for (int k = 0; k < 6; ++k) store(values[k], v[k]);
    for (int lane = 0; lane < lane_count; ++lane) {
        if (usable >> lane & 1u) continue;
        const float at[6] = {v[0][lane], v[1][lane], v[2][lane],
                             v[3][lane], v[4][lane], v[5][lane]};
        sample_texture(*map.texture, map.filter, map.most, at, out + 4 * lane);
    }
}

inline void sample_each(const BoundMap& map, const F values[6], float* out) {
    float v[6][lane_count];
    for (int k = 0; k < 6; ++k) store(values[k], v[k]);
    for (int lane = 0; lane < lane_count; ++lane) {
        const float at[6] = {v[0][lane], v[1][lane], v[2][lane],
                             v[3][lane], v[4][lane], v[5][lane]};
        sample_texture(*map.texture, map.filter, map.most, at, out + 4 * lane);
    }
}

template <class S>
RAST_INLINE Texel sample_map(const BoundMap& map, const S& s) {
    F uv[3][2];
    for (int k = 0; k < 3; ++k)
        for (int c = 0; c < 2; ++c) uv[k][c] = corner_value<2>(s, map.uv, k, c);
    const auto turned = [&](int row, F u, F v) {
        return set(map.matrix[row * 2]) * u + set(map.matrix[row * 2 + 1]) * v;
    };
    const F raw_u = blend_within(s, uv[0][0], uv[1][0], uv[2][0]);
    const F raw_v = blend_within(s, uv[0][1], uv[1][1], uv[2][1]);
    const F u1 = uv[1][0] - uv[0][0], u2 = uv[2][0] - uv[0][0];
    const F v1 = uv[1][1] - uv[0][1], v2 = uv[2][1] - uv[0][1];
    F values[6];
    values[0] = turned(0, raw_u, raw_v) + set(map.offset[0]);
    values[1] = turned(1, raw_u, raw_v) + set(map.offset[1]);
    const auto step = [&](F b, F c, int at) {
        const F du = b * u1 + c * u2, dv = b * v1 + c * v2;
        values[at] = turned(0, du, dv);
        values[at + 1] = turned(1, du, dv);
    };
    step(s.b_x, s.c_x, 2);
    step(s.b_y, s.c_y, 4);
    alignas(64) float out[4 * lane_count];
    const bool by_lanes = map.texture->view().by_lanes && (map.filter == TextureFilter::trilinear ||
                                                           map.filter == TextureFilter::bilinear);
    if (by_lanes)
        sample_lanes(map, values, out);
    else
        sample_each(map, values, out);
    Texel texel;
    load_interleaved4(out, texel.r, texel.g, texel.b, texel.a);
    return texel;
}
