#pragma once
// `exec --gdb`: a bench under a debugger.

#include "bench/bench.h"
#include "debug/gdb_session.h"

#include <functional>
#include <memory>
#include <string>

namespace puckloop::exec {

class DebugRun final : private debug::Debuggee {
  public:
    /// The bench was made with BenchOptions::record. Throws InputError for a place where nobody can listen.
    DebugRun(Bench& bench, const std::string& where);

    const std::string& address() const { return socket_.address(); }
    /// Reaching `pc` ends the run.
    void end_at(std::uint32_t pc) { control_.add_end(pc); }
    /// Waits for a debugger, then does what it wants, up to the budget. `paced`: by the wall clock.
    Bench::End run(cosim::Time budget, bool paced);
    /// The run has ended with this exit status.
    void on_exit(int status) { session_.on_exit(status); }

  private:
    debug::DebugChip& chip() override { return *chip_; }
    debug::StopControl& control() override { return control_; }
    bool reverses() const override { return bench_.target().saves(); }
    std::string frozen() const override;
    bool change(std::function<bool(debug::DebugChip&)> change) override;
    void press_reset() override { bench_.press_reset(); }
    double seconds() const override { return cosim::to_seconds(bench_.target().now()); }
    std::string summary() override;

    debug::Stop forward(bool step);
    debug::Stop backward(bool steps);
    /// Repeats up to where the chip stops or the present begins; false: the debugger wants to stop.
    bool repeat();

    Bench& bench_;
    History& history_;
    std::unique_ptr<debug::DebugChip> chip_;
    debug::StopControl control_;
    debug::GdbSocket socket_;
    std::function<bool()> interrupted_;
    debug::GdbSession session_;
    cosim::Time budget_ = 0;
    bool paced_ = false;
    Bench::End end_ = Bench::End::Time;
};

}  // namespace puckloop::exec
