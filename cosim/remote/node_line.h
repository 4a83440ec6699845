#pragma once
// A line of whole messages (protocol.h) to a node that lives in another process, however they are carried.

#include <chrono>
#include <cstdint>
#include <span>
#include <string>

namespace puckloop::cosim {

/// How often a wait of the conductor looks at the clock and at Ctrl-C.
inline constexpr std::chrono::milliseconds kWaitSlice{100};

class NodeLine {
  public:
    virtual ~NodeLine() = default;

    /// Sends `bytes`, a whole message, or what is left of it; waits for space at most `limit`. True when all
    /// of it is out; otherwise it is to be called again for the same message. Throws CodecError where the
    /// other end has damaged the line, as receive() does.
    virtual bool send(std::span<const std::uint8_t> bytes, std::chrono::nanoseconds limit) = 0;
    /// True when body() is a whole message. Reads what is there; with a `limit` waits for more at most so
    /// long, or until a signal comes.
    virtual bool receive(std::chrono::nanoseconds limit) = 0;
    /// Body of the message that receive() completed, valid until the next receive().
    virtual std::span<const std::uint8_t> body() const = 0;

    /// The other end is gone. Asked before looking for what it said: a node that dies has said it before.
    virtual bool ended() = 0;
    /// After that, how it went: "was killed by signal 9 (Killed)".
    virtual std::string ending() = 0;
    /// The node has given its report: there is nothing more to say.
    virtual void close() = 0;

    /// For messages: "process 4711".
    virtual std::string place() const = 0;
    /// Of this machine, that the node lives in; 0: none of its own.
    virtual int process() const { return 0; }
};

}  // namespace puckloop::cosim
