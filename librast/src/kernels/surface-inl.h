// Attributes at visible points.
//
// Triangles are set up as many at a time as there are lanes, into tables with an entry for each;
// vectors of points then pick from the tables what their triangles have. Large triangles cost no
// more than a set-up, small ones fill the lanes as well, and the bits cannot depend on either.
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

// All lanes read the same entry.
struct OnePick {
    std::int32_t entry;
};
RAST_INLINE F pick(const float* table, OnePick at) {
    return set(table[at.entry]);
}
RAST_INLINE I pick(const std::int32_t* table, OnePick at) {
    return set(table[at.entry]);
}

inline constexpr std::size_t vector_size = std::size_t(lane_count);

template <int factor>
RAST_INLINE I times(I v) {
    if constexpr (factor == 2) return shift_left<1>(v);
    if constexpr (factor == 3) return shift_left<1>(v) + v;
    if constexpr (factor == 4) return shift_left<2>(v);
    return v * set(factor);
}

RAST_INLINE I triangle_of(const ShadeDraw& draw, I id) {
    return (id & set(0x7fffffff)) -
           set(std::int32_t(draw.first_id) - std::int32_t(draw.first_triangle));
}

// The corners of one triangle per lane.
struct Corners {
    I vertex[3];
};
RAST_INLINE Corners corners_of(const ShadeDraw& draw, I id) {
    const I index = times<3>(triangle_of(draw, id));
    return {{gather(draw.indices, index), gather(draw.indices + 1, index),
             gather(draw.indices + 2, index)}};
}
// A component of their vertices, `stride` floats each.
template <int stride>
RAST_INLINE F corner_value(const Corners& s, const float* values, int k, int component) {
    return gather(values + component, times<stride>(s.vertex[k]));
}
template <int stride = 3>
RAST_INLINE V3 corner_vector(const Corners& s, const float* values, int k) {
    return {corner_value<stride>(s, values, k, 0), corner_value<stride>(s, values, k, 1),
            corner_value<stride>(s, values, k, 2)};
}

// Weights of the second and the third corner. Where a corner has no place on the screen
// (`crossing`), with their derivatives per pixel.
struct Weights {
    F b, c;
    F inverse;         // of the sum of all three before they were divided by it
    F from_x, from_y;  // of the point, from the first corner, in 1/256 pixels
    M crossing;
    bool any_crossing;
    F b_x, c_x, b_y, c_y;
};

// A value of the corners.
struct ValueTable {
    alignas(64) float first[vector_size], second[vector_size],
        third[vector_size];  // the others less the first

    RAST_INLINE void set_up(F v0, F v1, F v2) {
        store(v0, first);
        store(v1 - v0, second);
        store(v2 - v0, third);
    }
    template <int stride>
    RAST_INLINE void set_up(const Corners& s, const float* values, int component) {
        set_up(corner_value<stride>(s, values, 0, component),
               corner_value<stride>(s, values, 1, component),
               corner_value<stride>(s, values, 2, component));
    }
    // A value that is the same at all three corners comes out with the same bits.
    template <class At>
    RAST_INLINE F operator()(const Weights& w, At at) const {
        return pick(first, at) + (w.b * pick(second, at) + w.c * pick(third, at));
    }
};
struct VectorTable {
    ValueTable v[3];

    RAST_INLINE void set_up(V3 v0, V3 v1, V3 v2) {
        v[0].set_up(v0.x, v1.x, v2.x);
        v[1].set_up(v0.y, v1.y, v2.y);
        v[2].set_up(v0.z, v1.z, v2.z);
    }
    template <int stride = 3>
    RAST_INLINE void set_up(const Corners& s, const float* values) {
        set_up(corner_vector<stride>(s, values, 0), corner_vector<stride>(s, values, 1),
               corner_vector<stride>(s, values, 2));
    }
    template <class At>
    RAST_INLINE V3 operator()(const Weights& w, At at) const {
        return {v[0](w, at), v[1](w, at), v[2](w, at)};
    }
};
// A value that never leaves the range of the corners, not even by a rounding: colours, light, UVs.
struct RangeTable : ValueTable {
    alignas(64) float low[vector_size], high[vector_size];

    RAST_INLINE void set_up(F v0, F v1, F v2) {
        ValueTable::set_up(v0, v1, v2);
        store(min(min(v0, v1), v2), low);
        store(max(max(v0, v1), v2), high);
    }
    template <int stride>
    RAST_INLINE void set_up(const Corners& s, const float* values, int component) {
        set_up(corner_value<stride>(s, values, 0, component),
               corner_value<stride>(s, values, 1, component),
               corner_value<stride>(s, values, 2, component));
    }
    template <class At>
    RAST_INLINE F within(F value, At at) const {
        return min(max(value, pick(low, at)), pick(high, at));
    }
    template <class At>
    RAST_INLINE F operator()(const Weights& w, At at) const {
        return within(ValueTable::operator()(w, at), at);
    }
};

// Edge functions are integers. Over a small triangle they fit 32 bits, where arithmetic that wraps
// round is exact at last; those of wide ones are taken in double, which holds them exactly too.
// Their weighted sums stay in double up to the division: each corner's weight is then off by the
// rounding of its factor and its own last one, which three units in the last place of an
// interpolated value have room for.
struct TriangleTable {
    // Below, slopes fit 16 bits: 128 pixels.
    static constexpr std::int32_t small_extent = 1 << 15;
    // At the tile's first point, and per 1/256 pixel: to the right in the low half, down in the
    // high one.
    alignas(64) std::int32_t edge[3][vector_size], slope[3][vector_size];
    // Of corners 1 and 2: the first corner's w over theirs.
    alignas(64) float weight[3][vector_size];
    alignas(64) double exact_weight[3][vector_size];
    alignas(64) std::int32_t from_x[vector_size], from_y[vector_size];  // first corner to tile
    alignas(64) std::int32_t is_wide[vector_size], is_crossing[vector_size];
    // Of wide ones, anywhere.
    double constant[3][vector_size], slope_x[3][vector_size], slope_y[3][vector_size];
    CrossingWeights crossing_weights_of[vector_size];  // of crossing ones
    bool any_wide, any_crossing;

    // For the derivatives of what is interpolated, see PlaceTable: 256 · area · the factors of the
    // edges that meet in a corner, and that times the way from there to the first corner.
    struct Slopes {
        D at[3], x[3], y[3];
    };
    RAST_INLINE Slopes set_up(const ShadeDraw& draw, const Corners& s, const TilePlace& place,
                              bool derivatives) {
        I x[3], y[3], dx[3], dy[3];
        F w[3];
        for (int k = 0; k < 3; ++k) {
            std::uint32_t each[vector_size];
            store(s.vertex[k], each);
            I w_bits, depth_bits;
            load_each4<1>(&draw.records->x, each, x[k], y[k], w_bits, depth_bits);
            w[k] = from_bits(w_bits);
            dx[k] = x[k] - set(place.x);
            dy[k] = y[k] - set(place.y);
        }
        const I limit = set(first_valid), one = set(1), none = set(0);
        const M crossing = ((x[0] < limit) | (x[1] < limit)) | (x[2] < limit);
        const auto extent = [](const I v[3]) {
            return max(max(v[0], v[1]), v[2]) - min(min(v[0], v[1]), v[2]);
        };
        const I small = set(small_extent);
        const M narrow = (extent(x) < small) & (extent(y) < small);
        const M wide = !(narrow | crossing);
        any_crossing = any(crossing);
        any_wide = any(wide);
        store(select(crossing, one, none), is_crossing);
        store(select(wide, one, none), is_wide);
        if (any_crossing) set_up_crossing_ones(draw, s);
        // Clockwise corners would turn all edge functions round.
        const D area = to_double(x[1] - x[0]) * to_double(y[2] - y[0]) -
                       to_double(x[2] - x[0]) * to_double(y[1] - y[0]);
        const M turned = to_float(area) < set(0.0f);
        for (int k = 0; k < 3; ++k) {
            const int a = k == 2 ? 0 : k + 1, b = a == 2 ? 0 : a + 1;
            const auto positive = [&](I v) { return select(turned, none - v, v); };
            const I slope_right = positive(y[a] - y[b]), slope_down = positive(x[b] - x[a]);
            store(positive(dx[a] * dy[b] - dx[b] * dy[a]), edge[k]);
            store((slope_right & set(0xffff)) | shift_left<16>(slope_down), slope[k]);
            if (!any_wide) continue;
            store(set_double(0.0) - (to_double(slope_right) * to_double(x[a]) +
                                     to_double(slope_down) * to_double(y[a])),
                  constant[k]);
            store(to_double(slope_right), slope_x[k]);
            store(to_double(slope_down), slope_y[k]);
        }
        // Where corners' distances are as far apart as float's exponents go, it does not matter
        // how far.
        F factor[3] = {set(1.0f), w[0] / w[1], w[0] / w[2]};
        for (int k = 1; k < 3; ++k) {
            factor[k] = min(max(factor[k], set(0x1p-60f)), set(0x1p60f));
            store(factor[k], weight[k]);
            store(to_double(factor[k]), exact_weight[k]);
        }
        Slopes out;
        if (!derivatives) return out;
        store(set(place.x) - x[0], from_x);
        store(set(place.y) - y[0], from_y);
        const D scaled = area * set_double(double(subpixels));
        for (int k = 0; k < 3; ++k) {
            const int a = k == 2 ? 0 : k + 1, b = a == 2 ? 0 : a + 1;
            out.at[k] = scaled * (to_double(factor[a]) * to_double(factor[b]));
            out.x[k] = out.at[k] * to_double(x[0] - x[k]);
            out.y[k] = out.at[k] * to_double(y[0] - y[k]);
        }
        return out;
    }

    // The corners' shares of points before they are divided by their sum.
    struct Shares {
        D second, third, sum;
        F inverse;  // of the sum, roughly
    };
    // `at` is `entry` as Pick. Points lie at pixels `i`, `j` of the tile: 0 … 2^15 − 1.
    template <class At>
    RAST_INLINE Shares shares(const TilePlace& place, I entry, At at, I i, I j) const {
        // A covered point's edge functions are positive; outside its triangle (a pixel's centre
        // where only other samples are covered) they are clamped.
        const I way = i | shift_left<16>(j);
        D e[3];
        for (int k = 0; k < 3; ++k) {
            const I rise = sum_of_products(way, pick(slope[k], at));
            e[k] = to_double(max(pick(edge[k], at) + shift_left<subpixel_bits>(rise), set(0)));
        }
        if (any_wide) mend_wide(place, entry, i, j, e);
        Shares s;
        s.second = e[1] * weight_of(1, at);
        s.third = e[2] * weight_of(2, at);
        s.sum = (e[0] + s.second) + s.third;
        s.inverse = set(1.0f) / to_float(s.sum);
        return s;
    }

    template <class At>
    RAST_INLINE Weights weights(const TilePlace& place, bool derivatives, const Shares& s, I entry,
                                At at, I i, I j) const {
        Weights w;
        w.inverse = s.inverse;
        // One step of Newton's method: 46 bits.
        const D rough = to_double(w.inverse);
        const D inverse = rough * (set_double(2.0) - s.sum * rough);
        w.b = to_float(s.second * inverse);
        w.c = to_float(s.third * inverse);
        if (derivatives) {
            w.from_x = to_float(shift_left<subpixel_bits>(i) + pick(from_x, at));
            w.from_y = to_float(shift_left<subpixel_bits>(j) + pick(from_y, at));
        }
        w.any_crossing = any_crossing;
        if (any_crossing) mend_crossing(place, entry, i, j, w);
        return w;
    }

  private:
    RAST_INLINE D weight_of(int k, Pick at) const { return to_double(pick(weight[k], at)); }
    RAST_INLINE D weight_of(int k, OnePick at) const {
        return set_double(exact_weight[k][at.entry]);
    }

    inline void set_up_crossing_ones(const ShadeDraw& draw, const Corners& s) {
        std::uint32_t vertex[3][vector_size];
        for (int k = 0; k < 3; ++k) store(s.vertex[k], vertex[k]);
        for (std::size_t n = 0; n < vector_size; ++n) {
            if (is_crossing[n] == 0) continue;
            if (n > 0 && is_crossing[n - 1] != 0 && vertex[0][n] == vertex[0][n - 1] &&
                vertex[1][n] == vertex[1][n - 1] && vertex[2][n] == vertex[2][n - 1]) {
                crossing_weights_of[n] = crossing_weights_of[n - 1];
                continue;
            }
            const std::uint32_t corners[3] = {vertex[0][n], vertex[1][n], vertex[2][n]};
            crossing_weights_of[n] = crossing_weights(*draw.source_vertices, draw.records, corners);
        }
    }

    inline void mend_wide(const TilePlace& place, I entry, I i, I j, D e[3]) const {
        std::int32_t entries_of[vector_size], columns[vector_size], rows[vector_size];
        store(entry, entries_of);
        const std::int32_t n = entries_of[0];
        if (n == entries_of[vector_size - 1]) {
            if (is_wide[n] == 0) return;
            const D x = to_double(shift_left<subpixel_bits>(i) + set(place.x));
            const D y = to_double(shift_left<subpixel_bits>(j) + set(place.y));
            for (int k = 0; k < 3; ++k)
                e[k] = max((set_double(slope_x[k][n]) * x + set_double(constant[k][n])) +
                               set_double(slope_y[k][n]) * y,
                           set_double(0.0));
            return;
        }
        store(i, columns);
        store(j, rows);
        for (int k = 0; k < 3; ++k) {
            double each[vector_size];
            store(e[k], each);
            for (std::size_t l = 0; l < vector_size; ++l) {
                const std::int32_t m = entries_of[l];
                if (is_wide[m] == 0) continue;
                const double x = double(columns[l] * subpixels + place.x);
                const double y = double(rows[l] * subpixels + place.y);
                const double here = (slope_x[k][m] * x + constant[k][m]) + slope_y[k][m] * y;
                each[l] = here > 0 ? here : 0.0;
            }
            e[k] = load(each);
        }
    }

    inline void mend_crossing(const TilePlace& place, I entry, I i, I j, Weights& w) const {
        std::int32_t entries_of[vector_size], columns[vector_size], rows[vector_size];
        store(entry, entries_of);
        store(i, columns);
        store(j, rows);
        float b[vector_size], c[vector_size], b_x[vector_size], c_x[vector_size], b_y[vector_size],
            c_y[vector_size];
        store(w.b, b);
        store(w.c, c);
        for (float* values : {b_x, c_x, b_y, c_y}) store(set(0.0f), values);
        for (std::size_t l = 0; l < vector_size; ++l) {
            const std::int32_t n = entries_of[l];
            if (is_crossing[n] == 0) continue;
            double q[9];
            crossing_weights_of[n].at(double(columns[l] * subpixels + place.x) / subpixels,
                                      double(rows[l] * subpixels + place.y) / subpixels, q);
            for (int k = 0; k < 3; ++k) q[k] = q[k] > 0 ? q[k] : 0.0;
            const double inverse = 1 / ((q[0] + q[1]) + q[2]);
            const double mine_b = q[1] * inverse, mine_c = q[2] * inverse;
            const double sum_right = (q[3] + q[4]) + q[5], sum_down = (q[6] + q[7]) + q[8];
            b[l] = float(mine_b);
            c[l] = float(mine_c);
            b_x[l] = float((q[4] - mine_b * sum_right) * inverse);
            c_x[l] = float((q[5] - mine_c * sum_right) * inverse);
            b_y[l] = float((q[7] - mine_b * sum_down) * inverse);
            c_y[l] = float((q[8] - mine_c * sum_down) * inverse);
        }
        w.crossing = pick(is_crossing, pick_of(entry)) > set(0);
        w.b = load(b);
        w.c = load(c);
        w.b_x = load(b_x);
        w.c_x = load(c_x);
        w.b_y = load(b_y);
        w.c_y = load(c_y);
    }
};

// Texture coordinates, and their change per pixel to the right and down.
struct Coordinates {
    F u, v, u_x, v_x, u_y, v_y;
};

// Where a corner lies in the maps of a place.
RAST_INLINE void place_corner(const MapPlace& place, const Corners& s, int k, F& u, F& v) {
    const F raw_u = corner_value<2>(s, place.uv, k, 0), raw_v = corner_value<2>(s, place.uv, k, 1);
    const auto turned = [&](int row) {
        return (set(place.matrix[row * 2]) * raw_u + set(place.matrix[row * 2 + 1]) * raw_v) +
               set(place.offset[row]);
    };
    u = turned(0);
    v = turned(1);
}

// The coordinates at one place of maps, and their derivatives.
//
// A value is Σ qᵢ uᵢ / S with qᵢ = fᵢ eᵢ (factor and edge function of the edge opposite to corner
// i) and S = Σ qᵢ. Its derivative along x is Σ (qᵢ′ qⱼ − qⱼ′ qᵢ)(uᵢ − uⱼ) / S² over the pairs of
// corners, and eᵢ′ eⱼ − eⱼ′ eᵢ depends on y alone: it is area · (y − yₖ), zero at the corner k
// where both edges meet. So S² ∂u/∂x is linear in y, and S² ∂u/∂y in x: nothing large cancels,
// however strong the perspective is.
struct PlaceTable {
    RangeTable u, v;
    // Of the linear functions, from the first corner: ∂x = at_x + rise · y, ∂y = at_y − rise · x.
    struct Derivative {
        alignas(64) float rise[vector_size], at_x[vector_size], at_y[vector_size];
    } of_u, of_v;

    RAST_INLINE void set_up(const MapPlace& place, const Corners& s,
                            const TriangleTable::Slopes& slopes) {
        F us[3], vs[3];
        for (int k = 0; k < 3; ++k) place_corner(place, s, k, us[k], vs[k]);
        u.set_up(us[0], us[1], us[2]);
        v.set_up(vs[0], vs[1], vs[2]);
        set_up(of_u, us, slopes);
        set_up(of_v, vs, slopes);
    }

    template <class At>
    RAST_INLINE Coordinates operator()(const Weights& w, At at) const {
        Coordinates out;
        out.u = u(w, at);
        out.v = v(w, at);
        const auto along = [&](const Derivative& d, F& x, F& y) {
            const F rise = pick(d.rise, at);
            x = ((pick(d.at_x, at) + rise * w.from_y) * w.inverse) * w.inverse;
            y = ((pick(d.at_y, at) - rise * w.from_x) * w.inverse) * w.inverse;
        };
        along(of_u, out.u_x, out.u_y);
        along(of_v, out.v_x, out.v_y);
        if (w.any_crossing) {
            const auto mended = [&](const RangeTable& value, F b, F c, F otherwise) {
                return select(w.crossing, b * pick(value.second, at) + c * pick(value.third, at),
                              otherwise);
            };
            out.u_x = mended(u, w.b_x, w.c_x, out.u_x);
            out.v_x = mended(v, w.b_x, w.c_x, out.v_x);
            out.u_y = mended(u, w.b_y, w.c_y, out.u_y);
            out.v_y = mended(v, w.b_y, w.c_y, out.v_y);
        }
        return out;
    }

  private:
    static RAST_INLINE void set_up(Derivative& out, const F value[3],
                                   const TriangleTable::Slopes& slopes) {
        D difference[3];
        for (int k = 0; k < 3; ++k) {
            const int a = k == 2 ? 0 : k + 1, b = a == 2 ? 0 : a + 1;
            difference[k] = to_double(value[a]) - to_double(value[b]);
        }
        const auto sum = [&](const D factor[3]) {
            return (difference[0] * factor[0] + difference[1] * factor[1]) +
                   difference[2] * factor[2];
        };
        store(to_float(sum(slopes.at)), out.rise);
        store(to_float(sum(slopes.y)), out.at_x);
        store(-to_float(sum(slopes.x)), out.at_y);
    }
};

// The gradients of u and v over the triangle, per unit of the mesh.
struct GradientTable {
    alignas(64) float component[6][vector_size];

    // With edges a, b and n = a × b: ∇u = (Δu_a (b × n) + Δu_b (n × a)) / n². Edges are brought to
    // order one by the longer one, so that no product leaves float's range. Triangles without an
    // area have gradients of 0: nothing is said of slopes there.
    inline void set_up(const Corners& s, const float* positions, const MapPlace& place) {
        V3 p[3];
        F u[3], v[3];
        for (int k = 0; k < 3; ++k) {
            p[k] = corner_vector(s, positions, k);
            place_corner(place, s, k, u[k], v[k]);
        }
        const V3 first = p[1] - p[0], second = p[2] - p[0];
        const auto size_of = [](V3 e) { return max(max(abs(e.x), abs(e.y)), abs(e.z)); };
        const F size = max(size_of(first), size_of(second)), zero = set(0.0f);
        const M sized = (size > zero) & (size < set(0x1p126f));
        const F scale = set(1.0f) / select(sized, size, set(1.0f));
        const V3 a = first * scale, b = second * scale, n = cross(a, b);
        const F squared = dot(n, n);
        const M good = sized & (squared > zero);
        const F factor = scale / select(good, squared, set(1.0f));
        const V3 across_b = cross(b, n), across_a = cross(n, a);
        const auto gradient = [&](const F c[3], int at) {
            const V3 g = (across_b * (c[1] - c[0]) + across_a * (c[2] - c[0])) * factor;
            const M finite = good & (size_of(g) < set(0x1p126f));
            const F values[3] = {g.x, g.y, g.z};
            for (int k = 0; k < 3; ++k) store(select(finite, values[k], zero), component[at + k]);
        };
        gradient(u, 0);
        gradient(v, 3);
    }
    template <class At>
    RAST_INLINE F operator()(int k, At at) const {
        return pick(component[k], at);
    }
};

// The next runs, as many as there are lanes.
struct RunGroup {
    const TriangleRun* runs;
    std::size_t count;

    RAST_INLINE std::size_t end() const { return runs[count - 1].end; }
    RAST_INLINE I ids() const {
        std::uint32_t each[vector_size];
        for (std::size_t k = 0; k < vector_size; ++k) each[k] = runs[k < count ? k : count - 1].id;
        return load(each);
    }
    RAST_INLINE std::size_t run_of(std::size_t point) const {
        std::size_t run = 0;
        while (run + 1 < count && runs[run].end <= point) ++run;
        return run;
    }
    // Whether the vector from `point` on lies in one run.
    RAST_INLINE bool is_one(std::size_t point, std::size_t run) const {
        return runs[run].end >= point + vector_size || run + 1 == count;
    }
    // Which runs the points from `point` on belong to; `run` is that of the first, and is moved on
    // to the first of the next vector. Lanes past the end belong to the last.
    RAST_INLINE I entries(std::size_t point, std::size_t& run) const {
        I entry = set(std::int32_t(run));
        while (run + 1 < count && runs[run].end < point + vector_size) {
            const I last = set(std::int32_t(runs[run].end - point) - 1);
            ++run;
            entry = select(iota() > last, set(std::int32_t(run)), entry);
        }
        if (run + 1 < count && runs[run].end == point + vector_size) ++run;
        return entry;
    }
};
RAST_INLINE RunGroup next_group(const TriangleRun* runs, std::size_t count) {
    return {runs, count < vector_size ? count : vector_size};
}
