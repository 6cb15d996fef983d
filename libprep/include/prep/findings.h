// Findings: what is odd in a mesh, how often, and where first. check() makes them, prepare() adds
// what its stages met, the command prints them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "prep/enum_names.h"

namespace prep {

enum class Severity : std::uint8_t { info, warning, error };
constexpr auto names_of(Severity) {
    return std::to_array<EnumName<Severity>>(
        {{"info", Severity::info}, {"warning", Severity::warning}, {"error", Severity::error}});
}

// What the numbers in Finding::places index.
enum class PlaceKind : std::uint8_t {
    face,
    vertex,
    edge,
    corner
};  // edge: the corner that starts it
constexpr auto names_of(PlaceKind) {
    return std::to_array<EnumName<PlaceKind>>({{"face", PlaceKind::face},
                                               {"vertex", PlaceKind::vertex},
                                               {"edge", PlaceKind::edge},
                                               {"corner", PlaceKind::corner}});
}

struct Finding {
    std::string kind;  // stable identifier in kebab-case: "degenerate-face", "mirrored-uv", …
    Severity severity = Severity::info;
    std::uint32_t mesh = 0;  // into Scene::meshes
    std::uint64_t count = 0;
    PlaceKind place_kind = PlaceKind::face;
    std::vector<std::uint32_t> places;  // the first ones, at most max_places, ascending
    std::string text;                   // one sentence for people; no count in it
    static constexpr std::size_t max_places = 8;
};

}  // namespace prep
