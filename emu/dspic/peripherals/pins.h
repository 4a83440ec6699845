#pragma once
// What stands around the chip, seen from its pins. The chip knows no board: a board implements this.

#include "cosim/core/message.h"
#include "emu/dspic/machine/event_queue.h"

#include <cstdint>
#include <string_view>

namespace puckloop::dspic {

/// What is outside a pin, for reports.
struct OutsidePin {
    bool changes = true;          ///< false: its level stays what it is for the whole run
    std::string_view function{};  ///< the board's name for it, or empty
};

/// What the DCI shifts out in one slot of a frame, MSB first and left justified.
struct DciWord {
    std::uint8_t slot = 0;   ///< 0..15; 0 begins at (or one bit behind) the frame sync
    std::uint8_t bits = 16;  ///< that are transferred
    bool driven = false;     ///< the slot is one that the chip transmits in; else `value` is 0
    std::uint16_t value = 0;
    Cycle frame = 0;               ///< first bit of slot 0 of this frame
    std::uint32_t bit_cycles = 2;  ///< bit clock, cycles
};

/// A codec that is the DCI's master, and makes bit clock, frame sync or both for it, evenly.
struct DciMaster {
    cosim::Time first = 0;         ///< rising edge of its bit clock with which its first frame sync comes
    cosim::Time bit = 0;           ///< period of its bit clock; 0: it makes none, and counts the chip's
    std::uint32_t frame_bits = 0;  ///< from frame sync to frame sync (I2S: edge to edge); 0: it makes none
};

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
    /// The same for who is no part of what is simulated (reports, watches): changes nothing.
    virtual std::uint16_t quiet_levels(PortLetter port, Cycle now) { return levels(port, now); }
    /// The next cycle after `after` at which the board, by itself, may change one of the pins `monitored`,
    /// whose edges the chip notices; levels() then gives them. Pins that nobody monitors may change between
    /// events: levels() is asked where a program reads them. To be followed by Chip::edges_moved() when it
    /// changes.
    virtual Cycle next_edge(PortLetter port, std::uint16_t monitored, Cycle after) const;
    /// Voltage on analog input AN`channel` at this instant, as a fraction of the ADC's reference span; the
    /// ADC clips. May be asked somewhat after that cycle, but always before anything that the chip drives
    /// changes and before its run_until() returns; calls come in time order among themselves.
    virtual double analog(int channel, Cycle now) = 0;
    /// Stands for what the analog inputs show from cycle `from` on: while it stays the same, and is not 0,
    /// they show what they showed, and asking analog() changes nothing. 0: they may change by themselves.
    virtual std::uint64_t analog_epoch(Cycle from);
    /// A character left UART `unit` (1 or 2); called when its stop bit begins.
    virtual void uart_sent(int unit, const cosim::UartFrame& frame) = 0;
    /// The chip, as master, began an I2C phase of module `unit`; the board answers through
    /// Chip::i2c_answer().
    virtual void i2c_phase(int unit, const cosim::I2cPhase& phase) = 0;
    /// The chip, as slave of I2C module `unit`, answers the phase handed to Chip::i2c_slave_phase():
    /// Acknowledge to a Start or Write, Data to a Read. `start` and `clock_period` are the phase's, `stretch`
    /// gives how long SCL was held: the answer belongs to start + 8 clocks + stretch, and is called then.
    virtual void i2c_slave_answer(int unit, const cosim::I2cPhase& answer);
    /// Master of SPI module `unit` shifted out `bits` (8 or 16) bits, the last clock edge being now: what
    /// came in meanwhile. The chip select is an ordinary port pin. Without a board the line rests high.
    virtual std::uint16_t spi_exchange(int unit, std::uint16_t sent, int bits, Cycle now);
    /// The DCI's last bit of `word` is over, in a slot enabled for either direction: what came in meanwhile,
    /// left justified. Without a board the line rests low.
    virtual std::uint16_t dci_exchange(const DciWord& word, Cycle now);
    /// What clocks the board's codec makes at CSCK and COFS. Fixed for the chip's life. Without a board:
    /// none.
    virtual DciMaster dci_master() const;
    /// Voltage at VDD, as brown-out reset and low-voltage detector see it; a change is reported by
    /// Chip::supply_changed().
    virtual double supply() const;
    /// Module CAN`unit` is on a bus, which answers by Chip::can_news(). Fixed for the chip's life. Without a
    /// board it is alone.
    virtual bool can_wired(int unit) const;
    /// What module CAN`unit` sends that bus, at cycle `now`.
    virtual void can_to_bus(int unit, const cosim::CanMessage& message, Cycle now);
    /// Bit 0..15 of a port. Unless a board knows better, anything may change.
    virtual OutsidePin outside(PortLetter port, int bit) const;
    /// Chip::output_compare(unit) changed at cycle `now`.
    virtual void output_compare_changed(int unit, Cycle now);
    /// PWM of module OC`unit` comes edge by edge through driven(). False: its pin rests low, and
    /// output_compare_changed() is all that the board hears of it, which costs nothing per period.
    virtual bool wants_pwm_edges(int unit) const;
};

/// When the ninth clock of a phase ends, if nobody stretches: the earliest answer to a master.
constexpr cosim::Time i2c_ninth_clock_end(const cosim::I2cPhase& phase) {
    constexpr cosim::Time kClocks = 9;
    return phase.start + kClocks * phase.clock_period;
}

/// When a slave's answer stands on the wire.
constexpr cosim::Time i2c_answer_time(const cosim::I2cPhase& answer) {
    constexpr cosim::Time kClocksToAnswer = 8;
    return answer.start + kClocksToAnswer * answer.clock_period + answer.stretch;
}

inline void Pins::i2c_slave_answer(int, const cosim::I2cPhase&) {}
inline std::uint16_t Pins::spi_exchange(int, std::uint16_t, int bits, Cycle) {
    return static_cast<std::uint16_t>((1u << bits) - 1u);
}
inline std::uint16_t Pins::dci_exchange(const DciWord&, Cycle) {
    return 0;
}
inline DciMaster Pins::dci_master() const {
    return {};
}
inline double Pins::supply() const {
    return 3.3;
}
inline bool Pins::can_wired(int) const {
    return false;
}
inline void Pins::can_to_bus(int, const cosim::CanMessage&, Cycle) {}
inline OutsidePin Pins::outside(PortLetter, int) const {
    return {};
}
inline void Pins::output_compare_changed(int, Cycle) {}
inline bool Pins::wants_pwm_edges(int) const {
    return true;
}
inline std::uint64_t Pins::analog_epoch(Cycle) {
    return 0;
}
inline Cycle Pins::next_edge(PortLetter, std::uint16_t, Cycle) const {
    return kNoCycle;
}

}  // namespace puckloop::dspic
