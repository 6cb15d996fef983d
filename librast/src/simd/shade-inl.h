// Attributes, textures, normals and light at visible points.
// Included once per instruction set, inside the namespace that has its lanes.

struct V3 {
    F x, y, z;
};
inline V3 operator+(V3 a, V3 b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline V3 operator-(V3 a, V3 b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline V3 operator*(V3 a, F s) {
    return {a.x * s, a.y * s, a.z * s};
}
inline V3 operator*(V3 a, V3 b) {
    return {a.x * b.x, a.y * b.y, a.z * b.z};
}
inline V3 operator-(V3 a) {
    return {-a.x, -a.y, -a.z};
}
inline F dot(V3 a, V3 b) {
    return (a.x * b.x + a.y * b.y) + a.z * b.z;
}
inline V3 cross(V3 a, V3 b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline V3 set3(const float* v) {
    return {set(v[0]), set(v[1]), set(v[2])};
}
inline V3 select(M m, V3 yes, V3 no) {
    return {select(m, yes.x, no.x), select(m, yes.y, no.y), select(m, yes.z, no.z)};
}

// The corners of each lane's triangle, the perspective-correct weights of the second and the third,
// and the weights' derivatives per pixel.
struct Surface {
    I corner[3];
    F b, c;
    F b_x, c_x, b_y, c_y;
};

// A value that is the same at all three corners comes out with the same bits.
inline F blend(const Surface& s, F v0, F v1, F v2) {
    return v0 + (s.b * (v1 - v0) + s.c * (v2 - v0));
}
// One that never leaves the range of the corners, not even by a rounding: colours, light and UVs.
inline F blend_within(const Surface& s, F v0, F v1, F v2) {
    return min(max(blend(s, v0, v1, v2), min(min(v0, v1), v2)), max(max(v0, v1), v2));
}
inline F attribute(const Surface& s, const float* values, const I index[3], int component) {
    const float* p = values + component;
    return blend(s, gather(p, index[0]), gather(p, index[1]), gather(p, index[2]));
}
inline F attribute_within(const Surface& s, const float* values, const I index[3], int component) {
    const float* p = values + component;
    return blend_within(s, gather(p, index[0]), gather(p, index[1]), gather(p, index[2]));
}
inline V3 attribute3(const Surface& s, const float* values) {
    const I index[3] = {s.corner[0] * set(3), s.corner[1] * set(3), s.corner[2] * set(3)};
    return {attribute(s, values, index, 0), attribute(s, values, index, 1),
            attribute(s, values, index, 2)};
}

// Weights of lanes whose triangle has a corner without a place on the screen.
inline void mend_weights(const ShadeDraw& draw, const Surface& s, M crossing, I x, I y, D q[3],
                         D q_x[3], D q_y[3]) {
    std::int32_t xs[lane_count], ys[lane_count];
    std::uint32_t corners[3][lane_count];
    double values[9][lane_count];
    store(x, xs);
    store(y, ys);
    for (int k = 0; k < 3; ++k) {
        store(s.corner[k], corners[k]);
        store(q[k], values[k]);
        store(q_x[k], values[3 + k]);
        store(q_y[k], values[6 + k]);
    }
    for (std::uint32_t rest = bits_of(crossing); rest != 0; rest &= rest - 1) {
        const int lane = __builtin_ctz(rest);
        const std::uint32_t v[3] = {corners[0][lane], corners[1][lane], corners[2][lane]};
        double patch[9];
        crossing_weights(*draw.source_vertices, draw.records, v, double(xs[lane]) / subpixels,
                         double(ys[lane]) / subpixels, patch);
        for (int k = 0; k < 9; ++k) values[k][lane] = patch[k];
    }
    for (int k = 0; k < 3; ++k) {
        q[k] = load(values[k]);
        q_x[k] = load(values[3 + k]);
        q_y[k] = load(values[6 + k]);
    }
}

// Differences to the snapped corners are integers and their products exact, so that a covered
// point's weights are positive; outside its triangle (a pixel's centre where only other samples
// are covered) they are clamped.
inline Surface surface_at(const ShadeDraw& draw, I triangle, I px, I py, bool derivatives) {
    Surface s;
    const I index = triangle * set(3);
    const std::int32_t* xs = &draw.records->x;
    const float* ws = &draw.records->w;
    I raw[3];
    D x[3], y[3], w[3];
    for (int k = 0; k < 3; ++k) {
        s.corner[k] = gather(draw.indices + k, index);
        const I at = shift_left<2>(s.corner[k]);
        raw[k] = gather(xs, at);
        x[k] = to_double(raw[k] - px);
        y[k] = to_double(gather(xs + 1, at) - py);
        w[k] = to_double(gather(ws, at));
    }
    const D per_pixel = set_double(double(subpixels));
    D q[3], q_x[3], q_y[3], e[3];
    for (int k = 0; k < 3; ++k) {
        const int a = k == 2 ? 0 : k + 1, b = a == 2 ? 0 : a + 1;
        e[k] = x[a] * y[b] - x[b] * y[a];
    }
    const D area = (e[0] + e[1]) + e[2];  // signed: clockwise corners turn all of them round
    for (int k = 0; k < 3; ++k) {
        const int a = k == 2 ? 0 : k + 1, b = a == 2 ? 0 : a + 1;
        const D weight = area * (w[a] * w[b]);
        q[k] = e[k] * weight;
        if (!derivatives) continue;
        q_x[k] = (y[a] - y[b]) * per_pixel * weight;
        q_y[k] = (x[b] - x[a]) * per_pixel * weight;
    }
    const I limit = set(first_valid);
    const M crossing = ((raw[0] < limit) | (raw[1] < limit)) | (raw[2] < limit);
    if (any(crossing)) {
        if (!derivatives)
            for (int k = 0; k < 3; ++k) q_x[k] = q_y[k] = set_double(0.0);
        mend_weights(draw, s, crossing, px, py, q, q_x, q_y);
    }
    const D zero = set_double(0.0);
    for (int k = 0; k < 3; ++k) q[k] = max(q[k], zero);
    const D inverse = set_double(1.0) / ((q[0] + q[1]) + q[2]);
    const D b = q[1] * inverse, c = q[2] * inverse;
    s.b = to_float(b);
    s.c = to_float(c);
    if (derivatives) {
        const D sum_x = (q_x[0] + q_x[1]) + q_x[2], sum_y = (q_y[0] + q_y[1]) + q_y[2];
        s.b_x = to_float((q_x[1] - b * sum_x) * inverse);
        s.c_x = to_float((q_x[2] - c * sum_x) * inverse);
        s.b_y = to_float((q_y[1] - b * sum_y) * inverse);
        s.c_y = to_float((q_y[2] - c * sum_y) * inverse);
    } else {
        s.b_x = s.c_x = s.b_y = s.c_y = set(0.0f);
    }
    return s;
}

struct Texel {
    F r, g, b, a;
};

inline Texel sample_map(const BoundMap& map, const Surface& s) {
    const I index[3] = {shift_left<1>(s.corner[0]), shift_left<1>(s.corner[1]),
                        shift_left<1>(s.corner[2])};
    F uv[3][2];
    for (int k = 0; k < 3; ++k) {
        uv[k][0] = gather(map.uv, index[k]);
        uv[k][1] = gather(map.uv + 1, index[k]);
    }
    const auto turned = [&](int row, F u, F v) {
        return set(map.matrix[row * 2]) * u + set(map.matrix[row * 2 + 1]) * v;
    };
    const F raw_u = blend_within(s, uv[0][0], uv[1][0], uv[2][0]);
    const F raw_v = blend_within(s, uv[0][1], uv[1][1], uv[2][1]);
    const F u1 = uv[1][0] - uv[0][0], u2 = uv[2][0] - uv[0][0];
    const F v1 = uv[1][1] - uv[0][1], v2 = uv[2][1] - uv[0][1];
    // u, v, then their change per pixel right and down.
    float values[6][lane_count], out[4][lane_count];
    store(turned(0, raw_u, raw_v) + set(map.offset[0]), values[0]);
    store(turned(1, raw_u, raw_v) + set(map.offset[1]), values[1]);
    const auto step = [&](F b, F c, int at) {
        const F du = b * u1 + c * u2, dv = b * v1 + c * v2;
        store(turned(0, du, dv), values[at]);
        store(turned(1, du, dv), values[at + 1]);
    };
    step(s.b_x, s.c_x, 2);
    step(s.b_y, s.c_y, 4);
    for (int lane = 0; lane < lane_count; ++lane) {
        const float at[6] = {values[0][lane], values[1][lane], values[2][lane],
                             values[3][lane], values[4][lane], values[5][lane]};
        float texel[4];
        sample_texture(*map.texture, map.filter, map.most, at, texel);
        for (int c = 0; c < 4; ++c) out[c][lane] = texel[c];
    }
    return {load(out[0]), load(out[1]), load(out[2]), load(out[3])};
}

inline I triangle_of(const ShadeDraw& draw, I id) {
    return (id & set(0x7fffffff)) -
           set(std::int32_t(draw.first_id) - std::int32_t(draw.first_triangle));
}

inline M alpha_passes(const ShadeDraw& draw, I px, I py, I id) {
    const Surface s = surface_at(draw, triangle_of(draw, id), px, py, bool(draw.diffuse_map));
    F alpha = set(draw.diffuse[3]);
    if (draw.colors != nullptr) {
        const I index[3] = {shift_left<2>(s.corner[0]), shift_left<2>(s.corner[1]),
                            shift_left<2>(s.corner[2])};
        alpha = alpha * attribute_within(s, draw.colors, index, 3);
    }
    if (draw.diffuse_map) alpha = alpha * sample_map(draw.diffuse_map, s).a;
    return alpha >= set(draw.alpha_cutoff);
}

inline bool covers(const ShadeDraw& draw, std::int32_t x, std::int32_t y, std::uint32_t id) {
    return (bits_of(alpha_passes(draw, set(x), set(y), set(std::int32_t(id)))) & 1u) != 0;
}

inline V3 transformed_normal(const ShadeDraw& draw, V3 n) {
    const float* m = draw.normal_matrix;
    return {(set(m[0]) * n.x + set(m[1]) * n.y) + set(m[2]) * n.z,
            (set(m[3]) * n.x + set(m[4]) * n.y) + set(m[5]) * n.z,
            (set(m[6]) * n.x + set(m[7]) * n.y) + set(m[8]) * n.z};
}

inline F largest(V3 v) {
    return max(max(abs(v.x), abs(v.y)), abs(v.z));
}

// Whether a vector of this largest component has a direction. Above the limit, one over it would
// be flushed to zero.
inline M is_length(F size) {
    return (size > set(0.0f)) & (size < set(8.0e37f));
}

// Unit length whatever the length was; lanes without a direction (zero, NaN) get `otherwise`.
inline V3 unit_or(V3 v, V3 otherwise) {
    const F size = largest(v);
    const M good = is_length(size);
    const V3 scaled = v * (set(1.0f) / select(good, size, set(1.0f)));
    const F inverse = set(1.0f) / sqrt(select(good, dot(scaled, scaled), set(1.0f)));
    return select(good, scaled * inverse, otherwise);
}

// The triangle's own normal on its front side, world axes.
inline V3 face_normal(const ShadeDraw& draw, const Surface& s, V3 otherwise) {
    V3 p[3];
    for (int k = 0; k < 3; ++k) {
        const I at = s.corner[k] * set(3);
        p[k] = {gather(draw.positions, at), gather(draw.positions + 1, at),
                gather(draw.positions + 2, at)};
    }
    const V3 zero{set(0.0f), set(0.0f), set(0.0f)};
    // Edges brought to order one: products of tiny and huge ones would leave float's range.
    const V3 a = unit_or(p[1] - p[0], zero), b = unit_or(p[2] - p[0], zero);
    return unit_or(transformed_normal(draw, cross(a, b)), otherwise);
}

// Unit, on the side that is seen.
inline V3 normal_at(const ShadeDraw& draw, const Surface& s, M back, V3 to_eye) {
    const auto seen = [&](V3 n) { return select(back, -n, n); };
    if (draw.source == NormalSource::face) return seen(face_normal(draw, s, seen(to_eye)));
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
            const I index[3] = {shift_left<2>(s.corner[0]), shift_left<2>(s.corner[1]),
                                shift_left<2>(s.corner[2])};
            const V3 t = {attribute(s, draw.tangents, index, 0),
                          attribute(s, draw.tangents, index, 1),
                          attribute(s, draw.tangents, index, 2)};
            const V3 b = cross(n, t) * gather(draw.tangents + 3, index[0]);
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
    const V3 otherwise = all(good) ? n : face_normal(draw, s, seen(to_eye));
    return seen(unit_or(n, otherwise));
}

struct Light {
    V3 diffuse, specular;
};

// Sums over the lights at a point with unit normal n and unit direction v to the eye.
inline Light light_at(const ShadeFrame& frame, V3 n, V3 v, V3 position, F shininess) {
    const F zero = set(0.0f), one = set(1.0f);
    Light sum{{zero, zero, zero}, {zero, zero, zero}};
    for (std::size_t i = 0; i < frame.light_count; ++i) {
        const ShadeLight& light = frame.lights[i];
        V3 l = set3(light.to_light);
        V3 color = set3(light.color);
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
                const F cosine = dot(towards, l);
                const F cone =
                    min(max(cosine * set(light.cone_scale) + set(light.cone_offset), zero), one);
                strength = strength * (cone * cone);
            }
            color = color * strength;
            l = towards;
        }
        const F n_l = dot(n, l);
        const M lit = n_l > zero;
        sum.diffuse = sum.diffuse + color * select(lit, n_l, zero);
        const V3 h = l + v;
        const F h2 = max(dot(h, h), set(1.0e-30f));
        const V3 across = cross(n, h);
        const F n_h = dot(n, h);
        const F inverse = one / h2;
        const F power = specular_power(min(dot(across, across) * inverse, one),
                                       (n_h * n_h) * inverse, shininess);
        const F behind = select(shininess == zero, one, zero);  // 0^0
        sum.specular = sum.specular + color * select(lit, select(n_h > zero, power, behind), zero);
    }
    return sum;
}

// How the surface reflects: Blinn-Phong as the material says, or derived from metallic-roughness as
// prep::blinn_phong() does.
struct Lobe {
    V3 diffuse, specular;
    F shininess;
};
inline Lobe lobe_at(const ShadeDraw& draw, const Surface& s, V3 albedo) {
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
inline Light interpolated_light(const ShadeDraw& draw, const Surface& s, M back) {
    const I side = select(back, set(6), set(0));
    I index[3];
    for (int k = 0; k < 3; ++k)
        index[k] = s.corner[k] * set(std::int32_t(vertex_light_floats)) + side;
    const auto value = [&](int c) { return attribute_within(s, draw.vertex_light, index, c); };
    return {{value(0), value(1), value(2)}, {value(3), value(4), value(5)}};
}

inline V3 point_from_eye(const ShadeDraw& draw, V3 p) {
    const auto row = [&](int r) {
        const float* m = draw.from_eye[r];
        return ((set(m[0]) * p.x + set(m[1]) * p.y) + set(m[2]) * p.z) + set(m[3]);
    };
    return {row(0), row(1), row(2)};
}

inline V3 direction_to_eye(const ShadeFrame& frame, I x, I y) {
    const F to_pixels = set(1.0f / float(subpixels));
    const V3 otherwise = set3(frame.to_eye[0]);
    return unit_or((otherwise + set3(frame.to_eye[1]) * (to_float(x) * to_pixels)) +
                       set3(frame.to_eye[2]) * (to_float(y) * to_pixels),
                   otherwise);
}

inline V3 color_at(const ShadeDraw& draw, const ShadeFrame& frame, const Surface& s, M back, I x,
                   I y) {
    const F zero = set(0.0f);
    V3 albedo = set3(draw.diffuse);
    if (draw.colors != nullptr) {
        const I index[3] = {shift_left<2>(s.corner[0]), shift_left<2>(s.corner[1]),
                            shift_left<2>(s.corner[2])};
        albedo = albedo * V3{attribute_within(s, draw.colors, index, 0),
                             attribute_within(s, draw.colors, index, 1),
                             attribute_within(s, draw.colors, index, 2)};
    }
    if (draw.diffuse_map) {
        const Texel map = sample_map(draw.diffuse_map, s);
        albedo = albedo * V3{map.r, map.g, map.b};
    }
    V3 emissive = set3(draw.emissive);
    if (draw.emissive_map) {
        const Texel map = sample_map(draw.emissive_map, s);
        emissive = emissive * V3{map.r, map.g, map.b};
    }
    if (draw.unlit) return albedo + emissive;
    const Lobe lobe = lobe_at(draw, s, albedo);
    Light light;
    if (draw.vertex_light != nullptr) {
        light = interpolated_light(draw, s, back);
    } else {
        const V3 to_eye = direction_to_eye(frame, x, y);
        const V3 normal = normal_at(draw, s, back, to_eye);
        V3 position{zero, zero, zero};
        if (frame.needs_position) position = point_from_eye(draw, attribute3(s, draw.positions));
        light = light_at(frame, normal, to_eye, position, lobe.shininess);
    }
    V3 ambient = set3(frame.ambient) * set3(draw.ambient);
    if (draw.occlusion_map) {
        const F one = set(1.0f), open = sample_map(draw.occlusion_map, s).r;
        ambient = ambient * (one + set(draw.occlusion_map.strength) * (open - one));
    }
    return ((albedo * ambient + lobe.diffuse * light.diffuse) + lobe.specular * light.specular) +
           emissive;
}

inline void shade(const ShadeDraw& draw, const ShadeFrame& frame, const ShadeTask& task) {
    const bool derivatives = draw.textured();
    for (std::size_t n = 0; n < task.count; n += lane_count) {
        const I id = load(task.ids + n), x = load(task.x + n), y = load(task.y + n);
        const Surface s = surface_at(draw, triangle_of(draw, id), x, y, derivatives);
        const V3 color = color_at(draw, frame, s, id < set(0), x, y);
        store(color.x, task.out[0] + n);
        store(color.y, task.out[1] + n);
        store(color.z, task.out[2] + n);
    }
}

inline void attributes(const ShadeDraw& draw, const ShadeFrame& frame, const AttributeTask& task) {
    const auto put = [](V3 v, float* const out[3], std::size_t n) {
        store(v.x, out[0] + n);
        store(v.y, out[1] + n);
        store(v.z, out[2] + n);
    };
    for (std::size_t n = 0; n < task.count; n += lane_count) {
        const I id = load(task.ids + n), x = load(task.x + n), y = load(task.y + n);
        const Surface s = surface_at(draw, triangle_of(draw, id), x, y, draw.textured());
        if (task.normal[0] != nullptr)
            put(normal_at(draw, s, id < set(0), direction_to_eye(frame, x, y)), task.normal, n);
        if (task.position[0] != nullptr)
            put(point_from_eye(draw, attribute3(s, draw.positions)), task.position, n);
        if (task.barycentric[0] != nullptr)
            put(V3{max((set(1.0f) - s.b) - s.c, set(0.0f)), s.b, s.c}, task.barycentric, n);
        if (task.uv[0] == nullptr) continue;
        F u = set(0.0f), v = set(0.0f);
        if (task.uvs != nullptr) {
            const I index[3] = {shift_left<1>(s.corner[0]), shift_left<1>(s.corner[1]),
                                shift_left<1>(s.corner[2])};
            u = attribute_within(s, task.uvs, index, 0);
            v = attribute_within(s, task.uvs, index, 1);
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
