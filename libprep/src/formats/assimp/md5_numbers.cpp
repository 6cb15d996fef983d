#include "formats/assimp/md5_numbers.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>

namespace prep::detail {
namespace {

constexpr std::array<std::string_view, 8> numbered = {
    "vert", "tri", "weight", "numverts", "numtris", "numweights", "numJoints", "numMeshes"};

std::string_view without_blanks(std::string_view line) {
    const std::size_t first = line.find_first_not_of(" \t\f\v");
    return first == std::string_view::npos ? std::string_view() : line.substr(first);
}

}  // namespace

std::optional<Md5Excess> md5_excess(std::string_view text) {
    const std::size_t most = text.size();
    for (std::size_t line = 1; !text.empty(); ++line) {
        const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
        const std::string_view statement = without_blanks(text.substr(0, end));
        const bool two = end + 1 < text.size() && text[end] == '\r' && text[end + 1] == '\n';
        text.remove_prefix(std::min(end + 1 + two, text.size()));

        const std::string_view word = statement.substr(0, statement.find_first_of(" \t\f\v"));
        if (std::find(numbered.begin(), numbered.end(), word) == numbered.end()) continue;
        const std::string_view number = without_blanks(statement.substr(word.size()));
        std::uint64_t value = 0;
        const auto [stop, failure] =
            std::from_chars(number.data(), number.data() + number.size(), value);
        const bool beyond =
            failure == std::errc::result_out_of_range || (failure == std::errc() && value > most);
        if (beyond)
            return Md5Excess{line, std::string(word) + ' ' + std::string(number.data(), stop)};
    }
    return std::nullopt;
}

}  // namespace prep::detail
