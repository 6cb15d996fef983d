// What was chosen to fit a time, what it was predicted to take, and what it took: of every
// `--budget-ms`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "meshprep/output/console.h"
#include "meshprep/output/report_json.h"

namespace meshprep {

struct TimePrediction {
    std::string setting;  // as options
    double milliseconds = 0;
    bool measured = false;  // with this setting itself: on the whole file, or on smaller pictures
};

struct TimeCertificate {
    double asked = 0;  // milliseconds
    bool met = false;  // by the prediction
    TimePrediction chosen;
    std::size_t index = 0;               // of it in `tried`
    std::optional<TimePrediction> next;  // the next more accurate one, which does not fit
    std::vector<TimePrediction> tried;   // all, by accuracy
    double pilot_ms = 0;                 // that measuring what a prediction rests on took
    double taken = 0;                    // what it took then
    bool overrun() const { return taken > asked; }
};

// The last of `tried`, which get more accurate, that is predicted to take at most `asked`; else the
// one of least time, and `met` is false. `tried` holds at least one.
TimeCertificate chosen_in_time(double asked, std::vector<TimePrediction> tried);

// What it is about, in words: "draw", "drawing"; and of what the milliseconds are.
struct TimedWork {
    const char *verb, *noun, *unit;
};

// `command`: what does the same again without choosing.
Json to_json(const TimeCertificate& certificate, const TimedWork& work, const std::string& command);
void say_time(const CommonOptions& common, const TimeCertificate& certificate,
              const TimedWork& work, const std::string& command, Console& console);

}  // namespace meshprep
