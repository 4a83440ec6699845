// What can happen in the air between radio modules (carried out by emu/radio) and to words of IRcom's light
// (physics/ircom). What happens between one module and its air is in radio.cpp.

#include "cosim/faults/kinds/kind_table.h"

namespace puckloop::cosim {

namespace {

constexpr double kLongestOnAir = 10.0;  // s

ParameterInfo time(std::string_view key, double low, double high, double fallback) {
    return {key, Unit::Time, low, high, fallback};
}
ParameterInfo whole(std::string_view key, double low, double high) {
    return {key, Unit::Integer, low, high};
}
ParameterInfo whole(std::string_view key, double low, double high, double fallback) {
    return {key, Unit::Integer, low, high, fallback};
}
ParameterInfo receiver() {
    return {"to", Unit::Text};
}

}  // namespace

std::vector<KindInfo> xbee_kinds() {
    const ParameterInfo frame{"frame",
                              Unit::Text,
                              0,
                              0,
                              {},
                              false,
                              "any|data|acknowledge|route_request|route_reply|discover|discovered|remote_at|"
                              "remote_at_answer|mac_ack"};
    constexpr double kMostBits = 8 * 127, kFirstChannel = 11, kLastChannel = 26, kFactoryChannel = 12;
    constexpr double kShortestFrame = 352e-6, kLongestFrame = 4.256e-3;  // s: an acknowledgement; 127 octets
    return {
        {"loss", PlaceKind::Xbee, Style::Each, FaultKind::None, {receiver(), frame}, "drop"},
        {"corrupt",
         PlaceKind::Xbee,
         Style::Each,
         FaultKind::None,
         {receiver(), frame, whole("bits", 1, kMostBits, 1)},
         "flip"},
        {"clash",
         PlaceKind::Xbee,
         Style::Hold,
         FaultKind::None,
         {receiver(),
          whole("channel", kFirstChannel, kLastChannel, kFactoryChannel),
          {"dbm", Unit::Number, -100, 20, -50.0},
          {"load", Unit::Ratio, 0.001, 1, 0.5},
          time("length", kShortestFrame, kLongestOnAir, kLongestFrame)}},
    };
}

std::vector<KindInfo> ircom_kinds() {
    const auto kind = [](std::string_view name, std::vector<ParameterInfo> parameters,
                         std::string_view alias = {}) {
        parameters.push_back(receiver());
        return KindInfo{name, PlaceKind::Ircom, Style::Each, FaultKind::None, std::move(parameters), alias};
    };
    // A word has 80 to 120 half periods, 20 of which begin it; eight bits and two of check.
    constexpr double kFirstHalf = 20, kLastHalf = 119, kBits = 10;
    constexpr double kAfterWord = 0.04;  // s: behind a word of 32 ms, the receivers at rest
    constexpr double kHalfPeriod = 260e-6;
    return {
        kind("loss", {}, "drop"),
        kind("corrupt", {whole("halves", 1, kLastHalf, 1), whole("position", kFirstHalf, kLastHalf)}),
        kind("flip", {whole("bits", 1, kBits, 1), whole("bit", 0, kBits - 1)}),
        kind("jitter", {{"jitter", Unit::Time, 1e-6, kHalfPeriod, {}, true}}),
        kind("delay", {{"delay", Unit::Time, kAfterWord, kLongestOnAir, {}, true}}),
        kind("duplicate", {time("delay", kAfterWord, kLongestOnAir, kAfterWord)}),
        kind("swap", {}, "reorder"),
        kind("clash", {{"value", Unit::Byte, 0, 255}}),
    };
}

}  // namespace puckloop::cosim
