#include "cosim/faults/trigger.h"

#include <fmt/format.h>

#include <algorithm>

namespace puckloop::cosim {

Trigger::Trigger(const FaultSpec& spec, RandomStream random)
    : probability_(spec.probability),
      count_(spec.count),
      skip_(spec.skip),
      every_(std::max<std::uint64_t>(spec.every, 1)),
      begin_(spec.begin),
      end_(spec.end),
      period_(spec.period),
      burst_(spec.burst),
      random_(random) {}

bool Trigger::fires(Time time) {
    if (spent() || !open(time)) return false;
    const std::uint64_t place = state_.matched++;
    if (place < skip_ || (place - skip_) % every_ != 0) return false;
    if (!drawn()) return false;
    ++state_.fired;
    return true;
}

bool Trigger::drawn() {
    if (burst_) {
        const bool suffers = random_.uniform() < (state_.bad ? burst_->bad : burst_->good);
        if (random_.uniform() < (state_.bad ? burst_->r : burst_->p)) state_.bad = !state_.bad;
        return suffers;
    }
    return probability_ >= 1.0 || random_.uniform() < probability_;
}

Time Trigger::instant(Time time) const {
    Time next = begin_;
    if (time > begin_) {
        if (period_ <= 0) return kNever;
        next = later(begin_, (time - begin_ + period_ - 1) / period_ * period_);
    }
    return next < end_ ? next : kNever;
}

RandomStream fault_stream(const FaultSpec& spec, std::uint64_t seed, std::size_t index, int use) {
    return {seed, fmt::format("fault/{}/{}/{}", index, spec.link.empty() ? spec.node : spec.link, use)};
}

}  // namespace puckloop::cosim
