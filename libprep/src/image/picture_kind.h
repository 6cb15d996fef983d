// Which format a picture is in, by its first bytes, and whether its decoder has stood the test of
// damaged files (tests/prep/image_damage_test.cpp, the fuzz targets): others may end the process.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <span>
#include <string_view>

namespace prep::detail {

// As many of a file's first bytes as are looked at.
inline constexpr std::size_t picture_head = 16;

inline bool starts_with(std::span<const std::byte> bytes, std::string_view magic,
                        std::size_t at = 0) {
    return bytes.size() >= at + magic.size() &&
           std::memcmp(bytes.data() + at, magic.data(), magic.size()) == 0;
}

inline bool is_png(std::span<const std::byte> bytes) {
    return starts_with(bytes, "\x89PNG");
}

inline bool is_jpeg(std::span<const std::byte> bytes) {
    return starts_with(bytes, "\xff\xd8\xff");
}

// An ending of the format; empty where the bytes do not tell (TGA has no such mark).
inline std::string_view picture_kind(std::span<const std::byte> bytes) {
    if (is_png(bytes)) return "png";
    if (is_jpeg(bytes)) return "jpg";
    if (starts_with(bytes, "\x76\x2f\x31\x01")) return "exr";
    if (starts_with(bytes, "#?")) return "hdr";
    if (starts_with(bytes, "GIF8")) return "gif";
    if (starts_with(bytes, "RIFF") && starts_with(bytes, "WEBP", 8)) return "webp";
    if (starts_with(bytes, "DDS ")) return "dds";
    if (starts_with(bytes, "BM")) return "bmp";
    if (starts_with(bytes, std::string_view("II*\0", 4)) ||
        starts_with(bytes, std::string_view("MM\0*", 4)))
        return "tif";
    return {};
}

// Basis Universal, which nothing here decodes.
inline bool is_ktx2(std::span<const std::byte> bytes) {
    return starts_with(bytes, "\xabKTX 20\xbb");
}

// The ending of a format whose decoder may run in the caller's process; empty: it must not.
// `ending`: that of the picture's name in lower case, with its dot.
inline std::string_view tried_picture(std::span<const std::byte> head, std::string_view ending) {
    const std::string_view kind = picture_kind(head);
    if (!kind.empty()) return kind == "dds" ? std::string_view() : kind;
    for (const std::string_view known : {".tga", ".ppm", ".pgm", ".pbm", ".pnm", ".pfm"})
        if (ending == known) return known.substr(1);
    return {};
}

}  // namespace prep::detail
