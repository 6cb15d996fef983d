#include <gtest/gtest.h>

#include <bit>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <random>
#include <string>

#include "text/digits.h"
#include "text/numbers.h"

namespace {

using namespace prep::detail;

template <class Write, class T>
std::string text_of(Write write, T value) {
    char text[max_number_text];
    return {text, write(text, value)};
}

std::string shortest(float value) {
    char text[max_number_text];
    return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

TEST(NumberText, KnownFloats) {
    const std::pair<float, const char*> known[] = {{0.0f, "0"},
                                                   {-0.0f, "-0"},
                                                   {1.0f, "1"},
                                                   {-1.5f, "-1.5"},
                                                   {0.1f, "0.1"},
                                                   {1234567.0f, "1234567"},
                                                   {0.3f, "0.3"},
                                                   {1e-42f, "1e-42"},
                                                   {16777216.0f, "16777216"},
                                                   {3.14159274f, "3.1415927"},
                                                   {-0.70710677f, "-0.70710677"}};
    for (const auto& [value, text] : known) EXPECT_EQ(text_of(write_float, value), text);
    EXPECT_EQ(text_of(write_float, std::numeric_limits<float>::infinity()), "inf");
    EXPECT_EQ(text_of(write_float, std::nanf("")), "nan");
}

TEST(NumberText, FloatsReadBackInEveryBitAndAreNearlyAlwaysShortest) {
    // The C library's strtod is the judge. Seeded: the same floats every time.
    std::mt19937 random(20240607);
    std::size_t longer = 0, count = 0;
    const auto check = [&](float value) {
        const std::string text = text_of(write_float, value);
        const float again = float(std::strtod(text.c_str(), nullptr));
        ASSERT_EQ(std::bit_cast<std::uint32_t>(again), std::bit_cast<std::uint32_t>(value)) << text;
        const std::size_t least = shortest(value).size();
        ASSERT_LE(text.size(), least + 1) << text << " for " << shortest(value);
        longer += text.size() > least;
        ++count;
    };
    for (int i = 0; i < 200000; ++i) {
        const float any = std::bit_cast<float>(std::uint32_t(random()));
        if (std::isfinite(any)) check(any);
        check(std::ldexp(float(random() >> 8) + 1.0f, -24));     // (0, 1]
        check(float(int(random() % 2000001) - 1000000) / 1e6f);  // six decimals
        check(std::ldexp(1.0f + float(random() % 3) * 0x1p-23f, int(random() % 40) - 15));
    }
    EXPECT_LT(longer, count / 100) << longer << " of " << count;
}

TEST(NumberText, Integers) {
    for (const std::uint64_t value :
         {std::uint64_t(0), std::uint64_t(9), std::uint64_t(10), std::uint64_t(99),
          std::uint64_t(100), std::uint64_t(4294967295), std::uint64_t(999999999999),
          std::uint64_t(1000000000000), std::numeric_limits<std::uint64_t>::max()})
        EXPECT_EQ(text_of(write_integer, value), std::to_string(value));
}

TEST(NumberText, FlippedReadsBackAsTheSameFloat) {
    std::mt19937 random(7);
    for (int i = 0; i < 200000; ++i) {
        float v = std::ldexp(float(random() >> 8), -24) * (i % 3 == 0 ? 37.0f : 1.0f);
        if (i % 5 == 0) v = float(1.0 - double(random() % 1000001) / 1e6);
        if (i % 7 == 0) v = -v;
        const std::string text = text_of(write_flipped, v);
        EXPECT_EQ(float(1.0 - std::strtod(text.c_str(), nullptr)), v) << text;
    }
    EXPECT_EQ(text_of(write_flipped, 0.7f), "0.3");
    EXPECT_EQ(text_of(write_flipped, 1.0f), "0");
}

TEST(Digits, PlainDecimalsAreRoundedAsTheLibraryRounds) {
    std::mt19937_64 random(11);
    for (int i = 0; i < 300000; ++i) {
        std::string text = i % 2 ? "-" : "";
        const int before = int(random() % 9), behind = int(random() % 14);
        for (int k = 0; k < before; ++k) text += char('0' + random() % 10);
        if (i % 3) text += '.';
        for (int k = 0; i % 3 && k < behind; ++k) text += char('0' + random() % 10);
        const std::string padded = text + " \n123456789";
        const char* at = padded.c_str();
        double value = 0;
        if (!plain_decimal(at, value)) {
            EXPECT_EQ(at, padded.c_str());
            continue;
        }
        EXPECT_EQ(std::size_t(at - padded.c_str()), text.size());
        EXPECT_EQ(std::bit_cast<std::uint64_t>(value),
                  std::bit_cast<std::uint64_t>(std::strtod(text.c_str(), nullptr)))
            << text;
    }
}

TEST(Digits, IntegersOfEveryLengthAndWhatEndsThem) {
    for (const char* end : {" ", "/", "\n", "", ":", "a", "\x80", "\xff", "-"}) {
        std::string digits;
        for (int n = 1; n <= 12; ++n) {
            digits += char('0' + n % 10);
            const std::string text = digits + end + std::string(16, '\0');
            const char* at = text.c_str();
            const std::uint64_t value = std::stoull(digits);
            EXPECT_EQ(positive_integer(at, 1000000000), value <= 1000000000 ? value : 0) << text;
            if (value <= 1000000000) {
                EXPECT_EQ(at - text.c_str(), n);
            }
        }
    }
    const std::string none = "x" + std::string(16, '\0');
    const char* at = none.c_str();
    EXPECT_EQ(positive_integer(at, 10), 0u);
}

}  // namespace
