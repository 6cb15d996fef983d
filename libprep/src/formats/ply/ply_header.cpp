#include "formats/ply/ply_header.h"

#include <optional>
#include <string_view>

#include "text/scan.h"

namespace prep::detail {
namespace {

std::optional<PlyType> type_named(std::string_view name) {
    static const std::pair<std::string_view, PlyType> names[] = {
        {"char", PlyType::i8},    {"int8", PlyType::i8},     {"uchar", PlyType::u8},
        {"uint8", PlyType::u8},   {"short", PlyType::i16},   {"int16", PlyType::i16},
        {"ushort", PlyType::u16}, {"uint16", PlyType::u16},  {"int", PlyType::i32},
        {"int32", PlyType::i32},  {"uint", PlyType::u32},    {"uint32", PlyType::u32},
        {"float", PlyType::f32},  {"float32", PlyType::f32}, {"double", PlyType::f64},
        {"float64", PlyType::f64}};
    for (const auto& [text, type] : names)
        if (text == name) return type;
    return std::nullopt;
}

}  // namespace

Result<PlyHeader> read_ply_header(std::span<const std::byte> bytes, const std::string& name) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    PlyHeader header;
    std::size_t line_number = 0;
    bool format = false;
    const auto fail = [&](const std::string& what, std::string_view line,
                          ErrorCode code = ErrorCode::syntax) {
        return Error{code, what + " in " + quoted_line(line),
                     name + ":" + std::to_string(line_number)};
    };
    std::size_t at = 0;
    while (at < text.size()) {
        const std::size_t end = text.find('\n', at);
        if (end == std::string_view::npos) break;
        const std::string_view line = text.substr(at, end - at);
        at = end + 1;
        ++line_number;
        LineScanner scan(line);
        const std::string_view word = scan.word();
        if (line_number == 1) {
            if (word != "ply") return fail("expected \"ply\": not a PLY file", line);
        } else if (word == "format") {
            const std::string_view kind = scan.word();
            if (kind == "ascii")
                header.encoding = PlyEncoding::ascii;
            else if (kind == "binary_little_endian")
                header.encoding = PlyEncoding::little;
            else if (kind == "binary_big_endian")
                header.encoding = PlyEncoding::big;
            else
                return fail("unknown format", line, ErrorCode::unsupported);
            format = true;
        } else if (word == "element") {
            PlyElement element;
            element.name = std::string(scan.word());
            std::int64_t count = -1;
            scan.skip_blanks();
            if (!scan.integer(count) || count < 0)
                return fail("expected a number of elements", line);
            element.count = std::uint64_t(count);
            header.elements.push_back(std::move(element));
        } else if (word == "property") {
            if (header.elements.empty()) return fail("a property before any element", line);
            PlyProperty property;
            std::string_view type = scan.word();
            if (type == "list") {
                property.list = true;
                const auto count_type = type_named(scan.word());
                if (!count_type || *count_type == PlyType::f32 || *count_type == PlyType::f64)
                    return fail("expected an integer type for the list's length", line);
                property.count_type = *count_type;
                type = scan.word();
            }
            const auto known = type_named(type);
            if (!known) return fail("unknown property type", line);
            property.type = *known;
            property.name = std::string(scan.word());
            header.elements.back().properties.push_back(std::move(property));
        } else if (word == "end_header") {
            if (!format) return fail("the header names no format", line);
            header.size = at;
            return header;
        } else if (word == "comment") {
            const bool names_texture = scan.word() == "TextureFile";
            const std::string_view file = scan.rest();
            if (names_texture && !file.empty()) header.textures.emplace_back(file);
        } else if (!word.empty() && word != "obj_info") {
            return fail("unknown header line", line);
        }
    }
    return Error{ErrorCode::syntax, "the header has no end_header: not a PLY file or cut short",
                 name + ":" + std::to_string(line_number)};
}

}  // namespace prep::detail
