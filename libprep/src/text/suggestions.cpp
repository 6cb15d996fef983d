#include "text/suggestions.h"

#include <algorithm>
#include <vector>

#include "text/lower_case.h"

namespace prep::detail {
namespace {

std::size_t edit_distance(std::string_view a, std::string_view b) {
    const std::size_t n = b.size();
    std::vector<std::size_t> before(n + 1), last(n + 1), row(n + 1);
    for (std::size_t j = 0; j <= n; ++j) last[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        row[0] = i;
        for (std::size_t j = 1; j <= n; ++j) {
            const std::size_t change = lower_case(a[i - 1]) == lower_case(b[j - 1]) ? 0 : 1;
            row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + change});
            if (i > 1 && j > 1 && lower_case(a[i - 1]) == lower_case(b[j - 2]) &&
                lower_case(a[i - 2]) == lower_case(b[j - 1]))
                row[j] = std::min(row[j], before[j - 2] + 1);
        }
        std::swap(before, last);
        std::swap(last, row);
    }
    return last[n];
}

}  // namespace

std::string nearest_name(std::string_view name, std::span<const std::string> candidates) {
    // Names longer than this are no typing slips, and the distance is quadratic.
    constexpr std::size_t longest = 128;
    if (name.size() > longest) return {};
    std::string best;
    std::size_t best_distance = (name.size() + 2) / 3;
    for (const std::string& candidate : candidates) {
        if (candidate.size() > longest) continue;
        const std::size_t distance = edit_distance(name, candidate);
        if (distance < best_distance || (distance == best_distance && best.empty())) {
            best = candidate;
            best_distance = distance;
        }
    }
    return best;
}

std::string suggestion(std::string_view name, std::span<const std::string> candidates) {
    const std::string near = nearest_name(name, candidates);
    if (!near.empty()) return "; did you mean '" + near + "'?";
    if (candidates.empty()) return {};
    std::string text = "; known: ";
    constexpr std::size_t most = 12;
    for (std::size_t i = 0; i < candidates.size() && i < most; ++i)
        text += (i == 0 ? "" : ", ") + candidates[i];
    if (candidates.size() > most) text += ", …";
    return text;
}

}  // namespace prep::detail
