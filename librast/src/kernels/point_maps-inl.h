// The maps at the points: what is to be read is asked for first, then read.
// Included once per instruction set, inside the namespace that has its lanes.

RAST_INLINE Coordinates coordinates_at(const Points& points, const BoundMap& map, std::size_t n) {
    F values[6];
    for (int c = 0; c < 6; ++c) {
        values[c] = points.get(Points::coordinates + 6 * map.place + c, n);
        // Lanes past the end ask for no level of their own.
        if (points.held - n < vector_size)
            values[c] = select(iota() < set(std::int32_t(points.held - n)), values[c], set(0.0f));
    }
    return {values[0], values[1], values[2], values[3], values[4], values[5]};
}

// Some of a draw's maps that are read at the same texels: ShadeDraw::used from `begin` to `end`.
struct MapGroup {
    int begin, end;
};
RAST_INLINE MapGroup map_group(const ShadeDraw& draw, int begin) {
    int end = begin + 1;
    while (end < draw.used_count && draw.maps[draw.used[end]].same_texels) ++end;
    return {begin, end};
}

// What is to be read of them; it is asked for.
inline void ask_for(const ShadeDraw& draw, const MapGroup& group, Points& points) {
    const BoundMap& first = draw.maps[draw.used[group.begin]];
    if (!reads_by_lanes(first)) return;
    for (std::size_t n = 0; n < points.held; n += vector_size)
        find_level(first, coordinates_at(points, first, n), points.reads[n / vector_size]);
    for (std::size_t n = 0; n < points.held; n += vector_size) {
        const Coordinates at = coordinates_at(points, first, n);
        Reads& reads = points.reads[n / vector_size];
        find_texels(first, at.u, at.v, reads);
        const std::int16_t* asked = nullptr;  // a pair: both come
        for (int m = group.begin; m < group.end; ++m) {
            const BoundMap& map = draw.maps[draw.used[m]];
            const TextureView& view = map.texture->view();
            make_levels(map, reads);
            if (view.pair == nullptr || view.pair != asked) prefetch(view, reads);
            asked = view.pair;
        }
    }
}

// What was asked for.
template <int count>
RAST_INLINE void read_together(const ShadeDraw& draw, int first, Points& points) {
    const BoundMap* maps[count];
    for (int i = 0; i < count; ++i) maps[i] = &draw.maps[draw.used[first + i]];
    for (std::size_t n = 0; n < points.held; n += vector_size) {
        Texel t[count];
        read_maps_at<count>(maps, coordinates_at(points, *maps[0], n),
                            points.reads[n / vector_size], t);
        for (int i = 0; i < count; ++i)
            points.put3({t[i].r, t[i].g, t[i].b}, Points::texels + 3 * int(draw.used[first + i]),
                        n);
    }
}
// Apart: among it, the other one would lose registers.
template <int count>
__attribute__((noinline)) void sample_together(const ShadeDraw& draw, int first, Points& points) {
    const BoundMap* maps[count];
    for (int i = 0; i < count; ++i) maps[i] = &draw.maps[draw.used[first + i]];
    for (std::size_t n = 0; n < points.held; n += vector_size) {
        Texel t[count];
        sample_maps<count>(maps, coordinates_at(points, *maps[0], n), t);
        for (int i = 0; i < count; ++i)
            points.put3({t[i].r, t[i].g, t[i].b}, Points::texels + 3 * int(draw.used[first + i]),
                        n);
    }
}

// The texels of all maps. Those of the first group have been asked for.
inline void read_maps(const ShadeDraw& draw, Points& points) {
    for (MapGroup group = map_group(draw, 0);; group = map_group(draw, group.end)) {
        if (group.begin > 0) ask_for(draw, group, points);
        const auto are_alike = [&](int m, int n) {
            const TextureView& a = draw.maps[draw.used[m]].texture->view();
            const TextureView& b = draw.maps[draw.used[n]].texture->view();
            // Two halves of one pair, not one half twice.
            return (a.packed != nullptr) == (b.packed != nullptr) && a.pair == b.pair &&
                   (a.pair == nullptr || a.packed != b.packed);
        };
        const bool asked = reads_by_lanes(draw.maps[draw.used[group.begin]]);
        for (int m = group.begin; m < group.end; ++m) {
            const bool two = m + 1 < group.end && are_alike(m, m + 1);
            if (asked && two)
                read_together<2>(draw, m, points);
            else if (asked)
                read_together<1>(draw, m, points);
            else if (two)
                sample_together<2>(draw, m, points);
            else
                sample_together<1>(draw, m, points);
            m += two;
        }
        if (group.end == draw.used_count) return;
    }
}
RAST_INLINE V3 texel_of(const Points& points, MapKind kind, std::size_t n) {
    return points.get3(Points::texels + 3 * int(kind), n);
}
