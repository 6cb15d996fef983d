// Values of options from their texts.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

namespace meshprep {

// "1,2.5" → numbers; empty when any piece is none, or not finite.
std::vector<double> parse_numbers(const std::string& text, char separator);

// One number, over 0 where it is to be `positive`; else a usage error.
double parse_number(const std::string& option, const std::string& text, bool positive = false);

// "uv,material" → its words, without an empty last one.
std::vector<std::string> parse_list(const std::string& text);

// "1280x720", both from 1 to `greatest`.
glm::uvec2 parse_size(const std::string& option, const std::string& text, std::uint32_t greatest);

// #rrggbb (sRGB), R,G,B or one grey (linear) → linear.
glm::vec3 parse_color(const std::string& option, const std::string& text);

}  // namespace meshprep
