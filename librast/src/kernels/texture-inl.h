// Maps of a draw at points, a point per lane: nearest, bilinear and trilinear filters; probes-inl.h
// has more. The others, and coordinates out of range, are left to MipTexture::sample, lane by lane.
// Included once per instruction set, inside the namespace that has its lanes.

struct Texel {
    F r, g, b, a;
};
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

// Where a filter of two texels reads along one axis of a level of `size` texels: as rast::OnAxis.
// `powers`: sizes are powers of two.
struct LanesOnAxis {
    I first;
    F part;
};
RAST_INLINE LanesOnAxis on_axis(prep::Wrap wrap, bool powers, F t, I size) {
    const F below = floor(t);
    LanesOnAxis out{to_int(below), t - below};
    const I one = set(1), i = out.first;
    switch (wrap) {
        case prep::Wrap::repeat:
            out.first = powers ? i & (size - one) : modulo(i, size);
            break;
        case prep::Wrap::mirror: {
            const I turn = size + size;
            const I r = powers ? i & (turn - one) : modulo(i, turn);
            const M forward = r < size;
            out.first = select(forward, r, turn - set(2) - r);
            out.part = select(forward, out.part, set(1.0f) - out.part);
            break;
        }
        case prep::Wrap::clamp:
            out.first = min(max(i, set(-1)), size - one);
            break;
        case prep::Wrap::border:
            out.first = select((i < set(-1)) | (i > size - one), set(-2), i);
            break;
    }
    return out;
}
// One texel.
RAST_INLINE I wrapped(prep::Wrap wrap, bool powers, I i, I size) {
    const I one = set(1);
    if (wrap == prep::Wrap::repeat) return powers ? i & (size - one) : modulo(i, size);
    if (wrap == prep::Wrap::mirror) {
        const I turn = size + size;
        const I r = powers ? i & (turn - one) : modulo(i, turn);
        return select(r < size, r, turn - one - r);
    }
    if (wrap == prep::Wrap::clamp) return min(max(i, set(0)), size - one);
    return select((i < set(0)) | (i > size - one), set(-1), i);  // a margin
}

// The four texels of a bilinear filter, each lane on a level of its own: `top` and the one to its
// right, `bottom` and the one to its right. `weights` of both rows, as load_columns takes them.
struct Taps {
    alignas(64) std::uint32_t top[vector_size], bottom[vector_size];
    F across, down;
    I weights;
};

struct Sizes {
    I width, height, pitch, first;
};
RAST_INLINE Sizes sizes_of(const TextureView& view, I level) {
    if (view.level_count > std::uint32_t(lane_count)) {
        std::int32_t each[vector_size];
        store(level, each);
        const std::int32_t l = each[0];
        if (all(level == set(l)))
            return {set(view.widths[l]), set(view.heights[l]), set(view.pitches[l]),
                    set(view.firsts[l])};
        return {gather(view.widths, level), gather(view.heights, level),
                gather(view.pitches, level), gather(view.firsts, level)};
    }
    const Pick at = pick_of(level);
    return {pick(view.widths, at), pick(view.heights, at), pick(view.pitches, at),
            pick(view.firsts, at)};
}
RAST_INLINE bool is_power(std::int32_t v) {
    return (v & (v - 1)) == 0;
}
// `u` and `v` are in range of this level.
RAST_INLINE void place_taps(const TextureView& view, F u, F v, const Sizes& size, Taps& taps) {
    const F half = set(0.5f);
    const LanesOnAxis x =
        on_axis(view.wrap_u, is_power(view.widths[0]), u * to_float(size.width) - half, size.width);
    const LanesOnAxis y = on_axis(view.wrap_v, is_power(view.heights[0]),
                                  v * to_float(size.height) - half, size.height);
    const I top = y.first * size.pitch + (x.first + size.first);
    store(top, taps.top);
    store(top + size.pitch, taps.bottom);
    taps.across = x.part;
    taps.down = y.part;
    const I down = to_int(y.part * set(float(down_steps)) + half);
    // −(1 − down) for the top and −down for the bottom: both fit 16 bits.
    taps.weights = ((down + set(down_steps)) & set(0xffff)) - shift_left<16>(down);
}

// As MipTexture::mixed.
template <int part>
RAST_INLINE Quads mixed(const std::int16_t* texels, const Taps& taps) {
    Quads left, right;
    load_columns<part>(texels, taps.top, taps.bottom, taps.weights, left, right);
    return left + (right - left) * spread<part>(taps.across);
}
template <int part>
RAST_INLINE Quads mixed(const float* texels, const Taps& taps) {
    const Quads down = spread<part>(taps.down);
    const auto column = [&](const float* from) {
        const Quads top = load_texels<part>(from, taps.top);
        return top + (load_texels<part>(from, taps.bottom) - top) * down;
    };
    const Quads left = column(texels), right = column(texels + 4);
    return left + (right - left) * spread<part>(taps.across);
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

// As MipTexture::nearest_level.
RAST_INLINE F nearest_level(F lod) {
    const F fine = floor(lod);
    return select(lod - fine > set(0.5f), fine + set(1.0f), fine);
}

// Which texels a map reads at a vector of points, and how it mixes them.
struct Reads {
    Taps near, far;
    F between;  // of near and far
    I last;     // level of the pyramid
    bool two;   // levels that some lane reads
    M good;     // lanes whose coordinates are in range
};

RAST_INLINE M are_texels(const TextureView& view, F u, F v) {
    const F most = set(most_texels);
    return (abs(u) * set(float(view.widths[0])) < most) &
           (abs(v) * set(float(view.heights[0])) < most);
}

// In two steps, so that few operations wait for the level's quotient at a time: the level of detail
// goes to `between` first.
RAST_INLINE void find_level(const BoundMap& map, const Coordinates& at, Reads& reads) {
    const TextureView& view = map.texture->view();
    reads.between = set(0.0f);
    if (map.filter == TextureFilter::trilinear && view.level_count > 1)
        reads.between = level_of_detail(view, at);
    if (map.filter == TextureFilter::nearest_mip && view.level_count > 1)
        reads.between = nearest_level(level_of_detail(view, at));
}
RAST_INLINE void find_texels(const BoundMap& map, F at_u, F at_v, Reads& reads) {
    const TextureView& view = map.texture->view();
    reads.two = false;
    reads.last = set(0);
    const F none = set(0.0f);
    const I width = set(view.widths[0]), height = set(view.heights[0]);
    reads.good = are_texels(view, at_u, at_v);
    const F u = select(reads.good, at_u, none), v = select(reads.good, at_v, none);
    if (map.filter == TextureFilter::nearest) {
        const I x = wrapped(view.wrap_u, is_power(view.widths[0]),
                            to_int(floor(u * to_float(width))), width);
        const I y = wrapped(view.wrap_v, is_power(view.heights[0]),
                            to_int(floor(v * to_float(height))), height);
        store(y * set(view.pitches[0]) + (x + set(view.firsts[0])), reads.near.top);
        return;
    }
    const F lod = reads.between, whole = floor(lod);
    const I level = to_int(whole);
    reads.between = lod - whole;
    const M mixed = reads.between > none;
    reads.two = any(mixed);
    reads.last = select(mixed, level + set(1), level);
    if (reads.two) place_taps(view, u, v, sizes_of(view, reads.last), reads.far);
    place_taps(view, u, v, sizes_of(view, level), reads.near);
}

// Four floats of each lane's texel; packed ones as they are kept, code less texel_middle.
RAST_INLINE void gather_texels(const TextureView& view, I at, F out[4]) {
    if (view.packed == nullptr) {
        const I first = times<4>(at);
        for (int k = 0; k < 4; ++k) out[k] = gather(view.floats + k, first);
        return;
    }
    I low, high;
    gather_pairs(view.packed, view.pair != nullptr ? times<2>(at) : at, low, high);
    out[0] = to_float(shift_right<16>(shift_left<16>(low)));
    out[1] = to_float(shift_right<16>(low));
    out[2] = to_float(shift_right<16>(shift_left<16>(high)));
    out[3] = to_float(shift_right<16>(high));
}
// As MipTexture::finished.
RAST_INLINE F finished_code(F code) {
    return code * set(unpack_high) + code * set(unpack_low);
}
RAST_INLINE Texel nearest_texel(const TextureView& view, const Reads& reads) {
    F c[4];
    gather_texels(view, load(reads.near.top), c);
    for (int k = 0; view.packed != nullptr && k < 4; ++k)
        c[k] = finished_code(c[k] + set(float(texel_middle)));
    return {c[0], c[1], c[2], c[3]};
}

// Of `count` textures that are read at the same texels.
template <int count, int part = 0, class Channel>
RAST_INLINE void mix_levels(const Channel* const texels[], const Reads& reads,
                            Quads out[][part_count]) {
    constexpr bool floats = std::is_same_v<Channel, float>;
    for (int i = 0; i < count; ++i) out[i][part] = mixed<part>(texels[i], reads.near);
    if (reads.two) {
        const Quads between = spread<part>(reads.between);
        for (int i = 0; i < count; ++i) {
            Quads& near = out[i][part];
            const Quads both = near + (mixed<part>(texels[i], reads.far) - near) * between;
            // Lanes that read one level alone have it on both sides; floats may be infinite.
            near = floats ? select_positive(between, both, near) : both;
        }
    }
    if constexpr (part + 1 < part_count) mix_levels<count, part + 1>(texels, reads, out);
}

// Of two textures that lie together, from the first one's texels on.
template <int part = 0>
RAST_INLINE void mix_pair(const std::int16_t* texels, const Reads& reads, Quads out[][part_count]) {
    const auto read = [&](const Taps& taps, Quads mixed[2]) {
        Quads left[2], right[2];
        load_pair_columns<part>(texels, taps.top, taps.bottom, taps.weights, left, right);
        const Quads across = spread<part>(taps.across);
        for (int i = 0; i < 2; ++i) mixed[i] = left[i] + (right[i] - left[i]) * across;
    };
    Quads near[2], far[2];
    read(reads.near, near);
    for (int i = 0; i < 2; ++i) out[i][part] = near[i];
    if (reads.two) {
        const Quads between = spread<part>(reads.between);
        read(reads.far, far);
        for (int i = 0; i < 2; ++i) out[i][part] = near[i] + (far[i] - near[i]) * between;
    }
    if constexpr (part + 1 < part_count) mix_pair<part + 1>(texels, reads, out);
}

template <class Channel>
RAST_INLINE Texel finished_texel(const Quads parts[part_count]) {
    const auto finished = [](F v) {
        if constexpr (std::is_same_v<Channel, float>) return v;
        // code · unpack_high + code · unpack_low, to the bit: powers of two change no rounding.
        const F high = v * set(mixed_scale * unpack_high) + set(mixed_middle * unpack_high);
        return high + high * set(unpack_low / unpack_high);
    };
    F c[4];
    channels_of(parts, c);
    return {finished(c[0]), finished(c[1]), finished(c[2]), finished(c[3])};
}
template <int count, class Channel>
RAST_INLINE void filtered_texels(const Channel* const texels[], const Reads& reads, Texel out[]) {
    Quads parts[count][part_count];
    mix_levels<count>(texels, reads, parts);
    for (int i = 0; i < count; ++i) out[i] = finished_texel<Channel>(parts[i]);
}
// `count` textures of one pair.
template <int count>
RAST_INLINE void filtered_pair(const TextureView* const views[], const Reads& reads, Texel out[]) {
    Quads parts[2][part_count];
    mix_pair(views[0]->pair, reads, parts);
    // Not by index, which would keep the parts in memory.
    const auto finish = [&](int i, int which) {
        out[i] = finished_texel<std::int16_t>(parts[which]);
    };
    if (views[0]->is_second()) {
        finish(0, 1);
        if (count == 2) finish(count - 1, 0);
    } else {
        finish(0, 0);
        if (count == 2) finish(count - 1, 1);
    }
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
            map.filter == TextureFilter::nearest_mip || map.filter == TextureFilter::nearest);
}

// The levels that are read must be there.
RAST_INLINE void make_levels(const BoundMap& map, const Reads& reads) {
    if (!any(reads.last > set(std::int32_t(map.texture->pyramid_made()) - 1))) return;
    std::int32_t last[vector_size];
    store(reads.last, last);
    for (const std::int32_t l : last) map.texture->make_pyramid(std::uint32_t(l));
}

// Asks for the first row: the second one is the first of points below, mostly. Neighbours share
// cache lines. By the time they are read, most have come.
template <class Channel>
RAST_INLINE void prefetch(const Channel* texels, std::size_t step, const Reads& reads) {
    for (std::size_t lane = 0; lane < vector_size; lane += 2)
        __builtin_prefetch(texels + reads.near.top[lane] * step);
    if (!reads.two) return;
    for (std::size_t lane = 0; lane < vector_size; lane += 4)
        __builtin_prefetch(texels + reads.far.top[lane] * step);
}
RAST_INLINE void prefetch(const TextureView& view, const Reads& reads) {
    if (view.packed == nullptr)
        prefetch(view.floats, 4, reads);
    else if (view.pair == nullptr)
        prefetch(view.packed, 4, reads);
    else
        prefetch(view.pair, 8, reads);
}

// `count` maps on the same texels, all floats, all packed and alone, or all of one pair.
template <int count>
RAST_INLINE void read_maps_at(const BoundMap* const maps[], const Coordinates& at,
                              const Reads& reads, Texel out[]) {
    const TextureView* views[count];
    for (int i = 0; i < count; ++i) views[i] = &maps[i]->texture->view();
    if (maps[0]->filter == TextureFilter::nearest) {
        for (int i = 0; i < count; ++i) out[i] = nearest_texel(*views[i], reads);
    } else if (views[0]->pair != nullptr) {
        filtered_pair<count>(views, reads, out);
    } else if (views[0]->packed != nullptr) {
        const std::int16_t* texels[count];
        for (int i = 0; i < count; ++i) texels[i] = views[i]->packed;
        filtered_texels<count>(texels, reads, out);
    } else {
        const float* texels[count];
        for (int i = 0; i < count; ++i) texels[i] = views[i]->floats;
        filtered_texels<count>(texels, reads, out);
    }
    if (all(reads.good)) return;
    for (int i = 0; i < count; ++i) sample_each(*maps[i], at, bits_of(reads.good), out[i]);
}
