// What happens on Ctrl-C: temporary files of outputs being written and what was unpacked are
// removed, then the process ends. Finished outputs and old ones are not touched, because writing is
// to a temporary name.
#pragma once

namespace meshprep {

// Blocks SIGINT, SIGTERM and SIGHUP for this thread and those it starts, and waits for them in a
// thread of its own. Signals that are ignored already (nohup) stay so. Call once, before other
// threads start.
void watch_interrupts();

// To be called before main ends: once a signal has come, its thread ends the process with the
// signal's status, and what failed because files were being removed under it is no other status.
void yield_to_interrupt();

}  // namespace meshprep
