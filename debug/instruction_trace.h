#pragma once
// `--trace`: every instruction on a line of its own, with what it changed.

#include "debug/debug_chip.h"
#include "debug/places.h"

#include <cstdint>
#include <cstdio>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace puckloop::debug {

struct AddressRange {
    std::uint32_t first = 0, last = 0xFFFFFFFF;  ///< both included
};

struct TraceFilter {
    std::vector<AddressRange> ranges;  ///< program addresses; none: all
    double from_s = 0.0;               ///< simulated seconds
    double to_s = 1e300;
};

/// Columns, tab-separated: cycle, pc, place (symbol), line (source), instruction, changes ("r24=0x10",
/// "[0x0123]=0x01": registers and bytes or words of data space that hold something else, or were written,
/// afterwards). Interrupts and resets have lines of their own, "interrupt TIMER0_OVF" for an instruction.
class InstructionTrace final : public chip::Instrument {
  public:
    using SecondsOf = std::function<double(std::uint64_t cycle)>;
    /// Throws RunError if the file cannot be written.
    InstructionTrace(const std::string& file, const DebugChip& chip, const Places& places,
                     const TraceFilter& filter, SecondsOf seconds_of);
    ~InstructionTrace() override;

    bool instruction(std::uint32_t pc, std::uint64_t cycle) override;
    void interrupt(int vector, std::uint32_t pc, std::uint64_t cycle) override;
    void reset(std::uint64_t cycle) override;
    void access(std::uint16_t address, int bytes, bool write) override;
    /// The run is over: the last instruction is written. Throws RunError: the disk is full;
    /// the file is gone then.
    void finish();

  private:
    bool wanted(std::uint32_t pc, std::uint64_t cycle) const;
    void complete();
    void put(const std::string& text);

    std::string file_;
    std::FILE* out_ = nullptr;
    const DebugChip& chip_;
    const Places& places_;
    TraceFilter filter_;
    SecondsOf seconds_of_;
    struct Write {
        std::uint16_t address = 0;
        int bytes = 1;
    };
    bool open_ = false;  ///< a line waits for what its instruction changes
    std::string line_;
    std::vector<Write> writes_;
    std::vector<std::uint64_t> before_, after_;
    std::map<std::uint32_t, std::string> texts_;  ///< what stands behind the cycle, by address
};

}  // namespace puckloop::debug
