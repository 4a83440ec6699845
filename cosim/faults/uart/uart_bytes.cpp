// Faults of UART frames that lose, change, repeat, add or exchange bytes.

#include "cosim/faults/reordered_frames.h"

#include <array>
#include <optional>

namespace puckloop::cosim {

namespace {

/// The mark alone keeps the frame from arriving.
class Lose : public FrameFault {
  public:
    using FrameFault::FrameFault;

  protected:
    void harm(std::size_t, std::vector<Delivery>&) override {}
};

class Flip : public FrameFault {
  public:
    explicit Flip(const FaultPlan& plan)
        : FrameFault(plan), bits_(static_cast<unsigned>(spec().parameters.number("bits"))) {
        if (spec().parameters.has("bit")) bit_ = static_cast<unsigned>(spec().parameters.number("bit"));
        neighbours_ = bit_ || spec().parameters.number("burst") != 0;
    }

  protected:
    bool can_suffer(const Payload& payload) const override {
        const auto* frame = std::get_if<UartFrame>(&payload);
        return frame && !frame->is_break && bit_.value_or(0) + bits_ <= frame->data_bits;
    }

    void harm(std::size_t i, std::vector<Delivery>& batch) override {
        UartFrame& frame = std::get<UartFrame>(batch[i].message.payload);
        const unsigned chosen = neighbours_ ? run_of_bits(frame.data_bits) : single_bits(frame.data_bits);
        frame.data = static_cast<std::uint16_t>(frame.data ^ chosen);
    }

  private:
    unsigned run_of_bits(unsigned data_bits) {
        const auto first =
            bit_ ? *bit_ : static_cast<unsigned>(random().below(std::uint64_t{data_bits} - bits_ + 1));
        return ((1u << bits_) - 1) << first;
    }

    unsigned single_bits(unsigned data_bits) {
        std::array<unsigned, 9> bits{0, 1, 2, 3, 4, 5, 6, 7, 8};
        unsigned chosen = 0;
        for (unsigned k = 0; k < bits_; ++k) {
            std::swap(bits.at(k), bits.at(k + random().below(std::uint64_t{data_bits} - k)));
            chosen |= 1u << bits.at(k);
        }
        return chosen;
    }

    unsigned bits_;
    std::optional<unsigned> bit_;
    bool neighbours_ = false;
};

class Twice : public FrameFault {
  public:
    using FrameFault::FrameFault;

  protected:
    void harm(std::size_t i, std::vector<Delivery>& batch) override {
        Delivery copy = batch[i];
        shift(copy.message,
              with_frame<Time>(copy.message.payload, [](const auto& frame) { return frame_time(frame); }));
        batch.push_back(copy);
    }
};

/// A byte that nobody sent, behind one that somebody did.
class Insert : public QueuedFault {
  public:
    using QueuedFault::QueuedFault;

  protected:
    void harm(std::size_t i, std::vector<Delivery>& batch) override {
        batch[i].fault = FaultKind::None;
        Delivery copy = batch[i];
        UartFrame& frame = std::get<UartFrame>(copy.message.payload);
        const Time length = frame_time(frame);
        if (spec().parameters.has("value"))
            frame.data = static_cast<std::uint16_t>(spec().parameters.number("value"));
        else
            frame.data = static_cast<std::uint16_t>(random().below(1u << frame.data_bits));
        frame.is_break = 0;
        copy.fault = FaultKind::Insert;
        shift(copy.message, length);
        batch.push_back(copy);
    }
};

class Swap : public SwapFrames<QueuedFault> {
  public:
    using SwapFrames::SwapFrames;

  protected:
    std::optional<Behind> behind(const Delivery& passing) const override {
        const auto* frame = std::get_if<UartFrame>(&passing.message.payload);
        if (!frame) return std::nullopt;
        return Behind{frame->start + frame_time(*frame), passing.message.time};
    }
};

}  // namespace

std::unique_ptr<LinkFault> make_byte_fault(const FaultPlan& plan) {
    switch (plan.kind.mark) {
    case FaultKind::Drop:
        return std::make_unique<Lose>(plan);
    case FaultKind::Flip:
        return std::make_unique<Flip>(plan);
    case FaultKind::Duplicate:
        return std::make_unique<Twice>(plan);
    case FaultKind::Insert:
        return std::make_unique<Insert>(plan);
    case FaultKind::Swap:
        return std::make_unique<Swap>(plan);
    default:
        return nullptr;
    }
}

}  // namespace puckloop::cosim
