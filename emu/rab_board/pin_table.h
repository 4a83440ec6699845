#pragma once
// The range-and-bearing board's wiring of the dsPIC33FJ256GP710, one line per pin, in the manner of a
// schematic. Source: range-and-bearing fact sheet 1.4.
//
// Deviations:
// 1. The strap of newer boards (RC14, receivers for 455 or 57.6 kHz) stands open: 1, receivers for 455 kHz.
// 2. JTAG is off, as in the real board's configuration words: RA0, RA1, RA4 and RA5 are always the port's.

#include "emu/dspic/peripherals/pins.h"
#include "emu/rab_board/signals.h"

#include <array>
#include <string_view>

namespace puckloop::rab {

/// What the board does at a pin.
enum class Role : std::uint8_t {
    Gate,        ///< lets carrier through to one emitter, 1 = on
    Supply,      ///< supply of all emitters, 1 = on
    PeakReset,   ///< discharges one peak detector, 1 = on
    ChipSelect,  ///< of the potentiometer, 0 = selected
    Led,
    Demodulator,  ///< follows an input signal, inverted
    PulledHigh,   ///< idles at 1 (line with a pull-up, UART at rest)
    Open,         ///< drives nothing that has a model, or reads 0
};

/// One pin: where, what stands there, and which of the twelve (0..11) it belongs to.
struct PinUse {
    dspic::PortLetter port;
    std::uint8_t bit;
    std::string_view function;
    Role role;
    std::uint8_t index = 0;
};

namespace wiring {
using enum dspic::PortLetter;
using enum Role;

inline constexpr auto kPins = std::to_array<PinUse>({
    {B, 3, "gate1", Gate, 0},
    {B, 4, "gate2", Gate, 1},
    {B, 5, "gate3", Gate, 2},
    {B, 8, "gate4", Gate, 3},
    {B, 9, "gate5", Gate, 4},
    {B, 10, "gate6", Gate, 5},
    {B, 11, "gate7", Gate, 6},
    {B, 12, "gate8", Gate, 7},
    {B, 13, "gate9", Gate, 8},
    {B, 14, "gate10", Gate, 9},
    {B, 15, "gate11", Gate, 10},
    {B, 0, "gate12", Gate, 11},
    {D, 0, "oc1", Open},
    {D, 4, "demodulator1", Demodulator, 0},
    {D, 5, "demodulator2", Demodulator, 1},
    {D, 6, "demodulator3", Demodulator, 2},
    {D, 7, "demodulator4", Demodulator, 3},
    {D, 8, "demodulator5", Demodulator, 4},
    {D, 9, "demodulator6", Demodulator, 5},
    {D, 10, "demodulator7", Demodulator, 6},
    {D, 11, "demodulator8", Demodulator, 7},
    {D, 12, "demodulator9", Demodulator, 8},
    {D, 13, "demodulator10", Demodulator, 9},
    {D, 14, "demodulator11", Demodulator, 10},
    {D, 15, "demodulator12", Demodulator, 11},
    {F, 0, "peak_reset1", PeakReset, 0},
    {F, 1, "peak_reset2", PeakReset, 1},
    {G, 0, "peak_reset3", PeakReset, 2},
    {G, 1, "peak_reset4", PeakReset, 3},
    {G, 12, "peak_reset5", PeakReset, 4},
    {G, 13, "peak_reset6", PeakReset, 5},
    {G, 14, "peak_reset7", PeakReset, 6},
    {G, 15, "peak_reset8", PeakReset, 7},
    {A, 5, "peak_reset9", PeakReset, 8},
    {A, 4, "peak_reset10", PeakReset, 9},
    {A, 1, "peak_reset11", PeakReset, 10},
    {A, 0, "peak_reset12", PeakReset, 11},
    {F, 12, "emitter_supply", Supply},
    {A, 3, "led", Led},
    {F, 6, "potentiometer_clock", Open},
    {F, 7, "potentiometer_out", Open},
    {F, 8, "potentiometer_in", Open},
    {B, 2, "potentiometer_select", ChipSelect},
    {G, 2, "i2c_scl", PulledHigh},
    {G, 3, "i2c_sda", PulledHigh},
    {F, 2, "uart1_rx", PulledHigh},
    {F, 3, "uart1_tx", PulledHigh},
    {F, 4, "uart2_rx", PulledHigh},
    {F, 5, "uart2_tx", PulledHigh},
    {C, 14, "receiver_strap", PulledHigh},
});
}  // namespace wiring

/// Peak detector i is read at AN(20 + i): RA12, RA13, RA6, RA7, RE0..RE7.
inline constexpr int kFirstPeakChannel = 20;
/// The carrier comes from this output compare module, the potentiometer hangs on this SPI module and the
/// robot's bus on this I2C module.
inline constexpr int kCarrierUnit = 1;
inline constexpr int kPotentiometerUnit = 1;
inline constexpr int kI2cUnit = 1;
/// Soldered to OSC1 and OSC2: 4 MHz, by the firmware's comments and the vendor's carrier measurement (0.2).
inline constexpr double kCrystalHertz = 4e6;

/// Function of a pin, or "" where the board leaves it open.
constexpr std::string_view pin_function(dspic::PortLetter port, int bit) {
    for (const PinUse& pin : wiring::kPins)
        if (pin.port == port && pin.bit == bit) return pin.function;
    return {};
}

}  // namespace puckloop::rab
