// What is left out in every way of drawing: the table of docs/architecture.md, which the tests of
// its cells read as well.
#pragma once

#include <string>

namespace test {

struct SkippedThing {
    const char *code, *words;
    // Instead of "same", or of "≤ X" where the code is one of a bound.
    const char *exact_areas = nullptr, *bytes = nullptr, *gouraud = nullptr;
};
inline constexpr SkippedThing skipped_things[] = {
    {"light_black", "light that is black"},
    {"light_range", "light out of its range"},
    {"light_cone", "light whose cone is elsewhere"},
    {"light_behind", "light behind every normal"},
    {"highlights_zero", "highlights of colour 0", nullptr, nullptr, "not left out"},
    {"map_times_zero", "map that multiplies 0"},
    {"normal_map_flat", "normal map of (0, 0, 1)", nullptr, nullptr, "not read"},
    {"bump_map_flat", "bump map of strength 0", nullptr, nullptr, "not read"},
    {"mask_never_cuts", "alpha mask that never cuts"},
    {"light_faint", "light that is too faint, `--allow-error`", nullptr, "≤ X, to the next step"},
    {"samples_inside", "samples inside one triangle", "no samples"},
};

// Of the table, by the name of a way of drawing.
inline std::string cell_of(const SkippedThing& thing, const std::string& way, bool bounded) {
    const char* const other = way == "exact areas" ? thing.exact_areas
                              : way == "bytes"     ? thing.bytes
                              : way == "Gouraud"   ? thing.gouraud
                                                   : nullptr;
    return other != nullptr ? other : bounded ? "≤ X" : "same";
}

// Whether there is something to be left out.
inline bool is_there(const std::string& code, const std::string& way) {
    for (const SkippedThing& thing : skipped_things)
        if (thing.code == code) return cell_of(thing, way, false) == "same";
    return false;
}

}  // namespace test
