#pragma once
// The terminal line discipline (N_TTY) of one serial port: what stands between received characters and
// read(), and between write() and the wire, as termios(3) describes it.
//
// Deviations: 1. A port is nobody's controlling terminal: INTR, QUIT and SUSP characters send no signals and
// are dropped in ISIG mode. 2. Word erase, reprint and literal-next are not acted on.
// 3. IXOFF is stored only.

#include "protocols/serial/uart_sampling.h"

#include <termios.h>

#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>

namespace puckloop::linuxboard {

class LineDiscipline {
  public:
    /// What the driver must send, or do, because of a received character.
    struct Effect {
        std::string echo;
        bool stop_output = false;
        bool start_output = false;
    };

    /// Bytes that the kernel's read buffer holds.
    static constexpr std::size_t kBufferSize = 4096;

    Effect receive(const protocols::ReceivedCharacter& character, const termios& settings);
    /// `byte` as written by a program, as it goes to the wire.
    static std::string output(char byte, const termios& settings);

    /// Bytes that read() may return now: in canonical mode those of the first complete line.
    std::size_t readable(const termios& settings) const;
    /// A complete line, or an end-of-file mark, waits (canonical mode).
    bool has_line() const { return lines_ > 0; }
    /// Bytes received and not read, for FIONREAD.
    std::size_t queued(const termios& settings) const;
    std::string take(std::size_t most, const termios& settings);
    /// What take() would return, outside of canonical mode.
    void copy(std::size_t most, char* out) const;
    void discard();

    std::uint64_t dropped() const { return dropped_; }

  private:
    struct Item {
        char byte = 0;
        bool ends_line = false;
        bool is_end_of_file = false;
    };

    void push(char byte, bool ends_line = false, bool is_end_of_file = false);
    void erase_last(Effect& effect, const termios& settings);

    std::deque<Item> buffer_;
    std::size_t lines_ = 0;
    std::uint64_t dropped_ = 0;
};

}  // namespace puckloop::linuxboard
