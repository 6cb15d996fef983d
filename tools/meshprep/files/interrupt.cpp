#include "meshprep/files/interrupt.h"

#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <system_error>
#include <thread>

#include "meshprep/files/private_directory.h"
#include "prep/files.h"

namespace meshprep {
namespace {

std::atomic<bool> interrupted = false;

}  // namespace

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
    try {
        std::thread([signals] {
            int number = 0;
            if (sigwait(&signals, &number) != 0) return;
            interrupted = true;
            prep::discard_unfinished_files();
            remove_private_directories();
            ::_exit(128 + number);
        }).detach();
    } catch (const std::system_error&) {
        // No thread is to be had: signals end the process at once, whatever it leaves behind.
        pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
    }
}

void yield_to_interrupt() {
    while (interrupted) ::pause();
}

}  // namespace meshprep
