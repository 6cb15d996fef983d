#include "steps.h"

#include "base/step_count.h"

namespace test {

std::uint64_t steps_taken() {
    return prep::detail::steps_taken;
}

}  // namespace test
