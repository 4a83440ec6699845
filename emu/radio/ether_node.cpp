#include "emu/radio/ether_node.h"

#include "base/error.h"
#include "base/json.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace puckloop::radio {

using cosim::Time;
using protocols::MeshFrame;

namespace {

std::vector<std::string> names_of(const EtherSpec& spec) {
    std::vector<std::string> names;
    for (const EtherStation& station : spec.stations)
        names.push_back(station.name);
    return names;
}

std::vector<Position> positions_of(const EtherSpec& spec) {
    std::vector<Position> positions;
    for (const EtherStation& station : spec.stations)
        positions.push_back(station.at);
    return positions;
}

bool from_module(protocols::MeshKind kind) {
    using enum protocols::MeshKind;
    return kind != Acknowledge && kind != RouteRequest && kind != RouteReply;
}

}  // namespace

EtherNode::EtherNode(const EtherSpec& spec)
    : spec_(spec),
      medium_(spec.propagation, positions_of(spec)),
      faults_(spec.faults, names_of(spec)),
      mesh_(medium_, names_of(spec), spec.seed, spec.processing, faults_, *this) {
    const Propagation& air = spec.propagation;
    const auto refuse = [&](const char* what, const char* expected) {
        throw InputError("", "radio medium " + spec.name, what, expected);
    };
    if (!(air.range_m > 0 && air.range_m < 1e5)) refuse("bad range", "more than 0 m, at most 100 km");
    if (!(air.exponent > 0 && air.exponent <= 10)) refuse("bad exponent", "more than 0, at most 10");
    if (!(air.loss >= 0 && air.loss <= 1)) refuse("bad loss", "0 to 1");
    if (spec.processing <= 0 || spec.processing > cosim::kSecond) refuse("bad processing time", "up to 1 s");
    for (const EtherStation& station : spec.stations)
        ports_.push_back({station.name, cosim::PortKind::Radio});
}

void EtherNode::advance(Time until, std::span<const cosim::Message> inbox,
                        std::vector<cosim::Message>& outbox) {
    outbox_ = &outbox;
    for (const cosim::Message& message : inbox) {
        mesh_.run(message.time, true);
        receive(message);
    }
    mesh_.run(until, false);
    granted_ = until;
    outbox_ = nullptr;
}

void EtherNode::receive(const cosim::Message& message) {
    const auto* radio = std::get_if<cosim::RadioFrame>(&message.payload);
    if (radio == nullptr || message.port >= ports_.size()) return;
    if (radio->duration == 0) {
        if (const auto settings = decode_settings(radio->octets.view()))
            set(message.port, *settings, message.time);
        else
            mesh_.bad_frame(message.port);
        return;
    }
    const protocols::MeshReading reading = protocols::decode_mesh(radio->octets.view());
    if (reading.fault == protocols::MeshFault::None && from_module(reading.frame.kind))
        mesh_.send(message.port, reading.frame, message.time);
    else
        mesh_.bad_frame(message.port);
}

void EtherNode::set(std::size_t station, const RadioSettings& settings, Time now) {
    mesh_.set(station, settings, now);
    if (!settings.on) return;
    for (std::size_t other = 0; other < ports_.size(); ++other) {
        const RadioSettings& there = mesh_.mac().settings(other);
        if (other == station || !there.on || there.address != settings.address) continue;
        std::string warning = fmt::format(
            "{} and {} have one address, {:016X}: both receive what is sent to it",
            ports_[std::min(other, station)].name, ports_[std::max(other, station)].name, settings.address);
        if (std::find(warnings_.begin(), warnings_.end(), warning) == warnings_.end())
            warnings_.push_back(std::move(warning));
    }
}

void EtherNode::deliver(std::size_t station, const MeshFrame& frame, const Heard& heard) {
    cosim::RadioFrame radio;
    radio.start = heard.start;
    radio.duration = heard.end - heard.start;
    radio.octets = cosim::Octets(protocols::encode_mesh(frame));
    radio.channel = mesh_.mac().settings(station).channel;
    radio.dbm = static_cast<std::int8_t>(std::clamp(std::lround(heard.dbm), -128L, 127L));
    outbox_->push_back({heard.end, static_cast<cosim::PortIndex>(station), radio});
}

void EtherNode::report(std::size_t station, const RadioOutcome& outcome, Time now) {
    cosim::RadioFrame radio;
    radio.start = now;
    radio.octets = cosim::Octets(encode(outcome));
    radio.channel = mesh_.mac().settings(station).channel;
    outbox_->push_back({now, static_cast<cosim::PortIndex>(station), radio});
}

Time EtherNode::earliest_output(cosim::PortIndex /*port*/) const {
    return std::max(granted_, mesh_.earliest_output());
}

std::string EtherNode::finish() {
    using nlohmann::json;
    json stations = json::object();
    for (std::size_t s = 0; s < ports_.size(); ++s) {
        const MacCounts& mac = mesh_.mac().counts(s);
        const MeshCounts& net = mesh_.counts(s);
        stations[ports_[s].name] = {{"unicasts", net.unicasts},
                                    {"broadcasts", net.broadcasts},
                                    {"delivered", net.delivered},
                                    {"undelivered", net.undelivered},
                                    {"network_retries", net.retries},
                                    {"route_discoveries", net.discoveries},
                                    {"relayed", net.relayed},
                                    {"no_way_on", net.no_way_on},
                                    {"heard_again", net.duplicates},
                                    {"bad_frames", net.bad_frames},
                                    {"mac",
                                     {{"frames", mac.frames},
                                      {"acks", mac.acks},
                                      {"retries", mac.retries},
                                      {"failures", mac.failures},
                                      {"channel_busy", mac.channel_busy},
                                      {"received", mac.received},
                                      {"received_twice", mac.duplicates},
                                      {"collisions", mac.losses.collisions},
                                      {"noise", mac.losses.noise},
                                      {"while_sending", mac.losses.sending},
                                      {"dropped", mac.dropped}}}};
    }
    json report{{"stations", std::move(stations)}, {"hops", mesh_.hops()}, {"warnings", warnings_}};
    if (!faults_.empty())
        report["faults"] = json::parse(cosim::fault_results(faults_.carried(), granted_).dump());
    return report.dump();
}

}  // namespace puckloop::radio
