// Normals, reflection and light: a point per lane.
// Included once per instruction set, inside the namespace that has its lanes.

RAST_INLINE V3 transformed_normal(const ShadeDraw& draw, V3 n) {
    if (draw.world_normals) return n;
    const float* m = draw.normal_matrix;
    return {(set(m[0]) * n.x + set(m[1]) * n.y) + set(m[2]) * n.z,
            (set(m[3]) * n.x + set(m[4]) * n.y) + set(m[5]) * n.z,
            (set(m[6]) * n.x + set(m[7]) * n.y) + set(m[8]) * n.z};
}

RAST_INLINE F largest(V3 v) {
    return max(max(abs(v.x), abs(v.y)), abs(v.z));
}

// Whether a vector of this largest component and this squared length has a direction. Maxima pass
// NaN over, sums do not.
RAST_INLINE M is_length(F size, F squared) {
    return ((size > set(0.0f)) & (size < set(8.0e37f))) & (squared >= set(0.0f));
}

// Whether vectors of these squared lengths can be made unit as they are: where no square is near
// the ends of float's range, scaling them before would change no bit.
RAST_INLINE bool are_handy(F squared) {
    return all((squared > set(0x1p-60f)) & (squared < set(0x1p60f)));
}

// Unit length whatever the length was; lanes without a direction (zero, NaN) get `otherwise`.
RAST_INLINE V3 unit_or(V3 v, V3 otherwise) {
    const F squared = dot(v, v);
    if (are_handy(squared)) return v * (set(1.0f) / sqrt(squared));
    const F size = largest(v);
    const M good = is_length(size, squared);
    // By a power of two, to order one: squares stay in float's range and nothing is rounded.
    const I exponent = bits(select(good, size, set(1.0f))) & set(0x7f800000);
    const V3 scaled = v * from_bits(max(set(0x7f000000) - exponent, set(0x00800000)));
    const F inverse = set(1.0f) / sqrt(select(good, dot(scaled, scaled), set(1.0f)));
    return select(good, scaled * inverse, otherwise);
}

// Not normalised; of a length near one. From `x`, `y`, in pixels from the picture's centre.
RAST_INLINE V3 towards_eye(const ShadeFrame& frame, F x, F y) {
    return (set3(frame.to_eye[0]) + set3(frame.to_eye[1]) * x) + set3(frame.to_eye[2]) * y;
}
RAST_INLINE V3 direction_to_eye(const ShadeFrame& frame, I x, I y) {
    const F to_pixels = set(1.0f / float(subpixels));
    return unit_or(towards_eye(frame, to_float(x) * to_pixels, to_float(y) * to_pixels),
                   set3(frame.to_eye[0]));
}

// The triangle's own normal on its front side, world axes.
inline V3 face_normal(const ShadeDraw& draw, const Corners& s, V3 otherwise) {
    V3 p[3];
    for (int k = 0; k < 3; ++k) p[k] = corner_vector(s, draw.positions, k);
    const V3 zero{set(0.0f), set(0.0f), set(0.0f)};
    // Edges brought to order one: products of tiny and huge ones would leave float's range.
    const V3 a = unit_or(p[1] - p[0], zero), b = unit_or(p[2] - p[0], zero);
    return unit_or(transformed_normal(draw, cross(a, b)), otherwise);
}

RAST_INLINE V3 on_seen_side(I id, V3 n) {
    const M back = id < set(0);
    return any(back) ? select(back, -n, n) : n;
}

// The geometric normal where `good` does not hold, on the side that is seen; where there is none
// either, the direction to the eye.
inline V3 mended_normal(const ShadeDraw& draw, const ShadeFrame& frame, I id, I x, I y) {
    const V3 otherwise = on_seen_side(id, direction_to_eye(frame, x, y));
    return on_seen_side(id, face_normal(draw, corners_of(draw, id), otherwise));
}

// From mesh to world axes, unit, on the side that is seen. Opposite normals pass through zero: the
// geometric one takes over, where lanes are `there`.
RAST_INLINE V3 finished_normal(const ShadeDraw& draw, const ShadeFrame& frame, V3 n, M there, I id,
                               I x, I y) {
    n = transformed_normal(draw, n);
    const F squared = dot(n, n);
    if (are_handy(squared)) return on_seen_side(id, n * (set(1.0f) / sqrt(squared)));
    const M good = is_length(largest(n), squared);
    const V3 unit = on_seen_side(id, unit_or(n, n));
    if (all(good | !there)) return unit;
    return select(good, unit, mended_normal(draw, frame, id, x, y));
}

// Interpolated vectors stay as long as they come out: the map was baked so (MikkTSpace).
RAST_INLINE V3 tangent_space_normal(const ShadeDraw& draw, V3 n, V3 t, F sign, V3 map) {
    const V3 b = cross(n, t) * sign;
    const F two = set(2.0f), one = set(1.0f);
    const float strength = draw.maps[MapKind::normal].strength;
    const F mx = (map.x * two - one) * set(strength);
    const F my = (map.y * two - one) * set(draw.flip_green ? -strength : strength);
    const F mz = map.z * two - one;
    return (t * mx + b * my) + n * mz;
}
RAST_INLINE V3 object_space_normal(const ShadeDraw& draw, V3 map) {
    const F two = set(2.0f), one = set(1.0f);
    const V3 n{map.x * two - one, map.y * two - one, map.z * two - one};
    return {n.x, draw.flip_green ? -n.y : n.y, n.z};
}

// Of the surface that is moved by heights along its normal (Blinn 1978): n less the heights'
// gradient over the surface. `slope`: by u and v, whose gradients over the triangle are projected
// onto the plane that n is perpendicular to; Mikkelsen (2010) keeps slopes along the triangle
// instead, which grow without end where n leans from it. 0 changes no bit of n but a zero's sign.
RAST_INLINE V3 bumped_normal(const ShadeDraw& draw, V3 n, V3 u, V3 v, V3 slope) {
    const F strength = set(draw.maps[MapKind::bump].strength);
    const V3 gradient = u * (slope.x * strength) + v * (slope.y * strength);
    const F squared = dot(n, n), zero = set(0.0f);
    const M good = (squared > zero) & (squared < set(0x1p126f));
    const F length = sqrt(select(good, squared, set(1.0f)));
    const V3 bent = (n - gradient * length) + n * (dot(n, gradient) / length);
    return select(good, bent, n);
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

// Squared sine and cosine of the angle between the normal and the half vector, times the squared
// length of both; the cosine is −1 where the half vector points away from the surface.
struct HalfAngle {
    F sine2, cosine2, length2;
};
// `v`: towards the eye, of length `distance`, which saves dividing by it.
RAST_INLINE HalfAngle half_angle(V3 n, V3 v, F distance, V3 l) {
    const V3 h = l * distance + v;
    const V3 across = cross(n, h);
    const F n_h = dot(n, h);
    return {dot(across, across), select(n_h > set(0.0f), n_h * n_h, set(-1.0f)),
            max(dot(h, h), set(1.0e-30f))};
}

// Of the highlight; 0^0 is 1. `exponent`: of two, specular_exponent().
RAST_INLINE F highlight(F n_l, F cosine2, F exponent, F shininess) {
    const F zero = set(0.0f);
    const F otherwise = select(shininess == zero, set(1.0f), zero);
    const F power = select(cosine2 < zero, otherwise, exp2_negative(exponent));
    return select(n_l > zero, power, zero);
}

// Sums over the lights.
inline Light light_at(const ShadeFrame& frame, V3 n, V3 v, V3 position, F shininess) {
    const F zero = set(0.0f);
    Light sum{{zero, zero, zero}, {zero, zero, zero}};
    for (std::size_t i = 0; i < frame.light_count; ++i) {
        const Incoming in = incoming(frame.lights[i], n, position);
        const HalfAngle half = half_angle(n, v, set(1.0f), in.l);
        const F exponent = specular_exponent(half.sine2, half.cosine2, half.length2, shininess);
        sum.diffuse = sum.diffuse + in.color * in.n_l;
        sum.specular =
            sum.specular + in.color * highlight(in.n_l, half.cosine2, exponent, shininess);
    }
    return sum;
}

// How the surface reflects: Blinn-Phong as the material says, or derived from metallic-roughness as
// prep::blinn_phong() does.
struct Lobe {
    V3 diffuse, specular;
    F shininess;
};
RAST_INLINE Lobe metallic_lobe(V3 albedo, F metallic, F roughness, V3 reflectance) {
    const F one = set(1.0f), two = set(2.0f);
    const F alpha = max(roughness * roughness, set(0.02f));
    Lobe lobe;
    lobe.shininess = max(two / (alpha * alpha) - two, set(0.0f));
    const F width = lobe.shininess + two;
    lobe.specular =
        (reflectance + (albedo - reflectance) * metallic) * (width / set(8.0f) + set(0.5f) / width);
    lobe.diffuse = albedo * (one - metallic);
    return lobe;
}

RAST_INLINE V3 point_from_eye(const ShadeDraw& draw, V3 p) {
    const auto row = [&](int r) {
        const float* m = draw.from_eye[r];
        return ((set(m[0]) * p.x + set(m[1]) * p.y) + set(m[2]) * p.z) + set(m[3]);
    };
    return {row(0), row(1), row(2)};
}

inline void light_vertices(const ShadeDraw& draw, const ShadeFrame& frame,
                           const std::uint32_t* vertices, std::size_t count, float* out) {
    const V3 towards = set3(frame.to_eye[0]);
    for (std::size_t n = 0; n < count; n += lane_count) {
        const std::size_t some = count - n < lane_count ? count - n : lane_count;
        std::uint32_t list[lane_count];
        for (std::size_t k = 0; k < lane_count; ++k) list[k] = vertices[n + (k < some ? k : 0)];
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
                for (std::size_t k = 0; k < some; ++k)
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
        const std::size_t some = count - n < lane_count ? count - n : lane_count;
        for (std::size_t k = 0; k < some; ++k) {
            s[k] = sine2[n + k];
            c[k] = cosine2[n + k];
        }
        store(exp2_negative(specular_exponent(load(s), load(c), set(1.0f), set(shininess))), p);
        for (std::size_t k = 0; k < some; ++k) out[n + k] = p[k];
    }
}
