// Command mode: a host that speaks no API frames sends "+++" between two silences, then lines of AT commands.
// Source: XBee/XBee-PRO DigiMesh 2.4 manual (90000991), "Command mode", CC, CT, GT, CN.

#include "emu/xbee/module.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>

namespace puckloop::xbee {

using cosim::kMillisecond;
using cosim::Time;
using protocols::XBeeBytes;

namespace {

constexpr std::size_t kLongestLine = 255;
constexpr int kSequence = 3;  // characters
constexpr std::string_view kOk = "OK\r", kError = "ERROR\r";

/// Commands whose argument is text.
bool takes_text(std::string_view command) {
    return command == "NI" || command == "ND" || command == "DN";
}

/// A number without leading zeros.
std::string hexadecimal(const XBeeBytes& value) {
    std::string text;
    for (const std::uint8_t octet : value)
        text += fmt::format("{:02X}", octet);
    text.erase(0, std::min(text.find_first_not_of('0'), text.size() - 1));
    return text;
}

std::optional<XBeeBytes> octets_of(std::string_view digits) {
    std::uint64_t number = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number, 16);
    if (error != std::errc() || end != digits.data() + digits.size()) return std::nullopt;
    XBeeBytes octets;
    for (int shift = 56; shift >= 0; shift -= 8)
        if (const auto octet = static_cast<std::uint8_t>(number >> shift);
            octet != 0 || !octets.empty() || shift == 0)
            octets.push_back(octet);
    return octets;
}

}  // namespace

void Module::text_to_host(std::string_view text, Time now) {
    const XBeeBytes bytes(text.begin(), text.end());
    if (!out_.put(bytes, now)) ++counts_.dropped_out;
}

/// True if the byte may belong to "+++" and must wait.
bool Module::guarded(std::uint8_t value, Time now) {
    const Time begun = now - SerialOut::kBits * receiver_bit();
    const Time guard = static_cast<Time>(settings_[kGT]) * kMillisecond;
    const bool silence = begun - last_byte_at_ >= guard;
    last_byte_at_ = now;
    const bool own = value == settings_[kCC] && (plus_ == 0 ? silence : !silence && plus_ < kSequence);
    if (!own) {
        plain_.insert(plain_.end(), static_cast<std::size_t>(plus_),
                      static_cast<std::uint8_t>(settings_[kCC]));
        plus_ = 0;
        return false;
    }
    ++plus_;
    ++last_byte_;
    add(now + std::max(guard, options_.processing), {TaskKind::Guard, last_byte_});
    return true;
}

/// The silence after what may be "+++".
void Module::guard_over(Time now) {
    const int count = std::exchange(plus_, 0);
    if (count < kSequence) {
        plain_.insert(plain_.end(), static_cast<std::size_t>(count),
                      static_cast<std::uint8_t>(settings_[kCC]));
        packetize(now);
        return;
    }
    ++counts_.command_modes;
    command_mode_ = true;
    line_.clear();
    text_to_host(kOk, now);
    stay_in_command_mode(now);
}

void Module::stay_in_command_mode(Time now) {
    constexpr Time kUnit = 100 * kMillisecond;
    add(now + static_cast<Time>(settings_[kCT]) * kUnit, {TaskKind::CommandTimeout, ++command_turn_});
}

void Module::leave_command_mode(Time now) {
    if (!command_mode_) return;
    command_mode_ = false;
    last_byte_at_ = now;
    apply(now);
    for (const XBeeBytes& packet : std::exchange(heard_meanwhile_, {}))
        if (!out_.put(packet, now)) ++counts_.dropped_out;
}

void Module::keep_for_later(const XBeeBytes& data) {
    std::size_t kept = 0;
    for (const XBeeBytes& packet : heard_meanwhile_)
        kept += packet.size();
    if (kept + data.size() <= SerialOut::kRoom)
        heard_meanwhile_.push_back(data);
    else
        ++counts_.dropped_out;
}

void Module::command_byte(std::uint8_t value, Time now) {
    if (value == '\r') {
        lines_.push_back(std::exchange(line_, {}));
        add(now + options_.processing, {TaskKind::CommandLine});
    } else if (value == '\n') {
        // Of terminals that send both.
    } else if (line_.size() < kLongestLine) {
        line_ += static_cast<char>(value);
    } else {
        ++counts_.overflow;
    }
}

/// "ATNI TAM07", "atch", "ATDL 1234,WR,CN".
void Module::command_line(const std::string& line, Time now) {
    if (!command_mode_) return;
    const auto is_at = [](char given, char wanted) {
        return std::toupper(static_cast<unsigned char>(given)) == wanted;
    };
    if (line.size() < 2 || !is_at(line[0], 'A') || !is_at(line[1], 'T')) {
        if (!line.empty()) text_to_host(kError, now);
        return;
    }
    stay_in_command_mode(now);
    if (line.size() == 2) text_to_host(kOk, now);
    for (std::size_t at = 2; command_mode_ && at < line.size();) {
        const std::size_t comma = std::min(line.find(',', at), line.size());
        command(std::string_view(line).substr(at, comma - at), now);
        at = comma + 1;
    }
}

void Module::command(std::string_view words, Time now) {
    while (words.starts_with(' '))
        words.remove_prefix(1);
    if (words.size() < 2) return text_to_host(kError, now);
    std::string name(words.substr(0, 2));
    for (char& letter : name)
        letter = static_cast<char>(std::toupper(static_cast<unsigned char>(letter)));
    words.remove_prefix(2);
    while (words.starts_with(' '))
        words.remove_prefix(1);
    std::optional<XBeeBytes> value = XBeeBytes(words.begin(), words.end());
    if (!takes_text(name) && !words.empty()) value = octets_of(words);
    if (!value) {
        ++counts_.bad_values;
        return text_to_host(kError, now);
    }
    if (name == "CN") {
        text_to_host(kOk, now);
        ++counts_.at_commands;
        return leave_command_mode(now);
    }
    constexpr std::uint8_t kAsked = 1;
    const AtResult result = at({name[0], name[1]}, *value, kAsked, now);
    if (result.answered_later) return;
    if (result.status != kAtOk)
        text_to_host(kError, now);
    else if (result.value.empty())
        text_to_host(kOk, now);
    else if (name == "NI")
        text_to_host(std::string(result.value.begin(), result.value.end()) + "\r", now);
    else
        text_to_host(hexadecimal(result.value) + "\r", now);
}

/// An answer to ND, a line each; to DN, which ends command mode with the new destination in force.
void Module::discovered_in_command_mode(const Discovery& discovery, std::uint64_t address,
                                        const std::string& identifier, Time now) {
    if (discovery.single) {
        settings_.write_destination(address);
        text_to_host(kOk, now);
        leave_command_mode(now);
        return;
    }
    // MY, SH, SL, NI, parent, device type, status, profile, manufacturer, an empty line.
    text_to_host(fmt::format("FFFE\r{:X}\r{:X}\r{}\rFFFE\r01\r00\rC105\r101E\r\r", address >> 32,
                             address & 0xFFFFFFFF, identifier),
                 now);
}

/// The time of ND or DN is over.
void Module::discovery_over_in_command_mode(const Discovery& discovery, Time now) {
    if (command_mode_) text_to_host(discovery.single ? kError : std::string_view("\r"), now);
}

}  // namespace puckloop::xbee
