// The table of docs/architecture.md of what is left out has a row for each code that leaves
// something out, a column for each way of drawing, and says in each cell what is tested.
#include "skip_table.h"

#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "shared_data.h"
#include "skip_stage.h"

namespace {

// The rows of the page's table whose head begins so; the head first, without the line below it.
std::vector<std::string> table_of(const std::string& head) {
    std::ifstream page(test::source_dir() / "docs/architecture.md");
    std::vector<std::string> rows;
    for (std::string line; std::getline(page, line);) {
        if (rows.empty() && !line.starts_with(head)) continue;
        if (!line.starts_with("|")) break;
        if (!line.starts_with("|---")) rows.push_back(line);
    }
    return rows;
}

// What a plan leaves out thing by thing; these sum others up.
bool is_summary(const std::string& code) {
    return code == "highlights_all_zero" || code == "all_masks_never_cut" ||
           code == "normal_maps_all_flat" || code == "textures_all_neutral";
}

TEST(SkipTable, HasARowForEachCodeAndSaysWhatIsTested) {
    std::map<std::string, prep::ReasonLabel> labels;
    for (const prep::ReasonRow& row : prep::reason_rows())
        if (row.label == prep::ReasonLabel::proved_zero || row.label == prep::ReasonLabel::bounded)
            labels[std::string(row.key)] = row.label;
    std::string head = "| left out |";
    for (const test::Way& way : test::ways) head += std::string(" ") + way.name + " |";
    std::vector<std::string> expected = {head};
    std::set<std::string> listed;
    for (const test::SkippedThing& thing : test::skipped_things) {
        ASSERT_EQ(labels.count(thing.code), 1u) << thing.code;
        listed.insert(thing.code);
        std::string row = std::string("| ") + thing.words + " |";
        for (const test::Way& way : test::ways)
            row +=
                " " +
                test::cell_of(thing, way.name, labels[thing.code] == prep::ReasonLabel::bounded) +
                " |";
        expected.push_back(row);
    }
    for (const auto& [code, label] : labels)
        EXPECT_NE(listed.count(code) > 0, is_summary(code)) << code;
    EXPECT_EQ(table_of("| left out |"), expected);
}

}  // namespace
