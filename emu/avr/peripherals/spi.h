#pragma once
// The SPI as master and as slave of a board that calls. Source: data sheet 8272, "Serial Peripheral
// Interface".
//
// Deviations
//  1. The bits do not show at the pins: a byte is exchanged at its last clock edge.
//  2. SS pulled low does not turn a master into a slave.

#include "emu/avr/peripherals/surroundings.h"
#include "emu/avr/pins.h"

namespace puckloop::avr {

class Spi {
  public:
    Spi(const Surroundings& around, Pins& pins);

    void reset();
    /// A master elsewhere clocked a byte in; returns what was shifted out. 0xFF while the slave is off.
    std::uint8_t slave_exchange(std::uint8_t received);

    template <class Archive>
    void state(Archive& archive) {
        archive(shifting_, status_read_, received_, sent_);
    }

  private:
    std::uint8_t& control() const { return around_.io.raw(0x4C); }
    std::uint8_t& status() const { return around_.io.raw(0x4D); }
    void complete(std::uint8_t received);
    void update_request();
    static std::uint8_t read_status(void* owner, std::uint16_t address);
    static void write_status(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask);
    static void write_control(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask);
    static std::uint8_t read_data(void* owner, std::uint16_t address);
    static void write_data(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask);
    static void due(void* owner, Cycle cycle);
    static void acknowledge(void* owner, int vector);

    Surroundings around_;
    Pins& pins_;
    bool shifting_ = false;
    bool status_read_ = false;  ///< SPSR was read with SPIF or WCOL set: the next access to SPDR clears them
    std::uint8_t received_ = 0;
    std::uint8_t sent_ = 0;
    EventQueue::Slot slot_;
};

}  // namespace puckloop::avr
