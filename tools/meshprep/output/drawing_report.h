// What drawing a picture came to, told as rows and as JSON.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "meshprep/output/console.h"
#include "meshprep/output/report_json.h"
#include "prep/prepare.h"
#include "rast/render.h"

namespace meshprep {

// How much of what is seen came out black, by some of the pixels.
struct BlackPixels {
    std::uint64_t black = 0, seen = 0;

    void count(const rast::Frame& band, float exposure);
    std::optional<std::string> warning(const prep::PreparedScene& prepared) const;
};

// What drawing one picture came to.
struct Drawn {
    rast::Frame frame;  // without pixels
    BlackPixels black;
    std::vector<std::filesystem::path> paths;
    double draw_ms = 0, write_ms = 0;
};

// `explained`: the picture, where each step's cost is asked for; else null.
Json plan_json(const rast::RenderPlan& plan, const prep::PreparedScene& prepared,
               const Drawn* explained);

Json counters_json(const rast::Counters& c);

// A row for each step with what it came to, and below it one for each light, material and map that
// has a say in it.
void explain(const rast::RenderPlan& plan, const prep::PreparedScene& prepared,
             const rast::Frame& drawn, const CommonOptions& common, Console& console);

// What the scene has and no picture shows.
std::vector<std::string> not_drawn(const prep::PreparedScene& prepared);
// Why there is nothing to be seen where all of the scene's `triangles` were left out. With exact
// areas those between pixels' centres are drawn.
std::optional<std::string> why_empty(const rast::Counters& counters, std::uint64_t triangles,
                                     const rast::RenderRequest& request);

}  // namespace meshprep
