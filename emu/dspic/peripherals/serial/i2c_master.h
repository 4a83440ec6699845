#pragma once
// The I2C module as a master: start, repeated start, stop, transmit, receive and acknowledge, one at a
// time, each with its duration on the bus. The bus itself is the board's: phases go out through
// Pins::i2c_phase(), answers come back through answer(). It owns the module's registers; I2cSlave sees the
// accesses that concern it. Source: dsPIC30F Family Reference Manual, section 21, and DS70286; fact sheet
// peripherals.md section 4.
//
// Deviations
//  1. The slave of the same module is I2cSlave; a start by the master does not address it.
//  2. The slave's answer to an address or data byte, stretch included, is known when its ninth clock ends.
//     A read byte is therefore seen (RBF, RCEN = 0) after nine clocks instead of eight, and the acknowledge
//     that the program gives next lasts an eighth of a clock instead of a whole one: the byte takes as long
//     as in silicon.
//  3. A slave always gets "acknowledged" for a byte read; it learns of a not-acknowledge by the stop,
//     repeated start or byte that follows. Where ninth clocks were left out or given too often, clocks out of
//     step with a slave's bytes take nine a byte, a byte received too (8 in silicon), as does the ninth clock
//     of a slave's byte in which it is asked for; one acknowledge more in a slave's own byte is no clock of
//     it. A stop or repeated start where a slave is to send begins nine clocks late: SCL is low until the
//     slave's first bit is known, and a 0 is a collision (DS70068, 21.5.4 and 21.5.5).
//  4. I2CEN = 0 while an answer is awaited frees the bus when the answer comes. The bus sees a stop then.
//  What
//     the program asks for before, with I2CEN = 1 again, begins after that: up to nine clocks late.
//  5. Transmitting without a start condition reaches nobody: not acknowledged.
//  6. A start condition while another master's transfer is under way is a collision (BCL) at once, also at an
//     instant at which both lines happen to be high.

#include "cosim/core/clock.h"
#include "cosim/core/message.h"
#include "cosim/core/message_state.h"
#include "emu/dspic/peripherals/pins.h"
#include "emu/dspic/peripherals/ports.h"
#include "emu/dspic/peripherals/surroundings.h"

#include <algorithm>
#include <cstdint>
#include <map>

namespace puckloop::dspic {

class I2cSlave;

class I2cMaster {
  public:
    struct Setup {
        int unit = 1;
        std::uint16_t rcv = 0;  ///< I2CxRCV; I2CxTRN, BRG, CON, STAT, ADD follow
        bool has_mask = false;  ///< and I2CxMSK
        std::uint8_t master_irq = 0;
        std::uint8_t slave_irq = 0;
        PortLetter port{};
        std::uint8_t scl = 0;
        std::uint8_t sda = 0;
        double fixed_hertz = 0.0;  ///< the part of the SCL period that does not depend on I2CxBRG
    };
    I2cMaster(const Surroundings& around, const Setup& setup, const cosim::ClockDomain& clock, Ports& ports,
              Pins& pins);
    /// The slave that shares the registers.
    void attach(I2cSlave& slave) { slave_ = &slave; }

    void reset();
    /// Acknowledge, Data or BusLost, at cycle `at`.
    void answer(const cosim::I2cPhase& phase, Cycle at);
    /// The same for a later cycle, from within Pins::i2c_phase().
    void answer_at(const cosim::I2cPhase& phase, Cycle at);
    /// No phase goes out before this cycle, unless an answer comes; kNoCycle while one is awaited that is not
    /// known yet. `now`: the next instruction starts there.
    Cycle earliest(Cycle now) const;
    int unit() const { return setup_.unit; }
    /// How often each 7-bit address was sent and not acknowledged.
    const std::map<std::uint8_t, std::uint64_t>& refused() const { return refused_; }

    template <class Archive>
    void state(Archive& archive) {
        archive(state_, refused_, address_sent_, known_, known_at_);
        archive.bounded(sent_address_, 0, 127);
    }

  private:
    enum class Activity : std::uint8_t { Idle, Start, Restart, Stop, Transmit, Receive, Acknowledge };
    struct State {
        Activity activity = Activity::Idle;
        bool owns_bus = false;      ///< a start condition was given and no stop yet
        bool address_next = false;  ///< the next byte follows a (repeated) start
        bool awaits_answer = false;
        bool stop_when_answered = false;  ///< switched off meanwhile
        bool heard = false;               ///< the address was acknowledged, and a slave is there still
        std::uint8_t clocks = 0;          ///< that the slave's byte has had, 0 to 8
        bool loose = false;               ///< what is under way is out of step with it
        bool first_bit_asked = false;     ///< of a slave that sends, before a stop or repeated start
        bool received = false;            ///< a byte, since the address ...
        bool acknowledged = false;        ///< ... by ACKEN, the newest
        bool shared = false;              ///< another master sends the same (cosim/i2c/i2c_shared.h)
        bool reads = false;               ///< the address byte had R/W = 1
        bool ninth_low = false;           ///< a device holds SDA low in the clock that comes
        bool collides = false;            ///< what is under way finds SDA low
        Cycle buffer_empty = kNoCycle;
        Cycle ends = kNoCycle;  ///< of an activity that needs no answer

        template <class Archive>
        void state(Archive& archive) {
            archive.bounded(activity, Activity::Idle, Activity::Acknowledge);
            archive.bounded(clocks, 0, 8);
            archive(owns_bus, address_next, awaits_answer, stop_when_answered, heard, loose, first_bit_asked,
                    received, acknowledged, shared, reads, ninth_low, collides, buffer_empty, ends);
        }
    };

    static std::uint16_t read_rcv(void* owner, std::uint16_t address);
    static void write_trn(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void write_con(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void write_stat(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void due(void* owner, Cycle due);

    double clock_cycles() const;  ///< one SCL period in instruction cycles
    Cycle clocks(double count) const;
    static double duration_of(Activity activity);  ///< SCL periods
    void begin(Activity activity) { begin_at(activity, around_.now + 1); }
    void begin_at(Activity activity, Cycle from);
    /// A byte of its own is on the bus.
    bool busy() const { return state_.awaits_answer && !state_.stop_when_answered; }
    void send(cosim::I2cPhaseKind kind, std::uint8_t byte, std::uint8_t ack, cosim::Time start);
    void end_byte_read(cosim::Time start);
    bool finds_low(std::uint16_t asked);
    void collide(Cycle at);
    void transmit_behind_ninth(std::uint8_t byte);
    bool out_of_step(Activity activity) const;
    void send_loose(Activity activity, std::uint8_t byte);
    bool asks_first_bit() const;
    void ask_first_bit(Activity activity, cosim::Time start);
    void first_bit_known(bool high, Cycle at);
    void take_byte(const cosim::I2cPhase& phase);
    void complete(Cycle at);
    void stop_condition_seen(bool stopped);
    void switch_off();
    void plan() { around_.events.schedule(slot_, std::min({state_.buffer_empty, state_.ends, known_at_})); }

    std::uint16_t& reg(int offset) const {
        return around_.sfr.raw(static_cast<std::uint16_t>(setup_.rcv + offset));
    }

    std::map<std::uint8_t, std::uint64_t> refused_;
    std::uint8_t sent_address_ = 0;  ///< 7 bits, of the address byte on the bus ...
    bool address_sent_ = false;      ///< ... if it is one
    Surroundings around_;
    Setup setup_;
    const cosim::ClockDomain& clock_;
    Ports& ports_;
    Pins& pins_;
    I2cSlave* slave_ = nullptr;
    State state_;
    cosim::I2cPhase known_{};    ///< an answer that comes ...
    Cycle known_at_ = kNoCycle;  ///< ... then
    EventQueue::Slot slot_;
};

}  // namespace puckloop::dspic
