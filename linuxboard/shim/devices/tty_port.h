#pragma once
// A serial port of the Linux board: UART, driver buffers and line discipline in simulated time.
//
// Bytes leave back to back from the moment they are written, at the programmed rate and format; received
// frames are sampled at the port's own rate. A port that no program has open hears nothing.
//
// Received characters wait in the UART's FIFO until `trigger` of them are there or the line has been idle for
// four character times, as 16550-like UARTs do (the drivers of both 8250 and PXA set the trigger to 8).
// Behind a radio or a USB adapter they then wait for the driver's next tick (`batch`).
//
// Deviations: 1. An overrun of the FIFO cannot happen: the driver empties it at once.
// 2. No modem lines: DCD, DSR and CTS read as set, RTS and DTR are stored. 3. CRTSCTS does not stop output.
// 4. Input speed equals output speed.

#include "cosim/core/message.h"
#include "cosim/core/time.h"
#include "linuxboard/shim/devices/line_discipline.h"
#include "linuxboard/shim/devices/tty_settings.h"
#include "linuxboard/shim/wire/wire.h"
#include "protocols/serial/uart_line.h"

#include <algorithm>
#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::linuxboard {

class TtyPort {
  public:
    /// Bytes the driver takes before write() blocks.
    static constexpr std::size_t kOutputSize = 4095;

    static constexpr int kTrigger = 8;

    /// `ppm` is the error of the board's clock; `trigger` the receive FIFO's level, 1 hands on every
    /// character. With `batch` above 0 what is received is handed on at whole multiples of it.
    explicit TtyPort(double ppm = 0.0, int trigger = kTrigger, cosim::Time batch = 0)
        : ppm_(ppm), rate_ppm_(ppm), trigger_(trigger), batch_(batch) {}

    void open();
    /// The last close: what is written still goes out, what is received is dropped from now on.
    void close();
    bool is_open() const { return opens_ > 0; }
    /// The next close is the last one.
    bool is_open_once() const { return opens_ == 1; }
    /// What is written goes out by itself: nothing stops it.
    bool sends() const { return output_.empty() || can_send(); }
    /// The line is gone until the next open: reads return 0, writes fail.
    void hang_up();
    bool hung_up() const { return hung_up_; }

    /// A frame that was delivered at `delivered`.
    void deliver(const cosim::UartFrame& frame, cosim::Time delivered);
    /// Whether this frame would bring the FIFO to its level, so that it may be handed on at once.
    bool fills(const cosim::UartFrame& frame) const;
    /// Handles everything up to and including `now`; frames begun go to `sent`.
    void advance(cosim::Time now, std::vector<cosim::UartFrame>& sent);
    /// When advance() next has something to do.
    cosim::Time next_event() const;
    /// When a program next sees something come in, as far as the characters known so far show.
    cosim::Time next_input() const { return std::min(fifo_due(), next_tick(listener_.ask_again())); }
    /// What a program sees of the port, but for `valid_until`.
    void show(wire::TtyView& view) const;
    /// Start of the next frame if nothing changes: at or after `now`; kNever if none is queued.
    cosim::Time next_frame(cosim::Time now) const;
    /// A received character may cause output without the program (echo, flow control).
    bool echoes() const;

    std::size_t readable() const { return discipline_.readable(settings_); }
    /// What read() and poll() wait for: a line, or VMIN bytes where VTIME is 0, or one byte.
    bool input_ready() const;
    std::size_t input_queue() const { return discipline_.queued(settings_); }
    std::string read(std::size_t most) { return discipline_.take(most, settings_); }
    bool canonical() const { return (settings_.c_lflag & ICANON) != 0; }
    /// Time of the last character that came in, or kNever before the first.
    cosim::Time last_input() const { return last_input_; }

    /// Takes as many bytes as there is room for.
    std::size_t write(std::string_view data, cosim::Time now);
    std::size_t output_room() const {
        return output_.size() >= kOutputSize ? 0 : kOutputSize - output_.size();
    }
    /// Bytes not yet on the wire, the one being shifted out included.
    std::size_t output_queue(cosim::Time now) const { return output_.size() + (now < line_free_ ? 1 : 0); }
    bool drained(cosim::Time now) const { return output_.empty() && now >= line_free_; }
    /// When drained() becomes true, as far as that is known.
    cosim::Time drain_time() const { return output_.empty() ? line_free_ : cosim::kNever; }
    /// A break of `length`, after what is already written.
    void send_break(cosim::Time now, cosim::Time length);

    const termios& settings() const { return settings_; }
    void configure(const termios& settings);
    /// The bit rate is another than the one set, by so much beside the clock's own error.
    void distort_rate(double factor) { rate_ppm_ = ppm_ + (1e6 + ppm_) * (factor - 1.0); }
    void flush_input() { discipline_.discard(); }
    void flush_output();
    /// TIOCSTI: as if the line had brought it, but for the driver's counters.
    void insert(char byte, cosim::Time now);
    void stop_output() { stopped_ = true; }
    void start_output(cosim::Time now);

    wire::TtyCounters counters() const;

  private:
    /// Something may come in, and `receiver` would hear it.
    bool hears(const protocols::UartReceiver& receiver) const;
    /// When the characters in the FIFO go to the line discipline, as far as those known show.
    cosim::Time fifo_due() const;
    /// The driver's first tick at or after `time`.
    cosim::Time next_tick(cosim::Time time) const;
    void arrive(const std::vector<protocols::ReceivedCharacter>& characters, cosim::Time known);
    void take(const protocols::ReceivedCharacter& character);
    void discipline(const protocols::ReceivedCharacter& character);
    bool can_send() const { return !output_.empty() && !stopped_ && bit_period(settings_, rate_ppm_) != 0; }

    struct Arrival {
        cosim::Time time = 0;
        protocols::ReceivedCharacter character;
    };
    struct Output {
        char byte = 0;
        cosim::Time not_before = 0;
        cosim::Time break_length = 0;
    };

    double ppm_;
    double rate_ppm_;  ///< of the rate set, the clock's error included
    int trigger_;
    cosim::Time batch_;
    termios settings_ = initial_termios();
    LineDiscipline discipline_;
    std::deque<Arrival> arriving_;
    std::deque<Output> output_;
    protocols::UartListener listener_;
    cosim::Time line_free_ = 0;
    cosim::Time released_ = 0;
    cosim::Time last_input_ = cosim::kNever;
    int opens_ = 0;
    bool hung_up_ = false;
    bool stopped_ = false;
    wire::TtyCounters counters_;
};

}  // namespace puckloop::linuxboard
