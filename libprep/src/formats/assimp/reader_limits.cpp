#include "formats/assimp/reader_limits.h"

#include <algorithm>
#include <charconv>

namespace prep::detail {
namespace {

constexpr std::string_view blanks = " \t\r\n";

// Whether `name` is given `value` (empty: any) in some element.
bool has_attribute(std::string_view xml, std::string_view name, std::string_view value) {
    for (std::size_t at = xml.find(name); at != std::string_view::npos;
         at = xml.find(name, at + 1)) {
        if (at == 0 || blanks.find(xml[at - 1]) == std::string_view::npos) continue;
        std::string_view rest = xml.substr(at + name.size());
        rest.remove_prefix(std::min(rest.find_first_not_of(blanks), rest.size()));
        if (!rest.starts_with('=')) continue;
        rest.remove_prefix(1);
        rest.remove_prefix(std::min(rest.find_first_not_of(blanks), rest.size()));
        if (rest.empty() || (rest[0] != '"' && rest[0] != '\'')) continue;
        if (value.empty() || rest.substr(1).starts_with(std::string(value) + rest[0])) return true;
    }
    return false;
}

}  // namespace

std::string without_comments(std::string_view xml) {
    std::string out;
    for (;;) {
        const std::size_t begin = xml.find("<!--");
        out += xml.substr(0, begin);
        if (begin == std::string_view::npos) return out;
        const std::size_t end = xml.find("-->", begin + 4);
        if (end == std::string_view::npos) return out;
        xml.remove_prefix(end + 3);
    }
}

bool has_element(std::string_view xml, std::string_view name) {
    const std::string begin = '<' + std::string(name);
    for (std::size_t at = xml.find(begin); at != std::string_view::npos;
         at = xml.find(begin, at + 1)) {
        const std::size_t end = at + begin.size();
        if (end < xml.size() &&
            (blanks.find(xml[end]) != std::string_view::npos || xml[end] == '>' || xml[end] == '/'))
            return true;
    }
    return false;
}

std::uint64_t misplaced_dxf_inserts(std::string_view text) {
    std::uint64_t count = 0;
    bool in_insert = false, misplaced = false;
    const auto line = [&] {
        const std::size_t end = std::min(text.find('\n'), text.size());
        std::string_view out = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        out.remove_prefix(std::min(out.find_first_not_of(blanks), out.size()));
        return out.substr(0, out.find_last_not_of(blanks) + 1);
    };
    // A group is two lines: its code, and its value.
    while (!text.empty()) {
        const std::string_view code = line(), value = line();
        if (code == "0") {
            count += in_insert && misplaced;
            in_insert = value == "INSERT";
            misplaced = false;
            continue;
        }
        double number = 0;
        if (!in_insert ||
            std::from_chars(value.data(), value.data() + value.size(), number).ec != std::errc())
            continue;
        const bool scale = code == "41" || code == "42" || code == "43";
        misplaced |= (scale && number != 1) || (code == "50" && number != 0);
    }
    return count + (in_insert && misplaced);
}

std::vector<std::string> misread_statements(std::string_view ending, std::string_view xml) {
    // Each was seen with a file that has it and little else.
    std::vector<std::string> out;
    if (ending == ".x3d") {
        if (has_element(xml, "IndexedLineSet"))
            out.emplace_back("Assimp reads the lines of IndexedLineSet as faces");
        if (has_attribute(xml, "ccw", "false"))
            out.emplace_back("Assimp does not turn the faces of ccw=\"false\"");
        if (has_attribute(xml, "colorPerVertex", "false") || has_attribute(xml, "colorIndex", ""))
            out.emplace_back(
                "Assimp gives colours of faces, or by colorIndex, to other corners than the file");
        if (has_element(xml, "LOD")) out.emplace_back("Assimp leaves out what LOD holds");
    }
    if (ending == ".amf") {
        if (has_element(xml, "rx") || has_element(xml, "ry") || has_element(xml, "rz"))
            out.emplace_back("Assimp reads rotations of instances as translations");
        if (has_element(xml, "normal")) out.emplace_back("Assimp reads no normals of AMF files");
        if (has_element(xml, "edge"))
            out.emplace_back("Assimp reads the curved edges of AMF files as straight ones");
    }
    return out;
}

}  // namespace prep::detail
