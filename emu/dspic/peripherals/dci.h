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
// Deviations
//  1. A codec that makes the bit clock or the frame sync (CSCKD, COFSD = 1; BCG = 0) does not exist: no word
//  moves.
//  2. The first frame sync comes in the cycle after DCIEN is set; the transmit buffers move to their shadows
//  then.
//  3. Clearing DCIEN stops everything at once, in mid-word, and clears DCISTAT; the buffers stay.
//  4. DCICON2, DCICON3, TSCON and RSCON count from the next frame on (BLEN: the next word).
//  5. A word is exchanged in one piece when its last bit is over; CSCKE does not change its timing, and the
//  pins
//     rest low (ports.h, deviation 3).

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
    Dci(const Surroundings& around, const Setup& setup, Ports& ports, Pins& pins);

    void reset();
    /// Sleep, or Idle with DCISIDL set: the clock stands still.
    void hold(bool on);

    template <class Archive>
    void state(Archive& archive) {
        archive(state_);
        if constexpr (Archive::kLoads && !Archive::kRaw) {
            archive.check(state_.frame.slots >= 1 && state_.frame.slots <= kSlots && state_.slot <= kSlots,
                          "a frame of more than sixteen slots");
            archive.check(state_.frame.word >= 1 && state_.next < kBuffers, "words of no length");
        }
    }

  private:
    static constexpr unsigned kSlots = 16;
    static constexpr unsigned kBuffers = 4;
    using Words = std::array<std::uint16_t, kBuffers>;

    /// The timetable of a frame, as the registers stood when it began.
    struct Frame {
        std::uint32_t bit = 2;     ///< cycles
        std::uint32_t first = 32;  ///< cycles of slot 0
        std::uint32_t word = 32;   ///< cycles of every other slot
        std::uint8_t slots = 1;
        std::uint8_t bits = 16;  ///< of a word that are transferred
        std::uint16_t transmit = 0, receive = 0;

        template <class Archive>
        void state(Archive& archive) {
            archive(bit, first, word, slots, bits, transmit, receive);
        }
    };
    struct State {
        bool running = false;
        bool held = false;
        Frame frame;
        Cycle begun = 0;  ///< slot 0 of the frame
        Cycle held_at = 0;
        std::uint8_t slot = 0;  ///< that ends at the event; `slots` of the frame: only the frame does
        std::uint8_t next = 0;  ///< buffer that the next enabled slot takes
        std::uint8_t written = 0, unread = 0, starved = 0;  ///< buffers, a bit each
        Words out{}, in{};                                  ///< the shadows

        template <class Archive>
        void state(Archive& archive) {
            archive(running, held, frame, begun, held_at, slot, next, written, unread, starved, out, in);
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
    void start(Cycle from);
    void begin_frame(Cycle from);
    void plan(unsigned from_slot);
    Cycle end_of(unsigned slot) const;
    void exchange(Cycle at);
    void swap(Cycle at, bool interrupt);
    void lend_pins();
    std::uint16_t& reg(int offset) const {
        return around_.sfr.raw(static_cast<std::uint16_t>(setup_.con1 + offset));
    }

    Surroundings around_;
    Setup setup_;
    Ports& ports_;
    Pins& pins_;
    State state_;
    EventQueue::Slot slot_;
};

}  // namespace puckloop::dspic
