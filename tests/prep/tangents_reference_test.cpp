// Mode mikktspace_exact against what the C reference gave for recorded soups: every bit, however
// the input is indexed, on every instruction set. TangentsNpm holds the record against the npm
// package.
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <random>

#include "corner_soup.h"
#include "prep/tangents.h"
#include "shared_data.h"
#include "simd_levels.h"

namespace {

using prep::SimdLevel;

std::map<std::string, std::string> read_record() {
    std::map<std::string, std::string> record;
    std::ifstream in(test::source_dir() / "tests/prep/tangents_reference.txt");
    for (std::string name, hash; in >> name >> hash;) record[name] = hash;
    return record;
}

std::string hash_of_tangents(const prep::TangentInput& input, SimdLevel simd, int threads) {
    prep::TangentOptions options;
    options.mode = prep::TangentMode::mikktspace_exact;
    options.uv_origin = prep::UvOrigin::bottom_left;
    options.simd = simd;
    options.threads = threads;
    const auto result = prep::corner_tangents(input, options);
    if (!result) return prep::to_string(result.error());
    char text[17];
    std::snprintf(text, sizeof text, "%llx",
                  static_cast<unsigned long long>(test::hash_of(test::flattened(*result))));
    return text;
}

TEST(TangentsReference, EveryBitHoweverIndexedOnEveryInstructionSet) {
    const auto record = read_record();
    std::size_t compared = 0;
    for (const auto& [name, soup] : test::recorded_soups()) {
        ASSERT_TRUE(record.contains(name)) << name;
        const std::string& expected = record.at(name);
        if (expected == "crash") continue;
        ++compared;
        const test::IndexedSoup indexed = test::share_values(soup);
        for (const prep::SimdLevel simd : test::every_level()) {
            ASSERT_EQ(hash_of_tangents(soup.input(), simd, 1), expected)
                << name << ", " << prep::to_string(simd);
            ASSERT_EQ(hash_of_tangents(indexed.input(), simd, 1), expected)
                << name << ", indexed, " << prep::to_string(simd);
        }
    }
    EXPECT_EQ(compared, 1432u);  // the reference crashes on the others
}

}  // namespace
