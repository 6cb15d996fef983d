// Chosen lanes, one after the other.
// Included once per instruction set, inside its namespace.

#if HWY_TARGET == HWY_AVX2
// Of each mask of eight lanes the numbers of its lanes, ascending, four bits each.
struct ChosenLanes {
    std::uint32_t of[256] = {};

    constexpr ChosenLanes() {
        for (std::uint32_t mask = 0; mask < 256; ++mask)
            for (std::uint32_t lane = 0, found = 0; lane < 8; ++lane)
                if (mask >> lane & 1u) of[mask] |= lane << 4 * found++;
    }
};
inline constexpr ChosenLanes chosen_lanes;
#endif

// Stores the lanes of a mask, of 32 bits each, to `to` and returns how many they are. All lanes of
// the vector are written, whatever those past the chosen ones hold: AMD's Zen 4 takes some hundred
// cycles to compress into memory (vpcompressd), four into a register.
template <class Tag>
HWY_INLINE std::size_t compress_store(Tag d, hn::Vec<Tag> values, hn::Mask<Tag> mask,
                                      hn::TFromD<Tag>* to) {
    static_assert(sizeof(hn::TFromD<Tag>) == 4);
#if HWY_TARGET == HWY_AVX2
    // hn::Compress has its table in the function, and GCC copies all 1,024 bytes at each call.
    const hn::Repartition<std::uint32_t, Tag> words;
    const hn::Repartition<float, Tag> floats;
    const auto bits =
        std::uint32_t(_mm256_movemask_ps(hn::BitCast(floats, hn::VecFromMask(d, mask)).raw));
    const auto order =
        hn::Shr(hn::Set(words, chosen_lanes.of[bits]), hn::ShiftLeft<2>(hn::Iota(words, 0)));
    const hn::Vec<decltype(words)> first{
        _mm256_permutevar8x32_epi32(hn::BitCast(words, values).raw, order.raw)};
    hn::StoreU(hn::BitCast(d, first), d, to);
    return std::size_t(__builtin_popcount(bits));
#else
    hn::StoreU(hn::Compress(values, mask), d, to);
    return hn::CountTrue(d, mask);
#endif
}
