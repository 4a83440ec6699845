#include "physics/ir_fate.h"

#include <cmath>
#include <numbers>
#include <string>

namespace puckloop::physics {

namespace {
constexpr double kStrayTurn = 0.6;    // rad, scatter of a reflection's bearing
constexpr double kStraySpread = 0.3;  // ln counts, scatter of its strength
}  // namespace

IrFate::IrFate(const IrParameters& p, std::uint64_t seed, std::string_view pair)
    : loss_(p.loss),
      spell_(p.spell),
      spell_time_(p.spell_time),
      stray_(p.stray),
      stray_strength_(p.stray_loss),
      random_(seed, "ir/fate/" + std::string(pair)) {}

/// Two states that are left at random: lost for the share `spell` of all time, remembered for `spell_time`.
bool IrFate::in_spell(double seconds) {
    const double kept = std::exp(-(seconds - last_) / spell_time_);
    last_ = seconds;
    const double chance = spell_now_ ? spell_ + (1 - spell_) * kept : spell_ * (1 - kept);
    spell_now_ = random_.uniform() < chance;
    return spell_now_;
}

BurstFate IrFate::next(double seconds) {
    BurstFate fate;
    if (loss_ > 0.0) fate.lost = random_.uniform() < loss_;
    if (spell_ > 0.0 && in_spell(seconds)) fate.lost = true;
    if (stray_ > 0.0 && random_.uniform() < stray_) {
        constexpr auto kAll = static_cast<long>(kIrSensors);
        const double pitch = 2 * std::numbers::pi / kAll;
        const long turn = std::lround(kStrayTurn * random_.normal() / pitch) % kAll;
        fate.turn = static_cast<std::size_t>((turn + kAll) % kAll);
        fate.strength = static_cast<float>(std::exp(kStraySpread * random_.normal() - stray_strength_));
    }
    return fate;
}

}  // namespace puckloop::physics
