#pragma once
// What stands at the far end of one of the bench's UARTs: a script, the terminal, a pty, a TCP client.

#include "cosim/core/time.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace puckloop::exec {

struct UartSpec;

/// Bytes from the chip that no partner outside got.
struct EndLosses {
    std::uint64_t unconnected = 0;             ///< nobody had the terminal open or was connected
    std::uint64_t unread = 0;                  ///< somebody was there and did not read
    cosim::Time unread_since = cosim::kNever;  ///< start of the first of those
};
/// "1200 bytes from 3.412 s on were lost: the program at tcp 127.0.0.1:4242 did not read them".
std::string text_of(const EndLosses& losses, const std::string& partner);

class UartEnd {
  public:
    virtual ~UartEnd() = default;

    /// When the end's next byte may be begun; kNever while it has none.
    virtual cosim::Time next() const = 0;
    /// Bit period that the partner has set for that byte; 0: the line's own.
    virtual cosim::Time next_bit_period() const { return 0; }
    /// Takes that byte.
    virtual std::uint8_t take() = 0;
    /// Bit period at which the partner samples the line; 0: the line's own.
    virtual cosim::Time bit_period() const { return 0; }
    /// A byte came from the chip, its start bit at `start`. `clean` is false after a framing error.
    virtual void receive(std::uint8_t byte, bool clean, cosim::Time start) = 0;
    /// Once a simulated millisecond: look at the outside. `listening_since`: since when the chip's receiver
    /// has been on without a reset, kNever if it is off.
    virtual void poll(cosim::Time /*now*/, cosim::Time /*listening_since*/) {}
    /// A person or a program with a clock of its own is there: the run is paced by the wall clock.
    virtual bool live() const { return false; }
    /// What to print for the user when the run begins ("pty /dev/pts/3"), or "".
    virtual std::string announcement() const { return {}; }
    /// The run is over; everything received is written out. Throws RunError if that fails.
    virtual void finish() {}
    /// What was lost so far; after finish() all of it.
    virtual EndLosses losses() const { return {}; }
};

/// How `-` offers standard input when it is a pipe or a file (a terminal is live: bytes go as they are
/// typed).
struct StdioOptions {
    /// From this time on, back to back.
    std::optional<cosim::Time> start;
    /// Without `start`: once the chip's receiver has been on for this long without a reset, so that firmware
    /// which resets itself while it boots loses nothing.
    cosim::Time settle = 3 * cosim::kSecond;
    /// Bytes are offered as they arrive, like those of a terminal.
    bool live = false;
};

/// Of an end whose partner has a clock of its own.
struct LiveOptions {
    std::string name = "uart";         ///< for messages on standard error
    cosim::Time bit_period = 8680556;  ///< of the line, in picoseconds
    bool paced = true;                 ///< by the wall clock: no byte sooner than the wire would bring it
};

std::unique_ptr<UartEnd> make_stdio_end(const StdioOptions& options);
/// A pseudo terminal in raw mode, at the line's rate until a program sets another one: bytes are then sampled
/// as at that rate, in both directions. Bytes that nobody reads are lost once its buffer is full, and
/// while nobody has it open after somebody had; both are counted.
std::unique_ptr<UartEnd> make_pty_end(const LiveOptions& options = {});
/// Listens on 127.0.0.1; one client at a time. Bytes sent while there is none are lost, and those for a
/// client that does not read once 1 MiB waits for it; both are counted.
std::unique_ptr<UartEnd> make_tcp_end(std::uint16_t port, const LiveOptions& options = {});

}  // namespace puckloop::exec
