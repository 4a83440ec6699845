#pragma once
// The SPI as master and slave, bit by bit at its pins: SS (PB4), MOSI (PB5), MISO (PB6), SCK (PB7). Source:
// data sheet 8272, "SPI - Serial Peripheral Interface", "Alternate Functions of Port B".
//
// Deviations
//  1. A slave sees SCK and SS without its synchroniser's delay, however fast they are.
//  2. A master's last clock edge and SPIF come in one clock.
//  3. What a byte sends that is written in the clock in which the transfer before it ends was measured to be
//  lost, not what goes out in its place: here 0 (docs/measured_silicon.md).

#include "emu/avr/peripherals/ports.h"
#include "emu/avr/peripherals/surroundings.h"

#include <cstdint>
#include <optional>

namespace puckloop::avr {

class Spi {
  public:
    Spi(const Surroundings& around, Ports& ports, Pins& pins);

    void reset();

    template <class Archive>
    void state(Archive& archive) {
        archive(state_);
    }

  private:
    struct State {
        bool shifting = false;     ///< the master's clock runs
        bool status_read = false;  ///< SPSR was read with SPIF or WCOL set: the next access to SPDR clears
                                   ///< them
        std::uint8_t received = 0;
        std::uint8_t shift = 0;  ///< next out at the end that DORD states, what came in at the other
        std::uint8_t sent = 0;   ///< the byte that a master sends
        bool incoming = false;   ///< the bit that was sampled, on its way into `shift`
        std::uint8_t edges = 0;  ///< of SCK in this byte, 0..16
        bool slave = false;      ///< on, as slave
        bool selected = false;   ///< a slave, with SS low
        Cycle half = 0;          ///< clocks between edges of the master
        Cycle completed_at = 0;  ///< the newest transfer of a master

        template <class Archive>
        void state(Archive& archive) {
            archive(shifting, status_read, received, shift, sent, incoming);
            archive.bounded(edges, 0, 16);
            archive(slave, selected, half, completed_at);
            archive.check(!shifting || half > 0, "an SPI clock without a period");
        }
    };
    std::uint8_t& control() const { return around_.io.raw(0x4C); }
    std::uint8_t& status() const { return around_.io.raw(0x4D); }
    bool on() const;
    bool master() const;
    bool clock_idle() const;
    bool powered() const;
    void configure();
    void check_lost();
    void select(bool on);
    void show_bit();
    void edge(std::optional<std::uint8_t> whole);
    void complete(std::uint8_t received);
    void update_request();
    static std::uint8_t read_status(void* owner, std::uint16_t address);
    static void write_status(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask);
    static void write_control(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask);
    static std::uint8_t read_data(void* owner, std::uint16_t address);
    static void write_data(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask);
    static void due(void* owner, Cycle cycle);
    static void acknowledge(void* owner, int vector);
    static void pins_changed(void* owner, PortLetter port, std::uint8_t before, std::uint8_t after,
                             Cycle now);
    static void drivers_changed(void* owner, PortLetter port);

    Surroundings around_;
    Ports& ports_;
    Pins& pins_;
    State state_;
    EventQueue::Slot slot_;
};

}  // namespace puckloop::avr
