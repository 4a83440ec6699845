// What nodes send on its way through the network: foreseen, final, delivered.

#include "base/error.h"
#include "cosim/schedule/network.h"

#include <fmt/format.h>

#include <algorithm>

namespace puckloop::cosim {

void Network::check_earliest_output(const Wire& wire, Time stamp, Time delivery, Time first_in) const {
    const Channel& channel = channels_[wire.link * 2u + static_cast<unsigned>(wire.direction)];
    const Time earliest = std::min(channel.base, channel.answer(first_in));
    if (delivery >= earliest) return;
    const NodeHandle& node = *nodes_[wire.from];
    const PortState& port = node.state().ports[wire.from_port];
    const auto seconds = [](Time time) {
        return time == kNever ? std::string("never") : fmt::format("{:.12f} s", to_seconds(time));
    };
    throw RunError(fmt::format(
        "node {} sent before its earliest output time on port {}: a message stamped {}, to be delivered at "
        "{}, after it had reported: not before {} (first message in since: {}; earliest output time now {}, "
        "lookahead now "
        "{}, frame on the line {})",
        node.name(), node.ports()[wire.from_port].name, seconds(stamp), seconds(delivery), seconds(earliest),
        seconds(first_in), seconds(port.earliest_output), seconds(port.lookahead),
        port.begun ? "begun at " + seconds(*port.begun) : "none"));
}

void Network::check_port(std::size_t n, PortIndex port) const {
    if (port >= port_wire_[n].size())
        throw RunError(fmt::format("node {} sent a message by port {}, which it does not have",
                                   nodes_[n]->name(), port));
}

void Network::take_sent(std::size_t n, const std::vector<Message>& outbox, const Advanced& done,
                        Time first_in, std::vector<TraceRecord>& deliveries, std::vector<Change>& changes) {
    const std::size_t ports = port_wire_[n].size();
    sent_.resize(std::max(sent_.size(), ports));
    for (std::size_t p = 0; p < ports; ++p) {
        sent_[p].messages.clear();
        sent_[p].sure = 0;
    }
    for (std::size_t i = 0; i < outbox.size(); ++i) {
        const PortIndex port = outbox[i].port;
        check_port(n, port);
        sent_[port].messages.push_back(outbox[i]);
        if (i < done.sure) ++sent_[port].sure;
    }
    for (std::size_t p = 0; p < ports; ++p) {
        const std::size_t w = port_wire_[n][p];
        if (w != kNobody)
            take_wire(w, sent_[p], done.ahead, first_in, deliveries, changes);
        else if (nodes_[n]->ports()[p].kind != PortKind::Uart)  // an open serial line is no mistake
            unlinked_ += sent_[p].sure;
    }
}

void Network::take_final(std::size_t n, const std::vector<Message>& outbox, Time reached, Time first_in,
                         std::vector<TraceRecord>& deliveries, std::vector<Change>& changes) {
    const std::vector<std::size_t>& wires = port_wire_[n];
    for (const Message& message : outbox) {
        check_port(n, message.port);
        const std::size_t w = wires[message.port];
        if (w == kNobody) {
            if (nodes_[n]->ports()[message.port].kind != PortKind::Uart) ++unlinked_;
            continue;
        }
        Wire& wire = wires_[w];
        const Time time = delivery_time(message, wire.flight, wire.latency);
        check_earliest_output(wire, message.time, time, first_in);
        if (wire.faults.empty() && !wire.record) {
            ++wire.sent;
            deliveries.push_back(
                {time, wire.link, wire.direction, wire.sequence++, FaultKind::None, message.payload});
        } else {
            pass_on(wire, {time, wire.to_port, message.payload}, deliveries, changes);
        }
    }
    const NodeState& state = nodes_[n]->state();
    for (std::size_t p = 0; p < wires.size(); ++p) {
        if (wires[p] == kNobody) continue;
        Wire& wire = wires_[wires[p]];
        Channel& channel = channels_[wires[p]];
        const Time claimed = std::min(wire.base, later(first_in, channel.lookahead));
        channel.base = wire.base = future(wire, state.ports[p], reached, claimed);
        update_lookahead(wires[p], state.ports[p]);
    }
}

/// The first message that is not what was foreseen; how many were, if all are.
std::size_t Network::first_difference(const Wire& wire, const Sent& sent) const {
    const auto pair =
        std::mismatch(wire.foreseen.begin(), wire.foreseen.end(), sent.messages.begin(), sent.messages.end());
    return static_cast<std::size_t>(pair.first - wire.foreseen.begin());
}

void Network::take_wire(std::size_t w, Sent& sent, Time ahead, Time first_in,
                        std::vector<TraceRecord>& deliveries, std::vector<Change>& changes) {
    Wire& wire = wires_[w];
    if (wire.foreseen.empty() && sent.messages.empty()) return;
    const auto delivery = [&wire](const Message& message) {
        return delivery_time(message, wire.flight, wire.latency);
    };
    std::size_t first = first_difference(wire, sent);
    // One that went back will send again what is final already.
    while (first == sent.messages.size() && first < wire.settled && wire.foreseen[first].time >= ahead)
        sent.messages.push_back(wire.foreseen[first++]);
    if (first < wire.foreseen.size()) {
        const Message& gone = wire.foreseen[first];
        sent.first_change = delivery(gone);
        if (first < wire.settled)
            throw RunError(fmt::format("node {} took back a message stamped {:.12f} s that was final",
                                       nodes_[wire.from]->name(), to_seconds(gone.time)));
        // What lies beyond where the sender now stands may come again.
        if (gone.time < ahead) check_earliest_output(wire, gone.time, sent.first_change, first_in);
    }
    for (std::size_t i = first; i < sent.messages.size(); ++i)
        check_earliest_output(wire, sent.messages[i].time, delivery(sent.messages[i]), first_in);
    if (first < sent.messages.size()) sent.first_new = delivery(sent.messages[first]);
    const Time change = std::min(sent.first_new, sent.first_change);
    if (change != kNever && wire.is_i2c) channels_[w].takes_turns = true;
    if (change != kNever && wire.faults.empty()) changes.push_back({wire.from, wire.to, change});
    for (std::size_t i = wire.settled; i < sent.sure; ++i)
        send(wire, sent.messages[i], deliveries, changes);
    wire.settled = std::max(wire.settled, sent.sure) - sent.sure;
    wire.foreseen.assign(sent.messages.begin() + static_cast<std::ptrdiff_t>(sent.sure), sent.messages.end());
    update_channel(w);
}

/// To what the wire holds. What faults make of a message is known once it is final.
void Network::update_channel(std::size_t w) {
    const Wire& wire = wires_[w];
    Channel& channel = channels_[w];
    has_unsettled_[w] = wire.settled < wire.foreseen.size();
    channel.base = wire.base;
    channel.foreseen.clear();
    for (std::size_t i = wire.settled; i < wire.foreseen.size(); ++i) {
        const Time delivery = delivery_time(wire.foreseen[i], wire.flight, wire.latency);
        if (!wire.faults.empty()) {
            channel.base = std::min(channel.base, delivery);
            break;
        }
        channel.foreseen.push_back({wire.foreseen[i].time, delivery});
    }
    update_loop(w);
}

/// What is sent on the wire may come back shortly after it comes out at the far end.
void Network::update_loop(std::size_t w) {
    if (wires_[w].loop == kNobody) return;
    Channel& back = channels_[wires_[w].loop];
    const std::size_t sender = back.from;
    back = channels_[w];
    back.from = back.to = sender;
    back.base = later(back.base, kTurnRound);
    back.lookahead = later(back.lookahead, kTurnRound);
    for (auto& foreseen : back.foreseen)
        foreseen.delivery = later(foreseen.delivery, kTurnRound);
}

void Network::settle(const Bounds& bounds, std::vector<TraceRecord>& deliveries,
                     std::vector<Change>& changes) {
    for (std::size_t w = 0; w < wires_.size(); ++w) {
        if (!has_unsettled_[w]) continue;
        Wire& wire = wires_[w];
        const std::size_t before = wire.settled;
        while (wire.settled < wire.foreseen.size() &&
               !channels_[w].may_change(wire.foreseen[wire.settled].time, bounds.earliest(wire.from)))
            send(wire, wire.foreseen[wire.settled++], deliveries, changes);
        if (wire.settled != before) update_channel(w);
    }
}

Time Network::after_settled() const {
    Time after = 0;
    for (const Wire& wire : wires_)
        if (wire.settled > 0) after = std::max(after, wire.foreseen[wire.settled - 1].time + 1);
    return after;
}

void Network::foreseen(std::size_t n, Time until, std::vector<TraceRecord>& inbox) const {
    for (const std::size_t w : into_[n]) {
        const Wire& wire = wires_[w];
        if (!wire.faults.empty()) continue;
        for (std::size_t i = wire.settled; i < wire.foreseen.size(); ++i) {
            const Time time = delivery_time(wire.foreseen[i], wire.flight, wire.latency);
            if (time < until)
                inbox.push_back({time, wire.link, wire.direction, wire.sequence + (i - wire.settled),
                                 FaultKind::None, wire.foreseen[i].payload});
        }
    }
}

Time Network::first_foreseen(std::size_t n, Time from, Time& heard) const {
    Time first = kNever;
    for (const std::size_t w : into_[n])
        for (const Foreseen& message : channels_[w].foreseen)
            if (message.delivery >= from) {
                first = std::min(first, message.delivery);
                if (channels_[w].takes_turns) heard = std::min(heard, message.delivery);
                break;
            }
    return first;
}

void Network::send(Wire& wire, const Message& message, std::vector<TraceRecord>& deliveries,
                   std::vector<Change>& changes) {
    const Time time = delivery_time(message, wire.flight, wire.latency);
    pass_on(wire, {time, wire.to_port, message.payload}, deliveries, changes);
}

/// `message` carries the time at which it is delivered if there is no fault.
void Network::pass_on(Wire& wire, const Message& message, std::vector<TraceRecord>& deliveries,
                      std::vector<Change>& changes) {
    if (wire.record) wire.record->sent.add(message.time, message.payload);
    batch_.assign(1, {message, FaultKind::None});
    const Sending sending{message.time, wire.sent++};
    for (LinkFault* fault : wire.faults)
        fault->apply(batch_, sending);
    deliver(wire, deliveries, changes);
}

void Network::preset(std::vector<TraceRecord>& deliveries, std::vector<Change>& changes) {
    for (Wire& wire : wires_)
        for (LinkFault* fault : wire.faults) {
            batch_ = fault->preset();
            deliver(wire, deliveries, changes);
        }
}

void Network::deliver(Wire& wire, std::vector<TraceRecord>& deliveries, std::vector<Change>& changes) {
    for (const Delivery& delivery : batch_) {
        const bool back = delivery.back;
        const Direction other = wire.direction == Direction::FromA ? Direction::FromB : Direction::FromA;
        const std::uint64_t sequence = back ? kBroughtBack | wire.brought_back++ : wire.sequence++;
        deliveries.push_back({delivery.message.time, wire.link, back ? other : wire.direction, sequence,
                              delivery.fault, delivery.message.payload});
        if (wire.faults.empty()) continue;
        if (wire.record) wire.record->arrived.push_back(deliveries.back());
        if (!lost(deliveries.back()))
            changes.push_back({wire.from, back ? wire.from : wire.to, delivery.message.time});
    }
}

}  // namespace puckloop::cosim
