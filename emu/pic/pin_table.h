#pragma once
// The e-puck main board's wiring of the dsPIC30F6014A, one line per pin, in the manner of a schematic.
// Source: e-puck fact sheet 3.2 (from the e-puck library's port headers and the camera and codec drivers).
//
// Deviations:
// 1. No LIS turret is fitted: its inputs stand at the idle level given here.
// 2. Of board revision 1.3 (board_revision.h) nothing stands at AN5 and AN6: they read 0.

#include "emu/dspic/peripherals/pins.h"
#include "emu/pic/signals.h"

#include <array>
#include <string_view>

namespace puckloop::pic {

/// What the board does at a pin.
enum class Role : std::uint8_t {
    Output,      ///< drives a signal of the board, 1 = on
    Coil,        ///< one phase of a step motor, 1 = current flows
    Input,       ///< follows one bit of an input signal
    InputLow,    ///< the same, inverted: the pin is 0 while the signal is 1
    PulledHigh,  ///< idles at 1 (line with a pull-up, UART at rest)
    PulledLow,   ///< idles at 0
    Camera,      ///< driven by the camera, where one is fitted; idles at 0
};

/// One pin: where, what stands there, which signal, which bit of it (a coil: 0 = A .. 3 = D).
struct PinUse {
    dspic::PortLetter port;
    std::uint8_t bit;
    std::string_view function;
    Role role;
    SignalId signal = kSignalCount;
    std::uint8_t signal_bit = 0;
};

namespace wiring {
using enum dspic::PortLetter;
using enum Role;

inline constexpr auto kPins = std::to_array<PinUse>({
    {A, 6, "led0", Output, kLed + 0},
    {A, 7, "led1", Output, kLed + 1},
    {A, 9, "led2", Output, kLed + 2},
    {A, 12, "led3", Output, kLed + 3},
    {A, 10, "led4", Output, kLed + 4},
    {A, 13, "led5", Output, kLed + 5},
    {A, 14, "led6", Output, kLed + 6},
    {A, 15, "led7", Output, kLed + 7},
    {C, 1, "led_front", Output, kLedFront},
    {C, 2, "led_body", Output, kLedBody},
    {C, 3, "camera_href", Camera},
    {C, 4, "camera_vsync", Camera},
    {C, 13, "camera_reset", Output, kCameraReset},
    {C, 14, "camera_pclk", Camera},
    {D, 0, "left_coil_a", Coil, kWheelLeft, 0},
    {D, 1, "left_coil_b", Coil, kWheelLeft, 1},
    {D, 2, "left_coil_c", Coil, kWheelLeft, 2},
    {D, 3, "left_coil_d", Coil, kWheelLeft, 3},
    {D, 4, "right_coil_a", Coil, kWheelRight, 0},
    {D, 5, "right_coil_b", Coil, kWheelRight, 1},
    {D, 6, "right_coil_c", Coil, kWheelRight, 2},
    {D, 7, "right_coil_d", Coil, kWheelRight, 3},
    {D, 8, "camera_data0", Camera},
    {D, 9, "camera_data1", Camera},
    {D, 10, "camera_data2", Camera},
    {D, 11, "camera_data3", Camera},
    {D, 12, "camera_data4", Camera},
    {D, 13, "camera_data5", Camera},
    {D, 14, "camera_data6", Camera},
    {D, 15, "camera_data7", Camera},
    {F, 0, "audio_on", Output, kAudioOn},
    {F, 1, "battery_low", InputLow, kBatteryLow, 0},
    {F, 2, "uart1_rx", PulledHigh},
    {F, 3, "uart1_tx", PulledHigh},
    {F, 4, "uart2_rx", PulledHigh},
    {F, 5, "uart2_tx", PulledHigh},
    {F, 6, "remote", Input, kRemote, 0},
    {F, 7, "pulse0", Output, kPulse + 0},
    {F, 8, "pulse1", Output, kPulse + 1},
    {G, 0, "pulse2", Output, kPulse + 2},
    {G, 1, "pulse3", Output, kPulse + 3},
    {G, 2, "i2c_scl", PulledHigh},
    {G, 3, "i2c_sda", PulledHigh},
    {G, 6, "selector0", Input, kSelector, 0},
    {G, 7, "selector1", Input, kSelector, 1},
    {G, 8, "selector2", Input, kSelector, 2},
    {G, 9, "selector3", Input, kSelector, 3},
    {G, 12, "codec_in", PulledLow},
    {G, 13, "codec_out", PulledLow},
    {G, 14, "codec_clock", PulledLow},
    {G, 15, "codec_frame", PulledLow},
});

// UART1's TX.
inline constexpr dspic::PortLetter kLinePort = F;
inline constexpr int kLineTx = 3;
// Where the camera's lines are.
inline constexpr dspic::PortLetter kCameraLines = C, kCameraData = D;
inline constexpr int kCameraHref = 3, kCameraVsync = 4, kCameraPclk = 14;
inline constexpr int kFirstCameraData = 8;  ///< y0
}  // namespace wiring

/// Analog inputs, by ANn: the signal that stands there.
inline constexpr std::array<SignalId, kAdcCount> kAnalogWiring{
    kAdc,          kAdc + 1,          kMicrophone,       kMicrophone + 1, kMicrophone + 2,
    kAcceleration, kAcceleration + 1, kAcceleration + 2, kAmbient,        kAmbient + 1,
    kAmbient + 2,  kAmbient + 3,      kAmbient + 4,      kAmbient + 5,    kAmbient + 6,
    kAmbient + 7,
};
/// First of the three microphones: AN2 is mic0.
inline constexpr int kFirstMicrophoneChannel = 2;
/// First of the accelerometer's three, and that at which revision 1.3 has the battery.
inline constexpr int kFirstAccelerationChannel = 5, kBatteryChannel = 7;
/// First of the eight proximity channels: AN8 is proximity0.
inline constexpr int kFirstProximityChannel = 8;

/// Function of a pin, or "" where the board leaves it open.
constexpr std::string_view pin_function(dspic::PortLetter port, int bit) {
    for (const PinUse& pin : wiring::kPins)
        if (pin.port == port && pin.bit == bit) return pin.function;
    return {};
}

}  // namespace puckloop::pic
