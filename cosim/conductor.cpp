#include "cosim/conductor.h"

#include "base/error.h"
#include "cosim/conductor_state.h"
#include "cosim/remote/remote_node.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace puckloop::cosim {

namespace {

// Rounds between two plans.
constexpr int kMostFollowing = 8;
constexpr double kProgressSeconds = 0.2;
// What is recorded is on disk after so long, should this very process be killed.
constexpr double kFlushSeconds = 1.0;
// With --realtime, how far ahead of the wall clock nodes are let.
constexpr Time kPaceSlack = kMillisecond;

/// Thrown through the loop when the user ends the run.
struct Interrupted {};

bool after(const TraceRecord& a, const TraceRecord& b) {
    return a.key() > b.key();
}

}  // namespace

Conductor::State::State(std::vector<NodeSpec> nodes, std::vector<LinkSpec> links,
                        std::vector<FaultSpec> faults, RunOptions options, const NodeFactory& factory)
    : specs_(std::move(nodes)),
      links_(std::move(links)),
      fault_specs_(std::move(faults)),
      options_(std::move(options)) {
    std::set<std::string> names;
    for (const NodeSpec& spec : specs_)
        if (!names.insert(spec.name).second)
            throw InputError("", fmt::format("node {}", spec.name), "two nodes have this name");
    // Processes start side by side; each makes its node while the others do.
    for (const NodeSpec& spec : specs_) {
        if (spec.in_process.value_or(options_.in_process)) {
            handles_.push_back(make_local_node(spec.name, spec.json, factory));
            continue;
        }
        if (!processes_) processes_ = std::make_unique<NodeProcesses>();
        handles_.push_back(make_remote_node(*processes_, spec.name, spec.json, options_.node_command,
                                            options_.stall_seconds));
    }
    for (const auto& handle : handles_)
        handle->await_ready();
    network_ = std::make_unique<Network>(handles_, links_, fault_specs_, options_.seed);
    end_ = options_.duration;
    times_.resize(handles_.size());
    slots_.resize(handles_.size());
    stats_.resize(2 * links_.size());
    failures_.resize(handles_.size());
    workers_ = std::make_unique<Workers>(options_.threads > 1 ? options_.threads - 1 : 0, handles_.size(),
                                         [this](std::size_t n) { work(n); });
    if (options_.chop_seed) chop_.emplace(*options_.chop_seed, "chop");
}

Outcome Conductor::State::run() {
    Outcome outcome;
    start_ = WallClock::now();
    sinks.insert(sinks.begin(), &hash_);
    try {
        for (TraceSink* sink : sinks)
            sink->begin(links_);
        for (std::size_t n = 0; n < handles_.size(); ++n)
            network_->update(n, handles_[n]->state(), 0, kNever);
        network_->preset(deliveries_, changes_);
        take_deliveries(kNobody);
        for (std::size_t n = 0; n < handles_.size(); ++n)
            times_[n].runs_ahead = handles_[n]->state().runs_ahead;
        loop();
        wind_up();
        current_ = kNobody;
        release_trace(end_);
        outcome.text = "the asked duration is over";
        if (interrupted_at_) {
            outcome.reason = EndReason::Interrupted;
            outcome.text = "interrupted";
            outcome.stop_time = interrupted_at_;
        } else if (stop_) {
            outcome.reason = EndReason::NodeStopped;
            outcome.node = handles_[stop_requester_]->name();
            outcome.stop_time = stop_->time;
            outcome.text = fmt::format("node {} stopped at {:.9f} s: {}", outcome.node,
                                       to_seconds(stop_->time), stop_->reason);
            outcome.success = stop_->success;
        }
    } catch (const Interrupted&) {
        outcome.reason = EndReason::Interrupted;
        outcome.text = "interrupted";
        outcome.stop_time = interrupted_at_;
        current_ = kNobody;
    } catch (const std::exception& error) {
        fail(outcome, error.what());
    }
    outcome.wind_up = wind_up_at_;
    outcome.simulated = end_;
    for (const NodeTimes& node : times_)
        outcome.simulated = std::min(outcome.simulated, node.granted);
    finish(outcome);
    report(outcome);
    return outcome;
}

void Conductor::State::loop() {
    while (true) {
        take_interrupt();
        surprised_.clear();
        plan();
        if (schedule_.complete()) return;
        network_->settle(schedule_.bounds(), deliveries_, changes_);
        take_deliveries(kNobody);
        for (const std::size_t n : schedule_.chosen()) {
            Time until = schedule_.target(n);
            Time ahead = schedule_.ahead(n);
            if (chop_) chop(n, until, ahead);
            grant(n, until, ahead);
        }
        collect();
        for (int turns = 0; turns < kMostFollowing && follow_up(); ++turns)
            collect();
        if (merger_.full()) release_trace(std::min(schedule_.bounds().floor(), end_));
        report_progress();
    }
}

/// Grants the nodes that were taken by surprise since the plan. Bounds need not be known for that: it only
/// makes clear what there is to be foreseen. False: there is none.
bool Conductor::State::follow_up() {
    if (surprised_.empty()) return false;
    bool any = false;
    following_.swap(surprised_);
    surprised_.clear();
    for (const std::size_t n : following_) {
        const NodeTimes& node = times_[n];
        if (node.busy || !node.runs_ahead || node.surprise >= node.ahead) continue;
        if (node.ahead > end_ || !schedule_.follow(n, times_)) continue;
        Time until = schedule_.target(n), ahead = schedule_.ahead(n);
        if (chop_) chop(n, until, ahead);
        grant(n, until, ahead);
        any = true;
    }
    return any;
}

void Conductor::State::chop(std::size_t n, Time& until, Time& ahead) {
    const auto below = [this](Time span) {
        return static_cast<Time>(chop_->below(static_cast<std::uint64_t>(span)));
    };
    const NodeTimes& node = times_[n];
    if (until > node.granted) until = node.granted + 1 + below(until - node.granted);
    if (!node.runs_ahead) ahead = until;
    // Back to what is sure it goes as it is asked to: at the end, and where it could not go on.
    if (ahead > until && ahead > node.ahead)
        ahead = std::max(until, node.ahead) + 1 + below(ahead - std::max(until, node.ahead));
}

void Conductor::State::take_interrupt() {
    if (options_.hurried && *options_.hurried) throw Interrupted{};
    if (interrupted_at_ || !options_.interrupted || !*options_.interrupted) return;
    // The first instant that is in nobody's past: what is foreseen may be final already.
    interrupted_at_ = network_->after_settled();
    for (const Slot& slot : slots_)
        interrupted_at_ = std::max({*interrupted_at_, slot.asked, slot.asked_ahead});
    if (!wind_up_at_) end_ = std::min(end_, std::max<Time>(*interrupted_at_, 1));
}

void Conductor::State::plan() {
    pending_.resize(slots_.size());
    for (std::size_t n = 0; n < slots_.size(); ++n) {
        Slot& slot = slots_[n];
        if (slot.stale && !times_[n].busy) {
            slot.unknown = first_unknown(n);
            slot.stale = false;
        }
        pending_[n] = std::min(slot.unknown, slot.changed);
    }
    ScheduleLimits limits{end_, kNever, options_.stop_latency};
    if (options_.realtime) {
        if (!paced_since_ && schedule_.reached() >= options_.pace_from) paced_since_ = WallClock::now();
        // Before that the wall clock limits nobody: a node that has to wait for it would not go back.
        limits.pace =
            options_.pace_from + (paced_since_ ? from_seconds(seconds_since(*paced_since_)) + kPaceSlack
                                               : options_.stop_latency + 1);
    }
    schedule_.plan(network_->channels(), pending_, times_, limits);
}

/// The first message that node `n` has neither handled nor foreseen as it is now.
Time Conductor::State::first_unknown(std::size_t n) const {
    const NodeTimes& node = times_[n];
    Time first = std::min(node.surprise, network_->first_foreseen(n, node.ahead));
    for (const TraceRecord& record : slots_[n].queue)
        if (record.time >= node.ahead) first = std::min(first, record.time);
    return first;
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
        while (!slot.queue.empty() && slot.queue.front().time < until) {
            slot.taken.push_back(slot.queue.front());
            std::pop_heap(slot.queue.begin(), slot.queue.end(), after);
            slot.queue.pop_back();
        }
    }
    for (const TraceRecord& record : slot.taken)
        slot.inbox.push_back({record.time, network_->wire(record).to_port, record.payload});
}

void Conductor::State::grant(std::size_t n, Time until, Time ahead) {
    Slot& slot = slots_[n];
    if (slot.stale) slot.unknown = first_unknown(n);  // faults may have acted since the plan
    slot.stale = false;
    fill_inbox(n, ahead);
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

void Conductor::State::take_reply(std::size_t n) {
    Slot& slot = slots_[n];
    NodeTimes& node = times_[n];
    const Time before = node.granted;
    const Advanced& done = handles_[n]->advanced();
    const bool ran_ahead = std::exchange(node.runs_ahead, handles_[n]->state().runs_ahead);
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
    network_->update(n, handles_[n]->state(), done.ahead, first_in);
    take_deliveries(n);
    take_stop(n, before);
    take_wound_up(n, before);
}

void Conductor::State::take_deliveries(std::size_t sender) {
    for (const TraceRecord& record : deliveries_) {
        merger_.add(record);
        if (lost(record)) continue;
        Slot& slot = slots_[network_->wire(record).to];
        if (record.time < slot.asked) too_late(sender, network_->wire(record).to, record.time);
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
        if (change.time < slot.asked) too_late(change.from, change.to, change.time);
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

void Conductor::State::release_trace(Time floor) {
    current_ = kNobody;
    merger_.release(floor, [this](const TraceRecord& record) {
        stats_[record.link * 2u + static_cast<unsigned>(record.direction)].count(
            record, links_[record.link].nominal_baud);
        for (TraceSink* sink : sinks)
            sink->record(record);
    });
}

void Conductor::State::report_progress() {
    const double wall = seconds_since(start_);
    if (processes_) processes_->cores().step(wall, schedule_.reached(), grants_);
    if (wall - told_wall_ >= kProgressSeconds) {
        const Time time = schedule_.reached();
        if (options_.progress)
            options_.progress({time, wall, to_seconds(time - told_time_) / (wall - told_wall_)});
        told_wall_ = wall;
        told_time_ = time;
    }
    if (wall - flushed_wall_ >= kFlushSeconds) {
        release_trace(std::min(schedule_.bounds().floor(), end_));
        for (TraceSink* sink : sinks)
            sink->flush();
        flushed_wall_ = wall;
    }
}

Conductor::Conductor(std::vector<NodeSpec> nodes, std::vector<LinkSpec> links, std::vector<FaultSpec> faults,
                     RunOptions options, NodeFactory factory)
    : state_(std::make_unique<State>(std::move(nodes), std::move(links), std::move(faults),
                                     std::move(options), factory)) {}

Conductor::~Conductor() = default;

void Conductor::add_sink(TraceSink& sink) {
    state_->sinks.push_back(&sink);
}

int Conductor::process_of(const std::string& name) const {
    for (const auto& handle : state_->handles())
        if (handle->name() == name) return handle->process();
    return 0;
}

Outcome Conductor::run() {
    return state_->run();
}

}  // namespace puckloop::cosim
