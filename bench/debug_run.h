#pragma once
// `exec --gdb`: a bench under a debugger.

#include "bench/debugged.h"
#include "debug/gdb/gdb_session.h"

#include <functional>
#include <string>

namespace puckloop::exec {

class DebugRun {
  public:
    /// The bench was made with BenchOptions::record. Throws InputError for a place where nobody can listen.
    DebugRun(Bench& bench, const std::string& where);

    const std::string& address() const { return socket_.address(); }
    /// Reaching `pc` ends the run.
    void end_at(std::uint32_t pc) { debugged_.control().add_end(pc); }
    /// Waits for a debugger, then does what it wants, up to the budget. `paced`: by the wall clock.
    Bench::End run(cosim::Time budget, bool paced);
    /// The run has ended with this exit status.
    void on_exit(int status) { session_.on_exit(status); }

  private:
    Bench& bench_;
    Debugged debugged_;
    debug::GdbSocket socket_;
    std::function<bool()> interrupted_;
    debug::GdbSession session_;
};

}  // namespace puckloop::exec
