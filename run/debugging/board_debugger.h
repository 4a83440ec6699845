#pragma once
// The debugger at one board of a run: its connection, where the board is to stop, and what the debugger
// changed. It outlives the board, which is made anew whenever the run goes back.

#include "cosim/core/clock.h"
#include "cosim/core/stateful_node.h"
#include "debug/gdb/gdb_session.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::tools {

class RunDebuggers;

class BoardDebugger final : private debug::Debuggee, private chip::Instrument {
  public:
    /// Throws InputError: nobody can listen at `place`.
    BoardDebugger(RunDebuggers& run, std::size_t index, std::string name, const std::string& place);

    const std::string& name() const { return name_; }
    std::size_t index() const { return index_; }

    // Of the board (run/debugging/debugged_node.h).
    /// The board is there, or there again; `from`: so many changes were made to it.
    void set_board(cosim::Node& board);
    /// Before each advance, at its begin `now`, which is to fill `outbox`: the board's instrument, null while
    /// nobody looks.
    chip::Instrument* begin_advance(cosim::Time now, std::vector<cosim::Message>& outbox);
    void look_at(chip::Instrument* instrument) { chip_->set_instrument(instrument, true); }
    /// The next change at or before `until` that was made between two advances.
    std::optional<cosim::Time> next_change(cosim::Time until) const;
    /// Makes those that were made so at `now`.
    void repeat_changes(cosim::Time now);
    /// Everything before `until` was executed.
    void end_advance(cosim::Time until);
    /// The end of the board's last advance.
    cosim::Time granted() const { return granted_(); }
    /// Where the board stood when its debugger killed the run.
    std::optional<cosim::Time> killed_at() const { return killed_at_; }
    void on_exit(int status) { session_.on_exit(status); }

    // Of all debuggers of the run (run/debugging/run_debuggers.h).
    /// The board stands still until its debugger lets it go on. `inside`: before an instruction, which is
    /// executed then.
    void on_stop(const debug::Stop& stop, bool inside);
    bool stands() const { return stands_; }
    /// While the run stands still: answers what has come, takes a debugger that comes. False: there was
    /// nothing.
    bool poll();
    int descriptor() const { return socket_.descriptor(); }
    /// Whatever its debugger wants.
    void let_go() { stands_ = false; }
    std::uint64_t cycle() const { return chip_->cycle(); }
    /// Twice the cycle at which the next instruction starts, and one more behind a reset that was pressed
    /// then: what stops() counts by.
    std::uint64_t position() const;
    std::size_t changes_made() const { return made_; }
    cosim::Time time_of(std::uint64_t cycle) const { return clock_->time_of(cycle); }
    debug::StopControl& stops() { return control_; }
    /// The run goes back, to where so many changes had been made.
    void go_back(std::size_t changes);
    /// The run repeats what was before.
    void remember_present() { present_ = std::max(present_, position()); }

  private:
    struct Change {
        bool inside = false;
        bool reset = false;
        std::uint64_t cycle = 0;  ///< of the instruction before which it was made, if inside
        cosim::Time time = 0;     ///< else
        std::function<void()> make;
    };

    debug::DebugChip& chip() override { return *chip_; }
    debug::StopControl& control() override { return control_; }
    bool reverses() const override { return true; }
    std::string no_way_back() const override;
    std::string frozen() const override;
    bool change(std::function<bool(debug::DebugChip&)> change) override;
    /// Where the board is: at the present instruction, or behind all that it has executed.
    void press_reset() override;
    double seconds() const override { return cosim::to_seconds(clock_->time_of(chip_->cycle())); }
    std::string summary() override;
    const Change* next_inside(std::uint64_t cycle) const;
    void repeat_change();
    void reset_board();

    bool instruction(std::uint32_t pc, std::uint64_t cycle) override;
    void access(std::uint16_t address, int bytes, bool write) override {
        if (!changing_) control_.instrument().access(address, bytes, write);
    }
    void resume(debug::Resume how);

    RunDebuggers& run_;
    std::size_t index_;
    std::string name_;
    const cosim::ClockDomain* clock_ = nullptr;
    std::function<cosim::Time()> granted_;
    std::function<void(std::vector<cosim::Message>&)> press_reset_;
    std::vector<cosim::Message>* outbox_ = nullptr;  ///< of the advance under way; null: there is none
    std::unique_ptr<debug::DebugChip> chip_;
    debug::StopControl control_;
    debug::GdbSocket socket_;
    debug::GdbSession session_;
    bool met_ = false;  ///< a debugger was here
    bool stands_ = false, inside_ = false;
    std::optional<cosim::Time> killed_at_;
    bool reset_ = false;          ///< pressed between two advances: the next one begins with it
    bool reset_pending_ = false;  ///< pressed at the present instruction, which is not executed any more
    std::uint64_t begun_at_ = 0;  ///< the present instruction
    bool behind_ = false;         ///< it is the first one after a reset at this very cycle
    bool changing_ = false;       ///< repeats a change of the debugger's: no access of the program's
    unsigned looked_ = 0;
    cosim::Time now_ = 0;        ///< where the advance under way began
    std::uint64_t present_ = 0;  ///< position(): what lies before has been
    std::vector<Change> changes_;
    std::size_t made_ = 0;  ///< so many of them, where the board is now
};

}  // namespace puckloop::tools
