#pragma once
// The I2C module as a slave: 7-bit and 10-bit addresses with mask and general call, clock stretching,
// SI2CxIF. Phases come in from the bus as they begin; each but Stop is answered through
// Pins::i2c_slave_answer() when eight clocks have passed since SCL was let go. Source: dsPIC30F Family
// Reference Manual, section 21, and DS70286; fact sheets peripherals.md section 4 and rab.md section 2.2.
//
//   reserved addresses (33FJ: 0x00 to 0x07 without GCEN, 0x78 to 0x7F) match with IPMIEN = 1 only
//   address, R/W = 0   answer at the 8th clock, SI2CxIF at the 9th; SCL is not held
//   address, R/W = 1   the same, and SCLREL = 0: SCL is held until the program sets it, TRN loaded; where TRN
//                      is loaded already (TBF) SCL is not held
//   10 bits            the first byte (11110, two bits, 0) is acknowledged without a sign; the second is the
//                      address: ADD10 and SI2CxIF. A read begins again with the first byte, R/W = 1
//   byte received      STREN = 0: answer at the 8th clock, SI2CxIF at the 9th; STREN = 1: deviation 1
//   overrun            RBF or I2COV still set: no acknowledge; with RBF the byte is lost and I2COV set
//   byte sent          TBF falls at the 8th clock; SI2CxIF when the master acknowledged, and SCLREL = 0
//                      unless TBF is set again by then
//   not acknowledged   at the end of the 9th clock the slave resets without a sign (DS70068C, 21.7.5): it is
//                      not addressed any more, whoever clocks on reads ones; a byte that the program put into
//                      TRN meanwhile is dropped (TBF = 0)
//   read from a slave that is to receive: it receives ones. Written to one that is to send: both drive SDA,
//   nobody acknowledges, TBF falls all the same
//   START or STOP in the middle of a byte: the byte is dropped; TBF stays
//
// Deviations
//  1. With STREN = 1 a received byte is shown (RBF, SI2CxIF, SCLREL = 0) at the 8th clock and its answer
//     waits for SCLREL: the byte ends on the bus when it would in silicon, the program sees it one clock
//     earlier.
//  2. That the master acknowledged a byte is known by what follows: its next Read, or that it asks for the
//     next bit because a stop or a start follows (kNoByteFollows). The interrupt comes with that, at the
//     start of the next byte. A stop or a start at once means not acknowledged: no interrupt.
//  3. SMBus levels and slew rate (SMEN, DISSLW) are stored.
//  4. S and P follow what reaches the module: transfers to other devices do not.
//  5. The slave goes on in Sleep and Idle.

#include "cosim/core/clock.h"
#include "cosim/core/message_state.h"
#include "emu/dspic/peripherals/pins.h"
#include "emu/dspic/peripherals/serial/i2c_master.h"
#include "emu/dspic/peripherals/surroundings.h"

#include <cstdint>
#include <optional>

namespace puckloop::dspic {

class I2cSlave {
  public:
    I2cSlave(const Surroundings& around, const I2cMaster::Setup& setup, const cosim::ClockDomain& clock,
             Pins& pins);

    void reset();
    /// A phase that began at phase.start is handed in at cycle `at`.
    void phase(const cosim::I2cPhase& phase, Cycle at);
    /// No answer comes before this; kNever while nothing is open. `now`: the next instruction starts there.
    cosim::Time earliest_answer(Cycle now) const;

    // For the owner of the registers.
    /// A write to I2CxTRN belongs to the slave.
    bool transmitting() const { return state_.addressed && state_.sends && !in_address(); }
    /// Another master began a transfer and did not end it.
    bool bus_taken() const { return state_.taken; }
    void load(std::uint16_t value);
    /// I2CxCON was written; `old` was its value.
    void control_written(std::uint16_t old);

    template <class Archive>
    void state(Archive& archive) {
        archive(state_);
    }

  private:
    enum class Step : std::uint8_t {
        None,
        Answer,   ///< the 8th clock of an address or of a byte received
        Stretch,  ///< a received byte is shown, SCL held until SCLREL is set
        Hold,     ///< a byte to send, or its first bit, waits for SCLREL
        Shift     ///< a byte is being sent
    };
    struct State {
        bool taken = false;  ///< a START came and no STOP
        bool addressed = false;
        bool half = false;       ///< 10 bits: the first byte fitted, the second is to come
        bool whole = false;      ///< 10 bits: both fitted, until a stop or another address
        bool sends = false;      ///< R/W = 1
        bool byte_sent = false;  ///< since the address
        bool acknowledge = false;
        Step step = Step::None;
        cosim::I2cPhase open;        ///< while step is not None
        cosim::Time released = 0;    ///< SCL free from here on, for the byte that is open
        Cycle step_due = kNoCycle;   ///< of Answer and Shift
        Cycle shown_due = kNoCycle;  ///< the 9th clock: status and interrupt
        bool shows_address = false;
        std::uint8_t shown = 0;      ///< the byte to show then
        Cycle ended_due = kNoCycle;  ///< the 9th clock of a byte sent and not acknowledged

        template <class Archive>
        void state(Archive& archive) {
            archive(taken, addressed, half, whole, sends, byte_sent, acknowledge);
            archive.bounded(step, Step::None, Step::Shift);
            archive(open, released, step_due, shown_due, shows_address, shown, ended_due);
        }
    };

    static void due(void* owner, Cycle due);
    void start(const cosim::I2cPhase& phase);
    void byte(const cosim::I2cPhase& phase, Cycle at);
    void not_acknowledged();
    void first_bit(const cosim::I2cPhase& phase, Cycle at);
    void next_byte(Cycle at);
    void let_go(cosim::Time from);
    void end_byte_sent();
    void stop();
    void open(const cosim::I2cPhase& phase);
    void eighth_clock(Cycle at);
    void answer(cosim::Time stretch, bool acknowledge, std::uint8_t byte);
    void show(bool address, std::uint8_t byte, Cycle at);
    void hold_clock();
    void wait_for_byte();
    void shift(cosim::Time from);
    /// The address byte is still on the wires.
    bool in_address() const {
        return state_.step == Step::Answer && state_.open.kind == cosim::I2cPhaseKind::Start;
    }
    bool matches(std::uint8_t address_byte) const;
    bool matches_first_of_ten(std::uint8_t address_byte) const;
    bool matches_second_of_ten(std::uint8_t byte) const;
    bool ten_bits() const;
    bool released() const;
    Cycle cycle_before(cosim::Time time) const;
    void plan();
    std::uint16_t& reg(int offset) const {
        return around_.sfr.raw(static_cast<std::uint16_t>(setup_.rcv + offset));
    }

    Surroundings around_;
    I2cMaster::Setup setup_;
    const cosim::ClockDomain& clock_;
    Pins& pins_;
    State state_;
    EventQueue::Slot slot_;
};

}  // namespace puckloop::dspic
