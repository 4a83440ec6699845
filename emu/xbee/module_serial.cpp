// A module's serial line: bytes to frames or transparent packets, and what its host asks for.

#include "emu/xbee/module.h"

#include <algorithm>

namespace puckloop::xbee {

using cosim::Time;
using protocols::XBeeBytes;
using protocols::XBeeMessage;

namespace {

constexpr std::size_t kReceiveRoom = 255;  // FT reaches 17 bytes less
constexpr std::size_t kFtHysteresis = 16;
constexpr std::size_t kMostPackets = 4;
constexpr std::uint32_t kTransparentMode = 0;  // AP

}  // namespace

void Module::byte_received(std::uint8_t byte, Time at) {
    add(at, {TaskKind::Byte, byte});
}

void Module::byte(std::uint8_t value, Time now) {
    ++counts_.bytes_in;
    if (!up_) {
        ++counts_.while_down;
        return;
    }
    if (asleep_) {
        ++counts_.while_asleep;
        return;
    }
    stay_awake(now);
    if (settings_[kAP] == kTransparentMode || command_mode_) {
        if (command_mode_) return command_byte(value, now);
        if (guarded(value, now)) return;
        if (plain_.size() >= kReceiveRoom) {
            ++counts_.overflow;
            return;
        }
        plain_.push_back(value);
        ++last_byte_;
        const Time quiet = static_cast<Time>(settings_[kRO]) * SerialOut::kBits * receiver_bit();
        if (settings_[kRO] == 0 || plain_.size() >= protocols::kMostMeshData)
            add(now + options_.processing, {TaskKind::Packetize});
        else
            add(now + quiet, {TaskKind::Quiet, last_byte_});
        return;
    }
    if (waiting_bytes_ >= kReceiveRoom) {
        ++counts_.overflow;
        return;
    }
    api_byte(value, now);
    update_cts(now);
}

void Module::api_byte(std::uint8_t value, Time now) {
    ++partial_bytes_;
    const auto reading = reader_.take(value);
    if (!reading) {
        if (reader_.idle()) ++counts_.between_frames;
        return;
    }
    if (!reading->ok()) {
        ++counts_.bad_frames.at(static_cast<std::size_t>(reading->fault));
        // A delimiter that ended one frame began the next.
        partial_bytes_ = value == protocols::kXBeeStart ? 1 : 0;
        return;
    }
    ++counts_.frames_in;
    waiting_.emplace_back(protocols::decode_xbee(reading->data), partial_bytes_);
    waiting_bytes_ += partial_bytes_;
    partial_bytes_ = 0;
    schedule_input(now);
}

void Module::schedule_input(Time now) {
    if (input_scheduled_ || waiting_.empty() || packets_.size() >= kMostPackets) return;
    input_scheduled_ = true;
    add(now + options_.processing, {TaskKind::Input});
}

void Module::update_cts(Time now) {
    if (settings_[kD7] != 1 || asleep_) return;
    const std::size_t threshold = settings_[kFT];
    const bool level = cts_ ? waiting_bytes_ + kFtHysteresis >= threshold : waiting_bytes_ >= threshold;
    if (level != cts_) air_.cts_changed(cts_ = level, now);
}

void Module::packetize(Time now) {
    if (plain_.empty()) return;
    if (packets_.size() >= kMostPackets) {
        // As much as the buffer holds waits.
        add(now + options_.processing, {TaskKind::Packetize});
        return;
    }
    const std::size_t size = std::min(plain_.size(), protocols::kMostMeshData);
    protocols::XBeeTx tx;
    tx.id = 0;
    tx.to = settings_.destination();
    tx.data.assign(plain_.begin(), plain_.begin() + static_cast<std::ptrdiff_t>(size));
    plain_.erase(plain_.begin(), plain_.begin() + static_cast<std::ptrdiff_t>(size));
    transmit(tx, now);
    if (!plain_.empty()) add(now + options_.processing, {TaskKind::Packetize});
}

bool Module::to_host(const XBeeMessage& message, Time now) {
    if (settings_[kAP] == kTransparentMode) return false;
    const bool fits = out_.put(protocols::encode_xbee(protocols::encode(message), api_mode()), now);
    ++(fits ? counts_.frames_out : counts_.dropped_out);
    return fits;
}

void Module::handle(const XBeeMessage& message, Time now) {
    using namespace protocols;
    const auto answer = [&](const auto& request) {
        AtResult result = at(request.command, request.value, request.id, now);
        if (request.id != 0 && !result.answered_later)
            to_host(XBeeAtResponse{request.id, request.command, result.status, std::move(result.value)}, now);
    };
    if (const auto* command = std::get_if<XBeeAt>(&message)) {
        answer(*command);
        // In force once the answer is on its way, so that it still comes as the host expects it.
        apply(now);
    } else if (const auto* later = std::get_if<XBeeQueuedAt>(&message)) {
        answer(*later);
    } else if (const auto* tx = std::get_if<XBeeTx>(&message)) {
        transmit(*tx, now);
    } else if (const auto* remote = std::get_if<XBeeRemoteAt>(&message)) {
        XBeeBytes data{remote->id, remote->options};
        data.insert(data.end(), remote->command.begin(), remote->command.end());
        data.insert(data.end(), remote->value.begin(), remote->value.end());
        const std::uint16_t sequence = send(MeshKind::RemoteAt, remote->to, 0, 0, std::move(data), now);
        if (remote->id != 0) {
            remotes_[sequence] = {remote->id, remote->to, remote->command};
            // Longer than the network layer tries.
            constexpr Time kPatience = 10 * cosim::kSecond;
            add(now + kPatience, {TaskKind::RemoteEnd, sequence});
        }
    } else {
        ++counts_.odd_frames;
    }
}

}  // namespace puckloop::xbee
