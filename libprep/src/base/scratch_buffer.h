// Memory for intermediate results: not initialised, and in large pages where the system has them.
#pragma once

#include <cstddef>
#include <memory>
#include <new>
#include <span>
#include <type_traits>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace prep::detail {

inline constexpr std::size_t large_page = std::size_t(2) << 20;

// Gives memory back (a vector that is assigned {} keeps it).
template <class Container>
void release(Container& container) {
    container = Container();
}

// Asks for large pages: a first touch then costs one fault per 2 MB instead of 512. Only advice.
inline void advise_large_pages([[maybe_unused]] void* begin, [[maybe_unused]] std::size_t bytes) {
#if defined(__linux__) && defined(MADV_HUGEPAGE)
    const auto address = reinterpret_cast<std::size_t>(begin);
    const std::size_t first = (address + large_page - 1) / large_page * large_page;
    const std::size_t last = (address + bytes) / large_page * large_page;
    if (first < last) madvise(reinterpret_cast<void*>(first), last - first, MADV_HUGEPAGE);
#endif
}

template <class T>
class ScratchBuffer {
    static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

  public:
    ScratchBuffer() = default;
    explicit ScratchBuffer(std::size_t size) : size_(size) {
        const std::size_t bytes = size * sizeof(T);
        const auto alignment = std::align_val_t(bytes >= large_page ? large_page : 64);
        data_ = {static_cast<T*>(::operator new(bytes, alignment)), Deleter{alignment}};
        if (bytes >= large_page) advise_large_pages(data_.get(), bytes);
    }

    std::size_t size() const { return size_; }
    bool empty() const { return size_ == 0; }
    T* data() { return data_.get(); }
    const T* data() const { return data_.get(); }
    T& operator[](std::size_t i) { return data_.get()[i]; }
    const T& operator[](std::size_t i) const { return data_.get()[i]; }
    operator std::span<T>() { return {data(), size_}; }
    operator std::span<const T>() const { return {data(), size_}; }

  private:
    struct Deleter {
        std::align_val_t alignment{64};
        void operator()(T* p) const { ::operator delete(p, alignment); }
    };
    std::unique_ptr<T, Deleter> data_;
    std::size_t size_ = 0;
};

}  // namespace prep::detail
