#include "meshprep/output/placement_text.h"

#include <fmt/format.h>

#include "prep/enum_names.h"

namespace meshprep {

std::string placement_text(const prep::Placement& placement) {
    std::string text;
    if (!placement.file_unit_source.empty() || placement.scale != 1) {
        text = fmt::format("lengths × {:g}", placement.factor());
        if (!placement.file_unit_source.empty())
            text += fmt::format(": {} ({:g} m to a unit)", placement.file_unit_source,
                                placement.file_unit);
        if (placement.scale != 1)
            text += fmt::format("{}--scale {:g}", text.find(':') == std::string::npos ? ": " : ", ",
                                placement.scale);
    }
    if (placement.up != prep::Axis::y)
        text +=
            fmt::format("{}{} turned to y", text.empty() ? "" : "; ", prep::name_of(placement.up));
    return text;
}

nlohmann::ordered_json to_json(const prep::Placement& placement) {
    return {{"factor", placement.factor()},
            {"file_unit", placement.file_unit},
            {"file_unit_source", placement.file_unit_source},
            {"scale", placement.scale},
            {"up", prep::name_of(placement.up)}};
}

}  // namespace meshprep
