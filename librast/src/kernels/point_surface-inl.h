// Normals of the points, and how they reflect.
// Included once per instruction set, inside the namespace that has its lanes.

// Normals as they are lit: world axes, unit, on the side that is seen.
inline void finish_normals(const ShadeDraw& draw, const ShadeFrame& frame, const TilePlace& place,
                           const std::uint16_t* pixels, const StageList& list, Points& points) {
    float* const ids = points.at(list, PointValue::id);
    float* const normals = points.at(list, PointValue::normal);
    const float* const tangents = points.find(list, PointValue::tangent);
    const float* const texels = points.find(list, texels_of(MapKind::normal));
    const float* const slopes = points.find(list, texels_of(MapKind::bump));
    const float* const gradients = points.find(list, PointValue::uv_gradients);
    // Lanes past the end have a triangle, if nothing else.
    store(set(ids[points.held - 1]), ids + points.held);
    for (std::size_t n = 0; n < points.held; n += vector_size) {
        const I id = bits(load(ids + n));
        const M there = iota() < set(std::int32_t(points.held - n));
        I x, y;
        load_places(place, pixels + n, x, y);
        V3 normal;
        if (draw.source == NormalSource::face) {
            normal = get3(normals, n);
            const M good = largest(normal) > set(0.0f);
            normal = on_seen_side(id, normal);
            if (!all(good | !there))
                normal = select(good, normal, mended_normal(draw, frame, id, x, y));
        } else {
            if (draw.source == NormalSource::object_map)
                normal = object_space_normal(draw, get3(texels, n));
            else
                normal = get3(normals, n);
            if (draw.source == NormalSource::tangent_map)
                normal = tangent_space_normal(draw, normal, get3(tangents, n),
                                              get_plane(tangents, 3, n), get3(texels, n));
            if (slopes != nullptr)
                normal = bumped_normal(draw, normal, get3(gradients, n),
                                       get3(gradients + 3 * plane_stride, n), get3(slopes, n));
            normal = finished_normal(draw, frame, normal, there, id, x, y);
        }
        put3(normal, normals, n);
    }
}

// Texels of the map of metallic and roughness; null: there is none.
RAST_INLINE void roughness_at(const ShadeDraw& draw, const float* texels, std::size_t n,
                              F& metallic, F& roughness) {
    metallic = set(draw.metallic);
    roughness = set(draw.roughness);
    if (texels == nullptr) return;
    const V3 map = get3(texels, n);
    metallic = metallic * map.z;
    roughness = roughness * map.y;
}

// What reflection reads of the points; null: nothing of that.
struct ReflectionPlanes {
    const float *color = nullptr, *diffuse = nullptr, *specular = nullptr, *occlusion = nullptr,
                *emissive = nullptr, *metallic_roughness = nullptr;
    friend bool operator==(const ReflectionPlanes&, const ReflectionPlanes&) = default;
};
RAST_INLINE ReflectionPlanes reflection_planes(const StageList& list, Points& points) {
    const auto texels = [&](MapKind kind) { return points.find(list, texels_of(kind)); };
    return {points.find(list, PointValue::color),
            texels(MapKind::diffuse),
            texels(MapKind::specular),
            texels(MapKind::occlusion),
            texels(MapKind::emissive),
            texels(MapKind::metallic_roughness)};
}

// How a point answers to light: base + diffuse · Σ light + specular · Σ highlights.
struct Reflection {
    V3 base;
    Lobe lobe;
};
RAST_INLINE Reflection reflection_at(const ShadeDraw& draw, const ShadeFrame& frame,
                                     const ReflectionPlanes& planes, std::size_t n) {
    V3 albedo = set3(draw.diffuse);
    if (planes.color != nullptr) albedo = albedo * get3(planes.color, n);
    if (planes.diffuse != nullptr) albedo = albedo * get3(planes.diffuse, n);
    Reflection r{albedo, {albedo, set3(draw.specular), set(draw.shininess)}};
    if (draw.unlit) return r;
    if (draw.metallic_roughness) {
        F metallic, roughness;
        roughness_at(draw, planes.metallic_roughness, n, metallic, roughness);
        V3 reflectance = set3(draw.reflectance);
        if (planes.specular != nullptr) reflectance = reflectance * get3(planes.specular, n);
        r.lobe = metallic_lobe(albedo, metallic, roughness, reflectance);
    } else if (planes.specular != nullptr) {
        r.lobe.specular = r.lobe.specular * get3(planes.specular, n);
    }
    V3 ambient = set3(frame.ambient) * set3(draw.ambient);
    if (planes.occlusion != nullptr) {
        const F one = set(1.0f), open = get_plane(planes.occlusion, 0, n);
        ambient = ambient * (one + set(draw.maps[MapKind::occlusion].strength) * (open - one));
    }
    r.base = albedo * ambient;
    if (draw.glows) {
        V3 emissive = set3(draw.emissive);
        if (planes.emissive != nullptr) emissive = emissive * get3(planes.emissive, n);
        r.base = r.base + emissive;
    }
    return r;
}
