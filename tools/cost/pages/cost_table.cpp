#include "cost/pages/cost_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <thread>
#include <utility>

#include "prep/image.h"
#include "sheets/page.h"

namespace cost {
namespace {

// Shares of the processor below this, with one thread, mean that others had it meanwhile.
constexpr double least_share = 0.95;
// Quartiles apart by more than this share of the median.
constexpr double wide_spread = 0.1;

int processors() {
    return std::max(1, int(std::thread::hardware_concurrency()));
}

// As shown on screens, in base64.
prep::Result<std::string> png_text(const Pixels& linear) {
    prep::Image image;
    image.width = linear.width;
    image.height = linear.height;
    image.channels = 1;
    for (const double v : linear.values) {
        const double c = std::clamp(v, 0.0, 1.0);
        image.pixels.push_back(
            float(c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055));
    }
    const auto png = prep::encode_png(image);
    if (!png) return png.error();
    return report::base64(*png);
}

void derive(LadderRecord& ladder, int threads) {
    std::vector<double> errors;
    std::vector<std::vector<double>> seconds;
    double spread = 0;
    const std::vector<double>& base = ladder.rungs[ladder.reference].seconds;
    for (std::size_t i = 0; i < ladder.rungs.size(); ++i) {
        RungRecord& rung = ladder.rungs[i];
        rung.time = median_estimate(rung.seconds);
        rung.ratio = i == ladder.reference ? Estimate{1, 1, 1} : ratio_estimate(rung.seconds, base);
        spread = std::max(spread, relative_spread(rung.seconds));
        errors.push_back(rung.errors[ladder.primary]);
        seconds.push_back(rung.seconds);
    }
    // Exact rungs are no choice between speed and error: they neither dominate nor are dominated.
    std::vector<std::size_t> others;
    std::vector<double> other_errors;
    std::vector<std::vector<double>> other_seconds;
    for (std::size_t i = 0; i < ladder.rungs.size(); ++i) {
        if (ladder.rungs[i].exact) continue;
        others.push_back(i);
        other_errors.push_back(errors[i]);
        other_seconds.push_back(seconds[i]);
    }
    const std::vector<Verdict> verdicts = front(other_errors, other_seconds);
    for (std::size_t k = 0; k < others.size(); ++k)
        ladder.rungs[others[k]].verdict = {verdicts[k].standing, others[verdicts[k].by]};

    ladder.control_ratio = ratio_estimate(ladder.control, base);
    ladder.notes.clear();
    const auto note = [&](std::string text) { ladder.notes.push_back(std::move(text)); };
    if (threads == 1 && ladder.wall > 0 && ladder.cpu < least_share * ladder.wall)
        note(
            fmt::format("the machine was busy: {:.0f} % of the time went to other work; {} of {} "
                        "measurements were interrupted and taken again",
                        100 * (1 - ladder.cpu / ladder.wall), ladder.retries, ladder.measurements));
    else if (ladder.taken > 1 - least_share)
        note(fmt::format(
            "the machine was busy: other work had {:.0f} % of these threads' processors",
            100 * ladder.taken));
    if (spread > wide_spread)
        note(fmt::format("times scatter: the quartiles are up to {:.0f} % of the median apart",
                         100 * spread));
    if (!std::isfinite(ratio_estimate(ladder.control, base, Confidence::deciding).high))
        note(fmt::format("{} {} too few to say which setting is faster: that takes 8", base.size(),
                         base.size() == 1 ? "round is" : "rounds are"));
    else if (!ladder.narrow)
        note(fmt::format("stopped after {} rounds before every ratio was known to 5 %",
                         base.size()));
    const Estimate itself = ratio_estimate(ladder.control, base, Confidence::deciding);
    if (itself.low > 1 || itself.high < 1)
        note(fmt::format(
            "the {} setting, measured twice, differs from itself by a factor of {:.3f}: "
            "smaller differences mean nothing here",
            ladder.reference_is_default ? "default" : "reference", itself.value));
}

}  // namespace

prep::Result<LadderRecord> climb(const Ladder& ladder, int threads, const TimingOptions& options,
                                 Clock& clock) {
    LadderRecord record;
    record.name = ladder.name;
    record.title = ladder.title;
    record.setting = ladder.setting;
    record.subject = ladder.subject;
    record.oracle = ladder.oracle;
    record.timed = ladder.timed;
    record.metrics = ladder.metrics;
    record.primary = ladder.primary;
    record.floor = ladder.floor;
    record.floor_text = ladder.floor_text;
    record.reference = ladder.reference;
    record.reference_is_default = ladder.reference_is_default;
    record.grid = ladder.grid;
    std::vector<std::function<void()>> runs;
    for (const Rung& rung : ladder.rungs) {
        if (const prep::Result<void> ran = rung.run(); !ran) return ran.error();
        RungRecord r;
        r.name = rung.name;
        r.command = rung.command;
        r.exact = rung.exact;
        r.because = rung.because;
        r.errors = rung.judge();
        if (rung.look) {
            const Look look = rung.look();
            for (const auto& [from, to] : {std::pair(&look.picture, &r.picture),
                                           std::pair(&look.difference, &r.difference)}) {
                auto png = png_text(*from);
                if (!png) return png.error();
                *to = *std::move(png);
            }
        }
        record.rungs.push_back(std::move(r));
        runs.push_back([&rung] { static_cast<void>(rung.run().has_value()); });
    }
    runs.push_back(runs[ladder.reference]);
    Times times = measure(runs, ladder.reference, options, clock);
    for (std::size_t i = 0; i < record.rungs.size(); ++i) {
        record.rungs[i].seconds = std::move(times.seconds[i]);
        record.rungs[i].repeats = times.repeats[i];
    }
    record.control = std::move(times.seconds.back());
    record.wall = times.wall;
    record.cpu = times.cpu;
    record.narrow = times.narrow;
    record.measurements = times.measurements;
    record.retries = times.retries;
    record.taken = share_taken(times.others, threads, processors());
    return record;
}

void derive(CostTable& table) {
    for (LadderRecord& ladder : table.ladders) derive(ladder, table.threads);
}

std::string processor_name() {
    std::ifstream list("/proc/cpuinfo");
    for (std::string line; std::getline(list, line);) {
        if (line.rfind("model name", 0) != 0) continue;
        const std::size_t colon = line.find(": ");
        if (colon != std::string::npos) return line.substr(colon + 2);
    }
    return "unknown";
}

std::string short_number(double value) {
    if (value == 0) return "0";
    if (std::isinf(value)) return value > 0 ? "∞" : "−∞";
    if (std::isnan(value)) return "–";
    const double size = std::abs(value);
    if (size >= 1000 && size < 1e9 && value == std::floor(value))
        return fmt::format("{:.0f}", value);
    return fmt::format("{:.3g}", value);
}

std::string short_time(double seconds) {
    if (seconds < 1e-3) return fmt::format("{:.3g} µs", seconds * 1e6);
    if (seconds < 1) return fmt::format("{:.3g} ms", seconds * 1e3);
    return fmt::format("{:.3g} s", seconds);
}

std::string marked_name(const LadderRecord& ladder, std::size_t rung) {
    const std::string& name = ladder.rungs[rung].name;
    if (rung != ladder.reference) return name;
    return name + (ladder.reference_is_default ? " (default)" : " (reference)");
}

std::vector<std::string> name_cells(const LadderRecord& ladder, std::size_t rung) {
    const std::string marked = marked_name(ladder, rung);
    if (ladder.grid.empty()) return {marked};
    const std::vector<std::string>& second = ladder.grid[1].values;
    const std::string mark = marked.substr(ladder.rungs[rung].name.size());
    return {ladder.grid[0].values[rung / second.size()], second[rung % second.size()] + mark};
}

std::vector<std::string> name_headings(const LadderRecord& ladder) {
    if (ladder.grid.empty()) return {"setting"};
    return {ladder.grid[0].name, ladder.grid[1].name};
}

std::vector<std::string> rises(const LadderRecord& ladder) {
    std::vector<std::string> sentences;
    for (const RungRecord& rung : ladder.rungs) {
        if (rung.exact || rung.verdict.standing != Standing::dominated) continue;
        sentences.push_back(rung.name + ", " + standing_text(ladder, rung) + ": " +
                            (rung.because.empty()
                                 ? "no reason is known beforehand; so it was on this machine"
                                 : rung.because));
    }
    return sentences;
}

double share_taken(double others, int threads, int processors) {
    if (threads <= 0) return 0;
    const double spare = std::max(0, processors - threads);
    return std::clamp((others - spare) / threads, 0.0, 1.0);
}

std::string standing_text(const LadderRecord& ladder, const RungRecord& rung) {
    if (rung.exact) return "exact";
    const std::string& by = ladder.rungs[rung.verdict.by].name;
    switch (rung.verdict.standing) {
        case Standing::dominated:
            return "dominated by " + by;
        case Standing::tied:
            return "tied with " + by;
        case Standing::front:
            break;
    }
    return "front";
}

}  // namespace cost
