#pragma once
// What a user reads while an experiment goes on: time per run, and an estimate of what is left.

#include "campaigns/experiment/experiment_run.h"

#include <chrono>
#include <map>
#include <string>
#include <vector>

namespace puckloop::swarm {

/// "45 s", "12 min", "3.4 h".
std::string duration_text(double seconds);

class Progress {
  public:
    /// `done`: results of earlier; `side_by_side`: how many runs go on at a time.
    Progress(const Experiment& experiment, const std::vector<Run>& runs, const std::map<int, RunResult>& done,
             int side_by_side);

    /// A line before the first run: how many, and how long they will take where earlier ones show it.
    std::string beginning() const;
    /// A line for each result.
    std::string take(int id, const RunResult& result);

    /// s of wall time for what is left, from the mean of the runs that are there; negative: none is there.
    double left() const;

  private:
    const Experiment& experiment_;
    std::map<int, Run> runs_;
    std::size_t done_ = 0;
    double wall_ = 0.0;  ///< s, of all that are done
    int side_by_side_;
};

}  // namespace puckloop::swarm
