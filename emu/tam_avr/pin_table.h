#pragma once
// The TAM's wiring of the ATmega1284P, one line per pin, in the manner of a schematic.
// Source: TAM fact sheet, section 2.
//
// Deviations:
// 1. XBEE_CTS (PD5) is an output of the radio module that the firmware drives low: the driver wins, nothing
//    is damaged.

#include "emu/avr/peripherals/pins.h"
#include "emu/tam_avr/signals.h"

#include <array>
#include <string_view>

namespace puckloop::tam {

/// What the board does at a pin.
enum class Role : std::uint8_t {
    Output,      ///< becomes the signal `signal`
    Input,       ///< follows the signal `signal`
    PulledHigh,  ///< idles at 1 (pull-up, serial line at rest)
    Analog,
};

struct PinUse {
    avr::PortLetter port;
    std::uint8_t bit;
    std::string_view function;
    Role role;
    SignalId signal = 0;
};

namespace wiring {
using enum avr::PortLetter;
using enum Role;

inline constexpr auto kPins = std::to_array<PinUse>({
    {A, 0, "ir_sense_left", Analog},
    {A, 1, "battery_sense", Analog},
    {A, 2, "ir_sense_right", Analog},
    {B, 1, "proximity_emit", Output, kProximityEmit},
    {B, 2, "network_switch_1", Input, kNetworkSwitch + 1},
    {B, 3, "power_clear", Output, kPowerClear},
    {B, 4, "network_switch_0", Input, kNetworkSwitch},
    {C, 0, "scl", PulledHigh},
    {C, 1, "sda", PulledHigh},
    {C, 2, "xbee_rts", Output, kXBeeRts},
    {C, 3, "network_led", Output, kNetworkLed},
    {D, 0, "debug_rxd", PulledHigh},
    {D, 1, "debug_txd", PulledHigh},
    {D, 2, "xbee_dout", PulledHigh},
    {D, 3, "xbee_din", PulledHigh},
    {D, 4, "xbee_wake", Output, kXBeeWake},
    {D, 5, "xbee_cts", PulledHigh},
    {D, 6, "proximity_sense", Input, kProximitySense},
    {D, 7, "xbee_reset", Output, kXBeeReset},
});
}  // namespace wiring

/// Analog inputs: front barrier, battery, back barrier.
inline constexpr int kFrontChannel = 0, kBatteryChannel = 1, kBackChannel = 2;
/// 42.2 kilohms over 4.7: what of the battery's voltage reaches ADC1 (through a unity-gain amplifier).
inline constexpr double kBatteryDivider = 4.7 / (42.2 + 4.7);
inline constexpr double kSupplyVolts = 3.3;
inline constexpr double kResonatorHertz = 16e6;
/// USART0 is the debug console, USART1 the radio module.
inline constexpr int kConsoleUnit = 0, kXBeeUnit = 1;

/// Function of a pin, or "" where the board leaves it open.
constexpr std::string_view pin_function(avr::PortLetter port, int bit) {
    for (const PinUse& pin : wiring::kPins)
        if (pin.port == port && pin.bit == bit) return pin.function;
    return {};
}

}  // namespace puckloop::tam
