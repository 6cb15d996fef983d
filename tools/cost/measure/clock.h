// Where times come from: a clock that tests put their own in place of.
#pragma once

#include <cstddef>
#include <vector>

namespace cost {

struct Instant {
    double wall = 0;  // seconds since some moment
    double cpu = 0;   // seconds that all of this process' threads have computed
    // Seconds that all processors together were not idle, whoever had them, and a virtual machine's
    // stolen ones; 0: not known.
    double busy = 0;
};

class Clock {
  public:
    virtual ~Clock() = default;
    // Without `busy`.
    virtual Instant now() = 0;
    // With it: takes longer, for beginnings and ends.
    virtual Instant with_machine() { return now(); }
    // Keeps the calling thread on the processor that it runs on, with each further call on the next
    // one that it may run on, until run_anywhere().
    virtual void run_on_next() {}
    virtual void run_anywhere() {}
};

// The machine's steady clock, the process' CPU time, and Linux' /proc/stat (in hundredths of a
// second) and processor affinity: elsewhere threads stay where the system has them.
class SystemClock : public Clock {
  public:
    Instant now() override;
    Instant with_machine() override;
    void run_on_next() override;
    void run_anywhere() override;

  private:
    std::vector<int> processors_;  // empty: the thread runs anywhere
    std::size_t next_ = 0;
};

}  // namespace cost
