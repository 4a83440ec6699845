// Faults of a UART's line: what its levels are, bit by bit and at rest.

#include "cosim/faults/frame_fault.h"

#include <algorithm>
#include <cmath>

namespace puckloop::cosim {

namespace {

constexpr std::uint16_t kAllHigh = 0xFF;

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
    default:
        return nullptr;
    }
}

}  // namespace puckloop::cosim
