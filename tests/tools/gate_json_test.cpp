// What a gate file may be, hostile ones among them: the reader and the schema agree.
#include "meshprep/output/gate_json.h"

#include <gtest/gtest.h>

#include <random>

#include "command_runner.h"
#include "json_schema_check.h"
#include "shared_data.h"

namespace {

using nlohmann::json;

std::string complaint_of(const std::string& text) {
    const auto gate = meshprep::gate_from(text);
    return gate ? "" : gate.error().place + ": " + gate.error().text;
}

TEST(GateJson, TheSchemaRefusesWhatTheReaderDoes) {
    const json schema =
        json::parse(test::file_text(test::source_dir() / "docs/schema/gate.json"), nullptr, false);
    const std::pair<const char*, bool> gates[] = {
        {R"({"gate":1})", true},
        {R"({"gate":1,"views":0,"size":16})", true},
        {R"({"gate":1,"views":64,"size":4096,"limits":{"added":0,"flip":null}})", true},
        {R"({"gate":1,"views":65})", false},
        {R"({"gate":1,"views":-1})", false},
        {R"({"gate":1,"size":15})", false},
        {R"({"gate":1,"size":4097})", false},
        {R"({"gate":1,"limits":{"normals":-0.1}})", false},
        {R"({"gate":1,"limits":{"rmse":-1}})", false},
        {R"({"gate":1,"limits":{"rmse":true}})", false},
        {R"({"gate":1,"scope":{"meshes":[]}})", false},
        {R"({"gate":1,"scope":{"meshes":[1]}})", false},
        {R"({"gate":2})", false},
        {R"({"views":1})", false},
        {R"({"gate":1,"other":1})", false},
    };
    for (const auto& [text, good] : gates) {
        EXPECT_EQ(complaint_of(text).empty(), good) << text << complaint_of(text);
        EXPECT_EQ(test::schema_complaints(json::parse(text), schema).empty(), good) << text;
    }
}

TEST(GateJson, AMemberThatStandsTwiceIsAnError) {
    EXPECT_EQ(complaint_of(R"({"gate":1,"limits":{"uvs":0,"uvs":1}})"),
              ": has the member 'uvs' twice in one object");
    EXPECT_EQ(complaint_of(R"({"gate":1,"gate":1})"),
              ": has the member 'gate' twice in one object");
    // Of two objects each may have it.
    EXPECT_EQ(complaint_of(R"({"gate":1,"scope":{"meshes":["a"]},"limits":{"uvs":0}})"), "");
}

TEST(GateJson, PointersAreEscaped) {
    EXPECT_EQ(complaint_of(R"({"gate":1,"limits":{"a/b~c":1}})").rfind("#/limits/a~1b~0c: ", 0), 0u)
        << complaint_of(R"({"gate":1,"limits":{"a/b~c":1}})");
}

// Bytes changed, left out and repeated, and deep nesting: an error or a gate with numbers in range.
TEST(GateJson, DamagedGatesAreErrorsOrGates) {
    const std::string good =
        R"({"gate":1,"scope":{"meshes":["a","b"]},"limits":{"uvs":0.5,"flip":null},"views":3,"size":64,"replay":"x"})";
    ASSERT_EQ(complaint_of(good), "");
    std::mt19937_64 random(7);
    int read = 0;
    for (int k = 0; k < 4000; ++k) {
        std::string text = good;
        for (int n = 0; n <= k % 3; ++n) {
            const std::size_t at = random() % text.size();
            if (random() % 3 == 0)
                text.erase(at, 1 + random() % 4);
            else if (random() % 2 == 0)
                text[at] = char(random() % 256);
            else
                text.insert(at, text.substr(random() % text.size(), random() % 12));
        }
        const auto gate = meshprep::gate_from(text);
        if (!gate) continue;
        ++read;
        EXPECT_LE(gate->views, 64u) << text;
        EXPECT_TRUE(gate->size >= 16 && gate->size <= 4096) << text;
        for (const judge::LimitRow& row : judge::limit_rows)
            EXPECT_TRUE((gate->limits.*row.limit).value_or(0) >= 0) << text;
    }
    EXPECT_GT(read, 0);
    for (const char* const nest : {"[", "{\"a\":"}) {
        std::string deep;
        for (int k = 0; k < 100000; ++k) deep += nest;
        EXPECT_NE(complaint_of(deep), "");
        EXPECT_NE(complaint_of("{\"gate\":" + deep), "");
    }
}

}  // namespace
