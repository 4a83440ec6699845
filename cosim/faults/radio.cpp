// Faults of radio frames between a module and the air, other than those that bytes suffer in the same way.

#include "cosim/faults/frame_fault.h"

#include <algorithm>
#include <optional>
#include <set>
#include <utility>

namespace puckloop::cosim {

namespace {

class FlipRadio : public FrameFault {
  public:
    using FrameFault::FrameFault;

  protected:
    void harm(std::size_t i, std::vector<Delivery>& batch) override {
        RadioFrame& frame = std::get<RadioFrame>(batch[i].message.payload);
        const auto view = frame.octets.view();
        if (view.empty()) return;
        std::vector<std::uint8_t> octets(view.begin(), view.end());
        const std::size_t bits = std::min<std::size_t>(
            8 * octets.size(), static_cast<std::size_t>(spec().parameters.number("bits")));
        for (std::set<std::uint64_t> chosen; chosen.size() < bits;) {
            const std::uint64_t bit = random().below(8 * octets.size());
            if (!chosen.insert(bit).second) continue;
            octets[bit / 8] = static_cast<std::uint8_t>(octets[bit / 8] ^ 1u << bit % 8);
        }
        frame.octets = Octets(octets);
    }
};

/// Late by delay +- jitter, evenly: frames may pass one another.
class JitterRadio : public FrameFault {
  public:
    using FrameFault::FrameFault;

  protected:
    void harm(std::size_t i, std::vector<Delivery>& batch) override {
        const double delay = spec().parameters.number("delay"), jitter = spec().parameters.number("jitter");
        shift(batch[i].message,
              from_seconds(std::max(0.0, delay + jitter * (2.0 * random().uniform() - 1.0))));
    }
};

/// Held until the next frame has passed.
class SwapRadio : public FrameFault {
  public:
    using FrameFault::FrameFault;

  protected:
    bool can_suffer(const Payload&) const override { return !waiting_ && !taken_; }

    void harm(std::size_t i, std::vector<Delivery>& batch) override {
        taken_ = batch[i];
        batch[i].fault = FaultKind::Held;
    }

    void after(std::vector<Delivery>& batch) override {
        for (std::size_t i = 0; waiting_ && i < batch.size(); ++i) {
            const auto* passed = std::get_if<RadioFrame>(&batch[i].message.payload);
            if (!passed || passed->duration == 0 || keeps_from_arriving(batch[i].fault)) continue;
            Delivery behind = *waiting_;
            const Time arrival = batch[i].message.time + frame_time(*passed);
            shift(behind.message, passed->start + passed->duration - start_of(behind.message.payload));
            behind.message.time = std::max(behind.message.time, arrival);
            behind.fault = FaultKind::Swap;
            batch.insert(batch.begin() + static_cast<std::ptrdiff_t>(i) + 1, behind);
            waiting_.reset();
        }
        if (taken_) waiting_ = std::exchange(taken_, std::nullopt);
    }

  private:
    std::optional<Delivery> taken_;    // in this batch
    std::optional<Delivery> waiting_;  // for the next one
};

}  // namespace

std::vector<KindInfo> radio_kinds() {
    const ParameterInfo bits{"bits", Unit::Integer, 1, 8 * kMostRadioOctets, 1};
    const ParameterInfo delay{"delay", Unit::Time, 0, 1e6, {}, true};
    const ParameterInfo jitter{"jitter", Unit::Time, 0, 1e6, 0.0};
    const auto kind = [](std::string_view name, Style style, FaultKind mark,
                         std::vector<ParameterInfo> parameters = {}, std::string_view alias = {}) {
        return KindInfo{name, PlaceKind::Radio, style, mark, std::move(parameters), alias};
    };
    return {
        kind("drop", Style::Each, FaultKind::Drop, {}, "loss"),
        kind("flip", Style::Each, FaultKind::Flip, {bits}, "corrupt"),
        kind("delay", Style::Each, FaultKind::Delay, {delay, jitter}),
        kind("duplicate", Style::Each, FaultKind::Duplicate),
        kind("swap", Style::Each, FaultKind::Swap, {}, "reorder"),
        kind("disconnect", Style::Hold, FaultKind::Disconnect),
    };
}

std::unique_ptr<LinkFault> make_radio_fault(const FaultPlan& plan) {
    if (plan.site.place != PlaceKind::Radio) return nullptr;
    switch (plan.kind.mark) {
    case FaultKind::Flip:
        return std::make_unique<FlipRadio>(plan);
    case FaultKind::Swap:
        return std::make_unique<SwapRadio>(plan);
    case FaultKind::Delay:
        if (plan.spec.parameters.number("jitter") > 0) return std::make_unique<JitterRadio>(plan);
        return nullptr;
    default:
        return nullptr;
    }
}

}  // namespace puckloop::cosim
