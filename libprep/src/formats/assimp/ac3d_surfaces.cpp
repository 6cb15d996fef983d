#include "formats/assimp/ac3d_surfaces.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <vector>

#include "formats/assimp/import.h"
#include "prep/files.h"
#include "text/scan.h"

namespace prep::detail {
namespace {

// In quotation marks, or a word without.
std::string_view name_in(LineScanner& line) {
    line.skip_blanks();
    if (line.peek() != '"') return line.word();
    line.advance();
    const std::string_view rest = line.rest();
    return rest.substr(0, rest.find('"'));
}

std::optional<std::size_t> number_in(std::string_view word, int base) {
    std::size_t value = 0;
    const auto end = std::from_chars(word.data(), word.data() + word.size(), value, base);
    return end.ec == std::errc() ? std::optional(value) : std::nullopt;
}

}  // namespace

std::set<std::string> two_sided_ac3d_materials(std::string_view text) {
    constexpr std::size_t two_sided = 0x20;
    std::vector<std::string_view> names;
    std::set<std::string> found;
    bool both = false;  // of the surface that the lines are in
    while (!text.empty()) {
        const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
        LineScanner line(text.substr(0, end));
        text.remove_prefix(std::min(end + 1, text.size()));
        const std::string_view word = line.word();
        if (word == "MATERIAL") {
            names.push_back(name_in(line));
        } else if (word == "SURF") {
            std::string_view flags = line.word();
            if (flags.starts_with("0x") || flags.starts_with("0X")) flags.remove_prefix(2);
            both = (number_in(flags, 16).value_or(0) & two_sided) != 0;
        } else if (word == "mat" && both) {
            const std::optional<std::size_t> material = number_in(line.word(), 10);
            if (material && *material < names.size()) found.emplace(names[*material]);
        }
    }
    return found;
}

void import_sides(AssimpImport& import) {
    if (!import.is_by("AC3D")) return;
    const auto bytes = read_file(import.path);
    if (!bytes) return;
    const auto names =
        two_sided_ac3d_materials({reinterpret_cast<const char*>(bytes->data()), bytes->size()});
    for (Material& material : import.scene.materials)
        if (names.contains(material.name)) material.double_sided = true;
}

}  // namespace prep::detail
