// Vectors out of blocks of four lanes. Not for vectors of one lane.
// Included once per instruction set, inside its namespace.

// A vector whose j-th block of four is load(j).
template <class Tag, class Load>
HWY_INLINE hn::Vec<Tag> in_blocks(Tag d, const Load& load) {
#if HWY_TARGET == HWY_AVX3
    const hn::Half<Tag> half;
    return hn::Combine(d, hn::Combine(half, load(3), load(2)), hn::Combine(half, load(1), load(0)));
#elif HWY_TARGET == HWY_AVX2
    return hn::Combine(d, load(1), load(0));
#else
    (void)d;
    return load(0);
#endif
}

// Blocks of four lanes of a, b, c and e are the rows of 4 × 4 matrices: their columns.
template <class Tag, class V>
HWY_INLINE void columns_of_blocks(Tag d, V a, V b, V c, V e, V* columns) {
    const hn::RepartitionToWide<Tag> pairs;
    const auto lower_ab = hn::BitCast(pairs, hn::InterleaveLower(d, a, b));
    const auto lower_ce = hn::BitCast(pairs, hn::InterleaveLower(d, c, e));
    const auto upper_ab = hn::BitCast(pairs, hn::InterleaveUpper(d, a, b));
    const auto upper_ce = hn::BitCast(pairs, hn::InterleaveUpper(d, c, e));
    columns[0] = hn::BitCast(d, hn::InterleaveLower(pairs, lower_ab, lower_ce));
    columns[1] = hn::BitCast(d, hn::InterleaveUpper(pairs, lower_ab, lower_ce));
    columns[2] = hn::BitCast(d, hn::InterleaveLower(pairs, upper_ab, upper_ce));
    columns[3] = hn::BitCast(d, hn::InterleaveUpper(pairs, upper_ab, upper_ce));
}
