#pragma once
// What one range-and-bearing board reads of another's frame, ring and medium included: light by the
// simulator's own coupling (physics/ir/ir_coupling), strength and bearing by the formulas of the board's
// firmware (protocols/infrared/rab_reading, here without its rounding).
//
// Deviations: 1. boards stand alone; nothing shades or mirrors. 2. Spreads of parts count as noise of single
// messages; what boards that a run has for itself do to all its messages is drawn beside it. 3. A receiver at
// the edge of its reach counts by its probability. 4. The sender's power is the curve's reference.

#include "gap/models/keyed_cache.h"
#include "physics/ir/ir_coupling.h"

#include <array>
#include <cmath>
#include <memory>
#include <vector>

namespace puckloop::gap {

inline constexpr std::size_t kRabParts = physics::kIrSensors;

/// One message: where the boards stood.
struct RabLook {
    double distance = 0.0;  ///< m between the bodies
    double bearing = 0.0;   ///< rad, of the sender in the receiver's frame
    double facing = NAN;    ///< rad, of the receiver in the sender's frame; NaN: not known
    int emitter = 0;        ///< 1..12, 0: all
};

/// What may differ from the simulator.
struct RabParts {
    std::array<double, kRabParts> receiver{}, emitter{};  ///< gains
    double emitter_lobe = 1.0, receiver_lobe = 0.5;       ///< exponents of the cosine
};

struct RabReading {
    double log_strength = 0.0, bearing = 0.0;  ///< ln counts; rad
};
/// The firmware's formulas in double precision; `peaks` are counts above darkness. Without light all is 0.
RabReading rab_reading(const std::array<double, kRabParts>& peaks);

class RabRing {
  public:
    /// `carrier`: Hz of the sender's emitters; 0: what the demodulators are made for.
    RabRing(std::vector<RabLook> looks, const physics::IrParameters& parameters, double carrier);

    RabParts neutral() const;
    /// The reading of each look, chance averaged.
    std::shared_ptr<const std::vector<RabReading>> readings(const RabParts& parts) const;
    /// What chance and spread of parts add to each look: sd of ln strength and of the bearing (rad).
    const std::vector<double>& strength_sd() const { return strength_sd_; }
    const std::vector<double>& bearing_sd() const { return bearing_sd_; }
    /// What boards with parts drawn by the simulator's spreads read beside the mean of such boards: some of
    /// them, each of all looks.
    std::vector<std::vector<RabReading>> drawn_boards() const;

  private:
    using Light = physics::IrCoupling;
    struct Seen {
        std::array<double, kRabParts> level{}, heard{};  // heard: probability that it counts
    };
    std::vector<Light> shine(double emitter_lobe, double receiver_lobe) const;
    std::shared_ptr<const std::vector<Seen>> gather(const RabParts& parts) const;
    RabReading reading_of(const Seen& seen, const RabParts& parts) const;
    double full_scale(std::size_t receiver) const;
    void draw_chance();

    std::vector<RabLook> looks_;
    physics::IrParameters parameters_;
    double carrier_;  // Hz
    std::vector<double> strength_sd_, bearing_sd_;
    std::vector<RabReading> shift_;                 // what chance adds to the mean
    KeyedCache<std::vector<Light>> light_;          // by the lobes
    KeyedCache<std::vector<Seen>> seen_;            // by lobes and emitters
    KeyedCache<std::vector<RabReading>> readings_;  // by all
};

}  // namespace puckloop::gap
