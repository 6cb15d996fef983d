// Visible points of one draw: their surface, their maps, their normals, the light on them, and
// colours at last.
// Included once per instruction set, inside the namespace that has its lanes.
//
// Points go through several short loops instead of one long one: the processor then works on
// several vectors at a time, where one vector's chain of operations alone would keep it waiting.
// Between the loops they lie in Points, few enough for the first-level cache.

inline constexpr std::size_t points_at_once = 128;
struct Points {
    enum : int {
        normal = 0,  // as it is interpolated, then unit
        tangent = 3,
        sign = 6,  // of the bitangent
        color = 7,
        position = 10,  // from the eye
        vertex_light = 13,
        light = 19,  // sums over the lights
        gloss = 22,
        eye = 25,  // towards it, and how long that is
        distance = 28,
        n_l,  // of one light, as HalfAngle has them
        sine2,
        cosine2,
        length2,
        exponent,
        weights,  // of the second and the third corner
        uv = weights + 2,
        texels = uv + 2,  // of each kind of map
        coordinates = texels + 3 * int(map_kinds),
        count = coordinates + 6 * int(map_kinds)
    };
    alignas(64) float v[count][points_at_once + vector_size];
    alignas(64) std::int32_t id[points_at_once + vector_size];
    std::size_t held = 0, first = 0;            // first: of the task's points
    Reads reads[points_at_once / vector_size];  // of the first maps on the same texels

    RAST_INLINE F get(int plane, std::size_t at) const { return load(v[plane] + at); }
    RAST_INLINE V3 get3(int plane, std::size_t at) const {
        return {load(v[plane] + at), load(v[plane + 1] + at), load(v[plane + 2] + at)};
    }
    RAST_INLINE void put(F value, int plane, std::size_t at) { store(value, v[plane] + at); }
    RAST_INLINE void put3(V3 value, int plane, std::size_t at) {
        put(value.x, plane, at);
        put(value.y, plane + 1, at);
        put(value.z, plane + 2, at);
    }
};

// What is asked of the points of a draw.
struct Wanted {
    bool normals = false, positions = false, colors = false, vertex_light = false, maps = false;
    bool weights = false;
    const float* uvs = nullptr;
};

// The surface of as many triangles as there are lanes.
struct SurfaceTable {
    TriangleTable triangles;
    alignas(64) std::int32_t id[vector_size];
    alignas(64) float sign[vector_size], face[3][vector_size];
    VectorTable normal, tangent, position;
    RangeTable color[3], light[6], uv[2];
    PlaceTable places[map_kinds];

    inline void set_up(const ShadeDraw& draw, const TilePlace& place, const Wanted& wanted, I ids) {
        const Corners s = corners_of(draw, ids);
        const TriangleTable::Slopes slopes = triangles.set_up(draw, s, place, wanted.maps);
        store(ids, id);
        if (wanted.normals) {
            if (draw.source == NormalSource::face) {
                const F zero = set(0.0f);
                const V3 n = face_normal(draw, s, {zero, zero, zero});
                store(n.x, face[0]);
                store(n.y, face[1]);
                store(n.z, face[2]);
            } else if (draw.source != NormalSource::object_map) {
                normal.set_up(s, draw.normals);
            }
            if (draw.source == NormalSource::tangent_map) {
                tangent.set_up<4>(s, draw.tangents);
                store(corner_value<4>(s, draw.tangents, 0, 3), sign);
            }
        }
        if (wanted.positions) position.set_up(s, draw.positions);
        for (int c = 0; wanted.colors && c < 3; ++c) color[c].set_up<4>(s, draw.colors, c);
        if (wanted.vertex_light) {
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
        for (int c = 0; wanted.uvs != nullptr && c < 2; ++c) uv[c].set_up<2>(s, wanted.uvs, c);
        for (int p = 0; wanted.maps && p < draw.place_count; ++p)
            places[p].set_up(draw.places[p], s, slopes);
    }

    // One vector's points, from point `n` on. `at`: their triangles, as Pick or OnePick.
    template <class At>
    RAST_INLINE void put(const ShadeDraw& draw, const TilePlace& place, const Wanted& wanted,
                         const TriangleTable::Shares& shares, I entry, At at, I i, I j,
                         Points& points, std::size_t n) const {
        const Weights w = triangles.weights(place, wanted.maps, shares, entry, at, i, j);
        store(pick(id, at), points.id + n);
        if (wanted.normals) {
            if (draw.source == NormalSource::face)
                points.put3({pick(face[0], at), pick(face[1], at), pick(face[2], at)},
                            Points::normal, n);
            else if (draw.source != NormalSource::object_map)
                points.put3(normal(w, at), Points::normal, n);
            if (draw.source == NormalSource::tangent_map) {
                points.put3(tangent(w, at), Points::tangent, n);
                points.put(pick(sign, at), Points::sign, n);
            }
        }
        if (wanted.positions)
            points.put3(point_from_eye(draw, position(w, at)), Points::position, n);
        for (int c = 0; wanted.colors && c < 3; ++c)
            points.put(color[c](w, at), Points::color + c, n);
        for (int c = 0; wanted.vertex_light && c < 6; ++c)
            points.put(light[c](w, at), Points::vertex_light + c, n);
        for (int c = 0; wanted.uvs != nullptr && c < 2; ++c)
            points.put(uv[c](w, at), Points::uv + c, n);
        if (wanted.weights) {
            points.put(w.b, Points::weights, n);
            points.put(w.c, Points::weights + 1, n);
        }
        for (int p = 0; wanted.maps && p < draw.place_count; ++p) {
            const Coordinates c = places[p](w, at);
            const F values[6] = {c.u, c.v, c.u_x, c.v_x, c.u_y, c.v_y};
            for (int k = 0; k < 6; ++k) points.put(values[k], Points::coordinates + 6 * p + k, n);
        }
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

inline void expand(const PixelRun* runs, std::size_t count, std::uint32_t* counts,
                   std::uint16_t* pixels) {
    for (std::size_t r = 0; r < count; ++r) {
        const PixelRun& run = runs[r];
        store_sequence(run.pixel, run.length, pixels + counts[run.number]);
        counts[run.number] += run.length;
    }
}

// Takes the runs' points in portions. `ask(points)` is called as soon as a portion's surface is
// known, `take(points)` only when the next one has been asked: what was asked for comes meanwhile.
template <class Task, class Ask, class Take>
RAST_INLINE void for_each_portion(const ShadeDraw& draw, const Task& task, const Wanted& wanted,
                                  const Ask& ask, const Take& take) {
    SurfaceTable table;
    constexpr std::size_t most_vectors = points_at_once / vector_size;
    TriangleTable::Shares shares[most_vectors];
    I entries[most_vectors];
    std::int32_t one[most_vectors];  // the one entry of all lanes, or −1
    Points both[2];
    Points *now = &both[0], *before = &both[1];
    std::size_t point = task.begin;
    now->held = before->held = 0;
    const auto finish = [&] {
        now->first = point - now->held;
        if (!wanted.maps) {  // nothing has to come
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
        table.set_up(draw, task.place, wanted, group.ids());
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
                    table.put(draw, task.place, wanted, shares[v], entries[v], OnePick{one[v]}, i,
                              j, *now, n);
                else
                    table.put(draw, task.place, wanted, shares[v], entries[v], pick_of(entries[v]),
                              i, j, *now, n);
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
            points.put3({t[i].r, t[i].g, t[i].b}, Points::texels + 3 * draw.used[first + i], n);
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
            points.put3({t[i].r, t[i].g, t[i].b}, Points::texels + 3 * draw.used[first + i], n);
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

// Normals as they are lit: world axes, unit, on the side that is seen.
inline void finish_normals(const ShadeDraw& draw, const ShadeFrame& frame, const TilePlace& place,
                           const std::uint16_t* pixels, Points& points) {
    // Lanes past the end have a triangle, if nothing else.
    store(set(points.id[points.held - 1]), points.id + points.held);
    for (std::size_t n = 0; n < points.held; n += vector_size) {
        const I id = load(points.id + n);
        const M there = iota() < set(std::int32_t(points.held - n));
        I x, y;
        load_places(place, pixels + n, x, y);
        V3 normal = points.get3(Points::normal, n);
        if (draw.source == NormalSource::face) {
            const M good = largest(normal) > set(0.0f);
            normal = on_seen_side(id, normal);
            if (!all(good | !there))
                normal = select(good, normal, mended_normal(draw, frame, id, x, y));
        } else {
            if (draw.source == NormalSource::tangent_map)
                normal = tangent_space_normal(draw, normal, points.get3(Points::tangent, n),
                                              points.get(Points::sign, n),
                                              texel_of(points, normal_map, n));
            if (draw.source == NormalSource::object_map)
                normal = object_space_normal(draw, texel_of(points, normal_map, n));
            normal = finished_normal(draw, frame, normal, there, id, x, y);
        }
        points.put3(normal, Points::normal, n);
    }
}

RAST_INLINE void roughness_at(const ShadeDraw& draw, const Points& points, std::size_t n,
                              F& metallic, F& roughness) {
    metallic = set(draw.metallic);
    roughness = set(draw.roughness);
    if (!draw.maps[metallic_roughness_map]) return;
    const V3 map = texel_of(points, metallic_roughness_map, n);
    metallic = metallic * map.z;
    roughness = roughness * map.y;
}

// How a point answers to light: base + diffuse · Σ light + specular · Σ highlights.
struct Reflection {
    V3 base;
    Lobe lobe;
};
RAST_INLINE Reflection reflection_at(const ShadeDraw& draw, const ShadeFrame& frame,
                                     const Points& points, std::size_t n) {
    V3 albedo = set3(draw.diffuse);
    if (draw.colors != nullptr) albedo = albedo * points.get3(Points::color, n);
    if (draw.maps[diffuse_map]) albedo = albedo * texel_of(points, diffuse_map, n);
    Reflection r{albedo, {albedo, set3(draw.specular), set(draw.shininess)}};
    const auto glow = [&] {
        V3 emissive = set3(draw.emissive);
        if (draw.maps[emissive_map]) emissive = emissive * texel_of(points, emissive_map, n);
        r.base = r.base + emissive;
    };
    const bool glows = draw.emissive[0] != 0 || draw.emissive[1] != 0 || draw.emissive[2] != 0;
    if (draw.unlit) {
        if (glows) glow();
        return r;
    }
    if (draw.metallic_roughness) {
        F metallic, roughness;
        roughness_at(draw, points, n, metallic, roughness);
        r.lobe = metallic_lobe(albedo, metallic, roughness);
    } else if (draw.maps[specular_map]) {
        r.lobe.specular = r.lobe.specular * texel_of(points, specular_map, n);
    }
    V3 ambient = set3(frame.ambient) * set3(draw.ambient);
    if (draw.maps[occlusion_map]) {
        const F one = set(1.0f), open = texel_of(points, occlusion_map, n).x;
        ambient = ambient * (one + set(draw.maps[occlusion_map].strength) * (open - one));
    }
    r.base = albedo * ambient;
    if (glows) glow();
    return r;
}

// Light takes several loops, so that few operations wait for a root or a quotient at a time. The
// eye's direction first,
inline void find_eye(const ShadeFrame& frame, const TilePlace& place, const std::uint16_t* pixels,
                     Points& points) {
    for (std::size_t n = 0; n < points.held; n += vector_size) {
        I i, j;
        load_pixels(pixels + n, i, j);
        // Exact: places are multiples of 1/256 within 2^15 pixels.
        const V3 v = towards_eye(frame, to_float(i) + set(float(place.x) / float(subpixels)),
                                 to_float(j) + set(float(place.y) / float(subpixels)));
        points.put3(v, Points::eye, n);
        points.put(sqrt(dot(v, v)), Points::distance, n);
    }
}
// then for each light its angles,
inline void add_light(const ShadeFrame& frame, const ShadeLight& light, bool first,
                      Points& points) {
    const F none = set(0.0f);
    const V3 zero{none, none, none};
    for (std::size_t n = 0; n < points.held; n += vector_size) {
        const V3 normal = points.get3(Points::normal, n);
        V3 position = zero;
        if (frame.needs_position) position = points.get3(Points::position, n);
        const Incoming in = incoming(light, normal, position);
        const HalfAngle half =
            half_angle(normal, points.get3(Points::eye, n), points.get(Points::distance, n), in.l);
        const V3 sent = in.color * in.n_l;
        points.put3(first ? sent : points.get3(Points::light, n) + sent, Points::light, n);
        points.put(in.n_l, Points::n_l, n);
        points.put(half.sine2, Points::sine2, n);
        points.put(half.cosine2, Points::cosine2, n);
        points.put(half.length2, Points::length2, n);
    }
}
RAST_INLINE F shininess_at(const ShadeDraw& draw, const Points& points, std::size_t n) {
    if (!draw.metallic_roughness) return set(draw.shininess);
    const F none = set(0.0f);
    F metallic, roughness;
    roughness_at(draw, points, n, metallic, roughness);
    return metallic_lobe({none, none, none}, metallic, roughness).shininess;
}
// the logarithm of its highlight,
inline void find_exponents(const ShadeDraw& draw, Points& points) {
    for (std::size_t n = 0; n < points.held; n += vector_size) {
        if (!any(points.get(Points::n_l, n) > set(0.0f))) continue;
        points.put(specular_exponent(points.get(Points::sine2, n), points.get(Points::cosine2, n),
                                     points.get(Points::length2, n), shininess_at(draw, points, n)),
                   Points::exponent, n);
    }
}
// and the sum of highlights up to this light's.
RAST_INLINE V3 gloss_with(const ShadeDraw& draw, const ShadeLight& light, const Points& points,
                          bool first, std::size_t n) {
    const F none = set(0.0f);
    V3 sum{none, none, none};
    if (!first) sum = points.get3(Points::gloss, n);
    const F n_l = points.get(Points::n_l, n);
    if (!any(n_l > none)) return sum;  // adds nothing, to the bit
    const F strength = highlight(n_l, points.get(Points::cosine2, n),
                                 points.get(Points::exponent, n), shininess_at(draw, points, n));
    V3 color = set3(light.color);
    if (light.kind != prep::LightKind::directional)
        color =
            incoming(light, points.get3(Points::normal, n), points.get3(Points::position, n)).color;
    return first ? color * strength : sum + color * strength;
}

// Bytes of one channel; NaN is 0.
RAST_INLINE I byte_of(F v) {
    const F clipped = min(max(v, set(0.0f)), set(1.0f));
    return to_int(clipped * set(255.0f) + set(0.5f));
}
RAST_INLINE I packed_color(V3 c) {
    return (byte_of(c.x) | shift_left<8>(byte_of(c.y))) |
           (shift_left<16>(byte_of(c.z)) | set(std::int32_t(0xff000000u)));
}

RAST_INLINE void write_bytes(V3 color, const std::uint16_t* pixels, std::size_t count,
                             const ShadeTask& task) {
    const I packed = packed_color(color);
    if (count >= vector_size) {
        const I at = load(pixels), row = shift_right<6>(at);
        scatter(packed, task.bytes, at + row * set(std::int32_t(task.stride) - tile_size));
        return;
    }
    std::uint32_t each[vector_size];
    store(packed, each);
    for (std::size_t k = 0; k < count; ++k) {
        const std::size_t p = pixels[k];
        task.bytes[p / tile_size * task.stride + p % tile_size] = each[k];
    }
}

inline void shade(const ShadeDraw& draw, const ShadeFrame& frame, const ShadeTask& task) {
    const bool lit = !draw.unlit && draw.vertex_light == nullptr && frame.light_count > 0;
    Wanted wanted;
    wanted.normals = lit;
    wanted.positions = lit && frame.needs_position;
    wanted.colors = draw.colors != nullptr;
    wanted.vertex_light = !draw.unlit && draw.vertex_light != nullptr;
    wanted.maps = draw.used_count > 0;
    const auto ask = [&](Points& points) {
        if (wanted.maps) ask_for(draw, map_group(draw, 0), points);
    };
    for_each_portion(draw, task, wanted, ask, [&](Points& points) {
        const std::size_t first = points.first;
        const std::uint16_t* const pixels = task.pixels + first;
        if (wanted.maps) read_maps(draw, points);
        if (lit) {
            finish_normals(draw, frame, task.place, pixels, points);
            find_eye(frame, task.place, pixels, points);
        }
        for (std::size_t l = 0; lit && l < frame.light_count; ++l) {
            add_light(frame, frame.lights[l], l == 0, points);
            find_exponents(draw, points);
            if (l + 1 == frame.light_count) break;  // the last one's highlights wait for the end
            for (std::size_t n = 0; n < points.held; n += vector_size)
                points.put3(gloss_with(draw, frame.lights[l], points, l == 0, n), Points::gloss, n);
        }
        for (std::size_t n = 0; n < points.held; n += vector_size) {
            const Reflection r = reflection_at(draw, frame, points, n);
            V3 color = r.base;
            if (lit)
                color = (color + r.lobe.diffuse * points.get3(Points::light, n)) +
                        r.lobe.specular * gloss_with(draw, frame.lights[frame.light_count - 1],
                                                     points, frame.light_count == 1, n);
            if (wanted.vertex_light)
                color = (color + r.lobe.diffuse * points.get3(Points::vertex_light, n)) +
                        r.lobe.specular * points.get3(Points::vertex_light + 3, n);
            if (task.bytes != nullptr) {
                write_bytes(color, pixels + n, points.held - n, task);
                continue;
            }
            store(color.x, task.out[0] + first + n);
            store(color.y, task.out[1] + first + n);
            store(color.z, task.out[2] + first + n);
        }
    });
}

inline void pack(const float* red, const float* green, const float* blue, std::size_t count,
                 std::uint32_t* out) {
    if (count == 1) {
        std::uint32_t each[vector_size];
        store(packed_color({set(*red), set(*green), set(*blue)}), each);
        *out = each[0];
        return;
    }
    for (std::size_t n = 0; n < count; n += vector_size)
        store(packed_color({load(red + n), load(green + n), load(blue + n)}), out + n);
}

inline void attributes(const ShadeDraw& draw, const ShadeFrame& frame, const AttributeTask& task) {
    Wanted wanted;
    wanted.normals = task.normal[0] != nullptr;
    wanted.positions = task.position[0] != nullptr;
    wanted.weights = task.barycentric[0] != nullptr;
    wanted.uvs = task.uv[0] != nullptr ? task.uvs : nullptr;
    const bool mapped =
        wanted.normals && draw.maps[normal_map] &&
        (draw.source == NormalSource::tangent_map || draw.source == NormalSource::object_map);
    wanted.maps = mapped;
    // The normal map alone.
    ShadeDraw with_normals;
    if (mapped) {
        with_normals = draw;
        with_normals.used[0] = normal_map;
        with_normals.used_count = 1;
    }
    const auto ask = [&](Points& points) {
        if (mapped) ask_for(with_normals, {0, 1}, points);
    };
    for_each_portion(draw, task, wanted, ask, [&](Points& points) {
        const std::size_t first = points.first;
        if (mapped) read_maps(with_normals, points);
        if (wanted.normals) finish_normals(draw, frame, task.place, task.pixels + first, points);
        for (std::size_t n = 0; n < points.held; n += vector_size) {
            const auto write = [&](float* const out[], int c, F value) {
                store(value, out[c] + first + n);
            };
            for (int c = 0; wanted.normals && c < 3; ++c)
                write(task.normal, c, points.get(Points::normal + c, n));
            for (int c = 0; wanted.positions && c < 3; ++c)
                write(task.position, c, points.get(Points::position + c, n));
            for (int c = 0; task.uv[0] != nullptr && c < 2; ++c)
                write(task.uv, c,
                      wanted.uvs != nullptr ? points.get(Points::uv + c, n) : set(0.0f));
            if (!wanted.weights) continue;
            const F b = points.get(Points::weights, n), c = points.get(Points::weights + 1, n);
            write(task.barycentric, 0, max((set(1.0f) - b) - c, set(0.0f)));
            write(task.barycentric, 1, b);
            write(task.barycentric, 2, c);
        }
    });
}

// Points of one triangle, whole pixels from the first lane's.
inline M alpha_passes(const ShadeDraw& draw, I px, I py, I id) {
    F alpha = set(draw.diffuse[3]);
    if (draw.colors != nullptr || draw.maps[diffuse_map]) {
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
            triangles.set_up(draw, s, place, bool(draw.maps[diffuse_map]));
        const Weights w =
            triangles.weights(place, bool(draw.maps[diffuse_map]),
                              triangles.shares(place, entry, at, i, j), entry, at, i, j);
        if (draw.colors != nullptr) {
            RangeTable table;
            table.set_up<4>(s, draw.colors, 3);
            alpha = alpha * table(w, at);
        }
        if (draw.maps[diffuse_map]) {
            PlaceTable table;
            const BoundMap& map = draw.maps[diffuse_map];
            table.set_up(draw.places[map.place], s, slopes);
            alpha = alpha * sample_map(map, table(w, at)).a;
        }
    }
    return alpha >= set(draw.alpha_cutoff);
}

inline bool covers(const ShadeDraw& draw, std::int32_t x, std::int32_t y, std::uint32_t id) {
    return (bits_of(alpha_passes(draw, set(x), set(y), set(std::int32_t(id)))) & 1u) != 0;
}
