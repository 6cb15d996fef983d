// Colours of a draw's points, as floats or as bytes.
// Included once per instruction set, inside the namespace that has its lanes.

// Bytes of one channel; NaN is 0.
RAST_INLINE I byte_of(F v) {
    const F clipped = min(max(v, set(0.0f)), set(1.0f));
    return to_int(clipped * set(255.0f) + set(0.5f));
}
RAST_INLINE I packed_color(V3 c) {
    return (byte_of(c.x) | shift_left<8>(byte_of(c.y))) |
           (shift_left<16>(byte_of(c.z)) | set(std::int32_t(0xff000000u)));
}

RAST_INLINE void write_bytes(V3 color, const std::uint16_t* pixels, std::size_t count,
                             const ShadeTask& task) {
    const I packed = packed_color(color);
    if (count >= vector_size) {
        scatter(packed, task.bytes, load(pixels));
        return;
    }
    std::uint32_t each[vector_size];
    store(packed, each);
    for (std::size_t k = 0; k < count; ++k) task.bytes[pixels[k]] = each[k];
}

// What is reflected, and where it goes. `reflection(n)`: of the points from n on.
template <class ReflectionAt>
RAST_INLINE void write_colors(const ShadeTask& task, const StageList& list,
                              const ReflectionAt& reflection, Points& points) {
    const float* const lights = points.find(list, PointValue::light);
    const float* const vertex_light = points.find(list, PointValue::vertex_light);
    const float* const gloss = points.find(list, PointValue::gloss);
    const std::size_t first = points.first, held = points.held;
    const std::uint16_t* const pixels = task.pixels + first;
    for (std::size_t n = 0; n < held; n += vector_size) {
        const Reflection& r = reflection(n);
        V3 color = r.base;
        if (gloss != nullptr) {
            color = (color + r.lobe.diffuse * get3(lights, n)) + r.lobe.specular * get3(gloss, n);
        } else if (lights != nullptr) {
            // 0 is what highlights would add; −0 becomes 0 by it.
            const F none = set(0.0f);
            color = (color + r.lobe.diffuse * get3(lights, n)) + V3{none, none, none};
        }
        if (vertex_light != nullptr)
            color = (color + r.lobe.diffuse * get3(vertex_light, n)) +
                    r.lobe.specular * get3(vertex_light + 3 * plane_stride, n);
        if (task.bytes != nullptr) {
            write_bytes(color, pixels + n, held - n, task);
            continue;
        }
        store(color.x, task.out[0] + first + n);
        store(color.y, task.out[1] + first + n);
        store(color.z, task.out[2] + first + n);
    }
}

inline void write_colors(const ShadeDraw& draw, const ShadeFrame& frame, const ShadeTask& task,
                         const StageList& list, Points& points) {
    const ReflectionPlanes planes = reflection_planes(list, points);
    if (planes == ReflectionPlanes{}) {
        // The surface reflects alike everywhere.
        const Reflection r = reflection_at(draw, frame, ReflectionPlanes{}, 0);
        write_colors(
            task, list, [&](std::size_t) -> const Reflection& { return r; }, points);
        return;
    }
    const auto reflection = [&](std::size_t n) { return reflection_at(draw, frame, planes, n); };
    write_colors(task, list, reflection, points);
}

// The maps' first stage is asked for as soon as points have their surface; the others when the
// first one's turn has come.
RAST_INLINE const Stage& first_maps(const StageList& list) {
    return list.stages[1];  // after interpolation
}
inline void run_maps(const ShadeDraw& draw, const StageList& list, const Stage& stage,
                     Points& points) {
    if (&stage != &first_maps(list)) ask_for(draw, list, stage, points);
    read_maps(draw, list, stage, points);
}

// `watched`: the task's watch is told of each.
template <bool watched>
inline void run_stages(const ShadeDraw& draw, const ShadeFrame& frame, const ShadeTask& task,
                       const StageList& list, Points& points) {
    const std::uint16_t* const pixels = task.pixels + points.first;
    for (const Stage& s : list.stages) {
        switch (s.kind) {
            case StageKind::maps:
                run_maps(draw, list, s, points);
                break;
            case StageKind::normals:
                finish_normals(draw, frame, task.place, pixels, list, points);
                break;
            case StageKind::eye:
                find_eye(frame, task.place, pixels, list, points);
                break;
            case StageKind::light:
                add_light(frame.lights[s.begin], s.begin == 0, list, points);
                break;
            case StageKind::matte_light:
                add_matte_light(frame.lights[s.begin], s.begin == 0, list, points);
                break;
            case StageKind::exponents:
                find_exponents(draw, list, points);
                break;
            case StageKind::gloss:
                add_gloss(draw, frame.lights[s.begin], s.begin == 0, list, points);
                break;
            case StageKind::color:
                write_colors(draw, frame, task, list, points);
                break;
            case StageKind::interpolation:  // has been done
            case StageKind::attributes:
            case StageKind::count:
                break;
        }
        if constexpr (watched)
            task.watch->after(*task.watch, list, std::size_t(&s - list.stages.data()), points.v[0],
                              plane_stride);
    }
}

inline void shade(const ShadeDraw& draw, const ShadeFrame& frame, const ShadeTask& task) {
    const StageList& list = *draw.color_stages;
    const auto ask = [&](Points& points) { ask_for(draw, list, first_maps(list), points); };
    for_each_portion(draw, list, task, nullptr, ask, [&](Points& points) {
        if (task.watch == nullptr)
            run_stages<false>(draw, frame, task, list, points);
        else
            run_stages<true>(draw, frame, task, list, points);
    });
}

inline void pack(const float* red, const float* green, const float* blue, std::size_t count,
                 std::uint32_t* out) {
    if (count == 1) {
        std::uint32_t each[vector_size];
        store(packed_color({set(*red), set(*green), set(*blue)}), each);
        *out = each[0];
        return;
    }
    for (std::size_t n = 0; n < count; n += vector_size)
        store(packed_color({load(red + n), load(green + n), load(blue + n)}), out + n);
}

inline void fill(const PictureRows& picture, std::int32_t width, std::int32_t height,
                 std::uint32_t value, bool past_caches) {
    const I values = set(std::int32_t(value));
    for (std::int32_t y = 0; y < height; ++y) {
        std::uint32_t* p = picture.first + std::size_t(y) * picture.stride;
        std::uint32_t* const end = p + width;
        if (past_caches) {
            while (p != end && reinterpret_cast<std::uintptr_t>(p) % (vector_size * sizeof *p) != 0)
                *p++ = value;
            for (; end - p >= lane_count; p += vector_size) stream(values, p);
        } else {
            for (; end - p >= lane_count; p += vector_size) store(values, p);
        }
        while (p != end) *p++ = value;
    }
    if (past_caches) stream_end();
}
