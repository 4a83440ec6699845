#pragma once
// The two-wire interface as master and slave, phase by phase. Source: data sheet 8272, "2-wire Serial
// Interface".
//
// Deviations
//  1. START and STOP take one SCL period each; a repeated START too. Where a slave is to send, each begins
//     nine periods late: SCL is low until the slave's first bit is known, which is in the way where it is 0
//     (status 0x38; the data sheet's tables do not list the case).
//  2. Arbitration is the bus's: a lost one comes back as BusLost (status 0x38 when the ninth clock of the
//     byte is over; a STOP that another master's 0 prevents, at once). Lost in the address, the winner's
//     START comes in by slave_phase() first: the unit may be who it speaks to (0x68, 0x78, 0xB0).
//  3. A byte read from a slave that is to receive is received as ones, with the acknowledge that TWEA asks
//     for; one written to a slave that is to send is the and of both, and not acknowledged.
//  4. A START or STOP in the middle of an address byte, or of a byte of ours, is a bus error (0x00), in a
//     phase of ours at once; other units' data bytes are not followed, TWDR does not hold them.
//  5. Switched off in the middle of a byte that it sends, the unit has sent ones from its first bit on.

#include "cosim/core/clock.h"
#include "cosim/core/message.h"
#include "cosim/core/message_state.h"
#include "emu/avr/peripherals/ports.h"
#include "emu/avr/peripherals/surroundings.h"

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace puckloop::avr {

class Twi {
  public:
    Twi(const Surroundings& around, const cosim::ClockDomain& clock, Ports& ports, Pins& pins);

    void reset();
    /// The bus's answer (Acknowledge, Data or BusLost) to the last phase; its ninth clock ends now.
    void answer(const cosim::I2cPhase& phase);
    /// The same for an answer that is known before: the ninth clock ends at `at`.
    void answer_at(const cosim::I2cPhase& phase, Cycle at);
    /// A phase that a bus master begins now: Start, Write, Read or Stop; each but Stop is answered through
    /// Pins::twi_slave_answer(), with ack = 0 where this slave is not addressed.
    void slave_phase(const cosim::I2cPhase& phase);

    /// TWINT will not rise by itself: nothing was begun, and no bus master was heard.
    bool idle() const {
        return !state_.awaiting && state_.step == Step::None && !state_.slave && !state_.bus_taken;
    }
    /// The acknowledge or data of a phase that a master awaits comes no earlier than this cycle; kNoCycle
    /// while none is awaited.
    Cycle earliest_slave_answer(Cycle now) const;

    /// Addresses of slaves that did not acknowledge, rising; resets do not clear them.
    std::vector<std::uint8_t> refused() const;

    template <class Archive>
    void state(Archive& archive) {
        archive(state_, refused_);
    }

  private:
    /// What the event that is planned does.
    enum class Step : std::uint8_t { None, StartSent, StopSent, SlaveAnswer, SlavePhaseOver, Answer };
    struct State {
        bool owner = false;     ///< START was sent: the bus is ours
        bool awaiting = false;  ///< a phase of ours is to be answered
        Step step = Step::None;
        std::uint8_t next_status = 0xF8;
        std::uint8_t code = 0xF8;  ///< the newest status, which TWSR shows while TWINT is set
        cosim::I2cPhase phase;     ///< ours, or the master's that addresses us
        cosim::I2cPhase answer;    ///< to ours, for Step::Answer
        bool slave = false;        ///< addressed
        bool sends = false;        ///< to send
        bool general_call = false;
        bool slave_waits = false;      ///< the master's phase waits for TWINT to be cleared
        bool stop_waits = false;       ///< so does its STOP or repeated START
        bool bus_taken = false;        ///< another master is between START and STOP
        bool start_waits = false;      ///< for the bus to be free
        Cycle address_ends = 0;        ///< of an address byte that is not ours
        bool lost = false;             ///< arbitration, to the master that now speaks to us
        bool shared = false;           ///< another master sends the same (cosim/i2c/i2c_shared.h)
        bool first_bit_asked = false;  ///< of a slave that sends, before our STOP or START

        template <class Archive>
        void state(Archive& archive) {
            archive.bounded(step, Step::None, Step::Answer);
            archive(owner, awaiting, next_status, code, phase, answer, slave, sends, general_call,
                    slave_waits, stop_waits, bus_taken, start_waits, address_ends, lost, shared,
                    first_bit_asked);
        }
    };
    std::uint8_t& control() const { return around_.io.raw(0xBC); }
    std::uint8_t& status() const { return around_.io.raw(0xB9); }
    std::uint8_t& data() const { return around_.io.raw(0xBB); }
    unsigned state_code() const { return state_.code; }
    void show_status(std::uint8_t code);
    Cycle period() const;
    void plan(Step step, Cycle at);
    void interrupt(std::uint8_t code);
    void update_request();
    void go_on();
    void end_transfer(Cycle next);
    bool asks_first_bit();
    void start(bool repeated, Cycle now);
    void bus_free();
    bool powered() const;
    void begin_phase(cosim::I2cPhaseKind kind, std::uint8_t byte, bool acknowledge);
    bool addressed(std::uint8_t address_byte, bool& general_call) const;
    void begin_slave_phase();
    void finish_slave_phase(Cycle now);
    void finish_slave_byte(cosim::I2cPhase& answer);
    void refuse(cosim::I2cPhase phase);
    void refuse_address();
    void leave_slave();
    void bus_error(const cosim::I2cPhase& phase);
    Cycle slave_clocks(int clocks, const cosim::I2cPhase& phase) const;

    static void write_control(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask);
    static void write_status(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask);
    static void write_data(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask);
    static void due(void* owner, Cycle cycle);

    Surroundings around_;
    const cosim::ClockDomain& clock_;
    Ports& ports_;
    Pins& pins_;
    State state_;
    std::array<std::uint64_t, 2> refused_{};  ///< by address, a bit each; resets do not clear them
    EventQueue::Slot slot_;
};

}  // namespace puckloop::avr
