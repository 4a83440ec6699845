// Deviations: 1. a gain of the strength acts on all receivers' measurements, whatever made it, and leaves the
// reach alone. 2. A floor bends the medium's level curve at its nine points. 3. A rail of the range register
// is one of the single receivers: the register of a sender between two receivers at the rail is a little
// above it.

#include "gap/overlay/overlay_parts.h"

#include "physics/description/parameters.h"
#include "physics/ir/published_strengths.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace puckloop::gap {

namespace {

/// The register of a sender between two receivers that both lie at the rail, over the rail.
constexpr double kTwoAtTheRail = 1.19;

constexpr std::pair<const char*, const char*> kRenamed[] = {{"rab.emitter_lobe", "ir.emitter_exponent"},
                                                            {"rab.receiver_lobe", "ir.receiver_exponent"},
                                                            {"rab.random_loss", "ir.loss"},
                                                            {"rab.beat", "ir.spell"},
                                                            {"rab.beat_burst", "ir.spell_time"},
                                                            {"rab.multipath", "ir.stray"},
                                                            {"rab.multipath_loss", "ir.stray_loss"}};

}  // namespace

void rab_overlay(Values& fitted, Values& simulator) {
    const physics::IrParameters drawn = physics::Parameters().ir;
    const double scale = std::exp(take(fitted, "rab.strength_gain").value_or(0.0));
    for (std::size_t k = 0; k < drawn.receiver_gain.size(); ++k) {  // the boards number them from 1
        const auto receiver = take(fitted, fmt::format("rab.receiver_gain{}", k + 1)),
                   emitter = take(fitted, fmt::format("rab.emitter_gain{}", k + 1));
        if (receiver || scale != 1.0)
            simulator[fmt::format("ir.receiver_gain{}", k)] =
                drawn.receiver_gain[k] * scale * receiver.value_or(1.0);
        if (emitter) simulator[fmt::format("ir.emitter_gain{}", k)] = *emitter;
    }
    if (const auto floor = take(fitted, "rab.far_floor"))
        for (std::size_t k = 0; k < physics::kPublishedStrengths.size(); ++k)
            simulator[fmt::format("ir.level{}", k)] =
                drawn.level[k] *
                std::max(1.0, *floor / (scale * std::exp(physics::kPublishedStrengths[k].log_median)));
    if (const auto more = take(fitted, "rab.strength_spread")) {
        simulator["ir.frame_noise"] = drawn.frame_noise * (1 + *more);
        simulator["ir.receiver_noise"] = drawn.receiver_noise * (1 + *more);
        simulator["ir.near_noise"] = drawn.near_noise * (1 + *more);
    }
    if (const auto rail = take(fitted, "rab.saturation")) {
        double dark = 0.0;
        for (const double one : drawn.baseline)
            dark += one / static_cast<double>(drawn.baseline.size());
        simulator["ir.rail"] = *rail / kTwoAtTheRail + dark;
    }
    if (const auto turned = take(fitted, "rab.bearing_offset"))
        for (std::size_t k = 0; k < drawn.receiver_angle.size(); ++k)
            simulator[fmt::format("ir.receiver_angle{}", k)] =
                std::remainder(drawn.receiver_angle[k] - *turned, 2 * std::numbers::pi);
    for (const auto& [own, name] : kRenamed)
        if (const auto value = take(fitted, own)) simulator[name] = *value;
}

}  // namespace puckloop::gap
