// `meshprep diff` as the judge: what is found, in words, as JSON and as a page.
#pragma once

#include "meshprep/output/console.h"
#include "meshprep/output/gate_json.h"
#include "sheets/page.h"

namespace meshprep {

// The names of the two files, and what the gate file is called; empty: there is none.
struct JudgedFiles {
    std::string a, b, gate;
};

void say_judgement(const CommonOptions& common, const judge::Judgement& judgement,
                   const prep::Scene& first, Console& console);

// "normals, uvs": what is not within its limit and follows from nothing else; empty: all is.
std::string failed_causes(const judge::Judgement& judgement);

report::Page judgement_page(const JudgedFiles& files, const judge::Judgement& judgement,
                            const prep::Scene& first, const std::string& replay);

// The page, complete or not at all, with its directory. Errors: io, those of encode_png().
prep::Result<void> write_page(const std::filesystem::path& path, const report::Page& page);

}  // namespace meshprep
