// Faults of a UART's line: what its levels are, bit by bit and at rest.

#include "cosim/faults/frame_fault.h"

#include <algorithm>
#include <cmath>

namespace puckloop::cosim {

namespace {

constexpr std::uint8_t kMostDataBits = 9;
constexpr double kRounding = 2e-9;  // s

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

/// A time within a frame in whole nanoseconds, as frames have them.
std::uint32_t nanoseconds(double seconds) {
    constexpr double kMost = 4e9;
    return static_cast<std::uint32_t>(std::lround(std::clamp(seconds * 1e9, 0.0, kMost)));
}

void put_glitch(UartFrame& frame, double first_bit, double seconds) {
    frame.glitch_at = nanoseconds(first_bit * to_seconds(frame.bit_period));
    frame.glitch_width = std::max<std::uint32_t>(1, nanoseconds(seconds));
}

/// The stop bit is low, or goes low before its time. A missing one is written as one more data bit if the
/// frame has room for it.
class StopLow : public FrameFault {
  public:
    using FrameFault::FrameFault;

  protected:
    bool can_suffer(const Payload& payload) const override {
        const auto* frame = std::get_if<UartFrame>(&payload);
        return frame && is_sound(*frame) && !frame->is_break;
    }
    void harm(std::size_t i, std::vector<Delivery>& batch) override {
        UartFrame& frame = std::get<UartFrame>(batch[i].message.payload);
        const double length = spec().parameters.number("length"), bit = to_seconds(frame.bit_period);
        if (length == 0 && frame.parity == 0 && frame.data_bits < kMostDataBits) {
            ++frame.data_bits;
            batch[i].message.time = later(batch[i].message.time, frame.bit_period);
            return;
        }
        const int before = bits_of(frame) - frame.stop_bits;
        // Of two missing stop bits the first; else up to the frame's end, whatever is rounded.
        const bool one_of_two = length == 0 && frame.stop_bits == 2;
        put_glitch(frame, before + length, one_of_two ? bit : (frame.stop_bits - length) * bit + kRounding);
    }
};

/// The level is the other one for a while within the frame.
class Glitch : public FrameFault {
  public:
    using FrameFault::FrameFault;

  protected:
    bool can_suffer(const Payload& payload) const override {
        const auto* frame = std::get_if<UartFrame>(&payload);
        return frame && frame->glitch_width == 0 && spec().parameters.number("bit") < bits_of(*frame);
    }
    void harm(std::size_t i, std::vector<Delivery>& batch) override {
        UartFrame& frame = std::get<UartFrame>(batch[i].message.payload);
        const double bit = spec().parameters.has("bit") ? spec().parameters.number("bit")
                                                        : random().uniform() * bits_of(frame);
        put_glitch(frame, bit, spec().parameters.number("width"));
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
        // A stretch of high line with a pulse in it: no frame of a sender, which may begin one at any time.
        const Time width = std::max<Time>(1, spec().parameters.time("width"));
        frame.is_break = 1;
        frame.line = kLineInverted;
        frame.bit_period = std::max(bit_time(), width / bits_of(frame) + 1);
        put_glitch(frame, 0, to_seconds(width));
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
        return std::make_unique<StopLow>(plan);
    case FaultKind::Glitch:
        return std::make_unique<Glitch>(plan);
    default:
        return nullptr;
    }
}

}  // namespace puckloop::cosim
