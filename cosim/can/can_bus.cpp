#include "cosim/can/can_bus.h"

#include "base/text/times_text.h"
#include "cosim/can/can_message.h"

#include <fmt/format.h>

#include <algorithm>

namespace puckloop::cosim {

CanBusNode::CanBusNode(CanBusOptions options)
    : options_(std::move(options)),
      wire_(
          options_.controllers.size(), CanFaults(options_.faults, options_.controllers),
          [this](std::size_t index, const CanNews& news, Time time) { take_news(index, news, time); },
          [this](Time now, Time quiet) { take_edge(now, quiet); }),
      controllers_(options_.controllers.size()),
      log_(options_.log) {
    for (const std::string& name : options_.controllers)
        ports_.push_back({name, PortKind::Can});
    if (log_.is_open()) write(0, fmt::format("controllers {}", fmt::join(options_.controllers, ", ")));
}

Time CanBusNode::lag(const CanTiming& timing) {
    return std::max<Time>(0, kLookahead - (CanStation::kErrorBits - 1) * timing.bit);
}

void CanBusNode::advance(Time until, std::span<const Message> inbox, std::vector<Message>& outbox) {
    for (const Message& message : inbox) {
        wire_.run_until(message.time);
        now_ = message.time;
        if (const auto* can = std::get_if<CanMessage>(&message.payload)) receive(message.port, *can);
    }
    wire_.run_until(until);
    now_ = until;
    outbox.insert(outbox.end(), outgoing_.begin(), outgoing_.end());
    outgoing_.clear();
}

// ---- from controllers

void CanBusNode::receive(PortIndex port, const CanMessage& message) {
    Controller& controller = controllers_[port];
    CanStation& station = wire_.station(port);
    switch (message.kind) {
    case CanKind::Join:
        return join(port, message);
    case CanKind::Watch:
    case CanKind::Leave:
        controller.watches = message.kind == CanKind::Watch;
        wire_.set(port, {}, now_);
        return watch_state(port, now_);
    case CanKind::Offer: {
        const protocols::CanFrame frame = frame_in(message);
        return station.offer({frame, protocols::can_levels(frame), message.tag}, now_);
    }
    case CanKind::Withdraw:
        if (station.withdraw()) {
            CanMessage answer;
            answer.kind = CanKind::Withdrawn;
            answer.tag = message.tag;
            post(port, answer, now_ + kLookahead);
        }
        return;
    default:
        return;
    }
}

void CanBusNode::join(PortIndex port, const CanMessage& message) {
    Controller& controller = controllers_[port];
    const Time quanta = std::max<Time>(message.data[0], 1);
    const Time bit = std::max<Time>(message.bit_time, quanta);
    controller.timing = {bit, bit * message.data[1] / quanta, bit * message.data[2] / quanta};
    controller.watches = false;
    const bool listens = (message.flags & kCanListens) != 0;
    wire_.set(port, {true, controller.timing, listens, message.transmit_errors, message.receive_errors},
              now_);
    if (log_.is_open())
        write(now_, fmt::format("{}: {} at {:.6g} kbit/s, sampled at {:.3g} % of a bit",
                                options_.controllers[port], listens ? "listens" : "on the bus",
                                static_cast<double>(kSecond) / static_cast<double>(bit) / 1e3,
                                100.0 * message.data[1] / static_cast<double>(quanta)));
    controller.joined = true;
    watch_state(port, now_);
}

// ---- to controllers

void CanBusNode::post(std::size_t index, CanMessage message, Time time) {
    Controller& controller = controllers_[index];
    const CanStation& station = wire_.station(index);
    message.bit_time = static_cast<std::uint32_t>(controller.timing.bit);
    message.transmit_errors = static_cast<std::uint16_t>(station.transmit_errors());
    message.receive_errors = static_cast<std::uint8_t>(station.receive_errors());
    if (message.start == 0) message.start = time;
    controller.last_posted = std::max(controller.last_posted, time);
    outgoing_.push_back({controller.last_posted, static_cast<PortIndex>(index), message});
}

void CanBusNode::take_news(std::size_t index, const CanNews& news, Time time) {
    Controller& controller = controllers_[index];
    Counters& counters = controller.counters;
    const std::string& name = options_.controllers[index];
    CanMessage message;
    message.start = news.start;
    message.tag = news.tag;
    if (news.lost) message.flags |= kCanLost;
    if (news.gone) message.flags |= kCanGone;
    counters.lost += news.lost ? 1 : 0;
    bool posted = true;
    switch (news.what) {
    case CanNews::What::Sent:
        message.kind = CanKind::Sent;
        put_frame(message, news.frame);
        ++counters.sent;
        if (is_milestone(++frames_) && log_.is_open())
            write(time, fmt::format("{}: sent {}{}", name, can_text(news.frame), so_far_text(frames_)));
        break;
    case CanNews::What::Received:
        message.kind = CanKind::Received;
        put_frame(message, news.frame);
        if (!dropped(index, news)) {
            ++counters.received;
            break;
        }
        posted = news.gone;
        message.kind = CanKind::Withdrawn;
        break;
    case CanNews::What::Error:
    case CanNews::What::BusOff:
        message.kind = CanKind::Error;
        message.position = news.position;
        put_error(message, news.error);
        if (news.sender) {
            message.flags |= kCanSender;
            put_frame(message, news.frame);
            ++counters.errors[static_cast<std::size_t>(news.error)];
            ++counters.errors_sending;
        } else {
            ++counters.errors_receiving;
        }
        if (is_milestone(++error_frames_) && log_.is_open())
            write(time, fmt::format("{}: {} error at bit {} of {}{}", name, can_error_name(news.error),
                                    news.position, news.sender ? can_text(news.frame) : "another's frame",
                                    so_far_text(error_frames_)));
        break;
    case CanNews::What::Recovered:
        message.kind = CanKind::Recovered;
        break;
    }
    watch_state(index, time);
    if (posted && !wire_.leaving(index)) post(index, message, time + lag(controller.timing));
}

/// A fault keeps the frame from the receiver's program. The sender is whoever has it under way.
bool CanBusNode::dropped(std::size_t index, const CanNews& news) {
    if (wire_.faults().empty()) return false;
    for (std::size_t sender = 0; sender < wire_.size(); ++sender) {
        const CanStation& station = wire_.station(sender);
        if (sender == index || station.frame_start() != news.start || station.sending().frame != news.frame)
            continue;
        if (!wire_.faults().drops(sender, index, news.frame, news.start)) return false;
        ++controllers_[index].counters.dropped;
        return true;
    }
    return false;
}

void CanBusNode::take_edge(Time now, Time quiet) {
    for (std::size_t index = 0; index < controllers_.size(); ++index) {
        Controller& controller = controllers_[index];
        if (!controller.watches || wire_.faults().cut_off(index, now)) continue;
        constexpr Time kQuietBits = 11;
        if (quiet < kQuietBits * controller.timing.bit) continue;
        CanMessage message;
        message.kind = CanKind::Wake;
        message.start = now;
        post(index, message, now + kLookahead);
    }
}

Time CanBusNode::earliest_output(PortIndex port) const {
    const Controller& controller = controllers_[port];
    if (controller.watches) return later(wire_.earliest_edge(now_), kLookahead);
    return later(wire_.earliest_news(port, now_), lag(controller.timing));
}

Time CanBusNode::lookahead(PortIndex /*port*/) const {
    return kLookahead;
}

}  // namespace puckloop::cosim
