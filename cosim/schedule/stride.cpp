#include "cosim/schedule/stride.h"

#include "base/error.h"
#include "cosim/core/link.h"

#include <algorithm>

namespace puckloop::cosim {

namespace {

/// First instant at which something can come back that the node does from `now` on.
Time first_echo(const Node& node, Time now, Time first_in, std::span<const PortEcho> echoes) {
    Time first = kNever;
    for (std::size_t p = 0; p < echoes.size(); ++p) {
        const PortEcho& echo = echoes[p];
        if (echo.back == kNever) continue;
        const auto port = static_cast<PortIndex>(p);
        const Time begun = echo.is_uart ? later(node.begun(port).value_or(now), echo.flight) : 0;
        const Time unasked = std::max(node.earliest_output(port), begun);
        const Time answer = later(first_in, std::max(node.lookahead(port), echo.flight));
        first = std::min(first, later(later(std::min(unasked, answer), echo.latency), echo.back));
    }
    return first;
}

}  // namespace

Time advance_in_strides(Node& node, Time from, Reach reach, std::span<const Message> inbox,
                        std::span<const PortEcho> echoes, std::vector<Message>& outbox) {
    Time now = from;
    Time until = reach.until;
    while (now < until) {
        const Time first_in = inbox.empty() ? kNever : inbox.front().time;
        const Time stride = std::min(until, std::max(reach.sure, first_echo(node, now, first_in, echoes)));
        if (stride <= now) break;
        const auto due = std::find_if(inbox.begin(), inbox.end(),
                                      [stride](const Message& message) { return message.time >= stride; });
        const auto count = static_cast<std::size_t>(due - inbox.begin());
        const std::size_t said = outbox.size();
        node.advance(stride, inbox.first(count), outbox);
        inbox = inbox.subspan(count);
        now = stride;
        for (std::size_t m = said; m < outbox.size() && !echoes.empty(); ++m) {
            if (outbox[m].port >= echoes.size()) continue;
            const PortEcho& echo = echoes[outbox[m].port];
            until = std::min(until, later(delivery_time(outbox[m], echo.flight, echo.latency), echo.back));
        }
    }
    if (now == from) throw RunError("was granted no time it can use");
    return now;
}

}  // namespace puckloop::cosim
