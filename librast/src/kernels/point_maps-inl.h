// The maps at the points: what is to be read is asked for first, then read.
// Included once per instruction set, inside the namespace that has its lanes.

RAST_INLINE Coordinates coordinates_at(const float* planes, std::size_t held, std::size_t n) {
    F values[6];
    for (int c = 0; c < 6; ++c) {
        values[c] = get_plane(planes, c, n);
        // Lanes past the end ask for no level of their own.
        if (held - n < vector_size)
            values[c] = select(iota() < set(std::int32_t(held - n)), values[c], set(0.0f));
    }
    return {values[0], values[1], values[2], values[3], values[4], values[5]};
}

// Those of a stage: some of ShadeDraw::used, on the same texels.
RAST_INLINE const float* coordinates_for(const ShadeDraw& draw, const StageList& list,
                                         const Stage& group, Points& points) {
    return points.at(list, coordinates_of(draw.maps[draw.used[group.begin]].place));
}

// What is to be read of them; it is asked for.
inline void ask_for(const ShadeDraw& draw, const StageList& list, const Stage& group,
                    Points& points) {
    const BoundMap& first = draw.maps[draw.used[group.begin]];
    if (!reads_by_lanes(first)) return;
    const float* const coordinates = coordinates_for(draw, list, group, points);
    for (std::size_t n = 0; n < points.held; n += vector_size)
        find_level(first, coordinates_at(coordinates, points.held, n),
                   points.reads[n / vector_size]);
    for (std::size_t n = 0; n < points.held; n += vector_size) {
        const Coordinates at = coordinates_at(coordinates, points.held, n);
        Reads& reads = points.reads[n / vector_size];
        find_texels(first, at.u, at.v, reads);
        const std::int16_t* asked = nullptr;  // a pair: both come
        for (std::uint32_t m = group.begin; m < group.end; ++m) {
            const BoundMap& map = draw.maps[draw.used[m]];
            const TextureView& view = map.texture->view();
            make_levels(map, reads);
            if (view.pair == nullptr || view.pair != asked) prefetch(view, reads);
            asked = view.pair;
        }
    }
}

// `count` maps from `first` on: what was asked for.
template <int count>
RAST_INLINE void read_together(const ShadeDraw& draw, const StageList& list, std::uint32_t first,
                               const float* coordinates, Points& points) {
    const BoundMap* maps[count];
    float* texels[count];
    for (int i = 0; i < count; ++i) {
        const MapKind kind = draw.used[first + std::uint32_t(i)];
        maps[i] = &draw.maps[kind];
        texels[i] = points.at(list, texels_of(kind));
    }
    for (std::size_t n = 0; n < points.held; n += vector_size) {
        Texel t[count];
        read_maps_at<count>(maps, coordinates_at(coordinates, points.held, n),
                            points.reads[n / vector_size], t);
        for (int i = 0; i < count; ++i) put3({t[i].r, t[i].g, t[i].b}, texels[i], n);
    }
}
// Apart: among it, the other one would lose registers.
template <int count>
__attribute__((noinline)) void sample_together(const ShadeDraw& draw, const StageList& list,
                                               std::uint32_t first, const float* coordinates,
                                               Points& points) {
    const BoundMap* maps[count];
    float* texels[count];
    for (int i = 0; i < count; ++i) {
        const MapKind kind = draw.used[first + std::uint32_t(i)];
        maps[i] = &draw.maps[kind];
        texels[i] = points.at(list, texels_of(kind));
    }
    for (std::size_t n = 0; n < points.held; n += vector_size) {
        Texel t[count];
        sample_maps<count>(maps, coordinates_at(coordinates, points.held, n), t);
        for (int i = 0; i < count; ++i) put3({t[i].r, t[i].g, t[i].b}, texels[i], n);
    }
}

// Beyond the edges of a map that clamps heights are level: slopes, which clamp too, are not.
inline void level_beyond_edges(const TextureView& view, const float* coordinates, float* slopes,
                               const Points& points) {
    const F zero = set(0.0f), one = set(1.0f);
    for (std::size_t n = 0; n < points.held; n += vector_size) {
        const Coordinates at = coordinates_at(coordinates, points.held, n);
        V3 slope = get3(slopes, n);
        if (view.wrap_u == prep::Wrap::clamp)
            slope.x = select((at.u < zero) | (at.u > one), zero, slope.x);
        if (view.wrap_v == prep::Wrap::clamp)
            slope.y = select((at.v < zero) | (at.v > one), zero, slope.y);
        put3(slope, slopes, n);
    }
}

// The texels of one stage's maps, which have been asked for.
inline void read_maps(const ShadeDraw& draw, const StageList& list, const Stage& group,
                      Points& points) {
    const float* const coordinates = coordinates_for(draw, list, group, points);
    const auto are_alike = [&](std::uint32_t m, std::uint32_t n) {
        const TextureView& a = draw.maps[draw.used[m]].texture->view();
        const TextureView& b = draw.maps[draw.used[n]].texture->view();
        // Two halves of one pair, not one half twice.
        return (a.packed != nullptr) == (b.packed != nullptr) && a.pair == b.pair &&
               (a.pair == nullptr || a.packed != b.packed);
    };
    const bool asked = reads_by_lanes(draw.maps[draw.used[group.begin]]);
    for (std::uint32_t m = group.begin; m < group.end; ++m) {
        const bool two = m + 1 < group.end && are_alike(m, m + 1);
        if (asked && two)
            read_together<2>(draw, list, m, coordinates, points);
        else if (asked)
            read_together<1>(draw, list, m, coordinates, points);
        else if (two)
            sample_together<2>(draw, list, m, coordinates, points);
        else
            sample_together<1>(draw, list, m, coordinates, points);
        m += two;
    }
    for (std::uint32_t m = group.begin; m < group.end; ++m) {
        const TextureView& view = draw.maps[draw.used[m]].texture->view();
        if (draw.used[m] == MapKind::bump &&
            (view.wrap_u == prep::Wrap::clamp || view.wrap_v == prep::Wrap::clamp))
            level_beyond_edges(view, coordinates, points.at(list, texels_of(MapKind::bump)),
                               points);
    }
}
