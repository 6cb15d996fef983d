// Large arrays from one range of huge pages that is used again and again. A mesh of a million
// triangles goes through some six hundred megabytes of arrays, of which two hundred are in use at
// once; were each taken from the system and given back, a quarter of the command's processor time
// would be page faults, and not the same quarter twice.
#include "meshprep/large_blocks.h"

#if MESHPREP_OWN_NEW
#include <malloc.h>
#include <sys/mman.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>

namespace {

using meshprep::LargeBlocks;

// The C library's own allocator has those below.
constexpr std::size_t large = std::size_t{1} << 16;
constexpr std::size_t range = std::size_t{1} << 40;
constexpr std::size_t kept_gaps = std::size_t{512} << 20;
// Without a range, from here on blocks are of huge pages each: below four pages what is lost at the
// end of the last one is no longer small beside the block.
constexpr std::size_t several_pages = 4 * LargeBlocks::huge_page;

// Never destroyed: blocks outlive main.
LargeBlocks& blocks() {
    alignas(LargeBlocks) static std::byte place[sizeof(LargeBlocks)];
    static LargeBlocks& all = *[] {
        auto* const made = new (place) LargeBlocks(range, kept_gaps);
        // Blocks of middle size stay with the program, too: the C library would give each back.
        if (made->is_ready()) {
            mallopt(M_MMAP_THRESHOLD, int(8 * large));
            mallopt(M_TRIM_THRESHOLD, int(kept_gaps));
        }
        return made;
    }();
    return all;
}

void* aligned(std::size_t size, std::size_t alignment) {
    if (size > SIZE_MAX - alignment) return nullptr;
    return std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
}

void* from_c_library(std::size_t size, std::size_t alignment) {
    if (!blocks().is_ready() && size >= several_pages && alignment <= LargeBlocks::huge_page) {
        void* const block = aligned(size, LargeBlocks::huge_page);
        if (block) madvise(block, size, MADV_HUGEPAGE);  // a wish
        return block;
    }
    return alignment == 0 ? std::malloc(size) : aligned(size, alignment);
}

// Alignment 0: the usual one.
void* allocate(std::size_t size, std::size_t alignment) {
    if (size == 0) size = 1;
    for (;;) {
        void* block = size >= large ? blocks().allocate(size, alignment) : nullptr;
        if (!block) block = from_c_library(size, alignment);
        if (block) return block;
        const std::new_handler handler = std::get_new_handler();
        if (!handler) throw std::bad_alloc();
        handler();
    }
}

void release(void* block) noexcept {
    if (block != nullptr && blocks().owns(block))
        blocks().release(block);
    else
        std::free(block);
}

}  // namespace

// The other forms of new and delete that the standard library brings call these.
void* operator new(std::size_t size) {
    return allocate(size, 0);
}

void* operator new(std::size_t size, std::align_val_t alignment) {
    return allocate(size, std::size_t(alignment));
}

void operator delete(void* block) noexcept {
    release(block);
}

void operator delete(void* block, std::size_t) noexcept {
    release(block);
}

void operator delete(void* block, std::align_val_t) noexcept {
    release(block);
}

void operator delete(void* block, std::size_t, std::align_val_t) noexcept {
    release(block);
}
#endif
