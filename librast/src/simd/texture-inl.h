// Maps of a draw at points, a point per lane: nearest, bilinear and trilinear filters. The others,
// and coordinates out of range, are left to MipTexture::sample, lane by lane.
// Included once per instruction set, inside the namespace that has its lanes.

struct Texel {
    F r, g, b, a;
};
template <bool alpha>
RAST_INLINE Texel mix(const Texel& from, const Texel& to, F part) {
    const auto between = [&](F a, F b) { return a + (b - a) * part; };
    return {between(from.r, to.r), between(from.g, to.g), between(from.b, to.b),
            alpha ? between(from.a, to.a) : from.a};
}
RAST_INLINE Texel select(M m, const Texel& yes, const Texel& no) {
    return {select(m, yes.r, no.r), select(m, yes.g, no.g), select(m, yes.b, no.b),
            select(m, yes.a, no.a)};
}
RAST_INLINE Texel no_texel() {
    return {set(0.0f), set(0.0f), set(0.0f), set(0.0f)};
}

// Texel coordinates beyond this are left to MipTexture::sample: below, float has them to a quarter,
// and the wrapping below is exact.
inline constexpr float most_texels = 1 << 21;

// i modulo `size`, for |i| ≤ most_texels.
RAST_INLINE I modulo(I i, I size) {
    const F turns = floor(to_float(i) / to_float(size));
    return i - to_int(turns) * size;
}

// Texel numbers along one axis of a level of `size` texels. `powers`: sizes are powers of two.
RAST_INLINE I wrapped(prep::Wrap wrap, bool powers, I i, I size) {
    const I one = set(1);
    if (wrap == prep::Wrap::repeat) return powers ? i & (size - one) : modulo(i, size);
    if (wrap == prep::Wrap::mirror) {
        const I turn = size + size;
        const I r = powers ? i & (turn - one) : modulo(i, turn);
        return select(r < size, r, turn - one - r);
    }
    return min(max(i, set(0)), size - one);  // border texels are blanked afterwards
}

// The four texels of a bilinear filter, each lane on a level of its own. Texels: top left and
// right, bottom left and right.
struct Taps {
    I at[4];
    F across, down;
    M inside[4];  // where there is a border
};

struct Sizes {
    I width, height, pitch, first;
};
RAST_INLINE Sizes sizes_of(const TextureView& view, I level) {
    std::int32_t each[vector_size];
    store(level, each);
    const std::int32_t l = each[0];
    if (all(level == set(l)))
        return {set(view.widths[l]), set(view.heights[l]), set(view.pitches[l]),
                set(view.firsts[l])};
    return {gather(view.widths, level), gather(view.heights, level), gather(view.pitches, level),
            gather(view.firsts, level)};
}
RAST_INLINE bool is_power(std::int32_t v) {
    return (v & (v - 1)) == 0;
}
RAST_INLINE bool has_border(const TextureView& view) {
    return view.wrap_u == prep::Wrap::border || view.wrap_v == prep::Wrap::border;
}

RAST_INLINE void place_taps(const TextureView& view, F u, F v, I level, Taps& taps, M& good) {
    const Sizes size = sizes_of(view, level);
    const F half = set(0.5f), most = set(most_texels);
    const F tu = u * to_float(size.width) - half, tv = v * to_float(size.height) - half;
    good = good & ((abs(tu) < most) & (abs(tv) < most));
    const F su = select(good, tu, set(0.0f)), sv = select(good, tv, set(0.0f));
    const F fu = floor(su), fv = floor(sv);
    taps.across = su - fu;
    taps.down = sv - fv;
    const bool wide = is_power(view.widths[0]), high = is_power(view.heights[0]);
    const I x0 = to_int(fu), y0 = to_int(fv), x1 = x0 + set(1), y1 = y0 + set(1);
    const I left = wrapped(view.wrap_u, wide, x0, size.width);
    const I right = wrapped(view.wrap_u, wide, x1, size.width);
    const I top = wrapped(view.wrap_v, high, y0, size.height) * size.pitch + size.first;
    const I bottom = wrapped(view.wrap_v, high, y1, size.height) * size.pitch + size.first;
    taps.at[0] = top + left;
    taps.at[1] = top + right;
    taps.at[2] = bottom + left;
    taps.at[3] = bottom + right;
    if (!has_border(view)) return;
    const M yes = set(0) == set(0);
    const auto within = [&](prep::Wrap wrap, I i, I extent) {
        return wrap == prep::Wrap::border ? (i > set(-1)) & (i < extent) : yes;
    };
    const M in_left = within(view.wrap_u, x0, size.width);
    const M in_right = within(view.wrap_u, x1, size.width);
    const M in_top = within(view.wrap_v, y0, size.height);
    const M in_bottom = within(view.wrap_v, y1, size.height);
    taps.inside[0] = in_top & in_left;
    taps.inside[1] = in_top & in_right;
    taps.inside[2] = in_bottom & in_left;
    taps.inside[3] = in_bottom & in_right;
}

// Colours as they are stored: packed ones times texel_scale.
template <bool packed, bool alpha>
RAST_INLINE Texel read_texels(const TextureView& view, I at) {
    Texel t;
    if constexpr (packed) {
        const I mask = set((1 << packed_bits) - 1);
        I low, high;
        gather_pairs(view.packed, at, low, high);
        t.r = to_float(low & mask);
        t.g = to_float(shift_right_unsigned<packed_bits>(low) |
                       shift_left<11>(shift_right_unsigned<packed_bits>(high)));
        t.b = to_float(high & mask);
        t.a = set(1.0f);
        if (alpha && view.alpha != nullptr) t.a = gather(view.alpha, at);
    } else {
        const I first = times<4>(at);
        t.r = gather(view.floats, first);
        t.g = gather(view.floats + 1, first);
        t.b = gather(view.floats + 2, first);
        t.a = alpha ? gather(view.floats + 3, first) : set(1.0f);
    }
    return t;
}

// The order of operations of MipTexture::bilinear: a + f·(b − a).
template <bool packed, bool alpha>
RAST_INLINE Texel bilinear(const TextureView& view, const Taps& taps) {
    const bool border = has_border(view);
    const auto read = [&](int k) {
        Texel t = read_texels<packed, alpha>(view, taps.at[k]);
        return border ? select(taps.inside[k], t, no_texel()) : t;
    };
    const Texel top = mix<alpha>(read(0), read(1), taps.across);
    return mix<alpha>(top, mix<alpha>(read(2), read(3), taps.across), taps.down);
}

// As MipTexture::level_of_detail.
RAST_INLINE F level_of_detail(const TextureView& view, const Coordinates& at) {
    const F width = set(float(view.widths[0])), height = set(float(view.heights[0]));
    const F ax = at.u_x * width, bx = at.v_x * height;
    const F ay = at.u_y * width, by = at.v_y * height;
    const F longest = max(ax * ax + bx * bx, ay * ay + by * by);
    const M minified = longest > set(1.0f), in_range = longest < set(1.0e30f);
    if (!any(minified)) return set(0.0f);
    const F lod = set(0.5f) * log2(select(minified & in_range, longest, set(1.0f)));
    const F most = set(float(view.level_count - 1));
    return select(minified, select(in_range, min(lod, most), most), set(0.0f));
}

// Which texels a map reads at a vector of points, and how it mixes them.
struct Reads {
    Taps near, far;
    F between;       // of near and far
    I last;          // level of the pyramid
    bool two, four;  // levels that some lane reads; texels a level, else one
    M good;          // lanes whose coordinates are in range
};

inline void find_texels(const BoundMap& map, const Coordinates& at, Reads& reads) {
    const TextureView& view = map.texture->view();
    reads.good = set(0) == set(0);
    reads.two = false;
    reads.last = set(0);
    reads.four = map.filter != TextureFilter::nearest;
    I level = set(0);
    if (map.filter == TextureFilter::trilinear && view.level_count > 1) {
        const F lod = level_of_detail(view, at), whole = floor(lod);
        level = to_int(whole);
        reads.between = lod - whole;
        const M mixed = reads.between > set(0.0f);
        reads.two = any(mixed);
        const I next = select(mixed, level + set(1), level);
        reads.last = next;
        if (reads.two) place_taps(view, at.u, at.v, next, reads.far, reads.good);
    }
    if (reads.four) {
        place_taps(view, at.u, at.v, level, reads.near, reads.good);
        return;
    }
    const I width = set(view.widths[0]), height = set(view.heights[0]);
    const F tu = at.u * to_float(width), tv = at.v * to_float(height), most = set(most_texels);
    reads.good = (abs(tu) < most) & (abs(tv) < most);
    const I x = to_int(floor(select(reads.good, tu, set(0.0f))));
    const I y = to_int(floor(select(reads.good, tv, set(0.0f))));
    reads.near.at[0] =
        wrapped(view.wrap_u, is_power(view.widths[0]), x, width) +
        wrapped(view.wrap_v, is_power(view.heights[0]), y, height) * set(view.pitches[0]);
    if (!has_border(view)) return;
    const M in_u = (x > set(-1)) & (x < width), in_v = (y > set(-1)) & (y < height);
    const M yes = set(0) == set(0);
    reads.near.inside[0] = (view.wrap_u == prep::Wrap::border ? in_u : yes) &
                           (view.wrap_v == prep::Wrap::border ? in_v : yes);
}

template <bool packed, bool alpha>
RAST_INLINE Texel read_filtered(const TextureView& view, const Reads& reads) {
    Texel t;
    if (reads.four) {
        t = bilinear<packed, alpha>(view, reads.near);
        if (reads.two) {
            const Texel far = bilinear<packed, alpha>(view, reads.far);
            const Texel mixed = mix<alpha>(t, far, reads.between);
            // Lanes that read one level alone have it on both sides; floats may be infinite.
            const M several = reads.between > set(0.0f);
            if (packed)
                t = {mixed.r, mixed.g, mixed.b, alpha ? select(several, mixed.a, t.a) : mixed.a};
            else
                t = select(several, mixed, t);
        }
    } else {
        t = read_texels<packed, alpha>(view, reads.near.at[0]);
        if (has_border(view)) t = select(reads.near.inside[0], t, no_texel());
    }
    if constexpr (packed) {
        const auto unpack = [](F v) { return v * set(unpack_high) + v * set(unpack_low); };
        t = {unpack(t.r), unpack(t.g), unpack(t.b), t.a};
    }
    return t;
}

// Through MipTexture::sample; for the lanes that are not `done`.
inline void sample_each(const BoundMap& map, const Coordinates& at, std::uint32_t done, Texel& t) {
    float v[6][vector_size], out[4][vector_size];
    store(at.u, v[0]);
    store(at.v, v[1]);
    store(at.u_x, v[2]);
    store(at.v_x, v[3]);
    store(at.u_y, v[4]);
    store(at.v_y, v[5]);
    store(t.r, out[0]);
    store(t.g, out[1]);
    store(t.b, out[2]);
    store(t.a, out[3]);
    for (std::size_t lane = 0; lane < vector_size; ++lane) {
        if (done >> lane & 1u) continue;
        const float from[6] = {v[0][lane], v[1][lane], v[2][lane],
                               v[3][lane], v[4][lane], v[5][lane]};
        float texel[4];
        sample_texture(*map.texture, map.filter, map.most, from, texel);
        for (int k = 0; k < 4; ++k) out[k][lane] = texel[k];
    }
    t = {load(out[0]), load(out[1]), load(out[2]), load(out[3])};
}

RAST_INLINE bool reads_by_lanes(const BoundMap& map) {
    return map.texture->view().by_lanes &&
           (map.filter == TextureFilter::trilinear || map.filter == TextureFilter::bilinear ||
            map.filter == TextureFilter::nearest);
}

// The levels that are read must be there.
RAST_INLINE void make_levels(const BoundMap& map, const Reads& reads) {
    if (!any(reads.last > set(std::int32_t(map.texture->pyramid_made()) - 1))) return;
    std::int32_t last[vector_size];
    store(reads.last, last);
    for (const std::int32_t l : last) map.texture->make_pyramid(std::uint32_t(l));
}

// Asks for the rows of every other lane: neighbours' texels share cache lines. By the time they
// are read, most have come.
RAST_INLINE void prefetch(const TextureView& view, const Reads& reads) {
    const auto ask = [&](I at) {
        std::int32_t each[vector_size];
        store(at, each);
        for (std::size_t lane = 0; lane < vector_size; lane += 2) {
            const std::size_t n = std::size_t(each[lane]);
            __builtin_prefetch(view.packed != nullptr ? static_cast<const void*>(view.packed + n)
                                                      : view.floats + n * 4);
        }
    };
    ask(reads.near.at[0]);
    if (reads.four) ask(reads.near.at[2]);
    if (!reads.two) return;
    ask(reads.far.at[0]);
    ask(reads.far.at[2]);
}

template <bool alpha>
RAST_INLINE Texel read_map(const BoundMap& map, const Coordinates& at, const Reads& reads) {
    const TextureView& view = map.texture->view();
    Texel t = view.packed != nullptr ? read_filtered<true, alpha>(view, reads)
                                     : read_filtered<false, alpha>(view, reads);
    if (!all(reads.good)) sample_each(map, at, bits_of(reads.good), t);
    return t;
}

// One vector by itself.
template <bool alpha>
inline Texel sample_map(const BoundMap& map, const Coordinates& at) {
    if (!reads_by_lanes(map)) {
        Texel t = no_texel();
        sample_each(map, at, 0, t);
        return t;
    }
    Reads reads;
    find_texels(map, at, reads);
    make_levels(map, reads);
    return read_map<alpha>(map, at, reads);
}
