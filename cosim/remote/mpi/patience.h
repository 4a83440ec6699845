#pragma once
// How a rank waits for what MPI can only be asked for: it asks again and again and lets others have the core
// in between, then with pauses, which cost some 60 us each.

#include <chrono>
#include <thread>

#include <sched.h>

namespace puckloop::cosim {

class Patience {
  public:
    /// Before the next question, after one in vain.
    void wait() {
        ++asked_;
        if (asked_ < kAtOnce)
            sched_yield();
        else
            std::this_thread::sleep_for(used_up() ? kLong : kShort);
    }
    /// It has come to the long pauses. The short ones are many: two that wait for each other would make each
    /// other's pauses longer.
    bool used_up() const { return asked_ >= kAtOnce + kShortPauses; }
    /// After a question that was not in vain.
    void renew() { asked_ = 0; }

  private:
    static constexpr int kAtOnce = 2000, kShortPauses = 200;  // a question takes some 300 ns
    static constexpr std::chrono::microseconds kShort{10}, kLong{1000};

    int asked_ = 0;
};

}  // namespace puckloop::cosim
