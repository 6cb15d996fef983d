// `render --budget-ms`: what is chosen by known costs, what is kept in the cache, what is said.
// Times themselves are the machine's: nothing here depends on how long anything takes.
#include <gtest/gtest.h>

#include <cstdlib>
#include <optional>

#include "command_runner.h"
#include "meshprep/budgets/cost_cache.h"
#include "meshprep/budgets/time_budget.h"

namespace {

using meshprep::Json;
using meshprep::PilotTimes;
using meshprep::SamplingCost;
using meshprep::SamplingRung;
using test::run_here;
using test::TemporaryDirectory;
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
    const PilotTimes p = meshprep::pilot_from_times(3 + 40.0 / 16, 3 + 40.0 / 4);
    EXPECT_NEAR(p.fixed, 3, 1e-12);
    EXPECT_NEAR(p.pixels, 40, 1e-12);
    // Clocks that make the smaller picture the slower one.
    const PilotTimes odd = meshprep::pilot_from_times(5, 4);
    EXPECT_EQ(odd.fixed, 5);
    EXPECT_EQ(odd.pixels, 0);
    EXPECT_NEAR(meshprep::predicted_ms({3, 40}, {{4, 1}, 1.5, 2.5}), 4.5 + 100, 1e-12);
}

TEST(BudgetMs, CostsAreWhatManyTrianglesAddToFew) {
    const SamplingCost c = meshprep::cost_from_times({4, 1}, 6, 36, 2, 12);
    EXPECT_EQ(c.pixels, 3);
    EXPECT_EQ(c.triangles, 3);
    // Nothing that a clock says makes more samples cheaper than one.
    for (const double few : {0.0, 1.0, 9.0})
        for (const double one : {0.0, 1.0, 9.0}) {
            const SamplingCost odd = meshprep::cost_from_times({4, 1}, few, 1, one, 1);
            EXPECT_GE(odd.pixels, 1);
            EXPECT_GE(odd.triangles, 1);
        }
}

TEST(BudgetMs, TheMostAccurateThatFitsIsChosen) {
    const auto chosen = [](double asked, std::uint32_t extent = 1000) {
        return meshprep::chosen_within(asked, {2, 10}, costs_by_points(), extent);
    };
    EXPECT_TRUE(chosen(12).met);
    EXPECT_EQ(words_of(chosen(12).chosen.rung), words_of({1, 1}));
    EXPECT_EQ(chosen(12).chosen.milliseconds, 12);
    EXPECT_EQ(words_of(chosen(12).next->rung), words_of({2, 1}));
    EXPECT_EQ(words_of(chosen(41.9).chosen.rung), words_of({2, 1}));
    // Four points: supersampling has less error than samples.
    EXPECT_EQ(words_of(chosen(42).chosen.rung), words_of({1, 2}));
    EXPECT_EQ(words_of(chosen(91.9).chosen.rung), words_of({8, 1}));
    EXPECT_EQ(words_of(chosen(1e9).chosen.rung), words_of({1, 8}));
    EXPECT_FALSE(chosen(1e9).next);
    // A picture that is too large for it.
    EXPECT_EQ(words_of(chosen(1e9, 8192).chosen.rung), words_of({1, 4}));
    const auto none = chosen(11.9);
    EXPECT_FALSE(none.met);
    EXPECT_EQ(words_of(none.chosen.rung), words_of({1, 1}));
    EXPECT_EQ(none.tried.size(), 10u);
    // What is more accurate may cost less: the last that fits counts, not the last before one that
    // does not.
    auto odd = costs_by_points();
    odd[2].pixels = 100;  // supersampling by 2
    EXPECT_EQ(words_of(meshprep::chosen_within(100, {0, 1}, odd, 100).chosen.rung),
              words_of({1, 8}));
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
    // What the cache says of one thread is replaced.
    void seed(double factor) {
        Json json = Json::parse(test::read_text(file()));
        for (Json& entry : json["entries"])
            for (Json& cost : entry["costs"]) cost["triangles"] = cost["pixels"] = factor;
        write_text(file(), json.dump());
    }
    TemporaryDirectory dir_;
    Variable cache_{"XDG_CACHE_HOME", (dir_ / "cache").string()};
};

TEST_F(BudgetCache, CostsAreMeasuredOnceAndKept) {
    const test::Ran first = draw({"--budget-ms", "1e6"});
    ASSERT_EQ(first.exit_code, 0) << first.err;
    const Json b = first.json()["budget"];
    EXPECT_EQ(b["costs"], "measured");
    EXPECT_EQ(b["met"], true);
    EXPECT_EQ(b["overrun"], false);
    EXPECT_GT(b["taken"].get<double>(), 0);
    EXPECT_EQ(b["chosen"]["setting"], words_of({1, 8}));
    EXPECT_TRUE(b["next"].is_null());
    EXPECT_EQ(b["tried"].size(), 10u);
    EXPECT_EQ(Json::parse(test::read_text(file()))["entries"].size(), 1u);
    const std::string kept = test::read_text(file());
    EXPECT_EQ(draw({"--budget-ms", "1e6"}).json()["budget"]["costs"], "cached");
    EXPECT_EQ(test::read_text(file()), kept);
    // Another number of threads is measured for itself, beside.
    EXPECT_EQ(draw({"--budget-ms", "1e6"}, "o.png", "2").json()["budget"]["costs"], "measured");
    EXPECT_EQ(Json::parse(test::read_text(file()))["entries"].size(), 2u);
    EXPECT_EQ(draw({"--budget-ms", "1e6"}).json()["budget"]["costs"], "cached");
}

TEST_F(BudgetCache, WhatIsKeptDecides) {
    ASSERT_EQ(draw({"--budget-ms", "1e6"}).exit_code, 0);
    // As cheap as nothing: the finest fits into a time that it overruns.
    seed(1e-9);
    const test::Ran cheap = draw({"--budget-ms", "1e-5"});
    EXPECT_EQ(cheap.exit_code, 0) << cheap.err;
    EXPECT_EQ(cheap.json()["budget"]["chosen"]["setting"], words_of({1, 8}));
    EXPECT_EQ(cheap.json()["budget"]["overrun"], true);
    EXPECT_NE(cheap.err.find("times what was asked"), std::string::npos) << cheap.err;
    // So dear that nothing fits: the picture is drawn all the same, and the exit code says it.
    seed(1e6);
    const test::Ran dear = draw({"--budget-ms", "1"}, "dear.png");
    EXPECT_EQ(dear.exit_code, 1);
    EXPECT_EQ(dear.json()["budget"]["met"], false);
    EXPECT_EQ(dear.json()["budget"]["chosen"]["setting"], words_of({1, 1}));
    EXPECT_NE(dear.err.find("nothing is predicted to draw within 1 ms"), std::string::npos);
    EXPECT_TRUE(std::filesystem::exists(dir_ / "dear.png"));
    // The cache is not read.
    EXPECT_EQ(draw({"--budget-ms", "1e6", "--no-cache"}).json()["budget"]["costs"], "measured");
}

TEST_F(BudgetCache, TheCommandThatIsPrintedDrawsTheSameBytes) {
    for (const char* ms : {"0", "1e6"}) {
        const test::Ran ran = draw({"--budget-ms", ms, "--no-cache", "--shading", "flat"});
        ASSERT_EQ(ran.exit_code, ms[0] == '0' ? 1 : 0) << ran.err;
        const std::string picture = test::read_text(dir_ / "o.png");
        std::string again = ran.json()["budget"]["command"];
        EXPECT_EQ(again.find("budget"), std::string::npos) << again;
        EXPECT_EQ(again.find("cache"), std::string::npos) << again;
        again = "'" + test::command_path().string() + "'" + again.substr(8);
        ASSERT_EQ(test::run_program("/bin/sh", {"-c", again}).exit_code, 0) << again;
        EXPECT_EQ(test::read_text(dir_ / "o.png"), picture) << again;
    }
    EXPECT_FALSE(std::filesystem::exists(dir_ / "cache"));  // --no-cache keeps nothing
}

TEST_F(BudgetCache, WhatIsDamagedIsMeasuredAnew) {
    const std::string unknown(2 << 20, ' ');
    ASSERT_EQ(draw({"--budget-ms", "1e6"}).exit_code, 0);
    const Json good = Json::parse(test::read_text(file()));
    std::vector<std::string> damaged = {
        "", "{", "[]", "{\"layout\":1}", "{\"layout\":\"x\"}", unknown, good.dump().substr(0, 200)};
    const auto changed = [&](const auto& change) {
        Json json = good;
        change(json["entries"][0]);
        damaged.push_back(json.dump());
    };
    changed([](Json& e) { e = 7; });
    changed([](Json& e) { e["version"] = "0.0.0"; });
    changed([](Json& e) { e["processor"] = "another"; });
    changed([](Json& e) { e["costs"] = 1; });
    changed([](Json& e) { e["costs"].erase(3); });
    changed([](Json& e) { e["costs"][3]["samples"] = 5; });
    changed([](Json& e) { e["costs"][3]["pixels"] = "1"; });
    changed([](Json& e) { e["costs"][3]["pixels"] = 0; });
    changed([](Json& e) { e["costs"][3]["triangles"] = -1; });
    changed([](Json& e) { e["costs"][3]["triangles"] = 1e300; });
    for (const std::string& text : damaged) {
        SCOPED_TRACE(text.substr(0, 300));
        write_text(file(), text);
        const auto found = meshprep::cached_costs(
            file(),
            {"sampling", good["entries"][0]["version"], good["entries"][0]["processor"], 1});
        EXPECT_FALSE(found && meshprep::sampling_costs_from(*found));
    }
    // One of them from outside, and then there is a cache again.
    write_text(file(), "{");
    EXPECT_EQ(draw({"--budget-ms", "1e6"}).json()["budget"]["costs"], "measured");
    EXPECT_EQ(draw({"--budget-ms", "1e6"}).json()["budget"]["costs"], "cached");
}

TEST_F(BudgetCache, ACacheThatCannotBeWrittenIsToldAndNoFailure) {
    write_text(dir_ / "cache", "a file");
    const test::Ran ran = draw({"--budget-ms", "1e6"});
    EXPECT_EQ(ran.exit_code, 0);
    EXPECT_NE(ran.err.find("measured costs are not kept"), std::string::npos) << ran.err;
}

TEST_F(BudgetCache, KeepsTheLastSixteen) {
    for (int threads = 1; threads <= 20; ++threads)
        ASSERT_TRUE(meshprep::keep_costs(file(), {"sampling", "1", "p", threads}, Json(threads)));
    EXPECT_FALSE(meshprep::cached_costs(file(), {"sampling", "1", "p", 4}));
    EXPECT_EQ(meshprep::cached_costs(file(), {"sampling", "1", "p", 5}), Json(5));
    // Kept again: still the same number of others.
    ASSERT_TRUE(meshprep::keep_costs(file(), {"sampling", "1", "p", 7}, Json("new")));
    EXPECT_EQ(meshprep::cached_costs(file(), {"sampling", "1", "p", 5}), Json(5));
    EXPECT_EQ(meshprep::cached_costs(file(), {"sampling", "1", "p", 7}), Json("new"));
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
