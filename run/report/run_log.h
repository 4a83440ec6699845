#pragma once
// What a run writes in the host's log (base/logs/log.h): what was started where, how fast it goes, why it
// ended, and how long each phase took.

#include "cosim/conductor.h"
#include "run/description/run_request.h"
#include "run/description/run_setup.h"

#include <chrono>

namespace puckloop::tools {

class RunLog {
  public:
    /// The phase that begins is the start of the nodes.
    RunLog(const RunSetup& setup, const RunRequest& request);
    void started(const cosim::Conductor& conductor);
    void progress(const cosim::Progress& now);  ///< said once a wall second (debug)
    void ended(const cosim::Outcome& outcome);
    void written();

  private:
    using Clock = std::chrono::steady_clock;
    double phase_seconds();

    const RunSetup& setup_;
    Clock::time_point phase_ = Clock::now();
    double said_wall_s_ = 0.0;
};

}  // namespace puckloop::tools
