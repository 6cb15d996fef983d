// Threads for the stages: work is cut by its size alone, so that results do not depend on threads.
#pragma once

#include <cstddef>

#include "base/parallel.h"
#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace rast::detail {

// Flushes denormals to zero while it lives: they are slow, and the picture must not depend on how a
// worker thread happens to be set. The default rounding mode is set too.
class FloatingPointMode {
  public:
    FloatingPointMode() {
#if defined(__SSE2__)
        before_ = _mm_getcsr();
        constexpr unsigned masked_exceptions = 0x1f80, flush_to_zero = 0x8000,
                           denormals_are_zero = 0x0040;
        _mm_setcsr(masked_exceptions | flush_to_zero | denormals_are_zero);
#endif
    }
    ~FloatingPointMode() {
#if defined(__SSE2__)
        _mm_setcsr(before_);
#endif
    }
    FloatingPointMode(const FloatingPointMode&) = delete;
    FloatingPointMode& operator=(const FloatingPointMode&) = delete;

  private:
    unsigned before_ = 0;
};

// body(i) for every i below count, in any order.
template <class Body>
void parallel_items(std::size_t count, int threads, const Body& body) {
    prep::detail::parallel_blocks(count, 1, threads, [&](std::size_t i, std::size_t) {
        const FloatingPointMode mode;
        body(i);
    });
}

}  // namespace rast::detail
