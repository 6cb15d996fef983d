// Result has the interface of std::expected, and its access is checked in every build.
#include "prep/result.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>

namespace {

using prep::Error;
using prep::ErrorCode;
using prep::Result;

Result<int> half(int number) {
    if (number % 2) return Error{ErrorCode::invalid, "odd: " + std::to_string(number), "here"};
    return number / 2;
}

TEST(Result, HoldsAValueOrAnError) {
    const Result<int> four = half(8), none = half(7);
    ASSERT_TRUE(four);
    EXPECT_EQ(*four, 4);
    EXPECT_EQ(four.value(), 4);
    ASSERT_FALSE(none);
    EXPECT_EQ(none.error().text, "odd: 7");
    EXPECT_EQ(to_string(none.error()), "here: odd: 7");
    EXPECT_EQ(four.value_or(1), 4);
    EXPECT_EQ(none.value_or(1), 1);
}

TEST(Result, ChainsAsStdExpectedDoes) {
    EXPECT_EQ(half(8).and_then(half).and_then(half).value(), 1);
    EXPECT_EQ(half(12).and_then(half).and_then(half).error().text, "odd: 3");
    EXPECT_EQ(half(8).transform([](int n) { return std::to_string(n) + "!"; }).value(), "4!");
    EXPECT_EQ(half(7).transform([](int n) { return n + 1; }).error().place, "here");
    EXPECT_EQ(half(7).or_else([](const Error& e) { return half(int(e.text.size())); }).value(), 3);
    EXPECT_EQ(half(8).or_else([](const Error&) { return half(100); }).value(), 4);
    EXPECT_EQ(half(7).transform_error([](Error e) { return e.place = "there", e; }).error().place,
              "there");
}

TEST(Result, MovesWhatCannotBeCopied) {
    Result<std::unique_ptr<int>> owner = std::make_unique<int>(5);
    EXPECT_EQ(**owner, 5);
    EXPECT_EQ(
        std::move(owner).and_then([](std::unique_ptr<int> p) { return half(*p + 1); }).value(), 3);
    Result<std::unique_ptr<int>> other = std::make_unique<int>(6);
    const std::unique_ptr<int> taken = *std::move(other);
    EXPECT_EQ(*taken, 6);
}

TEST(Result, OfNothingIsDoneOrAnError) {
    const Result<void> done, failed = Error{ErrorCode::io, "disk full", ""};
    EXPECT_TRUE(done);
    EXPECT_EQ(failed.error().code, ErrorCode::io);
    EXPECT_EQ(done.and_then([] { return half(2); }).value(), 1);
    EXPECT_EQ(failed.and_then([] { return half(2); }).error().text, "disk full");
    EXPECT_TRUE(failed.or_else([](const Error&) { return Result<void>(); }));
}

using ResultDeathTest = testing::Test;
TEST(ResultDeathTest, TheValueOfAnErrorEndsTheProgramWithItsText) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    EXPECT_DEATH(static_cast<void>(half(7).value()), "here: odd: 7");
    EXPECT_DEATH(static_cast<void>(*half(7)), "here: odd: 7");
    EXPECT_DEATH(Result<void>(Error{ErrorCode::io, "disk full", ""}).value(), "disk full");
    EXPECT_DEATH(static_cast<void>(half(8).error()), "of a value");
}

}  // namespace
