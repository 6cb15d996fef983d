// The command's large arrays against a model of what is in use, and against what the kernel says is
// resident.
#include "meshprep/large_blocks.h"

#include <gtest/gtest.h>

#if defined(__linux__)
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <new>
#include <random>
#include <thread>
#include <vector>

namespace {

using meshprep::LargeBlocks;

constexpr std::size_t page = 4096, megabyte = std::size_t{1} << 20;

std::size_t rounded(std::size_t size) {
    return std::max<std::size_t>((size + LargeBlocks::piece - 1) / LargeBlocks::piece, 1) *
           LargeBlocks::piece;
}

// Of this process, for as long as it lives.
class SoftLimit {
  public:
    SoftLimit(__rlimit_resource what, rlim_t bytes) : what_(what) {
        getrlimit(what, &before_);
        rlimit now = before_;
        now.rlim_cur = std::min(bytes, before_.rlim_max);
        setrlimit(what, &now);
    }
    ~SoftLimit() { setrlimit(what_, &before_); }
    SoftLimit(const SoftLimit&) = delete;
    SoftLimit& operator=(const SoftLimit&) = delete;

  private:
    __rlimit_resource what_;
    rlimit before_{};
};

// Blocks with a pattern in every page.
class Blocks {
  public:
    Blocks(LargeBlocks& from, std::uint64_t seed) : from_(from), random_(seed), seed_(seed) {}

    void step() {
        if (!held_.empty() && random_() % 100 < 48 + std::min<std::size_t>(held_.size(), 40) / 10)
            release_one();
        else
            allocate_one();
    }
    void release_all() {
        while (!held_.empty()) release_one();
    }

    struct Held {
        std::size_t size;
        std::uint64_t pattern;
    };
    const std::map<std::uintptr_t, Held>& held() const { return held_; }

  private:
    void allocate_one() {
        const std::size_t size =
            random_() % 4 ? 1 + random_() % (megabyte / 2) : 1 + random_() % (12 * megabyte);
        const std::size_t alignment = std::size_t{1} << random_() % 22;
        void* const block = from_.allocate(size, alignment);
        ASSERT_NE(block, nullptr);
        EXPECT_TRUE(from_.owns(block));
        const auto at = reinterpret_cast<std::uintptr_t>(block);
        EXPECT_EQ(at % alignment, 0u);
        const auto next = held_.lower_bound(at);
        if (next != held_.end()) {
            EXPECT_LE(at + size, next->first);
        }
        if (next != held_.begin()) {
            EXPECT_LE(std::prev(next)->first + std::prev(next)->second.size, at);
        }
        const std::uint64_t pattern = ++made_ * 1000003 + seed_;
        held_[at] = {size, pattern};
        each_word(at, size, [&](unsigned char& byte, std::size_t i) { byte = value(pattern, i); });
    }
    void release_one() {
        const auto one = std::next(held_.begin(), std::ptrdiff_t(random_() % held_.size()));
        std::size_t wrong = 0;
        each_word(one->first, one->second.size, [&](unsigned char& byte, std::size_t i) {
            wrong += byte != value(one->second.pattern, i);
        });
        EXPECT_EQ(wrong, 0u);
        from_.release(reinterpret_cast<void*>(one->first));
        held_.erase(one);
    }
    static unsigned char value(std::uint64_t pattern, std::size_t i) {
        return static_cast<unsigned char>((pattern + i) * 0x9e3779b97f4a7c15u >> 56);
    }
    template <class F>
    static void each_word(std::uintptr_t at, std::size_t size, F f) {
        auto* const bytes = reinterpret_cast<unsigned char*>(at);
        for (std::size_t i = 0; i < size; i += page) f(bytes[i], i);
        f(bytes[size - 1], size - 1);
    }

    LargeBlocks& from_;
    std::mt19937_64 random_;
    std::uint64_t seed_, made_ = 0;
    std::map<std::uintptr_t, Held> held_;
};

std::size_t resident(std::uintptr_t begin, std::size_t size) {
    std::vector<unsigned char> pages(size / page);
    EXPECT_EQ(mincore(reinterpret_cast<void*>(begin), size, pages.data()), 0);
    return page * std::size_t(std::count_if(pages.begin(), pages.end(),
                                            [](unsigned char p) { return (p & 1) != 0; }));
}

TEST(LargeBlocks, LieApartKeepTheirContentsAndAreCounted) {
    // A huge page is resident as a whole, blocks and gaps alike.
    prctl(PR_SET_THP_DISABLE, 1, 0, 0, 0);
    constexpr std::size_t range = 2048 * megabyte, kept = 16 * megabyte;
    LargeBlocks all(range, kept);
    if (!all.is_ready()) GTEST_SKIP() << "the address space is limited";
    void* const first = all.allocate(1, 1);  // the range begins with it
    const auto begin = reinterpret_cast<std::uintptr_t>(first);
    all.release(first);
    Blocks blocks(all, 1);
    std::size_t given_back = 0, most = 0;
    for (int n = 0; n < 6000; ++n) {
        blocks.step();
        if (n % 50 != 0) continue;
        std::size_t used = 0;
        for (const auto& [at, block] : blocks.held()) used += rounded(block.size);
        EXPECT_EQ(all.used(), used);
        const std::size_t now = resident(begin, range);
        EXPECT_LE(now, all.used() + all.touched());
        given_back += now < most;
        most = std::max(most, now);
    }
    EXPECT_GT(given_back, 0u);
    blocks.release_all();
    EXPECT_EQ(all.used(), 0u);
    EXPECT_LE(all.touched(), kept);
    EXPECT_LE(resident(begin, range), all.touched());
    // All is one gap again.
    void* const half = all.allocate(range / 2, 1);
    EXPECT_EQ(half, first);
    all.release(half);
    prctl(PR_SET_THP_DISABLE, 0, 0, 0, 0);
}

TEST(LargeBlocks, OfSeveralThreadsLieApart) {
    LargeBlocks all(4096 * megabyte, 8 * megabyte);
    if (!all.is_ready()) GTEST_SKIP() << "the address space is limited";
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t)
        threads.emplace_back([&all, t] {
            Blocks blocks(all, 100 + std::uint64_t(t));
            for (int n = 0; n < 800; ++n) blocks.step();
            blocks.release_all();
        });
    for (auto& thread : threads) thread.join();
    EXPECT_EQ(all.used(), 0u);
}

// Gaps that are too small are not looked at for every block.
TEST(LargeBlocks, ManyOfOneSizeAreFoundInConstantTime) {
    LargeBlocks all(8192 * megabyte, 512 * megabyte);
    if (!all.is_ready()) GTEST_SKIP() << "the address space is limited";
    constexpr std::size_t small = 5 * LargeBlocks::piece;
    std::vector<void*> blocks;
    for (int n = 0; n < 4000; ++n) blocks.push_back(all.allocate(small, 1));
    for (std::size_t i = 0; i < blocks.size(); i += 2) all.release(blocks[i]);
    for (int n = 0; n < 2000; ++n) ASSERT_NE(all.allocate(small + 1, 1), nullptr);
    for (std::size_t i = 0; i < blocks.size(); i += 2) EXPECT_EQ(all.allocate(small, 1), blocks[i]);
    EXPECT_LE(all.looks(), 5u * 8000u);
}

TEST(LargeBlocks, AreNullWhereTheSystemHasNoMemory) {
    LargeBlocks all(4096 * megabyte, 8 * megabyte);
    if (!all.is_ready()) GTEST_SKIP() << "the address space is limited";
    EXPECT_EQ(all.allocate(3000 * megabyte, 1), nullptr);  // nor is there a place
    EXPECT_EQ(all.allocate(SIZE_MAX - 5, 1), nullptr);
    EXPECT_EQ(all.allocate(megabyte, std::size_t{1} << 30), nullptr);
    void* refused = nullptr;
    {
        const SoftLimit limit(RLIMIT_DATA, megabyte);
        refused = all.allocate(1000 * megabyte, 1);
    }
    EXPECT_EQ(refused, nullptr);
    EXPECT_EQ(all.used(), 0u);
    void* const block = all.allocate(1000 * megabyte, 1);
    ASSERT_NE(block, nullptr);
    static_cast<char*>(block)[1000 * megabyte - 1] = 1;
    all.release(block);
}

TEST(LargeBlocks, AreNoneUnderALimitOfTheAddressSpace) {
    const SoftLimit limit(RLIMIT_AS, rlim_t{1} << 62);
    LargeBlocks all(1024 * megabyte, 8 * megabyte);
    EXPECT_FALSE(all.is_ready());
    EXPECT_EQ(all.allocate(megabyte, 1), nullptr);
    int other = 0;
    EXPECT_FALSE(all.owns(&other));
}

TEST(LargeBlocksDeathTest, ReleaseOfWhatIsNoBlockAborts) {
    GTEST_FLAG_SET(death_test_style, "threadsafe");
    LargeBlocks all(1024 * megabyte, 8 * megabyte);
    if (!all.is_ready()) GTEST_SKIP() << "the address space is limited";
    auto* const block = static_cast<char*>(all.allocate(megabyte, 1));
    EXPECT_DEATH(all.release(block + 64), "");
    all.release(block);
    EXPECT_DEATH(all.release(block), "");
}

#if MESHPREP_OWN_NEW
// The compiler shall not know them.
template <class T>
T hidden(T value) {
    volatile T copy = value;
    return copy;
}

TEST(OwnNew, ThrowsWhereThereIsNoMemory) {
    EXPECT_THROW(::operator delete(::operator new(hidden(SIZE_MAX - 5))), std::bad_alloc);
    for (const std::size_t alignment : {64u, 4096u, 1u << 21, 1u << 22}) {
        const auto a = std::align_val_t(alignment);
        EXPECT_THROW(::operator delete(::operator new(hidden(SIZE_MAX - 5), a), a), std::bad_alloc);
        void* const none = ::operator new(hidden(std::size_t(0)), a);
        ASSERT_NE(none, nullptr);
        EXPECT_EQ(reinterpret_cast<std::uintptr_t>(none) % alignment, 0u);
        ::operator delete(none, a);
    }
    bool thrown = false;
    {
        const SoftLimit limit(RLIMIT_DATA, megabyte);
        try {
            ::operator delete(::operator new(hidden(1000 * megabyte)));
        } catch (const std::bad_alloc&) {
            thrown = true;
        }
    }
    EXPECT_TRUE(thrown);
}
#endif

}  // namespace
#endif
