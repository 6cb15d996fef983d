#include "base/large_vector.h"

#include <cstdint>
#include <cstring>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace prep::detail {
namespace {

std::size_t whole_pages(std::size_t bytes) {
    return (bytes + large_page - 1) / large_page * large_page;
}

#if defined(__linux__)
// Addresses alone, from a multiple of large pages on.
std::byte* reserve_addresses(std::size_t bytes) {
    void* const all = mmap(nullptr, bytes + large_page, PROT_NONE,
                           MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (all == MAP_FAILED) throw std::bad_alloc();
    auto* const from = static_cast<std::byte*>(all);
    const std::size_t skipped =
        (large_page - reinterpret_cast<std::uintptr_t>(all) % large_page) % large_page;
    if (skipped > 0) munmap(from, skipped);
    if (skipped < large_page) munmap(from + skipped + bytes, large_page - skipped);
    return from + skipped;
}

std::byte* map_pages(std::size_t bytes) {
    std::byte* const at = reserve_addresses(bytes);
    if (mprotect(at, bytes, PROT_READ | PROT_WRITE) != 0) {
        munmap(at, bytes);
        throw std::bad_alloc();
    }
    advise_large_pages(at, bytes);
    return at;
}

std::byte* move_pages(std::byte* from, std::size_t old_bytes, std::size_t bytes) {
    std::byte* const at = reserve_addresses(bytes);
    if (mremap(from, old_bytes, bytes, MREMAP_MAYMOVE | MREMAP_FIXED, at) == MAP_FAILED) {
        munmap(at, bytes);
        throw std::bad_alloc();
    }
    advise_large_pages(at, bytes);
    return at;
}

void unmap_pages(std::byte* at, std::size_t bytes) {
    munmap(at, bytes);
}
#else
std::byte* map_pages(std::size_t bytes) {
    return static_cast<std::byte*>(::operator new(bytes));
}
void unmap_pages(std::byte* at, std::size_t) {
    ::operator delete(at);
}
std::byte* move_pages(std::byte* from, std::size_t old_bytes, std::size_t bytes) {
    std::byte* const at = map_pages(bytes);
    std::memcpy(at, from, old_bytes);
    unmap_pages(from, old_bytes);
    return at;
}
#endif

}  // namespace

void LargeBytes::grow(std::size_t size) {
    if (size <= size_) return;
    const bool was_large = size_ >= large_page;
    if (size < large_page) {
        auto* const grown = static_cast<std::byte*>(std::realloc(data_, size));
        if (!grown) throw std::bad_alloc();
        data_ = grown;
        size_ = size;
        return;
    }
    size = whole_pages(size);
    if (was_large) {
        data_ = move_pages(data_, size_, size);
    } else {
        std::byte* const pages = map_pages(size);
        if (size_ > 0) std::memcpy(pages, data_, size_);
        std::free(data_);
        data_ = pages;
    }
    size_ = size;
}

void LargeBytes::free() {
    if (size_ >= large_page)
        unmap_pages(data_, size_);
    else
        std::free(data_);
    data_ = nullptr;
    size_ = 0;
}

}  // namespace prep::detail
