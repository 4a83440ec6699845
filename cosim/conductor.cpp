#include "cosim/conductor.h"

#include "base/error.h"
#include "cosim/conductor_state.h"
#include "cosim/remote/remote_node.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <thread>

namespace puckloop::cosim {

namespace {

constexpr double kProgressSeconds = 0.2;
// What is recorded is on disk after so long, should this very process be killed.
constexpr double kFlushSeconds = 1.0;
// With --realtime, how far ahead of the wall clock nodes are let, and how long to sleep when they are there.
constexpr Time kPaceSlack = kMillisecond;
constexpr std::chrono::microseconds kPaceSleep{500};
// Records held back before the trace is put in order and released.

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
    workers_ = std::make_unique<Workers>(options_.threads > 1 ? options_.threads - 1 : 0);
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
        network_->preset(deliveries_);
        take_deliveries(kNobody);
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
        plan();
        if (schedule_.complete()) return;
        for (const std::size_t n : schedule_.chosen()) {
            Time until = schedule_.target(n);
            if (chop_)
                until =
                    times_[n].granted + 1 +
                    static_cast<Time>(chop_->below(static_cast<std::uint64_t>(until - times_[n].granted)));
            grant(n, until);
        }
        collect();
        if (merger_.full()) release_trace(std::min(schedule_.bounds().floor(), end_));
        keep_house();
    }
}

void Conductor::State::take_interrupt() {
    if (options_.hurried && *options_.hurried) throw Interrupted{};
    if (interrupted_at_ || !options_.interrupted || !*options_.interrupted) return;
    // The first instant that is in nobody's past.
    interrupted_at_ = 0;
    for (const Slot& slot : slots_)
        interrupted_at_ = std::max(*interrupted_at_, slot.asked);
    if (!wind_up_at_) end_ = std::min(end_, std::max<Time>(*interrupted_at_, 1));
}

void Conductor::State::plan() {
    pending_.resize(slots_.size());
    for (std::size_t n = 0; n < slots_.size(); ++n) {
        const Slot& slot = slots_[n];
        pending_[n] = std::min(slot.first_in, slot.queue.empty() ? kNever : slot.queue.front().time);
    }
    ScheduleLimits limits{end_, kNever, options_.stop_latency};
    if (options_.realtime) {
        if (!paced_since_ && schedule_.reached() >= options_.pace_from) paced_since_ = WallClock::now();
        const double paced = paced_since_ ? seconds_since(*paced_since_) : 0.0;
        limits.pace = options_.pace_from + from_seconds(paced) + (paced_since_ ? kPaceSlack : 0);
    }
    schedule_.plan(network_->channels(), pending_, times_, limits);
}

void Conductor::State::grant(std::size_t n, Time until) {
    Slot& slot = slots_[n];
    slot.inbox.clear();
    slot.taken.clear();
    while (!slot.queue.empty() && slot.queue.front().time < until) {
        const TraceRecord& record = slot.queue.front();
        slot.inbox.push_back({record.time, network_->wire(record).to_port, record.payload});
        slot.taken.push_back(record);
        std::pop_heap(slot.queue.begin(), slot.queue.end(), after);
        slot.queue.pop_back();
    }
    slot.asked = until;
    slot.first_in = slot.inbox.empty() ? kNever : slot.inbox.front().time;
    times_[n].busy = true;
    ++grants_;
    ++slot.grants;
    current_ = n;
    slot.echoes.clear();
    const Time sure = std::min(until, schedule_.bounds().limit(n));
    if (until > sure) network_->echoes(n, slot.echoes);
    handles_[n]->grant({sure, until}, slot.inbox, slot.echoes);
}

/// Lets the granted nodes of this process work, and takes their replies in order.
void Conductor::State::work_here() {
    shared_.clear();
    for (const std::size_t n : here_)
        if (specs_[n].any_thread) shared_.push_back(n);
    workers_->run(shared_.size(), [this](std::size_t piece) {
        const std::size_t n = shared_[piece];
        try {
            handles_[n]->poll(false);
        } catch (...) {
            failures_[n] = std::current_exception();
        }
    });
    for (const std::size_t n : here_) {
        current_ = n;
        if (!specs_[n].any_thread) handles_[n]->poll(false);
        if (failures_[n]) std::rethrow_exception(failures_[n]);
        take_reply(n);
    }
}

void Conductor::State::collect() {
    elsewhere_.clear();
    here_.clear();
    for (std::size_t n = 0; n < handles_.size(); ++n) {
        if (!times_[n].busy) continue;
        (handles_[n]->elsewhere() ? elsewhere_ : here_).push_back(n);
    }
    const bool any = !here_.empty();
    if (any) work_here();
    if (!elsewhere_.empty()) {
        collect_elsewhere(!any);
    } else if (!any) {
        // Nobody works and nobody may be granted: ahead of the wall clock, or locked for good.
        if (!options_.realtime || stuck()) deadlock();
        std::this_thread::sleep_for(kPaceSleep);
    }
}

/// Takes what nodes of other processes have answered; with `wait` until there is something.
void Conductor::State::collect_elsewhere(bool wait) {
    for (int looks = wait ? 2 : 1; looks > 0; --looks) {
        const std::uint32_t seen = processes_->rings();
        bool any = false;
        for (const std::size_t n : elsewhere_) {
            current_ = n;
            if (!handles_[n]->poll(false)) continue;
            take_reply(n);
            any = true;
        }
        if (any) return;
        if (looks == 2) processes_->await_answers(seen, elsewhere_.size());
    }
}

void Conductor::State::take_reply(std::size_t n) {
    Slot& slot = slots_[n];
    const Time before = times_[n].granted;
    slot.asked = handles_[n]->reached();
    const Time first_in = slot.first_in < slot.asked ? slot.first_in : kNever;
    for (const Message& message : handles_[n]->outbox())
        network_->send(n, message, first_in, deliveries_);
    times_[n] = {slot.asked, false};
    slot.first_in = kNever;
    while (!slot.taken.empty() && slot.taken.back().time >= slot.asked) {
        slot.queue.push_back(slot.taken.back());
        std::push_heap(slot.queue.begin(), slot.queue.end(), after);
        slot.taken.pop_back();
    }
    network_->update(n, handles_[n]->state(), slot.asked, first_in);
    take_deliveries(n);
    take_stop(n, before);
    take_wound_up(n, before);
}

void Conductor::State::take_deliveries(std::size_t sender) {
    for (const TraceRecord& record : deliveries_) {
        merger_.add(record);
        if (lost(record)) continue;
        const std::size_t to = network_->wire(record).to;
        if (record.time < slots_[to].asked)
            throw RunError(fmt::format(
                "node {} sent a message for {:.12f} s on link {} when {} had been granted {:.12f} s",
                sender == kNobody ? "?" : handles_[sender]->name(), to_seconds(record.time),
                links_[record.link].name, handles_[to]->name(), to_seconds(slots_[to].asked)));
        slots_[to].queue.push_back(record);
        std::push_heap(slots_[to].queue.begin(), slots_[to].queue.end(), after);
    }
    deliveries_.clear();
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

void Conductor::State::keep_house() {
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
