// Rules of CONTRIBUTING.md that the sources themselves can be held to.
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "command_runner.h"
#include "shared_data.h"

namespace {

namespace fs = std::filesystem;

std::vector<fs::path> files_below(const std::vector<std::string>& folders,
                                  const std::set<std::string>& endings) {
    std::vector<fs::path> found;
    for (const std::string& folder : folders)
        for (const fs::directory_entry& entry :
             fs::recursive_directory_iterator(test::source_dir() / folder))
            if (entry.is_regular_file() && endings.count(entry.path().extension().string()))
                found.push_back(entry.path());
    return found;
}

// C++ without comments and without what stands between quotes.
std::string bare(const std::string& text) {
    std::string out;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text.compare(i, 2, "//") == 0) {
            i = std::min(text.find('\n', i), text.size()) - 1;
        } else if (text.compare(i, 2, "/*") == 0) {
            i = std::min(text.find("*/", i), text.size() - 2) + 1;
        } else if (text[i] == '"') {
            out += '"';
            for (++i; i < text.size() && text[i] != '"'; ++i) i += text[i] == '\\';
            out += '"';
        } else {
            out += text[i];
        }
    }
    return out;
}

TEST(SourceRules, LibrariesNeitherPrintNorExit) {
    const std::regex printing(
        R"(\b(std::)?(cout|cerr|clog|printf|fprintf|puts|fputs|putchar|perror)\b)");
    const std::regex leaving(
        R"((^|[^\w.>:])(std::)?(exit|_Exit|_exit|quick_exit|abort|terminate)\()");
    const auto sources = files_below({"libprep", "librast"}, {".h", ".cpp", ".inl"});
    EXPECT_GT(sources.size(), 150u);
    for (const fs::path& path : sources) {
        // The one way out: the value of an error was asked for, which is the caller's bug.
        if (path.filename() == "result.cpp") continue;
        const std::string text = bare(test::file_text(path));
        std::smatch found;
        EXPECT_FALSE(std::regex_search(text, found, printing)) << path << ": " << found.str();
        EXPECT_FALSE(std::regex_search(text, found, leaving)) << path << ": " << found.str();
    }
}

TEST(SourceRules, PublicHeadersIncludeGlmAlone) {
    const std::regex include(R"(#include\s*[<"]([^>"]+)[>"])");
    const auto headers = files_below({"libprep/include", "librast/include"}, {".h"});
    EXPECT_GT(headers.size(), 20u);
    for (const fs::path& path : headers) {
        const std::string text = test::file_text(path);
        for (std::sregex_iterator i(text.begin(), text.end(), include), end; i != end; ++i) {
            const std::string name = (*i)[1];
            const std::size_t slash = name.find('/');
            const std::string library = slash == std::string::npos ? "" : name.substr(0, slash);
            EXPECT_TRUE(library == "prep" || library == "rast" || library == "glm" ||
                        (library.empty() && name.find('.') == std::string::npos))
                << path << " includes " << name;
        }
    }
}

TEST(SourceRules, LibprepKnowsNothingOfLibrastNorLibrastOfTheTools) {
    const std::regex include(R"(#include\s*[<"]([^/">]+)/)");
    const auto includes = [&](const fs::path& path, const std::string& folder) {
        const std::string text = test::file_text(path);
        for (std::sregex_iterator i(text.begin(), text.end(), include), end; i != end; ++i)
            if ((*i)[1] == folder) return true;
        return false;
    };
    for (const fs::path& path : files_below({"libprep"}, {".h", ".cpp", ".inl"}))
        EXPECT_FALSE(includes(path, "rast")) << path;
    for (const fs::path& path : files_below({"libprep", "librast"}, {".h", ".cpp", ".inl"}))
        EXPECT_FALSE(includes(path, "meshprep") || includes(path, "sheets")) << path;
}

TEST(SourceRules, NoFileAsksForFastMath) {
    std::vector<fs::path> files = files_below({"cmake", "libprep", "librast", "tools", "samples"},
                                              {".h", ".cpp", ".inl", ".txt", ".cmake", ".in"});
    files.push_back(test::source_dir() / "CMakeLists.txt");
    files.push_back(test::source_dir() / "CMakePresets.json");
    for (const fs::path& path : files) {
        const std::string text = test::file_text(path);
        for (const char* word : {"-ffast-math", "-Ofast", "-funsafe-math", "-fassociative-math",
                                 "-ffinite-math-only", "\"fast-math\"", "-fno-signed-zeros"})
            EXPECT_EQ(text.find(word), std::string::npos) << path << ": " << word;
    }
    // A product and a sum in one rounding are other bits than in two.
    bool contraction = false;
    for (const fs::path& path : files)
        contraction |= test::file_text(path).find("-ffp-contract=off") != std::string::npos;
    EXPECT_TRUE(contraction);
}

// fuzz_prepare and fuzz_render make meshes of any bytes; readers want a file to begin with.
TEST(SourceRules, EveryReaderIsFuzzedFromSeeds) {
    for (const char* format :
         {"obj", "mtl", "stl", "off", "ply", "om", "gltf", "scene", "contained"}) {
        const fs::path fuzz = test::source_dir() / "fuzz", seeds = fuzz / "corpus" / format;
        EXPECT_TRUE(fs::exists(fuzz / ("fuzz_" + std::string(format) + ".cpp"))) << format;
        EXPECT_TRUE(fs::is_directory(seeds) && !fs::is_empty(seeds)) << seeds;
    }
}

}  // namespace
