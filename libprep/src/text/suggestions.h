// The nearest of a few known names to one that is not known, for error messages.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace prep::detail {

// The candidate with the smallest edit distance (Damerau's, adjacent swaps count one), if it is at
// most a third of the name's length rounded up; empty otherwise. The first wins a tie. Case does
// not count.
std::string nearest_name(std::string_view name, std::span<const std::string> candidates);

// "; did you mean 'NAME'?" or "; known: a, b, c" (at most 12 names) or nothing.
std::string suggestion(std::string_view name, std::span<const std::string> candidates);

}  // namespace prep::detail
