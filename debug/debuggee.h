#pragma once
// What a debugger's session acts on besides the chip: the run that the chip is part of.

#include "debug/debug_chip.h"
#include "debug/stop_control.h"

#include <functional>
#include <string>

namespace puckloop::debug {

class Debuggee {
  public:
    virtual ~Debuggee() = default;

    virtual DebugChip& chip() = 0;
    virtual StopControl& control() = 0;
    /// Whether the run can go back.
    virtual bool reverses() const = 0;
    /// Empty, or why one that can go back does not now, as text for the user.
    virtual std::string no_way_back() const { return {}; }
    /// Empty, or why nothing may be changed now (the program stands in its past).
    virtual std::string frozen() const = 0;
    /// From here on the chip is another one than the program made it. Registers and memory are changed by
    /// `change` only, so that a run that goes back can do it again.
    virtual bool change(std::function<bool(DebugChip&)> change) = 0;
    /// A pulse on the reset pin, now.
    virtual void press_reset() = 0;
    /// Simulated time in seconds.
    virtual double seconds() const = 0;
    /// What the run would report if it ended now.
    virtual std::string summary() = 0;
};

}  // namespace puckloop::debug
