// Fixed-partition parallelism: the work is cut by its size alone, never by the number of threads,
// so that results do not depend on it.
#pragma once

#include <algorithm>
#include <cstddef>

namespace prep::detail {

// A callable that outlives its call, without its type: what runs it is compiled once.
class TaskRef {
  public:
    template <class Task>
    TaskRef(const Task& task)
        : task_(&task),
          call_([](const void* t, std::size_t i) { (*static_cast<const Task*>(t))(i); }) {}
    void operator()(std::size_t i) const { call_(task_, i); }

  private:
    const void* task_;
    void (*call_)(const void*, std::size_t);
};

// Calls task(0) … task(count - 1) on at most `threads` threads (0: all cores), in order on one.
void parallel_tasks(std::size_t count, int threads, TaskRef task);
// Calls task(threads) where nested calls of `threads` share at most that many.
void parallel_arena(int threads, TaskRef task);
// How many threads there are to share, here.
int parallel_width();

// Calls body(begin, end) for consecutive blocks of `grain` items (the last may be shorter), on at
// most `threads` threads (0: all cores). Blocks start at multiples of `grain`.
template <class Body>
void parallel_blocks(std::size_t count, std::size_t grain, int threads, const Body& body) {
    parallel_tasks((count + grain - 1) / grain, threads,
                   [&](std::size_t b) { body(b * grain, std::min(count, (b + 1) * grain)); });
}

// Runs work(threads) where nested parallel_blocks(…, threads, …) share at most `threads` threads
// (0: all cores).
template <class Work>
void with_threads(int threads, const Work& work) {
    parallel_arena(threads, [&](std::size_t inner) { work(int(inner)); });
}

// Calls both, at once where threads != 1.
template <class A, class B>
void parallel_both(int threads, const A& a, const B& b) {
    parallel_tasks(2, threads, [&](std::size_t i) { i == 0 ? a() : b(); });
}

}  // namespace prep::detail
