#pragma once
// What a USART does with a clock line: synchronous frames, as master or slave of XCK, and SPI master mode.
// Bit by bit at TXD, RXD and XCK. Source: data sheet 8272, "USART", "Synchronous Clock Operation", and "USART
// in SPI mode".
//
// Deviations
//  1. A slave of XCK sees its edges without the synchroniser's two clocks, however fast they are.
//  2. In SPI master mode XCK's first half period begins two clocks after the write to UDRn: a clock to the
//     shift register and one more, as a measurement has it to within four clocks (docs/measured_silicon.md).

#include "cosim/core/clock.h"
#include "cosim/core/message.h"
#include "cosim/core/message_state.h"
#include "emu/avr/peripherals/ports.h"
#include "emu/avr/peripherals/surroundings.h"

#include <cstdint>
#include <optional>

namespace puckloop::avr {

class ClockedUsart {
  public:
    enum class Mode : std::uint8_t { Off, Synchronous, SpiMaster };
    struct Format {
        Mode mode = Mode::Off;
        std::uint8_t data_bits = 8;
        std::uint8_t parity = 0;  ///< as frames count it
        std::uint8_t stop_bits = 1;
        bool polarity = false;      ///< UCPOLn
        bool late = false;          ///< UCPHAn
        bool lowest_first = false;  ///< UDORDn
        Cycle half = 1;             ///< clocks between edges of a clock of its own: UBRRn + 1

        friend bool operator==(const Format&, const Format&) = default;
        template <class Archive>
        void state(Archive& archive) {
            archive.bounded(mode, Mode::Off, Mode::SpiMaster);
            archive.bounded(data_bits, 5, 9);
            archive.bounded(parity, 0, 2);
            archive.bounded(stop_bits, 1, 2);
            archive(polarity, late, lowest_first);
            archive.bounded(half, 1, 0x1000);
        }
    };
    /// The USART around it.
    class Owner {
      public:
        /// The word that was written, if there is one: it moves to the shift register.
        virtual std::optional<std::uint16_t> take_word() = 0;
        /// The stop bit of a synchronous frame begins.
        virtual void frame_out(const cosim::UartFrame& frame) = 0;
        /// A word went out in SPI master mode.
        virtual void word_out() = 0;
        /// The last word is out, and no other was written.
        virtual void all_out() = 0;
        virtual void word_in(Cycle now, std::uint16_t word, bool framing_error, bool parity_error) = 0;
        virtual bool listens() const = 0;

      protected:
        ~Owner() = default;
    };
    ClockedUsart(const Surroundings& around, const cosim::ClockDomain& clock, Ports& ports, Owner& owner,
                 Pin xck, Pin rxd, Pin txd);

    void reset();
    /// Another format, or the direction of XCK changed.
    void configure(const Format& format);
    /// A word was written.
    void kick();
    /// A word is in the shift register.
    bool busy() const { return state_.busy; }
    /// The receiver was switched on or off.
    void restart_receiver() { state_.in_frame = false; }
    /// The start bit of the frame in the shift register, if its stop bit has not begun.
    std::optional<cosim::UartFrame> begun() const;
    /// A cycle in which the receiver samples, of a master of XCK; frames on a link are sampled by it.
    std::optional<Cycle> sampling_phase() const;

    template <class Archive>
    void state(Archive& archive) {
        archive(state_);
    }

  private:
    struct State {
        Format format;
        bool master = false;     ///< XCK is its own, and runs
        bool level = false;      ///< of XCK
        Cycle origin = 0;        ///< XCK was low here, `half` before its first rising edge
        bool busy = false;       ///< a word is in the shift register
        std::uint16_t out = 0;   ///< bits still to go out, next one lowest
        std::uint8_t left = 0;   ///< how many
        bool started = false;    ///< the start bit stands on the line
        cosim::UartFrame frame;  ///< that goes out
        std::uint8_t edges = 0;  ///< SPI: of XCK in this word
        std::uint8_t shift = 0;
        bool incoming = false;
        bool in_frame = false;
        std::uint8_t count = 0;  ///< bits after the start bit
        std::uint16_t in = 0;
        bool ones_odd = false;
        bool parity_error = false;

        template <class Archive>
        void state(Archive& archive) {
            archive(format, master, level, origin, busy, out);
            archive.bounded(left, 0, 13);
            archive(started, frame);
            archive.bounded(edges, 0, 16);
            archive(shift, incoming, in_frame);
            archive.bounded(count, 0, 12);
            archive(in, ones_odd, parity_error);
        }
    };
    void load(std::uint16_t word);
    void clock_edge(Cycle now, bool rising);
    void change(Cycle now);
    void sample(Cycle now);
    void spi_edge(Cycle now);
    void begin_spi(Cycle now);
    void show_bit();
    static void due(void* owner, Cycle cycle);
    static void pins_changed(void* owner, PortLetter port, std::uint8_t before, std::uint8_t after,
                             Cycle now);
    static void drivers_changed(void* owner, PortLetter port);

    Surroundings around_;
    const cosim::ClockDomain& clock_;
    Ports& ports_;
    Owner& owner_;
    Pin xck_, rxd_, txd_;
    State state_;
    EventQueue::Slot slot_;
};

}  // namespace puckloop::avr
