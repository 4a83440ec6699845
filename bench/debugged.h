#pragma once
// A bench under a debugger, whoever speaks for it: going on, going back, changing something.

#include "bench/bench.h"
#include "debug/debuggee.h"

#include <functional>
#include <memory>
#include <string>

namespace puckloop::exec {

class Debugged final : public debug::Debuggee {
  public:
    /// The bench was made with BenchOptions::record.
    explicit Debugged(Bench& bench);

    /// Asked while the program runs: it is to stop now, as at a breakpoint; null: never.
    std::function<bool()> wants_stop;
    /// Asked likewise: the run is to end.
    std::function<bool()> wants_end;

    /// Before the first instruction. `budget`: the run ends there. `paced`: by the wall clock.
    void begin(cosim::Time budget, bool paced);
    /// Goes on; Stop::Why::End when the run is over, by the reason end().
    debug::Stop forward(bool step);
    debug::Stop backward(bool steps);
    Bench::End end() const { return end_; }
    bool in_past() const;

    debug::DebugChip& chip() override { return *chip_; }
    debug::StopControl& control() override { return control_; }
    bool reverses() const override { return bench_.target().saves(); }
    std::string frozen() const override;
    bool change(std::function<bool(debug::DebugChip&)> change) override;
    void press_reset() override { bench_.press_reset(); }
    double seconds() const override { return cosim::to_seconds(bench_.target().now()); }
    std::string summary() override;

  private:
    /// Repeats up to where the chip stops or the present begins; false: somebody wants it to stop.
    bool repeat();

    Bench& bench_;
    History& history_;
    std::unique_ptr<debug::DebugChip> chip_;
    debug::StopControl control_;
    cosim::Time budget_ = 0;
    bool paced_ = false;
    Bench::End end_ = Bench::End::Time;
};

}  // namespace puckloop::exec
