#pragma once
// Faults that make frames late by chance or let them change places, alike for bytes of a line and radio
// frames. `Base` decides what becomes of the frames behind: QueuedFault pushes them back, FrameFault lets
// them pass.

#include "cosim/faults/frame_fault.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace puckloop::cosim {

/// Late by delay +- jitter, evenly, never early.
template <class Base>
class JitterFrames : public Base {
  public:
    using Base::Base;

  protected:
    void harm(std::size_t i, std::vector<Delivery>& batch) override {
        const double delay = this->spec().parameters.number("delay");
        const double jitter = this->spec().parameters.number("jitter");
        shift(batch[i].message,
              from_seconds(std::max(0.0, delay + jitter * (2.0 * this->random().uniform() - 1.0))));
    }
};

/// Two neighbours change places: the first is held until the second has passed.
template <class Base>
class SwapFrames : public Base {
  public:
    using Base::Base;

  protected:
    /// When a held frame may start behind one that passes, and the earliest that it arrives.
    struct Behind {
        Time start = 0;
        Time arrival = 0;
    };
    /// Nothing: the frame is not one to be overtaken by.
    virtual std::optional<Behind> behind(const Delivery& passing) const = 0;

    bool can_suffer(const Payload&) const override { return !waiting_ && !taken_; }

    void harm(std::size_t i, std::vector<Delivery>& batch) override {
        taken_ = batch[i];
        batch[i].fault = FaultKind::Held;
    }

    void after(std::vector<Delivery>& batch) override {
        for (std::size_t i = 0; waiting_ && i < batch.size(); ++i) {
            const std::optional<Behind> place = behind(batch[i]);
            if (!place || keeps_from_arriving(batch[i].fault)) continue;
            Delivery held = *waiting_;
            shift(held.message, place->start - start_of(held.message.payload));
            held.message.time = std::max(held.message.time, place->arrival);
            held.fault = FaultKind::Swap;
            batch.insert(batch.begin() + static_cast<std::ptrdiff_t>(i) + 1, held);
            waiting_.reset();
        }
        if (taken_) waiting_ = std::exchange(taken_, std::nullopt);
        Base::after(batch);
    }

  private:
    std::optional<Delivery> taken_;    // in this batch
    std::optional<Delivery> waiting_;  // for the next one
};

}  // namespace puckloop::cosim
