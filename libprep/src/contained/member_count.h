// How many members an aggregate has, told by the compiler: what lists the members of a struct can
// be held to it.
#pragma once

#include <cstddef>
#include <utility>

namespace prep::detail {

struct AnyValue {
    template <class T>
    operator T() const;
};

template <class T, std::size_t... I>
constexpr bool takes(std::index_sequence<I...>) {
    return requires {
        T{(static_cast<void>(I), AnyValue{})...};
    };
}

// Members without arrays among them, up to 64.
template <class T, std::size_t N = 64>
constexpr std::size_t member_count() {
    if constexpr (takes<T>(std::make_index_sequence<N>{}))
        return N;
    else
        return N == 0 ? 0 : member_count<T, N - 1>();
}

}  // namespace prep::detail
