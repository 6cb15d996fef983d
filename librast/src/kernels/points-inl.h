// Where the values of visible points lie while they are shaded.
//
// Points go through several short loops instead of one long one: the processor then works on
// several vectors at a time, where one vector's chain of operations alone would keep it waiting.
// Between the loops they lie in planes, few enough for the first-level cache, that the draw's list
// of stages has assigned.
// Included once per instruction set, inside the namespace that has its lanes.

inline constexpr std::size_t points_at_once = 192;
inline constexpr std::size_t plane_stride = points_at_once + vector_size;

// Values of several planes, from the first one's float on.
RAST_INLINE F get_plane(const float* planes, int plane, std::size_t at) {
    return load(planes + std::size_t(plane) * plane_stride + at);
}
RAST_INLINE void put_plane(F value, float* planes, int plane, std::size_t at) {
    store(value, planes + std::size_t(plane) * plane_stride + at);
}
RAST_INLINE V3 get3(const float* planes, std::size_t at) {
    return {get_plane(planes, 0, at), get_plane(planes, 1, at), get_plane(planes, 2, at)};
}
RAST_INLINE void put3(V3 value, float* planes, std::size_t at) {
    put_plane(value.x, planes, 0, at);
    put_plane(value.y, planes, 1, at);
    put_plane(value.z, planes, 2, at);
}

// What is interpolated of the vertices; null: that is not asked for.
struct SurfacePlanes {
    float *id, *normal, *tangent;
    bool rare;  // any of the next line
    float *position, *color, *vertex_light, *uv, *weights, *uv_gradients;
    float* coordinates[drawn_maps];
};

struct Points {
    alignas(64) float v[most_planes][plane_stride];
    SurfacePlanes surface;
    std::size_t held, first;                    // first: of the task's points
    Reads reads[points_at_once / vector_size];  // of the first maps on the same texels

    // The value is in the list's planes.
    RAST_INLINE float* at(const StageList& list, PointValue value) {
        return v[list.first[std::size_t(value)]];
    }
    RAST_INLINE float* find(const StageList& list, PointValue value) {
        return list.has(value) ? at(list, value) : nullptr;
    }
    // Normals that are read, but made of a map alone, are not interpolated.
    inline void begin(const StageList& list, NormalSource source) {
        held = first = 0;
        surface.id = find(list, PointValue::id);
        surface.normal =
            source == NormalSource::object_map ? nullptr : find(list, PointValue::normal);
        surface.tangent = find(list, PointValue::tangent);
        surface.position = find(list, PointValue::position);
        surface.color = find(list, PointValue::color);
        surface.vertex_light = find(list, PointValue::vertex_light);
        surface.uv = find(list, PointValue::uv);
        surface.weights = find(list, PointValue::weights);
        surface.uv_gradients = find(list, PointValue::uv_gradients);
        surface.rare = surface.position != nullptr || surface.color != nullptr ||
                       surface.vertex_light != nullptr || surface.uv != nullptr ||
                       surface.weights != nullptr || surface.uv_gradients != nullptr;
        for (std::size_t p = 0; p < drawn_maps; ++p)
            surface.coordinates[p] = find(list, coordinates_of(p));
    }
};
