#include "formats/assimp/texts/utf16.h"

#include <cstdint>

namespace prep::detail {
namespace {

void append_utf8(std::uint32_t c, std::string& to) {
    const auto tail = [&](int shift) { to += char(0x80 | ((c >> shift) & 0x3f)); };
    if (c < 0x80) {
        to += char(c);
    } else if (c < 0x800) {
        to += char(0xc0 | (c >> 6));
        tail(0);
    } else if (c < 0x10000) {
        to += char(0xe0 | (c >> 12));
        tail(6);
        tail(0);
    } else {
        to += char(0xf0 | (c >> 18));
        tail(12);
        tail(6);
        tail(0);
    }
}

}  // namespace

std::optional<std::string> utf8_of_utf16(std::span<const std::byte> bytes) {
    if (bytes.size() < 2) return std::nullopt;
    const auto starts = [&](unsigned a, unsigned b) {
        return bytes[0] == std::byte(a) && bytes[1] == std::byte(b);
    };
    const bool mark = starts(0xff, 0xfe) || starts(0xfe, 0xff);
    const bool little = starts(0xff, 0xfe) || starts('<', 0);
    if (!mark && !starts('<', 0) && !starts(0, '<')) return std::nullopt;
    const auto unit = [&](std::size_t i) {
        const auto a = std::to_integer<std::uint32_t>(bytes[i]);
        const auto b = std::to_integer<std::uint32_t>(bytes[i + 1]);
        return little ? a | (b << 8) : b | (a << 8);
    };
    constexpr std::uint32_t unknown = 0xfffd;
    std::string text;
    text.reserve(bytes.size() / 2);
    for (std::size_t i = mark ? 2 : 0; i + 1 < bytes.size(); i += 2) {
        std::uint32_t c = unit(i);
        if (c >= 0xd800 && c < 0xdc00 && i + 3 < bytes.size() && unit(i + 2) >= 0xdc00 &&
            unit(i + 2) < 0xe000) {
            c = 0x10000 + ((c - 0xd800) << 10) + (unit(i + 2) - 0xdc00);
            i += 2;
        } else if (c >= 0xd800 && c < 0xe000) {
            c = unknown;
        }
        append_utf8(c, text);
    }
    return text;
}

}  // namespace prep::detail
