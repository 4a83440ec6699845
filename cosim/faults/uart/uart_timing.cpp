// Faults of UART frames that change when they come or how fast they are.

#include "cosim/faults/reordered_frames.h"

#include <algorithm>
#include <cmath>
#include <deque>

namespace puckloop::cosim {

namespace {

/// Changes the bit time of the frame by `factor`.
void stretch(Message& message, double factor) {
    UartFrame& frame = std::get<UartFrame>(message.payload);
    const Time before = frame.bit_period;
    frame.bit_period = std::max<Time>(1, std::llround(static_cast<double>(before) * factor));
    // The stop bit moves with the bit time; never earlier than the link promised.
    const Time shift = (frame.bit_period - before) * (bits_of(frame) - frame.stop_bits);
    if (shift > 0) message.time = later(message.time, shift);
}

/// Does not push back the frames behind: late ones may overlap them.
class Delay : public FrameFault {
  public:
    using FrameFault::FrameFault;

  protected:
    void harm(std::size_t i, std::vector<Delivery>& batch) override {
        shift(batch[i].message, spec().parameters.time("delay"));
    }
};

/// In order.
using Jitter = JitterFrames<QueuedFault>;

class Rate : public FrameFault {
  public:
    using FrameFault::FrameFault;

  protected:
    void harm(std::size_t i, std::vector<Delivery>& batch) override {
        stretch(batch[i].message, spec().parameters.number("factor"));
    }
};

/// The sender's clock is off, more and more so.
class Baud : public QueuedFault {
  public:
    using QueuedFault::QueuedFault;

  protected:
    void harm(std::size_t i, std::vector<Delivery>& batch) override {
        const double age = to_seconds(start_of(batch[i].message.payload) - spec().begin);
        const double offset = spec().parameters.number("offset") + spec().parameters.number("drift") * age;
        constexpr double kMost = 0.9;  // beyond that nothing is a serial line any more
        stretch(batch[i].message, 1.0 / (1.0 + std::clamp(offset, -kMost, kMost)));
    }
};

/// Frames come out at the ends of periods only, as from a USB adapter.
class Batch : public QueuedFault {
  public:
    using QueuedFault::QueuedFault;

  protected:
    void harm(std::size_t i, std::vector<Delivery>& batch) override {
        const Time slot = std::max<Time>(1, spec().parameters.time("slot"));
        const auto* frame = std::get_if<UartFrame>(&batch[i].message.payload);
        const Time end = frame->start + frame_time(*frame) - spec().begin;
        shift(batch[i].message, (slot - end % slot) % slot);
    }
};

/// A slower way in between: so many bits a second, and room for so many frames.
class Throttle : public FrameFault {
  public:
    using FrameFault::FrameFault;

  protected:
    void harm(std::size_t i, std::vector<Delivery>& batch) override {
        const auto& frame = std::get<UartFrame>(batch[i].message.payload);
        const Time start = frame.start;
        while (!leaves_.empty() && leaves_.front() <= start)
            leaves_.pop_front();
        const double limit = spec().parameters.number("limit");
        if (limit > 0 && static_cast<double>(leaves_.size()) >= limit) {
            batch[i].fault = FaultKind::Overflow;
            return;
        }
        const Time begin = leaves_.empty() ? start : leaves_.back();
        const Time taken = from_seconds(bits_of(frame) / spec().parameters.number("rate"));
        leaves_.push_back(begin + std::max(taken, frame_time(frame)));
        shift(batch[i].message, begin - start);
    }

  private:
    std::deque<Time> leaves_;  // when those that wait are through
};

/// The way stands still during the window; what waits comes at its end, back to back.
class Stall : public QueuedFault {
  public:
    using QueuedFault::QueuedFault;

  protected:
    void harm(std::size_t i, std::vector<Delivery>& batch) override {
        shift(batch[i].message, spec().end - start_of(batch[i].message.payload));
    }
};

}  // namespace

std::unique_ptr<LinkFault> make_timing_fault(const FaultPlan& plan) {
    switch (plan.kind.mark) {
    case FaultKind::Delay:
        if (plan.spec.parameters.number("jitter") > 0) return std::make_unique<Jitter>(plan);
        return std::make_unique<Delay>(plan);
    case FaultKind::Rate:
        return std::make_unique<Rate>(plan);
    case FaultKind::Baud:
        return std::make_unique<Baud>(plan);
    case FaultKind::Batch:
        return std::make_unique<Batch>(plan);
    case FaultKind::Throttle:
        return std::make_unique<Throttle>(plan);
    case FaultKind::Stall:
        return std::make_unique<Stall>(plan);
    default:
        return nullptr;
    }
}

}  // namespace puckloop::cosim
