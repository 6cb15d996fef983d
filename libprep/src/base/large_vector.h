// Vectors that grow to many megabytes, in large pages where the system has them: passes over them
// in no order miss fewer addresses. From 2 MB on, on Linux, growing moves pages and copies nothing,
// so that nothing is held twice and no page is cleared twice.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <new>
#include <type_traits>
#include <utility>

#include "base/scratch_buffer.h"

namespace prep::detail {

// Bytes that grow; new ones have any value.
class LargeBytes {
  public:
    LargeBytes() = default;
    ~LargeBytes() { free(); }
    LargeBytes(const LargeBytes&) = delete;
    LargeBytes& operator=(const LargeBytes&) = delete;
    LargeBytes(LargeBytes&& other) noexcept { swap(other); }
    LargeBytes& operator=(LargeBytes&& other) noexcept {
        swap(other);
        return *this;
    }

    std::byte* data() { return data_; }
    const std::byte* data() const { return data_; }
    std::size_t size() const { return size_; }
    // Keeps the first size() bytes. Throws bad_alloc, and is as it was then.
    void grow(std::size_t size);

  private:
    void free();
    void swap(LargeBytes& other) noexcept {
        std::swap(data_, other.data_);
        std::swap(size_, other.size_);
    }

    std::byte* data_ = nullptr;
    std::size_t size_ = 0;
};

template <class T>
class LargeVector {
    static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T> &&
                  alignof(T) <= alignof(std::max_align_t));

  public:
    LargeVector() = default;
    LargeVector(LargeVector&& other) noexcept { swap(other); }
    LargeVector& operator=(LargeVector&& other) noexcept {
        swap(other);
        return *this;
    }

    std::size_t size() const { return size_; }
    bool empty() const { return size_ == 0; }
    T* data() { return reinterpret_cast<T*>(bytes_.data()); }
    const T* data() const { return reinterpret_cast<const T*>(bytes_.data()); }
    T* begin() { return data(); }
    const T* begin() const { return data(); }
    T* end() { return data() + size_; }
    const T* end() const { return data() + size_; }
    T& operator[](std::size_t i) { return data()[i]; }
    const T& operator[](std::size_t i) const { return data()[i]; }

    T& emplace_back() {
        if ((size_ + 1) * sizeof(T) > bytes_.size()) reserve(size_ + 1);
        return *new (data() + size_++) T();
    }
    void push_back(const T& value) { emplace_back() = value; }
    // Memory stays.
    void clear() { size_ = 0; }
    // New elements are T().
    void resize(std::size_t size) {
        reserve(size);
        for (std::size_t i = size_; i < size; ++i) new (data() + i) T();
        size_ = size;
    }
    // New elements have any value: of passes that fill them on all threads.
    void resize_to_fill(std::size_t size) {
        reserve(size);
        size_ = size;
    }
    // At least twice what there was, so that growing one by one takes linear time.
    void reserve(std::size_t size) {
        if (size * sizeof(T) > bytes_.size())
            bytes_.grow(std::max(size * sizeof(T), 2 * bytes_.size()));
    }

  private:
    void swap(LargeVector& other) noexcept {
        std::swap(bytes_, other.bytes_);
        std::swap(size_, other.size_);
    }

    LargeBytes bytes_;
    std::size_t size_ = 0;
};

}  // namespace prep::detail
