// How a run ends: a node's request, a deadlock, a failure; and what is reported of it.

#include "base/error.h"
#include "base/plain_text.h"
#include "cosim/conductor_state.h"

#include <fmt/format.h>

#include <algorithm>

namespace puckloop::cosim {

void Conductor::State::take_stop(std::size_t n, Time before) {
    const std::optional<Stop>& stop = handles_[n]->state().stop;
    if (!stop || slots_[n].stop_seen) return;
    slots_[n].stop_seen = true;
    // Nobody has been granted more than the stop latency beyond `before`, so this end is in nobody's past.
    Stop request = *stop;
    request.time = std::max(request.time, before);
    if (request.together <= 1) return end_with(request, n);
    stop_requests_.emplace_back(request, n);
    if (stop_requests_.size() < request.together) return;
    const auto last =
        std::max_element(stop_requests_.begin(), stop_requests_.end(), [](const auto& a, const auto& b) {
            return std::pair(a.first.time, a.second) < std::pair(b.first.time, b.second);
        });
    end_with(last->first, last->second);
}

void Conductor::State::end_with(const Stop& stop, std::size_t n) {
    if (stop_ && (stop_->time < stop.time || (stop_->time == stop.time && stop_requester_ < n))) return;
    if (stop.time >= end_) return;
    stop_ = stop;
    stop_requester_ = n;
    end_ = std::min(end_, later(stop.time, options_.stop_latency));
}

/// Every node has reached the end: those that run programs let them end, for which simulated time goes on.
void Conductor::State::wind_up() {
    const Time now = end_;
    const int signal = interrupted_at_ ? *options_.interrupted : 0;
    for (std::size_t n = 0; n < handles_.size(); ++n) {
        current_ = n;
        handles_[n]->wind_up(signal);
        if (handles_[n]->state().wound_up == kNever) ++winding_;
    }
    if (winding_ == 0) return;
    wind_up_at_ = last_wound_up_ = now;
    end_ = kNever;
    for (std::size_t n = 0; n < handles_.size(); ++n) {
        network_->renew(n, handles_[n]->state(), now);
        slots_[n].wound_up = handles_[n]->state().wound_up != kNever;
    }
    loop();
}

void Conductor::State::take_wound_up(std::size_t n, Time before) {
    const Time done = handles_[n]->state().wound_up;
    if (!wind_up_at_ || slots_[n].wound_up || done == kNever) return;
    slots_[n].wound_up = true;
    last_wound_up_ = std::max({last_wound_up_, done, before});
    if (--winding_ == 0) end_ = std::min(end_, later(last_wound_up_, options_.stop_latency));
}

bool Conductor::State::stuck() const {
    const Time ceiling = std::min(pause_or_end(), later(reached(), options_.stop_latency));
    for (std::size_t n = 0; n < times_.size(); ++n)
        if (std::min(schedule_.bounds().limit(n), ceiling) > times_[n].granted) return false;
    return true;
}

void Conductor::State::deadlock() const {
    // Follow who limits whom, from a node that may not move, until a node comes again: those are the cycle.
    std::size_t n = 0;
    while (n < times_.size() && schedule_.bounds().limit(n) > times_[n].granted)
        ++n;
    std::vector<std::size_t> path;
    while (n < times_.size() && std::find(path.begin(), path.end(), n) == path.end()) {
        path.push_back(n);
        n = schedule_.bounds().limiter(n);
    }
    std::string names;
    bool in_cycle = false;
    for (const std::size_t step : path) {
        in_cycle = in_cycle || step == n;
        if (in_cycle) names += handles_[step]->name() + " <- ";
    }
    if (n < times_.size()) names += handles_[n]->name();
    throw RunError(fmt::format(
        "deadlock at simulated time {:.12f} s: each node waits for the next and none can rule out "
        "sending: {} (a cycle of links needs a positive sum of earliest output times, lookaheads and "
        "latencies)",
        to_seconds(reached()), names));
}

void Conductor::State::fail(Outcome& outcome, const std::string& text) {
    outcome.reason = EndReason::Failed;
    outcome.success = false;
    outcome.text = text;
    if (current_ != kNobody) outcome.node = handles_[current_]->name();
}

void Conductor::State::finish(Outcome& outcome) {
    // What was sent before a failure is kept whole; an interrupted trace ends where all of it is known.
    const bool failed = outcome.reason == EndReason::Failed;
    workers_->stop();
    const auto guarded = [&](auto work) {
        try {
            work();
        } catch (const std::exception& error) {
            if (outcome.reason != EndReason::Failed)
                fail(outcome, reason_of(error));
            else if (outcome.text != reason_of(error))
                outcome.warnings.emplace_back(reason_of(error));
        }
    };
    guarded([&] { take_written(); });
    guarded([&] { release_trace(failed ? kNever : std::min(floor(), end_)); });
    for (TraceSink* sink : sinks)
        guarded([&] { sink->flush(); });
    for (std::size_t n = 0; n < handles_.size(); ++n) {
        outcome.nodes.push_back({handles_[n]->name(), {}, slots_[n].grants, handles_[n]->work()});
        guarded([&] {
            current_ = n;
            outcome.nodes.back().json = handles_[n]->finish();
        });
    }
}

void Conductor::State::report(Outcome& outcome) {
    outcome.wall_s = seconds_since(start_);
    outcome.went_on = went_on_;
    outcome.restored_s = restored_s_;
    outcome.grants = grants_;
    outcome.trace_sha256 = hash_.finish();
    for (std::size_t l = 0; l < links_.size(); ++l) {
        const LinkSpec& link = links_[l];
        outcome.links.push_back({link.name, link.a.node + "." + link.a.port, link.b.node + "." + link.b.port,
                                 stats_[2 * l], stats_[2 * l + 1]});
    }
    for (const FaultSpec& spec : fault_specs_)
        outcome.faults.push_back(report_of(spec));
    for (std::size_t f = 0; f < network_->faults().size(); ++f)
        outcome.faults[network_->fault_specs()[f]].add(network_->faults()[f]->evidence(), outcome.simulated);
    if (network_->unlinked() != 0)
        outcome.warnings.push_back(
            fmt::format("{} messages were sent by ports without a link", network_->unlinked()));
}

}  // namespace puckloop::cosim
