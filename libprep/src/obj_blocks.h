// OBJ, first half: the text cut into blocks of fixed size at line ends, each parsed on its own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "prep/mesh.h"

namespace prep::detail {

// An index as the file writes it: 1-based and absolute (positive), absent (0), or relative to what
// the block has read so far: −(local index + relative_bias), where the local index may be before
// the block's beginning.
using ObjIndex = std::int32_t;
inline constexpr std::int32_t relative_bias = 1 << 30;
inline constexpr std::int64_t max_obj_index = (std::int64_t(1) << 30) - 1;

struct ObjCorner {
    ObjIndex v = 0, t = 0, n = 0;
};

struct ObjEvent {  // a change of state, before the block's face number `face`
    enum class Kind : std::uint8_t { material, group, object, smoothing, library };
    Kind kind;
    std::uint32_t face, line;
    std::string text;
    std::uint32_t number = 0;  // smoothing group
};

struct ObjTag {  // a subdivision tag line, read when all counts are known
    std::uint32_t line;
    std::string text;
};

struct ObjElements {  // faces or polylines
    std::vector<ObjCorner> corners;
    std::vector<std::uint32_t> ends;   // after each element's last corner
    std::vector<std::uint32_t> lines;  // where each stands, from 1 in this block
};

struct ObjBlock {
    std::vector<glm::dvec3> positions;
    std::vector<glm::vec4> colors;  // empty, or one per position (white where it has none)
    std::vector<glm::vec2> uvs;
    std::vector<glm::vec3> normals;
    ObjElements faces, polylines, points;
    std::vector<ObjEvent> events;
    std::vector<ObjTag> tags;
    std::uint32_t lines = 0;
    std::uint32_t short_faces = 0, short_face_line = 0;  // fewer than three corners
    std::uint32_t free_form = 0, free_form_line = 0;
    std::uint32_t unknown = 0, unknown_line = 0;
    std::string unknown_word;
    std::uint32_t non_finite = 0, non_finite_line = 0;

    struct Failure {
        std::uint32_t line;
        std::string text;
    };
    std::optional<Failure> failure;  // the first; parsing of the block ends there
};

// Block boundaries: a multiple of the block size moved to behind the next line end that no
// continuation joins. Never depends on the number of threads.
std::vector<std::size_t> obj_block_starts(std::string_view text);

ObjBlock parse_obj_block(std::string_view text);

}  // namespace prep::detail
