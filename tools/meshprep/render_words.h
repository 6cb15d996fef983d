// The words for what a renderer can be asked for, on the command line and in scene files.
#pragma once

#include "meshprep/argument_words.h"
#include "rast/render.h"

namespace meshprep {

const Words<rast::Shading>& shading_words();
const Words<rast::Cull>& cull_words();
const Words<rast::TextureFilter>& filter_words();
const Words<rast::Coverage>& coverage_words();
const Words<Buffer>& buffer_words();

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
