#pragma once
// SPI1 and SPI2: one buffer each way, 8 or 16 bits. As master the clock comes from the two prescalers, and
// what comes in is the board's: Pins::spi_exchange(). As slave the module lives at its pins: SCK, SDI and SS
// are watched edge by edge, SDO is driven. Framed mode has its pulse on SS, given or waited for. Source:
// dsPIC30F Family Reference Manual, section 20, and DS70286; fact sheet peripherals.md section 8.
//
//   SPIROV   a word arrives while SPIRBF is set: it is lost; 33FJ: SPIxEIF with it
//   framed   one clock with the pulse before the word (33FJ, FRMDLY = 1: during its first bit); the clock
//   runs
//            all the time, so that a word begins at its next edge
//
// Deviations
//  1. A master's word is exchanged at its last clock edge, in one piece; CKE, CKP and SMP do not change its
//     timing, SCK and SDO rest meanwhile. The frame's pulse is at the pin.
//  2. A write while SPITBF is set is dropped.
//  3. Prescalers of 1:1 both, which the sheets forbid, run as such.
//  4. A slave's edges act in the cycle after they are seen, however fast they come; a word that it has
//  nothing
//     new to send for carries what came in last. A
//     slave that is to give the frame's pulse gives none.

#include "emu/dspic/peripherals/pins.h"
#include "emu/dspic/peripherals/ports.h"
#include "emu/dspic/peripherals/surroundings.h"

#include <cstdint>

namespace puckloop::dspic {

class Spi {
  public:
    struct Setup {
        int unit = 1;
        std::uint16_t stat = 0;  ///< SPIxSTAT; SPIxCON (33FJ: SPIxCON1) follows
        std::uint8_t irq = 0;
        std::uint8_t error_irq = 255;  ///< 33FJ only
        PortLetter port{};
        std::uint8_t sck = 0, sdi = 0, sdo = 0;
        Ports::Pin ss{};
        std::uint16_t con2 = 0;  ///< 33FJ: framing; 0: it is in SPIxCON
        std::uint16_t buf = 0;
    };
    Spi(const Surroundings& around, const Setup& setup, Ports& ports, Pins& pins);

    void reset();
    /// Sleep, or Idle with SPISIDL set: a master's word in progress is lost, a slave goes on.
    void hold(bool on);

    template <class Archive>
    void state(Archive& archive) {
        archive(state_);
    }

  private:
    struct State {
        bool shifting = false;
        bool held = false;
        std::uint16_t shift = 0;     ///< being sent; a slave's shift register
        std::uint16_t waiting = 0;   ///< SPITBF
        std::uint16_t received = 0;  ///< SPIRBF
        std::uint8_t clocked = 0;    ///< slave: bits of this word that came in
        bool framed = false;         ///< slave: the frame's pulse has come
        bool pulse = false;          ///< master: SS is in its pulse, until the next event
        Cycle phase = 0;             ///< a clock that runs all the time began here
        Cycle pulse_at = kNoCycle;   ///< master: the frame's pulse begins here
        Cycle word_end = 0;          ///< master: of the framed word

        template <class Archive>
        void state(Archive& archive) {
            archive(shifting, held, shift, waiting, received, clocked, framed, pulse, phase, pulse_at,
                    word_end);
        }
    };

    static std::uint16_t read_buf(void* owner, std::uint16_t address);
    static std::uint16_t look_at_buf(void* owner, std::uint16_t address);
    static void write_buf(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void write_stat(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void write_con(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void due(void* owner, Cycle due);

    bool enabled() const;
    bool master() const;
    bool uses_select() const;  ///< SS is the module's pin
    int bits() const;
    Cycle clock_cycles() const;
    void begin(std::uint16_t value, Cycle from);
    void take_over_pins(Cycle at);
    void finish_word(std::uint16_t got, Cycle at);
    std::uint16_t& stat() const { return around_.sfr.raw(setup_.stat); }
    std::uint16_t con() const { return around_.sfr.raw(static_cast<std::uint16_t>(setup_.stat + 2)); }

    // Framing.
    bool framed() const;
    bool frame_slave() const;  ///< waits for the pulse
    bool pulse_high() const;
    bool pulse_with_word() const;

    // Slave (spi_slave.cpp).
    static void clock_edge(void* owner, bool level, Cycle at);
    static void select_edge(void* owner, bool level, Cycle at);
    bool selected() const;
    bool slave_drives() const;
    void attend_slave();
    void clear_word();
    void drive_bit(Cycle at);
    void take_word();

    Surroundings around_;
    Setup setup_;
    Ports& ports_;
    Pins& pins_;
    State state_;
    EventQueue::Slot slot_;
};

}  // namespace puckloop::dspic
