// Vectors out of blocks of four lanes.
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
