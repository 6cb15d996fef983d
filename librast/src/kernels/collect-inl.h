// Which triangles a tile's pixels show, as runs.
// Included once per instruction set, inside the namespace that has its lanes.

inline std::size_t collect(const std::uint32_t* numbers, const TilePlace& place,
                           std::uint32_t* counts, PixelRun* runs, const PictureRows& picture) {
    constexpr std::int32_t pixels_a_line = 16;
    std::size_t found = 0;
    static_assert(tile_padding > 0);  // the last row's last pixel is compared with one behind it
    for (std::int32_t y = 0; y < place.height; ++y) {
        const std::uint32_t* row = numbers + y * tile_size;
        for (std::int32_t x = 0; picture.first != nullptr && x < place.width; x += pixels_a_line)
            __builtin_prefetch(picture.first + std::size_t(y) * picture.stride + x, 1);
        std::uint64_t ends = 0;
        std::uint32_t any_drawn = 0;
        for (std::int32_t x = 0; x < tile_size; x += lane_count) {
            const I here = load(row + x);
            ends |= std::uint64_t(bits_of(!(here == load(row + x + 1)))) << x;
            any_drawn |= bits_of(here > set(-1));
        }
        std::uint64_t starts = ends << 1 | 1;
        if (any_drawn == 0) continue;
        if (place.width < tile_size) starts &= (std::uint64_t(1) << place.width) - 1;
        while (starts != 0) {
            const int x = __builtin_ctzll(starts);
            starts &= starts - 1;
            const int end = starts != 0 ? __builtin_ctzll(starts) : place.width;
            if (row[x] == id_none) continue;
            runs[found++] = {row[x], std::uint16_t(y * tile_size + x), std::uint16_t(end - x)};
            counts[row[x]] += std::uint32_t(end - x);
        }
    }
    return found;
}

inline void expand(const PixelRun* runs, std::size_t count, std::uint32_t* counts,
                   std::uint16_t* pixels) {
    for (std::size_t r = 0; r < count; ++r) {
        const PixelRun& run = runs[r];
        store_sequence(run.pixel, run.length, pixels + counts[run.number]);
        counts[run.number] += run.length;
    }
}
