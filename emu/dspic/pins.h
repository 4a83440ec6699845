#pragma once
// What stands around the chip, seen from its pins. The chip knows no board: a board implements this.

#include "cosim/message.h"
#include "emu/dspic/event_queue.h"

#include <cstdint>

namespace puckloop::dspic {

/// Ports A..G as on the package; H and above do not exist on these parts.
enum class PortLetter : std::uint8_t { A, B, C, D, E, F, G };

/// Everything is stamped in cycles of the chip. Calls come in time order.
class Pins {
  public:
    virtual ~Pins() = default;

    /// The chip's output drivers of one port changed: `driven` = pins that are outputs, `levels` = their
    /// levels.
    virtual void driven(PortLetter port, std::uint16_t levels, std::uint16_t driven, Cycle now) = 0;
    /// Levels that the outside puts on the port's pins now (bits of driven pins are ignored). Pull-ups are
    /// the board's.
    virtual std::uint16_t levels(PortLetter port, Cycle now) = 0;
    /// Voltage on analog input AN`channel` at this instant, as a fraction of the ADC's reference span; the
    /// ADC clips. May be asked somewhat after that cycle, but always before anything that the chip drives
    /// changes and before its run_until() returns; calls come in time order among themselves.
    virtual double analog(int channel, Cycle now) = 0;
    /// A character left UART `unit` (1 or 2); called when its stop bit begins.
    virtual void uart_sent(int unit, const cosim::UartFrame& frame) = 0;
    /// The chip, as master, began an I2C phase of module `unit`; the board answers through
    /// Chip::i2c_answer().
    virtual void i2c_phase(int unit, const cosim::I2cPhase& phase) = 0;
};

}  // namespace puckloop::dspic
