// Faults of a UART's line: what its levels are, bit by bit and at rest.

#include "cosim/faults/frame_fault.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace puckloop::cosim {

namespace {

constexpr std::uint16_t kAllHigh = 0xFF;
constexpr std::uint8_t kMostDataBits = 9;

class Parity : public FrameFault {
  public:
    using FrameFault::FrameFault;

  protected:
    bool can_suffer(const Payload& payload) const override {
        const auto* frame = std::get_if<UartFrame>(&payload);
        return frame && frame->parity != 0 && !frame->is_break;
    }
    void harm(std::size_t i, std::vector<Delivery>& batch) override {
        UartFrame& frame = std::get<UartFrame>(batch[i].message.payload);
        const std::string mode = spec().parameters.text("mode");
        frame.parity_bit = mode == "mark" ? 1 : mode == "space" ? 0 : frame.parity_bit ^ 1;
    }
};

/// The stop bit is low: on the line, one more data bit before the line goes high.
class NoStop : public FrameFault {
  public:
    using FrameFault::FrameFault;

  protected:
    bool can_suffer(const Payload& payload) const override {
        const auto* frame = std::get_if<UartFrame>(&payload);
        return frame && frame->parity == 0 && frame->data_bits < kMostDataBits && !frame->is_break;
    }
    void harm(std::size_t i, std::vector<Delivery>& batch) override {
        UartFrame& frame = std::get<UartFrame>(batch[i].message.payload);
        ++frame.data_bits;
        batch[i].message.time = later(batch[i].message.time, frame.bit_period);
    }
};

/// What happens to the line at instants, with frames or without.
class Pulses : public FrameFault {
  public:
    using FrameFault::FrameFault;

    std::vector<Delivery> preset() override {
        std::vector<Delivery> pulses;
        for (Time at = trigger().instant(0); at != kNever; at = trigger().instant(at + 1))
            if (trigger().fires(at)) {
                UartFrame frame;
                frame.start = at;
                draw(frame);
                pulses.push_back(own(frame, site_mark()));
            } else if (trigger().spent()) {
                break;
            }
        return pulses;
    }

  protected:
    virtual void draw(UartFrame& frame) const = 0;
    virtual FaultKind site_mark() const = 0;
    bool can_suffer(const Payload&) const override { return false; }
    void harm(std::size_t, std::vector<Delivery>&) override {}
};

class FalseStart : public Pulses {
  public:
    using Pulses::Pulses;

  protected:
    void draw(UartFrame& frame) const override {
        frame.bit_period = std::max<Time>(1, spec().parameters.time("width"));
        frame.data = kAllHigh;
    }
    FaultKind site_mark() const override { return FaultKind::FalseStart; }
};

class Break : public Pulses {
  public:
    using Pulses::Pulses;

  protected:
    void draw(UartFrame& frame) const override {
        constexpr Time kUsualBits = 15;  // a frame and a half
        const Time length = spec().parameters.time("length", kUsualBits * bit_time());
        frame.is_break = 1;
        frame.bit_period = std::max<Time>(1, length / bits_of(frame));
    }
    FaultKind site_mark() const override { return FaultKind::Break; }
};

/// Low: one break, then nothing. High: nothing.
class Stuck : public FrameFault {
  public:
    using FrameFault::FrameFault;

    std::vector<Delivery> preset() override {
        if (spec().parameters.text("level") == "high") return {};
        UartFrame low;
        low.start = spec().begin;
        low.bit_period = bit_time();
        low.is_break = 1;
        Delivery delivery = own(low, FaultKind::None);
        delivery.message.time = later(low.start, site().flight);
        return {delivery};
    }

  protected:
    void harm(std::size_t, std::vector<Delivery>&) override {}
};

/// Every level is the other one. What a receiver takes for a start bit is the first low level after the
/// sender's start bit, now high; behind the last data bit the line is low.
class Invert : public FrameFault {
  public:
    using FrameFault::FrameFault;

    std::vector<Delivery> preset() override {
        UartFrame low;
        low.start = spec().begin;
        low.bit_period = bit_time();
        low.is_break = 1;
        return {own(low, FaultKind::Invert)};
    }

  protected:
    void harm(std::size_t i, std::vector<Delivery>& batch) override {
        UartFrame& frame = std::get<UartFrame>(batch[i].message.payload);
        const int bits = bits_of(frame) - frame.stop_bits;
        unsigned levels = (frame.data << 1 | frame.parity_bit << (1 + frame.data_bits)) & ((1u << bits) - 1);
        if (frame.is_break != 0) levels = 0;
        levels = ~levels & ((1u << bits) - 1);  // bit 0 is the start bit
        const int start = std::countr_one(levels);
        frame.start += frame.bit_period * start;
        frame.data = static_cast<std::uint16_t>(levels >> (start + 1));
        frame.data_bits = kMostDataBits;
        frame.parity = frame.parity_bit = frame.is_break = 0;
        const Time sent = frame.start + frame.bit_period * (1 + frame.data_bits);
        batch[i].message.time = std::max(batch[i].message.time, later(sent, site().latency));
    }
};

}  // namespace

std::unique_ptr<LinkFault> make_level_fault(const FaultPlan& plan) {
    switch (plan.kind.mark) {
    case FaultKind::Parity:
        return std::make_unique<Parity>(plan);
    case FaultKind::FalseStart:
        return std::make_unique<FalseStart>(plan);
    case FaultKind::Break:
        return std::make_unique<Break>(plan);
    case FaultKind::Stuck:
        return std::make_unique<Stuck>(plan);
    case FaultKind::Stop:
        return std::make_unique<NoStop>(plan);
    case FaultKind::Invert:
        return std::make_unique<Invert>(plan);
    default:
        return nullptr;
    }
}

}  // namespace puckloop::cosim
