// Sums over the lights.
// Included once per instruction set, inside the namespace that has its lanes.

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
    return metallic_lobe({none, none, none}, metallic, roughness, {none, none, none}).shininess;
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
