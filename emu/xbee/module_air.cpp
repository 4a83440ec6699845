// What a module sends and gets over the air.

#include "emu/xbee/module.h"

#include "emu/radio/mac.h"

#include <algorithm>
#include <array>

namespace puckloop::xbee {

using cosim::Time;
using protocols::MeshFrame;
using protocols::MeshKind;
using protocols::XBeeBytes;

namespace {

constexpr std::uint8_t kAcknowledged = 1, kWasBroadcast = 2;  // options of a frame 90
constexpr std::uint16_t kSequences = 0x8000;                  // the network layer's own begin there

/// Longer than the network layer tries; what is not heard of by then was lost on the way to it.
constexpr Time kPatience = 20 * cosim::kSecond;

std::uint16_t number_at(const XBeeBytes& data, std::size_t at) {
    return static_cast<std::uint16_t>(data[at] << 8 | data[at + 1]);
}

}  // namespace

std::uint16_t Module::send(MeshKind kind, std::uint64_t to, std::uint8_t options, std::uint8_t radius,
                           XBeeBytes data, Time now) {
    MeshFrame frame;
    frame.kind = kind;
    frame.pan = static_cast<std::uint16_t>(settings_[kID]);
    frame.hop_from = frame.origin = options_.address;
    frame.target = to;
    frame.options = options;
    frame.radius = radius;
    frame.sequence = sequence_;
    sequence_ = static_cast<std::uint16_t>((sequence_ + 1) % kSequences);
    frame.data = std::move(data);
    auto octets = protocols::encode_mesh(frame);
    const Time on_air = radio::air_time(octets.size());
    air_.radio_sent(std::move(octets), on_air, now);
    return frame.sequence;
}

void Module::transmit(const protocols::XBeeTx& tx, Time now) {
    if (tx.data.size() > protocols::kMostMeshData) {
        ++counts_.too_long;
        if (tx.id != 0)
            to_host(protocols::XBeeTxStatus{tx.id, protocols::kXBeeUnknownNet, 0, radio::kTooLong, 0}, now);
        return;
    }
    ++counts_.sent;
    const std::uint16_t sequence = send(MeshKind::Data, tx.to, tx.options & 1u, tx.radius, tx.data, now);
    packets_[sequence] = {tx.id};
    add(now + kPatience, {TaskKind::PacketEnd, sequence});
}

void Module::radio_received(const cosim::RadioFrame& frame, Time now) {
    if (!up_ || asleep_) return;
    if (frame.duration == 0) {
        if (const auto fate = radio::decode_outcome(frame.octets.view())) outcome(*fate, now);
        return;
    }
    auto reading = protocols::decode_mesh(frame.octets.view());
    if (reading.fault != protocols::MeshFault::None) {
        ++counts_.bad_air.at(static_cast<std::size_t>(reading.fault));
        return;
    }
    last_dbm_ = static_cast<std::uint8_t>(std::clamp(-int{frame.dbm}, 0, 255));
    if (!reading.frame.broadcast() && reading.frame.target != options_.address) {
        ++counts_.not_for_us;
        return;
    }
    stay_awake(now);
    frame_received(reading.frame, now + options_.processing);
}

void Module::outcome(const radio::RadioOutcome& fate, Time now) {
    const auto packet = packets_.find(fate.sequence);
    if (packet == packets_.end()) return;
    Task task{TaskKind::Fate, fate.sequence};
    task.fate = fate;
    add(now + options_.processing, std::move(task));
}

void Module::fate(const radio::RadioOutcome& fate, Time now) {
    const auto packet = packets_.find(fate.sequence);
    if (packet == packets_.end()) return;
    ++counts_.fates[fate.delivery];
    counts_.retries += fate.retries;
    if (packet->second.id != 0)
        to_host(protocols::XBeeTxStatus{packet->second.id, protocols::kXBeeUnknownNet, fate.retries,
                                        fate.delivery, fate.discovery},
                now);
    packets_.erase(packet);
    schedule_input(now);
    update_cts(now);
}

void Module::frame_received(const MeshFrame& frame, Time at) {
    Task task{TaskKind::Heard, 0};
    task.frame = frame;
    add(at, std::move(task));
}

void Module::heard(const MeshFrame& frame, Time now) {
    switch (frame.kind) {
    case MeshKind::Data: {
        ++counts_.received;
        const std::uint8_t options = frame.broadcast() ? kWasBroadcast : kAcknowledged;
        if (command_mode_ && settings_[kAP] == 0)
            keep_for_later(frame.data);
        else if (settings_[kAP] != 0)
            to_host(protocols::XBeeRx{frame.origin, protocols::kXBeeUnknownNet, options, frame.data}, now);
        else if (!out_.put(frame.data, now))
            ++counts_.dropped_out;
        break;
    }
    case MeshKind::Discover:
        asked_to_show_itself(frame, now);
        break;
    case MeshKind::Discovered:
        discovered(frame, now);
        break;
    case MeshKind::RemoteAt:
        remote_at(frame, now);
        break;
    case MeshKind::RemoteAtAnswer:
        remote_answer(frame, now);
        break;
    default:
        break;  // of the network layer
    }
}

void Module::asked_to_show_itself(const MeshFrame& frame, Time now) {
    if (frame.data.size() < 2) return;
    const std::string wanted(frame.data.begin() + 2, frame.data.end());
    if (!wanted.empty() && wanted != settings_.node_identifier()) return;
    ++counts_.shown;
    Task task{TaskKind::Answer, 0};
    task.frame.kind = MeshKind::Discovered;
    task.frame.target = frame.origin;
    task.frame.data = {static_cast<std::uint8_t>(frame.sequence >> 8),
                       static_cast<std::uint8_t>(frame.sequence)};
    const std::string& identifier = settings_.node_identifier();
    task.frame.data.insert(task.frame.data.end(), identifier.begin(), identifier.end());
    // One that is asked by name answers at once; all others at a random time within NT.
    constexpr Time kUnit = 100 * cosim::kMillisecond;
    const Time most = static_cast<Time>(number_at(frame.data, 0)) * kUnit;
    const Time delay =
        wanted.empty() ? static_cast<Time>(discovery_random_.below(static_cast<std::uint64_t>(most) + 1)) : 0;
    add(now + delay, std::move(task));
}

XBeeBytes Module::description(std::uint64_t address, const std::string& identifier) const {
    constexpr std::uint8_t kRouter = 1;
    XBeeBytes value{0xFF, 0xFE};
    for (int shift = 56; shift >= 0; shift -= 8)
        value.push_back(static_cast<std::uint8_t>(address >> shift));
    value.insert(value.end(), identifier.begin(), identifier.end());
    // End of the name, parent, device type, status, profile C105, Digi's number 101E.
    constexpr std::array<std::uint8_t, 9> kRest{0x00, 0xFF, 0xFE, kRouter, 0x00, 0xC1, 0x05, 0x10, 0x1E};
    value.insert(value.end(), kRest.begin(), kRest.end());
    return value;
}

void Module::discovered(const MeshFrame& frame, Time now) {
    if (frame.data.size() < 2) return;
    const std::uint16_t sequence = number_at(frame.data, 0);
    const auto asked = std::find_if(discoveries_.begin(), discoveries_.end(),
                                    [&](const Discovery& one) { return one.sequence == sequence; });
    if (asked == discoveries_.end()) return;  // too late, or answered
    const std::string identifier(frame.data.begin() + 2, frame.data.end());
    const Discovery discovery = *asked;
    if (discovery.single) discoveries_.erase(asked);
    if (discovery.id == 0) return;
    if (discovery.text) {
        if (command_mode_) discovered_in_command_mode(discovery, frame.origin, identifier, now);
        return;
    }
    protocols::XBeeAtResponse response{
        discovery.id, {'N', 'D'}, kAtFromAir | kAtOk, description(frame.origin, identifier)};
    if (discovery.single) {
        response.command = {'D', 'N'};
        response.value.resize(10);  // FFFE and the address
    }
    to_host(response, now);
}

void Module::remote_at(const MeshFrame& frame, Time now) {
    constexpr std::size_t kHead = 4;
    constexpr std::uint8_t kApply = 2;
    if (frame.data.size() < kHead) return;
    const protocols::XBeeCommand command{static_cast<char>(frame.data[2]), static_cast<char>(frame.data[3])};
    const XBeeBytes value(frame.data.begin() + kHead, frame.data.end());
    const std::string name(command.begin(), command.end());
    // A module does not search on behalf of others.
    AtResult result{kAtError, {}, false};
    if (name != "ND" && name != "DN") result = at(command, value, 0, now);
    if (frame.data[1] & kApply) apply(now);
    if (frame.data[0] == 0) return;
    XBeeBytes data{static_cast<std::uint8_t>(frame.sequence >> 8), static_cast<std::uint8_t>(frame.sequence),
                   result.status};
    data.insert(data.end(), result.value.begin(), result.value.end());
    send(MeshKind::RemoteAtAnswer, frame.origin, 0, 0, std::move(data), now);
}

void Module::remote_answer(const MeshFrame& frame, Time now) {
    constexpr std::size_t kHead = 3;
    if (frame.data.size() < kHead) return;
    const auto remote = remotes_.find(number_at(frame.data, 0));
    if (remote == remotes_.end()) return;
    to_host(protocols::XBeeRemoteAtResponse{remote->second.id, frame.origin, protocols::kXBeeUnknownNet,
                                            remote->second.command, frame.data[2],
                                            XBeeBytes(frame.data.begin() + kHead, frame.data.end())},
            now);
    remotes_.erase(remote);
}

}  // namespace puckloop::xbee
