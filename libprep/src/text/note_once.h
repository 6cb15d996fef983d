#pragma once

#include <algorithm>
#include <string>
#include <vector>

namespace prep::detail {

// Adds a remark that is not there yet.
inline void note_once(std::vector<std::string>& notes, const std::string& text) {
    if (std::find(notes.begin(), notes.end(), text) == notes.end()) notes.push_back(text);
}

}  // namespace prep::detail
