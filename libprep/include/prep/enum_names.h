// Words for the values of an enum. One table stands beside each enum that has them, as a function
// that is found by the enum's type:
//
//     enum class Cull : std::uint8_t { back, none };
//     constexpr auto names_of(Cull) {
//         return std::to_array<EnumName<Cull>>({{"back", Cull::back}, {"none", Cull::none}});
//     }
#pragma once

#include <array>
#include <cassert>
#include <string>
#include <string_view>

#include "prep/result.h"

namespace prep {

template <class E>
struct EnumName {
    std::string_view name;
    E value;
};

// A value without a name is a mistake of the caller.
template <class E>
constexpr std::string_view name_of(E value) {
    for (const auto& entry : names_of(value))
        if (entry.value == value) return entry.name;
    assert(false && "a value outside the enum's table of names");
    return {};
}

// "flat|gouraud|phong", with another text between the names where asked.
template <class E>
std::string names_text(std::string_view between = "|") {
    std::string text;
    for (const auto& entry : names_of(E{}))
        text.append(text.empty() ? std::string_view{} : between).append(entry.name);
    return text;
}

// The value of a name; a name that is not in the table is an error (invalid) that lists them.
template <class E>
Result<E> enum_named(std::string_view name) {
    for (const auto& entry : names_of(E{}))
        if (entry.name == name) return entry.value;
    return Error{ErrorCode::invalid, "'" + std::string(name) + "' is not one of " + names_text<E>(),
                 ""};
}

}  // namespace prep
