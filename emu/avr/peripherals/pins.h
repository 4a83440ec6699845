#pragma once
// What is around the chip, seen from its pins. The chip knows no board: a board implements this.

#include "cosim/core/message.h"
#include "emu/avr/devices/device.h"

#include <cstdint>
#include <optional>

namespace puckloop::avr {

enum class PortLetter : std::uint8_t { A, B, C, D };

/// One pin: PD6 is {PortLetter::D, 6}.
struct Pin {
    PortLetter port{};
    std::uint8_t number = 0;

    constexpr std::uint8_t mask() const { return static_cast<std::uint8_t>(1u << number); }
};

/// Everything is stamped in cycles of the chip. Calls come in time order.
class Pins {
  public:
    virtual ~Pins() = default;

    /// The chip's output drivers of one port changed: `driven` = pins that are outputs, `levels` = their
    /// levels.
    virtual void driven(PortLetter port, std::uint8_t levels, std::uint8_t driven, Cycle now);
    /// Levels of the port's pins as the outside makes them (bits of driven pins are ignored); `pull_ups` =
    /// pins that the chip pulls up weakly.
    virtual std::uint8_t levels(PortLetter port, std::uint8_t pull_ups, Cycle now);
    /// Volts at input ADC`channel`, 0..7, at this instant.
    virtual double analog(int channel, Cycle now);
    /// Volts at AIN0 (false) and AIN1 (true) of the comparator.
    virtual double comparator(bool negative, Cycle now);
    /// A character left USART `unit` (0 or 1); called when its stop bit begins.
    virtual void uart_sent(int unit, const cosim::UartFrame& frame);
    /// The chip, as master, began a phase on the two-wire bus; the board answers through Chip::twi_answer().
    virtual void twi_phase(const cosim::I2cPhase& phase);
    /// The chip, as slave, answers the phase handed to Chip::twi_slave_phase().
    virtual void twi_slave_answer(const cosim::I2cPhase& answer);
    /// The SPI master shifted out `sent` (as written to SPDR), the last clock edge being now: what came in
    /// meanwhile (as read from SPDR), of a board that answers byte by byte. Without a value the bits are
    /// those that stood at MISO; driven() shows SCK and MOSI either way.
    virtual std::optional<std::uint8_t> spi_exchange(std::uint8_t sent, Cycle now);
};

inline void Pins::driven(PortLetter, std::uint8_t, std::uint8_t, Cycle) {}
inline std::uint8_t Pins::levels(PortLetter, std::uint8_t, Cycle) {
    return 0xFF;
}
inline double Pins::analog(int, Cycle) {
    return 0.0;
}
inline double Pins::comparator(bool, Cycle) {
    return 0.0;
}
inline void Pins::uart_sent(int, const cosim::UartFrame&) {}
inline void Pins::twi_phase(const cosim::I2cPhase&) {}
inline void Pins::twi_slave_answer(const cosim::I2cPhase&) {}
inline std::optional<std::uint8_t> Pins::spi_exchange(std::uint8_t, Cycle) {
    return std::nullopt;
}

}  // namespace puckloop::avr
