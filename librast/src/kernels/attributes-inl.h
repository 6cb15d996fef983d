// What is kept of points beside their colours.
// Included once per instruction set, inside the namespace that has its lanes.

inline void write_attributes(const AttributeTask& task, const StageList& list, Points& points) {
    const float* const normals = points.find(list, PointValue::normal);
    const float* const positions = points.find(list, PointValue::position);
    const float* const uvs = points.find(list, PointValue::uv);
    const float* const weights = points.find(list, PointValue::weights);
    for (std::size_t n = 0; n < points.held; n += vector_size) {
        const auto write = [&](float* const out[], int c, F value) {
            store(value, out[c] + points.first + n);
        };
        for (int c = 0; task.normal[0] != nullptr && c < 3; ++c)
            write(task.normal, c, get_plane(normals, c, n));
        for (int c = 0; task.position[0] != nullptr && c < 3; ++c)
            write(task.position, c, get_plane(positions, c, n));
        for (int c = 0; task.uv[0] != nullptr && c < 2; ++c)
            write(task.uv, c, uvs != nullptr ? get_plane(uvs, c, n) : set(0.0f));
        if (task.barycentric[0] == nullptr) continue;
        const F b = get_plane(weights, 0, n), c = get_plane(weights, 1, n);
        write(task.barycentric, 0, max((set(1.0f) - b) - c, set(0.0f)));
        write(task.barycentric, 1, b);
        write(task.barycentric, 2, c);
    }
}

inline void attributes(const ShadeDraw& draw, const ShadeFrame& frame, const AttributeTask& task) {
    const StageList& list = *draw.attribute_stages;
    const auto ask = [&](Points& points) { ask_for(draw, list, first_maps(list), points); };
    for_each_portion(draw, list, task, task.uvs, ask, [&](Points& points) {
        for (const Stage& s : list.stages) {
            if (s.kind == StageKind::maps) run_maps(draw, list, s, points);
            if (s.kind == StageKind::normals)
                finish_normals(draw, frame, task.place, task.pixels + points.first, list, points);
            if (s.kind == StageKind::attributes) write_attributes(task, list, points);
            if (task.watch != nullptr)
                task.watch->after(*task.watch, list, std::size_t(&s - list.stages.data()),
                                  points.v[0], plane_stride);
        }
    });
}
