#include "linuxboard/shim/node/linux_node.h"

#include "base/error.h"

#include <fmt/format.h>

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>

namespace puckloop::linuxboard {

using cosim::kNever;
using cosim::Message;
using cosim::Time;
using wire::Op;

namespace {
constexpr double kStartPatience = 10.0;  // wall-clock seconds until the library must have reported

std::int64_t wall_nanoseconds() {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(
               std::chrono::steady_clock::now().time_since_epoch())
        .count();
}
}  // namespace

LinuxNode::LinuxNode(LinuxSpec spec, std::unique_ptr<Scenery> scenery)
    : spec_(std::move(spec)),
      faults_(spec_.faults),
      ports_{{"uart", cosim::PortKind::Uart}, {"i2c", cosim::PortKind::I2c}},
      launcher_(std::make_unique<Launcher>(spec_)),
      scenery_(std::move(scenery)),
      kernel_(spec_, faults_) {
    if (!spec_.cameras.empty()) {
        if (!scenery_) throw InputError("", "linux.cameras", "there is nothing that cameras could look at");
        ports_.push_back({"camera", cosim::PortKind::Signals});
    }
    for (std::size_t i = 0; i < spec_.cameras.size(); ++i)
        kernel_.add_camera(std::make_unique<VideoDevice>(spec_.cameras[i], i,
                                                         cosim::from_seconds(spec_.uptime_s), *scenery_,
                                                         launcher_->video_memory(i), clock_error_of(spec_)));
    if (spec_.network) {
        network_port_ = static_cast<cosim::PortIndex>(ports_.size());
        ports_.push_back({"network", cosim::PortKind::Network});
    }
    if (can_foresee()) speculation_.emplace(*this);
    if (spec_.start == 0) {
        start_program();
    } else {
        start_at_ = spec_.start;
    }
}

void LinuxNode::start_program() {
    const Time now = start_at_ == kNever ? 0 : start_at_;
    start_at_ = kNever;
    ++starts_;
    ++processes_;
    first_killed_.clear();
    first_gone_at_.reset();
    last_number_ = wire::kFirstProcess;
    clients_.clear();
    auto process = launcher_->start();  // may throw: there is no client without a process
    clients_.push_back(std::make_unique<Client>());
    Client& client = *clients_.back();
    client.process = std::move(process);
    switch (client.process->hear(kStartPatience, client.request, client.data)) {
    case ProcessEvent::Ended:
        throw InputError(spec_.program, "node " + spec_.name,
                         client.process->describe_end() + " before it began: " + last_words());
    case ProcessEvent::Silent:
        throw InputError(spec_.program, "", "does not load the preloaded library",
                         "a dynamically linked program");
    case ProcessEvent::Request:
        break;
    }
    if (client.request.op != Op::Hello || client.request.a != wire::kVersion)
        throw InputError(spec_.program, "", "the preloaded library is of another version",
                         "one build of both");
    client.request.now = now;
    client.state = Client::State::Asking;
}

Time LinuxNode::next_device_event() const {
    Time next = kernel_.next_event();
    if (inbox_next_ < inbox_.size()) next = std::min(next, inbox_[inbox_next_].time);
    return next;
}

void LinuxNode::collect(std::vector<Message>& outbox) {
    for (const cosim::UartFrame& frame : kernel_.take_frames())
        outbox.push_back({protocols::stop_bit_start(frame), kUartPort, frame});
    for (const cosim::I2cPhase& phase : kernel_.take_phases())
        outbox.push_back({phase.start, kI2cPort, phase});
    for (const PacketOut& packet : kernel_.take_packets())
        outbox.push_back({packet.time, *network_port_, cosim::Packet{packet.time, 0, packet.octets}});
}

void LinuxNode::run_devices(Time now) {
    while (inbox_next_ < inbox_.size() && inbox_[inbox_next_].time <= now) {
        const Message& message = inbox_[inbox_next_];
        const Time before = kernel_.next_event();
        if (before < message.time) {
            kernel_.advance(before);
            continue;
        }
        ++inbox_next_;
        ++messages_in_;
        if (const auto* frame = std::get_if<cosim::UartFrame>(&message.payload)) {
            kernel_.deliver_uart(*frame, message.time);
        } else if (const auto* phase = std::get_if<cosim::I2cPhase>(&message.payload)) {
            kernel_.deliver_i2c(*phase, message.time);
        } else if (const auto* packet = std::get_if<cosim::Packet>(&message.payload)) {
            kernel_.deliver_packet(*packet, message.time);
        } else if (const auto* signal = std::get_if<cosim::Signal>(&message.payload)) {
            if (scenery_) scenery_->change(signal->id, signal->value);
        }
    }
    for (Time next = kernel_.next_event(); next <= now; next = kernel_.next_event())
        kernel_.advance(next);
    collect(*outbox_);
}

Time LinuxNode::next_scheduled() const {
    Time next = start_at_;
    if (next_restart_ < spec_.restarts.size()) next = std::min(next, spec_.restarts[next_restart_].time);
    if (next_signal_ < spec_.signals.size()) next = std::min(next, spec_.signals[next_signal_].time);
    if (next_hangup_ < spec_.hangups.size()) next = std::min(next, spec_.hangups[next_hangup_]);
    return std::min({next, end_signal_at_, kill_at_, faults_.next()});
}

void LinuxNode::run_scheduled(Time now) {
    must_be_final();
    if (faults_.next() <= now) apply_faults(now);
    if (next_hangup_ < spec_.hangups.size() && spec_.hangups[next_hangup_] <= now) {
        ++next_hangup_;
        kernel_.hang_up(now);
    }
    if (next_signal_ < spec_.signals.size() && spec_.signals[next_signal_].time <= now)
        signal_all(spec_.signals[next_signal_++].signal, now);
    if (next_restart_ < spec_.restarts.size() && spec_.restarts[next_restart_].time <= now) {
        const Restart& restart = spec_.restarts[next_restart_++];
        kill_all(now);
        start_at_ = restart.time + restart.down;
    }
    if (end_signal_at_ <= now) send_end_signal(now);
    if (kill_at_ <= now) return out_of_grace(now);
    if (start_at_ <= now) start_program();
}

void LinuxNode::pace(Time time) {
    if (!spec_.real_time) return;
    auto& origin = launcher_->page().wall_origin;
    if (origin == 0) origin = wall_nanoseconds() - time / cosim::kNanosecond;
    const std::int64_t ahead = origin + time / cosim::kNanosecond - wall_nanoseconds();
    if (ahead > 0) std::this_thread::sleep_for(std::chrono::nanoseconds(ahead));
}

Time LinuxNode::next_action() const {
    Time next = next_scheduled();
    for (const auto& client : clients_) {
        next = std::min(next, goes_on(*client));
        if (client->state == Client::State::Waiting) next = std::min(next, kernel_.next_event());
    }
    return next;
}

Time LinuxNode::earliest_output(cosim::PortIndex port) const {
    const bool network = port == network_port_;
    if (port >= kCameraPort && !network) return kNever;
    if (!action_) action_ = next_action();
    const Time action = std::max(*action_, until_);
    if (network) {
        // The end of a process may have left some that are still to be collected.
        if (kernel_.network()->has_packets()) return until_;
        return std::min(action, std::max(kernel_.network()->next_event(), until_));
    }
    if (port == kUartPort) {
        Time own = kernel_.tty().next_frame(until_);
        if (kernel_.tty().echoes()) own = std::min(own, std::max(kernel_.tty().next_event(), until_));
        return std::min(action, own);
    }
    return std::min(action, std::max(kernel_.adapter().next_event(), until_));
}

Time LinuxNode::lookahead(cosim::PortIndex port) const {
    if (port == network_port_) return 0;  // the kernel answers by itself
    if (port >= kCameraPort) return kNever;
    // Only a thread that waits on a device can be woken by a message, and not before the earliest time while
    // the program stands at a request.
    const bool waits = std::any_of(clients_.begin(), clients_.end(), [](const auto& client) {
        return client->state == Client::State::Waiting;
    });
    if (waits && kernel_.has_waiting()) return 0;
    if (port == kUartPort) return kernel_.tty().echoes() ? 0 : kNever;
    return kernel_.adapter().next_event() == kNever ? kNever : 0;
}

}  // namespace puckloop::linuxboard
