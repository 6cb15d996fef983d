// Where the values of visible points lie while they are shaded, and which of them are asked for.
//
// Points go through several short loops instead of one long one: the processor then works on
// several vectors at a time, where one vector's chain of operations alone would keep it waiting.
// Between the loops they lie in Points, few enough for the first-level cache.
// Included once per instruction set, inside the namespace that has its lanes.

inline constexpr std::size_t points_at_once = 128;
struct Points {
    enum : int {
        normal = 0,  // as it is interpolated, then unit
        tangent = 3,
        sign = 6,  // of the bitangent
        color = 7,
        position = 10,  // from the eye
        vertex_light = 13,
        light = 19,  // sums over the lights
        gloss = 22,
        eye = 25,  // towards it, and how long that is
        distance = 28,
        n_l,  // of one light, as HalfAngle has them
        sine2,
        cosine2,
        length2,
        exponent,
        weights,  // of the second and the third corner
        uv = weights + 2,
        texels = uv + 2,  // of each kind of map
        coordinates = texels + 3 * int(drawn_maps),
        count = coordinates + 6 * int(drawn_maps)
    };
    alignas(64) float v[count][points_at_once + vector_size];
    alignas(64) std::int32_t id[points_at_once + vector_size];
    std::size_t held = 0, first = 0;            // first: of the task's points
    Reads reads[points_at_once / vector_size];  // of the first maps on the same texels

    RAST_INLINE F get(int plane, std::size_t at) const { return load(v[plane] + at); }
    RAST_INLINE V3 get3(int plane, std::size_t at) const {
        return {load(v[plane] + at), load(v[plane + 1] + at), load(v[plane + 2] + at)};
    }
    RAST_INLINE void put(F value, int plane, std::size_t at) { store(value, v[plane] + at); }
    RAST_INLINE void put3(V3 value, int plane, std::size_t at) {
        put(value.x, plane, at);
        put(value.y, plane + 1, at);
        put(value.z, plane + 2, at);
    }
};

// What is asked of the points of a draw.
struct Wanted {
    bool normals = false, positions = false, colors = false, vertex_light = false, maps = false;
    bool weights = false;
    const float* uvs = nullptr;
};
