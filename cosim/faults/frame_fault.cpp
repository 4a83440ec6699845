#include "cosim/faults/frame_fault.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace puckloop::cosim {

namespace {

// Two frames sent back to back may overlap by a sender's rounding.
constexpr Time kSlackPart = 64;  // of a bit
constexpr Time kDataBits = 8;

/// A radio frame without a duration is no frame on air (emu/radio/control.h).
bool travels(const Payload& payload) {
    if (const auto* radio = std::get_if<RadioFrame>(&payload)) return radio->duration > 0;
    return std::holds_alternative<UartFrame>(payload);
}

}  // namespace

Time start_of(const Payload& payload) {
    if (const auto* frame = std::get_if<UartFrame>(&payload)) return frame->start;
    if (const auto* radio = std::get_if<RadioFrame>(&payload)) return radio->start;
    return 0;
}

std::string text_of(const Payload& payload) {
    if (const auto* frame = std::get_if<UartFrame>(&payload))
        return frame->is_break ? std::string("break") : fmt::format("0x{:02x}", frame->data);
    if (const auto* radio = std::get_if<RadioFrame>(&payload))
        return fmt::format("a radio frame of {} octets", radio->octets.size());
    return {};
}

void shift(Message& message, Time delay) {
    with_frame<void>(message.payload, [delay](auto& frame) { frame.start = later(frame.start, delay); });
    message.time = later(message.time, delay);
}

FrameFault::FrameFault(FaultPlan plan)
    : plan_(std::move(plan)), trigger_(plan_.spec, plan_.random), match_(plan_.spec) {}

void FrameFault::apply(std::vector<Delivery>& batch, const Sending& sending) {
    // What earlier faults appended suffers as well, what this one appends does not.
    const std::size_t count = batch.size();
    for (std::size_t i = 0; i < count; ++i) {
        const Payload& payload = batch[i].message.payload;
        if (!travels(payload)) continue;
        const bool meant =
            with_frame<bool>(batch[i].message.payload, [this](auto& frame) { return match_(frame); });
        if (!meant || keeps_from_arriving(batch[i].fault) || !can_suffer(payload)) continue;
        const Time start = start_of(payload);
        if (!trigger_.fires(start)) continue;
        evidence_.fire({start, sending.index, plan_.site.sender, text_of(payload)}, sending.delivery);
        batch[i].fault = plan_.kind.mark;
        harm(i, batch);
    }
    after(batch);
}

Delivery FrameFault::own(const UartFrame& frame, FaultKind mark, std::string what) {
    const int before_stop = bits_of(frame) - frame.stop_bits;
    const Time flight = std::max(plan_.site.flight, frame.bit_period * before_stop);
    const Time delivery = later(later(frame.start, flight), plan_.site.latency);
    if (what.empty()) what = fault_name(plan_.kind.mark);
    evidence_.foresee({frame.start, 0, plan_.site.sender, std::move(what)}, delivery);
    return {Message{delivery, 0, frame}, mark};
}

Time FrameFault::bit_time() const {
    return std::max<Time>(1, plan_.site.flight / (1 + kDataBits));
}

void QueuedFault::after(std::vector<Delivery>& batch) {
    for (Delivery& delivery : batch) {
        auto* frame = std::get_if<UartFrame>(&delivery.message.payload);
        if (!frame || keeps_from_arriving(delivery.fault)) continue;
        if (frame->start < free_ - frame->bit_period / kSlackPart) {
            shift(delivery.message, free_ - frame->start);
            if (delivery.fault == FaultKind::None) delivery.fault = FaultKind::Late;
        }
        free_ = std::max(free_, frame->start + frame_time(*frame));
    }
}

}  // namespace puckloop::cosim
