// Source of names: TAM fact sheet, sections 2 and 5.

#include "emu/tam_avr/signals.h"

#include <array>
#include <string>
#include <vector>

namespace puckloop::tam {

namespace {

using cosim::SignalDirection;
using cosim::SignalInfo;

constexpr double kSupply = 3.3;        // V
constexpr double kHighestBattery = 5;  // V
constexpr double kFullBattery = 3.7;   // V, of a lithium cell
constexpr double kIndoorLight = 0.2;   // V; an assumption, the firmware looks at the difference only

constexpr std::array<const char*, kLeds> kLedNames{
    "ir_led_right",   "led_right_red",   "led_right_blue",   "led_right_green",
    "led_middle_red", "led_middle_blue", "led_middle_green", "led_left_red",
    "led_left_blue",  "led_left_green",  "ir_led_left",      "led_breakout_1",
    "led_breakout_2", "led_top_blue",    "led_top_green",    "led_top_red"};

std::vector<SignalInfo> build() {
    std::vector<SignalInfo> list;
    const auto input = [&](const char* name, const char* unit, double max, const char* text, double initial) {
        list.push_back({name, SignalDirection::Input, unit, 0, max, text, initial});
    };
    const auto output = [&](const char* name, const char* unit, const char* text, double initial = 0) {
        list.push_back({name, SignalDirection::Output, unit, 0, 1, text, initial});
    };
    input("barrier_front", "share", 1, "part of the front light barrier that is interrupted", 0);
    input("barrier_back", "share", 1, "part of the back light barrier that is interrupted", 0);
    input("ambient_front", "V", kSupply, "what daylight alone makes at the front sensor", kIndoorLight);
    input("ambient_back", "V", kSupply, "what daylight alone makes at the back sensor", kIndoorLight);
    input("battery", "V", kHighestBattery, "voltage of the battery", kFullBattery);
    input("proximity_sense", "level", 1, "1 = the infra-red comparator sees light", 0);
    input("network_switch_0", "level", 1, "DIP switch XBEE_NET_0, 1 = open", 1);
    input("network_switch_1", "level", 1, "DIP switch XBEE_NET_1, 1 = open", 1);
    output("proximity_emit", "level", "1 = infra-red LED of the transceiver on");
    output("network_led", "level", "1 = on");
    output("power_clear", "level", "1 = the firmware switches the board off");
    output("xbee_reset", "level", "1 = the radio module is held in reset");
    output("xbee_rts", "level", "level at the radio module's RTS");
    output("xbee_wake", "level", "level at the radio module's sleep request");
    for (const char* name : kLedNames)
        output(name, "share", "part of the time that the LED is on");
    output("power", "level", "1 = the board has supply", 1);
    input("vdd", "V", kSupply, "supply of the board at most, under a load or a short", kSupply);
    return list;
}

}  // namespace

std::span<const SignalInfo> signals() {
    static const std::vector<SignalInfo> list = build();
    return list;
}

}  // namespace puckloop::tam
