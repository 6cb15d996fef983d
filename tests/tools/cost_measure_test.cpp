// Times, fronts and metrics, with a clock of the test's own.
#include <gtest/gtest.h>

#if defined(__linux__)
#include <sched.h>
#endif

#include <cmath>
#include <limits>
#include <random>
#include <set>

#include "cost/measure/front.h"
#include "cost/measure/metrics.h"
#include "cost/measure/statistics.h"
#include "cost/measure/timing.h"

namespace {

using cost::Estimate;
using cost::Standing;
using cost::Times;
using cost::TimingOptions;

// Time passes only while a setting runs.
class TestClock : public cost::Clock {
  public:
    cost::Instant now() override { return {wall, cpu, 0}; }
    cost::Instant with_machine() override { return {wall, cpu, busy}; }
    double wall = 0, cpu = 0, busy = 0;
};

// Settings that take `seconds`, scattered by `noise` (log-normal, as times scatter upwards).
struct Planted {
    std::vector<double> seconds;
    double noise = 0.02;
    std::uint64_t seed = 1;

    Times measured(const TimingOptions& options = {}) {
        TestClock clock;
        std::mt19937_64 random(seed);
        std::normal_distribution<double> normal;
        std::vector<std::function<void()>> runs;
        for (const double s : seconds)
            runs.push_back([&, s] {
                const double t = s * std::exp(noise * normal(random));
                clock.wall += t;
                clock.cpu += t;
            });
        return cost::measure(runs, 0, options, clock);
    }
};

TEST(CostTiming, ARoundRunsEverySettingOnceInAnOrderOfItsOwn) {
    TestClock clock;
    std::vector<int> order;
    std::vector<std::function<void()>> runs;
    for (int i = 0; i < 5; ++i)
        runs.push_back([&, i] {
            order.push_back(i);
            clock.wall += 0.01;
        });
    TimingOptions options;
    options.rounds = 40;
    const Times times = cost::measure(runs, 0, options, clock);
    ASSERT_EQ(order.size(), 5u * 41);
    EXPECT_EQ(std::vector<int>(order.begin(), order.begin() + 5),
              (std::vector<int>{0, 1, 2, 3, 4}));  // the warm-up
    int first_is_zero = 0;
    for (std::size_t round = 1; round <= 40; ++round) {
        std::vector<int> one(order.begin() + std::ptrdiff_t(5 * round),
                             order.begin() + std::ptrdiff_t(5 * round + 5));
        first_is_zero += one[0] == 0;
        std::sort(one.begin(), one.end());
        EXPECT_EQ(one, (std::vector<int>{0, 1, 2, 3, 4}));
    }
    EXPECT_LT(first_is_zero, 20);
    EXPECT_GT(first_is_zero, 1);
    for (const auto& seconds : times.seconds) EXPECT_EQ(seconds.size(), 40u);
}

#if defined(__linux__)
// All runs have one processor; afterwards the thread has those that it had.
TEST(CostTiming, OneThreadStaysOnOneProcessor) {
    cpu_set_t before, after;
    ASSERT_EQ(sched_getaffinity(0, sizeof before, &before), 0);
    std::set<int> on;
    const auto run = [&] {
        cpu_set_t now;
        EXPECT_EQ(sched_getaffinity(0, sizeof now, &now), 0);
        on.insert(CPU_COUNT(&now) == 1 ? sched_getcpu() : -1);
    };
    TimingOptions options;
    options.rounds = 6;
    options.one_processor = true;
    cost::SystemClock clock;
    cost::measure({run, run, run}, 0, options, clock);
    EXPECT_EQ(on.size(), 1u);
    EXPECT_GE(*on.begin(), 0);
    ASSERT_EQ(sched_getaffinity(0, sizeof after, &after), 0);
    EXPECT_TRUE(CPU_EQUAL(&before, &after));
}

TEST(CostTiming, TheNextProcessorIsAnotherOne) {
    cpu_set_t all;
    ASSERT_EQ(sched_getaffinity(0, sizeof all, &all), 0);
    cost::SystemClock clock;
    std::set<int> on;
    for (int k = 0; k < CPU_COUNT(&all); ++k) {
        clock.run_on_next();
        on.insert(sched_getcpu());
    }
    clock.run_anywhere();
    EXPECT_EQ(on.size(), std::size_t(CPU_COUNT(&all)));
}
#endif

// The second round is interrupted: the third has another processor.
TEST(CostTiming, AProcessorThatOtherWorkHasIsLeft) {
    class Processors : public TestClock {
      public:
        void run_on_next() override { ++moves; }
        void run_anywhere() override { ++ends; }
        int moves = 0, ends = 0;
    } clock;
    int runs = 0;
    std::vector<int> moves;
    const auto run = [&] {
        moves.push_back(clock.moves);
        clock.wall += ++runs == 3 ? 0.007 : 0.003;
        clock.cpu += 0.003;
    };
    TimingOptions options;
    options.rounds = 4;
    options.least_share = 0.95;
    cost::measure({run}, 0, options, clock);
    EXPECT_EQ(clock.moves + clock.ends, 0);
    options.one_processor = true;
    runs = 0;
    moves.clear();
    cost::measure({run}, 0, options, clock);
    EXPECT_EQ(moves, (std::vector<int>{1, 1, 1, 1, 2, 2}));
    EXPECT_EQ(clock.ends, 1);
}

TEST(CostTiming, TheWarmUpIsNotCounted) {
    TestClock clock;
    int runs = 0;
    const Times times =
        cost::measure({[&] { clock.wall += runs++ == 0 ? 5.0 : 0.01; }}, 0, {}, clock);
    for (const double s : times.seconds[0]) EXPECT_NEAR(s, 0.01, 1e-12);
}

TEST(CostTiming, ShortRunsAreRepeatedAndToldByOneRun) {
    TestClock clock;
    const Times times = cost::measure({[&] { clock.wall += 1e-5; }}, 0, {}, clock);
    EXPECT_EQ(times.repeats[0], 100);
    EXPECT_NEAR(times.seconds[0][0], 1e-5, 1e-9);
}

TEST(CostTiming, QuietTimesEndAfterEightRoundsNoisyOnesAtTheCap) {
    const Times quiet = Planted{{0.01, 0.02}, 0.001}.measured();
    EXPECT_EQ(quiet.seconds[0].size(), 8u);
    EXPECT_TRUE(quiet.narrow);
    TimingOptions options;
    options.seconds = 1e9;
    const Times noisy = Planted{{0.01, 0.02}, 0.5}.measured(options);
    EXPECT_EQ(noisy.seconds[0].size(), 25u);
    EXPECT_FALSE(noisy.narrow);
    options.seconds = 0.1;
    EXPECT_EQ((Planted{{0.1, 0.2}, 0.5}.measured(options).seconds[0].size()), 8u);
}

// Other work takes the processor for 4 ms in every third run: with its share watched, no
// measurement that counts has it.
TEST(CostTiming, InterruptedMeasurementsAreTakenAgain) {
    TestClock clock;
    int runs = 0;
    const auto run = [&] {
        const bool interrupted = ++runs % 3 == 0;
        clock.wall += interrupted ? 0.007 : 0.003;
        clock.cpu += 0.003;
    };
    TimingOptions options;
    options.rounds = 9;
    options.least_share = 0.95;
    const Times times = cost::measure({run}, 0, options, clock);
    for (const double s : times.seconds[0]) EXPECT_NEAR(s, 0.003, 1e-9);
    EXPECT_EQ(times.measurements, 9);
    // Run 1 warms up; of the nine measurements, those that begin with runs 3, 6, 9 and 12.
    EXPECT_EQ(times.retries, 4);
    // Not those that last longer than other work ever waits.
    options.longest_retried = 0.001;
    EXPECT_EQ(cost::measure({run}, 0, options, clock).retries, 0);
    options.least_share = 0;
    EXPECT_GT(cost::quantile(cost::measure({run}, 0, options, clock).seconds[0], 1), 0.006);
}

// A measurement that is interrupted three times is one that was taken again.
TEST(CostTiming, MeasurementsThatAreTakenAgainCountOnce) {
    TestClock clock;
    int runs = 0;
    const auto run = [&] {
        ++runs;
        clock.wall += runs >= 4 && runs <= 6 ? 0.007 : 0.003;
        clock.cpu += 0.003;
    };
    TimingOptions options;
    options.rounds = 5;
    options.least_share = 0.95;
    const Times times = cost::measure({run}, 0, options, clock);
    EXPECT_EQ(runs, 1 + 5 + 3);
    EXPECT_EQ(times.measurements, 5);
    EXPECT_EQ(times.retries, 1);
    EXPECT_NEAR(cost::quantile(times.seconds[0], 1), 0.003, 1e-9);
}

// The machine has been busy for longer than this process: one processor and a half went elsewhere.
TEST(CostTiming, OtherWorkOnTheMachineIsSeenWithAnyThreads) {
    TestClock clock;
    clock.busy = 1000;
    TimingOptions options;
    options.rounds = 4;
    const auto run = [&] {
        clock.wall += 1;
        clock.cpu += 2;
        clock.busy += 3.5;
    };
    EXPECT_NEAR(cost::measure({run}, 0, options, clock).others, 1.5, 1e-9);
    clock.busy = 0;  // not known
    const auto blind = [&] { clock.wall += 1; };
    EXPECT_EQ(cost::measure({blind}, 0, options, clock).others, 0);
}

// The same setting twice, in 400 runs. Neither may dominate in more than 5 % of them.
TEST(CostFront, TheSameSettingTwiceIsATie) {
    int dominated = 0;
    for (std::uint64_t seed = 1; seed <= 400; ++seed) {
        const Times times = Planted{{0.01, 0.01}, 0.03, seed}.measured();
        const std::vector<double> errors = {1, 1};
        for (const cost::Verdict& v : cost::front(errors, times.seconds))
            dominated += v.standing != Standing::front;
    }
    EXPECT_LE(dominated, 20);
}

// However few the rounds: identical settings are told apart in no more than one run of a hundred
// (and three standard deviations of 2,000 runs; both settings of a pair are looked at).
TEST(CostFront, FewRoundsNameNothingThatIsNotThere) {
    for (int rounds = 1; rounds <= 12; ++rounds) {
        int dominated = 0;
        TimingOptions options;
        options.rounds = rounds;
        for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
            const Times times = Planted{{0.01, 0.01}, 0.03, seed}.measured(options);
            const std::vector<double> errors = {1, 1};
            for (const cost::Verdict& v : cost::front(errors, times.seconds))
                dominated += v.standing == Standing::dominated;
        }
        EXPECT_LE(dominated, 20 + 13) << rounds << " rounds";
        if (rounds < 8) {
            EXPECT_EQ(dominated, 0) << rounds << " rounds";
        }
    }
}

// Twice the time is named as soon as anything can be.
TEST(CostFront, EightRoundsNameTwiceTheTime) {
    TimingOptions options;
    const std::vector<double> errors = {1, 1};
    for (const int rounds : {7, 8}) {
        options.rounds = rounds;
        const Times times = Planted{{0.01, 0.02}, 0.03}.measured(options);
        EXPECT_EQ(cost::front(errors, times.seconds)[1].standing == Standing::dominated,
                  rounds == 8);
    }
}

TEST(CostFront, TenPercentMoreIsNamedInThirtyEightOfForty) {
    int named = 0;
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
        const Times times = Planted{{0.01, 0.011}, 0.02, seed}.measured();
        const std::vector<double> errors = {1, 1};
        const auto verdicts = cost::front(errors, times.seconds);
        named += verdicts[1].standing == Standing::dominated && verdicts[1].by == 0 &&
                 verdicts[0].standing == Standing::front;
    }
    EXPECT_GE(named, 38);
}

TEST(CostFront, OnePercentMoreIsNamedOnlyWhereTheIntervalExcludesOne) {
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
        const Times times = Planted{{0.01, 0.0101}, 0.03, seed}.measured();
        const std::vector<double> errors = {1, 1};
        const auto verdicts = cost::front(errors, times.seconds);
        const Estimate ratio =
            cost::ratio_estimate(times.seconds[0], times.seconds[1], cost::Confidence::deciding);
        EXPECT_EQ(verdicts[1].standing == Standing::dominated, ratio.high < 1) << "seed " << seed;
    }
}

// A slow machine slows both settings of a round: pairs cancel it.
TEST(CostFront, RoundsThatAreSlowForAllChangeNothing) {
    std::vector<double> a, b;
    for (int round = 0; round < 9; ++round) {
        const double slow = 1 + round % 3;
        a.push_back(0.01 * slow);
        b.push_back(0.0105 * slow);
    }
    const Estimate ratio = cost::ratio_estimate(a, b);
    EXPECT_NEAR(ratio.value, 0.01 / 0.0105, 1e-12);
    EXPECT_LT(ratio.high, 1);
}

TEST(CostFront, NamesTheDominatedTheTiedAndTheFront) {
    const std::vector<double> errors = {1, 0.1, 0.5, 0.1, std::nan(""), 0};
    const auto steady = [](double s) { return std::vector<double>(8, s); };
    const std::vector<std::vector<double>> seconds = {steady(1), steady(2), steady(3),
                                                      steady(2), steady(2), steady(9)};
    const auto v = cost::front(errors, seconds);
    EXPECT_EQ(v[0].standing, Standing::front);
    EXPECT_EQ(v[1].standing, Standing::front);
    EXPECT_EQ(v[2].standing, Standing::dominated);  // slower than 1 with more error
    EXPECT_EQ(v[2].by, 1u);
    EXPECT_EQ(v[3].standing, Standing::front);      // equal in both: neither is better
    EXPECT_EQ(v[4].standing, Standing::dominated);  // by 0, which is faster and has an error
    EXPECT_EQ(v[5].standing, Standing::front);
    const std::vector<double> two = {1, 0.5};
    EXPECT_EQ(cost::front(two, std::vector{steady(1), steady(1)})[0].standing, Standing::tied);
}

// The order statistics of the tables of the sign test (Conover 1999, table A3 and sec. 3.2).
TEST(CostStatistics, IntervalsAreTheSignTests) {
    const auto interval = [](int n, cost::Confidence confidence) {
        std::vector<double> values;
        for (int i = 1; i <= n; ++i) values.push_back(i);
        const Estimate e = cost::median_estimate(values, confidence);
        return std::pair(e.low, e.high);
    };
    const double never = std::numeric_limits<double>::infinity();
    using cost::Confidence;
    EXPECT_EQ(interval(5, Confidence::shown), std::pair(0.0, never));
    EXPECT_EQ(interval(6, Confidence::shown), std::pair(1.0, 6.0));
    EXPECT_EQ(interval(9, Confidence::shown), std::pair(2.0, 8.0));
    EXPECT_EQ(interval(20, Confidence::shown), std::pair(6.0, 15.0));
    EXPECT_EQ(interval(25, Confidence::shown), std::pair(8.0, 18.0));
    EXPECT_EQ(interval(7, Confidence::deciding), std::pair(0.0, never));
    EXPECT_EQ(interval(8, Confidence::deciding), std::pair(1.0, 8.0));
    EXPECT_EQ(interval(25, Confidence::deciding), std::pair(6.0, 20.0));
}

// Times scatter upwards; the interval holds the median all the same, of few values as of many.
TEST(CostStatistics, IntervalsHoldTheMedianAsOftenAsTheySay) {
    std::mt19937_64 random(5);
    std::normal_distribution<double> normal;
    for (const std::size_t n : {2u, 3u, 4u, 5u, 6u, 7u, 8u, 9u, 12u, 25u}) {
        int shown = 0, deciding = 0;
        constexpr int trials = 2000;
        for (int trial = 0; trial < trials; ++trial) {
            std::vector<double> values(n);
            for (double& v : values) v = std::exp(0.2 * normal(random));  // of median 1
            const auto holds = [&](cost::Confidence confidence) {
                const Estimate e = cost::median_estimate(values, confidence);
                EXPECT_LE(e.low, e.value);
                EXPECT_GE(e.high, e.value);
                return e.low <= 1 && 1 <= e.high;
            };
            shown += holds(cost::Confidence::shown);
            deciding += holds(cost::Confidence::deciding);
        }
        // Less three standard deviations.
        EXPECT_GE(shown, 1900 - 29) << n;
        EXPECT_GE(deciding, 1980 - 13) << n;
    }
}

TEST(CostStatistics, SmallSamples) {
    EXPECT_EQ(cost::median(std::vector<double>{}), 0);
    EXPECT_EQ(cost::median(std::vector<double>{4, 1, 3, 2}), 2.5);
    EXPECT_EQ(cost::quantile(std::vector<double>{4, 1, 3, 2}, 0.5), 2);
    EXPECT_EQ(cost::quantile(std::vector<double>{4, 1, 3, 2}, 1), 4);
    const Estimate one = cost::median_estimate(std::vector<double>{3});
    EXPECT_EQ(one.value, 3);
    EXPECT_TRUE(std::isinf(one.high));
    EXPECT_EQ(cost::relative_spread(std::vector<double>{1, 1, 1}), 0);
}

// Angles whose sine and cosine are Pythagorean or tiny, where acos of floats sees 0.
TEST(CostMetrics, AnglesAreExactNearZeroAndNearAHalfTurn) {
    using cost::Vector;
    EXPECT_NEAR(cost::degrees_between({1, 0, 0}, {0, 2, 0}), 90, 1e-12);
    for (const double t : {1e-12, 1e-9, 1e-6, 1e-3}) {
        EXPECT_NEAR(cost::degrees_between({1, 0, 0}, {1, t, 0}) / (std::atan(t) * 180 / M_PI), 1,
                    1e-12);
        EXPECT_NEAR(180 - cost::degrees_between({1, 0, 0}, {-1, t, 0}), std::atan(t) * 180 / M_PI,
                    1e-9);
    }
    EXPECT_NEAR(cost::degrees_between({3e-4000L, 4e-4000L, 0}, {1e4000L, 0, 0}),
                std::atan2(4.0, 3.0) * 180 / M_PI, 1e-12);
    EXPECT_EQ(cost::degrees_between({0, 0, 0}, {1, 0, 0}), 180);
    EXPECT_EQ(cost::degrees_between({std::nanl(""), 0, 0}, {1, 0, 0}), 180);
}

TEST(CostMetrics, SummariesAndPictures) {
    std::vector<double> values(1000, 1.0);
    values[7] = 5;
    const cost::Summary s = cost::summary_of(values);
    EXPECT_EQ(s.largest, 5);
    EXPECT_EQ(s.p999, 1);
    EXPECT_NEAR(s.mean, 1.004, 1e-12);
    values[8] = std::nan("");
    EXPECT_TRUE(std::isinf(cost::summary_of(values).largest));

    const cost::Pixels a{2, 1, 1, {0, 0.5}}, b{2, 1, 1, {0.3, 0.1}};
    const cost::PictureError e = cost::picture_error(a, b);
    EXPECT_NEAR(e.rmse, std::sqrt((0.09 + 0.16) / 2), 1e-12);
    EXPECT_NEAR(e.largest, 0.4, 1e-12);
    EXPECT_NEAR(e.psnr, -20 * std::log10(e.rmse), 1e-12);
    EXPECT_NEAR(cost::picture_error(a, b, {true, false}).rmse, 0.3, 1e-12);
    EXPECT_TRUE(std::isinf(cost::picture_error(a, a).psnr));
    const cost::Pixels hole{2, 1, 1, {std::nan(""), 0.5}};
    EXPECT_TRUE(std::isinf(cost::picture_error(hole, a).largest));
    EXPECT_TRUE(std::isinf(cost::picture_error(hole, a).rmse));
}

}  // namespace
