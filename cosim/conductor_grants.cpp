// What a node is granted, and what becomes of its reply.

#include "base/error.h"
#include "cosim/conductor_state.h"

#include <fmt/format.h>

#include <algorithm>

namespace puckloop::cosim {

/// The first message that node `n` has neither handled nor foreseen as it is now.
void Conductor::State::find_unknown(std::size_t n) {
    NodeTimes& node = times_[n];
    Slot& slot = slots_[n];
    node.heard = node.surprise;
    slot.unknown = std::min(node.surprise, network_->first_foreseen(n, node.ahead, node.heard));
    for (const TraceRecord& record : slot.queue) {
        if (record.time < node.ahead) continue;
        slot.unknown = std::min(slot.unknown, record.time);
        if (network_->takes_turns(record)) node.heard = std::min(node.heard, record.time);
    }
    slot.stale = false;
}

/// With what comes in for node `n` before `until`, foreseen messages among it.
void Conductor::State::fill_inbox(std::size_t n, Time until) {
    Slot& slot = slots_[n];
    slot.inbox.clear();
    slot.taken.clear();
    if (times_[n].runs_ahead) {
        for (const TraceRecord& record : slot.queue)
            if (record.time < until) slot.taken.push_back(record);
        network_->foreseen(n, until, slot.taken);
        std::sort(slot.taken.begin(), slot.taken.end(),
                  [](const TraceRecord& a, const TraceRecord& b) { return after(b, a); });
    } else {
        slot.take_before(until, [&](const TraceRecord& record) { slot.taken.push_back(record); });
    }
    for (const TraceRecord& record : slot.taken)
        slot.inbox.push_back({record.time, network_->wire(record).to_port, record.payload});
}

void Conductor::State::grant(std::size_t n, Time until, Time ahead) {
    Slot& slot = slots_[n];
    if (slot.stale) find_unknown(n);  // faults may have acted since the plan
    // Where nothing differs after all it stays where it is: it must see all that is known up to there.
    fill_inbox(n, std::max(ahead, times_[n].ahead));
    slot.asked = until;
    slot.asked_ahead = ahead;
    slot.span = ahead - std::min(ahead, std::min(times_[n].surprise, times_[n].ahead));
    slot.changed = kNever;
    times_[n].busy = true;
    ++grants_;
    ++slot.grants;
    current_ = n;
    slot.echoes.clear();
    const Time sure = std::min(until, schedule_.bounds().limit(n));
    if (!times_[n].runs_ahead && until > sure) network_->echoes(n, slot.echoes);
    handles_[n]->grant({sure, until, ahead}, slot.inbox, slot.echoes);
    if (!handles_[n]->elsewhere()) here_.push_back(n);
}

/// Whether node `n` can go back. One that can only while its program waits does so beside others that can:
/// among those that cannot its stretches would end at once.
bool Conductor::State::may_run_ahead(std::size_t n) {
    const NodeState& state = handles_[n]->state();
    if (slots_[n].before_look) return false;
    if (state.runs_ahead && !state.bounded) others_run_ahead_ = true;
    return state.runs_ahead && (!state.bounded || others_run_ahead_);
}

void Conductor::State::take_reply(std::size_t n) {
    Slot& slot = slots_[n];
    NodeTimes& node = times_[n];
    const Time before = node.granted;
    const Advanced& done = handles_[n]->advanced();
    const NodeState& state = handles_[n]->state();
    const bool ran_ahead = std::exchange(node.runs_ahead, may_run_ahead(n));
    node.horizon = state.horizon;
    replied_.push_back(n);
    slot.asked = done.reached;
    slot.asked_ahead = done.ahead;
    Time first_in = slot.unknown < done.ahead ? slot.unknown : kNever;
    // Having gone back, it may foresee something else from there on.
    if (done.ahead < node.ahead) first_in = std::min(first_in, done.ahead);
    network_->take_sent(n, handles_[n]->outbox(), done, first_in, deliveries_, changes_);
    node.granted = done.reached;
    node.ahead = done.ahead;
    node.busy = false;
    if (ran_ahead) {
        std::erase_if(slot.queue, [&](const TraceRecord& record) { return record.time < done.reached; });
        std::make_heap(slot.queue.begin(), slot.queue.end(), after);
    }
    while (!ran_ahead && !slot.taken.empty() && slot.taken.back().time >= slot.asked) {
        slot.queue.push_back(slot.taken.back());
        std::push_heap(slot.queue.begin(), slot.queue.end(), after);
        slot.taken.pop_back();
    }
    node.surprise = kNever;
    if (slot.changed < done.ahead) surprise(slot.changed_by, n, slot.changed);
    slot.changed = kNever;
    slot.stale = true;
    network_->update(n, state, done.ahead, first_in);
    take_deliveries(n);
    take_stop(n, before);
    take_wound_up(n, before);
}

void Conductor::State::take_deliveries(std::size_t sender) {
    for (const TraceRecord& record : deliveries_) {
        merger_.add(record);
        if (lost(record)) continue;
        const Wire& wire = network_->wire(record);
        Slot& slot = slots_[wire.to];
        if (record.time < slot.asked) {
            if (!handles_[wire.to]->samples(wire.to_port)) too_late(sender, wire.to, record.time);
            if (!in_windows_) {
                show_sampled(record);
                continue;
            }
        }
        slot.queue.push_back(record);
        std::push_heap(slot.queue.begin(), slot.queue.end(), after);
    }
    deliveries_.clear();
    take_changes();
}

void Conductor::State::take_changes() {
    for (const Change& change : changes_) {
        Slot& slot = slots_[change.to];
        NodeTimes& node = times_[change.to];
        if (change.time < slot.asked) {
            // What it only looks at is shown to it once it is final.
            if (!slot.before_look) too_late(change.from, change.to, change.time);
            continue;
        }
        slot.stale = true;
        if (!node.busy) {
            if (change.time < node.ahead) surprise(change.from, change.to, change.time);
        } else if (change.time < slot.changed) {
            slot.changed = change.time;
            slot.changed_by = change.from;
        }
    }
    changes_.clear();
}

/// Something else comes in for node `to` at `time` than it foresaw.
void Conductor::State::surprise(std::size_t from, std::size_t to, Time time) {
    times_[to].surprise = std::min(times_[to].surprise, time);
    surprised_.push_back(to);
    if (times_[from].runs_ahead) schedule_.surprised(from, to);
}

void Conductor::State::too_late(std::size_t sender, std::size_t to, Time time) const {
    throw RunError(
        fmt::format("node {} sent a message for {:.12f} s to node {}, which had been granted {:.12f} s",
                    sender == kNobody ? "?" : handles_[sender]->name(), to_seconds(time),
                    handles_[to]->name(), to_seconds(slots_[to].asked)));
}

}  // namespace puckloop::cosim
