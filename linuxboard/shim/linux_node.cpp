#include "linuxboard/shim/linux_node.h"

#include "base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <thread>

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

LinuxNode::LinuxNode(LinuxSpec spec)
    : spec_(std::move(spec)),
      ports_{{"uart", cosim::PortKind::Uart}, {"i2c", cosim::PortKind::I2c}},
      process_(std::make_unique<Process>(spec_)),
      kernel_(spec_) {
    if (spec_.start == 0) {
        start_program();
    } else {
        start_at_ = spec_.start;
    }
}

void LinuxNode::start_program() {
    const Time now = start_at_ == kNever ? 0 : start_at_;
    start_at_ = kNever;
    announced_exit_ = false;
    ++starts_;
    process_->start();
    switch (process_->hear(kStartPatience, request_, request_data_)) {
    case Heard::Ended:
        throw InputError(spec_.program, "", process_->describe_end() + " before it began: " + last_words());
    case Heard::Silent:
        throw InputError(spec_.program, "", "does not load the preloaded library",
                         "a dynamically linked program");
    case Heard::Request:
        break;
    }
    if (request_.op != Op::Hello || request_.a != wire::kVersion)
        throw InputError(spec_.program, "", "the preloaded library is of another version",
                         "one build of both");
    request_.now = now;
    state_ = State::Asking;
}

void LinuxNode::listen() {
    const Heard heard = process_->hear(spec_.watchdog_s, request_, request_data_);
    process_->echo_output();
    switch (heard) {
    case Heard::Request:
        ++requests_;
        state_ = State::Asking;
        return;
    case Heard::Ended:
        program_ended(announced_exit_ ? exit_time_ : process_->page().now.load());
        return;
    case Heard::Silent: {
        const Time now = process_->page().now.load();
        const std::string reason =
            fmt::format("{} has not let time pass for {:g} s of wall clock (half of --stall): {}",
                        spec_.program, spec_.watchdog_s, process_->describe_silence());
        process_->kill();
        state_ = State::Off;
        kernel_.reset();
        end_ = "hung";
        end_run(now, false, reason, 1);
        return;
    }
    }
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
    return std::min({next, end_signal_at_, kill_at_});
}

void LinuxNode::run_scheduled(Time now) {
    if (next_hangup_ < spec_.hangups.size() && spec_.hangups[next_hangup_] <= now) {
        ++next_hangup_;
        kernel_.hang_up(now);
    }
    if (next_signal_ < spec_.signals.size() && spec_.signals[next_signal_].time <= now)
        pending_signals_ |= std::uint64_t{1} << spec_.signals[next_signal_++].signal;
    if (next_restart_ < spec_.restarts.size() && spec_.restarts[next_restart_].time <= now) {
        const Restart& restart = spec_.restarts[next_restart_++];
        process_->kill();
        kernel_.reset();
        state_ = State::Off;
        start_at_ = restart.time + restart.down;
    }
    if (end_signal_at_ <= now) {
        end_signal_at_ = kNever;
        pending_signals_ |= std::uint64_t{1} << end_signal_;
    }
    if (kill_at_ <= now) return out_of_grace(now);
    if (start_at_ <= now) start_program();
}

void LinuxNode::answer(Time now) {
    wire::Reply reply;
    reply.now = now;
    reply.limit = std::max(now, std::min({until_, next_device_event(), next_scheduled()}));
    reply.signals = std::exchange(pending_signals_, 0);
    const std::vector<FinishedCall> calls = kernel_.take_finished();
    reply.count = static_cast<std::uint32_t>(calls.size());
    process_->reply(reply, calls);
    listen();
}

void LinuxNode::handle_request() {
    const Time now = request_.now;
    run_devices(now);
    switch (request_.op) {
    case Op::Hello:
        // A program that became another one by exec() starts with no files of ours.
        kernel_.reset();
        break;
    case Op::Note:
        warn(request_data_);
        break;
    case Op::Exit:
        announced_exit_ = true;
        exit_time_ = now;
        listen();
        return;
    default:
        kernel_.call(request_, request_data_);
        break;
    }
    if (request_.wait != 0 && !kernel_.has_finished() && request_.wait_until > now && pending_signals_ == 0) {
        state_ = State::Waiting;
        return;
    }
    answer(now);
}

void LinuxNode::advance(Time until, std::span<const Message> inbox, std::vector<Message>& outbox) {
    inbox_.erase(inbox_.begin(), inbox_.begin() + static_cast<std::ptrdiff_t>(inbox_next_));
    inbox_next_ = 0;
    inbox_.insert(inbox_.end(), inbox.begin(), inbox.end());
    until_ = until;
    outbox_ = &outbox;
    while (true) {
        const Time scheduled = next_scheduled();
        Time next = std::min(scheduled, next_device_event());
        if (state_ == State::Asking) next = std::min(scheduled, request_.now);
        if (state_ == State::Waiting) next = std::min(next, request_.wait_until);
        if (next >= until) break;
        pace(next);
        if (scheduled <= next) {
            run_devices(next);
            run_scheduled(next);
            if (state_ == State::Waiting && (pending_signals_ != 0 || kernel_.has_finished())) answer(next);
        } else if (state_ == State::Asking) {
            handle_request();
        } else {
            run_devices(next);
            if (state_ == State::Waiting && (kernel_.has_finished() || next >= request_.wait_until))
                answer(next);
        }
    }
    run_devices(until - 1);
    outbox_ = nullptr;
}

void LinuxNode::pace(Time time) {
    if (!spec_.real_time) return;
    auto& origin = process_->wall_origin();
    if (origin == 0) origin = wall_nanoseconds() - time / cosim::kNanosecond;
    const std::int64_t ahead = origin + time / cosim::kNanosecond - wall_nanoseconds();
    if (ahead > 0) std::this_thread::sleep_for(std::chrono::nanoseconds(ahead));
}

Time LinuxNode::next_action() const {
    Time next = next_scheduled();
    if (state_ == State::Asking) next = std::min(next, request_.now);
    if (state_ == State::Waiting) next = std::min({next, request_.wait_until, kernel_.next_event()});
    return next;
}

Time LinuxNode::promise(cosim::PortIndex port) const {
    const Time action = std::max(next_action(), until_);
    if (port == kUartPort) {
        Time own = kernel_.tty().next_frame(until_);
        if (kernel_.tty().echoes()) own = std::min(own, std::max(kernel_.tty().next_event(), until_));
        return std::min(action, own);
    }
    return std::min(action, std::max(kernel_.adapter().next_event(), until_));
}

Time LinuxNode::reaction(cosim::PortIndex port) const {
    // Only a thread that waits on a device can be woken by a message, and not before the promised time while
    // the program stands at a request.
    if (state_ == State::Waiting && kernel_.has_waiting()) return 0;
    if (port == kUartPort) return kernel_.tty().echoes() ? 0 : kNever;
    return kernel_.adapter().next_event() == kNever ? kNever : 0;
}

}  // namespace puckloop::linuxboard
