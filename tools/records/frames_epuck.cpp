// puckloop frames epuck: the serial records between the e-puck's Linux board and its dsPIC, as hexadecimal
// bytes.

#include "base/error.h"
#include "base/json.h"
#include "protocols/serial/epuck_serial.h"
#include "tools/cli/command.h"
#include "tools/records/frames.h"

#include <fmt/format.h>

#include <cmath>
#include <iostream>
#include <limits>
#include <memory>
#include <span>

namespace puckloop::tools {

namespace {

using nlohmann::ordered_json;
using namespace protocols;

constexpr char kLengths[] = "12 bytes (actuators), 72 (sensors) or 4 (configuration)";

struct ActuatorArguments {
    std::string left = "0";
    std::string right = "0";
    std::string rab_data = "0";
    std::string ring_leds = "0";
    std::string other_leds = "0";
    std::string ircom_enabled = "0";
    std::string ircom_data = "0";
    std::string reset = "N";
};

template <typename Number>
Number number(const std::string& text, const char* option) {
    using Limits = std::numeric_limits<Number>;
    const bool hexadecimal = text.starts_with("0x") || text.starts_with("0X");
    return static_cast<Number>(
        parse_number(text, hexadecimal ? 16 : 10, Limits::min(), Limits::max(), "", option));
}

std::uint8_t reset_byte(const std::string& text) {
    if (text == "N") return kEpuckContinue;
    if (text == "R") return kEpuckEnd;
    throw InputError("", "--reset", fmt::format("{} is neither", shown(text)), "N (go on) or R (end)");
}

/// The shortest decimal that reads back as the same float; null if it is no number.
ordered_json decimal(float value) {
    if (!std::isfinite(value)) return nullptr;
    return std::stod(fmt::format("{}", value));
}

ordered_json fields_of(const EpuckConfiguration& c) {
    return {{"record", "configuration"},
            {"rab_range", c.rab_range},
            {"rab_enabled", c.rab_enabled},
            {"padding", c.padding}};
}

ordered_json fields_of(const EpuckActuators& a) {
    return {{"record", "actuators"},
            {"left", a.left},
            {"right", a.right},
            {"rab_data", a.rab_data},
            {"ring_leds", a.ring_leds},
            {"other_leds", a.other_leds},
            {"ircom_enabled", a.ircom_enabled},
            {"ircom_data", a.ircom_data},
            {"reset", a.reset},
            {"padding", a.padding}};
}

ordered_json fields_of(const EpuckSensors& s) {
    ordered_json fields = {{"record", "sensors"},
                           {"rab_data", s.rab_data},
                           {"rab_range", s.rab_range},
                           {"rab_bearing", decimal(s.rab_bearing)},
                           {"proximity", s.proximity},
                           {"battery_ok", s.battery_ok},
                           {"accelerometer", s.accelerometer},
                           {"microphones", s.microphones},
                           {"light", s.light},
                           {"rab_received", s.rab_received},
                           {"ircom_received", s.ircom_received},
                           {"ircom_data", s.ircom_data},
                           {"padding", s.padding},
                           {"ircom_sensor", s.ircom_sensor},
                           {"ircom_range", decimal(s.ircom_range)},
                           {"ircom_bearing", decimal(s.ircom_bearing)}};
    const std::string_view why = why_implausible(s);
    fields["plausible"] = why.empty();
    if (!why.empty()) fields["problem"] = why;
    return fields;
}

ordered_json read_epuck(const std::string& text, const std::string& origin) {
    const std::vector<std::uint8_t> bytes = bytes_of(text, origin);
    const std::span all(bytes);
    switch (bytes.size()) {
    case kEpuckConfigurationBytes:
        return fields_of(decode_configuration(all.first<kEpuckConfigurationBytes>()));
    case kEpuckActuatorBytes:
        return fields_of(decode_actuators(all.first<kEpuckActuatorBytes>()));
    case kEpuckSensorBytes:
        return fields_of(decode_sensors(all.first<kEpuckSensorBytes>()));
    default:
        throw InputError(origin, "record", fmt::format("{} bytes are no record", bytes.size()), kLengths);
    }
}

std::string as_text(const ordered_json& fields) {
    std::string text;
    for (const auto& [name, value] : fields.items()) {
        text += fmt::format("{:<16}", name);
        if (value.is_array())
            for (const ordered_json& one : value)
                text += ' ' + one.dump();
        else
            text += ' ' + (value.is_string() ? value.get<std::string>() : value.dump());
        text += '\n';
    }
    return text;
}

void decode(const std::vector<std::string>& words, bool json) {
    // Bytes may come as words of their own: together they are one record.
    std::vector<std::string> records;
    if (!words.empty()) records.emplace_back(fmt::format("{}", fmt::join(words, " ")));
    bool first = true;
    for_each_input(records, [&](const std::string& text, const std::string& origin) {
        const ordered_json fields = read_epuck(text, origin);
        std::cout << (json ? fields.dump() + "\n" : (first ? "" : "\n") + as_text(fields));
        first = false;
    });
}

void encode_actuators(const ActuatorArguments& arguments) {
    EpuckActuators record;
    record.left = number<std::int16_t>(arguments.left, "--left");
    record.right = number<std::int16_t>(arguments.right, "--right");
    record.rab_data = number<std::uint16_t>(arguments.rab_data, "--rab-data");
    record.ring_leds = number<std::uint8_t>(arguments.ring_leds, "--ring-leds");
    record.other_leds = number<std::uint8_t>(arguments.other_leds, "--other-leds");
    record.ircom_enabled = number<std::uint8_t>(arguments.ircom_enabled, "--ircom-enabled");
    record.ircom_data = number<std::uint8_t>(arguments.ircom_data, "--ircom-data");
    record.reset = reset_byte(arguments.reset);
    std::cout << fmt::format("{:02X}\n", fmt::join(encode(record), ""));
}

void declare_encode(Command& epuck, int& status) {
    auto arguments = std::make_shared<ActuatorArguments>();
    Command* command =
        epuck.add_subcommand("encode", "Print an actuator record, 12 bytes (numbers decimal, or 0x...)");
    command->add_option("--left", arguments->left, "left wheel, steps/s");
    command->add_option("--right", arguments->right, "right wheel, steps/s");
    command->add_option("--rab-data", arguments->rab_data, "0 to 65535");
    command->add_option("--ring-leds", arguments->ring_leds, "bit i = LED i, 0 in front, then clockwise");
    command->add_option("--other-leds", arguments->other_leds, "bit 0 front LED, bit 1 body LED");
    command->add_option("--ircom-enabled", arguments->ircom_enabled, "0 to 255");
    command->add_option("--ircom-data", arguments->ircom_data, "0 to 255");
    command->add_option("--reset", arguments->reset, "N: go on (default), R: end the session");
    command->callback([arguments, &status] {
        encode_actuators(*arguments);
        flush_output();
        status = 0;
    });
}

}  // namespace

void declare_epuck_frames(Command& frames, int& status) {
    Command* epuck = frames.add_subcommand("epuck", "Serial records between Linux board and main board");
    epuck->require_subcommand(1);
    declare_encode(*epuck, status);
    auto words = std::make_shared<std::vector<std::string>>();
    auto json = std::make_shared<bool>(false);
    Command* command = epuck->add_subcommand("decode", "Name the fields of a record of 12, 72 or 4 bytes");
    command->add_option("BYTES", *words, "hexadecimal; without it, one record a line on standard input");
    declare_action(*command, *json, [words, json, &status] {
        decode(*words, *json);
        status = 0;
    });
}

}  // namespace puckloop::tools
