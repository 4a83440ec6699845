#include "emu/xbee/module_node.h"

#include "base/error.h"
#include "protocols/serial/uart_sampling.h"

#include <algorithm>

namespace puckloop::xbee {

using cosim::Time;

ModuleNode::ModuleNode(const ModuleOptions& options, const std::map<std::string, std::uint16_t>& pins)
    : options_(options),
      ports_{{"uart", cosim::PortKind::Uart},
             {"pins", cosim::PortKind::Signals},
             {"radio", cosim::PortKind::Radio}},
      pins_(pins),
      module_(options, *this) {}

void ModuleNode::advance(Time until, std::span<const cosim::Message> inbox,
                         std::vector<cosim::Message>& outbox) {
    outbox_ = &outbox;
    for (const cosim::Message& message : inbox) {
        run(message.time, true);
        receive(message);
    }
    run(until, false);
    granted_ = until;
    outbox_ = nullptr;
}

void ModuleNode::run(Time until, bool inclusive) {
    const auto due = [&](Time time) { return time < until || (inclusive && time == until); };
    for (;;) {
        const Time byte = module_.serial().next();
        const Time task = module_.next_task();
        if (task <= byte && due(task)) {
            module_.run_until(task);
        } else if (due(byte)) {
            const cosim::UartFrame frame = module_.serial().take();
            outbox_->push_back({protocols::stop_bit_start(frame), kUart, frame});
        } else {
            return;
        }
    }
}

void ModuleNode::receive(const cosim::Message& message) {
    if (const auto* frame = std::get_if<cosim::UartFrame>(&message.payload)) {
        receive_frame(*frame, message.time);
    } else if (const auto* radio = std::get_if<cosim::RadioFrame>(&message.payload)) {
        module_.radio_received(*radio, message.time);
    } else if (const auto* signal = std::get_if<cosim::Signal>(&message.payload)) {
        const auto is = [&](const char* name) {
            const auto pin = pins_.find(name);
            return pin != pins_.end() && pin->second == signal->id;
        };
        const bool level = signal->value >= 0.5;
        if (is("xbee_reset")) module_.reset_pin(level, message.time);
        if (is("xbee_rts")) module_.rts(level, message.time);
        if (is("xbee_wake")) module_.sleep_request(level, message.time);
        if (is("power")) module_.power(level, message.time);
    }
}

/// A receiver that is faster than the sender has a character before the frame that holds it has come in.
void ModuleNode::receive_frame(const cosim::UartFrame& frame, Time now) {
    const protocols::UartReceiver receiver{.bit_period = module_.receiver_bit()};
    for (const auto& character : protocols::sample_frame(frame, receiver, heard_until_)) {
        heard_until_ = character.time;
        if (character.framing_error)
            module_.framing_error();
        else
            module_.byte_received(static_cast<std::uint8_t>(character.data), std::max(character.time, now));
    }
}

void ModuleNode::radio_sent(std::vector<std::uint8_t> octets, Time on_air, Time now) {
    cosim::RadioFrame frame;
    frame.start = now;
    frame.duration = on_air;
    frame.octets = cosim::Octets(octets);
    frame.channel = static_cast<std::uint8_t>(module_.settings()[kCH]);
    frame.dbm = 0;
    outbox_->push_back({now, kRadio, frame});
}

void ModuleNode::cts_changed(bool level, Time now) {
    if (const auto pin = pins_.find("xbee_cts"); pin != pins_.end())
        outbox_->push_back({now, kPins, cosim::Signal{pin->second, level ? 1.0 : 0.0}});
}

Time ModuleNode::earliest_output(cosim::PortIndex port) const {
    if (port == kRadio) return std::max(granted_, module_.next_radio());
    if (port == kUart) {
        // The byte that begins then, or one that is caused then, is handed out when its stop bit begins.
        const Time stop_bit = SerialOut::kBitsToStop * module_.serial().shortest_bit();
        return std::max(granted_, cosim::later(module_.next_byte(), stop_bit));
    }
    return pins_.contains("xbee_cts") ? std::max(granted_, module_.next_task()) : cosim::kNever;
}

Time ModuleNode::lookahead(cosim::PortIndex port) const {
    if (port == kRadio) return options_.processing;
    if (port == kUart) return options_.processing + SerialOut::kBitsToStop * module_.serial().shortest_bit();
    return pins_.contains("xbee_cts") ? 0 : cosim::kNever;
}

std::string ModuleNode::finish() {
    return to_json(module_);
}

}  // namespace puckloop::xbee
