// What can happen to boards and their chips; emu/chip/faults carries it out.

#include "base/error.h"
#include "cosim/faults/kinds/kind_table.h"
#include "cosim/faults/spec/profile.h"

#include <fmt/format.h>

#include <string>
#include <utility>

namespace puckloop::cosim {

namespace {

constexpr double kLongestOfBoard = 1e6, kMostArrivals = 1e9, kMostPpm = 90'000.0,
                 kHighestChipAddress = 0xFFFFFF;
constexpr double kHighestBit = 23, kMostVolts = 10;
constexpr std::size_t kDigitsOfHash = 64;
// Inputs of the converters. The range-and-bearing board's peak detectors are at AN20 to AN31.
constexpr double kChannels = 16, kRabChannels = 32;

/// Kinds that happen at instants may wait for the program instead.
std::vector<ParameterInfo> at_program(std::vector<ParameterInfo> parameters) {
    parameters.push_back({.key = "pc", .unit = Unit::Text});
    parameters.push_back(
        {.key = "nth", .unit = Unit::Integer, .low = 1, .high = kMostArrivals, .fallback = 1});
    return parameters;
}

ParameterInfo number(std::string_view key, double low, double high) {
    return {.key = key, .unit = Unit::Number, .low = low, .high = high, .required = true};
}

std::vector<KindInfo> of_chip(PlaceKind place) {
    const bool avr = place == PlaceKind::Tam;
    const ParameterInfo duration{.key = "duration", .unit = Unit::Time, .low = 0, .high = kLongestOfBoard};
    const ParameterInfo channel{.key = "channel",
                                .unit = Unit::Integer,
                                .low = 0,
                                .high = (place == PlaceKind::Rab ? kRabChannels : kChannels) - 1,
                                .required = true};
    const ParameterInfo cause{.key = "cause",
                              .unit = Unit::Text,
                              .choices =
                                  avr ? "mclr|power_on|brown_out|watchdog"
                                      : "mclr|power_on|brown_out|watchdog|software|trap|illegal_opcode"};
    std::vector<KindInfo> kinds{
        {"reset", place, Style::Times, FaultKind::None, at_program({cause})},
        {"hang", place, Style::Times, FaultKind::None, at_program({duration})},
        {"brown_out", place, Style::Times, FaultKind::None, at_program({duration})},
        {"flip", place, Style::Times, FaultKind::None,
         at_program({{.key = "space", .unit = Unit::Text, .choices = "ram|register|flash|eeprom"},
                     {.key = "symbol", .unit = Unit::Text},
                     {.key = "address", .unit = Unit::Integer, .low = 0, .high = kHighestChipAddress},
                     {.key = "bit", .unit = Unit::Integer, .low = 0, .high = kHighestBit}})},
        {"flash",
         place,
         Style::Times,
         FaultKind::None,
         {{.key = "image", .unit = Unit::Text, .required = true},
          {.key = "sha256", .unit = Unit::Text},
          {.key = "source", .unit = Unit::Text}}},
        {"clock",
         place,
         Style::Hold,
         FaultKind::None,
         {{.key = "ppm", .unit = Unit::Number, .low = -kMostPpm, .high = kMostPpm, .fallback = 0.0},
          {.key = "drift", .unit = Unit::Number, .low = -kMostPpm, .high = kMostPpm, .fallback = 0.0}}},
        {"adc_stuck", place, Style::Each, FaultKind::None, {channel, number("value", 0, 1)}},
        {"adc_offset", place, Style::Each, FaultKind::None, {channel, number("value", -1, 1)}},
        {"adc_gain", place, Style::Each, FaultKind::None, {channel, number("factor", 0, 1000)}},
        {"adc_noise", place, Style::Each, FaultKind::None, {channel, number("sigma", 0, 1)}},
    };
    const ParameterInfo vector{.key = "vector", .unit = Unit::Text, .required = true};
    const ParameterInfo delay{
        .key = "delay", .unit = Unit::Time, .low = 0, .high = kLongestOfBoard, .required = true};
    const ParameterInfo jitter{
        .key = "jitter", .unit = Unit::Time, .low = 0, .high = kLongestOfBoard, .fallback = 0.0};
    kinds.push_back(
        {"interrupt", place, Style::Times, FaultKind::None, at_program({vector}), "spurious_interrupt"});
    kinds.push_back({"lost_interrupt", place, Style::Each, FaultKind::None, {vector}});
    kinds.push_back({"late_interrupt", place, Style::Each, FaultKind::None, {vector, delay, jitter}});
    kinds.push_back({"battery",
                     place,
                     Style::Hold,
                     FaultKind::None,
                     {{.key = "profile", .unit = Unit::Text, .required = true}}});
    kinds.push_back(
        {"sag",
         place,
         Style::Hold,
         FaultKind::None,
         {{.key = "volts", .unit = Unit::Voltage, .low = 0, .high = kMostVolts, .required = true}}});
    return kinds;
}

}  // namespace

std::vector<KindInfo> board_kinds() {
    std::vector<KindInfo> kinds;
    for (const PlaceKind place : {PlaceKind::Pic, PlaceKind::Rab, PlaceKind::Tam}) {
        std::vector<KindInfo> some = of_chip(place);
        kinds.insert(kinds.end(), some.begin(), some.end());
    }
    const auto part = [](std::string_view key, double parts = 12) {
        return ParameterInfo{.key = key, .unit = Unit::Integer, .low = 0, .high = parts, .fallback = 0.0};
    };
    for (const char* key : {"emitter", "receiver"})
        kinds.push_back({key == std::string_view("emitter") ? "emitter_dead" : "receiver_dead",
                         PlaceKind::Rab,
                         Style::Each,
                         FaultKind::None,
                         {part(key)}});
    kinds.push_back({"foreign_carrier", PlaceKind::Rab, Style::Hold, FaultKind::None, {part("receiver")}});
    const ParameterInfo motor{.key = "motor", .unit = Unit::Text, .choices = "left|right"};
    const ParameterInfo winding{
        .key = "winding", .unit = Unit::Integer, .low = 1, .high = 2, .fallback = 1.0};
    for (const auto& [place, sensors] : {std::pair{PlaceKind::Pic, 8.0}, std::pair{PlaceKind::Tam, 2.0}})
        kinds.push_back({"ambient_burst",
                         place,
                         Style::Hold,
                         FaultKind::None,
                         {part("sensor", sensors),
                          {.key = "strength", .unit = Unit::Ratio, .low = 0, .high = 1, .fallback = 1.0}}});
    kinds.push_back({"phase_open", PlaceKind::Pic, Style::Hold, FaultKind::None, {motor, winding}});
    kinds.push_back({"wheel_stall", PlaceKind::Pic, Style::Hold, FaultKind::None, {motor}});
    return kinds;
}

void check_board_fault(const FaultSpec& spec, const KindInfo& kind) {
    if (kind.name == "battery") voltage_profile(spec.parameters.text("profile"), kMostVolts);
    if (kind.name != "flash") return;
    if (spec.parameters.text("image").empty())
        throw InputError("", "image", "no file is named", "a firmware image");
    const std::string hash = spec.parameters.text("sha256");
    if (!hash.empty() &&
        (hash.size() != kDigitsOfHash || hash.find_first_not_of("0123456789abcdef") != hash.npos))
        throw InputError("", "sha256", fmt::format("'{}' is no SHA-256", hash),
                         "64 hexadecimal digits, lower-case");
}

}  // namespace puckloop::cosim
