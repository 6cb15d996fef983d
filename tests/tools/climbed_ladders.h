// Ladders of `meshprep cost`, climbed for their errors alone.
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "cost/ladders/ladder.h"

namespace test {

inline cost::Ladder ladder_named(const std::string& name, const prep::Mesh* mesh = nullptr) {
    for (const cost::LadderRow& row : cost::ladder_rows()) {
        if (name != row.name) continue;
        auto ladder = row.make({"mesh", mesh, 1});
        EXPECT_TRUE(ladder) << name;
        return *std::move(ladder);
    }
    ADD_FAILURE() << name;
    return {};
}

// Of each rung its numbers, by its name.
inline std::map<std::string, std::vector<double>> climbed(const cost::Ladder& ladder) {
    std::map<std::string, std::vector<double>> numbers;
    for (const cost::Rung& rung : ladder.rungs) {
        EXPECT_TRUE(rung.run()) << rung.name;
        numbers[rung.name] = rung.judge();
        EXPECT_EQ(numbers[rung.name].size(), ladder.metrics.size()) << rung.name;
    }
    return numbers;
}

// What each rung's error is, on every machine. A stage that gets better leaves the table as one
// that gets worse does: the figures of docs/accuracy.md then need new ones.
inline void expect_errors(std::map<std::string, std::vector<double>>& numbers, std::size_t metric,
                          const std::vector<std::pair<const char*, double>>& expected,
                          double tolerance = 0.03) {
    std::string measured;
    for (const auto& [name, n] : numbers)
        measured += "\n" + name + ": " + std::to_string(n[metric]);
    EXPECT_EQ(numbers.size(), expected.size()) << measured;
    for (const auto& [name, value] : expected) {
        ASSERT_EQ(numbers.count(name), 1u) << name;
        EXPECT_NEAR(numbers[name][metric], value, tolerance * value) << name;
    }
}

}  // namespace test
