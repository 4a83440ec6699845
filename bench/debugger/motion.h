#pragma once
// How a debugged program moves: by instruction, by source line, out of a function, and back.

#include "bench/debugged.h"
#include "bench/debugger/program.h"
#include "bench/debugger/stack.h"

#include <cstdint>
#include <functional>
#include <set>
#include <vector>

namespace puckloop::exec::debugger {

class Motion {
  public:
    Motion(Debugged& debugged, const Program& program) : debugged_(debugged), program_(program) {}

    /// A breakpoint of the user's.
    void add_break(std::uint32_t pc);
    void remove_break(std::uint32_t pc);
    bool is_break(std::uint32_t pc) const { return breaks_.contains(pc); }

    debug::Stop run() { return debugged_.forward(false); }
    debug::Stop step_instruction() { return debugged_.forward(true); }
    /// One instruction, over a call and over interrupts.
    debug::Stop next_instruction();
    /// To where another line begins; `into` functions that have lines, else over what is called. Without
    /// lines one instruction. Interrupts are run through.
    debug::Stop step_line(bool into);
    /// Until `frame` (1: the caller) is reached; Stop::Why::Begin: there is no such frame.
    debug::Stop finish(std::size_t frame);
    /// Until `pc` or a breakpoint.
    debug::Stop run_to(std::uint32_t pc);

    debug::Stop back_instruction() { return debugged_.backward(true); }
    debug::Stop back_run() { return debugged_.backward(false); }
    /// To where the line before this one began, in this function or its caller; `into` whatever function that
    /// was.
    debug::Stop back_line(bool into);

  private:
    /// Goes on to `pc` with no more on the stack than at `sp`.
    debug::Stop run_out(std::uint32_t pc, std::uint16_t sp);
    bool has_lines(std::uint32_t pc) const { return program_.line_of(pc).line != 0; }

    Debugged& debugged_;
    const Program& program_;
    std::set<std::uint32_t> breaks_;
};

}  // namespace puckloop::exec::debugger
