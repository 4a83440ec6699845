#include "cosim/schedule/network.h"

#include "base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

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
    for (std::size_t n = 0; n < nodes.size(); ++n) {
        std::vector<PortIndex> linked;
        for (std::size_t p = 0; p < port_wire_[n].size(); ++p)
            if (port_wire_[n][p] != kNobody) linked.push_back(static_cast<PortIndex>(p));
        nodes[n]->set_linked(std::move(linked));
    }
    has_unsettled_.assign(wires_.size(), false);
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
    const bool is_i2c = kind == PortKind::I2c;
    wires_.push_back({link, Direction::FromA, a, port_a, b, port_b, is_uart, flight, spec.latency, is_i2c});
    wires_.push_back({link, Direction::FromB, b, port_b, a, port_a, is_uart, flight, spec.latency, is_i2c});
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
    if (!spec.node.empty()) return;  // the node's own affair
    const auto place = fmt::format("fault on link {}", spec.link);
    bool found_link = false, found_wire = false;
    for (Wire& wire : wires_) {
        if (links_[wire.link].name != spec.link) continue;
        found_link = true;
        const bool is_radio = nodes_[wire.from]->ports()[wire.from_port].kind == PortKind::Radio;
        if (!wire.is_uart && !is_radio)
            throw InputError("", place, "the link is no UART and no radio", "a UART or radio link");
        const bool loops = loops_back(spec),
                   meant = spec.from.empty() || nodes_[wire.from]->name() == spec.from;
        found_wire = found_wire || meant;
        // One end that hears itself is cut off from the other, which does not hear it any more either.
        if (!meant && !loops) continue;
        if (loops && meant && wire.loop == kNobody) {
            wire.loop = channels_.size();
            channels_.push_back({wire.from, wire.from, 0, 0});
        }
        const PlaceKind kind = is_radio ? PlaceKind::Radio : PlaceKind::Uart;
        const WireSite site{wire.direction, wire.flight, wire.latency, kind,
                            std::string(nodes_[wire.from]->name())};
        faults_.push_back(make_fault(spec, site, seed, index));
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
        const Time claimed = std::min({wire.base, later(first_in, channel.lookahead), sent.first_change});
        const Time base = future(wire, port, reached, claimed);
        update_arrival_confidence(channel, base, sent);
        if (state.runs_ahead && !state.bounded) channel.punctual = 0;
        wire.base = base;
        update_channel(port_wire_[n][p]);
        update_lookahead(port_wire_[n][p], port);
        sent = {std::move(sent.messages)};
    }
}

/// The earliest delivery of what a sender that has reached `reached` is to send by itself, if it said
/// `claimed` before.
Time Network::future(const Wire& wire, const PortState& port, Time reached, Time claimed) {
    // A frame begins at the EOT or later; what an incoming message causes begins after it.
    const Time begun = wire.is_uart ? later(port.begun.value_or(reached), wire.flight) : 0;
    return std::max(claimed, later(std::max(port.earliest_output, begun), wire.latency));
}

void Network::update_lookahead(std::size_t w, const PortState& port) {
    const Wire& wire = wires_[w];
    Channel& channel = channels_[w];
    const Time lookahead = later(std::max(port.lookahead, wire.flight), wire.latency);
    if (lookahead != channel.lookahead) ++lookaheads_;
    channel.lookahead = lookahead;
    channel.instant = port.lookahead == 0;
    update_loop(w);
}

/// Whether something came when the EOT fell due: `base` is the next one.
void Network::update_arrival_confidence(Channel& channel, Time base, const Sent& sent) const {
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
        echoes[p] = {wire.flight, wire.latency, wire.loop == kNobody ? back[wire.to] : 0, wire.is_uart};
    }
}

}  // namespace puckloop::cosim
