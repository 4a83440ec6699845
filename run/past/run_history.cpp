#include "run/past/run_history.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace puckloop::tools {

using cosim::RunSnapshot;
using cosim::Time;
using cosim::WireState;

std::string why_not_back(const RunSetup& setup, const RunRequest& request) {
    for (const PlannedNode& node : setup.nodes)
        if (node.outside) return node.name + " is a line to the outside, which cannot go back";
    if (request.realtime || request.paced) return "the run is paced by the wall clock, which cannot go back";
    if (!request.live.empty()) return "--live has given away what would have to be taken back";
    return {};
}

void RunHistory::begin(std::shared_ptr<const RunSnapshot> origin, Place place) {
    last_ = origin ? origin->time : 0;
    instants_.push_back({std::move(place), std::move(origin), {}});
}

Time RunHistory::next(Time time) const {
    return std::max(last_, time) + interval_;
}

void RunHistory::take(RunSnapshot& snapshot, Place place) {
    if (snapshot.time <= last_) return;  // for a file, in the past
    last_ = snapshot.time;
    carried_ = std::exchange(snapshot.wires, {});
    Instant instant{std::move(place), nullptr, {}};
    for (const WireState& wire : carried_) {
        instant.sent.push_back(wire.sent.length());
        snapshot.wires.push_back({wire.sequence, wire.brought_back, wire.faulty, {}, {}});
    }
    instant.snapshot = std::make_shared<const RunSnapshot>(std::move(snapshot));
    instants_.push_back(std::move(instant));
    if (instants_.size() > kMost) thin_out();
}

/// The first stays.
void RunHistory::thin_out() {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < instants_.size(); i += 2)
        if (kept++ != i) instants_[kept - 1] = std::move(instants_[i]);
    instants_.resize(kept);
    interval_ *= 2;
}

std::optional<std::size_t> RunHistory::before(std::size_t board, std::uint64_t cycle) const {
    for (std::size_t i = instants_.size(); i > 0; --i)
        if (instants_[i - 1].place.boards[board].cycle < cycle) return i - 1;
    return std::nullopt;
}

std::size_t RunHistory::at_or_before(Time time) const {
    for (std::size_t i = instants_.size(); i > 1; --i)
        if (this->time(i - 1) <= time) return i - 1;
    return 0;
}

Time RunHistory::time(std::size_t instant) const {
    const auto& snapshot = instants_[instant].snapshot;
    return snapshot ? snapshot->time : 0;
}

void RunHistory::forget_after(std::size_t instant) {
    last_ = time(instant);
    instants_.resize(instant + 1);
}

std::shared_ptr<const RunSnapshot> RunHistory::snapshot(std::size_t instant) const {
    const Instant& one = instants_[instant];
    if (instant == 0) return one.snapshot;
    auto whole = std::make_shared<RunSnapshot>(*one.snapshot);
    for (std::size_t w = 0; w < whole->wires.size(); ++w) {
        WireState& wire = whole->wires[w];
        wire.sent = carried_[w].sent.beginning(one.sent[w]);
        // By time, not by number: what a fault that came later puts on the line stands first in the record.
        const Time time = whole->time;
        const auto& all = carried_[w].arrived;
        std::copy_if(all.begin(), all.end(), std::back_inserter(wire.arrived),
                     [time](const cosim::TraceRecord& record) { return record.time < time; });
    }
    return whole;
}

RunHistory::Place RunWritten::place(std::vector<RunHistory::Board> boards) const {
    return {std::move(boards), trace->size(), record ? record->size() : 0, lines.seen()};
}

}  // namespace puckloop::tools
