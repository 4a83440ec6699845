#pragma once
// A partner on the host: a pseudo terminal, a TCP client. LiveEnd paces what goes to it and comes from it.

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>

namespace puckloop::exec {

/// All calls but the const ones come from LiveEnd's I/O thread; those may come from any thread.
class HostStream {
  public:
    virtual ~HostStream() = default;

    /// Where to find it: "pty /dev/pts/3".
    virtual std::string announcement() const = 0;
    /// Somebody has it open; what is sent to nobody is lost.
    virtual bool there() const = 0;
    /// The rate that the partner has set, 0 if it hung up so (B0); nothing where a rate has no meaning.
    virtual std::optional<double> baud() const { return std::nullopt; }

    /// Calls `then` once there may be bytes; one call at a time.
    virtual void await_readable(std::function<void()> then) = 0;
    /// Takes what there is, at most a block; 0 if there is nothing now.
    virtual std::size_t read(std::span<std::uint8_t> block) = 0;
    /// Returns how many bytes were taken; 0 if there is no room now, or nobody.
    virtual std::size_t write(std::span<const std::uint8_t> bytes) = 0;
    /// In a paced run what it has no room for may wait for it; else that is lost, as at a serial port.
    virtual bool waits() const = 0;
};

}  // namespace puckloop::exec
