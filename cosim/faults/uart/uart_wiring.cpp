// Faults of the cable: plugs and wires.

#include "cosim/faults/frame_fault.h"

#include <algorithm>
#include <bit>

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
            if (!tear(*frame)) {
                delivery.fault = FaultKind::Unplug;
                continue;
            }
            delivery.message.time = later(delivery.message.time, frame->start - start);
        }
    }

  private:
    /// Levels are high while the plug is out, to the bit. False: nothing low is left.
    bool tear(UartFrame& frame) const {
        const int bits = bits_of(frame) - frame.stop_bits;
        unsigned levels = (frame.data << 1 | frame.parity_bit << (1 + frame.data_bits)) & ((1u << bits) - 1);
        if (frame.is_break != 0) levels = 0;
        for (int bit = 0; bit < bits; ++bit) {
            const Time middle = frame.start + frame.bit_period * bit + frame.bit_period / 2;
            if (middle >= begin_ && middle < end_) levels |= 1u << bit;
        }
        const int start = std::countr_one(levels);  // the first that a receiver can take for a start bit
        if (start >= bits) return false;
        levels >>= start + 1;
        levels |= ~0u << (bits - start - 1);  // at rest behind the frame
        if (start == 0 && frame.parity != 0)
            frame.parity_bit = levels >> frame.data_bits & 1;
        else if (start != 0)
            frame.parity = frame.parity_bit = 0;
        frame.start += frame.bit_period * start;
        frame.data = static_cast<std::uint16_t>(levels & ((1u << frame.data_bits) - 1));
        frame.is_break = 0;
        return true;
    }

    Time begin_, end_;
    std::string sender_;
};

/// A plug that puts the transmitter on the receiver of the same end.
class Loopback : public LinkFault {
  public:
    explicit Loopback(const FaultPlan& plan)
        : begin_(plan.spec.begin),
          end_(plan.spec.end),
          sender_(plan.site.sender),
          hears_itself_(plan.spec.from.empty() || plan.spec.from == sender_),
          through_(plan.spec.parameters.number("through") != 0) {}

    void apply(std::vector<Delivery>& batch, const Sending& sending) override {
        const std::size_t count = batch.size();
        for (std::size_t i = 0; i < count; ++i) {
            const auto* frame = std::get_if<UartFrame>(&batch[i].message.payload);
            if (!frame || batch[i].back || keeps_from_arriving(batch[i].fault)) continue;
            if (frame->start < begin_ || frame->start >= end_ || (through_ && !hears_itself_)) continue;
            evidence_.fire({frame->start, sending.index, sender_, text_of(batch[i].message.payload)},
                           sending.delivery);
            Delivery back = batch[i];
            if (!through_) batch[i].fault = FaultKind::Disconnect;
            if (!hears_itself_) continue;
            back.fault = FaultKind::Loopback;
            back.back = true;
            back.message.time = later(back.message.time, kTurnRound);
            batch.push_back(back);
        }
    }

  private:
    Time begin_, end_;
    std::string sender_;
    bool hears_itself_, through_;
};

}  // namespace

bool loops_back(const FaultSpec& spec) {
    const KindInfo* kind = find_kind(spec.kind, PlaceKind::Uart);
    return kind && kind->mark == FaultKind::Loopback;
}

std::unique_ptr<LinkFault> make_wiring_fault(const FaultPlan& plan) {
    switch (plan.kind.mark) {
    case FaultKind::Disconnect:
    case FaultKind::SwappedWires:
        return std::make_unique<Open>(plan);
    case FaultKind::Unplug:
        return std::make_unique<Unplug>(plan);
    case FaultKind::Loopback:
        return std::make_unique<Loopback>(plan);
    default:
        return nullptr;
    }
}

}  // namespace puckloop::cosim
