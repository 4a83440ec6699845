// Links as part of a snapshot of the run: what is kept of them, and how they are brought there again.
//
// Faults have no saved state: what was sent goes through them again, which takes microseconds a message. So
// one that the run did not have when it was saved begins as if it had been there, and one that would have
// changed what was sent until then is found.

#include "base/error.h"
#include "cosim/schedule/network.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace puckloop::cosim {

namespace {

/// The same on the wire, whatever their numbers: a fault's own messages have numbers too.
bool same(const TraceRecord& a, const TraceRecord& b) {
    return a.time == b.time && a.direction == b.direction && a.fault == b.fault && a.payload == b.payload;
}

/// Moves those from `time` on to `in_flight`.
void split(std::vector<TraceRecord>& records, Time time, std::vector<TraceRecord>& in_flight) {
    const auto later = std::stable_partition(
        records.begin(), records.end(), [time](const TraceRecord& record) { return record.time < time; });
    in_flight.insert(in_flight.end(), later, records.end());
    records.erase(later, records.end());
}

bool by_key(const TraceRecord& a, const TraceRecord& b) {
    return a.key() < b.key();
}

}  // namespace

void Network::keep_record(const std::vector<bool>& has_state) {
    for (Wire& wire : wires_) {
        const bool is_radio = nodes_[wire.from]->ports()[wire.from_port].kind == PortKind::Radio;
        // What a node without a state received it receives again; a UART or radio link may have faults.
        const bool keep = !has_state[wire.to] || wire.is_uart || is_radio;
        wire.record = std::make_unique<WireState>();
        wire.record->sent = SentRecord(keep);
    }
}

std::vector<WireState> Network::save() const {
    std::vector<WireState> saved;
    for (const Wire& wire : wires_) {
        saved.push_back(*wire.record);
        saved.back().sequence = wire.sequence;
        saved.back().brought_back = wire.brought_back;
        saved.back().faulty = !wire.faults.empty();
    }
    return saved;
}

/// Names of the faults on a wire, for messages.
std::string Network::faults_on(const Wire& wire) const {
    std::string names = links_[wire.link].name;
    for (std::size_t f = 0; f < faults_.size(); ++f)
        if (std::find(wire.faults.begin(), wire.faults.end(), faults_[f].get()) != wire.faults.end())
            names += fmt::format(", fault {}", fault_specs_[f] + 1);
    return names;
}

std::size_t Network::sender_of(const TraceRecord& record) const {
    const std::size_t w = record.link * 2u + static_cast<unsigned>(record.direction);
    return record.sequence < kBroughtBack ? w : w ^ 1u;
}

/// What the wire's faults make of all that was sent, and of what they put there themselves.
std::vector<TraceRecord> Network::send_again(Wire& wire, const SentRecord& sent) {
    std::vector<TraceRecord> arrived;
    std::vector<Change> nobody;
    for (LinkFault* fault : wire.faults) {
        batch_ = fault->preset();
        deliver(wire, arrived, nobody);
    }
    for (const Message& message : sent.messages(wire.to_port))
        pass_on(wire, message, arrived, nobody);
    return arrived;
}

Network::Restored Network::restore(const std::vector<WireState>& saved,
                                   const std::vector<TraceRecord>& in_flight, Time time,
                                   const std::vector<bool>& has_state, std::uint64_t unlinked) {
    if (saved.size() != wires_.size()) throw InputError("", "links", "another number of links");
    Restored restored;
    std::vector<bool> again(wires_.size());
    for (std::size_t w = 0; w < wires_.size(); ++w) {
        Wire& wire = wires_[w];
        const WireState& from = saved[w];
        again[w] = from.faulty || !wire.faults.empty();
        std::vector<TraceRecord> arrived;
        if (again[w] || !has_state[wire.to]) {
            std::uint64_t number = 0;
            for (Message& message : from.sent.messages(wire.to_port))
                arrived.push_back({message.time, wire.link, wire.direction, number++, FaultKind::None,
                                   std::move(message.payload)});
        }
        if (again[w]) {
            std::vector<TraceRecord> then = from.faulty ? from.arrived : arrived, ignored;
            arrived = send_again(wire, from.sent);
            split(then, time, ignored);
            split(arrived, time, restored.in_flight);
            const auto other = std::mismatch(then.begin(), then.end(), arrived.begin(), arrived.end(), same);
            if (other.first != then.end() || other.second != arrived.end()) {
                const Time at = std::min(other.first != then.end() ? other.first->time : kNever,
                                         other.second != arrived.end() ? other.second->time : kNever);
                throw InputError(
                    "", faults_on(wire),
                    fmt::format("would have changed what arrived at {:.6f} s, before the snapshot",
                                to_seconds(at)),
                    fmt::format("faults that act after {:g} s", to_seconds(time)));
            }
        } else {
            wire.sequence = from.sequence;
            wire.sent = from.sent.count();
            wire.brought_back = from.brought_back;
            if (wire.record) wire.record->sent = from.sent;
            std::erase_if(arrived, [time](const TraceRecord& record) { return record.time >= time; });
        }
        std::copy_if(
            arrived.begin(), arrived.end(), std::back_inserter(restored.arrived),
            [&](const TraceRecord& record) { return !lost(record) && !has_state[this->wire(record).to]; });
    }
    for (const TraceRecord& record : in_flight) {
        if (record.link >= links_.size()) throw InputError("", "links", "a message of no link");
        if (!again[sender_of(record)]) restored.in_flight.push_back(record);
    }
    std::sort(restored.arrived.begin(), restored.arrived.end(), by_key);
    unlinked_ = unlinked;
    return restored;
}

}  // namespace puckloop::cosim
