#include "base/parallel.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace prep::detail {
namespace {

// An arena of its own only to have fewer threads than there are here: it takes time to start.
template <class Work>
void in_arena(int threads, const Work& work) {
    if (threads == 0 || threads >= parallel_width()) {
        work();
    } else {
        tbb::task_arena arena(threads);
        arena.execute(work);
    }
}

}  // namespace

int parallel_width() {
    return tbb::this_task_arena::max_concurrency();
}

void parallel_tasks(std::size_t count, int threads, TaskRef task) {
    if (count <= 1 || threads == 1) {
        for (std::size_t i = 0; i < count; ++i) task(i);
        return;
    }
    in_arena(threads,
             [&] { tbb::parallel_for(std::size_t{0}, count, task, tbb::simple_partitioner{}); });
}

void parallel_arena(int threads, TaskRef task) {
    if (threads == 1) {
        task(1);
    } else {
        in_arena(threads, [&] { task(0); });
    }
}

}  // namespace prep::detail
