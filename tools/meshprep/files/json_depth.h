// How deeply JSON is nested, asked before it is parsed: the parser copes with any depth, but
// copying, comparing and writing a value recurse, and would overflow the stack.
#pragma once

#include <string_view>

namespace meshprep {

// Whether objects and arrays stand in more than `most` others. What stands in texts counts for
// nothing. Text that is no JSON has some answer. O(n).
bool is_nested_deeper(std::string_view json, int most);

}  // namespace meshprep
