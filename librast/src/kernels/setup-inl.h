// Triangles that survived culling and have all their corners on the sub-pixel grid, set up in
// lanes. Included once per instruction set, inside the namespace that has its lanes.

inline void set_up(const SetupTask& task, SetupBlock& out) {
    static_assert(SetupBlock::capacity % lane_count == 0);
    std::uint32_t indices[3 * (SetupBlock::capacity + lane_count)];
    std::int32_t ids[SetupBlock::capacity + lane_count];
    std::uint32_t listed = 0;
    for (; listed < task.count; ++listed) {
        const std::uint32_t entry = task.entries[listed], number = entry & entry_number;
        ids[listed] =
            std::int32_t((task.first_id + number) | (entry & entry_back_face ? id_back_face : 0u));
        for (std::uint32_t k = 0; k < 3; ++k) {
            indices[listed * 3 + k] = task.indices[number * 3 + k];
        }
    }
    for (; listed % std::uint32_t(lane_count) != 0; ++listed) {  // lanes past the end
        ids[listed] = ids[0];
        for (std::uint32_t k = 0; k < 3; ++k) indices[listed * 3 + k] = indices[k];
    }

    for (std::uint32_t first = 0; first < task.count; first += std::uint32_t(lane_count)) {
        I x[3], y[3];
        F z[3];
        load_corners(task.records, indices + std::size_t(first) * 3, x, y, z);
        // Differences have 23 bits, products 46: exact in double. Twice the area in 1/256 pixels.
        const auto edge = [](I v, I from) { return to_double(v - from); };
        const D area = edge(x[1], x[0]) * edge(y[2], y[0]) - edge(y[1], y[0]) * edge(x[2], x[0]);
        const M turned = less(area, set_double(0.0)) > set(0);
        const auto turn = [&](auto* v) {
            const auto second = v[1];
            v[1] = select(turned, v[2], second);
            v[2] = select(turned, second, v[2]);
        };
        turn(x);
        turn(y);
        turn(z);
        const D x1 = edge(x[1], x[0]), y1 = edge(y[1], y[0]);
        const D x2 = edge(x[2], x[0]), y2 = edge(y[2], y[0]);
        const D d0 = to_double(z[0]);
        const D rise1 = to_double(z[1]) - d0, rise2 = to_double(z[2]) - d0;
        const D scale = set_double(double(subpixels)) / max(area, set_double(0.0) - area);
        for (int k = 0; k < 3; ++k) {
            store(x[k], out.x[k] + first);
            store(y[k], out.y[k] + first);
        }
        store(z[0], out.z0 + first);
        store(to_float((rise1 * y2 - rise2 * y1) * scale), out.dzdx + first);
        store(to_float((rise2 * x1 - rise1 * x2) * scale), out.dzdy + first);
        store(min(min(z[0], z[1]), z[2]), out.z_low + first);
        store(max(max(z[0], z[1]), z[2]), out.z_high + first);
        store(load(ids + first), out.id + first);
    }
}
