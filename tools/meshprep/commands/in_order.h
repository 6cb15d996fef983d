// Several files at once, and what is said of them in the order in which they were named.
#pragma once

#include <algorithm>
#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <optional>
#include <system_error>
#include <thread>
#include <vector>

namespace meshprep {

// make(i) for each i below `count`, on `workers` threads at once (1: on this one), or as many as
// the system has to give; use(result) on this thread, in order, each as soon as it and those before
// it are there. `make` does not throw. No worker is more than 4·workers files ahead of what was
// used: results wait in memory.
template <class Make, class Use>
void in_order(std::size_t count, std::size_t workers, const Make& make, const Use& use) {
    if (workers <= 1 || count <= 1) {
        for (std::size_t i = 0; i < count; ++i) use(make(i));
        return;
    }
    using Made = decltype(make(std::size_t(0)));
    std::vector<std::optional<Made>> made(count);
    std::mutex mutex;
    std::condition_variable changed;
    std::size_t next = 0, used = 0;
    const std::size_t ahead = 4 * workers;
    const auto work = [&] {
        for (;;) {
            std::unique_lock lock(mutex);
            changed.wait(lock, [&] { return next >= count || next < used + ahead; });
            if (next >= count) return;
            const std::size_t i = next++;
            lock.unlock();
            Made result = make(i);
            lock.lock();
            made[i].emplace(std::move(result));
            changed.notify_all();
        }
    };
    // The workers end whatever becomes of `use`: nobody would wait for a place otherwise.
    struct Ending {
        std::mutex& mutex;
        std::condition_variable& changed;
        std::size_t &next, count;
        ~Ending() {
            const std::lock_guard lock(mutex);
            next = count;
            changed.notify_all();
        }
    };
    std::vector<std::jthread> threads;
    const Ending ending{mutex, changed, next, count};
    threads.reserve(std::min(workers, count));
    try {
        while (threads.size() < std::min(workers, count)) threads.emplace_back(work);
    } catch (const std::system_error&) {
        // The limit of threads is reached: those there are do it, or else this one.
    }
    for (std::size_t i = 0; i < count; ++i) {
        if (threads.empty()) {
            use(make(i));
            continue;
        }
        std::unique_lock lock(mutex);
        changed.wait(lock, [&] { return made[i].has_value(); });
        Made result = *std::move(made[i]);
        made[i].reset();
        used = i + 1;
        changed.notify_all();
        lock.unlock();
        use(std::move(result));
    }
}

}  // namespace meshprep
