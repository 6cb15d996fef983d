// Names for a report, each once: a file of nonsense must not flood it, nor fill the memory. A dozen
// fit a few lines of a terminal. Names that begin with the same 64 bytes count as one.
#pragma once

#include <algorithm>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace prep::detail {

class NameList {
  public:
    void add(std::string_view name) {
        constexpr std::size_t most_shown = 12, longest = 32;
        if (seen_.size() >= most_kept || !seen_.emplace(name.substr(0, 2 * longest)).second) return;
        const bool plain = std::all_of(name.begin(), name.end(), [](char c) {
            return static_cast<unsigned char>(c) >= 32 && c != 127;
        });
        if (plain && name.size() <= longest && shown_.size() < most_shown)
            shown_.emplace_back(name);
    }

    bool empty() const { return seen_.empty(); }

    // "a, b and 3 more"
    std::string text() const {
        std::string all;
        for (const std::string& name : shown_) all += (all.empty() ? "" : ", ") + name;
        const std::size_t rest = seen_.size() - shown_.size();
        if (rest == 0) return all;
        const std::string more =
            all.empty() ? " with names that are long or no plain text" : " more";
        return all + (all.empty() ? "" : " and ") + (seen_.size() < most_kept ? "" : "at least ") +
               std::to_string(rest) + more;
    }

  private:
    static constexpr std::size_t most_kept = 1000;
    std::set<std::string> seen_;
    std::vector<std::string> shown_;
};

}  // namespace prep::detail
