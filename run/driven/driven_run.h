#pragma once
// `run --control`: a client starts, steps, reads, changes and ends the run (docs/control_protocol.md).
//
// The run stands still where the conductor takes a snapshot: there every node is at exactly the same
// simulated time, and all that came before is in the trace. So what a client does at a simulated time is done
// at that time in any placement and on any machine.

#include "cosim/conductor.h"
#include "cosim/resume/run_snapshot.h"
#include "cosim/trace/trace_csv.h"
#include "run/description/run_request.h"
#include "run/description/run_setup.h"
#include "run/driven/board_access.h"
#include "run/driven/client_line.h"
#include "run/driven/frame_watch.h"
#include "run/driven/world_commands.h"

#include <nlohmann/json.hpp>

#include <csignal>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::tools {

/// Before the run: boards are in the run's own process, on its thread, begin at power-up, and the world takes
/// commands. Throws InputError for options of `request` that do not go with a client.
void let_client_drive(RunSetup& setup, const RunRequest& request);

class DrivenRun {
  public:
    static constexpr int kProtocol = 1;

    /// Listens beside the world's socket (`setup.control`), whose folder exists. `setup` and `request` must
    /// outlive it. Throws RunError.
    DrivenRun(const RunSetup& setup, const RunRequest& request,
              const volatile std::sig_atomic_t* interrupted);

    /// As run/factory/node_factory.h, with boards that the client reaches.
    std::unique_ptr<cosim::Node> make_node(const std::string& json);
    /// The conductor stands still at the beginning, and then where the client wants. `trace` is what the run
    /// writes.
    void drive(cosim::RunOptions& options, std::optional<cosim::TraceCsvSink>& trace);
    cosim::TraceSink& sink() { return frames_; }
    /// The run is over: the client, if it waits, hears how.
    void over(const cosim::Outcome& outcome);

  private:
    /// What a step waits for.
    struct Step {
        nlohmann::json id;
        cosim::Time until = 0;     ///< where it ends in any case
        cosim::Time every = 0;     ///< how often its condition is looked at; 0: it has none
        nlohmann::json condition;  ///< null: none
    };

    void stand(cosim::RunSnapshot& snapshot);
    /// The step's condition holds now.
    bool met();
    /// Answers requests until one lets the run go on.
    void serve(cosim::RunSnapshot& snapshot);
    nlohmann::ordered_json answer(const nlohmann::json& request, cosim::RunSnapshot& snapshot, bool& go_on);
    void begin_step(const nlohmann::json& request);
    void save(const nlohmann::json& request, cosim::RunSnapshot& snapshot);
    void end(const std::string& reason, bool success);
    BoardAccess& board(const nlohmann::json& request);
    nlohmann::ordered_json greeting() const;
    nlohmann::ordered_json reply(const nlohmann::json& id) const;
    bool compare(const nlohmann::json& condition);

    const RunSetup& setup_;
    const RunRequest& request_;
    const volatile std::sig_atomic_t* interrupted_;
    ClientLine line_;
    WorldCommands world_;
    FrameWatch frames_;
    std::map<std::string, std::unique_ptr<BoardAccess>> boards_;
    std::string origin_;
    std::optional<cosim::TraceCsvSink>* trace_ = nullptr;
    cosim::Time now_ = 0;
    std::optional<cosim::Time> next_;  ///< where the run stands still next; nothing: nowhere
    bool begun_ = false, ended_ = false;
    std::optional<Step> step_;
};

}  // namespace puckloop::tools
