// Large arrays on huge pages. A mesh of a million triangles goes through some hundreds of megabytes
// of arrays; with pages of 4 kB a quarter of the command's processor time is page faults. Where the
// system leaves the choice to the program (/sys/kernel/mm/transparent_hugepage/enabled: madvise,
// the usual default), nobody makes it but the program.
//
// Sanitizers bring allocators of their own.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define MESHPREP_OWN_NEW 0
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || \
    __has_feature(memory_sanitizer)
#define MESHPREP_OWN_NEW 0
#endif
#endif
#if !defined(MESHPREP_OWN_NEW) && defined(__linux__)
#define MESHPREP_OWN_NEW 1
#endif

#if MESHPREP_OWN_NEW
#include <sys/mman.h>

#include <cstdint>
#include <cstdlib>
#include <new>

namespace {

constexpr std::size_t huge_page = std::size_t{1} << 21;
// Below four pages what is lost at the end of the last one is no longer small beside the block.
constexpr std::size_t large = 4 * huge_page;

void* allocate(std::size_t size) {
    if (size < large || size > SIZE_MAX - huge_page) return std::malloc(size ? size : 1);
    const std::size_t whole = (size + huge_page - 1) / huge_page * huge_page;
    void* const block = std::aligned_alloc(huge_page, whole);
    if (block) madvise(block, whole, MADV_HUGEPAGE);  // a wish: its failure changes nothing
    return block;
}

}  // namespace

// The other forms of new and delete that the standard library brings call these two.
void* operator new(std::size_t size) {
    for (;;) {
        if (void* const block = allocate(size)) return block;
        const std::new_handler handler = std::get_new_handler();
        if (!handler) throw std::bad_alloc();
        handler();
    }
}

void operator delete(void* block) noexcept {
    std::free(block);
}

void operator delete(void* block, std::size_t) noexcept {
    std::free(block);
}
#endif
