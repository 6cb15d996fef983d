// Triangles that survived culling and have all their corners on the sub-pixel grid, set up in
// lanes. Included once per instruction set, inside the namespace that has its lanes.

inline void set_up(const SetupTask& task, SetupTriangle* out, TileBox* boxes) {
    static_assert(sizeof(SetupTriangle) == 12 * sizeof(std::int32_t));
    const Window& window = task.window;
    const std::int32_t low_bias = task.every_touched_pixel ? subpixels / 2 : subpixels - 1;
    const std::int32_t high_bias = task.every_touched_pixel ? subpixels / 2 : 0;
    const I zero = set(0);
    for (std::uint32_t first = 0; first < task.count; first += lane_count) {
        const std::uint32_t lanes = task.count - first < std::uint32_t(lane_count)
                                        ? task.count - first
                                        : std::uint32_t(lane_count);
        std::uint32_t indices[3 * lane_count];
        std::int32_t numbers[lane_count];
        for (std::uint32_t lane = 0; lane < std::uint32_t(lane_count); ++lane) {
            const std::uint32_t n = task.numbers[first + (lane < lanes ? lane : lanes - 1)];
            numbers[lane] = std::int32_t(n);
            for (std::uint32_t k = 0; k < 3; ++k)
                indices[lane * 3 + k] = task.indices[std::size_t(n) * 3 + k];
        }
        I x[3], y[3];
        F z[3];
        load_corners(task.records, indices, x, y, z);
        // Differences have 23 bits, products 46: exact in double. Twice the area in 1/256 pixels.
        const auto edge = [](I v, I from) { return to_double(v - from); };
        const D area = edge(x[1], x[0]) * edge(y[2], y[0]) - edge(y[1], y[0]) * edge(x[2], x[0]);
        const M turned = less(area, set_double(0.0)) > zero;
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
        const F dzdx = to_float((rise1 * y2 - rise2 * y1) * scale);
        const F dzdy = to_float((rise2 * x1 - rise1 * x2) * scale);
        const F z_low = min(min(z[0], z[1]), z[2]), z_high = max(max(z[0], z[1]), z[2]);
        // y points down on the screen: counter-clockwise in the world had to be turned.
        const I back = set(std::int32_t(id_back_face));
        const I side = task.mirrored ? select(turned, back, zero) : select(turned, zero, back);
        const I id = (load(numbers) + set(std::int32_t(task.first_id))) | side;

        std::int32_t words[3][4 * lane_count];
        store_interleaved4(x[0], x[1], x[2], y[0], words[0]);
        store_interleaved4(y[1], y[2], bits(z[0]), bits(dzdx), words[1]);
        store_interleaved4(bits(dzdy), bits(z_low), bits(z_high), id, words[2]);
        for (std::uint32_t lane = 0; lane < lanes; ++lane)
            for (int part = 0; part < 3; ++part)
                std::memcpy(reinterpret_cast<char*>(out + first + lane) + 16 * part,
                            words[part] + 4 * lane, 16);

        // Pixels whose centres, or any part, the triangle's box reaches; then their tiles.
        const auto range = [&](const I* v, std::int32_t start, std::int32_t extent) {
            const I low = min(min(v[0], v[1]), v[2]), high = max(max(v[0], v[1]), v[2]);
            const I from = max(shift_right<subpixel_bits>(low + set(low_bias - start)), zero);
            const I to =
                min(shift_right<subpixel_bits>(high + set(high_bias - start)), set(extent - 1));
            static_assert(tile_size == 64);
            return shift_right<6>(from) | shift_left<16>(shift_right<6>(to));
        };
        std::int32_t columns[lane_count], rows[lane_count];
        store(range(x, window.first_x, window.width), columns);
        store(range(y, window.first_y, window.height), rows);
        for (std::uint32_t lane = 0; lane < lanes; ++lane) {
            const std::uint32_t across = std::uint32_t(columns[lane]);
            const std::uint32_t down = std::uint32_t(rows[lane]);
            boxes[first + lane] = {std::uint16_t(across), std::uint16_t(across >> 16),
                                   std::uint16_t(down), std::uint16_t(down >> 16)};
        }
    }
}
