// Fixed-partition parallelism: the work is cut by its size alone, never by the number of threads,
// so that results do not depend on it.
#pragma once

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstddef>

namespace prep::detail {

// Calls body(begin, end) for consecutive blocks of `grain` items (the last may be shorter), on at
// most `threads` threads (0: all cores). Blocks start at multiples of `grain`.
template <class Body>
void parallel_blocks(std::size_t count, std::size_t grain, int threads, const Body& body) {
    if (count == 0) return;
    const std::size_t blocks = (count + grain - 1) / grain;
    const auto run = [&](std::size_t b) { body(b * grain, std::min(count, (b + 1) * grain)); };
    if (blocks == 1 || threads == 1) {
        for (std::size_t b = 0; b < blocks; ++b) run(b);
        return;
    }
    const auto all = [&] {
        tbb::parallel_for(std::size_t{0}, blocks, run, tbb::simple_partitioner{});
    };
    // An arena of its own only to have fewer threads than there are here: it takes time to start.
    if (threads == 0 || threads >= tbb::this_task_arena::max_concurrency()) {
        all();
    } else {
        tbb::task_arena arena(threads);
        arena.execute(all);
    }
}

// Runs work(threads) where nested parallel_blocks(…, threads, …) share at most `threads` threads
// (0: all cores).
template <class Work>
void with_threads(int threads, const Work& work) {
    if (threads == 1) {
        work(1);
    } else if (threads == 0 || threads >= tbb::this_task_arena::max_concurrency()) {
        work(0);
    } else {
        tbb::task_arena arena(threads);
        arena.execute([&] { work(0); });
    }
}

// Calls both, at once where threads != 1.
template <class A, class B>
void parallel_both(int threads, const A& a, const B& b) {
    if (threads == 1) {
        a();
        b();
    } else {
        tbb::parallel_invoke(a, b);
    }
}

}  // namespace prep::detail
