// OBJ, first half: the text cut into blocks of fixed size at line ends, each parsed on its own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "formats/obj/source.h"
#include "model/origin.h"
#include "prep/mesh.h"
#include "prep/result.h"

namespace prep::detail {

// An index as the file writes it: 1-based and absolute (positive), absent (0), or relative to what
// the block has read so far: −(local index + relative_bias), where the local index may be before
// the block's beginning.
using ObjIndex = std::int32_t;
inline constexpr std::int32_t relative_bias = 1 << 30;
inline constexpr std::int64_t max_obj_index = (std::int64_t(1) << 30) - 1;

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

// Faces, polylines or points. `t` and `n` are empty when no corner has any.
struct ObjElements {
    struct Run {  // from this element on, until the next run
        std::uint32_t element;
        std::uint32_t value;
    };
    std::vector<ObjIndex> v, t, n;
    std::vector<Run> sizes;  // corners of each element
    std::vector<Run> lines;  // line of the first; each of the others stands on the next line
    std::uint32_t count = 0;
    bool relative = false;  // whether any index is

    void close(std::uint32_t corners, std::uint32_t line) {
        if (sizes.empty() || sizes.back().value != corners) sizes.push_back({count, corners});
        if (lines.empty() || lines.back().value + (count - lines.back().element) != line)
            lines.push_back({count, line});
        ++count;
    }
    std::uint32_t line_of_corner(std::size_t corner) const;
};

inline constexpr glm::vec4 no_color{1, 1, 1, 0};  // those that are stated have an alpha of 1

// Something that is told once for a file, with how often it is there.
struct ObjOddity {
    std::uint32_t count = 0, first_line = 0;

    void note(std::uint32_t line) {
        if (count++ == 0) first_line = line;
    }
};

struct ObjBlock {
    std::vector<glm::vec3> positions;  // about the origin that parsing was given
    PositionBounds bounds;             // of the coordinates as written
    std::vector<glm::vec4> colors;     // empty, or one per position: no_color where it has none
    std::vector<glm::vec2> uvs;
    std::vector<glm::vec3> normals;
    ObjElements faces, polylines, points;
    std::vector<ObjEvent> events;
    std::vector<ObjTag> tags;
    std::uint32_t lines = 0;
    ObjOddity short_faces;  // fewer than three corners
    ObjOddity free_form, unknown, non_finite;
    std::string unknown_word;  // the first
    ObjOddity third_uvs;       // texture coordinates with a third, not 0
    ObjOddity loose_uvs;       // lines and points with texture coordinates,
    bool any_material = false;
    ObjOddity loose_materials, loose_before;  // behind the block's first usemtl, and before it

    struct Failure {
        std::uint32_t line;
        std::string text;
    };
    std::optional<Failure> failure;  // the first; parsing of the block ends there
};

// Cuts the text into blocks and parses each. The cuts depend on the text's size and line ends
// alone, never on the number of threads. Errors: io (`name` is the place).
Result<std::vector<ObjBlock>> parse_obj_blocks(const ObjSource& source, const std::string& name,
                                               int threads,
                                               const glm::dvec3& origin = glm::dvec3(0.0));

}  // namespace prep::detail
