#pragma once
// Which nodes to grant now, and how far. Pure arithmetic over bounds and times: no node is touched here.

#include "cosim/core/time.h"
#include "cosim/schedule/bounds.h"

#include <cstddef>
#include <vector>

namespace puckloop::cosim {

/// What the schedule must know of a node.
struct NodeTimes {
    Time granted = 0;  ///< handled everything before
    bool busy = false;
};

struct ScheduleLimits {
    Time end = kNever;      ///< of the run
    Time pace = kNever;     ///< of the wall clock
    Time stop_latency = 0;  ///< no node runs further ahead of the last one
};

/// A grant costs a round trip to another process, so a node is granted only when that serves: when something
/// may happen there no later than the first node of all may go now, when it may go to the end, or when a good
/// stretch has become free for it to run beside the others. One that only the echo of its own messages limits
/// is granted as if it said nothing.
class Schedule {
  public:
    void plan(const std::vector<Channel>& channels, const std::vector<Time>& pending,
              const std::vector<NodeTimes>& nodes, const ScheduleLimits& limits);
    const Bounds& bounds() const { return bounds_; }

    /// How far node `n` may go, in strides where that is beyond bounds().limit(n): there only the echo of
    /// what it says itself limits it. At most its present time if it may not go.
    Time target(std::size_t n) const { return target_[n]; }
    const std::vector<std::size_t>& chosen() const { return chosen_; }
    /// Every node has reached the end.
    bool complete() const { return complete_; }
    /// Time every node has reached.
    Time reached() const { return reached_; }

  private:
    Time limit_if_silent(std::size_t n);
    void find_next(const std::vector<NodeTimes>& nodes, Time end);

    Bounds bounds_;
    Bounds alone_;
    const std::vector<Channel>* channels_ = nullptr;
    const std::vector<Time>* pending_ = nullptr;
    std::vector<Time> target_;
    std::vector<Time> next_;
    Time round_ = 0;
    std::vector<std::size_t> chosen_;
    bool complete_ = false;
    Time reached_ = 0;
};

}  // namespace puckloop::cosim
