#pragma once
// USART0 and USART1: baud rate generator, transmit buffer and shift register, two-deep receive FIFO with its
// errors, 5 to 9 data bits, multi-processor mode. What has a clock line is ClockedUsart's. Source: data sheet
// 8272, "USART".
//
// Deviations
//  1. UMSELn = 2, which is reserved, is reported and counts as asynchronous. Frames on a link reach a
//     synchronous receiver only if XCK is its own; a slave of XCK hears the pin.
//  2. Asynchronous: between frames and in them the TXD pin is shown high: the line's waveform is in the
//  frame.
//  3. A frame begins at the next tick of the baud rate generator's 16x (8x) clock.
//  4. The majority of three samples is taken as the middle one.

#include "cosim/core/clock.h"
#include "cosim/core/message.h"
#include "cosim/core/message_state.h"
#include "emu/avr/peripherals/ports.h"
#include "emu/avr/peripherals/serial/clocked_usart.h"
#include "emu/avr/peripherals/surroundings.h"
#include "emu/chip/uart_counters.h"
#include "emu/chip/uart_receiver.h"

#include <cstdint>
#include <deque>
#include <optional>

namespace puckloop::avr {

class Usart final : private ClockedUsart::Owner {
  public:
    struct Setup {
        int unit = 0;
        std::uint16_t base = 0;  ///< UCSRnA; UCSRnB, UCSRnC, UBRRnL, UBRRnH, UDRn at +1, +2, +4, +5, +6
        int receive_vector = 0;  ///< USARTn_RX; UDRE and TX follow
        Pin rxd{}, txd{}, xck{};
        std::uint8_t power_bit = 0;  ///< of PRR0
    };
    Usart(const Surroundings& around, const Setup& setup, const cosim::ClockDomain& clock, Ports& ports,
          Pins& pins);

    void reset();
    /// A frame whose stop bit begins at cycle `at`.
    void receive(const cosim::UartFrame& frame, Cycle at);
    /// The frame in the shift register, if its stop bit has not begun.
    std::optional<cosim::UartFrame> begun() const;
    bool receiving() const;  ///< RXENn
    const chip::UartCounters& counters() const { return counters_; }

    template <class Archive>
    void state(Archive& archive) {
        archive(state_, counters_, receiver_, clocked_);
        archive.check(!state_.shifting || state_.frame.bit_period > 0, "a frame without a bit period");
        archive.check(state_.fifo.size() <= 3, "more characters than a USART holds");
    }

  private:
    struct Received {
        std::uint16_t data = 0;
        std::uint8_t errors = 0;  ///< FEn, DORn, UPEn in their places

        template <class Archive>
        void state(Archive& archive) {
            archive(data, errors);
        }
    };
    struct State {
        std::deque<Received> fifo;  ///< two characters, and a third that waits in the shift register
        std::optional<std::uint16_t> buffer;  ///< written, not yet in the shift register
        std::optional<std::uint16_t> early;   ///< written while the transmitter was off
        bool shifting = false;
        bool stop_begun = false;
        bool transmitter_on = false;
        Cycle frame_end = 0;
        cosim::UartFrame frame;
        std::optional<chip::UartReceiver::Character> sampled;  ///< complete at its `done`
        Cycle phase = 0;                                       ///< the baud rate generator started here

        template <class Archive>
        void state(Archive& archive) {
            archive(fifo, buffer, early, shifting, stop_begun, transmitter_on, frame_end, frame, sampled,
                    phase);
        }
    };

    std::uint8_t& reg(int offset) const {
        return around_.io.raw(static_cast<std::uint16_t>(setup_.base + offset));
    }
    std::uint8_t& a() const { return reg(0); }
    std::uint8_t& b() const { return reg(1); }
    std::uint8_t& c() const { return reg(2); }
    std::uint32_t divisor() const { return static_cast<std::uint32_t>(reg(5) << 8 | reg(4)) + 1; }
    unsigned mode() const;
    bool clocked() const;
    void configure_clocked();
    std::uint32_t ticks_per_bit() const;
    int data_bits() const;
    int parity() const;
    bool powered() const;
    void update_requests();
    void show_receiver();
    void begin_frame(Cycle from);
    void sample(Cycle now);
    void deliver(const chip::UartReceiver::Character& character);
    void enable_receiver(bool on);
    void enable_transmitter(bool on);
    void transmit(std::uint16_t word);

    std::optional<std::uint16_t> take_word() override;
    void frame_out(const cosim::UartFrame& frame) override;
    void word_out() override { ++counters_.sent; }
    void all_out() override;
    void word_in(Cycle now, std::uint16_t word, bool framing_error, bool parity_error) override;
    bool listens() const override { return receiving(); }

    static std::uint8_t read_data(void* owner, std::uint16_t address);
    static void write_data(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask);
    static void write_a(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask);
    static void write_b(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask);
    static void write_c(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask);
    static void write_baud(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask);
    static void acknowledge_transmitted(void* owner, int vector);
    static void transmit_due(void* owner, Cycle due);
    static void receive_due(void* owner, Cycle due);

    Surroundings around_;
    Setup setup_;
    const cosim::ClockDomain& clock_;
    Ports& ports_;
    Pins& pins_;
    chip::UartReceiver receiver_;
    State state_;
    chip::UartCounters counters_;
    ClockedUsart clocked_;
    EventQueue::Slot transmit_slot_;
    EventQueue::Slot receive_slot_;
};

}  // namespace puckloop::avr
