#pragma once
// Requests that the library answers by itself, from what the node's last reply showed of the serial port. The
// answer is the node's at the same simulated time; what it changes, the node is given with the next request
// (wire::Done).

#include "linuxboard/shim/preload/host/link.h"

#include <cstddef>
#include <cstdint>

namespace puckloop::shim {

struct Answer {
    std::int64_t result = 0;
    int error = 0;             ///< with result -1
    std::size_t received = 0;  ///< bytes put to `out`
    std::int64_t time = 0;     ///< when the call ends: now, or at a poll's deadline
};

/// The answer to `request`, made at `now`, which is before the last reply's limit; false if only the node
/// knows it. An answer at a later time than `now` holds if nothing else happens in the program until then.
bool answer_ahead(const wire::Request& request, const void* data, std::size_t size, void* out,
                  std::size_t capacity, std::int64_t now, Answer& answer);

}  // namespace puckloop::shim
