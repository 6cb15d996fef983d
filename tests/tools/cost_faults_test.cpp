// The table of docs/accuracy.md of how far planted faults raise the ladders' errors. As it is
// built, the errors without a fault are compared with it; `scripts/mutate --rises` plants the
// faults and runs this again with each.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>

#include "command_runner.h"
#include "cost/ladders/ladder.h"
#include "shared_data.h"

namespace {

struct Row {
    std::string ladder, rung, number, fault;
    double before = 0, with = 0;
    std::string line;
};

std::string trimmed(const std::string& text) {
    const std::size_t first = text.find_first_not_of(" `"), last = text.find_last_not_of(" `");
    return first == std::string::npos ? "" : text.substr(first, last - first + 1);
}

double number_of(const std::string& text) {
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    return end == text.c_str() ? std::nan("") : value;
}

// | ladder | rung | number | `name`: what it does | before | with it |
std::vector<Row> rows() {
    std::vector<Row> found;
    std::istringstream page(test::file_text(test::source_dir() / "docs/accuracy.md"));
    for (std::string line; std::getline(page, line);) {
        std::vector<std::string> cells;
        std::istringstream cut(line);
        for (std::string cell; std::getline(cut, cell, '|');) cells.push_back(trimmed(cell));
        if (cells.size() != 7 || cells[4].find("`:") == std::string::npos) continue;
        found.push_back({cells[1], cells[2], cells[3], cells[4].substr(0, cells[4].find('`')),
                         number_of(cells[5]), number_of(cells[6]), line});
    }
    return found;
}

class Ladders {
  public:
    double error(const Row& row) {
        cost::Ladder& ladder = named(row.ladder);
        for (std::size_t m = 0; m < ladder.metrics.size(); ++m)
            if (ladder.metrics[m].name == row.number) return numbers(ladder, row.rung).at(m);
        ADD_FAILURE() << "no such number: " << row.line;
        return std::nan("");
    }

  private:
    cost::Ladder& named(const std::string& name) {
        const auto at = ladders_.find(name);
        if (at != ladders_.end()) return at->second;
        for (const cost::LadderRow& row : cost::ladder_rows())
            if (name == row.name) {
                auto made = row.make({"", nullptr, 1});
                EXPECT_TRUE(made) << prep::to_string(made.error());
                if (made) ladders_[name] = *std::move(made);
            }
        return ladders_[name];
    }
    std::vector<double> numbers(const cost::Ladder& ladder, const std::string& name) {
        std::vector<double>& known = numbers_[ladder.name + "/" + name];
        for (const cost::Rung& rung : ladder.rungs)
            if (known.empty() && rung.name == name && rung.run()) known = rung.judge();
        EXPECT_EQ(known.size(), ladder.metrics.size()) << ladder.name << " has no rung " << name;
        known.resize(ladder.metrics.size());
        return known;
    }
    std::map<std::string, cost::Ladder> ladders_;
    std::map<std::string, std::vector<double>> numbers_;
};

// Two digits; of roundings, which are not everywhere the same, the size.
bool agrees(double measured, double stated) {
    if (stated == 0 || measured == 0) return measured == stated;
    const double ratio = measured / stated;
    return stated < 2e-5 ? ratio > 0.5 && ratio < 2 : std::abs(ratio - 1) < 0.08;
}

std::string two_digits(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.2g", value);
    return text;
}

TEST(CostFaults, AreAsTheTableSays) {
    const char* const planted = std::getenv("MESHPREP_FAULT_NAME");
    Ladders ladders;
    std::size_t compared = 0;
    for (const Row& row : rows()) {
        if (planted && row.fault != planted) continue;
        ++compared;
        const double measured = ladders.error(row);
        EXPECT_TRUE(agrees(measured, planted ? row.with : row.before))
            << "measured " << two_digits(measured) << (planted ? " with the fault" : " without")
            << ": " << row.line;
    }
    EXPECT_GE(compared, planted ? 1u : 38u);
}

TEST(CostFaults, TwoOfEachLadderRaiseItsErrorFivefold) {
    std::string lists;
    for (const auto& entry :
         std::filesystem::directory_iterator(test::source_dir() / "tests/mutants"))
        lists += "\n" + test::file_text(entry.path());
    std::map<std::string, std::set<std::string>> seen;
    for (const Row& row : rows()) {
        EXPECT_NE(lists.find("\n" + row.fault + "\n"), std::string::npos) << row.line;
        if (row.with >= 5 * row.before && row.with > 0) seen[row.ladder].insert(row.fault);
    }
    for (const cost::LadderRow& row : cost::ladder_rows())
        EXPECT_GE(seen[row.name].size(), 2u) << row.name;
}

}  // namespace
