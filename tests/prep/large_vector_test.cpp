// Growing memory: nothing is lost, whatever it moves to.
#include "base/large_vector.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <numeric>

namespace prep {
namespace {

using detail::LargeVector;

struct Record {
    std::uint64_t number = 7;
    std::uint8_t kind = 3;
};

std::uint64_t mixed(std::uint64_t k) {
    return (k + 1) * 0x9e3779b97f4a7c15U;
}

std::size_t changed(const LargeVector<Record>& vector) {
    std::size_t changed = 0;
    for (std::size_t k = 0; k < vector.size(); ++k)
        changed += vector[k].number != mixed(k) || vector[k].kind != std::uint8_t(k);
    return changed;
}

// From some bytes through 2 MB, where pages of its own begin, to 64 MB, through several moves.
TEST(LargeVector, KeepsItsElementsAsItGrows) {
    LargeVector<Record> vector;
    EXPECT_TRUE(vector.empty());
    std::size_t moves = 0;
    const Record* at = nullptr;
    for (std::uint64_t k = 0; k < (std::uint64_t(64) << 20) / sizeof(Record); ++k) {
        vector.push_back({mixed(k), std::uint8_t(k)});
        if (vector.data() == at) continue;
        ++moves;
        at = vector.data();
        EXPECT_EQ(changed(vector), 0U) << "of " << vector.size();
    }
    EXPECT_EQ(changed(vector), 0U);
    EXPECT_GE(moves, 5U);
    EXPECT_LE(moves, 64U) << "growing one by one takes linear time";
}

TEST(LargeVector, LargeOnesBeginAPage) {
    for (const std::size_t bytes :
         {std::size_t(1) << 20, detail::large_page, std::size_t(1) << 25}) {
        LargeVector<std::uint8_t> vector;
        vector.reserve(bytes);
        if (bytes < detail::large_page) continue;
        EXPECT_EQ(reinterpret_cast<std::uintptr_t>(vector.data()) % detail::large_page, 0U);
    }
}

TEST(LargeVector, NewElementsAreAsDeclared) {
    LargeVector<Record> vector;
    for (const std::size_t size : {std::size_t(3), std::size_t(100'000), std::size_t(1'000'000)}) {
        vector.clear();
        vector.resize(size / 2);
        for (Record& record : vector) record = {1, 1};
        vector.resize(size);
        for (std::size_t k = 0; k < size; ++k) {
            ASSERT_EQ(vector[k].number, k < size / 2 ? 1U : 7U) << k << " of " << size;
            ASSERT_EQ(vector[k].kind, k < size / 2 ? 1U : 3U) << k << " of " << size;
        }
    }
}

TEST(LargeVector, MovesAndSwaps) {
    for (const std::size_t size : {std::size_t(10), std::size_t(1'000'000)}) {
        LargeVector<std::uint64_t> a, b;
        a.resize_to_fill(size);
        std::iota(a.begin(), a.end(), std::uint64_t(5));
        b.push_back(1);
        std::swap(a, b);
        ASSERT_EQ(a.size(), 1U);
        EXPECT_EQ(a[0], 1U);
        ASSERT_EQ(b.size(), size);
        EXPECT_EQ(b[size - 1], 4 + size);
        const LargeVector<std::uint64_t> c = std::move(b);
        ASSERT_EQ(c.size(), size);
        EXPECT_EQ(c[size / 2], 5 + size / 2);
        EXPECT_TRUE(b.empty());  // NOLINT(bugprone-use-after-move): it says so
    }
}

// More than there are addresses: an error, and what was there stays.
TEST(LargeVector, SaysWhereThereIsNoMemory) {
    LargeVector<std::uint64_t> vector;
    vector.push_back(11);
    EXPECT_THROW(vector.reserve(std::size_t(1) << 57), std::bad_alloc);
    ASSERT_EQ(vector.size(), 1U);
    EXPECT_EQ(vector[0], 11U);
    vector.resize(1'000'000);
    EXPECT_THROW(vector.reserve(std::size_t(1) << 57), std::bad_alloc);
    ASSERT_EQ(vector.size(), 1'000'000U);
    EXPECT_EQ(vector[0], 11U);
    vector[999'999] = 12;
    EXPECT_EQ(vector[999'999], 12U);
}

}  // namespace
}  // namespace prep
