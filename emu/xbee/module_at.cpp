// The AT commands of a module. Source: XBee/XBee-PRO DigiMesh 2.4 manual (90000991 W), "AT commands".

#include "emu/xbee/module.h"

#include <algorithm>

namespace puckloop::xbee {

using cosim::Time;
using protocols::XBeeBytes;

namespace {

constexpr std::size_t kMostUnknownNames = 32;  // counted by name; the rest together
constexpr Time kBeforeRestart = 100 * cosim::kMillisecond;

XBeeBytes octets_of(std::uint64_t number, int count) {
    XBeeBytes octets;
    for (int shift = 8 * (count - 1); shift >= 0; shift -= 8)
        octets.push_back(static_cast<std::uint8_t>(number >> shift));
    return octets;
}

}  // namespace

Module::AtResult Module::at(const protocols::XBeeCommand& name, const XBeeBytes& value, std::uint8_t id,
                            Time now) {
    ++counts_.at_commands;
    const std::string command(name.begin(), name.end());
    bool known = true;
    AtResult result = act(command, value, id, now, known);
    if (known) return result;
    if (command == "NI") {
        if (value.empty())
            result.value.assign(settings_.node_identifier().begin(), settings_.node_identifier().end());
        else
            result.status = settings_.write_identifier(value);
    } else if (const auto place = find_parameter(command)) {
        if (value.empty())
            result.value = settings_.read(*place, command_mode_);
        else
            result.status = settings_.write(*place, value);
        constexpr std::uint8_t kFirstSynchronised = 7;
        if (*place == kSM && !value.empty() && value.back() >= kFirstSynchronised && result.status == kAtOk)
            ++counts_.without_effect;
    } else {
        const bool room =
            counts_.unknown_at.size() < kMostUnknownNames || counts_.unknown_at.contains(command);
        const bool printable =
            std::all_of(command.begin(), command.end(), [](char c) { return c > ' ' && c < 0x7F; });
        ++counts_.unknown_at[room && printable ? command : "others"];
        result.status = kAtUnknown;
    }
    if (result.status == kAtBadValue) ++counts_.bad_values;
    return result;
}

Module::AtResult Module::act(const std::string& command, const XBeeBytes& value, std::uint8_t id, Time now,
                             bool& known) {
    AtResult result;
    if (command == "SH" || command == "SL") {
        if (value.empty())
            result.value = octets_of(command == "SH" ? options_.address >> 32 : options_.address, 4);
        else
            result.status = kAtBadValue;
    } else if (command == "DB") {
        result.value = {last_dbm_};
    } else if (command == "%V") {
        result.value = octets_of(3300, 2);  // mV
    } else if (command == "N?") {
        result.value = octets_of(std::uint64_t{settings_[kNT]} * 100, 4);  // ms
    } else if (command == "WR") {
        apply(now);
        settings_.save();
    } else if (command == "RE") {
        settings_.restore();
    } else if (command == "AC" || command == "CN") {
        apply(now);
    } else if (command == "FR") {
        add(now + kBeforeRestart, {TaskKind::Restart});
    } else if (command == "ND") {
        discover(false, value, id, now);
        result.answered_later = true;
    } else if (command == "DN") {
        if (value.empty() || value.size() > kMostNodeIdentifier) {
            result.status = kAtError;
        } else {
            discover(true, value, id, now);
            result.answered_later = true;
        }
    } else {
        known = false;
    }
    return result;
}

void Module::discover(bool single, const XBeeBytes& identifier, std::uint8_t id, Time now) {
    ++counts_.discoveries;
    XBeeBytes data = octets_of(settings_[kNT], 2);
    data.insert(data.end(), identifier.begin(), identifier.end());
    const std::uint16_t sequence =
        send(protocols::MeshKind::Discover, protocols::kXBeeBroadcast, 0, 0, std::move(data), now);
    discoveries_.push_back({sequence, id, single, command_mode_});
    constexpr Time kUnit = 100 * cosim::kMillisecond;
    add(now + static_cast<Time>(settings_[kNT]) * kUnit, {TaskKind::DiscoveryEnd, sequence});
    // NO, bit 1: the module shows itself as well.
    if (!single && (settings_[kNO] & 2) != 0 && id != 0 && !command_mode_)
        to_host(
            protocols::XBeeAtResponse{
                id, {'N', 'D'}, kAtOk, description(options_.address, settings_.node_identifier())},
            now);
}

}  // namespace puckloop::xbee
