// A function that is inline in one source and not in another has two definitions: which of them is
// called depends on the sources that are compiled together, and no compiler says so.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <map>
#include <sstream>
#include <string>

namespace {

struct Definitions {
    std::map<std::string, std::string> strong;  // symbol -> object
    std::map<std::string, std::string> weak;
};

// What the objects of an archive define in code.
Definitions definitions(const std::string& archive) {
    Definitions result;
    std::FILE* listing = popen(("nm -A --defined-only " + archive + " 2>/dev/null").c_str(), "r");
    if (!listing) return result;
    char line[65536];
    while (std::fgets(line, sizeof line, listing)) {
        // ARCHIVE:OBJECT:ADDRESS KIND SYMBOL
        std::istringstream words(line);
        std::string place, kind, symbol;
        if (!(words >> place >> kind >> symbol)) continue;
        if (kind == "T") result.strong.emplace(symbol, place);
        if (kind == "W") result.weak.emplace(symbol, place);
    }
    pclose(listing);
    return result;
}

void expect_one_definition(const std::string& archive) {
    if (std::system("nm --version >/dev/null 2>&1") != 0)
        GTEST_SKIP() << "there is no nm to list the symbols of " << archive;
    const Definitions found = definitions(archive);
    ASSERT_GT(found.strong.size(), 100u) << archive;
    ASSERT_GT(found.weak.size(), 100u) << archive;
    for (const auto& [symbol, place] : found.strong) {
        const auto other = found.weak.find(symbol);
        if (other != found.weak.end())
            ADD_FAILURE() << symbol << " is inline in " << other->second << ", not in " << place;
    }
}

TEST(OneDefinition, OfEveryFunctionOfThePreparation) {
    expect_one_definition(MESHPREP_PREP_LIBRARY);
}
TEST(OneDefinition, OfEveryFunctionOfTheRasterizer) {
    expect_one_definition(MESHPREP_RAST_LIBRARY);
}

}  // namespace
