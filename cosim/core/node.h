#pragma once
// A node: one emulated board, the physics world, a Linux process, a bus, or the outside.

#include "cosim/core/message.h"
#include "cosim/core/time.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::cosim {

enum class PortKind : std::uint8_t { Uart, I2c, Signals, Radio, Can, Network };

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
    /// The run ends only when so many nodes want it to, with the last of them: programs of several robots.
    std::uint32_t together = 1;
};

/// A node that can go back to an earlier state of its own. What runs ahead of the time granted to it, in the
/// hope that nothing comes in, can so be taken back. All three are called between two calls of advance().
class Rewindable {
  public:
    virtual ~Rewindable() = default;
    /// Remembers the present state, in microseconds; a mark set before is given up as settle() does.
    virtual void mark() = 0;
    /// Goes back to the mark, which stays: state, EOTs and logs are as if nothing had been done since.
    virtual void rewind() = 0;
    /// What was done since the mark stands; the mark is given up.
    virtual void settle() = 0;
};

/// A node for which something outside of simulated time works, such as a program in a process of its own:
/// whoever grants it need not wait for that.
class Suspendable {
  public:
    virtual ~Suspendable() = default;
    /// Begins what Node::advance() does, with the same parameters. False where it would wait; resume() then
    /// goes on, and `outbox` must stay until that is done. `inbox` may go.
    virtual bool begin(Time until, std::span<const Message> inbox, std::vector<Message>& outbox) = 0;
    /// True once everything is done. `wait`: lets it wait for some milliseconds.
    virtual bool resume(bool wait) = 0;
};

/// The contract with the conductor.
///
/// Time is granted, never taken: advance(until, ...) handles everything that happens strictly before `until`
/// and nothing else. What a node does must depend only on the messages it got and their times, never on how
/// the grants were cut: that is what makes the trace the same in every placement.
///
/// earliest_output(p) is the earliest time stamp that a message leaving by port p can still carry if nothing
/// more comes in; lookahead(p) is the shortest delay from any incoming message to a message it can cause on p
/// (0 is allowed, but a cycle of links needs a positive sum). Together they say: every message still to leave
/// by p carries at least min(earliest_output(p), t + lookahead(p)), t being the first message that comes in.
/// Both may change with every advance: a program asleep until T, which no message can wake, has EOT T and
/// lookahead kNever. The conductor checks each message against them and ends the run, naming the node, when
/// they were broken.
///
/// UART ports: the link adds the 9 nominal bit times by itself. A frame that is not yet begun when advance()
/// returns begins at `until` or later, so EOT `until` and lookahead 0 are good enough for a UART. A node
/// that hands a frame out when its stop bit begins states through begun(p) that one is being shifted out, and
/// since when; its EOT is then that stop bit. (A node may as well hand a frame out as soon as it begins,
/// stamped with its stop bit, and leave begun() alone.)
class Node {
  public:
    virtual ~Node() = default;

    virtual std::string_view name() const = 0;
    /// Fixed for the node's life; a PortIndex indexes it.
    virtual std::span<const Port> ports() const = 0;

    /// `inbox` is sorted by time, all before `until`, none before the previous `until`.
    /// Appends to `outbox`, sorted by time for each port.
    virtual void advance(Time until, std::span<const Message> inbox, std::vector<Message>& outbox) = 0;

    virtual Time earliest_output(PortIndex port) const = 0;
    virtual Time lookahead(PortIndex port) const = 0;
    /// UART ports only: start of the frame that is on the line and still to be handed out, if there is one.
    virtual std::optional<Time> begun(PortIndex /*port*/) const { return std::nullopt; }

    /// Not null if the node can go back; asked after each advance. Of such a node lookahead(p) holds for
    /// changes as well: what comes in at t adds no message on p before t + lookahead(p), unless later than
    /// one that would carry t or more, and takes none away that would carry less than t (t or less, if
    /// lookahead(p) > 0).
    virtual Rewindable* rewindable() { return nullptr; }

    /// Not null if the node can leave its advance() for others meanwhile; fixed for its life.
    virtual Suspendable* suspendable() { return nullptr; }

    /// Set once the node wants the run to end (a Linux program that exited, a breakpoint). Everything else
    /// still runs on for the run's stop latency (10 ms), so that the end is the same in every placement.
    virtual std::optional<Stop> stop() const { return std::nullopt; }

    /// The run is to end and every node has reached exactly `now`: what the node runs is asked to end, a
    /// Linux program by a signal. `signal` is the one that the user sent to the run, 0 if the end has another
    /// cause.
    virtual void wind_up(Time /*now*/, int /*signal*/) {}
    /// After wind_up(): when the node was done with it, kNever while it still needs simulated time.
    virtual Time wound_up() const { return 0; }

    /// Called once after the last advance: flush logs and return the node's part of report.json as JSON text.
    virtual std::string finish() { return "{}"; }
};

}  // namespace puckloop::cosim
