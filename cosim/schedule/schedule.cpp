#include "cosim/schedule/schedule.h"

#include <algorithm>

namespace puckloop::cosim {

namespace {
// To run ahead at least and at most: what is wrong is executed again from the mark on, so that a surprise
// every few milliseconds (a program that polls a board) costs a stretch each.
constexpr Time kShortestAhead = 40 * kMicrosecond;
constexpr Time kLongestAhead = kMillisecond;
constexpr Time kTogether = 250 * kMicrosecond;
// Where so much is sure anyway, nothing is to be won by running ahead.
constexpr Time kLongEnough = 200 * kMicrosecond;
// A stretch that was right makes the next one longer by this part: it stays a fraction of the time since the
// last surprise.
constexpr Time kGrowth = 3;
// One that takes turns on a bus goes on from its mark for so long, beyond what is sure.
constexpr Time kTurns = 400 * kMicrosecond;
// Stretches without surprise after which a node no longer waits for the one that caused the last.
constexpr int kLongStreak = 16;
}  // namespace

Schedule::Stretch::Stretch() : length(kLongestAhead) {}

void Schedule::surprised(std::size_t from, std::size_t to) {
    if (to >= stretches_.size()) return;
    stretches_[to].waits_for = from;
    stretches_[to].streak = 0;
}

/// Limit of node `n`, which its own messages set, as if it were silent: it will go in strides.
Time Schedule::limit_if_silent(std::size_t n) {
    alone_.compute(*channels_, *pending_, n);
    return alone_.limit(n);
}

/// When something may happen at each node next, if nothing new comes in. Of a node that cannot go back only
/// what others see of it counts: what it has received, and answers later or not at all, can wait.
void Schedule::find_next(const std::vector<NodeTimes>& nodes, Time end) {
    next_.resize(nodes.size());
    for (std::size_t n = 0; n < nodes.size(); ++n)
        next_[n] = nodes[n].runs_ahead ? (*pending_)[n] : kNever;
    expected_.assign(nodes.size(), kNever);
    due_.assign(nodes.size(), kNever);
    for (const Channel& channel : *channels_) {
        Time& next = next_[channel.from];
        next = std::min(next, channel.base);
        if (!nodes[channel.from].runs_ahead) next = std::min(next, channel.answer((*pending_)[channel.from]));
        if (channel.lookahead >= kLongEnough && channel.lookahead != kNever && channel.base != kNever)
            due_[channel.from] = std::min(due_[channel.from], channel.base - channel.lookahead + 1);
        if (channel.punctual > 0) expected_[channel.to] = std::min(expected_[channel.to], channel.base);
    }
    // How far the first one may go: whatever happens within that time happens beside it.
    std::size_t first = kNobody;
    for (std::size_t n = 0; n < nodes.size(); ++n)
        if (nodes[n].granted < end && (first == kNobody || next_[n] < next_[first])) first = n;
    if (first != kNobody) round_ = std::max(next_[first], bounds_.limit(first));
}

void Schedule::plan(const std::vector<Channel>& channels, const std::vector<Time>& pending,
                    const std::vector<NodeTimes>& nodes, const ScheduleLimits& limits) {
    channels_ = &channels;
    pending_ = &pending;
    bounds_.compute(channels, pending);
    find_next(nodes, limits.end);
    bus_turns_.update(channels, nodes.size());
    for (std::size_t group = 0; group < bus_turns_.count(); ++group)
        listen(group, nodes);
    const std::size_t count = nodes.size();
    reached_ = limits.end;
    for (const NodeTimes& node : nodes)
        reached_ = std::min(reached_, node.granted);
    complete_ = reached_ >= limits.end && std::all_of(nodes.begin(), nodes.end(), [&](const NodeTimes& node) {
                    return node.ahead <= std::max(limits.end, node.granted);
                });
    window_ = later(reached_, limits.stop_latency);
    ceiling_ = std::min({window_, limits.end, limits.pace});

    target_.resize(count);
    ahead_.resize(count);
    stretches_.resize(count);
    for (std::size_t n = 0; n < count; ++n)
        target_[n] = ahead_[n] = std::min(bounds_.limit(n), ceiling_);
    any_ahead_ = std::any_of(nodes.begin(), nodes.end(), [](const auto& n) { return n.runs_ahead; });
    chosen_.clear();
    plan_ahead(nodes, limits);
    if (chosen_.empty())
        choose_plain(nodes, limits);
    else
        choose_due(nodes);
    const bool idle =
        chosen_.empty() && std::none_of(nodes.begin(), nodes.end(), [](const auto& n) { return n.busy; });
    if (idle && limits.pace > ceiling_) choose_any(nodes);
}

/// Long stretches end together, so that the nodes' next ones begin together: side by side on several threads.
Time Schedule::stretch_end(Time from, Time length) {
    const Time end = later(from, length);
    return length < 2 * kTogether ? end : end - end % kTogether;
}

void Schedule::listen(std::size_t group, const std::vector<NodeTimes>& nodes) {
    next_unexecuted_.resize(nodes.size());
    for (const std::size_t n : bus_turns_.nodes(group))
        next_unexecuted_[n] = nodes[n].heard;
    bus_turns_.compute(group, *channels_, next_unexecuted_);
}

/// How far node `n` may well go for its bus: what it hears or sends itself there it does, be it answered at
/// the same time.
Time Schedule::turn_end(std::size_t n) const {
    if (bus_turns_.group_of(n) == kNobody) return kNever;
    const Time limit = bus_turns_.limit(n), first = std::min(next_unexecuted_[n], bus_turns_.next_send(n));
    return first == limit ? later(first, 1) : limit;
}

/// How far node `n` may well run ahead from there on.
Time Schedule::worth_going(std::size_t n, Time from) const {
    return std::min({ceiling_, expected_[n], stretch_end(from, stretches_[n].length), turn_end(n)});
}

/// Whether node `n`, which nothing took by surprise, goes on because something is to be said or heard on its
/// bus, although nothing more is sure.
bool Schedule::takes_turn(std::size_t n, const NodeTimes& node) {
    if (bus_turns_.group_of(n) == kNobody) return false;
    const Time reach =
        std::min({ceiling_, expected_[n], node.horizon, later(node.granted, kTurns), turn_end(n)});
    if (std::min(node.heard, bus_turns_.next_send(n)) >= reach || reach <= node.ahead) return false;
    target_[n] = node.granted;
    ahead_[n] = reach;
    return true;
}

/// Whether node `n`, which can go back, has something to do, and how far it is to go.
bool Schedule::aims_ahead(std::size_t n, const NodeTimes& node, const ScheduleLimits& limits) {
    const Time end = limits.end;
    const Time sure = std::max(target_[n], node.granted);
    if (node.ahead > end) {  // the end came nearer
        target_[n] = ahead_[n] = std::min(sure, end);
        return true;
    }
    const Time from = std::min(node.surprise, node.ahead);
    const Time reach = worth_going(n, from);
    if (node.surprise < node.ahead) {
        target_[n] = std::max(node.granted, std::min(sure, std::max(reach, from)));
        ahead_[n] = std::max(target_[n], reach);
        return ahead_[n] > from;
    }
    if (sure < node.ahead) return takes_turn(n, node);  // else the mark would stay behind for nothing
    target_[n] = std::max(node.ahead, std::min(sure, ceiling_));
    ahead_[n] = target_[n];
    if (target_[n] - node.ahead < kLongEnough)
        ahead_[n] = std::max(target_[n], std::min(reach, node.horizon));
    if (node.granted < node.ahead && (node.ahead == end || node.granted == reached_)) return true;
    // One that would only wait, and is known to, need not: it limits nobody.
    const bool serves = next_[n] < ahead_[n] || target_[n] >= end ||
                        target_[n] - node.granted >= limits.stop_latency / kStretchDivisor;
    return serves && ahead_[n] > node.ahead;
}

/// Nodes that can go back and have something to do, but for those that wait for another one of them.
void Schedule::plan_ahead(const std::vector<NodeTimes>& nodes, const ScheduleLimits& limits) {
    goes_.assign(nodes.size(), false);
    for (std::size_t n = 0; n < nodes.size(); ++n)
        goes_[n] = nodes[n].runs_ahead && !nodes[n].busy && aims_ahead(n, nodes[n], limits);
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        if (!goes_[n]) continue;
        Stretch& stretch = stretches_[n];
        // Of several that wait for each other in a circle the last one goes.
        goes_[n] = stretch.waits_for == kNobody || !goes_[stretch.waits_for];
        if (!goes_[n]) continue;
        chosen_.push_back(n);
        if (nodes[n].surprise < nodes[n].ahead) {
            stretch.length = kShortestAhead;
            continue;
        }
        stretch.length = std::clamp(stretch.length + stretch.length / kGrowth, kShortestAhead, kLongestAhead);
        if (++stretch.streak >= kLongStreak) stretch.waits_for = kNobody;
    }
}

bool Schedule::follow(std::size_t n, const std::vector<NodeTimes>& nodes) {
    const NodeTimes& node = nodes[n];
    if (node.surprise >= node.ahead) return takes_turn(n, node);
    Stretch& stretch = stretches_[n];
    const std::size_t first = stretch.waits_for;
    if (first != kNobody && (nodes[first].busy || nodes[first].surprise < nodes[first].ahead)) return false;
    const Time reach = worth_going(n, node.surprise);
    if (reach <= node.surprise) return false;
    target_[n] = node.granted;
    ahead_[n] = reach;
    stretch.length = kShortestAhead;
    return true;
}

/// Whether node `n`, which cannot go back and answers late, may go as far as it takes for it to say what
/// comes next: the world's step. Others then need not wait for it when they have come there.
bool Schedule::is_due(std::size_t n, const NodeTimes& node) const {
    return !node.runs_ahead && !node.busy && node.granted < due_[n] && due_[n] <= target_[n];
}

/// Such nodes, to work beside those that run ahead.
void Schedule::choose_due(const std::vector<NodeTimes>& nodes) {
    for (std::size_t n = 0; n < nodes.size(); ++n)
        if (is_due(n, nodes[n])) chosen_.push_back(n);
}

/// Nodes that cannot go back, as far as that serves.
void Schedule::choose_plain(const std::vector<NodeTimes>& nodes, const ScheduleLimits& limits) {
    bool last_holds_up = false;
    for (std::size_t n = 0; n < nodes.size(); ++n)
        last_holds_up = last_holds_up || (nodes[n].granted < limits.end && bounds_.limit(n) > window_);
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        if (nodes[n].runs_ahead || nodes[n].busy || target_[n] <= nodes[n].granted) continue;
        if (next_[n] <= round_ || is_due(n, nodes[n]) || target_[n] == limits.end ||
            (last_holds_up && nodes[n].granted == reached_) ||
            target_[n] - nodes[n].granted >= limits.stop_latency / kStretchDivisor)
            chosen_.push_back(n);
    }
    if (chosen_.empty() && std::none_of(nodes.begin(), nodes.end(), [](const auto& n) { return n.busy; }))
        for (std::size_t n = 0; n < nodes.size(); ++n)
            if (!nodes[n].runs_ahead && target_[n] > nodes[n].granted) chosen_.push_back(n);
    for (const std::size_t n : chosen_) {
        // Beyond what is foreseen for others its echo would come earlier than their lookaheads say.
        if (!any_ahead_ && bounds_.root(n) == n) target_[n] = std::min(limit_if_silent(n), ceiling_);
        ahead_[n] = target_[n];
    }
}

/// Nobody has something to do, or may. What nodes claim that have run ahead may be less than what they could
/// claim otherwise: they go back to what is sure, until that is further.
void Schedule::choose_any(const std::vector<NodeTimes>& nodes) {
    for (const bool back : {false, true}) {
        for (std::size_t n = 0; n < nodes.size(); ++n) {
            const NodeTimes& node = nodes[n];
            if (!node.runs_ahead) continue;
            target_[n] = std::max(node.granted, std::min(bounds_.limit(n), ceiling_));
            ahead_[n] = back ? target_[n] : std::max(target_[n], node.ahead);
            if (back ? node.ahead == node.granted : target_[n] == node.granted) continue;
            stretches_[n].length = back ? 0 : kShortestAhead;
            chosen_.push_back(n);
        }
        if (!chosen_.empty()) return;
    }
}

}  // namespace puckloop::cosim
