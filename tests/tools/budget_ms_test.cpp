// `render --budget-ms`: what is chosen by known costs, what is kept in the cache, what is said.
// Times themselves are the machine's: nothing here depends on how long anything takes.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <array>
#include <atomic>
#include <cstdlib>
#include <optional>
#include <set>
#include <sstream>
#include <thread>

#include "command_runner.h"
#include "meshprep/budgets/cost_cache.h"
#include "meshprep/budgets/explicit_command.h"
#include "meshprep/budgets/time_budget.h"

namespace {

using meshprep::Json;
using meshprep::PilotTimes;
using meshprep::SamplingCost;
using meshprep::SamplingRung;
using test::run_here;
using test::TempDir;
using test::write_text;

// A variable of the environment for as long as this lives.
class Variable {
  public:
    Variable(const char* name, const std::string& value) : name_(name) {
        if (const char* const old = std::getenv(name)) old_ = old;
        ::setenv(name, value.c_str(), 1);
    }
    ~Variable() {
        if (old_)
            ::setenv(name_, old_->c_str(), 1);
        else
            ::unsetenv(name_);
    }
    Variable(const Variable&) = delete;
    Variable& operator=(const Variable&) = delete;

  private:
    const char* name_;
    std::optional<std::string> old_;
};

std::string words_of(const SamplingRung& rung) {
    return rung.words();
}

// Each sampling costs what it has of points in a pixel, and for triangles nothing more.
std::vector<SamplingCost> costs_by_points() {
    std::vector<SamplingCost> costs;
    for (const SamplingRung& r : meshprep::sampling_rungs())
        costs.push_back({r, 1, double(r.samples * r.supersample * r.supersample)});
    return costs;
}

TEST(BudgetMs, PilotsAreSolvedForWhatPixelsTake) {
    // 3 ms and 0.4 ms a pixel, for all the sizes that rounding can make.
    for (const double pixels : {1.0, 5.0, 6.0, 25.0})
        for (const double more : {1.0, 3.0, 75.0}) {
            const double larger = pixels + more;
            const PilotTimes p = meshprep::pilot_from_times({pixels, 3 + 0.4 * pixels},
                                                            {larger, 3 + 0.4 * larger}, 100);
            EXPECT_NEAR(p.fixed, 3, 1e-12);
            EXPECT_NEAR(p.pixels, 40, 1e-12);
            EXPECT_FALSE(p.noisy);
        }
    // Clocks that make the smaller picture the slower one, and pictures of one size: never less
    // than were all of it the pixels'.
    for (const double smaller : {4.0, 5.0}) {
        const PilotTimes odd = meshprep::pilot_from_times({1, smaller}, {4, 4}, 16);
        EXPECT_EQ(odd.fixed, 0);
        EXPECT_EQ(odd.pixels, 16);
        EXPECT_TRUE(odd.noisy);
    }
    EXPECT_EQ(meshprep::pilot_from_times({4, 3}, {4, 4}, 16).pixels, 16);
    // A smaller picture that is too fast makes no more of them than that.
    EXPECT_EQ(meshprep::pilot_from_times({1, 0}, {4, 4}, 16).pixels, 16);
    EXPECT_EQ(meshprep::pilot_from_times({1, 0}, {4, 4}, 16).fixed, 0);
    EXPECT_EQ(meshprep::pilot_from_times({1, 0}, {4, 4}, 16).count, 16);
    // 2 million pixels, of which 10 ms are what empty ones take.
    const PilotTimes pilot{3, 40, 7, 2e6};
    const SamplingCost one{{1, 1}, 1, 1, 5}, four{{4, 1}, 1.5, 2.5, 20};
    EXPECT_NEAR(meshprep::predicted_ms(pilot, four, one), 7 + 3 * 1.5 + 30 * 2.5 + 40, 1e-12);
    EXPECT_NEAR(meshprep::predicted_ms(pilot, one, one), 7 + 3 + 40, 1e-12);
    // A pilot that is faster than empty pictures: nothing is drawn then.
    EXPECT_NEAR(meshprep::predicted_ms({3, 4, 7, 2e6}, four, one), 7 + 4.5 + 40, 1e-12);
}

// What is drawn for a pilot is counted, not timed.
TEST(BudgetMs, PilotsAreWholeAndSmallerPicturesInBands) {
    const prep::PreparedScene scene;
    rast::SceneRenderer renderer(scene);
    rast::RenderRequest request;
    request.width = 403;
    request.height = 801;
    request.threads = 1;
    request.band_bytes = 1;
    using Size = std::array<std::uint32_t, 4>;
    std::set<Size> asked;
    std::set<std::size_t> views;
    const auto plan_for = [&](const rast::RenderRequest& r, std::size_t view) {
        EXPECT_EQ(r.samples * r.supersample, 1);
        const rast::Crop crop = r.crop.value_or(rast::Crop{0, 0, r.width, r.height});
        EXPECT_LE(crop.x + crop.width, r.width);
        EXPECT_LE(crop.y + crop.height, r.height);
        asked.insert({r.width, r.height, crop.width, crop.height});
        views.insert(view);
        return rast::plan(scene, r);
    };
    const auto pilot = meshprep::pilot_of(renderer, request, 8, plan_for);
    ASSERT_TRUE(pilot) << to_string(pilot.error());
    EXPECT_EQ(asked,
              (std::set<Size>{{100, 200, 100, 200}, {201, 400, 201, 400}, {403, 801, 403, 801}}));
    EXPECT_EQ(views, (std::set<std::size_t>{0, 2, 4, 6}));
    EXPECT_EQ(pilot->count, 8.0 * 403 * 801);
    EXPECT_NEAR(pilot->fixed + pilot->pixels, pilot->one.whole, 1e-9 * pilot->one.whole);
    EXPECT_GT(pilot->band_pixels, 0u);
    EXPECT_LT(pilot->band_pixels, 403u * 801 / 2);  // as the picture itself, in bands
    asked.clear();
    request.crop = rast::Crop{400, 0, 3, 3};
    ASSERT_TRUE(meshprep::pilot_of(renderer, request, 1, plan_for));
    EXPECT_EQ(asked, (std::set<Size>{{100, 200, 1, 1}, {201, 400, 1, 1}, {403, 801, 3, 3}}));
}

// Samples cost 5 ms for the length of edges, half of that at half the size, and 3 for triangles at
// any. Shaded points cost 64 ms for pixels, a fourth of that at half the size, and 3.
TEST(BudgetMs, WholePicturesFollowFromSmallerOnes) {
    const meshprep::SizeTimes one{20, 8, 5};  // a line says 20
    EXPECT_NEAR(meshprep::whole_ms({4, 1}, {0, 8 + 5.5, 5 + 4.25}, one), 20 + 8, 1e-12);
    EXPECT_NEAR(meshprep::whole_ms({1, 3}, {0, 16 + 3, 4 + 3}, one), 64 + 3, 1e-12);
    // A line through 3 + 48 / 16 and 3 + 48 / 4 says 51 where one sample took 51 / 4.
    const meshprep::SizeTimes bent{51.0 / 4, 15, 6};
    EXPECT_NEAR(meshprep::whole_ms({1, 3}, {0, 16 + 3, 4 + 3}, bent), (64 + 3) / 2.0, 1e-12);
    // Clocks that make smaller pictures the slower ones, and more samples the faster ones.
    EXPECT_EQ(meshprep::whole_ms({4, 1}, {0, 9, 15}, one), 21);
    EXPECT_EQ(meshprep::whole_ms({4, 1}, {0, 7, 4}, one), 20);
    EXPECT_EQ(meshprep::whole_ms({1, 3}, {0, 4, 5}, one), 20);  // as one sample: 16 on a line
    // Where triangles are all that counts, a last bit of one sample's clock changes little.
    const double slower = meshprep::whole_ms({1, 3}, {0, 110, 103}, {100, 100.1, 100});
    const double faster = meshprep::whole_ms({1, 3}, {0, 110, 103}, {100, 99.9, 100});
    EXPECT_NEAR(slower, 138, 1);
    EXPECT_NEAR(faster, 138, 1);
    // Whatever parts of the pixels small pictures have: 3 and 98 ms of 7 × 7, 3 × 3 and 1 × 1; and
    // for their edges 3 and 7 ms.
    const meshprep::SizeTimes tiny{0, 3 + 18, 3 + 2, 9.0 / 49, 1.0 / 49};
    EXPECT_NEAR(meshprep::whole_ms({1, 3}, tiny, {20, 0, 0, 9.0 / 49, 1.0 / 49}), 101, 1e-9);
    const meshprep::SizeTimes edges{0, 8 + 6, 5 + 4, 9.0 / 49, 1.0 / 49};
    EXPECT_NEAR(meshprep::whole_ms({4, 1}, edges, {20, 8, 5, 9.0 / 49, 1.0 / 49}), 20 + 10, 1e-9);
    EXPECT_EQ(meshprep::of_all_views(3, 8, 4), 6);
}

TEST(BudgetMs, CostsAreWhatManyTrianglesAddToFew) {
    const SamplingCost c = meshprep::cost_from_times({4, 1}, {8, 38, 2}, {3, 13, 1});
    EXPECT_EQ(c.pixels, 3);
    EXPECT_EQ(c.triangles, 3);
    EXPECT_EQ(c.empty, 2e6 / meshprep::calibration_pixels);
    // Nothing that a clock says makes more samples cheaper than one.
    const SamplingCost cheaper = meshprep::cost_from_times({4, 1}, {5, 6, 1}, {9, 19, 1});
    EXPECT_EQ(cheaper.pixels, 1);
    EXPECT_EQ(cheaper.triangles, 1);
    for (const double few : {0.0, 1.0, 9.0})
        for (const double one : {0.0, 1.0, 9.0}) {
            const SamplingCost odd =
                meshprep::cost_from_times({4, 1}, {few, 1, one}, {one, 1, few});
            EXPECT_GE(odd.pixels, 1);
            EXPECT_GE(odd.triangles, 1);
        }
}

// What draws smaller pictures `factor` times as slowly as costs_by_points() say.
class Drawn {
  public:
    explicit Drawn(double factor = 1) : factor_(factor) {}
    static PilotTimes pilot() {
        PilotTimes pilot{2, 10};
        pilot.one = {12, 2 + 10.0 / 4, 2 + 10.0 / 16};
        return pilot;
    }
    meshprep::SamplingTimes chosen(double asked, std::uint32_t extent = 1000,
                                   std::vector<SamplingCost> costs = costs_by_points()) {
        const auto draw = [this](const SamplingRung& rung) -> prep::Result<meshprep::SizeTimes> {
            drawn.push_back(words_of(rung));
            const double whole =
                factor_ * (2 + 10.0 * rung.samples * rung.supersample * rung.supersample);
            const meshprep::SizeTimes one = pilot().one;
            if (rung.samples > 1)
                return meshprep::SizeTimes{0, one.half + whole - 12, one.quarter + whole - 12};
            const double fixed = 2 * factor_;
            return meshprep::SizeTimes{0, fixed + (whole - fixed) / 4,
                                       fixed + (whole - fixed) / 16};
        };
        const auto out = meshprep::chosen_within(asked, pilot(), costs, extent, draw);
        EXPECT_TRUE(out);
        return *out;
    }
    std::vector<std::string> drawn;

  private:
    double factor_;
};

TEST(BudgetMs, TheMostAccurateThatFitsIsChosen) {
    const auto chosen = [](double asked, std::uint32_t extent = 1000) {
        return Drawn().chosen(asked, extent);
    };
    EXPECT_TRUE(chosen(12).met);
    EXPECT_EQ(chosen(12).chosen.setting, words_of({1, 1}));
    EXPECT_EQ(chosen(12).chosen.milliseconds, 12);
    EXPECT_EQ(chosen(12).next->setting, words_of({2, 1}));
    EXPECT_EQ(chosen(41.9).chosen.setting, words_of({2, 1}));
    // Four points: supersampling has less error than samples.
    EXPECT_EQ(chosen(42.001).chosen.setting, words_of({1, 2}));
    EXPECT_EQ(chosen(91.9).chosen.setting, words_of({8, 1}));
    EXPECT_EQ(chosen(1e9).chosen.setting, words_of({1, 8}));
    EXPECT_FALSE(chosen(1e9).next);
    // A picture that is too large for it.
    EXPECT_EQ(chosen(1e9, 8192).chosen.setting, words_of({1, 4}));
    const auto none = chosen(11.9);
    EXPECT_FALSE(none.met);
    EXPECT_EQ(none.chosen.setting, words_of({1, 1}));
    EXPECT_EQ(none.tried.size(), 10u);
    // What is more accurate may cost less: the last that fits counts, not the last before one that
    // does not.
    auto odd = costs_by_points();
    odd[2].pixels = 1000;  // supersampling by 2
    EXPECT_EQ(Drawn().chosen(700, 100, odd).chosen.setting, words_of({1, 8}));
}

// Guesses are of another picture: what is chosen was drawn.
TEST(BudgetMs, WhatIsGuessedToFitIsDrawnSmaller) {
    // All as guessed: one is drawn, and nothing where one sample is all that fits.
    Drawn as_guessed;
    EXPECT_TRUE(as_guessed.chosen(100).chosen.measured);
    EXPECT_EQ(as_guessed.drawn, std::vector<std::string>{words_of({1, 3})});
    EXPECT_EQ(as_guessed.chosen(12).chosen.setting, words_of({1, 1}));
    EXPECT_EQ(as_guessed.drawn.size(), 1u);
    // Twice as slow: points by 3 take 184 ms, and by 2, in proportion, 84. 8 samples, guessed at
    // 82, are more accurate; they are drawn and take 164.
    Drawn slow(2);
    const auto held = slow.chosen(100);
    EXPECT_EQ(slow.drawn,
              (std::vector<std::string>{words_of({1, 3}), words_of({8, 1}), words_of({1, 2})}));
    EXPECT_EQ(held.chosen.setting, words_of({1, 2}));
    EXPECT_NEAR(held.chosen.milliseconds, 84, 1e-9);
    EXPECT_NEAR(held.next->milliseconds, 164, 1e-9);
    EXPECT_EQ(held.next->setting, words_of({8, 1}));
    EXPECT_TRUE(held.next->measured);
    // A fourth of it: what was guessed too slow is drawn, too.
    Drawn fast(0.25);
    const auto more = fast.chosen(100);
    EXPECT_EQ(more.chosen.setting, words_of({1, 6}));
    EXPECT_NEAR(more.chosen.milliseconds, 0.25 * 362, 1e-9);
    EXPECT_EQ(fast.drawn, (std::vector<std::string>{words_of({1, 3}), words_of({1, 6})}));
    // What no one drew is a guess, and says so.
    for (const auto& tried : more.tried)
        EXPECT_EQ(tried.measured, tried.setting == words_of({1, 1}) ||
                                      tried.setting == words_of({1, 3}) ||
                                      tried.setting == words_of({1, 6}))
            << tried.setting;
    const auto failing = [](const SamplingRung&) -> prep::Result<meshprep::SizeTimes> {
        return prep::Error{prep::ErrorCode::limit, "too large", ""};
    };
    EXPECT_FALSE(meshprep::chosen_within(100, Drawn::pilot(), costs_by_points(), 100, failing));
}

class BudgetCache : public ::testing::Test {
  protected:
    BudgetCache() { write_text(dir_ / "ball.obj", test::sphere_obj(14, 7)); }
    std::filesystem::path file() const { return dir_ / "cache/meshprep/costs.json"; }
    test::Ran draw(const std::vector<std::string>& more, const std::string& name = "o.png",
                   const char* threads = "1") {
        std::vector<std::string> words = {"render",       (dir_ / "ball.obj").string(),
                                          "-o",           (dir_ / name).string(),
                                          "--size=64x48", "--json",
                                          "--threads",    threads};
        words.insert(words.end(), more.begin(), more.end());
        return run_here(words);
    }
    // Each sampling costs this many times one sample, as if measured.
    void seed(double factor, int threads = 1) {
        auto costs = costs_by_points();
        for (SamplingCost& cost : costs) cost.triangles = cost.pixels = factor;
        ASSERT_TRUE(meshprep::keep_costs(file(), meshprep::sampling_key(threads),
                                         meshprep::to_json(costs)));
    }
    TempDir dir_;
    Variable cache_{"XDG_CACHE_HOME", (dir_ / "cache").string()};
};

TEST_F(BudgetCache, CostsAreMeasuredOnceAndKept) {
    const test::Ran first = draw({"--budget-ms", "1e9"});
    ASSERT_EQ(first.exit_code, 0) << first.err;
    // A busy machine's are used and not kept, and that is said.
    if (!std::filesystem::exists(file())) {
        EXPECT_NE(first.err.find("the machine is busy"), std::string::npos) << first.err;
        seed(1);
    }
    const Json b = first.json()["budget"];
    EXPECT_EQ(b["costs"], "measured");
    EXPECT_EQ(b["met"], true);
    EXPECT_EQ(b["overrun"], false);
    EXPECT_GT(b["taken"].get<double>(), 0);
    EXPECT_EQ(b["chosen"]["setting"], words_of({1, 8}));
    EXPECT_TRUE(b["next"].is_null());
    EXPECT_EQ(b["tried"].size(), 10u);
    EXPECT_EQ(Json::parse(test::file_text(file()))["entries"].size(), 1u);
    const std::string kept = test::file_text(file());
    EXPECT_EQ(draw({"--budget-ms", "1e9"}).json()["budget"]["costs"], "cached");
    EXPECT_EQ(test::file_text(file()), kept);
    // Another number of threads is measured for itself, beside.
    EXPECT_EQ(draw({"--budget-ms", "1e9"}, "o.png", "2").json()["budget"]["costs"], "measured");
    seed(1, 2);
    EXPECT_EQ(Json::parse(test::file_text(file()))["entries"].size(), 2u);
    EXPECT_EQ(draw({"--budget-ms", "1e9"}).json()["budget"]["costs"], "cached");
}

TEST_F(BudgetCache, WhatIsKeptDecides) {
    for (const double factor : {1.0, 1000.0}) {
        seed(factor);
        const Json b = draw({"--budget-ms", "1e9"}).json()["budget"];
        const Json& pilot = b["pilot"];
        const double of_one = pilot["fixed"].get<double>() + pilot["pixels"].get<double>();
        int guessed = 0;
        for (const Json& tried : b["tried"]) {
            const std::string setting = tried["setting"];
            EXPECT_EQ(tried["measured"], setting == words_of({1, 1}) || setting == words_of({1, 8}))
                << setting;
            if (setting.find("--samples 1 ") != std::string::npos) continue;
            ++guessed;  // nothing of its kind was drawn
            EXPECT_NEAR(tried["milliseconds"].get<double>() - pilot["first"].get<double>(),
                        factor * of_one, 1e-9 * factor * of_one);
        }
        EXPECT_EQ(guessed, 4);
        EXPECT_GE(b["taken"], pilot["first"]);
    }
    // So dear that nothing fits: the picture is drawn all the same, and the exit code says it.
    const test::Ran dear = draw({"--budget-ms", "1e-3"}, "dear.png");
    EXPECT_EQ(dear.exit_code, 1);
    EXPECT_EQ(dear.json()["budget"]["met"], false);
    EXPECT_EQ(dear.json()["budget"]["chosen"]["setting"], words_of({1, 1}));
    EXPECT_NE(dear.err.find("nothing is predicted to draw within 0.001 ms"), std::string::npos);
    EXPECT_TRUE(std::filesystem::exists(dir_ / "dear.png"));
    // The cache is not read, and nothing is kept.
    EXPECT_EQ(draw({"--budget-ms", "1e9", "--no-cache"}).json()["budget"]["costs"], "measured");
    std::filesystem::remove_all(dir_ / "cache");
    EXPECT_EQ(draw({"--budget-ms", "1e9", "--no-cache"}).json()["budget"]["costs"], "measured");
    EXPECT_FALSE(std::filesystem::exists(dir_ / "cache"));
}

TEST_F(BudgetCache, TheCommandThatIsPrintedDrawsTheSameBytes) {
    for (const char* ms : {"0", "1e9"}) {
        seed(1);
        const test::Ran ran = draw({"--budget-ms", ms, "--shading", "flat"});
        ASSERT_EQ(ran.exit_code, ms[0] == '0' ? 1 : 0) << ran.err;
        const std::string picture = test::file_text(dir_ / "o.png");
        std::string again = ran.json()["budget"]["command"];
        EXPECT_EQ(again.find("budget"), std::string::npos) << again;
        EXPECT_EQ(again.find("cache"), std::string::npos) << again;
        again = "'" + test::command_path().string() + "'" + again.substr(8);
        ASSERT_EQ(test::run_program("/bin/sh", {"-c", again}).exit_code, 0) << again;
        EXPECT_EQ(test::file_text(dir_ / "o.png"), picture) << again;
    }
}

TEST(ExplicitCommand, NamesFilesThatAShellAndTheCommandTakeForFiles) {
    const auto command = [](const char* input, const char* output) {
        return meshprep::explicit_command("render", input, output, {{"--size", {"8x8"}}},
                                          "--samples=4");
    };
    EXPECT_EQ(command("a b.obj", "o.png"),
              "meshprep render 'a b.obj' -o o.png --size=8x8 --samples=4");
    EXPECT_EQ(command("-x.obj", "-o.png"),
              "meshprep render ./-x.obj -o ./-o.png --size=8x8 --samples=4");
    EXPECT_EQ(command("-", "-"), "meshprep render - -o - --size=8x8 --samples=4");
}

TEST_F(BudgetCache, TheCommandThatIsPrintedForStandardOutputDrawsTheSameBytes) {
    seed(1);
    const test::Ran ran = run_here({"render", (dir_ / "ball.obj").string(), "-o", "-", "--format",
                                    "png", "--size=64x48", "--threads=1", "--budget-ms=1e9"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    const std::string said = "the same again: meshprep";
    const std::size_t at = ran.err.find(said);
    ASSERT_NE(at, std::string::npos) << ran.err;
    const std::size_t from = at + said.size();
    const std::string again = "'" + test::command_path().string() + "'" +
                              ran.err.substr(from, ran.err.find('\n', from) - from);
    const test::Ran same = test::run_program("/bin/sh", {"-c", again});
    ASSERT_EQ(same.exit_code, 0) << again;
    EXPECT_EQ(same.out, ran.out);
}

TEST_F(BudgetCache, OverrunsAreTold) {
    meshprep::SamplingTimes c;
    c.asked = 10;
    c.met = true;
    c.taken = 10;
    EXPECT_EQ(meshprep::to_json(c, "")["overrun"], false);
    c.taken = 25;
    EXPECT_EQ(meshprep::to_json(c, "")["overrun"], true);
    std::ostringstream out, err;
    meshprep::Console console(out, err, false);
    meshprep::say_time({}, c, meshprep::drawing_work, "again", console);
    EXPECT_NE(err.str().find("drawing took 25 ms, 2.5 times what was asked"), std::string::npos)
        << err.str();
}

// Neither waited for nor written into.
TEST_F(BudgetCache, APipeInTheCachesPlaceIsToldAndNoFailure) {
    std::filesystem::create_directories(file().parent_path());
    ASSERT_EQ(::mkfifo(file().c_str(), 0600), 0);
    const meshprep::CostKey key{"sampling", "1", "b", "p", 1};
    EXPECT_FALSE(meshprep::cached_costs(file(), key));
    const auto kept = meshprep::keep_costs(file(), key, Json(1));
    ASSERT_FALSE(kept);
    EXPECT_EQ(kept.error().code, prep::ErrorCode::io);
    EXPECT_NE(kept.error().text.find("no regular file"), std::string::npos);
}

// One reader beside two writers finds what one of them wrote, whole.
TEST_F(BudgetCache, NobodyReadsHalfAFile) {
    const meshprep::CostKey key{"sampling", "1", "b", "p", 1};
    const Json values[2] = {Json(std::string(20000, 'a')), Json(std::string(30000, 'b'))};
    ASSERT_TRUE(meshprep::keep_costs(file(), key, values[0]));
    std::vector<std::thread> writers;
    std::atomic<int> left = 2;
    for (const Json& value : values)
        writers.emplace_back([&] {
            for (int n = 0; n < 100; ++n) EXPECT_TRUE(meshprep::keep_costs(file(), key, value));
            --left;
        });
    while (left > 0) {
        const auto found = meshprep::cached_costs(file(), key);
        EXPECT_TRUE(found == values[0] || found == values[1]);
    }
    for (std::thread& writer : writers) writer.join();
}

// Names of virtual processors are free text.
TEST_F(BudgetCache, NamesThatAreNoUtf8AreKept) {
    const meshprep::CostKey key{"sampling", "1", "b", "p\xff\xfe", 1};
    ASSERT_TRUE(meshprep::keep_costs(file(), key, Json(3)));
    EXPECT_EQ(meshprep::cached_costs(file(), key), Json(3));
}

TEST_F(BudgetCache, WhatIsDamagedIsMeasuredAnew) {
    seed(1);
    const Json good = Json::parse(test::file_text(file()));
    const std::string too_large = good.dump() + std::string(2 << 20, ' ');
    const std::string deep = std::string(200'000, '[') + std::string(200'000, ']');
    std::vector<std::string> damaged = {"",
                                        "{",
                                        "[]",
                                        "{\"layout\":1}",
                                        "{\"layout\":\"x\"}",
                                        too_large,
                                        good.dump().substr(0, 200),
                                        "{\"layout\":1,\"entries\":" + deep + "}"};
    Json of_two = good;
    of_two["layout"] = 2;
    damaged.push_back(of_two.dump());
    std::string nested = good.dump();
    const std::size_t costs_at = nested.find("\"costs\":[") + 8;
    damaged.push_back(nested.replace(costs_at, nested.find(']', costs_at) + 1 - costs_at, deep));
    const auto changed = [&](const auto& change) {
        Json json = good;
        change(json["entries"][0]);
        damaged.push_back(json.dump());
    };
    changed([](Json& e) { e = 7; });
    changed([](Json& e) { e["version"] = "0.0.0"; });
    changed([](Json& e) { e["build"] = "another"; });
    changed([](Json& e) { e["processor"] = "another"; });
    changed([](Json& e) { e["threads"] = "1"; });
    changed([](Json& e) { e["threads"] = 1.5; });
    changed([](Json& e) { e["costs"] = 1; });
    changed([](Json& e) { e["costs"].erase(3); });
    changed([](Json& e) { e["costs"][3]["samples"] = 5; });
    changed([](Json& e) { e["costs"][3]["pixels"] = "1"; });
    changed([](Json& e) { e["costs"][3]["pixels"] = 0; });
    changed([](Json& e) { e["costs"][3]["triangles"] = -1; });
    changed([](Json& e) { e["costs"][3]["triangles"] = 0.99; });
    changed([](Json& e) { e["costs"][3]["triangles"] = 1001; });
    changed([](Json& e) { e["costs"][3].erase("empty"); });
    changed([](Json& e) { e["costs"][3]["empty"] = -1; });
    const meshprep::CostKey key = meshprep::sampling_key(1);
    const auto taken = meshprep::cached_costs(file(), key);
    ASSERT_TRUE(taken && meshprep::sampling_costs_from(*taken));
    for (const std::string& text : damaged) {
        SCOPED_TRACE(text.substr(0, 300));
        write_text(file(), text);
        const auto found = meshprep::cached_costs(file(), key);
        EXPECT_FALSE(found && meshprep::sampling_costs_from(*found));
        EXPECT_TRUE(meshprep::keep_costs(file(), key, Json(5)));
        EXPECT_EQ(meshprep::cached_costs(file(), key), Json(5));
    }
    // One of them from outside, and then there is a cache again.
    write_text(file(), "{");
    EXPECT_EQ(draw({"--budget-ms", "1e9"}).json()["budget"]["costs"], "measured");
}

TEST_F(BudgetCache, ACacheThatCannotBeWrittenIsToldAndNoFailure) {
    write_text(dir_ / "cache", "a file");
    const test::Ran ran = draw({"--budget-ms", "1e9"});
    EXPECT_EQ(ran.exit_code, 0);
    EXPECT_NE(ran.err.find("measured costs are not kept"), std::string::npos) << ran.err;
}

TEST_F(BudgetCache, KeepsTheLastSixteen) {
    for (int threads = 1; threads <= 20; ++threads)
        ASSERT_TRUE(
            meshprep::keep_costs(file(), {"sampling", "1", "b", "p", threads}, Json(threads)));
    EXPECT_FALSE(meshprep::cached_costs(file(), {"sampling", "1", "b", "p", 4}));
    EXPECT_EQ(meshprep::cached_costs(file(), {"sampling", "1", "b", "p", 5}), Json(5));
    // Kept again: still the same number of others.
    ASSERT_TRUE(meshprep::keep_costs(file(), {"sampling", "1", "b", "p", 7}, Json("new")));
    EXPECT_EQ(meshprep::cached_costs(file(), {"sampling", "1", "b", "p", 5}), Json(5));
    EXPECT_EQ(meshprep::cached_costs(file(), {"sampling", "1", "b", "p", 7}), Json("new"));
}

TEST(BudgetMs, TheCacheIsWhereTheUserHasCaches) {
    const Variable home("HOME", "/home/someone");
    {
        const Variable cache("XDG_CACHE_HOME", "/var/somewhere");
        EXPECT_EQ(meshprep::cost_cache_file(), "/var/somewhere/meshprep/costs.json");
    }
    const Variable relative("XDG_CACHE_HOME", "caches");
    EXPECT_EQ(meshprep::cost_cache_file(), "/home/someone/.cache/meshprep/costs.json");
    const Variable none("HOME", "");
    EXPECT_EQ(meshprep::cost_cache_file(), std::nullopt);
}

TEST(BudgetMs, RefusesWhatMakesNoSense) {
    const std::vector<std::vector<std::string>> refused = {
        {"--budget-ms", "-1"},
        {"--budget-ms", "nan"},
        {"--budget-ms", "soon"},
        {"--budget-ms", "9", "--samples", "4"},
        {"--budget-ms", "9", "--supersample", "2"},
        {"--budget-ms", "9", "--coverage", "area"},
        {"--budget-ms", "9", "--image-error", "2"},
        {"--no-cache"}};
    for (const std::vector<std::string>& more : refused) {
        std::vector<std::string> words = {"render", "x.obj", "-o", "x.png"};
        words.insert(words.end(), more.begin(), more.end());
        EXPECT_EQ(run_here(words).exit_code, 2) << more[0] << " " << more.back();
    }
}

}  // namespace
