// Gates, which say what must hold between two files, and what was found, as JSON.
#pragma once

#include <string_view>

#include "judge/judgement.h"
#include "meshprep/output/report_json.h"

namespace meshprep {

struct Gate {
    judge::Limits limits;
    std::optional<double> rmse = 1.0 / 510;  // of pictures
    std::vector<std::string> meshes;         // by name, in both files; none: all
    std::uint32_t views = 6, size = 256;
    std::string replay;  // the command that makes the second file again
    // A limit that the text sets for what is drawn of meshes, "flip" or "silhouettes"; empty: none.
    std::string drawn_limit;
};

// docs/schema/gate.json. What the text does not name has its default; a limit of null is none.
// Errors: syntax (no JSON), invalid (unknown, missing or repeated members, other kinds, with the
// JSON pointer).
prep::Result<Gate> gate_from(std::string_view text);

Json to_json(const judge::Judgement& judgement, const prep::Scene& first);

}  // namespace meshprep
