#pragma once
// How far each node may be granted: conservative look-ahead by relaxation over the graph of links.
//
// For every directed channel c (one direction of a link) from node f to node t
//     bound(c)   = min(base(c), earliest(f) + lookahead(c))
//     limit(t)   = min of bound(c) over the channels into t
//     earliest(t)= min(pending(t), limit(t))
// where base is the sender's EOT and lookahead its shortest answer, both with the link's own flight time
// added, and pending(t) is the first message already known that t has not handled.
//
// A node that runs ahead (cosim/schedule/run_ahead.h) has handled what is foreseen up to some time; pending
// is then the first message that it did not foresee. Its channels hold the messages that it is going to send
// if nothing else comes in. Its EOT lies beyond them; what comes in at t may change those stamped t or
// later, so that bound(c) is no later than the delivery of the first one stamped earliest(f) or later. The
// answer is the greatest solution, which is a shortest path from the EOTs and pending messages: chains of
// zero lookaheads of any length come out right.

#include "cosim/core/time.h"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace puckloop::cosim {

inline constexpr std::size_t kNobody = static_cast<std::size_t>(-1);

/// A message that is going to be sent unless something comes in for its sender by its stamp.
struct Foreseen {
    Time stamp = 0;
    Time delivery = 0;
};

struct Channel {
    std::size_t from = 0;
    std::size_t to = 0;
    Time base = 0;
    Time lookahead = 0;
    std::vector<Foreseen> foreseen{};  ///< in order
    bool instant =
        true;  ///< the sender may answer, or take back, at the very time at which something comes in
    bool takes_turns = false;  ///< of an I2C bus, and something has come by it
    /// How surely a message comes when the EOT falls due, by what happened before: from 0, never.
    int punctual = 0;

    /// The earliest delivery of what the sender may change or send when something comes in for it at `time`.
    Time answer(Time time) const {
        const Time caused = later(time, lookahead);
        return foreseen.empty() ? caused : std::min(caused, first_change(time));
    }
    /// Delivery of the first foreseen message that what comes in at `time` may change, or kNever.
    Time first_change(Time time) const;
    /// Whether what comes in at `time` may change what is foreseen with this stamp.
    bool may_change(Time stamp, Time time) const { return instant ? stamp >= time : stamp > time; }
};

/// Bounds of one instant of the run; kept between calls only to save allocations.
class Bounds {
  public:
    /// `pending[n]` is kNever where nothing is known. What node `silent` sends, if one is given, is left out.
    /// Both lists must stay as they are while this object is asked.
    void compute(const std::vector<Channel>& channels, const std::vector<Time>& pending,
                 std::size_t silent = kNobody);

    /// Nothing not yet known can reach node `n` before this.
    Time limit(std::size_t n) const { return limit_[n]; }
    /// Nothing that node `n` has not handled comes in before: what it sends stamped earlier is final.
    Time earliest(std::size_t n) const { return earliest_[n]; }
    /// No message still to come on any channel is delivered before this.
    Time floor() const { return floor_; }
    /// The node that must go on for limit(n) to grow: the one whose EOT, or whose message not yet
    /// handled, sets it; kNobody when nothing limits n.
    std::size_t root(std::size_t n) const;
    /// The sender of the channel that sets limit(n), or kNobody.
    std::size_t limiter(std::size_t n) const;

  private:
    void build_adjacency(std::size_t nodes);
    void relax();

    const std::vector<Channel>* channels_ = nullptr;
    const std::vector<Time>* pending_ = nullptr;
    std::size_t silent_ = kNobody;
    std::vector<Time> earliest_;
    std::vector<Time> limit_;
    std::vector<std::size_t> critical_;  ///< index of the channel that sets limit_
    Time floor_ = kNever;
    std::vector<std::vector<std::size_t>> leaving_;          ///< channels, by their sender
    std::vector<std::pair<std::size_t, std::size_t>> ends_;  ///< of the channels that leaving_ was made for
    std::vector<std::size_t> order_;
    std::vector<Time> last_relaxed_;  ///< what the channels that leave a node were relaxed with
    std::vector<Time> answers_;       ///< of each channel to that
};

/// Puts nodes in the order of `times`, which is much the same each time.
template <class Node>
void sort_again(std::vector<Node>& order, const std::vector<Time>& times) {
    for (std::size_t i = 1; i < order.size(); ++i) {
        const Node n = order[i];
        std::size_t place = i;
        for (; place > 0 && times[order[place - 1]] > times[n]; --place)
            order[place] = order[place - 1];
        order[place] = n;
    }
}

/// For each node the shortest time from a message that reaches it to one, caused by it, that reaches
/// `target`; 0 for the target itself, kNever where there is no way.
std::vector<Time> distances_to(std::size_t target, const std::vector<Channel>& channels, std::size_t nodes);

}  // namespace puckloop::cosim
