#pragma once
// Where a debugged program stops: breakpoints, watchpoints, single steps. It decides how the chip runs: with
// plain stop addresses at full speed, or with an instrument where every instruction counts.

#include "debug/debug_chip.h"

#include <cstdint>
#include <optional>
#include <set>
#include <vector>

namespace puckloop::debug {

enum class WatchKind : std::uint8_t { Write, Read, Access };

struct Watchpoint {
    std::uint16_t start = 0;  ///< data address
    std::uint32_t bytes = 1;
    WatchKind kind = WatchKind::Write;

    friend bool operator==(const Watchpoint&, const Watchpoint&) = default;
};

/// Bits of data space, a register's flag say, whoever changes them: the program stops before the instruction
/// after the change.
struct BitWatch {
    std::uint16_t start = 0;                ///< data address
    std::uint32_t bytes = 1;                ///< at most 4
    std::uint32_t mask = 0;                 ///< of these, the lowest byte first
    std::optional<std::uint32_t> wanted{};  ///< stops only when they become this, as masked

    friend bool operator==(const BitWatch&, const BitWatch&) = default;
};

/// Why the program stands still.
struct Stop {
    enum class Why : std::uint8_t {
        Step,
        Break,
        Watch,
        Bits,       ///< of a BitWatch
        Interrupt,  ///< the debugger asked for it
        Begin,      ///< going back ended at the first moment there is
        End         ///< the run is over
    };
    Why why = Why::Step;
    Watchpoint watch{};         ///< of Why::Watch
    std::uint16_t touched = 0;  ///< data address, of Why::Watch
    BitWatch bits{};            ///< of Why::Bits
};

class StopControl : private chip::Instrument {
  public:
    explicit StopControl(DebugChip& chip) : chip_(&chip) {}
    /// Of a chip that is named later.
    StopControl() = default;

    /// Another chip from here on, or the same again made anew; break- and watchpoints stay.
    void set_chip(DebugChip& chip) { chip_ = &chip; }

    void add_break(std::uint32_t pc) { breaks_.insert(pc); }
    void remove_break(std::uint32_t pc) { breaks_.erase(pc); }
    /// Reaching `pc` is the end of the run, whatever a debugger wants.
    void add_end(std::uint32_t pc) { ends_.insert(pc); }
    void add_watch(const Watchpoint& watch) { watches_.push_back(watch); }
    void remove_watch(const Watchpoint& watch);
    void add_bits(const BitWatch& bits) { bits_.push_back({bits, 0}); }
    void remove_bits(const BitWatch& bits);
    /// No breakpoint, no watchpoint; ends stay.
    void clear();

    /// The chip goes on from here, one instruction (or one entry of an interrupt) if `step`.
    void begin(bool step);
    /// The chip goes on towards `position`, noting the last place before it where it would have stopped:
    /// each instruction if `steps`, else break- and watchpoints.
    void begin_search(bool steps, std::uint64_t position);
    /// The chip goes on and stops before the first instruction that starts at `position` or later.
    void begin_seek(std::uint64_t position);
    /// As begin() for whoever is the chip's instrument himself and asks instrument(); `inside`: from within
    /// instrument().instruction(), whose instruction is executed next.
    void begin_inside(bool step, bool inside);
    /// Likewise begin_search() and begin_seek().
    void search_inside(bool steps, std::uint64_t position);
    void seek_inside(std::uint64_t position);
    chip::Instrument& instrument() { return *this; }
    /// Why instrument().instruction() said no.
    const std::optional<Stop>& stopped() const { return stop_; }
    /// Accesses of the debugger's own count for nothing until the chip goes on.
    void pause() { mode_ = Mode::Idle; }
    /// The chip stands: why it does, if it stopped by itself.
    std::optional<Stop> end();

    struct Found {
        std::uint64_t position = 0;  ///< cycle at which the instruction starts
        Stop stop;
    };
    /// What begin_search() found.
    const std::optional<Found>& found() const { return found_; }

  private:
    enum class Mode : std::uint8_t { Idle, Run, Search, Seek };

    bool instruction(std::uint32_t pc, std::uint64_t cycle) override;
    void access(std::uint16_t address, int bytes, bool write) override;
    bool run_on(std::uint32_t pc);
    void note_bits();
    /// The first of bits_ that has changed since; all are noted.
    const BitWatch* changed_bits();

    DebugChip* chip_ = nullptr;
    std::set<std::uint32_t> breaks_, ends_;
    std::vector<Watchpoint> watches_;
    struct NotedBits {
        BitWatch watch;
        std::uint32_t value = 0;
    };
    std::vector<NotedBits> bits_;

    Mode mode_ = Mode::Idle;
    bool step_ = false;
    std::uint32_t first_pc_ = 0;  ///< of a search: the instruction before
    bool first_ = false;          ///< no instruction was begun yet
    bool begun_ = false;          ///< the first one was
    std::uint64_t position_ = 0;
    std::uint64_t current_ = 0;  ///< where the present instruction starts
    std::optional<Stop> stop_;
    std::optional<Found> found_;
};

}  // namespace puckloop::debug
