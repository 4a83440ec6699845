#pragma once
// `run --control`: a client starts, steps, reads, changes and ends the run (docs/control_protocol.md).
//
// The run stands still where every node is at exactly the same simulated time, and all that came before is in
// the trace. So what a client does at a simulated time is done at that time in any placement and on any
// machine.
//
// It can go back, and take a fault that begins later: it is then given up (cosim::Reverted) and begun again
// from a snapshot, on the same line to the client. What the client did until then is done again: what it
// wrote to boards while the run stands still, commands to the world as events of it, for the world is
// executed from its beginning. What it types into serial lines is a fault of its own kind, `type`, what it
// flashes into boards one of the kind `flash`: going back takes both away.

#include "base/json.h"
#include "cosim/conductor.h"
#include "cosim/resume/run_snapshot.h"
#include "cosim/trace/trace_csv.h"
#include "run/description/run_request.h"
#include "run/description/run_setup.h"
#include "run/driven/board_access.h"
#include "run/driven/client_line.h"
#include "run/driven/frame_watch.h"
#include "run/driven/kept_images.h"
#include "run/driven/world_commands.h"
#include "run/expectations/line_watch.h"
#include "run/past/run_history.h"

#include <csignal>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace puckloop::tools {

/// Before the run: boards are in the run's own process, on its thread, begin at power-up, and the world takes
/// commands, at the socket that `setup` has or else at a new one. Throws InputError for options of `request`
/// that do not go with a client.
void let_client_drive(RunSetup& setup, const RunRequest& request);

class DrivenRun {
  public:
    static constexpr int kProtocol = 1;
    /// Rises when requests are added; those that were there stay as they are.
    static constexpr int kRevision = 4;

    /// Plans the run of a request (run/setup.h).
    using Planner = std::function<RunSetup(const RunRequest&)>;

    /// Listens beside the world's socket (`setup.control`), whose folder exists. Throws RunError.
    DrivenRun(const RunSetup& setup, const RunRequest& request, Planner planner,
              const volatile std::sig_atomic_t* interrupted);

    /// As run/factory/node_factory.h, with boards that the client reaches.
    std::unique_ptr<cosim::Node> make_node(const std::string& json);
    /// The conductor stands still at the beginning, and then where the client wants.
    void drive(cosim::RunOptions& options, RunWritten written);
    /// After EndReason::Reverted: from where the run is to begin again; null: from power-up.
    const cosim::RunSnapshot* begin_again();
    /// How much of what was written stays; null: the run begins where it began first.
    const RunHistory::Place* kept() const { return kept_ ? &*kept_ : nullptr; }
    /// The run as it is now: with what the client did, once it was begun again.
    const RunSetup& setup() const { return setup_; }
    cosim::TraceSink& sink() { return frames_; }
    /// The run is over: the client, if it waits, hears how.
    void over(cosim::Outcome& outcome);

  private:
    /// What a step waits for.
    struct Step {
        nlohmann::json id;
        cosim::Time until = 0;     ///< where it ends in any case
        cosim::Time every = 0;     ///< how often its condition is looked at; 0: it has none
        nlohmann::json condition;  ///< null: none
        /// Of a step by instructions: the board, and how many it will then have executed.
        DrivenNode* board = nullptr;
        std::uint64_t instructions = 0;
        cosim::Time looked = 0;  ///< its instructions that begin until then have been waited for
    };

    /// What the client did at a board or to the world.
    struct Deed {
        cosim::Time time = 0;    ///< the run stood still there
        nlohmann::json write{};  ///< the request; null: a command
        std::string command{};   ///< to the world
        bool refused = false;    ///< by the world
    };
    /// Where a run that was begun again is to stand.
    struct Return {
        std::size_t instant = 0;  ///< of history_, to begin from
        cosim::Time to = 0;
        nlohmann::json id;  ///< of the request
    };
    /// What the client typed into a serial line, or flashed into a board.
    struct Typed {
        cosim::Time time = 0;        ///< the run stood still there
        cosim::Time end = 0;         ///< of its last byte
        std::string link{}, from{};  ///< empty: it was flashed
        std::string fault{};         ///< among those of the request
    };
    using TakeSnapshot = std::function<cosim::RunSnapshot()>;

    void stand(const TakeSnapshot& take);
    /// Into history_.
    void remember(const TakeSnapshot& take);
    /// The board of which a register is still to be written, null: none.
    const std::string* waiting_change() const;
    /// Throws InputError for it, naming `op`.
    void refuse_waiting_change(const char* op) const;
    /// False: not yet where a run that was begun again is to stand.
    bool returned();
    /// The step's condition holds now.
    bool met();
    /// When it is looked at next, after now.
    cosim::Time next_look();
    /// Answers requests until one lets the run go on.
    void serve(const TakeSnapshot& take);
    nlohmann::ordered_json answer(const nlohmann::json& request, const TakeSnapshot& take, bool& go_on);
    void count_interrupts(const nlohmann::json& request);
    void begin_step(const nlohmann::json& request);
    void begin_instructions(const nlohmann::json& request, Step& step);
    void save(const nlohmann::json& request, const TakeSnapshot& take);
    /// Both return only by exceptions: Reverted, or InputError for what cannot be.
    [[noreturn]] void go_back(const nlohmann::json& request);
    [[noreturn]] void add_fault(const nlohmann::json& request, const TakeSnapshot& take);
    [[noreturn]] void type(const nlohmann::json& request, const TakeSnapshot& take);
    [[noreturn]] void flash(const nlohmann::json& request, const TakeSnapshot& take);
    /// The image that `board` has now: the one of its description, or the last that was flashed.
    std::string image_of(const std::string& board) const;
    /// Begins the run again here, with the faults of `with`. `accepted`: called once they are.
    [[noreturn]] void go_on_with(RunRequest with, const nlohmann::json& id, const TakeSnapshot& take,
                                 const std::function<void()>& accepted = {});
    void check_boards(const RunSetup& next) const;
    /// With its images as they were when the run first used them.
    NodeDescription with_images(NodeDescription board) const;
    /// All faults that are not the scenario's, into events.toml.
    void record_faults() const;
    /// The plan of `request`, with the client, and what it did to the world before `time`.
    RunSetup planned(const RunRequest& request) const;
    void add_events(RunSetup& setup, cosim::Time time) const;
    void end(const std::string& reason, bool success);
    BoardAccess& board(const nlohmann::json& request);
    nlohmann::ordered_json greeting() const;
    nlohmann::ordered_json reply(const nlohmann::json& id) const;
    bool compare(const nlohmann::json& condition);

    RunSetup setup_;
    RunRequest request_;
    Planner planner_;
    ClientLine line_;
    WorldCommands world_;
    FrameWatch frames_;
    std::map<std::string, std::unique_ptr<BoardAccess>> boards_;
    KeptImages images_;
    std::set<std::string> counted_;  ///< boards whose interrupts are
    std::string origin_;
    std::string no_way_back_;  ///< why; empty: there is one
    std::optional<RunWritten> written_;
    cosim::Time now_ = 0;
    std::optional<cosim::Time> next_;  ///< where the run stands still next; nothing: nowhere
    bool begun_ = false, ended_ = false, begins_again_ = false;
    std::optional<Step> step_;
    RunHistory history_;
    cosim::Time remember_at_ = cosim::kNever;  ///< the next snapshot into it
    std::vector<Deed> deeds_;                  ///< in their order
    std::vector<Typed> typed_;                 ///< in their order
    std::size_t answered_ = 0;  ///< of deeds_, the first of which the world has not said anything
    std::optional<Return> return_;
    std::optional<RunHistory::Place> kept_;
    std::shared_ptr<const cosim::RunSnapshot> from_;
};

}  // namespace puckloop::tools
