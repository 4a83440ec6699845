#pragma once
// What looks at a core while it executes: debuggers, instruction traces, profiles.

#include <cstdint>

namespace puckloop::chip {

/// A core with an instrument interprets every instruction and skips none, which changes nothing of what
/// the program does and when. Without one a core pays nothing. All calls come from inside a run.
class Instrument {
  public:
    virtual ~Instrument() = default;
    /// The instruction at `pc` (program address; AVR: in bytes) is next, at `cycle`; each iteration of a
    /// repeated instruction. False: the run ends before it, as at a stop address, and goes on with it. A chip
    /// that is reset from within this call goes on with what its reset vector leads to, which is shown next.
    virtual bool instruction(std::uint32_t pc, std::uint64_t cycle) = 0;
    /// An interrupt or trap is taken at `cycle`, before the instruction at `pc`.
    virtual void interrupt(int /*vector*/, std::uint32_t /*pc*/, std::uint64_t /*cycle*/) {}
    /// The core is reset at `cycle`.
    virtual void reset(std::uint64_t /*cycle*/) {}
    /// The instruction reads or writes data space: RAM, registers, working registers by address; only if it
    /// was asked for. Where an instruction reads in order to write, both come. Before the access.
    virtual void access(std::uint16_t /*address*/, int /*bytes*/, bool /*write*/) {}
};

}  // namespace puckloop::chip
