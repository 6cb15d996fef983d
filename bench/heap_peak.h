// What a piece of code has on the heap at its height.
//
// Every program that links heap_peak.cpp counts the bytes asked of operator new and given back.
// What the allocator keeps for later is not counted, so that a second run shows the same as the
// first; resident memory would not, and turned negative where the first run's pages were used
// again.
#pragma once

#include <cstddef>

namespace bench {

// Bytes held at the moment.
std::size_t heap_bytes();

// Peak of heap_bytes() since the last restart_heap_peak().
std::size_t heap_peak();
void restart_heap_peak();

}  // namespace bench
