// Nodes of this process side by side, a window at a time: each goes as far as is sure, and nothing is
// foreseen, marked or taken back. Nodes that any thread may advance are shared with helpers where a window
// has enough of them; what they sent is taken by this thread alone, once all are done.

#include "cosim/conductor_state.h"

#include <algorithm>
#include <exception>
#include <vector>

namespace puckloop::cosim {

namespace {
// Fewer nodes are done before a helper has begun.
constexpr std::size_t kWorthSharingNodes = 4;
}  // namespace

void Conductor::State::loop_in_windows() {
    pending_.resize(slots_.size());
    acting_.resize(slots_.size());
    windows_.connect(network_->channels(), sampled_channels(), slots_.size());
    while (true) {
        take_interrupt();
        find_pending();
        windows_.plan(pending_, acting_, times_, limits());
        if (windows_.complete()) return show_sampled();
        if (windows_.chosen().empty()) return leave_windows();
        window();
        if (writing_) {  // perhaps no longer
            done_.clear();
            take_done();
        }
        if (merger_.full()) release_trace_beside(std::min(floor(), end_));
        report_progress();
    }
}

/// The first message for each node, and the first that it does not sample.
void Conductor::State::find_pending() {
    for (std::size_t n = 0; n < slots_.size(); ++n) {
        const std::vector<TraceRecord>& queue = slots_[n].queue;
        pending_[n] = acting_[n] = queue.empty() ? kNever : queue.front().time;
        if (queue.empty() || !handles_[n]->samples()) continue;
        acting_[n] = kNever;
        for (const TraceRecord& record : queue)
            if (record.time < acting_[n] && !handles_[n]->samples(network_->wire(record).to_port))
                acting_[n] = record.time;
    }
}

/// Of each channel, what its ends state as SampledInputs.
std::vector<Windows::Sampling> Conductor::State::sampled_channels() const {
    std::vector<Windows::Sampling> sampling(network_->channels().size());
    for (std::size_t w = 0; w < network_->wire_count(); ++w) {
        const Wire& wire = network_->wires()[w];
        const NodeHandle& to = *handles_[wire.to];
        sampling[w] = {to.samples(wire.to_port), handles_[wire.from]->independent(wire.from_port),
                       to.turn_port() == wire.to_port};
    }
    return sampling;
}

/// Nodes take in what came from before where they are, and they have not looked at.
void Conductor::State::show_sampled() {
    for (std::size_t n = 0; n < slots_.size(); ++n) {
        Slot& slot = slots_[n];
        if (slot.queue.empty() || slot.queue.front().time >= times_[n].granted) continue;
        slot.asked = slot.known = slot.answered = times_[n].granted;
        advance_sampling(n);
    }
}

/// After the windows: what a node that is ahead of it only looks at.
void Conductor::State::show_sampled(const TraceRecord& record) {
    const Wire& wire = network_->wire(record);
    Slot& slot = slots_[wire.to];
    slot.inbox.assign(1, {record.time, wire.to_port, record.payload});
    handles_[wire.to]->advance_sampling({slot.asked, slot.asked, slot.asked}, slot.inbox);
}

/// All wait for each other, as far as a plain grant goes. A node that hands something out at T and answers
/// later than at once has it settled before it knows what comes in at T: nodes that run ahead show such
/// things, and find out whether the wait is for good.
void Conductor::State::leave_windows() {
    in_windows_ = false;
    show_sampled();
    for (std::size_t n = 0; n < slots_.size(); ++n) {
        slots_[n].stale = true;
        slots_[n].before_look =
            handles_[n]->samples() && std::min(windows_.known(n), windows_.answered(n)) < times_[n].granted;
        times_[n].runs_ahead = may_run_ahead(n);
        times_[n].horizon = handles_[n]->state().horizon;
    }
    loop();
}

void Conductor::State::window() {
    shares_.clear();
    const std::vector<Windows::Step>& steps = windows_.chosen();
    // Programs compute in processes of their own meanwhile.
    for (const auto& [n, to, known, answered] : steps) {
        Time until = to, ahead = to;
        if (chop_) chop(n, until, ahead);
        slots_[n].asked = slots_[n].asked_ahead = until;
        slots_[n].known = known;
        slots_[n].answered = answered;
        ++grants_;
        ++slots_[n].grants;
        if (specs_[n].any_thread) {
            shares_.push_back(n);
            continue;
        }
        current_ = n;
        if (!advance_in_window(n)) suspended_.push_back(n);
    }
    share_window();
    for (const Windows::Step& step : steps)
        if (std::find(suspended_.begin(), suspended_.end(), step.node) == suspended_.end())
            take_window(step.node);
    resume_in_window();
}

/// Advances shares_, with helpers where that serves.
void Conductor::State::share_window() {
    next_share_.store(0, std::memory_order_relaxed);
    std::size_t open = 0;
    // A batch of the trace that no helper has begun goes first.
    if (shares_.size() >= kWorthSharingNodes && workers_->waiting() == 0 && workers_->available())
        for (; open < workers_->helpers(); ++open)
            workers_->submit(share_piece() + open, true);
    advance_shares();
    if (open == 0) return;
    while (workers_->do_one()) {  // what no helper has begun
    }
    while (true) {
        done_.clear();
        take_done();
        open -= done_.size();
        if (open == 0) return;
        workers_->wait();
    }
}

/// On any thread.
void Conductor::State::advance_shares() {
    std::size_t share = 0;
    while ((share = next_share_.fetch_add(1, std::memory_order_relaxed)) < shares_.size()) {
        const std::size_t n = shares_[share];
        try {
            advance_in_window(n);
        } catch (...) {
            failures_[n] = std::current_exception();
        }
    }
}

/// As far as it was asked to; false where it waits for its program.
bool Conductor::State::advance_in_window(std::size_t n) {
    if (handles_[n]->samples()) {
        advance_sampling(n);
        return true;
    }
    Slot& slot = slots_[n];
    slot.inbox.clear();
    slot.take_before(slot.asked, [&](const TraceRecord& record) {
        slot.inbox.push_back({record.time, network_->wire(record).to_port, record.payload});
    });
    return handles_[n]->advance(slot.asked, slot.inbox);
}

/// The same for a node that may end before that, where it would look at what is not known.
void Conductor::State::advance_sampling(std::size_t n) {
    Slot& slot = slots_[n];
    NodeHandle& node = *handles_[n];
    slot.inbox.clear();
    slot.taken.clear();
    slot.take_before(slot.asked, [&](const TraceRecord& record) {
        const PortIndex port = network_->wire(record).to_port;
        if (record.time >= slot.known && node.samples(port)) {
            slot.left.push_back(record);
            return;
        }
        slot.inbox.push_back({record.time, port, record.payload});
        slot.taken.push_back(record);
    });
    node.advance_sampling({slot.asked, slot.known, slot.answered}, slot.inbox);
    for (; !slot.taken.empty() && slot.taken.back().time >= node.reached(); slot.taken.pop_back())
        slot.left.push_back(slot.taken.back());
    for (const TraceRecord& record : slot.left) {
        slot.queue.push_back(record);
        std::push_heap(slot.queue.begin(), slot.queue.end(), after);
    }
    slot.left.clear();
}

/// The rest of the window for those that wait for their programs.
void Conductor::State::resume_in_window() {
    for (int looks = 0; !suspended_.empty(); ++looks) {
        done_.clear();
        resume(suspended_.size() == 1 || looks >= kLooksAtSeveral);
        for (const std::size_t n : done_)
            take_window(n);
    }
}

void Conductor::State::take_window(std::size_t n) {
    current_ = n;
    if (failures_[n]) std::rethrow_exception(failures_[n]);
    Slot& slot = slots_[n];
    const Time before = times_[n].granted;
    const Time reached = handles_[n]->advanced().reached;
    network_->take_final(n, handles_[n]->outbox(), reached,
                         slot.inbox.empty() ? kNever : slot.inbox.front().time, deliveries_, changes_);
    windows_.update(n, network_->channels());
    windows_.note_look(n, reached < slot.asked);
    windows_.note_turn(n, handles_[n]->has_turn());
    slot.asked = slot.asked_ahead = reached;
    times_[n].granted = times_[n].ahead = reached;
    take_deliveries(n);
    take_stop(n, before);
    take_wound_up(n, before);
}

}  // namespace puckloop::cosim
