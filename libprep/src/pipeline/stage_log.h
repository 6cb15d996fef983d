// Which stages ran, why or why not, and their time.
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "base/process_memory.h"
#include "prep/prepared_scene.h"

namespace prep::detail {

// Collects, over all meshes, whether a stage ran, the first reason given for running or skipping
// it, and its time.
class StageLog {
  public:
    void skipped(const std::string& stage, const std::string& reason) {
        Entry& e = entry(stage);
        ++e.skipped;
        if (e.skip_reason.empty()) e.skip_reason = reason;
    }
    template <class Work>
    auto run(const std::string& stage, const std::string& reason, const Work& work) {
        auto result = run_on(stage, work);
        Entry& e = entry(stage);
        ++e.run;
        if (e.run_reason.empty()) e.run_reason = reason;
        return result;
    }
    // Time alone: the mesh was counted, or will be.
    template <class Work>
    auto run_on(const std::string& stage, const Work& work) {
        const ProcessMemory before = process_memory();
        const std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
        auto result = work();
        Entry& e = entry(stage);
        e.milliseconds +=
            std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
                .count();
        const ProcessMemory after = process_memory();
        e.page_faults += after.page_faults - before.page_faults;
        e.peak_bytes = after.peak_bytes;
        return result;
    }
    void count_moved(const std::string& stage, std::uint64_t bytes) { entry(stage).moved += bytes; }
    void count_exact(const std::string& stage, std::uint64_t count) { entry(stage).exact += count; }
    std::vector<StageReport> reports() const {
        std::vector<StageReport> result;
        for (const Entry& e : entries_) {
            StageReport r{e.stage,        e.run > 0, e.run > 0 ? e.run_reason : e.skip_reason,
                          e.milliseconds, e.exact,   e.page_faults,
                          e.peak_bytes,   e.moved};
            if (e.run > 0 && e.skipped > 0)
                r.reason = std::to_string(e.run) + " of " + std::to_string(e.run + e.skipped) +
                           " meshes: " + r.reason + "; others: " + e.skip_reason;
            result.push_back(std::move(r));
        }
        return result;
    }

  private:
    struct Entry {
        std::string stage, run_reason, skip_reason;
        std::size_t run = 0, skipped = 0;
        double milliseconds = 0;
        std::uint64_t exact = 0, page_faults = 0, peak_bytes = 0, moved = 0;
    };
    Entry& entry(const std::string& stage) {
        for (Entry& e : entries_)
            if (e.stage == stage) return e;
        entries_.push_back({stage, {}, {}});
        return entries_.back();
    }
    std::vector<Entry> entries_;
};

}  // namespace prep::detail
