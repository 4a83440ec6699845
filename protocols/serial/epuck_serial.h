#pragma once
// The serial records between the e-puck's Linux board and its dsPIC: 115200 8N1, no header, no check, no
// sequence number; synchronisation is by byte count alone. Little-endian, layout in the comments (offset of
// each field). Source: e-puck fact sheet 1.2 and 1.3.
//
//   Linux -> PIC   1 byte wake-up (any value), 4 bytes configuration     once a session
//   PIC -> Linux   72 bytes sensor state                                 after the configuration
//   Linux -> PIC   12 bytes actuator state                               each cycle
//   PIC -> Linux   72 bytes sensor state                                 after each, unless reset is 'R'

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace puckloop::protocols {

inline constexpr std::size_t kEpuckConfigurationBytes = 4;
inline constexpr std::size_t kEpuckActuatorBytes = 12;
inline constexpr std::size_t kEpuckSensorBytes = 72;
inline constexpr std::uint8_t kEpuckWakeUp = 0x01;    ///< what Linux sends; the PIC accepts any value
inline constexpr std::uint8_t kEpuckContinue = 0x4E;  ///< 'N' in EpuckActuators::reset
inline constexpr std::uint8_t kEpuckEnd = 0x52;       ///< 'R' in EpuckActuators::reset: the session ends
inline constexpr int kEpuckRing = 8;                  ///< proximity and light sensors, ring LEDs

struct EpuckConfiguration {
    std::uint8_t rab_range = 0;    ///< 0: used only when rab_enabled is not 0
    std::uint8_t rab_enabled = 0;  ///< 1
    std::uint16_t padding = 0;     ///< 2
    bool operator==(const EpuckConfiguration&) const = default;
};

struct EpuckActuators {
    std::int16_t left = 0;                ///< 0: motor steps/s, firmware means +-1000
    std::int16_t right = 0;               ///< 2
    std::uint16_t rab_data = 0;           ///< 4
    std::uint8_t ring_leds = 0;           ///< 6: bit i = LED i, 0 is the front one, then clockwise
    std::uint8_t other_leds = 0;          ///< 7: bit 0 front LED, bit 1 body LED
    std::uint8_t ircom_enabled = 0;       ///< 8
    std::uint8_t ircom_data = 0;          ///< 9
    std::uint8_t reset = kEpuckContinue;  ///< 10
    std::uint8_t padding = 0;             ///< 11
    bool operator==(const EpuckActuators&) const = default;
};

struct EpuckSensors {
    std::uint16_t rab_data = 0;   ///< 0
    std::uint16_t rab_range = 0;  ///< 2
    float rab_bearing = 0;        ///< 4: rad
    std::array<std::int16_t, kEpuckRing>
        proximity{};                               ///< 8: ambient - lit, ADC counts; > 0: something reflects
    std::uint16_t battery_ok = 0;                  ///< 24: 1 = above about 3.4 V
    std::array<std::int16_t, 3> accelerometer{};   ///< 26
    std::array<std::int16_t, 4> microphones{};     ///< 32
    std::array<std::int16_t, kEpuckRing> light{};  ///< 40: raw ambient, 0..4095, bright = small
    std::uint16_t rab_received = 0;                ///< 56
    std::uint16_t ircom_received = 0;              ///< 58
    std::uint8_t ircom_data = 0;                   ///< 60
    std::uint8_t padding = 0;                      ///< 61
    std::uint16_t ircom_sensor = 0;                ///< 62: 0..7
    float ircom_range = 0;                         ///< 64: cm
    float ircom_bearing = 0;                       ///< 68: rad
};

using EpuckConfigurationBytes = std::array<std::uint8_t, kEpuckConfigurationBytes>;
using EpuckActuatorBytes = std::array<std::uint8_t, kEpuckActuatorBytes>;
using EpuckSensorBytes = std::array<std::uint8_t, kEpuckSensorBytes>;

/// Encoding and decoding are exact inverses for every byte pattern, padding included.
EpuckConfigurationBytes encode(const EpuckConfiguration& configuration);
EpuckActuatorBytes encode(const EpuckActuators& actuators);
EpuckSensorBytes encode(const EpuckSensors& sensors);
EpuckConfiguration decode_configuration(std::span<const std::uint8_t, kEpuckConfigurationBytes> bytes);
EpuckActuators decode_actuators(std::span<const std::uint8_t, kEpuckActuatorBytes> bytes);
EpuckSensors decode_sensors(std::span<const std::uint8_t, kEpuckSensorBytes> bytes);

/// Why a sensor record cannot be what a PIC sent (a field out of its range), or empty. The record carries no
/// check, so this and its length are all that distinguishes a shifted or garbled record from a good one.
std::string_view why_implausible(const EpuckSensors& sensors);

}  // namespace puckloop::protocols
