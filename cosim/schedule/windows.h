#pragma once
// Which nodes go next and how far, where nothing is foreseen and a grant is a plain call: all that another
// one may wait for, side by side, each as far as is sure. The same bounds as cosim/schedule/bounds.h, over
// flat arrays: they are found some hundred thousand times a simulated second.

#include "cosim/core/time.h"
#include "cosim/schedule/bounds.h"
#include "cosim/schedule/schedule.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace puckloop::cosim {

class Windows {
  public:
    struct Step {
        std::size_t node = 0;
        Time until = 0;
        Time known = kNever;     ///< what comes in by sampled channels, before this (SampledInputs)
        Time answered = kNever;  ///< what comes in by its turn's channel, if it has the turn, not before this
    };

    /// What SampledInputs states of a channel's ends.
    struct Sampling {
        bool sampled = false;      ///< by the receiver
        bool independent = false;  ///< of what the sender samples
        bool turns = false;        ///< ends at the receiver's turn_port()
    };

    /// Who can send to whom, and how; that stays so.
    void connect(const std::vector<Channel>& channels, const std::vector<Sampling>& sampling,
                 std::size_t nodes);
    /// What leaves node `n` has another EOT or lookahead.
    void update(std::size_t n, const std::vector<Channel>& channels);
    /// Node `n` came to where it has to look, before the end of its step.
    void note_look(std::size_t n, bool looks) { looks_[n] = looks; }
    /// It has the turn, or no more.
    void note_turn(std::size_t n, bool has) { turn_[n] = has; }
    /// `pending`: of each node, the first message that it has not handled, or kNever; `acting`: the first
    /// that does not come by a sampled channel.
    void plan(const std::vector<Time>& pending, const std::vector<Time>& acting,
              const std::vector<NodeTimes>& nodes, const ScheduleLimits& limits);

    /// Empty only where all wait for each other for good.
    const std::vector<Step>& chosen() const { return chosen_; }
    /// Every node has reached the end.
    bool complete() const { return complete_; }
    /// Time every node has reached.
    Time reached() const { return reached_; }
    /// Nothing not yet known can reach node `n` before this.
    Time limit(std::size_t n) const { return limit_[n]; }
    /// Nothing not yet known that it only looks at can reach node `n` before this.
    Time known(std::size_t n) const { return known_[n]; }
    /// And that it waits for only once it has sent something.
    Time answered(std::size_t n) const { return answered_[n]; }
    /// No message still to come on any channel is delivered before this.
    Time floor() const { return floor_; }

  private:
    struct Edge {
        std::uint32_t to = 0;
        Sampling sampling;
        std::uint32_t channel = 0;
        Time base = 0;
        Time lookahead = 0;
    };

    void find_earliest(const std::vector<Time>& pending, const std::vector<Time>& acting,
                       const std::vector<NodeTimes>& nodes);
    /// What comes in for the sender of `edge` that may make it send by that.
    Time cause(std::size_t n, const Edge& edge) const {
        return edge.sampling.independent ? acting_[n] : earliest_[n];
    }
    void find_limits();
    bool waits_to_look(std::size_t n, Time granted) const { return looks_[n] && known_[n] <= granted; }
    void choose(const std::vector<Time>& pending, const std::vector<NodeTimes>& nodes,
                const ScheduleLimits& limits);

    std::vector<Edge> edges_;              ///< by sender
    std::vector<std::size_t> first_;       ///< of each sender's edges; one more at the end
    std::vector<Time> base_, lookahead_;   ///< of each sender, the least of its edges'
    std::vector<Time> earliest_, acting_;  ///< something comes in; the same without sampled channels
    std::vector<Time> limit_, known_, answered_, next_;
    std::vector<bool> relaxed_;  ///< has been, with its present times
    std::vector<bool> looks_;    ///< waits where it has to look
    std::vector<bool> turn_;
    std::vector<std::uint32_t> order_;  ///< nodes by their earliest time, about
    std::vector<Step> chosen_;
    bool complete_ = false;
    Time reached_ = 0;
    Time floor_ = kNever;
};

}  // namespace puckloop::cosim
