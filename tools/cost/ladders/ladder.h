// A ladder: one setting of one stage, its rungs, what is timed, and the truth that each rung's
// result is held against. The truths are in cost/oracles, which sees nothing of the stages. A grid
// is a ladder over two settings, whose rungs are the pairs of their values.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cost/measure/metrics.h"
#include "prep/mesh.h"
#include "prep/result.h"

namespace cost {

// What a number of a rung says. Angles in degrees, pictures in linear light unless `domain` says
// otherwise.
struct Metric {
    std::string name, unit, domain;
};

// A part of a picture, pixel for pixel, and how far each is from the truth, four times over. One
// channel, linear.
struct Look {
    Pixels picture, difference;
};
inline constexpr std::uint32_t look_width = 96, look_height = 72;
inline constexpr double look_gain = 4;
// The part of that size, or all that there is, whose middle is that of both.
Look look_of(const Pixels& picture, const Pixels& truth);

struct Rung {
    std::string name;
    std::string command;                      // the settings, as `meshprep` takes them
    std::function<prep::Result<void>()> run;  // what is timed; keeps its result
    // Of the last result: one number for each metric. Not timed.
    std::function<std::vector<double>()> judge;
    std::function<Look()> look = {};  // of the last result; empty: it is no picture
    bool exact = false;               // meant as the truth: on a lane of its own
    // Why it may take longer than another and have no less error; empty: it should not.
    std::string because = {};
};

// One of the two settings of a grid.
struct GridSetting {
    std::string name;  // "samples"
    std::vector<std::string> values;
};

struct Ladder {
    std::string name;     // "normal-precision"
    std::string title;    // "Precision of normals"
    std::string setting;  // which stage, and which setting of it
    std::string subject;  // what it is tried on
    std::string oracle;   // where the truth comes from
    std::vector<std::string> timed;
    std::vector<Metric> metrics;
    std::size_t primary = 0;      // the metric of plots and fronts
    std::optional<double> floor;  // of that metric: no result of this kind can do better
    std::string floor_text;
    std::size_t reference = 0;         // the rung that ratios are to
    bool reference_is_default = true;  // it is what `meshprep` does unasked
    std::vector<Rung> rungs;
    // None, or two: rungs are all pairs, for each value of the first all of the second.
    std::vector<GridSetting> grid;
};

// Makes a grid of a ladder without rungs: `rung` is asked for each pair, by the values' indices;
// its name becomes "first, second".
void make_grid(Ladder& ladder, GridSetting first, GridSetting second,
               const std::function<Rung(std::size_t, std::size_t)>& rung);

struct ScenePicture;  // scenes.h

// What ladders are tried on: the user's mesh or scene, or shapes of their own where there is none.
struct Subject {
    std::string name;
    const prep::Mesh* mesh = nullptr;
    int threads = 0;
    const ScenePicture* picture = nullptr;  // of the same file, as it is drawn
};

struct LadderRow {
    const char* name;
    const char* summary;
    bool of_meshes;  // tried on the user's files; the others have shapes of their own
    bool grid;       // of two settings
    // Runs nothing yet but the oracle. Errors: those of the stages on such a mesh.
    prep::Result<Ladder> (*make)(const Subject& subject);
};

// In the order of pages and of --list.
std::span<const LadderRow> ladder_rows();

// The rows' makers, each in the file of its name, or of its stage's.
prep::Result<Ladder> weld_distance_ladder(const Subject& subject);
prep::Result<Ladder> normal_precision_ladder(const Subject& subject);
prep::Result<Ladder> normal_weight_ladder(const Subject& subject);
prep::Result<Ladder> weight_by_precision_grid(const Subject& subject);
prep::Result<Ladder> hard_angle_ladder(const Subject& subject);
prep::Result<Ladder> tangent_mode_ladder(const Subject& subject);
prep::Result<Ladder> subdivision_level_ladder(const Subject& subject);
prep::Result<Ladder> chord_error_ladder(const Subject& subject);
prep::Result<Ladder> displacement_error_ladder(const Subject& subject);
prep::Result<Ladder> height_filter_ladder(const Subject& subject);
prep::Result<Ladder> band_limit_ladder(const Subject& subject);
prep::Result<Ladder> chord_error_by_height_filter_grid(const Subject& subject);
prep::Result<Ladder> relief_ladder(const Subject& subject);
prep::Result<Ladder> shading_frequency_ladder(const Subject& subject);
prep::Result<Ladder> anti_aliasing_ladder(const Subject& subject);
prep::Result<Ladder> samples_by_supersampling_grid(const Subject& subject);
prep::Result<Ladder> scene_sampling_ladder(const Subject& subject);
prep::Result<Ladder> texture_filter_ladder(const Subject& subject);
prep::Result<Ladder> depth_format_ladder(const Subject& subject);
prep::Result<Ladder> quantized_positions_ladder(const Subject& subject);
prep::Result<Ladder> quantized_normals_ladder(const Subject& subject);
prep::Result<Ladder> quantized_tangents_ladder(const Subject& subject);
prep::Result<Ladder> quantized_uvs_ladder(const Subject& subject);

}  // namespace cost
