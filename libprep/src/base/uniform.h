// Whether all elements of a list are the same.
#pragma once

#include <cstring>
#include <span>
#include <type_traits>

namespace prep::detail {

// The list and itself from the second element on, byte by byte: at the speed of memory.
template <class T>
requires std::has_unique_object_representations_v<T>
bool is_uniform(std::span<const T> list) {
    return list.size() < 2 ||
           std::memcmp(list.data(), list.data() + 1, (list.size() - 1) * sizeof(T)) == 0;
}

}  // namespace prep::detail
