// `render --explain`: what each step came to, on a picture whose points are known beforehand.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "command_runner.h"

namespace {

using nlohmann::json;
using test::run_here;

// A floor that fills all of 40 × 30 pixels, under two lights and a black one.
std::string floor_seen_from_above(const std::string& material) {
    return R"({"meshprep": 1,
  "materials": {"floor": )" +
           material + R"(},
  "meshes": {"floor": {"shape": {"kind": "plane", "size": [80, 1, 80]}, "material": "floor"}},
  "lights": [{"kind": "directional", "direction": [0, -1, 0]},
             {"kind": "directional", "direction": [0.3, -1, 0]},
             {"kind": "directional", "direction": [0, -1, 0.3], "color": [0, 0, 0]}],
  "camera": {"position": [0.3, 5, 2], "target": [0, 0, 0], "fov": 40},
  "picture": {"size": [40, 30]}})";
}
constexpr std::uint64_t points = 40 * 30;

class RenderCosts : public ::testing::Test {
  protected:
    test::Ran render(const std::string& material, std::vector<std::string> options) {
        test::write_text(dir_ / "s.json", floor_seen_from_above(material));
        options.insert(options.begin(),
                       {"render", (dir_ / "s.json").string(), "-o", (dir_ / "x.png").string()});
        return run_here(options);
    }
    // By step.
    std::map<std::string, json> costs(const std::string& material,
                                      std::vector<std::string> options = {"--explain"}) {
        options.push_back("--json");
        const test::Ran ran = render(material, options);
        EXPECT_EQ(ran.exit_code, 0) << ran.err;
        std::map<std::string, json> out;
        const json document = ran.json();
        for (const json& step : document["plan"]["steps"])
            if (step.contains("cost")) out[step["step"]] = step["cost"];
        return out;
    }
    json document(const std::string& material, std::vector<std::string> options) {
        options.insert(options.end(), {"--explain", "--json"});
        return render(material, options).json();
    }
    test::TempDir dir_;
};

TEST_F(RenderCosts, AreThePointsThatThereAre) {
    auto all = costs("{}");
    EXPECT_EQ(all["shading"]["count"], points);
    EXPECT_EQ(all["lights"]["count"], 2 * points);  // the black one is proved to do nothing
    EXPECT_EQ(all["highlights"]["count"], 2 * points);
    EXPECT_EQ(all["normal maps"]["count"], 0);
    EXPECT_EQ(all["textures"]["count"], 0);
    EXPECT_EQ(all["vertex lighting"]["count"], 0);
    EXPECT_EQ(all["alpha mask"]["count"], 0);
    EXPECT_EQ(all.count("depth output"), 0u);
    EXPECT_EQ(all.count("multisampling"), 0u);  // one sample a pixel is none
    EXPECT_EQ(costs(R"({"specular": [0, 0, 0]})")["highlights"]["count"], 0);
    // Tiles inside a triangle take one sample; two triangles meet somewhere in the picture.
    auto sampled = costs("{}", {"--explain", "--samples", "4"});
    EXPECT_GT(sampled["multisampling"]["count"], points);
    EXPECT_LE(sampled["multisampling"]["count"], 4 * points);
    auto gouraud = costs("{}", {"--explain", "--shading", "gouraud"});
    // They are counted where they are computed, together.
    EXPECT_EQ(gouraud.count("lights") + gouraud.count("highlights"), 0u);
    EXPECT_EQ(gouraud["vertex lighting"]["count"], 4);
}

// Each of the two lights adds at most 1: the material's diffuse and specular colour together.
TEST_F(RenderCosts, OfLightsThatMayBeLeftOutAreNone) {
    EXPECT_EQ(costs("{}", {"--explain", "--allow-error", "0.9"})["lights"]["count"], 2 * points);
    EXPECT_EQ(costs("{}", {"--explain", "--allow-error", "1.1"})["lights"]["count"], points);
    EXPECT_EQ(costs("{}", {"--explain", "--allow-error", "9"})["lights"]["count"], points);
    EXPECT_EQ(render("{}", {"--allow-error", "-1"}).exit_code, 2);
}

// The floor fills the picture, and its box reaches behind the eye: estimates are exact.
TEST_F(RenderCosts, AreEstimatedBeforeTheyAreCounted) {
    for (const char* const material : {"{}", R"({"specular": [0, 0, 0]})", R"({"unlit": true})"}) {
        const json all = document(material, {});
        for (const json& step : all["plan"]["steps"]) {
            if (!step.contains("estimate")) continue;
            EXPECT_EQ(step["run"], true);
            EXPECT_EQ(step["estimate"], step["cost"]) << step["step"];
        }
    }
    const auto expected = [&](std::vector<std::string> options) {
        return document("{}", std::move(options))["plan"]["steps"];
    };
    for (const json& step : expected({"--samples", "4", "--crop", "3,4,10x8"})) {
        if (step["step"] == "multisampling") {
            EXPECT_EQ(step["estimate"]["count"], 4 * 80);
        }
        if (step["step"] == "shading") {
            EXPECT_EQ(step["estimate"]["count"], 80);
        }
    }
    for (const json& step : expected({"--supersample", "3"}))
        if (step["step"] == "shading") {
            EXPECT_EQ(step["estimate"]["count"], 9 * points);
        }
    for (const json& step : expected({"--shading", "gouraud"}))
        if (step["step"] == "vertex lighting") {
            EXPECT_EQ(step["estimate"]["count"], 4);
        }
}

// A square flat on, 2 of the 4 units that the picture is high: a box of no depth, filled.
TEST_F(RenderCosts, AreExpectedWhereTheBoxIs) {
    test::write_text(dir_ / "w.json", R"({"meshprep": 1,
  "meshes": {"wall": {"shape": {"kind": "plane", "size": [2, 1, 2]}}},
  "camera": {"position": [0, 5, 0], "target": [0, 0, 0], "up": [0, 0, -1], "height": 4},
  "picture": {"size": [60, 40]}})");
    const test::Ran ran = run_here({"render", (dir_ / "w.json").string(), "-o",
                                    (dir_ / "x.png").string(), "--explain", "--json"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    const json document = ran.json();
    for (const json& step : document["plan"]["steps"]) {
        if (step["step"] != "shading") continue;
        EXPECT_EQ(step["estimate"]["count"], 20 * 20);
        EXPECT_EQ(step["cost"]["count"], 20 * 20);
        EXPECT_GT(step["cost"]["milliseconds"], 0);
    }
}

// Steps that run say what they took, from the parts of drawing that are theirs; a part belongs to
// one step, or says who else is in it.
TEST_F(RenderCosts, AreMeasured) {
    const std::vector<std::string> ways[] = {
        {"--size", "320x240"},
        {
            "--size",
            "320x240",
            "--samples",
            "4",
            "--buffers",
            "depth,normal",
            "--buffer-file",
            (dir_ / "b.exr").string(),
        },
        {"--size", "160x120", "--coverage", "area"},
        {"--size", "160x120", "--supersample", "2", "--shading", "gouraud"}};
    for (const std::vector<std::string>& way : ways) {
        const json plan = document("{}", way)["plan"];
        const json& all = plan["milliseconds"];
        EXPECT_GT(all["geometry"], 0);
        EXPECT_GT(all["drawing"], 0);
        EXPECT_GT(all["writing"], 0);
        std::map<std::string, std::set<std::string>> steps_of;
        for (const json& step : plan["steps"]) {
            if (!step.contains("measured")) continue;
            EXPECT_EQ(step["run"], true) << step["step"];
            double sum = 0;
            for (const json& part : step["measured"]["parts"]) {
                sum += all["parts"][part.get<std::string>()].get<double>();
                steps_of[part].insert(step["step"]);
            }
            EXPECT_NEAR(step["measured"]["milliseconds"], sum, 1e-9);
        }
        for (const json& step : plan["steps"])
            if (step.contains("measured"))
                for (const json& part : step["measured"]["parts"])
                    for (const std::string& other : steps_of[part])
                        if (step["step"] != other) {
                            const json& with = step["measured"]["with"];
                            EXPECT_NE(std::find(with.begin(), with.end(), other), with.end())
                                << step["step"] << " " << other;
                        }
        // Nothing that takes time at points is no step's.
        for (const auto& [part, ms] : all["parts"].items())
            if (ms > 0 && part != "clearing") {
                EXPECT_EQ(steps_of.count(part), 1u) << part;
            }
    }
    EXPECT_FALSE(render("{}", {"--json"}).json()["plan"].contains("milliseconds"));
    const json counters = render("{}", {"--json"}).json()["counters"];
    EXPECT_EQ(counters["stage_points"]["light"], 2 * points);
    EXPECT_EQ(counters["stage_points"]["exponents"], counters["highlight_points"]);
    EXPECT_EQ(counters["stage_points"]["color"], counters["pixels_shaded"]);
    const std::string text = render("{}", {"--explain"}).out;
    EXPECT_NE(text.find("; took "), std::string::npos) << text;
    EXPECT_NE(text.find("parts of drawing"), std::string::npos) << text;
}

TEST_F(RenderCosts, OfBuffersAreTheirBytes) {
    const auto all = costs("{}", {"--explain", "--buffers", "depth,normal", "--buffer-file",
                                  (dir_ / "b.exr").string()});
    EXPECT_EQ(all.at("depth output")["bytes"], 4 * points);
    EXPECT_EQ(all.at("normal output")["bytes"], 12 * points);
    EXPECT_EQ(all.count("UV output"), 0u);
}

TEST_F(RenderCosts, AreToldWhereAskedFor) {
    EXPECT_TRUE(costs("{}", {}).empty());
    const test::Ran words = render("{}", {"--explain"});
    EXPECT_NE(words.out.find("2,400 points by lights"), std::string::npos) << words.out;
    EXPECT_EQ(render("{}", {}).out.find("points by lights"), std::string::npos);
}

}  // namespace
