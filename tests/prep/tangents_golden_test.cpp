// Bit parity with results of the MikkTSpace reference and of its definition (../shared/golden).
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "corner_soup.h"
#include "shared_data.h"

namespace {

std::vector<std::filesystem::path> golden_inputs(const std::filesystem::path& shared) {
    std::vector<std::filesystem::path> inputs;
    for (const auto& entry :
         std::filesystem::recursive_directory_iterator(shared / "golden" / "mikktspace"))
        if (entry.path().extension() == ".mkt") inputs.push_back(entry.path());
    std::sort(inputs.begin(), inputs.end());
    return inputs;
}

void expect_golden(const std::filesystem::path& shared, prep::TangentMode mode,
                   const char* ending) {
    const auto inputs = golden_inputs(shared);
    ASSERT_FALSE(inputs.empty());
    for (const auto& path : inputs) {
        const auto soup = test::read_mkt(path);
        ASSERT_TRUE(soup) << path;
        const auto expected =
            test::read_tan(std::filesystem::path(path).replace_extension(ending), soup->corners());
        ASSERT_TRUE(expected) << path;
        prep::TangentOptions options;
        options.mode = mode;
        options.uv_origin = prep::UvOrigin::bottom_left;
        const auto result = prep::corner_tangents(soup->input(), options);
        ASSERT_TRUE(result.has_value()) << path;
        const auto tangents = test::flattened(*result);
        std::size_t different = 0;
        for (std::size_t c = 0; c < expected->size(); ++c) {
            const glm::vec4 got = tangents[c], want = (*expected)[c];
            if (std::memcmp(&got, &want, sizeof got) != 0 && different++ < 3)
                ADD_FAILURE() << path.filename() << " corner " << c << ": (" << got.x << ", "
                              << got.y << ", " << got.z << ", " << got.w << ") instead of ("
                              << want.x << ", " << want.y << ", " << want.z << ", " << want.w
                              << ")";
        }
        EXPECT_EQ(different, 0u) << path.filename() << ": of " << expected->size() << " corners";
    }
}

TEST(TangentsGolden, DefinitionMatchesEveryBit) {
    MESHPREP_REQUIRE_SHARED(shared);
    expect_golden(shared, prep::TangentMode::definition, ".fix");
}

TEST(TangentsGolden, ExactModeMatchesEveryBitOfTheReference) {
    MESHPREP_REQUIRE_SHARED(shared);
    expect_golden(shared, prep::TangentMode::mikktspace_exact, ".tan");
}

}  // namespace
