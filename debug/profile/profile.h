#pragma once
// `--stats`: what each instruction cost and how often it ran, which function called which, how deep the stack
// went, and what was read of RAM before anything wrote it.

#include "debug/debug_chip.h"
#include "debug/places.h"
#include "debug/variables.h"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace puckloop::debug {

struct Cost {
    std::uint64_t cycles = 0, instructions = 0;

    Cost& operator+=(const Cost& other) {
        cycles += other.cycles;
        instructions += other.instructions;
        return *this;
    }
};

class Profile final : public chip::Instrument {
  public:
    explicit Profile(const DebugChip& chip);

    bool instruction(std::uint32_t pc, std::uint64_t cycle) override;
    void interrupt(int vector, std::uint32_t pc, std::uint64_t cycle) override;
    void reset(std::uint64_t cycle) override;
    void access(std::uint16_t address, int bytes, bool write) override;
    /// The run ended at `cycle`. Calls that have not returned count up to there.
    void finish(std::uint64_t cycle);

    /// By program address; what interrupts cost to be taken belongs to the first instruction after it. Time
    /// asleep belongs to the instruction that put the chip to sleep.
    std::map<std::uint32_t, Cost> costs() const;
    struct Calls {
        std::uint64_t times = 0;
        Cost inclusive;  ///< interrupts meanwhile left out; a call inside itself counts in both
    };
    /// By call instruction and the function it called.
    const std::map<std::pair<std::uint32_t, std::uint32_t>, Calls>& calls() const { return calls_; }
    /// Where calls and interrupts led, with the vector's number where it was one.
    const std::map<std::uint32_t, std::optional<int>>& entries() const { return entries_; }

    struct Stack {
        std::uint32_t base = 0, peak = 0;  ///< SP at the first call since a reset, and farthest from it
        std::uint32_t peak_pc = 0;
        std::uint32_t bytes() const { return base > peak ? base - peak : peak - base; }
    };
    /// Nothing: no call was made.
    const std::optional<Stack>& stack() const { return stack_; }

    struct Unwritten {
        std::uint16_t address = 0;
        std::uint32_t pc = 0;
        std::uint64_t cycle = 0;  ///< of the first time
        std::uint64_t times = 0;
    };
    /// Reads of bytes of RAM that nothing had written since power-up, by place in the program and address.
    std::vector<Unwritten> unwritten() const;
    std::uint64_t unwritten_reads() const { return unwritten_reads_; }

  private:
    struct Frame {
        std::uint32_t site = 0, callee = 0, back = 0;
        Cost start, apart;  ///< apart: interrupts since
        bool interrupt = false;
    };
    void account(std::uint64_t cycle);
    void serve(std::uint32_t pc, std::uint64_t cycle);
    void follow(std::uint32_t pc);
    void enter(std::uint32_t pc);
    void leave(std::uint32_t pc, bool from_interrupt);
    void pop();
    struct Slot {
        Cost cost;
        Flow flow = Flow::Other;
        std::uint8_t size = 0;  ///< program addresses; 0: not looked at yet
    };
    Slot& slot(std::uint32_t pc);

    static constexpr std::size_t kDeepest = 4096;     ///< frames; older ones are given up
    static constexpr std::size_t kMostPlaces = 1000;  ///< of unwritten reads

    const DebugChip& chip_;
    std::vector<Slot> slots_;  ///< by half the program address
    std::map<std::pair<std::uint32_t, std::uint32_t>, Calls> calls_;
    std::map<std::uint32_t, std::optional<int>> entries_;
    std::vector<Frame> frames_;
    Cost total_;
    bool running_ = false;
    std::uint32_t pc_ = 0;
    std::uint64_t begun_ = 0;
    Flow flow_ = Flow::Other;  ///< of the instruction at pc_ ...
    std::uint32_t size_ = 0;
    std::optional<std::pair<int, std::uint32_t>> taken_;  ///< an interrupt: vector, where it came
    std::optional<Stack> stack_;
    bool based_ = false;  ///< the stack's base is known since the last reset
    std::vector<bool> written_;
    std::map<std::pair<std::uint32_t, std::uint16_t>, Unwritten> unwritten_;
    std::uint64_t unwritten_reads_ = 0;
};

/// Functions by their first address: the image's symbols, or, without any, where calls and interrupts led.
class FunctionNames {
  public:
    FunctionNames(const Profile& profile, const Places& places);
    std::uint32_t start_of(std::uint32_t pc) const;
    std::string name_of(std::uint32_t start) const;

  private:
    bool symbols_;
    std::map<std::uint32_t, std::string> starts_;
};
/// What each function cost, by its first address.
std::map<std::uint32_t, Cost> function_costs(const Profile& profile, const FunctionNames& names);

/// Callgrind's format, version 1, with instruction addresses and lines: callgrind_annotate and KCachegrind
/// read it. Costs are cycles and instructions.
std::string callgrind_text(const Profile& profile, const Places& places, const std::string& image,
                           const DebugChip& chip);
/// lcov's tracefile format. `folder`: where the source files lie, put before names that are not absolute;
/// empty: nothing. Empty without source lines.
std::string lcov_text(const Profile& profile, const Places& places, const std::string& folder);
/// The data addresses first..behind-1 that the stack has held at its deepest.
struct StackUse {
    std::uint32_t first = 0, behind = 0;
    /// Bytes to spare: a dsPIC's up to SPLIM, an AVR's down to the end of the variables; nothing: no such
    /// limit is known.
    std::optional<std::uint32_t> left;
    Variables::Overlap over;  ///< with variables
};
/// Nothing: no call was made.
std::optional<StackUse> stack_use(const Profile& profile, const Variables& variables, const DebugChip& chip);
/// "the stack has grown over 4 bytes of variables (levels, ticks)", or empty.
std::string overlap_text(const StackUse& use);
/// The same of a profile; empty, too, where no call was made.
std::string stack_warning(const Profile& profile, const Variables& variables, const DebugChip& chip);
/// For a person: functions by cost, stack, reads of RAM that nothing had written.
std::string profile_text(const Profile& profile, const Places& places, const Variables& variables,
                         const DebugChip& chip);
/// The same for programs, as a JSON object; of the reads at most 1000 places.
std::string profile_json(const Profile& profile, const Places& places, const Variables& variables,
                         const DebugChip& chip);

}  // namespace puckloop::debug
