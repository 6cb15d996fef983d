#include "meshprep/interrupt.h"

#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace meshprep {
namespace {

namespace fs = std::filesystem;

struct Guarded {
    fs::path output;
    fs::file_time_type since;
};

// The one list that the waiting thread and the writing one share.
struct Shared {
    std::mutex mutex;
    std::vector<Guarded> outputs;
};
Shared& shared() {
    static Shared* const instance =
        new Shared;  // never destroyed: the waiting thread outlives main
    return *instance;
}

bool is_temporary_of(const std::string& name, const std::string& stem) {
    if (name.size() < stem.size() + 9 || name.compare(0, stem.size() + 1, stem + ".") != 0)
        return false;
    const std::size_t dot = name.size() - 7;
    return name[dot] == '.' && dot > stem.size() &&
           std::all_of(name.begin() + static_cast<std::ptrdiff_t>(dot) + 1, name.end(),
                       [](unsigned char c) { return std::isalnum(c) != 0; });
}

}  // namespace

OutputGuard::OutputGuard(const fs::path& output) {
    const std::lock_guard lock(shared().mutex);
    // File systems may keep coarser times than the clock: a second of grace.
    shared().outputs.push_back(
        {output, fs::file_time_type::clock::now() - std::chrono::seconds(1)});
}

OutputGuard::~OutputGuard() {
    const std::lock_guard lock(shared().mutex);
    shared().outputs.pop_back();
}

int remove_temporaries() {
    const std::lock_guard lock(shared().mutex);
    int removed = 0;
    for (const Guarded& guarded : shared().outputs) {
        const fs::path parent =
            guarded.output.has_parent_path() ? guarded.output.parent_path() : fs::path(".");
        std::error_code ec;
        for (fs::directory_iterator it(parent, ec), end; !ec && it != end; it.increment(ec)) {
            std::error_code entry_ec;
            if (!it->is_regular_file(entry_ec) ||
                !is_temporary_of(it->path().filename().string(), guarded.output.stem().string()))
                continue;
            if (it->last_write_time(entry_ec) < guarded.since || entry_ec) continue;
            if (fs::remove(it->path(), entry_ec)) ++removed;
        }
    }
    return removed;
}

void watch_interrupts() {
    sigset_t signals;
    sigemptyset(&signals);
    bool any = false;
    for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
        struct sigaction old {};
        if (sigaction(number, nullptr, &old) == 0 && old.sa_handler == SIG_IGN) continue;
        sigaddset(&signals, number);
        any = true;
    }
    if (!any || pthread_sigmask(SIG_BLOCK, &signals, nullptr) != 0) return;
    std::thread([signals] {
        int number = 0;
        if (sigwait(&signals, &number) != 0) return;
        remove_temporaries();
        ::_exit(128 + number);
    }).detach();
}

}  // namespace meshprep
