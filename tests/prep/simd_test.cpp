#include "prep/simd.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <string>

namespace {

using prep::SimdLevel;

// What the kernel says of the processor, in its words.
std::set<std::string> processor_flags() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);) {
        if (!line.starts_with("flags")) continue;
        std::istringstream words(line.substr(line.find(':') + 1));
        return {std::istream_iterator<std::string>(words), {}};
    }
    return {};
}

TEST(Simd, LevelsAreThoseOfTheProcessor) {
    const std::set<std::string> flags = processor_flags();
    if (flags.empty()) GTEST_SKIP() << "no /proc/cpuinfo with flags on this system";
    bool has = true;
    const auto needs = [&](std::initializer_list<const char*> names) {
        for (const char* name : names) has = has && flags.contains(name);
        return has;
    };
    const bool sse4 = needs({"ssse3", "sse4_1", "sse4_2", "pclmulqdq", "aes"});
    EXPECT_EQ(prep::simd_available(SimdLevel::sse4), sse4);
    const bool avx2 = needs({"avx", "avx2", "bmi1", "bmi2", "fma", "f16c"});
    EXPECT_EQ(prep::simd_available(SimdLevel::avx2), avx2);
    const bool avx512 = needs({"avx512f", "avx512vl", "avx512dq", "avx512bw"});
    EXPECT_EQ(prep::simd_available(SimdLevel::avx512), avx512);
    EXPECT_TRUE(prep::simd_available(SimdLevel::scalar));
    EXPECT_TRUE(prep::simd_available(SimdLevel::automatic));
}

}  // namespace
