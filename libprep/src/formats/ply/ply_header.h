// The header of a PLY file (Turk 1994).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "prep/result.h"

namespace prep::detail {

enum class PlyEncoding : std::uint8_t { ascii, little, big };
enum class PlyType : std::uint8_t { i8, u8, i16, u16, i32, u32, f32, f64 };

inline std::size_t size_of(PlyType type) {
    constexpr std::size_t sizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
    return sizes[std::size_t(type)];
}

inline bool is_integer(PlyType type) {
    return type != PlyType::f32 && type != PlyType::f64;
}

struct PlyProperty {
    std::string name;
    PlyType type = PlyType::f32, count_type = PlyType::u8;  // count_type is an integer
    bool list = false;
};

struct PlyElement {
    std::string name;
    std::uint64_t count = 0;
    std::vector<PlyProperty> properties;
};

struct PlyHeader {
    PlyEncoding encoding = PlyEncoding::ascii;
    std::vector<PlyElement> elements;
    std::vector<std::string> textures;  // of the lines "comment TextureFile NAME"
    std::size_t size = 0;               // bytes up to and with the line end after end_header
};

Result<PlyHeader> read_ply_header(std::span<const std::byte> bytes, const std::string& name);

}  // namespace prep::detail
