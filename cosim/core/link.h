#pragma once
// A link: two ports of two nodes. It adds flight time, never content; faults (cosim/faults/faults.h) sit here
// too.

#include "cosim/core/message.h"
#include "cosim/core/node.h"
#include "cosim/core/time.h"

#include <cstdint>
#include <string>
#include <vector>

namespace puckloop::cosim {

struct PortRef {
    std::string node;
    std::string port;
};

struct LinkSpec {
    std::string name;  ///< "robot0.uart"
    PortRef a;
    PortRef b;
    double nominal_baud = 0.0;  ///< UART links only, > 0: see docs/architecture.md, "UART on a link"
    Time latency = 0;           ///< added to every message, >= 0
    /// Names of the signals by id, for traces; ids beyond the list are written as numbers.
    std::vector<std::string> signal_names{};
    /// Whether messages sent by a, by b are written to trace files. All are part of the trace's hash.
    bool record_from_a = true;
    bool record_from_b = true;
    /// Whether the trace's hash names the link where nothing goes over it. Without, such a run is as one that
    /// does not have the link, which comes after all others.
    bool hashed_when_unused = true;
};

/// Which end sends.
enum class Direction : std::uint8_t { FromA = 0, FromB = 1 };

/// The shortest time from the start bit of a frame to its delivery: 9 nominal bit times, 0 for other links.
Time flight_time(const LinkSpec& link);

/// When a message stamped and begun as it is comes out at the far end of a link.
Time delivery_time(const Message& message, Time flight, Time latency);

}  // namespace puckloop::cosim
