// Whether the alpha mask lets points stand.
// Included once per instruction set, inside the namespace that has its lanes.

// Points of one triangle, whole pixels from the first lane's.
inline M alpha_passes(const ShadeDraw& draw, I px, I py, I id) {
    F alpha = set(draw.diffuse[3]);
    if (draw.colors != nullptr || draw.maps[MapKind::diffuse]) {
        std::int32_t x[vector_size], y[vector_size];
        store(px, x);
        store(py, y);
        TilePlace place;
        place.x = x[0];
        place.y = y[0];
        const I i = shift_right<subpixel_bits>(px - set(place.x));
        const I j = shift_right<subpixel_bits>(py - set(place.y)), entry = set(0);
        const Corners s = corners_of(draw, id);
        const Pick at = pick_of(entry);
        TriangleTable triangles;
        const TriangleTable::Slopes slopes =
            triangles.set_up(draw, s, place, bool(draw.maps[MapKind::diffuse]));
        const Weights w =
            triangles.weights(place, bool(draw.maps[MapKind::diffuse]),
                              triangles.shares(place, entry, at, i, j), entry, at, i, j);
        if (draw.colors != nullptr) {
            RangeTable table;
            table.set_up<4>(s, draw.colors, 3);
            alpha = alpha * table(w, at);
        }
        if (draw.maps[MapKind::diffuse]) {
            PlaceTable table;
            const BoundMap& map = draw.maps[MapKind::diffuse];
            table.set_up(draw.places[map.place], s, slopes);
            alpha = alpha * sample_map(map, table(w, at)).a;
        }
    }
    return alpha >= set(draw.alpha_cutoff);
}

inline bool covers(const ShadeDraw& draw, std::int32_t x, std::int32_t y, std::uint32_t id) {
    return (bits_of(alpha_passes(draw, set(x), set(y), set(std::int32_t(id)))) & 1u) != 0;
}
