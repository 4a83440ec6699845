#pragma once
// The data converter interface: words to and from a codec in frames of up to 16 slots. One word at a time is
// exchanged with the board through Pins::dci_exchange().
// Source: dsPIC30F Family Reference Manual, section 22, DS70143 section 18, DS70286; fact sheet
// peripherals.md section 7.
//
// The bit clock is 2*(BCG+1) cycles. Frames: multichannel COFSG+1 words of WS+1 bits; I2S the same between
// two edges of the frame sync, each of which starts slot 0; 16-bit AC-Link a slot of 16 bits and twelve of
// 20, whose first 16 count; 20-bit AC-Link sixteen slots of 16. Of TXBUF and RXBUF the first BLEN+1 are in
// use: each enabled slot takes the next, and after the last one both sets change places with their shadows
// (DCIIF).
//
// Slave: CSCKD = 1 takes the bit clock of Pins::dci_master(), whatever BCG holds, COFSD = 1 its frame syncs.
// A frame's data begin with the sync or a bit behind it (DJST); a sync while a frame is under way is not
// heard, and behind a frame shorter than the codec's nothing moves until the next. With the codec's bit clock
// the module runs on in Sleep. The last two rules are taken from other parts of the family: the manual's text
// was not at hand.
//
// Deviations
//  1. Clocks of a codec are even: it counts the bits of its own clock or of the chip's, from DCIEN on. Both
//  driving one pin is not noticed.
//  2. Of its own clock the first frame sync comes in the cycle after DCIEN is set, of a codec's with its next
//  edge; the transmit buffers move to their shadows then.
//  3. Clearing DCIEN stops everything at once, in mid-word, and clears DCISTAT; the buffers stay.
//  4. DCICON2, DCICON3, TSCON and RSCON count from the next frame on (BLEN: the next word).
//  5. A word is exchanged in one piece when its last bit is over; CSCKE does not change its timing, and the
//  pins
//     rest low (ports.h, deviation 3).
//  6. Halted in Idle (DCISIDL) a slave loses the rest of its frame and goes on with the next.

#include "cosim/core/clock.h"
#include "emu/dspic/peripherals/pins.h"
#include "emu/dspic/peripherals/ports.h"
#include "emu/dspic/peripherals/surroundings.h"

#include <array>
#include <cstdint>

namespace puckloop::dspic {

class Dci {
  public:
    struct Setup {
        std::uint16_t con1 = 0;  ///< DCICON1, of the 16 words up to TXBUF3; 0: the part has no such module
        std::uint8_t irq = 0;
        std::uint8_t error_irq = 0;  ///< at an overflow or underflow; 0: none
        PortLetter port{};
        std::uint8_t csdi = 0, csdo = 0, csck = 0, cofs = 0;
    };
    Dci(const Surroundings& around, const Setup& setup, const cosim::ClockDomain& clock, Ports& ports,
        Pins& pins);

    void reset();
    /// Sleep without the codec's clock, or Idle with DCISIDL set: the clock stands still.
    void hold(bool on);
    bool runs_in_sleep() const;
    /// The chip's clock has another rate: what comes by the codec's clock comes in other cycles.
    void rate_changed();

    template <class Archive>
    void state(Archive& archive) {
        archive(state_);
        if constexpr (Archive::kLoads && !Archive::kRaw) {
            archive.check(state_.frame.slots >= 1 && state_.frame.slots <= kSlots && state_.slot <= kSlots,
                          "a frame of more than sixteen slots");
            archive.check(state_.frame.word >= 1 && state_.next < kBuffers, "words of no length");
            archive.check(!state_.frame.external || master_.bit > 0,
                          "a bit clock that the codec does not make");
            archive.check(!state_.frame.synced || master_.frame_bits > 0,
                          "frames that the codec does not make");
        }
    }

  private:
    static constexpr unsigned kSlots = 16;
    static constexpr unsigned kBuffers = 4;
    using Words = std::array<std::uint16_t, kBuffers>;

    using Bit = std::uint64_t;  ///< of the bit clock, counted from DCIEN or from the codec's first sync

    /// The timetable of a frame, as the registers stood when it began.
    struct Frame {
        bool external = false, synced = false;  ///< the codec makes the bit clock, the frame sync
        std::uint32_t bit = 2;                  ///< cycles; of the codec's clock rounded
        std::uint8_t first = 16;                ///< bits of slot 0
        std::uint8_t word = 16;                 ///< bits of every other slot
        std::uint8_t slots = 1;
        std::uint8_t bits = 16;  ///< of a word that are transferred
        std::uint16_t transmit = 0, receive = 0;

        template <class Archive>
        void state(Archive& archive) {
            archive(external, synced, bit, first, word, slots, bits, transmit, receive);
        }
    };
    struct State {
        bool running = false;
        bool waiting = false;  ///< the event is the beginning of slot 0
        bool held = false;
        Frame frame;
        Bit begun = 0;   ///< slot 0 of the frame
        Cycle base = 0;  ///< of the chip's own bit clock: when bit `base_bit` begins
        Bit base_bit = 0;
        Cycle held_at = 0;
        std::uint8_t slot = 0;  ///< that ends at the event; `slots` of the frame: only the frame does
        std::uint8_t next = 0;  ///< buffer that the next enabled slot takes
        std::uint8_t written = 0, unread = 0, starved = 0;  ///< buffers, a bit each
        Words out{}, in{};                                  ///< the shadows

        template <class Archive>
        void state(Archive& archive) {
            archive(running, waiting, held, frame, begun, base, base_bit, held_at, slot, next, written,
                    unread, starved, out, in);
        }
    };

    static std::uint16_t read_stat(void* owner, std::uint16_t address);
    static std::uint16_t read_rxbuf(void* owner, std::uint16_t address);
    static std::uint16_t look_rxbuf(void* owner, std::uint16_t address);
    static void write_txbuf(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void write_con1(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void write_con3(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void write_nothing(void*, std::uint16_t, std::uint16_t, std::uint16_t) {}
    static void due(void* owner, Cycle due);

    bool clocked() const;
    unsigned in_use() const;
    unsigned delay() const;
    void start(Cycle from);
    void enter(Cycle from);
    void await_frame(Bit earliest);
    void begin_frame();
    void next_frame(Cycle at);
    void plan(unsigned from_slot);
    Cycle cycle_of(Bit bit) const;
    Bit after(unsigned slot) const;
    Cycle event() const;
    void exchange(Cycle at);
    void swap(Cycle at, bool interrupt);
    void take_over_pins();
    std::uint16_t& reg(int offset) const {
        return around_.sfr.raw(static_cast<std::uint16_t>(setup_.con1 + offset));
    }

    Surroundings around_;
    Setup setup_;
    const cosim::ClockDomain& clock_;
    Ports& ports_;
    Pins& pins_;
    DciMaster master_;
    State state_;
    EventQueue::Slot slot_;
};

}  // namespace puckloop::dspic
