// The sheets' typeface: letters as strokes, drawn with round ends at any size.
//
// Made for this project. Grid: baseline y = 0, lower-case height 10, capitals 14, descenders −4; x
// from 0 to the glyph's width. Covers ASCII, a few signs of the field (° × ± µ · – — … → ≤ ≥ ² ³)
// and German and French accents by composition.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

namespace report {

struct GlyphPoint {
    float x = 0, y = 0;
};

struct Glyph {
    float width = 0;
    std::vector<std::vector<GlyphPoint>> strokes;  // polylines; one point alone is a dot
};

inline constexpr float font_capital_height = 14;
inline constexpr float font_lower_height = 10;
inline constexpr float font_descender = -4;
inline constexpr float font_letter_space = 3.4f;

// The glyph of a code point; a box where the font has none.
const Glyph& glyph(char32_t code);

// The next code point of UTF-8 text, which it takes off the front; U+FFFD for a broken sequence
// (one byte is taken).
char32_t next_code_point(std::string_view& utf8);

}  // namespace report
