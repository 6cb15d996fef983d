// Which settings are worth their time: Pareto fronts of error against measured time.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace cost {

enum class Standing {
    front,      // nothing is as good and faster
    tied,       // another has less error, and their times cannot be told apart
    dominated,  // another is faster and has no more error
};
const char* word_for(Standing standing);

struct Verdict {
    Standing standing = Standing::front;
    std::size_t by = 0;  // tied or dominated: the setting that is better
};

// `errors` by setting (smaller is better), `seconds` by setting and round. One is faster than
// another where the 99 % interval of the ratio of their times (statistics.h) lies below 1: equal
// times are ties, whatever their medians. Of several that dominate, the one with the least error,
// then the first. An error that is not a number is dominated by every one that is and is faster,
// and tied with one whose time cannot be told from its own.
std::vector<Verdict> front(std::span<const double> errors,
                           std::span<const std::vector<double>> seconds);

}  // namespace cost
