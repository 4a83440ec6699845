// Faults of the cable: plugs and wires.

#include "cosim/faults/frame_fault.h"

#include <algorithm>

namespace puckloop::cosim {

namespace {

/// Nothing passes.
class Open : public FrameFault {
  public:
    using FrameFault::FrameFault;

  protected:
    void harm(std::size_t, std::vector<Delivery>&) override {}
};

/// The line rests while the plug is out: of frames on the way when it goes out or in, a part arrives.
class Unplug : public LinkFault {
  public:
    explicit Unplug(const FaultPlan& plan)
        : begin_(plan.spec.begin), end_(plan.spec.end), sender_(plan.site.sender) {}

    void apply(std::vector<Delivery>& batch, const Sending& sending) override {
        for (Delivery& delivery : batch) {
            auto* frame = std::get_if<UartFrame>(&delivery.message.payload);
            if (!frame || keeps_from_arriving(delivery.fault)) continue;
            const Time start = frame->start, end = start + frame_time(*frame);
            if (end <= begin_ || start >= end_) continue;
            evidence_.fire({start, sending.index, sender_, text_of(delivery.message.payload)},
                           sending.delivery);
            const bool out_before = start >= begin_, back_after = end <= end_;
            delivery.fault = out_before && back_after ? FaultKind::Unplug : FaultKind::Torn;
            if (delivery.fault != FaultKind::Torn) continue;
            tear(*frame);
            delivery.message.time = later(delivery.message.time, frame->start - start);
        }
    }

  private:
    /// Levels are high while the plug is out; to the bit.
    void tear(UartFrame& frame) const {
        if (frame.is_break) {
            // Low for the part that is left of it.
            const Time from = std::max(frame.start, frame.start >= begin_ ? end_ : frame.start);
            const Time to = std::min(frame.start + frame_time(frame), frame.start < begin_ ? begin_ : kNever);
            frame.bit_period = std::max<Time>(1, (to - from) / bits_of(frame));
            frame.start = from;
            return;
        }
        const auto rests = [&](int bit) {
            const Time middle = frame.start + frame.bit_period * bit + frame.bit_period / 2;
            return middle >= begin_ && middle < end_;
        };
        for (int bit = 0; bit < frame.data_bits; ++bit)
            if (rests(1 + bit)) frame.data = static_cast<std::uint16_t>(frame.data | 1u << bit);
        if (frame.parity != 0 && rests(1 + frame.data_bits)) frame.parity_bit = 1;
    }

    Time begin_, end_;
    std::string sender_;
};

}  // namespace

std::unique_ptr<LinkFault> make_wiring_fault(const FaultPlan& plan) {
    switch (plan.kind.mark) {
    case FaultKind::Disconnect:
    case FaultKind::SwappedWires:
        return std::make_unique<Open>(plan);
    case FaultKind::Unplug:
        return std::make_unique<Unplug>(plan);
    default:
        return nullptr;
    }
}

}  // namespace puckloop::cosim
