#include "cosim/core/link.h"

#include <algorithm>

namespace puckloop::cosim {

namespace {
// Start bit and 8 data bits: the stop bit of an 8N1 frame begins then.
constexpr double kFlightBits = 9.0;
}  // namespace

Time flight_time(const LinkSpec& link) {
    if (link.nominal_baud <= 0.0) return 0;
    return static_cast<Time>(kFlightBits * static_cast<double>(kSecond) / link.nominal_baud);
}

Time delivery_time(const Message& message, Time flight, Time latency) {
    Time time = message.time;
    if (const auto* frame = std::get_if<UartFrame>(&message.payload))
        time = std::max(time, later(frame->start, flight));
    return later(time, latency);
}

}  // namespace puckloop::cosim
