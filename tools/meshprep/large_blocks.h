// Blocks cut from one range of address space, of huge pages where the system has them.
#pragma once

// Sanitizers bring allocators of their own; the command then leaves new and delete to them.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define MESHPREP_OWN_NEW 0
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || \
    __has_feature(memory_sanitizer)
#define MESHPREP_OWN_NEW 0
#endif
#endif
#if !defined(MESHPREP_OWN_NEW) && defined(__linux__)
#define MESHPREP_OWN_NEW 1
#endif

#if defined(__linux__)
#include <sys/mman.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <iterator>
#include <map>
#include <mutex>

namespace meshprep {

// A block is cut from the lowest gap that is large enough, so that what was touched is touched
// again. Where gaps that take memory outgrow what is in use, they go back to the system. May be
// called from any thread.
class LargeBlocks {
  public:
    using Address = std::uintptr_t;

    // What blocks are rounded to.
    static constexpr std::size_t piece = std::size_t{1} << 14;
    static constexpr std::size_t huge_page = std::size_t{1} << 21;

    // `range`: address space alone; memory is asked for as blocks need it. `kept_gaps`: bytes of
    // gaps that are kept whatever is in use.
    LargeBlocks(std::size_t range, std::size_t kept_gaps) : range_(range), kept_gaps_(kept_gaps) {
        bounds_.fill(0);
        rlimit limit{};
        // Who limits the address space shall have what is left of it.
        if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur != RLIM_INFINITY) return;
        // Without access nothing is promised to the program, and a core dump has nothing to write.
        void* const all =
            mmap(nullptr, range + huge_page, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
        if (all == MAP_FAILED) return;
        mapped_ = all;
        begin_ = rounded_up(Address(all), huge_page);
        top_ = usable_ = begin_;
        madvise(reinterpret_cast<void*>(begin_), range, MADV_HUGEPAGE);  // a wish
    }
    ~LargeBlocks() {
        if (mapped_) munmap(mapped_, range_ + huge_page);
    }
    LargeBlocks(const LargeBlocks&) = delete;
    LargeBlocks& operator=(const LargeBlocks&) = delete;

    bool is_ready() const { return begin_ != 0; }

    // Null: there is no place, or the system has no memory. Throws bad_alloc where there is none
    // for the books; nothing has changed then.
    void* allocate(std::size_t size, std::size_t alignment) {
        if (!is_ready() || size > range_ / 2 || alignment > huge_page) return nullptr;
        size = std::max(rounded_up(size, piece), piece);
        alignment = std::max(alignment, piece);
        const std::lock_guard lock(mutex_);
        auto span = lowest_fit(size, alignment);
        if (span == spans_.end()) {
            span = grown_end(size, alignment);
            if (span == spans_.end()) return nullptr;
        }
        const Address block = rounded_up(span->first, alignment);
        if (block > span->first) span = cut(span, block);
        if (span->second.size > size) cut(span, block + size);
        touched_ -= span->second.touched;
        span->second.used = true;
        used_ += size;
        return reinterpret_cast<void*>(block);
    }

    // Aborts where that is no block.
    void release(void* pointer) noexcept {
        const std::lock_guard lock(mutex_);
        auto span = spans_.find(Address(pointer));
        if (span == spans_.end() || !span->second.used) std::abort();
        used_ -= span->second.size;
        touched_ += span->second.size;
        span->second.touched = span->second.size;
        span->second.used = false;
        const auto next = std::next(span);
        if (next != spans_.end() && !next->second.used) span = merged(span, next);
        if (span != spans_.begin() && !std::prev(span)->second.used)
            span = merged(std::prev(span), span);
        note(span);
        if (touched_ > std::max(kept_gaps_ + used_, next_giving_)) give_back();
    }

    // Without the lock: a block is owned from its allocation to its release.
    bool owns(const void* pointer) const {
        return is_ready() && Address(pointer) - begin_ < range_;
    }

    // Bytes of blocks, and of gaps those that may take memory.
    std::size_t used() const {
        const std::lock_guard lock(mutex_);
        return used_;
    }
    std::size_t touched() const {
        const std::lock_guard lock(mutex_);
        return touched_;
    }
    // Spans looked at for a place, so far.
    std::uint64_t looks() const {
        const std::lock_guard lock(mutex_);
        return looks_;
    }

  private:
    // A block or a gap. They lie side by side from begin_ to top_, no two gaps next to each other
    // but where the books had no memory.
    struct Span {
        std::size_t size = 0;
        std::size_t touched = 0;  // of a gap: at most so much of it takes memory
        bool used = false;
    };
    using Spans = std::map<Address, Span>;

    // Memory is asked for in multiples of it.
    static constexpr std::size_t step = std::size_t{64} << 20;

    static Address rounded_up(Address value, std::size_t unit) {
        return (value + unit - 1) / unit * unit;
    }

    // Sizes of a class differ by less than an eighth; those of up to 16 pieces have their own.
    static std::size_t class_of(std::size_t size) {
        const std::size_t pieces = size / piece;
        if (pieces < 16) return pieces;
        const std::size_t power = std::size_t(std::bit_width(pieces)) - 1;
        return 16 + 8 * (power - 4) + (pieces >> (power - 3)) % 8;
    }
    static constexpr std::size_t classes = 16 + 8 * 44;

    // The lowest gap with a place for it. Gaps below a class' bound are known to be of lower ones,
    // so that many blocks of about one size do not look at each other.
    Spans::iterator lowest_fit(std::size_t size, std::size_t alignment) {
        const std::size_t own = class_of(size);
        Address bound = top_;
        auto span = spans_.lower_bound(bounds_[own]);
        for (; span != spans_.end(); ++span) {
            ++looks_;
            if (span->second.used || class_of(span->second.size) < own) continue;
            bound = std::min(bound, span->first);
            const Address block = rounded_up(span->first, alignment);
            if (block + size <= span->first + span->second.size) break;
        }
        bounds_[own] = bound;
        return span;
    }

    // A gap at the end that has the place.
    Spans::iterator grown_end(std::size_t size, std::size_t alignment) {
        auto last = spans_.empty() ? spans_.end() : std::prev(spans_.end());
        if (last != spans_.end() && last->second.used) last = spans_.end();
        const Address begin = last == spans_.end() ? top_ : last->first;
        const Address end = rounded_up(begin, alignment) + size;
        if (end > begin_ + range_ || !make_usable(end)) return spans_.end();
        if (last == spans_.end()) last = spans_.emplace(begin, Span{}).first;
        last->second.size = end - begin;
        top_ = end;
        note(last);
        return last;
    }

    bool make_usable(Address end) {
        if (end <= usable_) return true;
        const Address to = std::min(begin_ + rounded_up(end - begin_, step), begin_ + range_);
        if (mprotect(reinterpret_cast<void*>(usable_), to - usable_, PROT_READ | PROT_WRITE) != 0)
            return false;
        usable_ = to;
        return true;
    }

    // Makes two gaps of one; gives the second.
    Spans::iterator cut(Spans::iterator gap, Address at) {
        Span& lower = gap->second;
        const std::size_t size = at - gap->first, rest = lower.size - size;
        const std::size_t touched = lower.touched;
        const auto upper =
            spans_.emplace_hint(std::next(gap), at, Span{rest, std::min(touched, rest), false});
        lower.size = size;
        lower.touched = std::min(touched, size);
        touched_ += lower.touched + upper->second.touched - touched;
        note(upper);
        return upper;
    }

    Spans::iterator merged(Spans::iterator lower, Spans::iterator upper) {
        lower->second.size += upper->second.size;
        lower->second.touched += upper->second.touched;
        spans_.erase(upper);
        return lower;
    }

    void note(Spans::iterator gap) {
        const std::size_t own = class_of(gap->second.size);
        for (std::size_t c = 0; c <= own; ++c) bounds_[c] = std::min(bounds_[c], gap->first);
    }

    // From the highest down, for the low ones are used first; a quarter more than is needed, so
    // that gaps are looked through once in many releases.
    void give_back() {
        const std::size_t enough = kept_gaps_ / 4 * 3 + used_;
        for (auto gap = spans_.end(); gap != spans_.begin() && touched_ > enough;) {
            --gap;
            if (gap->second.used || gap->second.touched == 0) continue;
            const Address first = rounded_up(gap->first, huge_page);
            const Address last = (gap->first + gap->second.size) / huge_page * huge_page;
            if (first >= last) continue;
            madvise(reinterpret_cast<void*>(first), last - first, MADV_DONTNEED);
            const std::size_t kept =
                std::min(gap->second.touched, gap->second.size - (last - first));
            touched_ -= gap->second.touched - kept;
            gap->second.touched = kept;
        }
        // Gaps within huge pages stay; they are not looked at again for each block.
        next_giving_ = touched_ > kept_gaps_ + used_ ? touched_ + step : 0;
    }

    const std::size_t range_, kept_gaps_;
    void* mapped_ = nullptr;
    Address begin_ = 0;
    mutable std::mutex mutex_;
    Address top_ = 0;     // behind the last block that ever was
    Address usable_ = 0;  // what may be read and written ends here
    std::size_t used_ = 0, touched_ = 0, next_giving_ = 0;
    std::uint64_t looks_ = 0;
    Spans spans_;
    std::array<Address, classes> bounds_;  // by class: no gap below is of it or a higher one
};

}  // namespace meshprep
#endif
