// What the library may do by itself between two requests, and how the node catches up with it.
//
// The limit of a reply is the earliest time at which anything can happen to the program: the end of the time
// granted, a signal or another event of the scenario, another process that is due, a call of a thread that
// may end. What the serial port shows holds until something comes in. All that the library does lies before
// both, so doing it later, but before anything else at that time, comes to the same.

#include "linuxboard/shim/node/linux_node.h"

#include <algorithm>
#include <utility>

namespace puckloop::linuxboard {

using cosim::kNever;
using cosim::Time;

void LinuxNode::show_ahead(const Client& client, wire::Reply& reply) const {
    const Time message = inbox_next_ < inbox_.size() ? inbox_[inbox_next_].time : kNever;
    reply.limit = std::min({until_, next_scheduled(), kernel_.next_completion(message)});
    if (spec_.ask_always) reply.limit = std::min(reply.limit, next_device_event());
    for (const auto& other : clients_)
        if (other.get() != &client) reply.limit = std::min(reply.limit, due(*other));
    reply.limit = std::max(reply.now, reply.limit);
    wire::TtyView& view = client.process->channel().tty;
    kernel_.tty().show(view);
    if (!kernel_.lets_library_answer()) view.usable = 0;
    view.valid_until = std::min(message, kernel_.tty().next_input());
}

void LinuxNode::catch_up(Client& client) {
    wire::Channel& channel = client.process->channel();
    answered_by_library_ += std::exchange(channel.answered, 0);
    std::string_view written(channel.written, std::min(channel.written_size, wire::Channel::kMostWritten));
    const std::uint32_t count = std::min(channel.done_count, wire::Channel::kMostDone);
    channel.done_count = channel.written_size = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        const wire::Done& done = channel.done[i];
        // No call ends up to then (the reply's limit): only what was written before goes out.
        const Time time = std::clamp(done.time, client.answered, std::max(client.answered, until_));
        run_devices(time);
        if (done.read > 0) kernel_.was_read(done.read);
        if (done.written == 0) continue;
        kernel_.was_written(written.substr(0, done.written), time);
        written.remove_prefix(std::min<std::size_t>(done.written, written.size()));
    }
}

}  // namespace puckloop::linuxboard
