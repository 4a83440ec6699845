#pragma once
// UART1 and UART2: baud rate generator, 4-deep FIFOs both ways, interrupt modes, errors, break, loopback.
// Source: dsPIC30F Family Reference Manual, section 19, and DS70286; fact sheet peripherals.md section 1.
//
// Deviations
//  1. RIDLE falls when a frame is handed in (at its stop bit), not at its start bit.
//  2. What happens at a start bit is known at its frame's stop bit: with WAKE Sleep ends a frame late. 30F:
//     ABAUD leads the line to input capture (U1RX to IC1, U2RX to IC2), one frame late with exact intervals.
//     33FJ: ABAUD measures one frame of 0x55 and is over at its stop bit; other frames do not count, none is
//     received meanwhile. ALTIO does not move the pins.
//  3. A word written to an idle transmitter moves to the shift register at once; its start bit begins at
//     the next tick of the 16x clock.
//  4. While UTXBRK is set the line is reported low in whole frames, from the end of the frame in progress
//     on. 33FJ: the next word written goes out as one such frame, and UTXBRK clears itself.
//  5. 33FJ (uart_line.cpp): a new level at rest, as UTXINV, IREN and UTXEN make it, is handed out as a frame
//     would be, nine bits after it began; one that lasts less is not. UTXINV and IREN are taken over by the
//     next frame, URXINV at once. IREN does nothing with BRGH = 1, for which the sheet does not have it.
//  6. 33FJ: UxRTS is high while the FIFO is full or OERR is set, not while a character comes in; UEN = 3
//  lends
//     its pin to BCLK, which rests low. UxCTS is looked at when a frame would begin.

#include "cosim/core/clock.h"
#include "cosim/core/message.h"
#include "cosim/core/message_state.h"
#include "emu/dspic/peripherals/pins.h"
#include "emu/dspic/peripherals/ports.h"
#include "emu/dspic/peripherals/serial/uart_counters.h"
#include "emu/dspic/peripherals/serial/uart_receiver.h"
#include "emu/dspic/peripherals/surroundings.h"
#include "protocols/serial/irda.h"

#include <array>
#include <cstdint>
#include <optional>

namespace puckloop::dspic {

class InputCapture;

class Uart {
  public:
    struct Setup {
        int unit = 1;
        std::uint16_t mode = 0;  ///< UxMODE; UxSTA, UxTXREG, UxRXREG, UxBRG follow
        std::uint8_t rx_irq = 0;
        std::uint8_t tx_irq = 0;
        PortLetter port{};  ///< of both pins
        int rx_pin = 0;
        int tx_pin = 0;
        bool family_33f = false;  ///< BRGH, UTXISEL of two bits, a break of 13 bits, no first TX interrupt
        std::uint8_t error_irq = 255;  ///< 33FJ only
        PortLetter flow_port{};        ///< 33FJ: of UxCTS and UxRTS
        int cts_pin = 0;
        int rts_pin = 0;
    };
    Uart(const Surroundings& around, const Setup& setup, const cosim::ClockDomain& clock, Ports& ports,
         Pins& pins);

    /// 30F: what UxMODE<ABAUD> leads the line to.
    void attach(InputCapture& capture) { capture_ = &capture; }
    void reset();
    /// A frame whose stop bit begins at cycle `at`.
    void receive(const cosim::UartFrame& frame, Cycle at);
    /// Sleep, or Idle with USIDL set: frames in progress are lost, the FIFOs stay.
    void hold(bool on);
    /// The frame in the shift register, if its stop bit has not begun, or the level at rest to be handed out.
    std::optional<cosim::UartFrame> begun() const;
    bool enabled() const;
    const UartCounters& counters() const { return counters_; }

    template <class Archive>
    void state(Archive& archive) {
        archive(state_, counters_, receiver_);
        if (setup_.family_33f) archive(line_);
        archive.check(!state_.shifting || state_.frame.bit_period > 0, "a frame without a bit period");
    }

  private:
    static constexpr int kDepth = 4;
    struct Received {
        std::uint16_t data = 0;
        bool framing_error = false;
        bool parity_error = false;

        template <class Archive>
        void state(Archive& archive) {
            archive(data, framing_error, parity_error);
        }
    };
    template <typename Word>
    struct Fifo {
        std::array<Word, kDepth> words{};
        int first = 0;
        int count = 0;

        bool full() const { return count == kDepth; }
        void push(const Word& word) { words[static_cast<std::size_t>((first + count++) % kDepth)] = word; }
        const Word& top() const { return words[static_cast<std::size_t>(first)]; }
        void pop() {
            first = (first + 1) % kDepth;
            --count;
        }
        template <class Archive>
        void state(Archive& archive) {
            archive(words);
            archive.bounded(first, 0, kDepth - 1);
            archive.bounded(count, 0, kDepth);
        }
    };
    struct State {
        Fifo<std::uint16_t> transmit;
        bool shifting = false;
        bool stop_begun = false;  ///< of the frame being shifted: it was handed out
        Cycle frame_end = 0;
        cosim::UartFrame frame;  ///< being shifted
        Fifo<Received> receive;
        std::optional<UartReceiver::Character> sampled;  ///< complete at its `done`
        bool held = false;
        Cycle phase = 0;  ///< the baud rate generator started here

        template <class Archive>
        void state(Archive& archive) {
            archive(transmit, shifting, stop_begun, frame_end, frame, receive, sampled, held, phase);
        }
    };
    /// 33FJ: what is between the module and its line.
    struct LineState {
        bool rests_low = false;                 ///< as the other side knows it
        std::optional<cosim::UartFrame> level;  ///< the other one, to be handed out
        bool turned = false, decodes = false;   ///< how the receiver sees the line (URXINV, IREN)
        protocols::IrdaDecoder infrared;

        template <class Archive>
        void state(Archive& archive) {
            archive(rests_low, level, turned, decodes, infrared);
            archive.check(!level || level->bit_period > 0, "a level without a bit period");
        }
    };

    static std::uint16_t read_rxreg(void* owner, std::uint16_t address);
    static void write_mode(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void write_sta(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void write_txreg(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void write_rxreg(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void write_brg(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void transmit_due(void* owner, Cycle due);
    static void receive_due(void* owner, Cycle due);
    static void level_due(void* owner, Cycle due);
    static void cts_changed(void* owner, bool level, Cycle at);

    std::uint16_t mode_address() const { return setup_.mode; }
    std::uint16_t& mode() const { return around_.sfr.raw(setup_.mode); }
    std::uint16_t& sta() const { return around_.sfr.raw(static_cast<std::uint16_t>(setup_.mode + 2)); }
    std::uint16_t& rxreg() const { return around_.sfr.raw(static_cast<std::uint16_t>(setup_.mode + 6)); }
    std::uint32_t ticks_per_bit() const;
    bool transfer_interrupts() const;
    std::uint16_t writable_sta() const;
    std::uint32_t divisor() const {
        return around_.sfr.raw(static_cast<std::uint16_t>(setup_.mode + 8)) + 1u;
    }
    void clear();
    bool consumed(const cosim::UartFrame& frame, Cycle at);
    void measure(const cosim::UartFrame& frame);
    void take_over_pins();
    // uart_line.cpp
    bool infrared() const;
    bool idles_low() const;
    unsigned flow_pins() const;
    bool cts_holds() const;
    bool rts_low() const;
    void show_rts(Cycle when);
    void update_rest(Cycle at);
    void update_polarity(Cycle at);
    void take_from_line(const cosim::UartFrame& frame, Cycle at);
    void begin_frame(Cycle from);
    void stop_transmitter();
    void show_transmitter();
    UartReceiver::Format format() const;
    void sample(Cycle now);
    void deliver(const UartReceiver::Character& character, Cycle now);
    void show_receiver();

    Surroundings around_;
    Setup setup_;
    const cosim::ClockDomain& clock_;
    Ports& ports_;
    Pins& pins_;
    InputCapture* capture_ = nullptr;
    UartReceiver receiver_;
    State state_;
    LineState line_;
    UartCounters counters_;
    EventQueue::Slot transmit_slot_;
    EventQueue::Slot receive_slot_;
    EventQueue::Slot level_slot_ = 0;  ///< 33FJ
};

}  // namespace puckloop::dspic
