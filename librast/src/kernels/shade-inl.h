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
        const I at = load(pixels), row = shift_right<6>(at);
        scatter(packed, task.bytes, at + row * set(std::int32_t(task.stride) - tile_size));
        return;
    }
    std::uint32_t each[vector_size];
    store(packed, each);
    for (std::size_t k = 0; k < count; ++k) {
        const std::size_t p = pixels[k];
        task.bytes[p / tile_size * task.stride + p % tile_size] = each[k];
    }
}

inline void shade(const ShadeDraw& draw, const ShadeFrame& frame, const ShadeTask& task) {
    const bool lit = !draw.unlit && draw.vertex_light == nullptr && frame.light_count > 0;
    Wanted wanted;
    wanted.normals = lit;
    wanted.positions = lit && frame.needs_position;
    wanted.colors = draw.colors != nullptr;
    wanted.vertex_light = !draw.unlit && draw.vertex_light != nullptr;
    wanted.maps = draw.used_count > 0;
    const auto ask = [&](Points& points) {
        if (wanted.maps) ask_for(draw, map_group(draw, 0), points);
    };
    for_each_portion(draw, task, wanted, ask, [&](Points& points) {
        const std::size_t first = points.first;
        const std::uint16_t* const pixels = task.pixels + first;
        if (wanted.maps) read_maps(draw, points);
        if (lit) {
            finish_normals(draw, frame, task.place, pixels, points);
            find_eye(frame, task.place, pixels, points);
        }
        for (std::size_t l = 0; lit && l < frame.light_count; ++l) {
            add_light(frame, frame.lights[l], l == 0, points);
            find_exponents(draw, points);
            if (l + 1 == frame.light_count) break;  // the last one's highlights wait for the end
            for (std::size_t n = 0; n < points.held; n += vector_size)
                points.put3(gloss_with(draw, frame.lights[l], points, l == 0, n), Points::gloss, n);
        }
        for (std::size_t n = 0; n < points.held; n += vector_size) {
            const Reflection r = reflection_at(draw, frame, points, n);
            V3 color = r.base;
            if (lit)
                color = (color + r.lobe.diffuse * points.get3(Points::light, n)) +
                        r.lobe.specular * gloss_with(draw, frame.lights[frame.light_count - 1],
                                                     points, frame.light_count == 1, n);
            if (wanted.vertex_light)
                color = (color + r.lobe.diffuse * points.get3(Points::vertex_light, n)) +
                        r.lobe.specular * points.get3(Points::vertex_light + 3, n);
            if (task.bytes != nullptr) {
                write_bytes(color, pixels + n, points.held - n, task);
                continue;
            }
            store(color.x, task.out[0] + first + n);
            store(color.y, task.out[1] + first + n);
            store(color.z, task.out[2] + first + n);
        }
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
