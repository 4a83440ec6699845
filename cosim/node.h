#pragma once
// A node: one emulated board, the physics world, a Linux process, a bus, or the outside.

#include "cosim/message.h"
#include "cosim/time.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::cosim {

enum class PortKind : std::uint8_t { Uart, I2c, Signals };

/// A named place where a link can be attached.
struct Port {
    std::string name;  ///< "uart2", "i2c", "world", ...
    PortKind kind = PortKind::Uart;
};

/// Why a node wants the whole run to end, and when.
struct Stop {
    Time time = 0;
    bool success = true;
    std::string reason;  ///< one line for the user
};

/// The contract with the conductor.
///
/// Time is granted, never taken: advance(until, ...) handles everything that happens strictly before `until`
/// and nothing else. What a node does must depend only on the messages it got and their times, never on how
/// the grants were cut: that is what makes the trace the same in every placement.
///
/// promise(p) is the earliest time stamp that a message leaving by port p can still carry if nothing more
/// comes in; reaction(p) is the shortest delay from any incoming message to a message it can cause on p (0 is
/// allowed, but a cycle of links needs a positive sum). A message never carries a time earlier than the last
/// promise for its port.
class Node {
  public:
    virtual ~Node() = default;

    virtual std::string_view name() const = 0;
    /// Fixed for the node's life; a PortIndex indexes it.
    virtual std::span<const Port> ports() const = 0;

    /// `inbox` is sorted by time, all before `until`, none before the previous `until`.
    /// Appends to `outbox`, sorted by time for each port.
    virtual void advance(Time until, std::span<const Message> inbox, std::vector<Message>& outbox) = 0;

    virtual Time promise(PortIndex port) const = 0;
    virtual Time reaction(PortIndex port) const = 0;

    /// Set once the node wants the run to end (a Linux program that exited, a breakpoint).
    virtual std::optional<Stop> stop() const { return std::nullopt; }

    /// Called once after the last advance: flush logs and return the node's part of report.json as JSON text.
    virtual std::string finish() { return "{}"; }
};

}  // namespace puckloop::cosim
