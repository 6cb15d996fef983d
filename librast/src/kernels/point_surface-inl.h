// Normals of the points, and how they reflect.
// Included once per instruction set, inside the namespace that has its lanes.

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
                                              texel_of(points, MapKind::normal, n));
            if (draw.source == NormalSource::object_map)
                normal = object_space_normal(draw, texel_of(points, MapKind::normal, n));
            normal = finished_normal(draw, frame, normal, there, id, x, y);
        }
        points.put3(normal, Points::normal, n);
    }
}

RAST_INLINE void roughness_at(const ShadeDraw& draw, const Points& points, std::size_t n,
                              F& metallic, F& roughness) {
    metallic = set(draw.metallic);
    roughness = set(draw.roughness);
    if (!draw.maps[MapKind::metallic_roughness]) return;
    const V3 map = texel_of(points, MapKind::metallic_roughness, n);
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
    if (draw.maps[MapKind::diffuse]) albedo = albedo * texel_of(points, MapKind::diffuse, n);
    Reflection r{albedo, {albedo, set3(draw.specular), set(draw.shininess)}};
    const auto glow = [&] {
        V3 emissive = set3(draw.emissive);
        if (draw.maps[MapKind::emissive])
            emissive = emissive * texel_of(points, MapKind::emissive, n);
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
        V3 reflectance = set3(draw.reflectance);
        if (draw.maps[MapKind::specular])
            reflectance = reflectance * texel_of(points, MapKind::specular, n);
        r.lobe = metallic_lobe(albedo, metallic, roughness, reflectance);
    } else if (draw.maps[MapKind::specular]) {
        r.lobe.specular = r.lobe.specular * texel_of(points, MapKind::specular, n);
    }
    V3 ambient = set3(frame.ambient) * set3(draw.ambient);
    if (draw.maps[MapKind::occlusion]) {
        const F one = set(1.0f), open = texel_of(points, MapKind::occlusion, n).x;
        ambient = ambient * (one + set(draw.maps[MapKind::occlusion].strength) * (open - one));
    }
    r.base = albedo * ambient;
    if (glows) glow();
    return r;
}
