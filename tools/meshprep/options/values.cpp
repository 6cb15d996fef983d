#include "meshprep/options/values.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>

#include "meshprep/options/option_set.h"
#include "prep/render_choices.h"

namespace meshprep {

std::vector<double> parse_numbers(const std::string& text, char separator) {
    std::vector<double> numbers;
    std::istringstream in(text);
    std::string item;
    while (std::getline(in, item, separator)) {
        char* end = nullptr;
        const double value = std::strtod(item.c_str(), &end);
        if (item.empty() || *end != '\0' || !std::isfinite(value)) return {};
        numbers.push_back(value);
    }
    if (!text.empty() && text.back() == separator) return {};
    return numbers;
}

double parse_number(const std::string& option, const std::string& text, bool positive) {
    const std::vector<double> numbers = parse_numbers(text, ',');
    if (numbers.size() != 1 || (positive && !(numbers[0] > 0)))
        usage_error(option, "'" + text + "' is not a number" + (positive ? " over 0" : ""));
    return numbers[0];
}

std::vector<std::string> parse_list(const std::string& text) {
    std::vector<std::string> words;
    std::istringstream in(text);
    std::string word;
    while (std::getline(in, word, ',')) words.push_back(word);
    if (!text.empty() && text.back() == ',')
        words.emplace_back();  // an empty word, which nobody knows
    return words;
}

glm::uvec2 parse_size(const std::string& option, const std::string& text, std::uint32_t greatest) {
    const std::vector<double> n = parse_numbers(text, 'x');
    if (n.size() != 2 || n[0] != std::floor(n[0]) || n[1] != std::floor(n[1]) ||
        std::min(n[0], n[1]) < 1 || std::max(n[0], n[1]) > greatest)
        usage_error(option, "'" + text + "' is not a size such as 1280x720, up to " +
                                std::to_string(greatest) + "x" + std::to_string(greatest));
    return {std::uint32_t(n[0]), std::uint32_t(n[1])};
}

glm::vec3 parse_color(const std::string& option, const std::string& text) {
    if (const std::optional<glm::vec3> color = prep::color_from_hex(text)) return *color;
    std::vector<double> numbers = parse_numbers(text, ',');
    if (numbers.size() == 1) numbers.assign(3, numbers[0]);
    if (numbers.size() != 3)
        usage_error(option, "'" + text +
                                "' is not a colour; give #rrggbb, or linear R,G,B such as 1,0.5,0");
    for (const double n : numbers)
        if (n < 0 || n > 1e6)
            usage_error(option, "'" + text + "' has a component outside 0 to 1e6");
    return {numbers[0], numbers[1], numbers[2]};
}

}  // namespace meshprep
