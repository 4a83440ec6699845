#pragma once
// What the CAN module of the 30F and the ECAN of the 33FJ have in common: modes, bit timing, sending by
// priority, error counters, the flags in CxINTF. Their buffers, filters and registers are their own (can.h,
// ecan.h). Sources: DS70070 section 23, DS70185.
//
// The bus is outside: where the board's pins are wired to one (Pins::can_wired()), the module offers it a
// frame and hears what became of it, with the error counters (can_line_bus.cpp; cosim/can/can_bus.h is the
// bus, with its own deviations). A module that is wired to nothing is alone: nobody acknowledges.
//
// Deviations
//  1. A buffer's words are taken when it is offered: at its request, or when the one before it has gone.
//  2. Entering Normal, Listen Only or Listen All mode takes 11 bit times after the request, or after the
//     frame under way; the other modes are entered at once, or after that frame. Intermission: 3 bits.
//  3. A frame received is handed in at its end. Alone, a sender does not suspend transmission.
//  4. CANCAP, SAM and WAKFIL are stored. CxTX rests at the recessive level.
//  5. Listen All takes sound frames only, as Listen Only does.

#include "cosim/core/clock.h"
#include "cosim/core/message.h"
#include "emu/dspic/peripherals/pins.h"
#include "emu/dspic/peripherals/ports.h"
#include "emu/dspic/peripherals/surroundings.h"
#include "protocols/can/can_frame.h"

#include <cstdint>
#include <optional>

namespace puckloop::dspic {

using protocols::CanFrame;

class CanLine {
  public:
    struct Place {
        int unit = 1;
        std::uint16_t ctrl = 0, cfg1 = 0, cfg2 = 0, intf = 0, inte = 0, ec = 0;
        std::uint8_t irq = 0;
        PortLetter port{};
        std::uint8_t rx = 0, tx = 0;
        /// Quarters of FCY's period in a cycle of the master clock with CANCKS clear, and set.
        std::uint8_t clock_quarters = 4, clock_quarters_set = 4;
        std::uint8_t transmitters = 3;  ///< buffers that can send
    };
    virtual ~CanLine() = default;

    /// What the bus has to say at cycle `at`.
    void news(const cosim::CanMessage& message, Cycle at);
    /// Sleep, or Idle with CSIDL set: only the wake-up interrupt is left.
    void hold(bool on);
    /// Cycles of a bit times 4, by the timing registers.
    Cycle bit_quarters() const;

    template <class Archive>
    void state(Archive& archive) {
        archive(state_);
    }

  protected:
    enum class Mode : std::uint8_t { Normal, Disable, Loopback, ListenOnly, Configuration, ListenAll = 7 };

    CanLine(const Surroundings& around, const Place& place, const cosim::ClockDomain& clock, Ports& ports,
            Pins& pins);

    void reset_line();
    Mode mode() const;
    std::uint16_t& reg(std::uint16_t address) const { return around_.sfr.raw(address); }
    /// The buffer asks to be sent, or no longer; `was_asked`: before this write.
    void control_written(int buffer, bool was_asked);
    /// CxCTRL's common part: ABAT, REQOP.
    void mode_written();
    /// Sets these flags in CxINTF, and interrupts if one is enabled.
    void set_flags(std::uint16_t flags, Cycle at);
    /// A write to CxINTF (flags in `clearable` are cleared by 0), CxINTE or CxEC.
    void interrupts_written(std::uint16_t address, std::uint16_t value, std::uint16_t mask,
                            std::uint16_t clearable);

    // A transmit buffer's control byte: TXABT 6, TXLARB 5, TXERR 4, TXREQ 3, TXPRI 1:0.
    static constexpr std::uint8_t kTxAbt = 0x40, kTxLarb = 0x20, kTxErr = 0x10, kTxReq = 0x08, kTxPri = 0x03;
    virtual std::uint8_t control_of(int buffer) const = 0;
    virtual void set_control(int buffer, std::uint8_t control) = 0;
    virtual CanFrame frame_of(int buffer, Cycle at) = 0;
    virtual void was_sent(int buffer, Cycle at) = 0;
    /// Filters and stores a frame that was received whole.
    virtual void deliver(const CanFrame& frame, Cycle at) = 0;
    /// Shows the interrupt code of what is pending.
    virtual void show_code() = 0;

    Surroundings around_;

  private:
    /// Of a bit.
    struct Quanta {
        unsigned all = 0, behind_sample = 0;
    };
    Quanta bit_quanta() const;

    static constexpr std::uint8_t kNobody = 0xFF, kMostBuffers = 8;
    /// To the bus.
    enum class Role : std::uint8_t { Off, Watches, Joined, Listens };
    struct State {
        std::uint8_t sending = kNobody;  ///< transmit buffer whose frame is on the wire or offered
        CanFrame frame;
        Cycle bus_free = 0;          ///< intermission is over
        Cycle mode_due = kNoCycle;   ///< the mode asked for is entered
        Cycle frame_due = kNoCycle;  ///< the frame ends; nobody sends: the next one begins. Not on a bus
        std::uint16_t errors = 0;    ///< transmit error count; over 255: bus off
        bool held = false;
        Role role = Role::Off;
        bool withdrawn = false;     ///< what was offered is not wanted any more; the bus's answer is awaited
        std::uint8_t aborting = 0;  ///< buffers, by bit, whose program gave them up meanwhile

        template <class Archive>
        void state(Archive& archive) {
            archive(sending);
            archive.check(sending < kMostBuffers || sending == kNobody, "a transmit buffer that is none");
            archive(frame, bus_free, mode_due, frame_due, errors, held);
            archive.bounded(role, Role::Off, Role::Listens);
            archive(withdrawn, aborting);
        }
    };

    static void due(void* owner, Cycle due);
    bool asks(int buffer) const { return control_of(buffer) & kTxReq; }
    void change_control(int buffer, std::uint8_t clear, std::uint8_t set);
    Cycle bits(Cycle count) const { return (count * bit_quarters() + 3) / 4; }
    void request_mode(Cycle at);
    void enter_mode(Cycle at);
    void take_over_pins(Cycle at);
    void abort(int buffer);
    int best_buffer() const;
    void look_for_frame(Cycle at);
    void send(Cycle at);
    void end_frame(Cycle at);
    void count_errors(unsigned transmit, unsigned receive, Cycle at);
    void show_errors();
    void plan();

    // With a bus (can_line_bus.cpp).
    bool on_bus() const { return wired_ && mode() != Mode::Loopback; }
    void take_role(Cycle at);
    cosim::CanMessage join() const;
    void offer(Cycle at);
    void withdraw(Cycle at);
    void given_up(int buffer);
    void tell_bus(cosim::CanMessage message, Cycle at);

    Place place_;
    const cosim::ClockDomain& clock_;
    Ports& ports_;
    Pins& pins_;
    State state_;
    EventQueue::Slot slot_;
    const bool wired_;  ///< to a bus
};

}  // namespace puckloop::dspic
