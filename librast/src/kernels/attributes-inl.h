// What is kept of points beside their colours.
// Included once per instruction set, inside the namespace that has its lanes.

inline void attributes(const ShadeDraw& draw, const ShadeFrame& frame, const AttributeTask& task) {
    Wanted wanted;
    wanted.normals = task.normal[0] != nullptr;
    wanted.positions = task.position[0] != nullptr;
    wanted.weights = task.barycentric[0] != nullptr;
    wanted.uvs = task.uv[0] != nullptr ? task.uvs : nullptr;
    const bool mapped =
        wanted.normals && draw.maps[MapKind::normal] &&
        (draw.source == NormalSource::tangent_map || draw.source == NormalSource::object_map);
    wanted.maps = mapped;
    // The normal map alone.
    ShadeDraw with_normals;
    if (mapped) {
        with_normals = draw;
        with_normals.used[0] = MapKind::normal;
        with_normals.used_count = 1;
    }
    const auto ask = [&](Points& points) {
        if (mapped) ask_for(with_normals, {0, 1}, points);
    };
    for_each_portion(draw, task, wanted, ask, [&](Points& points) {
        const std::size_t first = points.first;
        if (mapped) read_maps(with_normals, points);
        if (wanted.normals) finish_normals(draw, frame, task.place, task.pixels + first, points);
        for (std::size_t n = 0; n < points.held; n += vector_size) {
            const auto write = [&](float* const out[], int c, F value) {
                store(value, out[c] + first + n);
            };
            for (int c = 0; wanted.normals && c < 3; ++c)
                write(task.normal, c, points.get(Points::normal + c, n));
            for (int c = 0; wanted.positions && c < 3; ++c)
                write(task.position, c, points.get(Points::position + c, n));
            for (int c = 0; task.uv[0] != nullptr && c < 2; ++c)
                write(task.uv, c,
                      wanted.uvs != nullptr ? points.get(Points::uv + c, n) : set(0.0f));
            if (!wanted.weights) continue;
            const F b = points.get(Points::weights, n), c = points.get(Points::weights + 1, n);
            write(task.barycentric, 0, max((set(1.0f) - b) - c, set(0.0f)));
            write(task.barycentric, 1, b);
            write(task.barycentric, 2, c);
        }
    });
}
