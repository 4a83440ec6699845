#pragma once
// CAN1 and CAN2 of the 30F: three transmit buffers, two receive buffers, six filters, two masks, bit timing,
// error counters and interrupts. The bus is the board's: a frame goes out through Pins::can_sent() when its
// acknowledge is due and comes in through receive(). Source: dsPIC30F Family Reference Manual, section 23
// (DS70070), and DS70143.
//
// Deviations
//  1. Frames take their exact time on the wire, stuff bits included, but arbitration is not played: who
//  begins
//     to send is not disturbed. The bus is known to be busy only by this module's own frames.
//  2. Entering Normal, Listen Only or Listen All mode takes 11 bit times after the request, or after the
//  frame
//     under way; the other modes are entered at once, or after that frame. Intermission: 3 bits.
//  3. A frame received is handed in at its end; REC counts down only: what is broken never comes in. Bus-off
//     ends after 128 times 11 bit times.
//  4. CANCAP, CANFRZ, SAM, SJW and WAKFIL are stored. C?TX rests at the recessive level.

#include "emu/dspic/peripherals/can_frame.h"
#include "emu/dspic/peripherals/pins.h"
#include "emu/dspic/peripherals/ports.h"
#include "emu/dspic/peripherals/surroundings.h"

#include <cstdint>
#include <optional>

namespace puckloop::dspic {

class Can {
  public:
    struct Setup {
        int unit = 1;
        std::uint16_t base = 0;  ///< CxRXF0SID; all others follow at fixed distances
        std::uint8_t irq = 0;
        PortLetter port{};
        std::uint8_t rx = 0, tx = 0;
    };
    static constexpr int kWords = 78;  ///< from the first register to the last
    /// CxCTRL.
    static constexpr std::uint16_t control(const Setup& setup) {
        return static_cast<std::uint16_t>(setup.base + 0x90);
    }
    Can(const Surroundings& around, const Setup& setup, Ports& ports, Pins& pins);

    void reset();
    /// A frame that somebody else sent ends at cycle `at`. True: this module acknowledged it.
    bool receive(const CanFrame& frame, Cycle at);
    /// Sleep, or Idle with CANSIDL set: only the wake-up interrupt is left.
    void hold(bool on);
    /// Cycles of a bit times 4, by the timing registers.
    Cycle bit_quarters() const;

    template <class Archive>
    void state(Archive& archive) {
        archive(state_);
    }

  private:
    static constexpr int kTransmitters = 3;
    static constexpr std::uint8_t kNobody = 0xFF;
    enum class Mode : std::uint8_t { Normal, Disable, Loopback, ListenOnly, Configuration, ListenAll = 7 };
    struct State {
        std::uint8_t sending = kNobody;  ///< transmit buffer whose frame is on the wire
        CanFrame frame;
        Cycle bus_free = 0;          ///< intermission is over
        Cycle mode_due = kNoCycle;   ///< the mode asked for is entered
        Cycle frame_due = kNoCycle;  ///< the frame ends; nobody sends: the next one begins
        Cycle recovery = kNoCycle;   ///< of bus-off
        std::uint16_t errors = 0;    ///< transmit error count; over 255: bus off
        bool held = false;

        template <class Archive>
        void state(Archive& archive) {
            archive(sending);
            archive.check(sending < kTransmitters || sending == kNobody, "a transmit buffer that is none");
            archive(frame, bus_free, mode_due, frame_due, recovery, errors, held);
        }
    };

    static void write_transmit(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void write_receive(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void write_setup(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void write_control(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void write_interrupts(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void due(void* owner, Cycle due);

    std::uint16_t& reg(int offset) const {
        return around_.sfr.raw(static_cast<std::uint16_t>(setup_.base + offset));
    }
    Mode mode() const;
    bool on_bus() const;  ///< Normal mode, not bus off
    Cycle bits(Cycle count) const { return (count * bit_quarters() + 3) / 4; }
    void request_mode(Cycle at);
    void enter_mode(Cycle at);
    void lend_pins(Cycle at);
    void abort(int buffer);
    void look_for_frame(Cycle at);
    void send(Cycle at);
    void end_frame(Cycle at);
    void count_errors(CanOutcome outcome, Cycle at);
    void show_errors();
    void set_flags(std::uint16_t flags, Cycle at);
    void show_code();
    void plan();
    CanFrame frame_of(int buffer) const;

    // Reception (can_receive.cpp).
    void deliver(const CanFrame& frame, Cycle at);
    std::optional<int> filter_hit(const CanFrame& frame, int first, int last, int mask) const;
    void store(int buffer, const CanFrame& frame, int filter, Cycle at);

    Surroundings around_;
    Setup setup_;
    Ports& ports_;
    Pins& pins_;
    State state_;
    EventQueue::Slot slot_;
};

}  // namespace puckloop::dspic
