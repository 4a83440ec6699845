#include "cosim/schedule/network.h"

#include "base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace puckloop::cosim {

namespace {

std::size_t find_node(const std::vector<std::unique_ptr<NodeHandle>>& nodes, const LinkSpec& link,
                      const std::string& name) {
    for (std::size_t n = 0; n < nodes.size(); ++n)
        if (nodes[n]->name() == name) return n;
    throw InputError("", fmt::format("link {}", link.name), fmt::format("there is no node \"{}\"", name));
}

PortIndex find_port(const NodeHandle& node, const LinkSpec& link, const std::string& name) {
    std::string known;
    for (std::size_t p = 0; p < node.ports().size(); ++p) {
        if (node.ports()[p].name == name) return static_cast<PortIndex>(p);
        known += (p == 0 ? "" : ", ") + node.ports()[p].name;
    }
    throw InputError("", fmt::format("link {}", link.name),
                     fmt::format("node {} has no port \"{}\"", node.name(), name), known);
}

/// EOTs in a row at which nothing was sent, until a sender is not counted on any more.
constexpr int kPatience = 4;

}  // namespace

Network::Network(const std::vector<std::unique_ptr<NodeHandle>>& nodes, const std::vector<LinkSpec>& links,
                 const std::vector<FaultSpec>& faults, std::uint64_t seed)
    : nodes_(nodes), links_(links) {
    for (const auto& node : nodes)
        port_wire_.emplace_back(node->ports().size(), kNobody);
    if (links.size() > std::numeric_limits<std::uint16_t>::max())
        throw InputError("", "", "too many links", "at most 65535");
    for (std::size_t l = 0; l < links.size(); ++l)
        attach(links[l], static_cast<std::uint16_t>(l));
    ways_back_.resize(nodes.size());
    into_.resize(nodes.size());
    for (std::size_t w = 0; w < wires_.size(); ++w)
        into_[wires_[w].to].push_back(w);
    for (std::size_t f = 0; f < faults.size(); ++f)
        attach_fault(faults[f], f, seed);
}

void Network::attach(const LinkSpec& spec, std::uint16_t link) {
    const auto place = fmt::format("link {}", spec.name);
    const std::size_t a = find_node(nodes_, spec, spec.a.node);
    const std::size_t b = find_node(nodes_, spec, spec.b.node);
    const PortIndex port_a = find_port(*nodes_[a], spec, spec.a.port);
    const PortIndex port_b = find_port(*nodes_[b], spec, spec.b.port);
    const PortKind kind = nodes_[a]->ports()[port_a].kind;
    if (kind != nodes_[b]->ports()[port_b].kind)
        throw InputError("", place,
                         fmt::format("{}.{} and {}.{} are ports of different kinds", spec.a.node, spec.a.port,
                                     spec.b.node, spec.b.port));
    const bool is_uart = kind == PortKind::Uart;
    if (is_uart != (spec.nominal_baud > 0.0))
        throw InputError("", place, is_uart ? "no nominal baud" : "a nominal baud on a link that is no UART",
                         "one for UART links, and for no others");
    if (spec.latency < 0) throw InputError("", place, "negative latency");
    const Time flight = flight_time(spec);
    wires_.push_back({link, Direction::FromA, a, port_a, b, port_b, is_uart, flight, spec.latency});
    wires_.push_back({link, Direction::FromB, b, port_b, a, port_a, is_uart, flight, spec.latency});
    for (const std::size_t w : {wires_.size() - 2, wires_.size() - 1}) {
        std::size_t& slot = port_wire_[wires_[w].from][wires_[w].from_port];
        if (slot != kNobody)
            throw InputError("", place,
                             fmt::format("port {}.{} is linked already", nodes_[wires_[w].from]->name(),
                                         w % 2 == 0 ? spec.a.port : spec.b.port));
        slot = w;
        channels_.push_back({wires_[w].from, wires_[w].to, 0, 0});
    }
}

void Network::attach_fault(const FaultSpec& spec, std::size_t index, std::uint64_t seed) {
    const auto place = fmt::format("fault on link {}", spec.link);
    bool found_link = false, found_wire = false;
    for (Wire& wire : wires_) {
        if (links_[wire.link].name != spec.link) continue;
        found_link = true;
        const bool is_radio = nodes_[wire.from]->ports()[wire.from_port].kind == PortKind::Radio;
        if (!wire.is_uart && !is_radio)
            throw InputError("", place, "the link is no UART and no radio", "a UART or radio link");
        if (is_radio && !harms_radio(spec.kind))
            throw InputError("", place, fmt::format("{} on a radio link", fault_name(spec.kind)),
                             "drop, flip, delay, duplicate or disconnect");
        if (!spec.from.empty() && nodes_[wire.from]->name() != spec.from) continue;
        found_wire = true;
        faults_.push_back(make_fault(spec, wire.direction, wire.flight, seed, index));
        fault_specs_.push_back(index);
        wire.faults.push_back(faults_.back().get());
    }
    if (!found_link) throw InputError("", place, "there is no such link");
    if (!found_wire) throw InputError("", place, fmt::format("no node {} at either end", spec.from));
}

void Network::update(std::size_t n, const NodeState& state, Time reached, Time first_in) {
    sent_.resize(std::max(sent_.size(), port_wire_[n].size()));
    for (std::size_t p = 0; p < port_wire_[n].size(); ++p) {
        if (port_wire_[n][p] == kNobody) continue;
        Wire& wire = wires_[port_wire_[n][p]];
        const PortState& port = state.ports[p];
        Channel& channel = channels_[port_wire_[n][p]];
        Sent& sent = sent_[p];
        // A frame begins at the EOT or later; what an incoming message causes begins after it.
        const Time begun = wire.is_uart ? later(port.begun.value_or(reached), wire.flight) : 0;
        const Time said_before = std::min({wire.base, later(first_in, channel.lookahead), sent.first_change});
        const Time base = std::max(said_before, later(std::max(port.earliest_output, begun), wire.latency));
        judge_punctuality(channel, base, sent);
        if (state.runs_ahead) channel.punctual = 0;
        wire.base = base;
        update_channel(port_wire_[n][p]);
        const Time lookahead = later(std::max(port.lookahead, wire.flight), wire.latency);
        if (lookahead != channel.lookahead) ++lookaheads_;
        channel.lookahead = lookahead;
        channel.instant = port.lookahead == 0;
        sent = {std::move(sent.messages)};
    }
}

/// Whether something came when the EOT fell due: `base` is the next one.
void Network::judge_punctuality(Channel& channel, Time base, const Sent& sent) const {
    if (sent.first_new != kNever)
        channel.punctual = sent.first_new == channel.base ? kPatience : std::max(0, channel.punctual - 1);
    else if (base > channel.base)
        channel.punctual = std::max(0, channel.punctual - 1);
}

void Network::renew(std::size_t n, const NodeState& state, Time now) {
    for (const std::size_t wire : port_wire_[n])
        if (wire != kNobody) wires_[wire].base = 0;
    update(n, state, now, kNever);
}

/// Ways back to node `n`; they change only when somebody's lookahead does.
const std::vector<Time>& Network::distances_to_node(std::size_t n) {
    WaysBack& ways = ways_back_[n];
    if (ways.lookaheads != lookaheads_) {
        ways.distances = distances_to(n, channels_, nodes_.size());
        ways.lookaheads = lookaheads_;
    }
    return ways.distances;
}

void Network::echoes(std::size_t n, std::vector<PortEcho>& echoes) {
    const std::vector<Time>& back = distances_to_node(n);
    echoes.assign(port_wire_[n].size(), {});
    for (std::size_t p = 0; p < echoes.size(); ++p) {
        if (port_wire_[n][p] == kNobody) continue;
        const Wire& wire = wires_[port_wire_[n][p]];
        echoes[p] = {wire.flight, wire.latency, back[wire.to], wire.is_uart};
    }
}

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
        if (port >= ports)
            throw RunError(fmt::format("node {} sent a message by port {}, which it does not have",
                                       nodes_[n]->name(), port));
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
    channel.base = wire.base;
    channel.foreseen.clear();
    for (std::size_t i = wire.settled; i < wire.foreseen.size(); ++i) {
        const Time delivery = delivery_time(wire.foreseen[i], wire.flight, wire.latency);
        if (!wire.faults.empty()) {
            channel.base = std::min(channel.base, delivery);
            return;
        }
        channel.foreseen.push_back({wire.foreseen[i].time, delivery});
    }
}

void Network::settle(const Bounds& bounds, std::vector<TraceRecord>& deliveries,
                     std::vector<Change>& changes) {
    for (std::size_t w = 0; w < wires_.size(); ++w) {
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

Time Network::first_foreseen(std::size_t n, Time from) const {
    Time first = kNever;
    for (const std::size_t w : into_[n])
        for (const Foreseen& message : channels_[w].foreseen)
            if (message.delivery >= from) {
                first = std::min(first, message.delivery);
                break;
            }
    return first;
}

void Network::send(Wire& wire, const Message& message, std::vector<TraceRecord>& deliveries,
                   std::vector<Change>& changes) {
    const Time time = delivery_time(message, wire.flight, wire.latency);
    batch_.assign(1, {Message{time, wire.to_port, message.payload}, FaultKind::None});
    for (LinkFault* fault : wire.faults)
        fault->apply(batch_);
    deliver(wire, deliveries, changes);
}

void Network::preset(std::vector<TraceRecord>& deliveries, std::vector<Change>& changes) {
    for (Wire& wire : wires_)
        for (const LinkFault* fault : wire.faults) {
            batch_ = fault->preset();
            deliver(wire, deliveries, changes);
        }
}

void Network::deliver(Wire& wire, std::vector<TraceRecord>& deliveries, std::vector<Change>& changes) {
    for (const Delivery& delivery : batch_) {
        deliveries.push_back({delivery.message.time, wire.link, wire.direction, wire.sequence++,
                              delivery.fault, delivery.message.payload});
        if (!wire.faults.empty() && !lost(deliveries.back()))
            changes.push_back({wire.from, wire.to, delivery.message.time});
    }
}

}  // namespace puckloop::cosim
