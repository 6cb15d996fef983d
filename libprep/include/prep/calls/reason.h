// Why something is computed, drawn or left out, as data. The sentence that people read is made from
// it, so that both say the same.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "prep/calls/reason_code.h"
#include "prep/enum_names.h"
#include "prep/scene.h"

namespace prep {

enum class ReasonLabel : std::uint8_t {
    run,
    not_requested,  // nothing that there is, or that is asked for, reads it
    proved_zero,    // left out: the result is the same, to the bit
    bounded,        // left out, or standing in: the result differs by at most Reason::limit
    not_possible    // asked for and left out, since it cannot be done: what it needs is not there,
                    // or nothing here does it
};
constexpr auto names_of(ReasonLabel) {
    return std::to_array<EnumName<ReasonLabel>>({{"run", ReasonLabel::run},
                                                 {"not requested", ReasonLabel::not_requested},
                                                 {"proved zero", ReasonLabel::proved_zero},
                                                 {"bounded", ReasonLabel::bounded},
                                                 {"not possible", ReasonLabel::not_possible}});
}

// A row of the table: its key is for programs and stays, its words are for people.
struct ReasonRow {
    ReasonCode code;
    std::string_view key;
    ReasonLabel label;
    // {material}, {map}, {light}, {mesh}, {camera}: what the subject names; {value}, {limit}.
    std::string_view words;
};

struct Reason {
    ReasonCode code = ReasonCode::none;
    ReasonLabel label = ReasonLabel::not_requested;
    // JSON pointer into the Scene as it was loaded, by its lists and their numbers, which need not
    // be the file's: "/materials/2/normal_map"; empty: all of it, or what it has not, as its
    // default material ("/normal_map": of what is drawn in place of that). "light 2", without a
    // slash: a light of the plan that is not the scene's.
    std::string subject;
    // What was found, and what it is held against; 0 where there is no such figure.
    double value = 0, limit = 0;
    // The material that a picture draws in place of the subject's ("unnamed": it has no name);
    // empty: itself.
    std::string drawn_as = {};
};

// All reasons that there are, by code.
std::span<const ReasonRow> reason_rows();
// "normal_map_flat"
std::string_view name_of(ReasonCode code);
// With the label of its row.
Reason reason(ReasonCode code, std::string subject = {}, double value = 0, double limit = 0);
// "material 'brick' has a normal map". Things without a name are told by their number.
std::string sentence(const Reason& reason, const Scene& scene);

// Subjects.
std::string material_subject(std::uint32_t material);  // no_index: the default material
std::string map_subject(std::uint32_t material, const MaterialMap& map);
std::string mesh_subject(std::uint32_t mesh);
std::string node_subject(std::uint32_t node);

}  // namespace prep
