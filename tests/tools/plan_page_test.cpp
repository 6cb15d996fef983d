// The plans that docs/plan.md shows are those that the command prints.
#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <vector>

#include "command_runner.h"
#include "shared_data.h"

namespace {

using Json = nlohmann::json;

struct Shown {
    std::vector<std::string> words;  // of its first line: meshprep render …
    std::vector<std::string> rows;
};

// Blocks that begin with such a line and tell a plan, and the scene file that stands on the page.
struct Page {
    std::vector<Shown> plans;
    std::string scene;
};
Page read_page() {
    std::istringstream text(test::file_text(test::source_dir() / "docs/plan.md"));
    Page page;
    std::string kind;
    for (std::string line; std::getline(text, line);) {
        if (line.starts_with("```")) {
            kind = kind.empty() ? line : "";
            if (kind == "```plan") page.plans.emplace_back();
        } else if (kind == "```json") {
            page.scene += line + "\n";
        } else if (kind == "```plan" && page.plans.back().words.empty()) {
            std::istringstream words(line);
            for (std::string word; words >> word;) page.plans.back().words.push_back(word);
        } else if (kind == "```plan") {
            page.plans.back().rows.push_back(line);
        }
    }
    return page;
}

// What a row begins with and what it ends with: between them it says what the step came to.
struct Row {
    std::string begin, end;
};
std::vector<Row> rows_of(const Json& plan) {
    constexpr std::size_t step_width = 25;
    std::vector<Row> rows;
    const auto add = [&](std::string step, const Json& label, const Json& why) {
        step.resize(step_width, ' ');
        rows.push_back({"  " + step + label.get<std::string>() + " ", why.get<std::string>()});
    };
    for (const Json& step : plan["steps"]) {
        add(step["step"], step["label"], step["reason"]);
        for (std::size_t k = 1; k < step["reasons"].size(); ++k)
            add("", step["reasons"][k]["label"], step["reasons"][k]["sentence"]);
    }
    return rows;
}

TEST(PlanPage, ShowsThePlansOfFiveScenesAsTheyAre) {
    const Page page = read_page();
    ASSERT_EQ(page.plans.size(), 5u);
    const test::TempDir dir;
    test::write_text(dir / "yard.json", page.scene);
    int number = 0;
    for (const Shown& shown : page.plans) {
        ASSERT_GE(shown.words.size(), 5u);
        ASSERT_EQ(shown.words[0] + " " + shown.words[1], "meshprep render");
        std::vector<std::string> words(shown.words.begin() + 1, shown.words.end());
        EXPECT_EQ(words.back(), "--explain");
        words.back() = "--json";
        words[1] = words[1] == "yard.json" ? (dir / "yard.json").string()
                                           : (test::source_dir() / words[1]).string();
        ASSERT_EQ(words[2], "-o");
        words[3] = (dir / (std::to_string(number++) + ".png")).string();
        const test::Ran ran = test::run_here(words);
        ASSERT_EQ(ran.exit_code, 0) << ran.err;
        const std::vector<Row> rows = rows_of(ran.json()["plan"]);
        ASSERT_EQ(shown.rows.size(), rows.size()) << shown.words[2];
        for (std::size_t k = 0; k < rows.size(); ++k) {
            EXPECT_TRUE(shown.rows[k].starts_with(rows[k].begin) &&
                        shown.rows[k].ends_with(" " + rows[k].end))
                << shown.words[2] << "\n"
                << shown.rows[k] << "\n"
                << rows[k].begin << "… " << rows[k].end;
        }
    }
}

}  // namespace
