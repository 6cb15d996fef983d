// The JSON that subcommands print, held against the schemas of docs/schema.
#include <gtest/gtest.h>

#include <sstream>

#include "command_runner.h"
#include "json_schema_check.h"
#include "meshprep/budgets/time_budget.h"
#include "prep/calls/reason.h"
#include "shared_data.h"

namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::run_here;
using test::TempDir;
using test::write_text;

json schema(const std::string& name) {
    return json::parse(test::file_text(test::source_dir() / "docs/schema" / (name + ".json")),
                       nullptr, false);
}

void expect_valid(const json& document, const std::string& name) {
    const json rules = schema(name);
    ASSERT_TRUE(rules.is_object()) << name;
    std::string all;
    for (const std::string& text : test::schema_complaints(document, rules)) all += text + "\n";
    EXPECT_EQ(all, "") << document.dump(1).substr(0, 2000);
}

class Schema : public ::testing::Test {
  protected:
    Schema() {
        write_text(dir_ / "cube.obj", test::cube_obj());
        write_text(dir_ / "ball.obj", test::sphere_obj(12, 6));
        write_text(dir_ / "open.obj",
                   "o a/b\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 5 5 5\nf 1 2 3\nf 3 2 1\nf 1 1 2\nl 1 2\n");
        write_text(dir_ / "points.obj", "v 0 0 0\nv 1 0 0\np 1 2\n");
        write_text(dir_ / "bad.obj", "v 0 0 0\nf 1 2 9\n");
        test::GltfText gltf;
        const std::vector<float> n = {0, 0, 1, 0, 0, 1, 0, 0, 1}, uv = {0, 0, 1, 0, 0, 1};
        const std::vector<float> t = {1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1};
        gltf.add({"m", {0, 0, 0, 1, 0, 0, 0, 1, 0}, n, uv, t, {0, 1, 2}, "\"material\":0", ""});
        write_text(dir_ / "map.gltf",
                   gltf.text(R"("extensionsUsed":["KHR_materials_unlit"],"materials":[{"name":"x",)"
                             R"("normalTexture":{"index":0}}],"textures":[{"source":0}],)"
                             R"("images":[{"uri":"none.png"}])"));
    }
    std::string at(const std::string& name) const { return (dir_ / name).string(); }
    // Runs with --json and, where there is such a thing, --json-lines.
    void check(std::vector<std::string> words, int code, bool lines = false) {
        const std::string name = words[0];
        words.push_back(lines ? "--json-lines" : "--json");
        std::string typed;
        for (const std::string& word : words) typed += word + " ";
        SCOPED_TRACE(typed);
        const test::Ran ran = run_here(words);
        EXPECT_EQ(ran.exit_code, code) << ran.err;
        if (!lines) return expect_valid(ran.json(), name);
        std::istringstream text(ran.out);
        std::size_t count = 0;
        for (std::string line; std::getline(text, line); ++count)
            expect_valid(json::parse(line, nullptr, false), name);
        EXPECT_GT(count, 0u);
    }
    TempDir dir_;
};

TEST_F(Schema, HoldsForPrepare) {
    const std::vector<std::string> all = {"prepare",       at("cube.obj"), at("open.obj"),
                                          at("map.gltf"),  at("bad.obj"),  at("none.obj"),
                                          at("points.obj")};
    for (const bool lines : {false, true}) {
        std::vector<std::string> words = all;
        words.insert(words.end(), {"-o", at("out"), "--repair", "all", "--optimize", "--manifest",
                                   at("out/made.json"), "--skip-unchanged"});
        check(words, 1, lines);
        check(words, 1, lines);  // now with files that are skipped
        expect_valid(json::parse(test::file_text(dir_ / "out/made.json"), nullptr, false),
                     "manifest");
        check({"prepare", at("cube.obj"), "-o", at("x.fbx")}, 2, lines);
        check({"prepare", at("cube.obj"), "-o", at("x.glb"), "--weight", "heavy"}, 2, lines);
        check({"prepare", "-o", at("x.glb")}, 2, lines);
    }
    for (const bool lines : {false, true})
        check({"prepare", at("map.gltf"), "-o", at("one.glb"), "--explain", "--optimize",
               "--quantize", "auto"},
              0, lines);
    for (const bool lines : {false, true})
        for (const char* const degrees : {"0.1", "0"})
            check({"prepare", at("cube.obj"), "-o", at("few.glb"), "--quantize", "auto",
                   "--normal-error", degrees, "--tangent-error", degrees, "--manifest",
                   at("few.json")},
                  degrees == std::string("0") ? 1 : 0, lines);
    expect_valid(json::parse(test::file_text(dir_ / "few.json"), nullptr, false), "manifest");
    for (const bool lines : {false, true})
        for (const bool fits : {false, true})
            check({"prepare", at("cube.obj"), "-o", at("timed.glb"), "--budget-ms",
                   fits ? "10" : "0", "--subdivide", "catmark", "--manifest", at("timed.json")},
                  fits ? 0 : 1, lines);
    expect_valid(json::parse(test::file_text(dir_ / "timed.json"), nullptr, false), "manifest");
}

// Where reasons are told, each code that there is, and no other.
TEST_F(Schema, ListsTheCodesOfReasons) {
    json codes = json::array();
    for (const prep::ReasonRow& row : prep::reason_rows())
        if (row.code != prep::ReasonCode::none) codes.push_back(row.key);
    for (const char* const name : {"prepare", "render"})
        EXPECT_EQ(schema(name)["$defs"]["reason"]["properties"]["code"]["enum"], codes) << name;
}

TEST_F(Schema, HoldsForInspect) {
    for (const bool lines : {false, true}) {
        check({"inspect", at("cube.obj"), at("open.obj"), at("map.gltf"), at("points.obj")}, 0,
              lines);
        check({"inspect", at("bad.obj"), at("none.obj")}, 1, lines);
        check({"inspect", at("cube.obj"), "--plcaes", "3"}, 2, lines);
    }
    check({"inspect", "--selftest"}, 0);
}

TEST_F(Schema, HoldsForRender) {
    check({"render", at("ball.obj"), "-o", at("x.png"), "--size", "32x32"}, 0);
    check({"render", at("ball.obj"), "-o", at("x.png"), "--size", "32x32", "--explain", "--samples",
           "4", "--allow-error", "0.1"},
          0);
    check({"render", at("map.gltf"), "-o", at("y.png"), "--size", "32x32", "--buffers", "depth",
           "--turntable", "2"},
          0);
    check({"render", at("ball.obj"), "-o", at("x.png"), "--size", "32x32", "--image-error", "9"},
          0);
    check({"render", at("ball.obj"), "-o", at("x.png"), "--size", "32x32", "--image-error", "0"},
          1);
    check({"render", at("ball.obj"), "-o", at("x.png"), "--size", "32x32", "--budget-ms", "1e6",
           "--no-cache"},
          0);
    check({"render", at("ball.obj"), "-o", at("x.png"), "--size", "32x32", "--budget-ms", "0",
           "--no-cache"},
          1);
    check({"render", at("bad.obj"), "-o", at("x.png")}, 1);
    check({"render", at("none.obj"), "-o", at("x.png")}, 1);
    check({"render", at("ball.obj"), "-o", at("x.zzz")}, 2);
    check({"render", at("ball.obj"), "-o", at("x.png"), "--size", "0"}, 2);
}

// Beside a choice that fits, the next one that does not: by known costs, not by a clock.
TEST_F(Schema, HoldsForBudgetsWithANextOne) {
    const test::Ran ran = run_here({"render", at("ball.obj"), "-o", at("x.png"), "--size", "8x8",
                                    "--allow-error=0", "--json"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    json document = ran.json();
    std::vector<meshprep::SamplingCost> costs;
    for (const meshprep::SamplingRung& r : meshprep::sampling_rungs())
        costs.push_back({r, 1, double(r.samples * r.supersample * r.supersample)});
    const auto undrawn = [](const meshprep::SamplingRung&) -> prep::Result<meshprep::SizeTimes> {
        return prep::Error{prep::ErrorCode::invalid, "one sample needs no drawing", ""};
    };
    const auto chosen = meshprep::chosen_within(12, {2, 10}, costs, 8, undrawn);
    ASSERT_TRUE(chosen);
    document["budget"] = meshprep::to_json(*chosen, "again");
    ASSERT_TRUE(document["budget"]["next"].is_object());
    expect_valid(document, "render");
    document["budget"]["next"]["setting"] = 1;
    EXPECT_FALSE(test::schema_complaints(document, schema("render")).empty());
}

TEST_F(Schema, HoldsForValidate) {
    for (const bool lines : {false, true}) {
        check({"validate", at("ball.obj"), at("map.gltf"), at("bad.obj"), "-o", at("sheets"),
               "--panel", "64"},
              1, lines);
        check({"validate", at("ball.obj")}, 2, lines);
    }
}

TEST_F(Schema, HoldsForCost) {
    check({"cost", at("ball.obj"), "--ladder", "normal-precision,normal-weight,depth-format",
           "--rounds", "2", "--threads", "1"},
          0);
    check({"cost", "--list"}, 0);
    // Of a mesh without normals one ladder fails, the other is there.
    test::write_text(at("flat.obj"), "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
    check({"cost", at("flat.obj"), "--ladder", "normal-precision,depth-format", "--rounds", "1"},
          1);
    check({"cost", at("bad.obj"), "--rounds", "1"}, 1);
    check({"cost", "--from", at("cube.obj")}, 1);
    check({"cost", "--ladder", "no-such"}, 2);
}

TEST_F(Schema, HoldsForDiff) {
    ASSERT_EQ(run_here({"prepare", at("ball.obj"), "-o", at("b.glb"), "--tangents", "mikktspace"})
                  .exit_code,
              0);
    ASSERT_EQ(run_here({"prepare", at("ball.obj"), "-o", at("c.glb"), "--tangents", "mikktspace",
                        "--weight", "uniform"})
                  .exit_code,
              0);
    check({"diff", at("b.glb"), at("c.glb")}, 0);
    check({"diff", at("b.glb"), at("c.glb"), "--tolerance", "0"}, 1);
    ASSERT_EQ(run_here({"render", at("ball.obj"), "-o", at("x.png"), "--size", "16x16"}).exit_code,
              0);
    ASSERT_EQ(run_here({"render", at("cube.obj"), "-o", at("y.png"), "--size", "16x16"}).exit_code,
              0);
    check({"diff", at("b.glb"), at("c.glb"), "--views", "0"}, 0);
    check({"diff", at("ball.obj"), at("cube.obj"), "--views", "2", "--report", at("p.html")}, 0);
    // What a gate is, by its schema and by the reader, and what it finds.
    const std::string gate = R"({"gate":1,"scope":{"meshes":["m"]},"limits":{"normals":0.5,)"
                             R"("flip":0.1,"rmse":null},"views":1,"size":32,"replay":"x"})";
    expect_valid(json::parse(gate), "gate");
    test::write_text(at("gate.json"), gate);
    check({"diff", at("map.gltf"), at("map.gltf"), "--gate", at("gate.json")}, 0);
    check({"diff", at("x.png"), at("x.png"), "--flip"}, 0);
    check({"diff", at("x.png"), at("x.png"), "--gate", at("cube.obj")}, 1);
    check({"diff", at("x.png"), at("x.png")}, 0);
    check({"diff", at("x.png"), at("y.png")}, 0);
    check({"diff", at("x.png"), at("b.glb")}, 1);
    check({"diff", at("x.png"), at("none.png")}, 1);
    check({"diff", at("x.png")}, 2);
}

// The judge of the others: it finds what it must.
TEST(SchemaCheck, ComplainsOfWhatTheSchemaForbids) {
    const json rules = json::parse(
        R"({"type":"object","properties":{"n":{"type":"integer"},"k":{"$ref":"#/$defs/k"},)"
        R"("l":{"type":"array","items":{"anyOf":[{"const":1},{"type":["string","null"]}]}}},)"
        R"("required":["n"],"additionalProperties":false,"$defs":{"k":{"enum":["a","b"]}}})");
    const auto count = [&](const char* text) {
        return test::schema_complaints(json::parse(text), rules).size();
    };
    EXPECT_EQ(count(R"({"n":1,"k":"a","l":[1,"x",null]})"), 0u);
    EXPECT_EQ(count(R"({"n":"1"})"), 1u);
    EXPECT_EQ(count(R"({"n":1.5})"), 1u);
    EXPECT_EQ(count(R"({})"), 1u);
    EXPECT_EQ(count(R"({"n":1,"k":"c"})"), 1u);
    EXPECT_EQ(count(R"({"n":1,"l":[2,true]})"), 2u);
    EXPECT_EQ(count(R"({"n":1,"more":0})"), 1u);
    EXPECT_EQ(test::schema_complaints(0, json{{"minimum", 0}}).size(), 0u);
    EXPECT_EQ(test::schema_complaints(-1, json{{"minimum", 0}}).size(), 1u);
    EXPECT_EQ(test::schema_complaints(2, json{{"maximum", 1}}).size(), 1u);
    EXPECT_EQ(test::schema_complaints(json::array(), json{{"minItems", 1}}).size(), 1u);
    EXPECT_EQ(test::schema_complaints(1, json{{"multipleOf", 1}}).size(), 1u);  // not known
    EXPECT_EQ(test::schema_complaints(1, json{{"$ref", "#/$defs/none"}}).size(), 1u);
}

}  // namespace
