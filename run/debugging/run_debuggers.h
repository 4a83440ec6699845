#pragma once
// All debuggers of a run, and the run's way back.
//
// They and their boards live in the conductor's process. While one board stands still all debuggers are
// answered. To go back, the run is given up (cosim::Reverted) and begun again from an earlier snapshot: once
// or a few times to find where the board was to stop, each time from twice as far back, and once more to stop
// there. Every node goes along, and what was written of the trace since is cut off.

#include "cosim/conductor.h"
#include "cosim/trace/trace_csv.h"
#include "run/debugging/board_debugger.h"
#include "run/description/run_request.h"
#include "run/description/run_setup.h"
#include "run/past/run_history.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::tools {

class RunDebuggers {
  public:
    /// One for each board of `setup` with a "gdb" place. `setup` must stay. Throws InputError: nobody can
    /// listen at one of them.
    RunDebuggers(const RunSetup& setup, const RunRequest& request,
                 const volatile std::sig_atomic_t* abort_requested);

    /// As run/factory/node_factory.h, with debuggers at their boards.
    std::unique_ptr<cosim::Node> make_node(const std::string& json);
    /// Has the conductor keep the run's past, if it can go back at all.
    void keep_past(cosim::RunOptions& options, RunWritten written);
    /// After EndReason::Reverted: from where the run is to begin again; null: from power-up.
    const cosim::RunSnapshot* begin_again();
    /// How much of what was written stays; nothing: the run begins where it began first.
    const RunHistory::Place* kept() const;

    // Of a board's debugger.
    void begin_history();
    void stand_still(BoardDebugger& who, const debug::Stop& stop, bool inside);
    /// Returns only if nothing lies before.
    void go_back(BoardDebugger& who, bool step);
    std::string no_way_back(const BoardDebugger& who) const;
    /// The run is on its way to an instant that has been: no debugger but one counts.
    bool repeats() const { return plan_.has_value(); }
    bool listens_to(const BoardDebugger& who) const { return !plan_ || plan_->who == who.index(); }
    /// The board's stops say that it is to stop, before an instruction.
    void stopped(BoardDebugger& who);
    /// The board has executed all that lies before `until`.
    void passed(BoardDebugger& who, cosim::Time until);

  private:
    struct Plan {
        std::size_t who = 0;
        bool step = false;
        std::size_t instant = 0;  ///< of history_, to begin from
        std::size_t next = 1;     ///< so many instants further back if nothing is found
        std::uint64_t limit = 0;  ///< BoardDebugger::position() before which a place to stop is looked for
        /// Once found: to stop before the instruction there.
        std::optional<std::uint64_t> position{};
        debug::Stop stop{};
    };
    [[noreturn]] void search_over(BoardDebugger& who);
    std::vector<RunHistory::Board> places() const;
    void wait() const;

    std::vector<std::unique_ptr<BoardDebugger>> boards_;
    std::shared_ptr<const cosim::RunSnapshot> origin_;
    const volatile std::sig_atomic_t* abort_requested_;
    std::string no_way_back_;  ///< why; empty: there is one
    RunHistory history_;
    std::optional<Plan> plan_;
    std::shared_ptr<const cosim::RunSnapshot> from_;  ///< the run goes on from
    std::optional<RunHistory::Place> kept_;
};

}  // namespace puckloop::tools
