#include "linuxboard/shim/preload/scheduler/outside_news.h"

#include "linuxboard/shim/preload/scheduler/board_clock.h"

#include <algorithm>
#include <cerrno>
#include <climits>

namespace puckloop::shim {

void external_changed() {
    wake(external_key(), INT_MAX);
}

void tell_others() {
    if (page().alive < 2) return;
    const int error = errno;
    wire::Request request;
    request.op = wire::Op::Changed;
    device_call(request);
    errno = error;
}

Wake park_shared(const void* key, WaitOptions options, bool shared) {
    if (!shared || page().alive < 2) return park(key, options);
    const Time asked = options.deadline;
    options.deadline = std::min(asked, time_after(kExternalPeriod));
    const Wake reason = park(key, options);
    return reason == Wake::Timeout && now() < asked ? Wake::Key : reason;
}

}  // namespace puckloop::shim
