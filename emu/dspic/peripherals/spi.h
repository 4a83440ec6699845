#pragma once
// SPI1 and SPI2 of the 33FJ as masters: one buffer each way, 8 or 16 bits, clock from the two prescalers.
// What comes in is the board's: Pins::spi_exchange(). Source: DS70286; fact sheet peripherals.md section 8.
//
// Deviations
//  1. Slave mode (MSTEN = 0) and framed mode (FRMEN) are stored: no word ever moves.
//  2. The word is exchanged at its last clock edge, in one piece; CKE, CKP and SMP do not change its timing.
//  3. A write while SPITBF is set is dropped.
//  4. Prescalers of 1:1 both, which the sheet forbids, run as such.

#include "emu/dspic/peripherals/pins.h"
#include "emu/dspic/peripherals/ports.h"
#include "emu/dspic/peripherals/surroundings.h"

#include <cstdint>

namespace puckloop::dspic {

class Spi {
  public:
    struct Setup {
        int unit = 1;
        std::uint16_t stat = 0;  ///< SPIxSTAT; SPIxCON1, SPIxCON2 and, four bytes on, SPIxBUF follow
        std::uint8_t irq = 0;
        std::uint8_t error_irq = 0;
        PortLetter port{};
        std::uint8_t sck = 0, sdi = 0, sdo = 0;
    };
    Spi(const Surroundings& around, const Setup& setup, Ports& ports, Pins& pins);

    void reset();
    /// Sleep, or Idle with SPISIDL set: the word in progress is lost.
    void hold(bool on);

    template <class Archive>
    void state(Archive& archive) {
        archive(state_);
    }

  private:
    struct State {
        bool shifting = false;
        bool held = false;
        std::uint16_t shift = 0;     ///< being sent
        std::uint16_t waiting = 0;   ///< SPITBF
        std::uint16_t received = 0;  ///< SPIRBF

        template <class Archive>
        void state(Archive& archive) {
            archive(shifting, held, shift, waiting, received);
        }
    };

    static std::uint16_t read_buf(void* owner, std::uint16_t address);
    static void write_buf(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void write_stat(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void write_con1(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void due(void* owner, Cycle due);

    bool enabled() const;
    bool master() const;
    int bits() const;
    Cycle word_cycles() const;
    void begin(std::uint16_t value, Cycle from);
    void lend_pins();
    std::uint16_t& reg(int offset) const {
        return around_.sfr.raw(static_cast<std::uint16_t>(setup_.stat + offset));
    }

    Surroundings around_;
    Setup setup_;
    Ports& ports_;
    Pins& pins_;
    State state_;
    EventQueue::Slot slot_;
};

}  // namespace puckloop::dspic
