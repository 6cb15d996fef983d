// Sums over the lights.
// Included once per instruction set, inside the namespace that has its lanes.

// Light takes several loops, so that few operations wait for a root or a quotient at a time. The
// eye's direction first,
inline void find_eye(const ShadeFrame& frame, const TilePlace& place, const std::uint16_t* pixels,
                     const StageList& list, Points& points) {
    float* const eye = points.at(list, PointValue::eye);
    for (std::size_t n = 0; n < points.held; n += vector_size) {
        I i, j;
        load_pixels(pixels + n, i, j);
        // Exact: places are multiples of 1/256 within 2^15 pixels.
        const V3 v = towards_eye(frame, to_float(i) + set(float(place.x) / float(subpixels)),
                                 to_float(j) + set(float(place.y) / float(subpixels)));
        put3(v, eye, n);
        put_plane(sqrt(dot(v, v)), eye, 3, n);
    }
}
// Where a light is not at a place, positions matter to nothing.
RAST_INLINE V3 position_at(const ShadeLight& light, const float* positions, std::size_t n) {
    if (light.kind != prep::LightKind::directional) return get3(positions, n);
    const F none = set(0.0f);
    return {none, none, none};
}
// then for each light its angles,
inline void add_light(const ShadeLight& light, bool first, const StageList& list, Points& points) {
    const float* const normals = points.at(list, PointValue::normal);
    const float* const positions = points.find(list, PointValue::position);
    const float* const eye = points.at(list, PointValue::eye);
    float* const sums = points.at(list, PointValue::light);
    float* const angles = points.at(list, PointValue::angle);
    float* const halves = points.at(list, PointValue::half);
    for (std::size_t n = 0; n < points.held; n += vector_size) {
        const V3 normal = get3(normals, n);
        const Incoming in = incoming(light, normal, position_at(light, positions, n));
        const HalfAngle half = half_angle(normal, get3(eye, n), get_plane(eye, 3, n), in.l);
        const V3 sent = in.color * in.n_l;
        put3(first ? sent : get3(sums, n) + sent, sums, n);
        put_plane(in.n_l, angles, 0, n);
        put_plane(half.cosine2, angles, 1, n);
        put_plane(half.sine2, halves, 0, n);
        put_plane(half.length2, halves, 1, n);
    }
}
// where there are no highlights, its part of the sum alone,
inline void add_matte_light(const ShadeLight& light, bool first, const StageList& list,
                            Points& points) {
    const float* const normals = points.at(list, PointValue::normal);
    const float* const positions = points.find(list, PointValue::position);
    float* const sums = points.at(list, PointValue::light);
    for (std::size_t n = 0; n < points.held; n += vector_size) {
        const Incoming in = incoming(light, get3(normals, n), position_at(light, positions, n));
        const V3 sent = in.color * in.n_l;
        put3(first ? sent : get3(sums, n) + sent, sums, n);
    }
}
RAST_INLINE F shininess_at(const ShadeDraw& draw, const float* metallic_roughness, std::size_t n) {
    if (!draw.metallic_roughness) return set(draw.shininess);
    const F none = set(0.0f);
    F metallic, roughness;
    roughness_at(draw, metallic_roughness, n, metallic, roughness);
    return metallic_lobe({none, none, none}, metallic, roughness, {none, none, none}).shininess;
}
// the logarithm of its highlight,
inline void find_exponents(const ShadeDraw& draw, const StageList& list, Points& points) {
    const float* const angles = points.at(list, PointValue::angle);
    const float* const halves = points.at(list, PointValue::half);
    const float* const roughness = points.find(list, texels_of(MapKind::metallic_roughness));
    float* const exponents = points.at(list, PointValue::exponent);
    for (std::size_t n = 0; n < points.held; n += vector_size) {
        if (!any(get_plane(angles, 0, n) > set(0.0f))) continue;
        store(specular_exponent(get_plane(halves, 0, n), get_plane(angles, 1, n),
                                get_plane(halves, 1, n), shininess_at(draw, roughness, n)),
              exponents + n);
    }
}
// and the sum of highlights up to this light's. It is a loop of its own for the last light as well:
// beside the stores of colours, what does not fit the registers holds them up.
inline void add_gloss(const ShadeDraw& draw, const ShadeLight& light, bool first,
                      const StageList& list, Points& points) {
    const float* const angles = points.at(list, PointValue::angle);
    const float* const exponents = points.at(list, PointValue::exponent);
    const float* const roughness = points.find(list, texels_of(MapKind::metallic_roughness));
    const float* const positions = points.find(list, PointValue::position);
    float* const sums = points.at(list, PointValue::gloss);
    const F none = set(0.0f);
    for (std::size_t n = 0; n < points.held; n += vector_size) {
        V3 sum{none, none, none};
        if (!first) sum = get3(sums, n);
        const F n_l = get_plane(angles, 0, n);
        if (any(n_l > none)) {  // else it adds nothing, to the bit
            const F strength = highlight(n_l, get_plane(angles, 1, n), load(exponents + n),
                                         shininess_at(draw, roughness, n));
            V3 color = set3(light.color);
            if (light.kind != prep::LightKind::directional)
                color = incoming(light, {none, none, none}, get3(positions, n)).color;
            sum = first ? color * strength : sum + color * strength;
        }
        put3(sum, sums, n);
    }
}
