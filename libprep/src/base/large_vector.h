// Vectors that grow to many megabytes, in large pages where the system has them: passes over them
// in no order miss fewer addresses. They grow as vectors do, the old numbers held while the new
// ones are filled; from 2 MB on each begins a page of its own.
#pragma once

#include <algorithm>
#include <cstddef>
#include <new>
#include <vector>

#include "base/scratch_buffer.h"

namespace prep::detail {

template <class T>
struct LargePages {
    using value_type = T;
    LargePages() = default;
    template <class U>
    LargePages(const LargePages<U>&) {}

    T* allocate(std::size_t count) {
        const std::size_t bytes = count * sizeof(T);
        void* const block = ::operator new(bytes, alignment(bytes));
        if (bytes >= large_page) advise_large_pages(block, bytes);
        return static_cast<T*>(block);
    }
    void deallocate(T* block, std::size_t count) {
        ::operator delete(block, alignment(count * sizeof(T)));
    }
    bool operator==(const LargePages&) const { return true; }

  private:
    static std::align_val_t alignment(std::size_t bytes) {
        constexpr std::size_t small = std::max(alignof(T), alignof(std::max_align_t));
        return std::align_val_t(bytes >= large_page ? large_page : small);
    }
};

template <class T>
using LargeVector = std::vector<T, LargePages<T>>;

}  // namespace prep::detail
