// Deviations: 1. a gain of the strength acts on all receivers' measurements, whatever made it, and leaves the
// reach alone. 2. A floor bends the medium's level curve at its nine points. 3. A rail of the range register
// is one of the single receivers: the register of a sender between two receivers at the rail is a little
// above it.

#include "gap/overlay/overlay_parts.h"

#include "gap/models/rab_table.h"
#include "physics/description/parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace puckloop::gap {

namespace {

/// The register of a sender between two receivers that both lie at the rail, over the rail.
constexpr double kTwoAtTheRail = 1.19;

class RabOverlay {
  public:
    RabOverlay(Values& fitted, Values& simulator) : fitted_(fitted), simulator_(simulator) {}

    void write() {
        gains();
        levels();
        noise();
        if (const auto rail = take("rab.saturation")) {
            double dark = 0.0;
            for (const double one : defaults_.ir.baseline)
                dark += one / static_cast<double>(defaults_.ir.baseline.size());
            set("ir.rail", *rail / kTwoAtTheRail + dark);
        }
        if (const auto turned = take("rab.bearing_offset"))
            for (std::size_t k = 0; k < defaults_.ir.receiver_angle.size(); ++k)
                set(fmt::format("ir.receiver_angle{}", k),
                    std::remainder(defaults_.ir.receiver_angle[k] - *turned, 2 * std::numbers::pi));
        constexpr std::pair<const char*, const char*> kSame[] = {
            {"rab.emitter_lobe", "ir.emitter_exponent"},
            {"rab.receiver_lobe", "ir.receiver_exponent"},
            {"rab.random_loss", "ir.loss"},
            {"rab.beat", "ir.spell"},
            {"rab.beat_burst", "ir.spell_time"},
            {"rab.multipath", "ir.stray"},
            {"rab.multipath_loss", "ir.stray_loss"}};
        for (const auto& [own, name] : kSame)
            if (const auto value = take(own)) set(name, *value);
    }

  private:
    std::optional<double> take(const std::string& name) { return gap::take(fitted_, name); }
    void set(const std::string& name, double value) { simulator_[name] = value; }

    /// Gains of parts; the boards number them from 1.
    void gains() {
        scale_ = std::exp(take("rab.strength_gain").value_or(0.0));
        for (std::size_t k = 0; k < defaults_.ir.receiver_gain.size(); ++k) {
            const auto own = take(fmt::format("rab.receiver_gain{}", k + 1));
            if (own || scale_ != 1.0)
                set(fmt::format("ir.receiver_gain{}", k),
                    defaults_.ir.receiver_gain[k] * scale_ * own.value_or(1.0));
            if (const auto emitter = take(fmt::format("rab.emitter_gain{}", k + 1)))
                set(fmt::format("ir.emitter_gain{}", k), *emitter);
        }
    }
    void levels() {
        const auto floor = take("rab.far_floor");
        if (!floor) return;
        for (std::size_t k = 0; k < kRabTable.size(); ++k)
            set(fmt::format("ir.level{}", k),
                defaults_.ir.level[k] * std::max(1.0, *floor / (scale_ * std::exp(kRabTable[k].log_median))));
    }
    void noise() {
        const auto more = take("rab.strength_spread");
        if (!more) return;
        set("ir.frame_noise", defaults_.ir.frame_noise * (1 + *more));
        set("ir.receiver_noise", defaults_.ir.receiver_noise * (1 + *more));
        set("ir.near_noise", defaults_.ir.near_noise * (1 + *more));
    }

    Values &fitted_, &simulator_;
    const physics::Parameters defaults_;
    double scale_ = 1.0;
};

}  // namespace

void rab_overlay(Values& fitted, Values& simulator) {
    RabOverlay(fitted, simulator).write();
}

}  // namespace puckloop::gap
