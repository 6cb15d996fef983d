// What was measured, and what follows from it: the one table that terminal, JSON, CSV, plots and
// pages are made from.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cost/ladders/ladder.h"
#include "cost/measure/front.h"
#include "cost/measure/statistics.h"
#include "cost/measure/timing.h"

namespace cost {

struct RungRecord {
    std::string name, command;
    bool exact = false;
    std::vector<double> errors;   // by metric
    std::vector<double> seconds;  // by round, of one run
    int repeats = 1;
    std::string because;  // why it may be dominated; empty: no reason is known
    // Of rungs that draw: PNG files as base64, as a page holds them; empty: there are none.
    std::string picture, difference;

    // From these, by derive().
    Estimate time;   // median of `seconds`
    Estimate ratio;  // to the reference
    Verdict verdict;
};

struct LadderRecord {
    std::string name, title, setting, subject, oracle;
    std::vector<std::string> timed;
    std::vector<Metric> metrics;
    std::size_t primary = 0;
    std::optional<double> floor;
    std::string floor_text;
    std::size_t reference = 0;
    std::vector<RungRecord> rungs;
    std::vector<double> control;  // seconds of the reference, measured once more as if another
    double wall = 0, cpu = 0;     // of all timed runs
    bool narrow = false;
    int measurements = 0, retries = 0;  // retries: measurements that were taken again
    double taken = 0;  // share of the threads' processors that other work had meanwhile
    bool reference_is_default = true;
    std::vector<GridSetting> grid;  // of grids: two

    // From these, by derive().
    Estimate control_ratio;
    std::vector<std::string>
        notes;  // what to know about these times: a busy machine, wide intervals
};

struct CostTable {
    std::string version, processor;
    int threads = 1;
    std::vector<LadderRecord> ladders;
};

// Runs every rung once for its error, then all of them for their times. Errors: those of the
// stages.
prep::Result<LadderRecord> climb(const Ladder& ladder, int threads, const TimingOptions& options,
                                 Clock& clock);

// Intervals, ratios, fronts and notes of each ladder.
void derive(CostTable& table);

// The model name of the processor, or "unknown".
std::string processor_name();

// A few significant digits for people: "0.0123", "1.2e-07", "0".
std::string short_number(double value);
std::string short_time(double seconds);  // "12.3 ms"

// The rung's name, marked where ratios are to it: "60° (default)", "level 2 (reference)".
std::string marked_name(const LadderRecord& ladder, std::size_t rung);
// The share of `threads` processors that `others` (processors' worth of other work) left no room
// for on a machine of `processors`, 0 … 1.
double share_taken(double others, int threads, int processors);

// The same in cells of a table: one, of grids one for each setting.
std::vector<std::string> name_cells(const LadderRecord& ladder, std::size_t rung);
std::vector<std::string> name_headings(const LadderRecord& ladder);

// For each rung that is dominated a sentence that says by what, and why where a reason is known.
std::vector<std::string> rises(const LadderRecord& ladder);

// Where a rung stands, in words: "front", "dominated by trilinear", "tied with …", "exact".
std::string standing_text(const LadderRecord& ladder, const RungRecord& rung);

}  // namespace cost
