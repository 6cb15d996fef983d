// Attributes at visible points: vectors, and the weights of a triangle's corners.
// Included once per instruction set, inside the namespace that has its lanes.

struct V3 {
    F x, y, z;
};
RAST_INLINE V3 operator+(V3 a, V3 b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
RAST_INLINE V3 operator-(V3 a, V3 b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
RAST_INLINE V3 operator*(V3 a, F s) {
    return {a.x * s, a.y * s, a.z * s};
}
RAST_INLINE V3 operator*(V3 a, V3 b) {
    return {a.x * b.x, a.y * b.y, a.z * b.z};
}
RAST_INLINE V3 operator-(V3 a) {
    return {-a.x, -a.y, -a.z};
}
RAST_INLINE F dot(V3 a, V3 b) {
    return (a.x * b.x + a.y * b.y) + a.z * b.z;
}
RAST_INLINE V3 cross(V3 a, V3 b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
RAST_INLINE V3 set3(const float* v) {
    return {set(v[0]), set(v[1]), set(v[2])};
}
RAST_INLINE V3 select(M m, V3 yes, V3 no) {
    return {select(m, yes.x, no.x), select(m, yes.y, no.y), select(m, yes.z, no.z)};
}

// Perspective-correct weights of the second and the third corner, and their derivatives per pixel.
struct Weights {
    F b, c;
    F b_x, c_x, b_y, c_y;
};
// Lanes in triangles of their own, or all in one; the same operations on the same numbers, so that
// the bits do not depend on which is used.
struct MixedSurface : Weights {
    I corner[3];
};
struct UniformSurface : Weights {
    std::uint32_t vertex[3];
};

template <int factor>
RAST_INLINE I times(I v) {
    if constexpr (factor == 2) return shift_left<1>(v);
    if constexpr (factor == 3) return shift_left<1>(v) + v;
    if constexpr (factor == 4) return shift_left<2>(v);
    return v * set(factor);
}

// A component of the corners' vertices, `stride` floats each.
template <int stride>
RAST_INLINE F corner_value(const MixedSurface& s, const float* values, int k, int component) {
    return gather(values + component, times<stride>(s.corner[k]));
}
template <int stride>
RAST_INLINE F corner_value(const UniformSurface& s, const float* values, int k, int component) {
    return set(values[std::size_t(s.vertex[k]) * stride + std::size_t(component)]);
}

// A value that is the same at all three corners comes out with the same bits.
RAST_INLINE F blend(const Weights& s, F v0, F v1, F v2) {
    return v0 + (s.b * (v1 - v0) + s.c * (v2 - v0));
}
// One that never leaves the range of the corners, not even by a rounding: colours, light and UVs.
RAST_INLINE F blend_within(const Weights& s, F v0, F v1, F v2) {
    return min(max(blend(s, v0, v1, v2), min(min(v0, v1), v2)), max(max(v0, v1), v2));
}
template <int stride, class S>
RAST_INLINE F attribute_within(const S& s, const float* values, int component) {
    return blend_within(s, corner_value<stride>(s, values, 0, component),
                        corner_value<stride>(s, values, 1, component),
                        corner_value<stride>(s, values, 2, component));
}
template <int stride, class S>
RAST_INLINE F attribute(const S& s, const float* values, int component) {
    return blend(s, corner_value<stride>(s, values, 0, component),
                 corner_value<stride>(s, values, 1, component),
                 corner_value<stride>(s, values, 2, component));
}
template <int stride = 3, class S>
RAST_INLINE V3 attribute3(const S& s, const float* values) {
    return {attribute<stride>(s, values, 0), attribute<stride>(s, values, 1),
            attribute<stride>(s, values, 2)};
}

RAST_INLINE I triangle_of(const ShadeDraw& draw, I id) {
    return (id & set(0x7fffffff)) -
           set(std::int32_t(draw.first_id) - std::int32_t(draw.first_triangle));
}

// Weights of lanes whose triangle has a corner without a place on the screen.
inline void mend_weights(const ShadeDraw& draw, const MixedSurface& s, M crossing, I x, I y, D q[3],
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

// Edge functions times area and the other corners' w, and the same per pixel.
struct CornerWeights {
    D q[3], q_x[3], q_y[3];
};

RAST_INLINE void set_weights(const CornerWeights& e, bool derivatives, Weights& s) {
    const D zero = set_double(0.0);
    // A covered point's weights are positive; outside its triangle (a pixel's centre where only
    // other samples are covered) they are clamped.
    D q[3];
    for (int k = 0; k < 3; ++k) q[k] = max(e.q[k], zero);
    const D inverse = set_double(1.0) / ((q[0] + q[1]) + q[2]);
    const D b = q[1] * inverse, c = q[2] * inverse;
    s.b = to_float(b);
    s.c = to_float(c);
    if (!derivatives) {
        s.b_x = s.c_x = s.b_y = s.c_y = set(0.0f);
        return;
    }
    const D sum_x = (e.q_x[0] + e.q_x[1]) + e.q_x[2], sum_y = (e.q_y[0] + e.q_y[1]) + e.q_y[2];
    s.b_x = to_float((e.q_x[1] - b * sum_x) * inverse);
    s.c_x = to_float((e.q_x[2] - c * sum_x) * inverse);
    s.b_y = to_float((e.q_y[1] - b * sum_y) * inverse);
    s.c_y = to_float((e.q_y[2] - c * sum_y) * inverse);
}

// Differences to the snapped corners are integers; their products and the sums of those are exact.
RAST_INLINE MixedSurface surface_at(const ShadeDraw& draw, I triangle, I px, I py,
                                    bool derivatives) {
    MixedSurface s;
    const I index = times<3>(triangle);
    const std::int32_t* xs = &draw.records->x;
    const float* ws = &draw.records->w;
    I raw[3];
    D x[3], y[3], w[3];
    for (int k = 0; k < 3; ++k) {
        s.corner[k] = gather(draw.indices + k, index);
        const I at = times<4>(s.corner[k]);
        raw[k] = gather(xs, at);
        x[k] = to_double(raw[k] - px);
        y[k] = to_double(gather(xs + 1, at) - py);
        w[k] = to_double(gather(ws, at));
    }
    const D per_pixel = set_double(double(subpixels));
    CornerWeights out;
    D e[3];
    for (int k = 0; k < 3; ++k) {
        const int a = k == 2 ? 0 : k + 1, b = a == 2 ? 0 : a + 1;
        e[k] = x[a] * y[b] - x[b] * y[a];
    }
    const D area = (e[0] + e[1]) + e[2];  // signed: clockwise corners turn all of them round
    for (int k = 0; k < 3; ++k) {
        const int a = k == 2 ? 0 : k + 1, b = a == 2 ? 0 : a + 1;
        const D weight = area * (w[a] * w[b]);
        out.q[k] = e[k] * weight;
        if (!derivatives) {
            out.q_x[k] = out.q_y[k] = set_double(0.0);
            continue;
        }
        out.q_x[k] = (y[a] - y[b]) * per_pixel * weight;
        out.q_y[k] = (x[b] - x[a]) * per_pixel * weight;
    }
    const I limit = set(first_valid);
    const M crossing = ((raw[0] < limit) | (raw[1] < limit)) | (raw[2] < limit);
    if (any(crossing)) mend_weights(draw, s, crossing, px, py, out.q, out.q_x, out.q_y);
    set_weights(out, derivatives, s);
    return s;
}

// One triangle for all points: what does not depend on the point is computed once.
struct UniformTriangle {
    std::uint32_t vertex[3];
    double constant[3], slope_x[3], slope_y[3];  // of the edge functions: integers, exact
    double weight[3], q_x[3], q_y[3];
};

// False: a corner has no place on the screen.
RAST_INLINE bool uniform_triangle(const ShadeDraw& draw, std::uint32_t id, UniformTriangle& t) {
    const std::size_t triangle = (id & ~id_back_face) - draw.first_id + draw.first_triangle;
    double x[3], y[3], w[3];
    for (int k = 0; k < 3; ++k) {
        t.vertex[k] = draw.indices[triangle * 3 + std::size_t(k)];
        const VertexRecord& record = draw.records[t.vertex[k]];
        if (record.x < first_valid) return false;
        x[k] = double(record.x);
        y[k] = double(record.y);
        w[k] = double(record.w);
    }
    const double area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
    for (int k = 0; k < 3; ++k) {
        const int a = k == 2 ? 0 : k + 1, b = a == 2 ? 0 : a + 1;
        t.constant[k] = x[a] * y[b] - x[b] * y[a];
        t.slope_x[k] = y[a] - y[b];
        t.slope_y[k] = x[b] - x[a];
        t.weight[k] = area * (w[a] * w[b]);
        t.q_x[k] = t.slope_x[k] * double(subpixels) * t.weight[k];
        t.q_y[k] = t.slope_y[k] * double(subpixels) * t.weight[k];
    }
    return true;
}

RAST_INLINE UniformSurface surface_at(const UniformTriangle& t, I px, I py, bool derivatives) {
    UniformSurface s;
    const D x = to_double(px), y = to_double(py);
    CornerWeights out;
    for (int k = 0; k < 3; ++k) {
        s.vertex[k] = t.vertex[k];
        const D e = (set_double(t.slope_x[k]) * x + set_double(t.constant[k])) +
                    set_double(t.slope_y[k]) * y;
        out.q[k] = e * set_double(t.weight[k]);
        out.q_x[k] = set_double(t.q_x[k]);
        out.q_y[k] = set_double(t.q_y[k]);
    }
    set_weights(out, derivatives, s);
    return s;
}
