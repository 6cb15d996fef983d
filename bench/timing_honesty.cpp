// timing_honesty [RUNS [LADDER…]]: whether the times of `meshprep cost` say what is so, on this
// machine, with one thread. For each ladder RUNS times (default 40):
//
//   twice   its default measured as two settings: neither may be named faster in more than 5 %
//   +10 %   the default ten times in a row beside eleven times: to be named in 38 of 40
//   +1 %    a hundred times beside a hundred and one, where that takes less than 60 ms: named or
//           not, but never the wrong one in more than 5 %
//   busy    all rungs, alone and beside a process that computes without end on each processor: a
//           pair named in opposite orders is a contradiction, and what stands elsewhere on the
//           front without a tie in either is one too
//
// "Named" is what fronts go by: the 99 % interval of the ratio excludes 1. The planted work is the
// default itself once more, so that it is as much slower as it says. Exit code 1 where any of that
// does not hold. Rounds end as the command's do. An idle machine is asked for; about ten minutes.
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include "cost/ladders/ladder.h"
#include "cost/measure/front.h"
#include "cost/measure/statistics.h"
#include "cost/measure/timing.h"
#include "cost/pages/cost_table.h"

namespace {

constexpr double longest_hundred = 0.06;  // seconds

cost::TimingOptions options_of(std::uint64_t seed) {
    cost::TimingOptions options;
    options.one_processor = true;  // as the command with one thread
    options.least_share = 0.95;
    options.seed = seed;
    return options;
}

enum class Named { neither, first, second };  // as the faster one

Named faster_of(const std::vector<double>& a, const std::vector<double>& b) {
    const cost::Estimate ratio = cost::ratio_estimate(a, b, cost::Confidence::deciding);
    return ratio.high < 1 ? Named::first : ratio.low > 1 ? Named::second : Named::neither;
}

std::function<void()> repeated(const std::function<void()>& run, int times) {
    return [run, times] {
        for (int k = 0; k < times; ++k) run();
    };
}

struct Counts {
    int none = 0, right = 0, wrong = 0;
    void add(Named named) {
        ++(named == Named::neither ? none : named == Named::first ? right : wrong);
    }
};

Named compared(const std::function<void()>& a, const std::function<void()>& b, std::uint64_t seed) {
    cost::SystemClock clock;
    const cost::Times times = cost::measure({a, b}, 0, options_of(seed), clock);
    return faster_of(times.seconds[0], times.seconds[1]);
}

// Processes that compute until this ends.
class BusyProcessors {
  public:
    BusyProcessors() {
        const unsigned count = std::max(1u, std::thread::hardware_concurrency());
        for (unsigned k = 0; k < count; ++k) {
            const pid_t child = fork();
            if (child == 0) {
                volatile unsigned work = 0;
                while (work == 0) {
                }
            }
            if (child > 0) children_.push_back(child);
        }
    }
    ~BusyProcessors() {
        for (const pid_t child : children_) {
            kill(child, SIGKILL);
            waitpid(child, nullptr, 0);
        }
    }
    BusyProcessors(const BusyProcessors&) = delete;
    BusyProcessors& operator=(const BusyProcessors&) = delete;

  private:
    std::vector<pid_t> children_;
};

// Rungs that are not exact, with their errors and times.
struct Climbed {
    std::vector<std::string> names;
    std::vector<double> errors;
    std::vector<std::vector<double>> seconds;
};

Climbed climbed(const cost::Ladder& ladder, std::uint64_t seed) {
    cost::SystemClock clock;
    const auto record = cost::climb(ladder, 1, options_of(seed), clock);
    Climbed out;
    if (!record) return out;
    for (const cost::RungRecord& rung : record->rungs) {
        if (rung.exact) continue;
        out.names.push_back(rung.name);
        out.errors.push_back(rung.errors[record->primary]);
        out.seconds.push_back(rung.seconds);
    }
    return out;
}

// What two runs of one ladder say that cannot both be so.
int contradictions(const char* ladder, const Climbed& quiet, const Climbed& busy) {
    int found = 0;
    const auto front_quiet = cost::front(quiet.errors, quiet.seconds),
               front_busy = cost::front(busy.errors, busy.seconds);
    for (std::size_t i = 0; i < quiet.names.size(); ++i) {
        bool tied = false;
        for (std::size_t j = 0; j < quiet.names.size(); ++j) {
            if (i == j) continue;
            const Named a = faster_of(quiet.seconds[i], quiet.seconds[j]),
                        b = faster_of(busy.seconds[i], busy.seconds[j]);
            tied |= a == Named::neither || b == Named::neither;
            if (i < j && a != Named::neither && b != Named::neither && a != b) {
                ++found;
                std::printf("  %s: %s and %s are named in opposite orders\n", ladder,
                            quiet.names[i].c_str(), quiet.names[j].c_str());
            }
        }
        if (front_quiet[i].standing != front_busy[i].standing && !tied) {
            ++found;
            std::printf("  %s: %s stands elsewhere, and nothing is tied with it\n", ladder,
                        quiet.names[i].c_str());
        }
    }
    return found;
}

std::string of(int count, int all) {
    return std::to_string(count) + "/" + std::to_string(all);
}

}  // namespace

int main(int argc, char** argv) {
    const int runs = argc > 1 ? std::atoi(argv[1]) : 40;
    if (runs < 1) {
        std::fprintf(stderr, "timing_honesty [RUNS [LADDER...]]\n");
        return 2;
    }
    const std::vector<std::string> wanted(argv + std::min(argc, 2), argv + argc);
    bool holds = true;
    int all_contradictions = 0;
    Counts all_twice;
    std::printf(
        "| ladder | default, ms | twice: either named | +10 %%: named | +1 %%: named, "
        "the wrong one | busy: contradictions |\n|---|---:|---:|---:|---:|---:|\n");
    for (const cost::LadderRow& row : cost::ladder_rows()) {
        if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), row.name) == wanted.end())
            continue;
        const auto ladder = row.make({.name = "", .threads = 1});
        if (!ladder) {
            std::fprintf(stderr, "timing_honesty: %s: %s\n", row.name,
                         to_string(ladder.error()).c_str());
            holds = false;
            continue;
        }
        const cost::Rung& rung = ladder->rungs[ladder->reference];
        const std::function<void()> run = [&rung] { static_cast<void>(rung.run().has_value()); };
        cost::SystemClock clock;
        double seconds = 1e9;
        for (int k = 0; k < 3; ++k) {
            const double start = clock.now().wall;
            run();
            seconds = std::min(seconds, clock.now().wall - start);
        }
        const bool hundred = 100 * seconds < longest_hundred;
        Counts twice, tenth, hundredth;
        for (int k = 0; k < runs; ++k) {
            const auto seed = std::uint64_t(3 * k + 1);
            twice.add(compared(run, run, seed));
            tenth.add(compared(repeated(run, 10), repeated(run, 11), seed + 1));
            if (hundred) hundredth.add(compared(repeated(run, 100), repeated(run, 101), seed + 2));
        }
        const Climbed quiet = climbed(*ladder, 1);
        Climbed busy;
        {
            const BusyProcessors others;
            busy = climbed(*ladder, 2);
        }
        const int contradicted = contradictions(row.name, quiet, busy);
        std::printf("| `%s` | %.3g | %s | %s | %s | %d |\n", row.name, 1e3 * seconds,
                    of(twice.right + twice.wrong, runs).c_str(), of(tenth.right, runs).c_str(),
                    hundred ? (of(hundredth.right, runs) + ", " + of(hundredth.wrong, runs)).c_str()
                            : "not measured",
                    contradicted);
        std::fflush(stdout);
        holds &= tenth.right * 40 >= runs * 38 && hundredth.wrong * 20 <= runs &&
                 (twice.right + twice.wrong) * 20 <= runs && contradicted == 0;
        all_contradictions += contradicted;
        all_twice.right += twice.right;
        all_twice.wrong += twice.wrong;
        all_twice.none += twice.none;
    }
    std::printf(
        "\nThe default beside itself: named in %s of all. Contradictions: %d. %s.\n",
        of(all_twice.right + all_twice.wrong, all_twice.right + all_twice.wrong + all_twice.none)
            .c_str(),
        all_contradictions, holds ? "All holds" : "Not all holds");
    return holds ? 0 : 1;
}
