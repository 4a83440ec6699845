#include "emu/bluetooth/module.h"

#include <algorithm>
#include <initializer_list>
#include <utility>

namespace puckloop::bluetooth {

using cosim::Time;
using protocols::LmxPacket;

namespace {

constexpr Time kSlot = 625 * cosim::kMicrosecond;
// ACL errors in indications 50 and 51: page timeout, connection timeout, ended there, ended here.
constexpr std::uint8_t kPageTimeout = 0x04, kConnectionTimeout = 0x08, kEndedThere = 0x13, kEndedHere = 0x16;
constexpr std::string_view kVersion = "0618";
constexpr int kAttempts = 3;  // at a stored connection, data sheet 10.1.1

Bytes joined(std::initializer_list<Bytes> parts) {
    Bytes all;
    for (const Bytes& part : parts)
        all.insert(all.end(), part.begin(), part.end());
    return all;
}

Bytes octets(const Address& address) {
    return {address.begin(), address.end()};
}

}  // namespace

Module::Module(const ModuleOptions& options, Network& network)
    : options_(options), settings_(options.settings), network_(network), number_(network.add(*this)) {
    wait(options_.start + options_.boot, EventKind::Boot);
}

void Module::wait(Time at, EventKind kind, Bytes bytes) {
    network_.agenda().add(at, {kind, number_, number_, 0, turn_, std::move(bytes)});
}

void Module::happen(const Event& event, Time now) {
    if (event.turn != turn_) return;
    if (event.kind == EventKind::Boot) boot(now);
    if (event.kind == EventKind::Request) request(event.bytes, now);
    if (event.kind == EventKind::Flush) flush(now);
    if (event.kind == EventKind::Left) indicate(0x11, {event.bytes.at(0), 0}, now);
    if (event.kind == EventKind::SpeedTaken) serial_.set(line_ = settings_.serial);
    if (event.kind != EventKind::Dial) return;
    const std::uint8_t port = event.bytes.at(0);
    if (const auto open = links_.find(port); open != links_.end() && open->second.link == 0)
        network_.connect(number_, open->second.peer, port, open->second.remote_port, now);
}

void Module::boot(Time now) {
    up_ = true;
    line_ = settings_.serial;
    serial_.set(line_);
    reader_.clear();
    Bytes version{static_cast<std::uint8_t>(kVersion.size())};
    version.insert(version.end(), kVersion.begin(), kVersion.end());
    indicate(0x25, version, now);
    if (!settings_.automatic) return;
    for (const DefaultConnection& stored : settings_.defaults)
        dial(stored, now);
}

void Module::dial(const DefaultConnection& stored, Time now) {
    if (links_.contains(stored.port)) return;
    links_[stored.port] = {0, stored.address, stored.remote_port, stored.transparent, kAttempts};
    network_.connect(number_, stored.address, stored.port, stored.remote_port, now);
}

void Module::restart(Time now) {
    ++counts_.resets;
    ++turn_;
    network_.gone(number_, now);
    up_ = inquiring_ = false;
    discoverable_ = connectable_ = true;
    links_.clear();
    transparent_ = 0;
    gathered_.clear();
    wait(now + options_.boot, EventKind::Boot);
}

void Module::byte_received(std::uint8_t byte, Time now) {
    ++counts_.bytes_in;
    if (!up_) {
        ++counts_.while_down;
        return;
    }
    if (transparent_ != 0) {
        ++counts_.transparent_in;
        if (gathered_.empty()) wait(now + network_.times().gather, EventKind::Flush);
        gathered_.push_back(byte);
        return;
    }
    const auto reading = reader_.take(byte);
    if (!reading) {
        if (reader_.idle()) ++counts_.between_packets;
        return;
    }
    if (!reading->ok()) {
        ++counts_.bad_packets[std::string(protocols::to_text(reading->fault))];
        return;
    }
    const LmxPacket& packet = reading->packet;
    if (packet.type != protocols::kLmxRequest) {
        ++counts_.bad_packets["no request"];
        return;
    }
    wait(now + options_.processing, EventKind::Request, joined({{packet.opcode}, packet.data}));
}

void Module::break_received(Time now) {
    if (!up_) return;
    if (transparent_ == 0) {
        reader_.clear();
        return;
    }
    flush(now);
    const std::uint8_t port = transparent_;
    transparent_ = 0;
    wait(now + options_.processing, EventKind::Left, {port});
}

void Module::flush(Time now) {
    if (gathered_.empty() || transparent_ == 0) return;
    network_.send(number_, links_.at(transparent_).link, std::exchange(gathered_, {}), now);
}

void Module::confirm(std::uint8_t opcode, const Bytes& data, Time now) {
    if (!data.empty() && data[0] != 0) ++counts_.errors[protocols::lmx_error_name(data[0])];
    if (settings_.event_filter >= 2) return;
    serial_.put(protocols::encode_lmx({protocols::kLmxConfirm, opcode, data}), now);
}

void Module::indicate(std::uint8_t opcode, const Bytes& data, Time now) {
    if (settings_.event_filter >= 2 || transparent_ != 0) return;
    serial_.put(protocols::encode_lmx({protocols::kLmxIndication, opcode, data}), now);
}

std::string Module::friendly_name() const {
    return settings_.name;
}

std::uint8_t Module::port_state(std::uint8_t port) const {
    if (port < 1 || port > kPorts || ((settings_.ports_open >> (port - 1)) & 1u) == 0)
        return kRfcommInvalidPort;
    return links_.contains(port) || links_.size() >= kMostLinks ? kRfcommFailed : kRfcommOk;
}

bool Module::has_key(const Address& peer) const {
    return std::find(settings_.paired.begin(), settings_.paired.end(), peer) != settings_.paired.end();
}

void Module::keep_key(const Address& peer) {
    if (has_key(peer)) return;
    if (settings_.paired.size() >= kMostPaired) settings_.paired.erase(settings_.paired.begin());
    settings_.paired.push_back(peer);
}

Time Module::link_timeout() const {
    return settings_.link_timeout == 0 ? cosim::kNever : settings_.link_timeout * kSlot;
}

void Module::found(const Address& address, const DeviceClass& device_class, Time now) {
    indicate(0x01, joined({octets(address), {device_class.begin(), device_class.end()}}), now);
}

void Module::inquiry_over(Time now) {
    inquiring_ = false;
    if (transparent_ == 0) confirm(0x00, {kOk}, now);
}

void Module::named(const Address& address, const std::optional<std::string>& name, Time now) {
    if (transparent_ != 0) return;
    Bytes text{static_cast<std::uint8_t>(name ? std::min(name->size(), kMostName) : 0)};
    if (name) text.insert(text.end(), name->begin(), name->begin() + text[0]);
    confirm(0x02, joined({{name ? kOk : kTimeout}, octets(address), text}), now);
}

void Module::linked(const Address& peer, std::uint8_t port, std::uint8_t remote_port, std::uint8_t status,
                    LinkId link, Time now) {
    Open& open = links_[port];
    if (settings_.event_filter == 0)
        indicate(0x50, joined({octets(peer), {status == kRfcommNobody ? kPageTimeout : kOk}}), now);
    indicate(0x0B, joined({{status}, octets(peer), {port, remote_port}}), now);
    open.link = link;
    if (link != 0) {
        if (open.transparent && links_.size() == 1) transparent_ = port;
        return;
    }
    if (--open.attempts <= 0)
        links_.erase(port);
    else
        wait(now + options_.processing, EventKind::Dial, {port});
}

void Module::incoming(const Address& peer, std::uint8_t port, LinkId link, Time now) {
    links_[port] = {link, peer};
    if (settings_.event_filter == 0) indicate(0x50, joined({octets(peer), {kOk}}), now);
    indicate(0x0C, joined({octets(peer), {port}}), now);
    if (settings_.automatic && links_.size() == 1) transparent_ = port;
}

std::uint8_t Module::port_of(LinkId link) const {
    for (const auto& [port, open] : links_)
        if (open.link == link) return port;
    return 0;
}

void Module::received(LinkId link, const Bytes& bytes, Time now) {
    const std::uint8_t port = port_of(link);
    if (port == 0) return;
    if (transparent_ == port) {
        counts_.transparent_out += bytes.size();
        serial_.put(bytes, now);
        return;
    }
    for (std::size_t at = 0; at < bytes.size(); at += kMostPayload) {
        const std::size_t size = std::min(kMostPayload, bytes.size() - at);
        const auto first = bytes.begin() + static_cast<std::ptrdiff_t>(at);
        indicate(0x10,
                 joined({{port, static_cast<std::uint8_t>(size & 0xff), static_cast<std::uint8_t>(size >> 8)},
                         {first, first + static_cast<std::ptrdiff_t>(size)}}),
                 now);
    }
}

void Module::released(LinkId link, std::uint8_t reason, Time now) {
    const std::uint8_t port = port_of(link);
    if (port == 0) return;
    const Address peer = links_[port].peer;
    links_.erase(port);
    const bool was_transparent = transparent_ == port;
    if (was_transparent) {
        transparent_ = 0;
        gathered_.clear();
        if (settings_.event_filter != 3) serial_.put_break(now);
    }
    indicate(0x0E, {reason, port}, now);
    if (was_transparent) indicate(0x11, {port, 0}, now);
    if (settings_.event_filter != 0) return;
    const std::uint8_t why =
        reason == kLinkLost ? kConnectionTimeout : (reason == kReleasedHere ? kEndedHere : kEndedThere);
    indicate(0x51, joined({octets(peer), {why}}), now);
}

}  // namespace puckloop::bluetooth
