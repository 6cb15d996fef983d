// Chosen lanes, one after the other.
// Included once per instruction set, inside its namespace.

#if HWY_TARGET == HWY_AVX2
// Of each mask of eight lanes the numbers of its lanes, ascending, in four bits each from the
// lowest on.
struct CompressedLanes {
    std::uint32_t of[256] = {};

    constexpr CompressedLanes() {
        for (std::uint32_t mask = 0; mask < 256; ++mask)
            for (std::uint32_t lane = 0, found = 0; lane < 8; ++lane)
                if (mask >> lane & 1u) of[mask] |= lane << 4 * found++;
    }
};
inline constexpr CompressedLanes compressed_lanes;
#endif

// Stores the lanes of a mask to `to` and returns how many they are. All lanes of the vector are
// written, whatever those past the chosen ones hold: AMD's Zen 4 takes some hundred cycles to
// compress into memory (vpcompressd), four into a register.
template <class Tag>
HWY_INLINE std::size_t compress_store(Tag d, hn::Vec<Tag> values, hn::Mask<Tag> mask,
                                      hn::TFromD<Tag>* to) {
#if HWY_TARGET == HWY_AVX2
    // hn::Compress has a table in the function, all of which GCC copies to the stack at each call.
    static_assert(sizeof(hn::TFromD<Tag>) == 4);
    const hn::Repartition<std::uint32_t, Tag> words;
    const hn::Repartition<float, Tag> floats;
    const auto bits =
        std::uint32_t(_mm256_movemask_ps(hn::BitCast(floats, hn::VecFromMask(d, mask)).raw));
    const auto lanes =
        hn::Shr(hn::Set(words, compressed_lanes.of[bits]), hn::ShiftLeft<2>(hn::Iota(words, 0)));
    const auto chosen = hn::BitCast(words, values);
    hn::StoreU(hn::BitCast(
                   d, hn::Vec<decltype(words)>{_mm256_permutevar8x32_epi32(chosen.raw, lanes.raw)}),
               d, to);
    return std::size_t(__builtin_popcount(bits));
#else
    hn::StoreU(hn::Compress(values, mask), d, to);
    return hn::CountTrue(d, mask);
#endif
}
