#pragma once
// Ports A to D: direction, output, input with its synchroniser, pull-ups, and what other modules do to the
// pins. Source: data sheet 8272, "I/O-Ports".
//
// Deviations
//  1. Output drivers and inputs switch in no time; the synchroniser delays a change by one clock, not by 0.5
//  to 1.5.
//  2. Inputs are not cut off in the deeper sleep modes.

#include "emu/avr/peripherals/pins.h"
#include "emu/avr/peripherals/surroundings.h"

#include <array>
#include <cstdint>
#include <vector>

namespace puckloop::avr {

/// Who drives a pin in place of PORTxn. Where both do, the serial module does.
enum class PinUser : std::uint8_t { Compare, Serial };

class Ports {
  public:
    Ports(const Surroundings& around, Pins& pins);

    void reset();
    /// The outside's levels on this port changed.
    void pins_changed(PortLetter port);
    bool level(Pin pin) const { return state_[index(pin.port)].levels & pin.mask(); }
    /// The pin's driver is on.
    bool output(Pin pin) const { return state_[index(pin.port)].shown_driven & pin.mask(); }
    /// Pull-ups, directions and inputs anew: something that they depend on changed.
    void refresh();

    /// A module drives the pin's value in place of PORTxn; the direction stays DDxn's.
    void override_value(Pin pin, bool level, PinUser user);
    /// A module makes the pin an output or an input, whatever DDxn states; its value is PORTxn's unless
    /// overridden.
    void override_direction(Pin pin, bool output);
    /// Back to DDxn and PORTxn.
    void release_value(Pin pin, PinUser user);
    void release_direction(Pin pin);
    /// The pins of `mask` belong to an oscillator or to the debugger: no drivers, and they read 0.
    void take_over(PortLetter port, std::uint8_t mask, bool on);

    /// Called after a level changed: levels before and after.
    using Listener = void (*)(void* owner, PortLetter port, std::uint8_t before, std::uint8_t after,
                              Cycle now);
    void listen(void* owner, Listener listener) { listeners_.push_back({owner, listener}); }
    /// Called after drivers of a port were switched on or off.
    using DriverListener = void (*)(void* owner, PortLetter port);
    void listen_drivers(void* owner, DriverListener listener) {
        driver_listeners_.push_back({owner, listener});
    }

    template <class Archive>
    void state(Archive& archive) {
        archive(state_);
    }

  private:
    static constexpr std::size_t kPorts = 4;
    struct Port {
        std::uint8_t levels = 0;
        std::uint8_t before = 0;  ///< the levels up to `changed`
        Cycle changed = 0;
        std::array<std::uint8_t, 2> value_mask{}, values{};  ///< overridden outputs, by PinUser
        std::uint8_t direction_mask = 0, directions = 0;     ///< overridden directions
        std::uint8_t taken_over = 0;                         ///< see take_over()
        std::uint8_t shown_levels = 0, shown_driven = 0;     ///< as Pins::driven() last had them

        template <class Archive>
        void state(Archive& archive) {
            archive(levels, before, changed, value_mask, values, direction_mask, directions, taken_over,
                    shown_levels, shown_driven);
        }
    };
    struct Heard {
        void* owner;
        Listener call;
    };
    struct HeardDrivers {
        void* owner;
        DriverListener call;
    };
    static std::size_t index(PortLetter port) { return static_cast<std::size_t>(port); }
    std::uint8_t& pin_register(PortLetter port, int offset) const {
        return around_.io.raw(static_cast<std::uint16_t>(kFirst + 3 * static_cast<int>(port) + offset));
    }
    static std::uint8_t read_pin(void* owner, std::uint16_t address);
    static void write_pin(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask);
    static void write_output(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask);
    static void write_disable(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask);
    std::uint8_t disabled_inputs(PortLetter port) const;
    void drive(PortLetter port);

    static constexpr std::uint16_t kFirst = 0x20;  ///< PINA, DDRA, PORTA, PINB ...
    static constexpr int kDdr = 1, kOutput = 2;
    Surroundings around_;
    Pins& pins_;
    std::array<Port, kPorts> state_{};
    std::vector<Heard> listeners_;
    std::vector<HeardDrivers> driver_listeners_;
};

}  // namespace puckloop::avr
