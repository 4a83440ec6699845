#include "physics/ir/ir_receiver.h"

#include <algorithm>

namespace puckloop::physics {

using cosim::Time;

namespace {

/// A decision falls a tenth of the delay before it shows at the latest, so that it is never due when it
/// falls.
Time decided_within(double seconds, Time delay) {
    return std::min(cosim::from_seconds(seconds), delay - delay / 10);
}

int counts(float level, float rail) {
    return static_cast<int>(std::clamp(level, 0.0F, rail) + 0.5F);
}

}  // namespace

IrReceiver::IrReceiver(const IrParameters& p)
    : delay_on_(cosim::from_seconds(p.delay_on)),
      delay_off_(cosim::from_seconds(p.delay_off)),
      min_burst_(decided_within(p.min_burst, delay_on_)),
      min_gap_(decided_within(p.min_gap, delay_off_)),
      level_delay_(cosim::from_seconds(p.level_delay)),
      level_hold_(cosim::from_seconds(p.level_hold)),
      gain_hold_(cosim::from_seconds(p.gain_hold)),
      lookahead_(std::min({delay_on_, delay_off_, level_delay_})),
      settled_(std::min({delay_on_ - min_burst_, delay_off_ - min_gap_, level_delay_})),
      threshold_(static_cast<float>(p.threshold)),
      rail_(static_cast<float>(p.rail)),
      gain_share_(static_cast<float>(p.gain_share)) {
    level_.fill(-1);
    shown_.fill(-1);
}

/// Clears `mask` in changes not decided yet; returns what was cleared.
std::uint16_t IrReceiver::take_back(std::deque<Change>& changes, std::uint16_t mask) {
    std::uint16_t taken = 0;
    for (Change& change : changes) {
        taken = static_cast<std::uint16_t>(taken | (change.mask & mask));
        change.mask = static_cast<std::uint16_t>(change.mask & ~mask);
    }
    return taken;
}

void IrReceiver::put(Time time, std::size_t index, double value) {
    time = std::max(time, last_[index] + 1);  // delays that differ cannot turn two changes round
    last_[index] = time;
    const IrOutput output{time, static_cast<std::uint8_t>(index), value};
    const auto later = [](const IrOutput& a, const IrOutput& b) {
        return a.time != b.time ? a.time < b.time : a.index < b.index;
    };
    outputs_.insert(std::upper_bound(outputs_.begin(), outputs_.end(), output, later), output);
}

void IrReceiver::see(Time now, const IrLight& light) {
    control_gain(now, light.carrier);
    if (const std::uint16_t above = above_threshold(); above != above_) demodulate(now, above);
    measure(now, light.level);
}

std::uint16_t IrReceiver::above_threshold() const {
    std::uint16_t above = 0;
    for (std::size_t k = 0; k < kIrSensors; ++k)
        if (is_above(k)) above = static_cast<std::uint16_t>(above | 1U << k);
    return above;
}

void IrReceiver::control_gain(Time now, const IrArray<float>& carrier) {
    if (gain_share_ == 0.0F) {
        carrier_ = carrier;
        return;
    }
    std::uint16_t fell = 0, back = 0;
    for (std::size_t k = 0; k < kIrSensors; ++k) {
        if (carrier[k] == carrier_[k]) continue;
        const auto bit = static_cast<std::uint16_t>(1U << k);
        const bool was_strongest = carrier_[k] >= strongest_[k];
        carrier_[k] = carrier[k];
        if (carrier[k] >= strongest_[k]) {
            strongest_[k] = carrier[k];
            if (!was_strongest) back = static_cast<std::uint16_t>(back | bit);
        } else if (was_strongest) {
            fell = static_cast<std::uint16_t>(fell | bit);
        }
    }
    if (back != 0) take_back(fading_, back);
    if (fell != 0) fading_.push_back({now, fell});
}

void IrReceiver::demodulate(Time now, std::uint16_t above) {
    const auto rose = static_cast<std::uint16_t>(above & ~above_);
    const auto fell = static_cast<std::uint16_t>(above_ & ~above);
    above_ = above;
    // A gap or burst that was too short leaves no trace.
    const auto burst = static_cast<std::uint16_t>(rose & ~take_back(falling_, rose));
    const auto gap = static_cast<std::uint16_t>(fell & ~take_back(rising_, fell));
    if (burst != 0) rising_.push_back({now, burst});
    if (gap != 0) falling_.push_back({now, gap});
}

void IrReceiver::measure(Time now, const IrArray<float>& level) {
    std::uint16_t fell = 0;
    std::uint16_t back = 0;
    for (std::size_t k = 0; k < kIrSensors; ++k) {
        const int value = counts(level[k], rail_);
        if (value == level_[k]) continue;
        const bool was_lower = level_[k] < shown_[k];
        level_[k] = value;
        const auto bit = static_cast<std::uint16_t>(1U << k);
        if (value >= shown_[k]) {
            if (was_lower) back = static_cast<std::uint16_t>(back | bit);
            if (value == shown_[k]) continue;
            shown_[k] = value;
            put(now + level_delay_, kIrLevelOutput + k, value);
        } else if (!was_lower) {
            fell = static_cast<std::uint16_t>(fell | bit);
        }
    }
    if (back != 0) take_back(lower_, back);
    if (fell != 0) lower_.push_back({now, fell});
}

void IrReceiver::decide(const Change& change, Time delay, double value) {
    for (std::size_t k = 0; k < kIrSensors; ++k)
        if ((change.mask >> k & 1U) != 0) put(change.begun + delay, k, value);
}

void IrReceiver::run_to(Time now) {
    for (; !fading_.empty() && fading_.front().begun + gain_hold_ <= now; fading_.pop_front()) {
        const Change over = fading_.front();
        for (std::size_t k = 0; k < kIrSensors; ++k)
            if ((over.mask >> k & 1U) != 0) strongest_[k] = carrier_[k];
        settle_bursts(over.begun + gain_hold_);
        if (const std::uint16_t above = above_threshold(); above != above_)
            demodulate(over.begun + gain_hold_, above);
    }
    settle_bursts(now);
    for (; !lower_.empty() && lower_.front().begun + level_hold_ <= now; lower_.pop_front())
        for (std::size_t k = 0; k < kIrSensors; ++k) {
            if ((lower_.front().mask >> k & 1U) == 0) continue;
            shown_[k] = level_[k];
            put(lower_.front().begun + level_hold_ + level_delay_, kIrLevelOutput + k, shown_[k]);
        }
}

/// Decides which bursts and gaps were long enough.
void IrReceiver::settle_bursts(Time now) {
    for (; !rising_.empty() && rising_.front().begun + min_burst_ <= now; rising_.pop_front())
        decide(rising_.front(), delay_on_, 1.0);
    for (; !falling_.empty() && falling_.front().begun + min_gap_ <= now; falling_.pop_front())
        decide(falling_.front(), delay_off_, 0.0);
}

void IrReceiver::release(Time until, std::vector<IrOutput>& out) {
    while (!outputs_.empty() && outputs_.front().time < until + settled_) {
        out.push_back(outputs_.front());
        outputs_.pop_front();
    }
}

Time IrReceiver::next_output() const {
    Time next = outputs_.empty() ? cosim::kNever : outputs_.front().time;
    const auto consider = [&next](const std::deque<Change>& changes, Time delay) {
        for (const Change& change : changes) {
            if (change.mask == 0) continue;
            next = std::min(next, change.begun + delay);
            return;
        }
    };
    consider(rising_, delay_on_);
    consider(falling_, delay_off_);
    consider(lower_, level_hold_ + level_delay_);
    consider(fading_, gain_hold_ + delay_on_);
    return next;
}

}  // namespace puckloop::physics
