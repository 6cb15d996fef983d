// How many there were of something, and what they are called.
#pragma once

#include <cstdint>
#include <string_view>

#include "text/name_list.h"

namespace prep::detail {

struct CountedNames {
    std::uint64_t count = 0;
    NameList names;
    void add(std::string_view name) {
        ++count;
        names.add(name);
    }
};

}  // namespace prep::detail
