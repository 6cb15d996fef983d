// For the preset tsan: what this project uses of TBB, on threads of its own. The thread sanitizer
// does not see the synchronisation inside the installed library, which is not instrumented, and
// would call every hand-over between its workers a race. Here every hand-over is seen, so what is
// reported is ours.
#pragma once

#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

namespace tbb {

// At least four, so that races show on machines of fewer cores.
class task_arena {
  public:
    explicit task_arena(int) {}
    template <class Work>
    auto execute(const Work& work) {
        return work();
    }
};

namespace this_task_arena {
inline int max_concurrency() {
    return 4;
}
}  // namespace this_task_arena

struct simple_partitioner {};

template <class Body>
void parallel_for(std::size_t first, std::size_t last, const Body& body, simple_partitioner = {}) {
    std::atomic<std::size_t> next{first};
    const auto work = [&] {
        for (std::size_t i = next++; i < last; i = next++) body(i);
    };
    std::vector<std::thread> threads;
    for (int t = 1; t < 4; ++t) threads.emplace_back(work);
    work();
    for (std::thread& t : threads) t.join();
}

template <class A, class B>
void parallel_invoke(const A& a, const B& b) {
    std::thread other(b);
    a();
    other.join();
}

}  // namespace tbb
