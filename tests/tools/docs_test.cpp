// The documentation's own promises: what its links lead to is there.
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>

#include "command_runner.h"
#include "shared_data.h"

namespace {

namespace fs = std::filesystem;

std::vector<fs::path> pages() {
    std::vector<fs::path> found;
    for (const char* folder : {"", "docs", "bench", "samples", "fuzz"})
        for (const fs::directory_entry& entry : fs::directory_iterator(test::source_dir() / folder))
            if (entry.path().extension() == ".md") found.push_back(entry.path());
    return found;
}

TEST(Documentation, LinksLeadToFiles) {
    const std::regex link(R"(\]\(([^)#\s]+))");
    std::size_t links = 0;
    for (const fs::path& page : pages()) {
        const std::string text = test::read_text(page);
        for (std::sregex_iterator at(text.begin(), text.end(), link), end; at != end; ++at) {
            const std::string target = (*at)[1];
            if (target.find("://") != std::string::npos) continue;
            ++links;
            EXPECT_TRUE(fs::exists(page.parent_path() / target)) << page << " → " << target;
        }
    }
    EXPECT_GT(links, 20u);
}

// Headers and sources refer to pages too.
TEST(Documentation, PagesThatTheCodeNamesAreThere) {
    const std::regex name(R"(docs/[a-z0-9-]+\.md)");
    std::size_t names = 0;
    for (const char* folder : {"libprep", "librast", "tools", "tests", "bench"})
        for (const fs::directory_entry& entry :
             fs::recursive_directory_iterator(test::source_dir() / folder)) {
            const std::string ending = entry.path().extension().string();
            if (ending != ".h" && ending != ".cpp") continue;
            const std::string text = test::read_text(entry.path());
            for (std::sregex_iterator at(text.begin(), text.end(), name), end; at != end; ++at) {
                ++names;
                EXPECT_TRUE(fs::exists(test::source_dir() / at->str()))
                    << entry.path() << " → " << at->str();
            }
        }
    EXPECT_GT(names, 5u);
}

}  // namespace
