// From runs of triangles to points: what the vertices' values come to at each.
// Included once per instruction set, inside the namespace that has its lanes.

// The surface of as many triangles as there are lanes.
struct SurfaceTable {
    TriangleTable triangles;
    alignas(64) std::int32_t id[vector_size];
    alignas(64) float sign[vector_size], face[3][vector_size];
    VectorTable normal, tangent, position;
    RangeTable color[3], light[6], uv[2];
    GradientTable uv_gradients;
    PlaceTable places[drawn_maps];

    inline void set_up(const ShadeDraw& draw, const TilePlace& place, const SurfacePlanes& asked,
                       bool mapped, const float* uvs, I ids) {
        const Corners s = corners_of(draw, ids);
        const TriangleTable::Slopes slopes = triangles.set_up(draw, s, place, mapped);
        if (asked.id != nullptr) store(ids, id);
        if (asked.normal != nullptr) {
            if (draw.source == NormalSource::face) {
                const F zero = set(0.0f);
                const V3 n = face_normal(draw, s, {zero, zero, zero});
                store(n.x, face[0]);
                store(n.y, face[1]);
                store(n.z, face[2]);
            } else {
                normal.set_up(s, draw.normals);
            }
            if (asked.tangent != nullptr) {
                tangent.set_up<4>(s, draw.tangents);
                store(corner_value<4>(s, draw.tangents, 0, 3), sign);
            }
        }
        if (asked.rare) set_up_rare(draw, s, asked, uvs, ids);
        for (int p = 0; mapped && p < draw.place_count; ++p)
            if (asked.coordinates[p] != nullptr) places[p].set_up(draw.places[p], s, slopes);
    }

    // One vector's points, from point `n` on. `at`: their triangles, as Pick or OnePick.
    template <class At>
    RAST_INLINE void put(const ShadeDraw& draw, const TilePlace& place, bool mapped,
                         const TriangleTable::Shares& shares, I entry, At at, I i, I j,
                         const SurfacePlanes& to, std::size_t n) const {
        const Weights w = triangles.weights(place, mapped, shares, entry, at, i, j);
        if (to.id != nullptr) store(from_bits(pick(id, at)), to.id + n);
        if (to.normal != nullptr) {
            if (draw.source == NormalSource::face)
                put3({pick(face[0], at), pick(face[1], at), pick(face[2], at)}, to.normal, n);
            else
                put3(normal(w, at), to.normal, n);
            if (to.tangent != nullptr) {
                put3(tangent(w, at), to.tangent, n);
                put_plane(pick(sign, at), to.tangent, 3, n);
            }
        }
        if (to.rare) put_rare(draw, w, at, to, n);
        for (int p = 0; mapped && p < draw.place_count; ++p) {
            float* const planes = to.coordinates[p];
            if (planes == nullptr) continue;
            const Coordinates c = places[p](w, at);
            const F values[6] = {c.u, c.v, c.u_x, c.v_x, c.u_y, c.v_y};
            for (int k = 0; k < 6; ++k) put_plane(values[k], planes, k, n);
        }
    }

  private:
    inline void set_up_rare(const ShadeDraw& draw, const Corners& s, const SurfacePlanes& asked,
                            const float* uvs, I ids) {
        if (asked.position != nullptr) position.set_up(s, draw.positions);
        for (int c = 0; asked.color != nullptr && c < 3; ++c) color[c].set_up<4>(s, draw.colors, c);
        if (asked.vertex_light != nullptr) {
            // The sums on the side that is seen.
            const I from = select(ids < set(0), set(6), set(0));
            for (int c = 0; c < 6; ++c) {
                F values[3];
                for (int k = 0; k < 3; ++k)
                    values[k] = gather(draw.vertex_light + c,
                                       times<int(vertex_light_floats)>(s.vertex[k]) + from);
                light[c].set_up(values[0], values[1], values[2]);
            }
        }
        for (int c = 0; asked.uv != nullptr && c < 2; ++c) uv[c].set_up<2>(s, uvs, c);
        if (asked.uv_gradients != nullptr)
            uv_gradients.set_up(s, draw.positions, draw.places[draw.maps[MapKind::bump].place]);
    }
    template <class At>
    RAST_INLINE void put_rare(const ShadeDraw& draw, const Weights& w, At at,
                              const SurfacePlanes& to, std::size_t n) const {
        if (to.position != nullptr) put3(point_from_eye(draw, position(w, at)), to.position, n);
        for (int c = 0; to.color != nullptr && c < 3; ++c)
            put_plane(color[c](w, at), to.color, c, n);
        for (int c = 0; to.vertex_light != nullptr && c < 6; ++c)
            put_plane(light[c](w, at), to.vertex_light, c, n);
        for (int c = 0; to.uv != nullptr && c < 2; ++c) put_plane(uv[c](w, at), to.uv, c, n);
        for (int k = 0; to.uv_gradients != nullptr && k < 6; ++k)
            put_plane(uv_gradients(k, at), to.uv_gradients, k, n);
        if (to.weights == nullptr) return;
        put_plane(w.b, to.weights, 0, n);
        put_plane(w.c, to.weights, 1, n);
    }
};

// Pixels of the tile.
RAST_INLINE void load_pixels(const std::uint16_t* pixels, I& i, I& j) {
    static_assert(tile_size == 64);
    const I at = load(pixels);
    i = at & set(63);
    j = shift_right<6>(at);
}
RAST_INLINE void load_places(const TilePlace& place, const std::uint16_t* pixels, I& x, I& y) {
    load_pixels(pixels, x, y);
    x = shift_left<subpixel_bits>(x) + set(place.x);
    y = shift_left<subpixel_bits>(y) + set(place.y);
}

// Takes the runs' points in portions. Where there are maps, `ask(points)` is called as soon as a
// portion's surface is known, `take(points)` only when the next one has been asked: what was asked
// for comes meanwhile. `uvs`: those that the list reads as such.
template <class Task, class Ask, class Take>
RAST_INLINE void for_each_portion(const ShadeDraw& draw, const StageList& list, const Task& task,
                                  const float* uvs, const Ask& ask, const Take& take) {
    const bool mapped = list.map_count > 0;
    SurfaceTable table;
    constexpr std::size_t most_vectors = points_at_once / vector_size;
    TriangleTable::Shares shares[most_vectors];
    I entries[most_vectors];
    std::int32_t one[most_vectors];  // the one entry of all lanes, or −1
    Points both[2];
    Points *now = &both[0], *before = &both[1];
    std::size_t point = task.begin;
    now->begin(list, draw.source);
    before->held = 0;
    if (mapped) before->begin(list, draw.source);
    const auto finish = [&] {
        now->first = point - now->held;
        if (!mapped) {  // nothing has to come
            take(*now);
            now->held = 0;
            return;
        }
        ask(*now);
        if (before->held > 0) take(*before);
        std::swap(now, before);
        now->held = 0;
    };
    for (std::size_t r = 0; r < task.run_count;) {
        const RunGroup group = next_group(task.runs + r, task.run_count - r);
        table.set_up(draw, task.place, now->surface, mapped, uvs, group.ids());
        std::size_t run = 0;
        while (point < group.end()) {
            // As many vectors as the group and the portion have, in two loops: else all
            // of a vector's chain of operations would wait for its quotient.
            const std::size_t left = group.end() - point, room = points_at_once - now->held,
                              vectors =
                                  ((left < room ? left : room) + vector_size - 1) / vector_size;
            for (std::size_t v = 0; v < vectors; ++v) {
                const std::size_t at = point + v * vector_size;
                I i, j;
                load_pixels(task.pixels + at, i, j);
                one[v] = group.is_one(at, run) ? std::int32_t(run) : -1;
                entries[v] = group.entries(at, run);
                if (one[v] >= 0)
                    shares[v] =
                        table.triangles.shares(task.place, entries[v], OnePick{one[v]}, i, j);
                else
                    shares[v] =
                        table.triangles.shares(task.place, entries[v], pick_of(entries[v]), i, j);
            }
            for (std::size_t v = 0; v < vectors; ++v) {
                const std::size_t n = now->held + v * vector_size;
                I i, j;
                load_pixels(task.pixels + point + v * vector_size, i, j);
                if (one[v] >= 0)
                    table.put(draw, task.place, mapped, shares[v], entries[v], OnePick{one[v]}, i,
                              j, now->surface, n);
                else
                    table.put(draw, task.place, mapped, shares[v], entries[v], pick_of(entries[v]),
                              i, j, now->surface, n);
            }
            const std::size_t n = vectors * vector_size < left ? vectors * vector_size : left;
            point += n;
            now->held += n;
            if (now->held < points_at_once) continue;
            // What the last vector has beyond the portion's end comes again.
            const std::size_t more = now->held - points_at_once;
            if (more > 0) {
                now->held -= more;
                point -= more;
                run = group.run_of(point);
            }
            finish();
        }
        r += group.count;
    }
    if (now->held > 0) finish();
    if (before->held > 0) take(*before);
}
