#include "physics/ir/burst_outcomes.h"

#include <cmath>
#include <numbers>
#include <string>

namespace puckloop::physics {

namespace {
constexpr double kStrayTurn = 0.6;    // rad, scatter of a reflection's bearing
constexpr double kStraySpread = 0.3;  // ln counts, scatter of its strength
}  // namespace

BurstOutcomes::BurstOutcomes(const IrParameters& p, std::uint64_t seed, std::string_view pair)
    : loss_(p.loss),
      stray_(p.stray),
      stray_strength_(p.stray_loss),
      random_(seed, "ir/fate/" + std::string(pair)) {}

BurstOutcome BurstOutcomes::next() {
    BurstOutcome outcome;
    if (loss_ > 0.0) outcome.lost = random_.uniform() < loss_;
    if (stray_ > 0.0 && random_.uniform() < stray_) {
        constexpr auto kAll = static_cast<long>(kIrSensors);
        const double pitch = 2 * std::numbers::pi / kAll;
        const long turn = std::lround(kStrayTurn * random_.normal() / pitch) % kAll;
        outcome.turn = static_cast<std::size_t>((turn + kAll) % kAll);
        outcome.strength = static_cast<float>(std::exp(kStraySpread * random_.normal() - stray_strength_));
    }
    return outcome;
}

IrSpell::IrSpell(const IrParameters& p, std::uint64_t seed, std::string_view pair)
    : share_(p.spell), time_(p.spell_time), random_(seed, "ir/spell/" + std::string(pair)) {}

/// Two states that are left at random.
bool IrSpell::at(double seconds) {
    if (share_ <= 0.0 || seconds <= last_) return now_;
    const double kept = std::exp(-(seconds - last_) / time_);
    last_ = seconds;
    const double chance = now_ ? share_ + (1 - share_) * kept : share_ * (1 - kept);
    now_ = random_.uniform() < chance;
    return now_;
}

}  // namespace puckloop::physics
