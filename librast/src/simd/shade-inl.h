// Normals, materials and light at visible points.
// Included once per instruction set, inside the namespace that has its lanes.

RAST_INLINE M alpha_passes(const ShadeDraw& draw, I px, I py, I id) {
    const MixedSurface s = surface_at(draw, triangle_of(draw, id), px, py, bool(draw.diffuse_map));
    F alpha = set(draw.diffuse[3]);
    if (draw.colors != nullptr) {
        alpha = alpha * attribute_within<4>(s, draw.colors, 3);
    }
    if (draw.diffuse_map) alpha = alpha * sample_map(draw.diffuse_map, s).a;
    return alpha >= set(draw.alpha_cutoff);
}

inline bool covers(const ShadeDraw& draw, std::int32_t x, std::int32_t y, std::uint32_t id) {
    return (bits_of(alpha_passes(draw, set(x), set(y), set(std::int32_t(id)))) & 1u) != 0;
}

RAST_INLINE V3 transformed_normal(const ShadeDraw& draw, V3 n) {
    const float* m = draw.normal_matrix;
    return {(set(m[0]) * n.x + set(m[1]) * n.y) + set(m[2]) * n.z,
            (set(m[3]) * n.x + set(m[4]) * n.y) + set(m[5]) * n.z,
            (set(m[6]) * n.x + set(m[7]) * n.y) + set(m[8]) * n.z};
}

RAST_INLINE F largest(V3 v) {
    return max(max(abs(v.x), abs(v.y)), abs(v.z));
}

// Whether a vector of this largest component has a direction.
RAST_INLINE M is_length(F size) {
    return (size > set(0.0f)) & (size < set(8.0e37f));
}

// Unit length whatever the length was; lanes without a direction (zero, NaN) get `otherwise`.
RAST_INLINE V3 unit_or(V3 v, V3 otherwise) {
    const F size = largest(v);
    const M good = is_length(size);
    // By a power of two, to order one: squares stay in float's range and nothing is rounded.
    const I exponent = bits(select(good, size, set(1.0f))) & set(0x7f800000);
    const V3 scaled = v * from_bits(max(set(0x7f000000) - exponent, set(0x00800000)));
    const F inverse = set(1.0f) / sqrt(select(good, dot(scaled, scaled), set(1.0f)));
    return select(good, scaled * inverse, otherwise);
}

// Not normalised; of a length near one.
RAST_INLINE V3 towards_eye(const ShadeFrame& frame, I x, I y) {
    const F to_pixels = set(1.0f / float(subpixels));
    return (set3(frame.to_eye[0]) + set3(frame.to_eye[1]) * (to_float(x) * to_pixels)) +
           set3(frame.to_eye[2]) * (to_float(y) * to_pixels);
}
RAST_INLINE V3 direction_to_eye(const ShadeFrame& frame, I x, I y) {
    return unit_or(towards_eye(frame, x, y), set3(frame.to_eye[0]));
}

// The triangle's own normal on its front side, world axes.
template <class S>
RAST_INLINE V3 face_normal(const ShadeDraw& draw, const S& s, V3 otherwise) {
    V3 p[3];
    for (int k = 0; k < 3; ++k)
        p[k] = {corner_value<3>(s, draw.positions, k, 0), corner_value<3>(s, draw.positions, k, 1),
                corner_value<3>(s, draw.positions, k, 2)};
    const V3 zero{set(0.0f), set(0.0f), set(0.0f)};
    // Edges brought to order one: products of tiny and huge ones would leave float's range.
    const V3 a = unit_or(p[1] - p[0], zero), b = unit_or(p[2] - p[0], zero);
    return unit_or(transformed_normal(draw, cross(a, b)), otherwise);
}

// Unit, on the side that is seen.
template <class S>
RAST_INLINE V3 normal_at(const ShadeDraw& draw, const S& s, M back, const ShadeFrame& frame, I x,
                         I y) {
    const auto seen = [&](V3 n) { return select(back, -n, n); };
    if (draw.source == NormalSource::face)
        return seen(face_normal(draw, s, seen(direction_to_eye(frame, x, y))));
    V3 n;
    if (draw.source == NormalSource::object_map) {
        const Texel map = sample_map(draw.normal_map, s);
        const F two = set(2.0f), one = set(1.0f);
        n = {map.r * two - one, map.g * two - one, map.b * two - one};
        if (draw.flip_green) n.y = -n.y;
    } else {
        n = attribute3(s, draw.normals);
        if (draw.source == NormalSource::tangent_map) {
            // Interpolated vectors stay as long as they come out: the map was baked so
            // (MikkTSpace).
            const V3 t = attribute3<4>(s, draw.tangents);
            const V3 b = cross(n, t) * corner_value<4>(s, draw.tangents, 0, 3);
            const Texel map = sample_map(draw.normal_map, s);
            const F two = set(2.0f), one = set(1.0f);
            const float strength = draw.normal_map.strength;
            const F mx = (map.r * two - one) * set(strength);
            const F my = (map.g * two - one) * set(draw.flip_green ? -strength : strength);
            const F mz = map.b * two - one;
            n = (t * mx + b * my) + n * mz;
        }
    }
    n = transformed_normal(draw, n);
    // Opposite normals pass through zero: the geometric one takes over.
    const M good = is_length(largest(n));
    V3 otherwise = n;
    if (!all(good)) otherwise = face_normal(draw, s, seen(direction_to_eye(frame, x, y)));
    return seen(unit_or(n, otherwise));
}

struct Light {
    V3 diffuse, specular;
};

// What one light sends to a point with unit normal n and unit direction v to the eye.
struct Incoming {
    V3 color, l;
    F n_l;  // 0 where it is not lit
};
RAST_INLINE Incoming incoming(const ShadeLight& light, V3 n, V3 position) {
    const F zero = set(0.0f), one = set(1.0f);
    Incoming in{set3(light.color), set3(light.to_light), zero};
    if (light.kind != prep::LightKind::directional) {
        const V3 d = set3(light.position) - position;
        const F r2 = dot(d, d);
        // A light exactly on the surface would be infinitely bright: it adds nothing.
        const M apart = r2 > set(1.0e-30f);
        const F kept = select(apart, r2, one);
        const V3 towards = d * (one / sqrt(kept));
        F strength = select(apart, one / kept, zero);
        if (light.inv_range > 0) {
            const F ratio2 = kept * set(light.inv_range * light.inv_range);
            strength = strength * max(one - ratio2 * ratio2, zero);
        }
        if (light.kind == prep::LightKind::spot) {
            const F cosine = dot(towards, in.l);
            const F cone =
                min(max(cosine * set(light.cone_scale) + set(light.cone_offset), zero), one);
            strength = strength * (cone * cone);
        }
        in.color = in.color * strength;
        in.l = towards;
    }
    const F n_l = dot(n, in.l);
    in.n_l = select(n_l > zero, n_l, zero);
    return in;
}

// Squared sine and cosine of the angle between the normal and the half vector; `behind`: it points
// away from the surface.
struct HalfAngle {
    F sine2, cosine2;
    M behind;
};
RAST_INLINE HalfAngle half_angle(V3 n, V3 v, V3 l) {
    const V3 h = l * sqrt(dot(v, v)) + v;  // v of any length saves dividing by it
    const F h2 = max(dot(h, h), set(1.0e-30f));
    const V3 across = cross(n, h);
    const F n_h = dot(n, h), one = set(1.0f), inverse = one / h2;
    return {min(dot(across, across) * inverse, one), (n_h * n_h) * inverse, !(n_h > set(0.0f))};
}

// Of the highlight. `n_l` and `behind` as above; 0^0 is 1.
RAST_INLINE F highlight(F n_l, F sine2, F cosine2, M behind, F shininess) {
    const F zero = set(0.0f);
    const F otherwise = select(shininess == zero, set(1.0f), zero);
    const F power = specular_power(sine2, cosine2, shininess);
    return select(n_l > zero, select(behind, otherwise, power), zero);
}

// Sums over the lights.
inline Light light_at(const ShadeFrame& frame, V3 n, V3 v, V3 position, F shininess) {
    const F zero = set(0.0f);
    Light sum{{zero, zero, zero}, {zero, zero, zero}};
    for (std::size_t i = 0; i < frame.light_count; ++i) {
        const Incoming in = incoming(frame.lights[i], n, position);
        const HalfAngle half = half_angle(n, v, in.l);
        sum.diffuse = sum.diffuse + in.color * in.n_l;
        sum.specular = sum.specular + in.color * highlight(in.n_l, half.sine2, half.cosine2,
                                                           half.behind, shininess);
    }
    return sum;
}

// How the surface reflects: Blinn-Phong as the material says, or derived from metallic-roughness as
// prep::blinn_phong() does.
struct Lobe {
    V3 diffuse, specular;
    F shininess;
};
template <class S>
RAST_INLINE Lobe lobe_at(const ShadeDraw& draw, const S& s, V3 albedo) {
    Lobe lobe{albedo, set3(draw.specular), set(draw.shininess)};
    if (draw.metallic_roughness) {
        F metallic = set(draw.metallic), roughness = set(draw.roughness);
        if (draw.metallic_roughness_map) {
            const Texel map = sample_map(draw.metallic_roughness_map, s);
            metallic = metallic * map.b;
            roughness = roughness * map.g;
        }
        const F dielectric = set(0.04f), one = set(1.0f), two = set(2.0f), eight = set(8.0f);
        const F alpha = max(roughness * roughness, set(0.02f));
        lobe.shininess = max(two / (alpha * alpha) - two, set(0.0f));
        const V3 base{dielectric, dielectric, dielectric};
        lobe.specular = (base + (albedo - base) * metallic) * ((lobe.shininess + eight) / eight);
        lobe.diffuse = albedo * (one - metallic);
    } else if (draw.specular_map) {
        const Texel map = sample_map(draw.specular_map, s);
        lobe.specular = lobe.specular * V3{map.r, map.g, map.b};
    }
    return lobe;
}

// Gouraud: the light sums of the corners, on the side that is seen.
template <class S>
RAST_INLINE Light interpolated_light(const ShadeDraw& draw, const S& s, M back) {
    const auto value = [&](int c) {
        return select(back, attribute_within<int(vertex_light_floats)>(s, draw.vertex_light, c + 6),
                      attribute_within<int(vertex_light_floats)>(s, draw.vertex_light, c));
    };
    return {{value(0), value(1), value(2)}, {value(3), value(4), value(5)}};
}

RAST_INLINE V3 point_from_eye(const ShadeDraw& draw, V3 p) {
    const auto row = [&](int r) {
        const float* m = draw.from_eye[r];
        return ((set(m[0]) * p.x + set(m[1]) * p.y) + set(m[2]) * p.z) + set(m[3]);
    };
    return {row(0), row(1), row(2)};
}

// How a point answers to light: base + diffuse · Σ light + specular · Σ highlights.
struct Reflection {
    V3 base;
    Lobe lobe;
};
template <class S>
RAST_INLINE Reflection reflection_at(const ShadeDraw& draw, const ShadeFrame& frame, const S& s) {
    V3 albedo = set3(draw.diffuse);
    if (draw.colors != nullptr)
        albedo = albedo * V3{attribute_within<4>(s, draw.colors, 0),
                             attribute_within<4>(s, draw.colors, 1),
                             attribute_within<4>(s, draw.colors, 2)};
    if (draw.diffuse_map) {
        const Texel map = sample_map(draw.diffuse_map, s);
        albedo = albedo * V3{map.r, map.g, map.b};
    }
    V3 emissive = set3(draw.emissive);
    if (draw.emissive_map) {
        const Texel map = sample_map(draw.emissive_map, s);
        emissive = emissive * V3{map.r, map.g, map.b};
    }
    if (draw.unlit) {
        const V3 none = set3(frame.ambient) * set(0.0f);
        return {albedo + emissive, {none, none, set(0.0f)}};
    }
    const Lobe lobe = lobe_at(draw, s, albedo);
    V3 ambient = set3(frame.ambient) * set3(draw.ambient);
    if (draw.occlusion_map) {
        const F one = set(1.0f), open = sample_map(draw.occlusion_map, s).r;
        ambient = ambient * (one + set(draw.occlusion_map.strength) * (open - one));
    }
    return {albedo * ambient + emissive, lobe};
}

// A vector of points, the last one again where there are fewer.
RAST_INLINE void load_points(const TilePlace& place, const std::uint16_t* pixels,
                             const std::uint32_t* ids, std::size_t count, I& x, I& y, I& id) {
    std::uint16_t few_pixels[lane_count];
    std::uint32_t few_ids[lane_count];
    if (count < std::size_t(lane_count)) {
        for (std::size_t k = 0; k < std::size_t(lane_count); ++k) {
            const std::size_t from = k < count ? k : count - 1;
            few_pixels[k] = pixels[from];
            few_ids[k] = ids[from];
        }
        pixels = few_pixels;
        ids = few_ids;
    }
    static_assert(tile_size == 64);
    const I at = load(pixels);
    x = shift_left<subpixel_bits>(at & set(63)) + set(place.x);
    y = shift_left<subpixel_bits>(shift_right<6>(at)) + set(place.y);
    id = load(ids);
}

RAST_INLINE void store3(V3 v, float* const out[3], std::size_t at) {
    store(v.x, out[0] + at);
    store(v.y, out[1] + at);
    store(v.z, out[2] + at);
}

// Points go through three short loops instead of one long one: the processor then works on several
// vectors at a time, where one vector's chain of operations alone would keep it waiting. Between
// the loops they lie here, few enough for the first-level cache.
inline constexpr std::size_t points_at_once = 512;
struct ShadePlanes {
    // Base, diffuse, specular, normal, position, shininess; sums of light; one light's n · l, sine
    // and cosine.
    enum : int {
        base = 0,
        diffuse = 3,
        specular = 6,
        normal = 9,
        position = 12,
        shininess = 15,
        light = 16,
        gloss = 19,
        n_l = 22,
        sine2,
        cosine2,
        count
    };
    alignas(64) float v[count][points_at_once + lane_count];

    V3 load3(int plane, std::size_t at) const {
        return {load(v[plane] + at), load(v[plane + 1] + at), load(v[plane + 2] + at)};
    }
    void store3(V3 value, int plane, std::size_t at) {
        store(value.x, v[plane] + at);
        store(value.y, v[plane + 1] + at);
        store(value.z, v[plane + 2] + at);
    }
};

// First loop: attributes, textures and normals of a vector of points.
template <class S>
RAST_INLINE void store_surface(const ShadeDraw& draw, const ShadeFrame& frame, const S& s, M back,
                               I x, I y, std::size_t at, ShadePlanes& planes) {
    const Reflection r = reflection_at(draw, frame, s);
    if (draw.unlit || draw.vertex_light != nullptr) {
        V3 color = r.base;
        if (!draw.unlit) {
            const Light light = interpolated_light(draw, s, back);
            color = (color + r.lobe.diffuse * light.diffuse) + r.lobe.specular * light.specular;
        }
        planes.store3(color, ShadePlanes::base, at);
        return;
    }
    planes.store3(r.base, ShadePlanes::base, at);
    planes.store3(r.lobe.diffuse, ShadePlanes::diffuse, at);
    planes.store3(r.lobe.specular, ShadePlanes::specular, at);
    store(r.lobe.shininess, planes.v[ShadePlanes::shininess] + at);
    planes.store3(normal_at(draw, s, back, frame, x, y), ShadePlanes::normal, at);
    if (frame.needs_position)
        planes.store3(point_from_eye(draw, attribute3(s, draw.positions)), ShadePlanes::position,
                      at);
}

// Points that are too few for a vector of their own triangle, gathered until they fill one.
struct LeftOver {
    std::uint16_t pixels[lane_count];
    std::uint32_t ids[lane_count];
    std::size_t at[lane_count];
    std::size_t count = 0;
};
inline void store_left_over(const ShadeDraw& draw, const ShadeFrame& frame, const TilePlace& place,
                            LeftOver& left, ShadePlanes& planes) {
    if (left.count == 0) return;
    I x, y, id;
    load_points(place, left.pixels, left.ids, left.count, x, y, id);
    const MixedSurface s = surface_at(draw, triangle_of(draw, id), x, y, draw.textured());
    store_surface(draw, frame, s, id < set(0), x, y, points_at_once, planes);
    const bool colors_only = draw.unlit || draw.vertex_light != nullptr;
    const int last = colors_only ? 3 : int(ShadePlanes::light);
    for (int plane = 0; plane < last; ++plane)
        for (std::size_t k = 0; k < left.count; ++k)
            planes.v[plane][left.at[k]] = planes.v[plane][points_at_once + k];
    left.count = 0;
}

inline void store_surfaces(const ShadeDraw& draw, const ShadeFrame& frame, const ShadeTask& task,
                           ShadePlanes& planes) {
    // Below three quarters of a vector, lanes that do nothing cost more than gathering.
    constexpr std::size_t lanes = std::size_t(lane_count), few = lanes * 3 / 4;
    const bool derivatives = draw.textured();
    LeftOver left;
    for (std::size_t n = 0; n < task.count;) {
        const std::uint32_t id = task.ids[n];
        std::size_t end = n + 1;
        while (end < task.count && task.ids[end] == id) ++end;
        UniformTriangle triangle;
        if (end - n >= few && uniform_triangle(draw, id, triangle)) {
            const M back = set(std::int32_t(id)) < set(0);
            // What the last vector writes past the triangle's end is written again later.
            for (; end > n && end - n >= few; n += lanes) {
                I x, y, unused;
                load_points(task.place, task.pixels + n, task.ids + n, end - n, x, y, unused);
                const UniformSurface s = surface_at(triangle, x, y, derivatives);
                store_surface(draw, frame, s, back, x, y, n, planes);
            }
        }
        for (; n < end; ++n) {
            left.pixels[left.count] = task.pixels[n];
            left.ids[left.count] = task.ids[n];
            left.at[left.count++] = n;
            if (left.count == lanes) store_left_over(draw, frame, task.place, left, planes);
        }
        n = end;
    }
    store_left_over(draw, frame, task.place, left, planes);
}

// Second and third loop, for each light: angles, then highlights.
inline void add_light(const ShadeFrame& frame, const ShadeLight& light, const ShadeTask& task,
                      bool first, ShadePlanes& planes) {
    const V3 zero = set3(frame.ambient) * set(0.0f);
    for (std::size_t n = 0; n < task.count; n += lane_count) {
        I x, y, id;
        load_points(task.place, task.pixels + n, task.ids + n, task.count - n, x, y, id);
        const V3 normal = planes.load3(ShadePlanes::normal, n);
        V3 position = zero;
        if (frame.needs_position) position = planes.load3(ShadePlanes::position, n);
        const Incoming in = incoming(light, normal, position);
        const HalfAngle half = half_angle(normal, towards_eye(frame, x, y), in.l);
        const V3 sum = first ? zero : planes.load3(ShadePlanes::light, n);
        planes.store3(sum + in.color * in.n_l, ShadePlanes::light, n);
        store(in.n_l, planes.v[ShadePlanes::n_l] + n);
        store(half.sine2, planes.v[ShadePlanes::sine2] + n);
        // Behind the surface: below every squared cosine.
        store(select(half.behind, set(-1.0f), half.cosine2), planes.v[ShadePlanes::cosine2] + n);
    }
    for (std::size_t n = 0; n < task.count; n += lane_count) {
        const F cosine2 = load(planes.v[ShadePlanes::cosine2] + n);
        const F strength =
            highlight(load(planes.v[ShadePlanes::n_l] + n), load(planes.v[ShadePlanes::sine2] + n),
                      cosine2, cosine2 < set(0.0f), load(planes.v[ShadePlanes::shininess] + n));
        V3 color = set3(light.color);
        if (light.kind != prep::LightKind::directional)
            color = incoming(light, planes.load3(ShadePlanes::normal, n),
                             planes.load3(ShadePlanes::position, n))
                        .color;
        const V3 sum = first ? zero : planes.load3(ShadePlanes::gloss, n);
        planes.store3(sum + color * strength, ShadePlanes::gloss, n);
    }
}

inline void shade(const ShadeDraw& draw, const ShadeFrame& frame, const ShadeTask& whole) {
    ShadePlanes planes;
    for (std::size_t begin = 0; begin < whole.count; begin += points_at_once) {
        ShadeTask task = whole;
        task.pixels += begin;
        task.ids += begin;
        task.count = whole.count - begin < points_at_once ? whole.count - begin : points_at_once;
        for (float*& out : task.out) out += begin;
        store_surfaces(draw, frame, task, planes);
        const bool lit = !draw.unlit && draw.vertex_light == nullptr && frame.light_count > 0;
        for (std::size_t i = 0; lit && i < frame.light_count; ++i)
            add_light(frame, frame.lights[i], task, i == 0, planes);
        for (std::size_t n = 0; n < task.count; n += lane_count) {
            V3 color = planes.load3(ShadePlanes::base, n);
            if (lit)
                color =
                    (color +
                     planes.load3(ShadePlanes::diffuse, n) * planes.load3(ShadePlanes::light, n)) +
                    planes.load3(ShadePlanes::specular, n) * planes.load3(ShadePlanes::gloss, n);
            store3(color, task.out, n);
        }
    }
}

// Bytes of one channel; NaN is 0.
RAST_INLINE I byte_of(F v) {
    const F most = set(1.0f), clipped = select(v > set(0.0f), min(v, most), set(0.0f));
    return to_int(clipped * set(255.0f) + set(0.5f));
}
inline void pack(const float* red, const float* green, const float* blue, std::size_t count,
                 std::uint32_t* out) {
    const auto packed = [](F r, F g, F b) {
        return (byte_of(r) | shift_left<8>(byte_of(g))) |
               (shift_left<16>(byte_of(b)) | set(std::int32_t(0xff000000u)));
    };
    if (count == 1) {
        std::uint32_t lanes[lane_count];
        store(packed(set(*red), set(*green), set(*blue)), lanes);
        *out = lanes[0];
        return;
    }
    for (std::size_t n = 0; n < count; n += lane_count)
        store(packed(load(red + n), load(green + n), load(blue + n)), out + n);
}

inline void attributes(const ShadeDraw& draw, const ShadeFrame& frame, const AttributeTask& task) {
    for (std::size_t n = 0; n < task.count; n += lane_count) {
        I x, y, id;
        load_points(task.place, task.pixels + n, task.ids + n, task.count - n, x, y, id);
        const MixedSurface s = surface_at(draw, triangle_of(draw, id), x, y, draw.textured());
        if (task.normal[0] != nullptr)
            store3(normal_at(draw, s, id < set(0), frame, x, y), task.normal, n);
        if (task.position[0] != nullptr)
            store3(point_from_eye(draw, attribute3(s, draw.positions)), task.position, n);
        if (task.barycentric[0] != nullptr)
            store3(V3{max((set(1.0f) - s.b) - s.c, set(0.0f)), s.b, s.c}, task.barycentric, n);
        if (task.uv[0] == nullptr) continue;
        F u = set(0.0f), v = set(0.0f);
        if (task.uvs != nullptr) {
            u = attribute_within<2>(s, task.uvs, 0);
            v = attribute_within<2>(s, task.uvs, 1);
        }
        store(u, task.uv[0] + n);
        store(v, task.uv[1] + n);
    }
}

inline void light_vertices(const ShadeDraw& draw, const ShadeFrame& frame,
                           const std::uint32_t* vertices, std::size_t count, float* out) {
    const V3 towards = set3(frame.to_eye[0]);
    for (std::size_t n = 0; n < count; n += lane_count) {
        const std::size_t lanes = count - n < lane_count ? count - n : lane_count;
        std::uint32_t list[lane_count];
        for (std::size_t k = 0; k < lane_count; ++k) list[k] = vertices[n + (k < lanes ? k : 0)];
        const I at = load(list) * set(3);
        const auto read = [&](const float* values) {
            return V3{gather(values, at), gather(values + 1, at), gather(values + 2, at)};
        };
        const V3 position = point_from_eye(draw, read(draw.positions));
        const V3 eye = frame.perspective ? unit_or(-position, towards) : unit_or(towards, towards);
        const V3 zero{set(0.0f), set(0.0f), set(0.0f)};
        const V3 normal = unit_or(transformed_normal(draw, read(draw.normals)), zero);
        const F shininess = set(draw.shininess);
        const Light front = light_at(frame, normal, eye, position, shininess);
        const Light back = light_at(frame, -normal, eye, position, shininess);
        const V3 values[4] = {front.diffuse, front.specular, back.diffuse, back.specular};
        for (int part = 0; part < 4; ++part) {
            const F components[3] = {values[part].x, values[part].y, values[part].z};
            for (int c = 0; c < 3; ++c) {
                float results[lane_count];
                store(components[c], results);
                for (std::size_t k = 0; k < lanes; ++k)
                    out[std::size_t(list[k]) * vertex_light_floats + std::size_t(part * 3 + c)] =
                        results[k];
            }
        }
    }
}

inline void specular_powers(const float* sine2, const float* cosine2, float shininess,
                            std::size_t count, float* out) {
    for (std::size_t n = 0; n < count; n += lane_count) {
        float s[lane_count] = {}, c[lane_count] = {}, p[lane_count];
        const std::size_t lanes = count - n < lane_count ? count - n : lane_count;
        for (std::size_t k = 0; k < lanes; ++k) {
            s[k] = sine2[n + k];
            c[k] = cosine2[n + k];
        }
        store(specular_power(load(s), load(c), set(shininess)), p);
        for (std::size_t k = 0; k < lanes; ++k) out[n + k] = p[k];
    }
}
