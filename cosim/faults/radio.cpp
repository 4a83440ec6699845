// Faults of radio frames between a module and the air, other than those that bytes suffer in the same way.

#include "cosim/faults/reordered_frames.h"

#include <algorithm>
#include <optional>
#include <set>

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

/// Frames may pass one another.
using JitterRadio = JitterFrames<FrameFault>;

class SwapRadio : public SwapFrames<FrameFault> {
  public:
    using SwapFrames::SwapFrames;

  protected:
    std::optional<Behind> behind(const Delivery& passing) const override {
        const auto* frame = std::get_if<RadioFrame>(&passing.message.payload);
        if (!frame || frame->duration == 0) return std::nullopt;
        return Behind{frame->start + frame->duration, passing.message.time + frame_time(*frame)};
    }
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
