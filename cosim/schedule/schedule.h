#pragma once
// Which nodes to grant now, and how far. Pure arithmetic over bounds and times: no node is touched here.

#include "cosim/core/time.h"
#include "cosim/schedule/bounds.h"
#include "cosim/schedule/bus_turns.h"

#include <cstddef>
#include <vector>

namespace puckloop::cosim {

/// What the schedule must know of a node.
struct NodeTimes {
    Time granted = 0;  ///< handled everything before
    bool busy = false;
    Time ahead = 0;           ///< executed so far on what was foreseen; >= granted
    Time surprise = kNever;   ///< from there on something else comes in than was foreseen, if before `ahead`
    bool runs_ahead = false;  ///< it can go back
    Time horizon = kNever;    ///< from here on not, as far as is known
    Time heard = kNever;      ///< the first message of its I2C bus from `ahead` or a surprise on
};

struct ScheduleLimits {
    Time end = kNever;      ///< of the run
    Time pace = kNever;     ///< of the wall clock
    Time stop_latency = 0;  ///< no node runs further ahead of the last one
};

/// Free stretch, as a part of the stop latency, for which a node nobody waits for is granted all the same.
inline constexpr Time kStretchDivisor = 2;

/// A node that can go back runs ahead on what is foreseen, by a stretch that begins short when something was
/// wrong and grows by a third each time that it was not. It does so at once, the others wait for it: what
/// they are to receive is then known. One that was taken by surprise waits for the one that did it. A
/// message that has come punctually is counted on, so that a node does not run beyond it.
///
/// For the others a grant costs a round trip to another process, so one is granted only when that serves:
/// when something may happen there no later than the first node of all may go now, when it may go to the end,
/// or when a good stretch has become free for it to run beside the others. One that only the echo of its own
/// messages limits is granted as if it said nothing.
class Schedule {
  public:
    void plan(const std::vector<Channel>& channels, const std::vector<Time>& pending,
              const std::vector<NodeTimes>& nodes, const ScheduleLimits& limits);
    const Bounds& bounds() const { return bounds_; }
    /// Between two plans: whether node `n`, taken by surprise, is to go again at once on what is foreseen, or
    /// one that takes turns on a bus is to go on; then target(n) and ahead(n) say how far. Nothing more is
    /// sure than before.
    bool follow(std::size_t n, const std::vector<NodeTimes>& nodes);
    /// Takes over what the nodes of a bus have said since the plan, and when each hears something next.
    void listen(std::size_t group, const std::vector<NodeTimes>& nodes);
    const BusTurns& bus_turns() const { return bus_turns_; }

    /// How far node `n` may go, in strides where that is beyond bounds().limit(n): there only the echo of
    /// what it sends itself limits it. At most its present time if it may not go.
    Time target(std::size_t n) const { return target_[n]; }
    /// How far it is to run ahead; target(n) if not at all.
    Time ahead(std::size_t n) const { return ahead_[n]; }
    /// What node `from` sends took node `to` by surprise.
    void surprised(std::size_t from, std::size_t to);
    const std::vector<std::size_t>& chosen() const { return chosen_; }
    /// Every node has reached the end.
    bool complete() const { return complete_; }
    /// Time every node has reached.
    Time reached() const { return reached_; }

  private:
    /// How a node that runs ahead fared.
    struct Stretch {
        Time length;
        std::size_t waits_for = kNobody;  ///< took it by surprise and so goes first
        int streak = 0;                   ///< stretches since a surprise
        Stretch();
    };

    static Time stretch_end(Time from, Time length);
    Time limit_if_silent(std::size_t n);
    void plan_ahead(const std::vector<NodeTimes>& nodes, const ScheduleLimits& limits);
    bool aims_ahead(std::size_t n, const NodeTimes& node, const ScheduleLimits& limits);
    bool takes_turn(std::size_t n, const NodeTimes& node);
    Time turn_end(std::size_t n) const;
    Time worth_going(std::size_t n, Time from) const;
    bool is_due(std::size_t n, const NodeTimes& node) const;
    void choose_due(const std::vector<NodeTimes>& nodes);
    void choose_plain(const std::vector<NodeTimes>& nodes, const ScheduleLimits& limits);
    void choose_any(const std::vector<NodeTimes>& nodes);
    void find_next(const std::vector<NodeTimes>& nodes, Time end);

    Bounds bounds_;
    Bounds alone_;
    BusTurns bus_turns_;
    std::vector<Time> next_unexecuted_;
    const std::vector<Channel>* channels_ = nullptr;
    const std::vector<Time>* pending_ = nullptr;
    std::vector<Time> target_;
    std::vector<Time> ahead_;
    std::vector<Stretch> stretches_;
    std::vector<Time> expected_;  ///< when a punctual message is due next
    std::vector<bool> goes_;
    Time window_ = 0, ceiling_ = 0;
    bool any_ahead_ = false;
    std::vector<Time> next_;
    std::vector<Time> due_;  ///< granted so far, a node with a long lookahead states what comes next
    Time round_ = 0;
    std::vector<std::size_t> chosen_;
    bool complete_ = false;
    Time reached_ = 0;
};

}  // namespace puckloop::cosim
