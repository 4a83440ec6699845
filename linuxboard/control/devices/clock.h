#pragma once
// Time for the control program: the system's monotonic clock on a robot, a simulated one in tests.

namespace puckloop::control {

class Clock {
  public:
    virtual ~Clock() = default;

    /// Monotonic time in seconds.
    virtual double now() = 0;
    /// Returns at `time`, or earlier when a signal arrives.
    virtual void sleep_until(double time) = 0;
};

class PosixClock : public Clock {
  public:
    double now() override;
    void sleep_until(double time) override;
};

}  // namespace puckloop::control
