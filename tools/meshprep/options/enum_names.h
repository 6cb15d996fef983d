// Lists of words that stand for values.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace meshprep {

template <class Value>
using Words = std::vector<std::pair<std::string, Value>>;

// The value of a word that is one of the list's; the first value where it is none.
template <class Value>
Value value_of(const Words<Value>& words, const std::string& text) {
    for (const auto& [word, value] : words)
        if (word == text) return value;
    return words.front().second;
}

// The word of a value that is one of the list's.
template <class Value>
const std::string& word_of(const Words<Value>& words, Value value) {
    for (const auto& entry : words)
        if (entry.second == value) return entry.first;
    return words.front().first;
}

}  // namespace meshprep
