#include "cosim/conductor.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "cosim/conductor_state.h"
#include "cosim/remote/node_hosts.h"
#include "cosim/remote/processes/process_line.h"
#include "cosim/remote/remote_node.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace puckloop::cosim {

namespace {

// Rounds between two plans.
constexpr int kMostFollowing = 32;
constexpr double kProgressSeconds = 0.2;
// What is recorded is on disk after so long, should this very process be killed.
constexpr double kFlushSeconds = 1.0;
// With --realtime, how far ahead of the wall clock nodes are let.
constexpr Time kPaceSlack = kMillisecond;

// Helpers look for work on a core of their own, which must be worth it.
constexpr Trial::Rule kThreadRule{
    .slices = 8, .slice = 0.004, .margin = 1.1, .first_hold = 0.5, .longest_hold = 8.0};

/// Thrown through the loop when the user ends the run.
struct Interrupted {};

}  // namespace

Conductor::State::State(std::vector<NodeSpec> nodes, std::vector<LinkSpec> links,
                        std::vector<FaultSpec> faults, RunOptions options, const NodeFactory& factory)
    : specs_(std::move(nodes)),
      links_(std::move(links)),
      fault_specs_(std::move(faults)),
      options_(std::move(options)) {
    name_faults(fault_specs_);
    std::set<std::string> names;
    for (const NodeSpec& spec : specs_)
        if (!names.insert(spec.name).second)
            throw InputError("", fmt::format("node {}", spec.name), "two nodes have this name");
    // Processes start side by side; each makes its node while the others do.
    for (const NodeSpec& spec : specs_) {
        if (spec.host != 0) {
            handles_.push_back(make_remote_node(options_.hosts->line_to(spec.host), spec.name, spec.json,
                                                options_.stall_seconds));
            continue;
        }
        if (options_.hosts || spec.in_process.value_or(options_.in_process)) {
            handles_.push_back(make_local_node(spec.name, spec.json, factory));
            continue;
        }
        if (!processes_) processes_ = std::make_unique<NodeProcesses>();
        handles_.push_back(make_remote_node(start_node_process(*processes_, spec.name, options_.node_command),
                                            spec.name, spec.json, options_.stall_seconds));
    }
    elsewhere_too_ =
        std::any_of(handles_.begin(), handles_.end(), [](const auto& handle) { return handle->elsewhere(); });
    for (const auto& handle : handles_)
        handle->await_ready();
    in_windows_ = options_.windows && !elsewhere_too_ && !options_.realtime;
    network_ = std::make_unique<Network>(handles_, links_, fault_specs_, options_.seed);
    end_ = options_.duration;
    times_.resize(handles_.size());
    slots_.resize(handles_.size());
    stats_.resize(2 * links_.size());
    failures_.resize(handles_.size());
    const unsigned helpers = options_.threads > 1 ? options_.threads - 1 : 0;
    workers_ = std::make_unique<Workers>(helpers, handles_.size() + 1 + helpers, [this](std::size_t piece) {
        if (piece == trace_piece()) return write_trace();
        if (piece >= share_piece()) return advance_shares();
        while (!work(piece, true)) {
        }
    });
    if (options_.threads_if_faster && workers_->helpers() > 0) thread_trial_.emplace(kThreadRule);
    if (options_.chop_seed) chop_.emplace(*options_.chop_seed, "chop");
}

Outcome Conductor::State::run() {
    Outcome outcome;
    start_ = WallClock::now();
    sinks.insert(sinks.begin(), &hash_);
    try {
        for (TraceSink* sink : sinks)
            sink->begin(links_);
        if (options_.save || options_.stand) keep_record();
        if (options_.from)
            go_on_from(*options_.from);
        else
            begin_anew();
        run_and_save();
        wind_up();
        current_ = kNobody;
        finish_trace();
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
    } catch (const Reverted&) {
        workers_->stop();
        outcome.reason = EndReason::Reverted;
        return outcome;
    } catch (const Interrupted&) {
        outcome.reason = EndReason::Interrupted;
        outcome.text = "interrupted";
        outcome.stop_time = interrupted_at_;
        current_ = kNobody;
    } catch (const std::exception& error) {
        fail(outcome, reason_of(error));
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
    if (in_windows_) return loop_in_windows();
    while (true) {
        take_interrupt();
        surprised_.clear();
        replied_.clear();
        plan_begun_ = WallClock::now();
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
        planned_at_ = WallClock::now();
        collect();
        for (int turns = 0; turns < kMostFollowing && follow_up(); ++turns)
            collect();
        if (merger_.full()) release_trace_beside(std::min(floor(), end_));
        report_progress();
    }
}

/// Grants the nodes that were taken by surprise since the plan, and those of a bus whose turn it is. Bounds
/// need not be known for that: it only makes clear what there is to be foreseen. False: there is none.
bool Conductor::State::follow_up() {
    following_.swap(surprised_);
    surprised_.clear();
    take_turns();
    bool any = false;
    for (const std::size_t n : following_) {
        const NodeTimes& node = times_[n];
        if (node.busy || !node.runs_ahead || node.ahead > pause_or_end() || !schedule_.follow(n, times_))
            continue;
        Time until = schedule_.target(n), ahead = schedule_.ahead(n);
        if (chop_) chop(n, until, ahead);
        grant(n, until, ahead);
        any = true;
    }
    return any;
}

/// Adds to following_ the nodes of those buses of which one has replied.
void Conductor::State::take_turns() {
    for (const std::size_t n : replied_) {
        const std::size_t group = schedule_.bus_turns().group_of(n);
        if (group == kNobody) continue;
        for (const std::size_t other : schedule_.bus_turns().nodes(group))
            if (!times_[other].busy && slots_[other].stale) find_unknown(other);
        schedule_.listen(group, times_);
        const auto& nodes = schedule_.bus_turns().nodes(group);
        following_.insert(following_.end(), nodes.begin(), nodes.end());
    }
    replied_.clear();
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
    if (options_.abort_requested && *options_.abort_requested) throw Interrupted{};
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
        if (slot.stale && !times_[n].busy) find_unknown(n);
        pending_[n] = std::min(slot.unknown, slot.changed);
    }
    schedule_.plan(network_->channels(), pending_, times_, limits());
}

ScheduleLimits Conductor::State::limits() {
    ScheduleLimits limits{pause_or_end(), kNever, options_.stop_latency};
    if (options_.realtime) {
        if (!paced_since_ && reached() >= options_.pace_from) paced_since_ = WallClock::now();
        // Before that the wall clock limits nobody: a node that has to wait for it would not go back.
        limits.pace =
            options_.pace_from + (paced_since_ ? from_seconds(seconds_since(*paced_since_)) + kPaceSlack
                                               : options_.stop_latency + 1);
    }
    return limits;
}

void Conductor::State::report_progress() {
    const double wall = seconds_since(start_);
    if (processes_) processes_->cores().step(wall, reached(), grants_);
    if (thread_trial_) workers_->set_resting(!thread_trial_->step(wall, reached(), grants_));
    if (wall - last_progress_wall_ >= kProgressSeconds) {
        const Time time = reached();
        if (options_.progress)
            options_.progress(
                {time, wall, to_seconds(time - last_progress_time_) / (wall - last_progress_wall_)});
        last_progress_wall_ = wall;
        last_progress_time_ = time;
    }
    if (wall - flushed_wall_ >= kFlushSeconds && !writing_) {
        release_trace(std::min(floor(), end_));
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
