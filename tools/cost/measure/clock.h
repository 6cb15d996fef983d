// Where times come from: a clock that tests put their own in place of.
#pragma once

namespace cost {

struct Instant {
    double wall = 0;  // seconds since some moment
    double cpu = 0;   // seconds that all of this process' threads have computed
};

class Clock {
  public:
    virtual ~Clock() = default;
    virtual Instant now() = 0;
};

// The machine's steady clock and the process' CPU time.
class SystemClock : public Clock {
  public:
    Instant now() override;
};

}  // namespace cost
