// Chosen lanes, one after the other.
// Included once per instruction set, inside its namespace.

// Stores the lanes of a mask to `to` and returns how many they are. All lanes of the vector are
// written: AMD's Zen 4 takes some hundred cycles to compress into memory (vpcompressd), four into a
// register.
template <class Tag>
HWY_INLINE std::size_t compress_store(Tag d, hn::Vec<Tag> values, hn::Mask<Tag> mask,
                                      hn::TFromD<Tag>* to) {
    hn::StoreU(hn::Compress(values, mask), d, to);
    return hn::CountTrue(d, mask);
}
