#pragma once
// Which lines are lit, and what light that makes at every phototransistor: a function of the two alone. Knows
// no time but that of the scene.

#include "physics/ircom/scene.h"

#include <cstdint>
#include <vector>

namespace puckloop::physics {

/// The light at a phototransistor has become `counts`.
struct IrcomLight {
    std::size_t device = 0, sensor = 0;
    double counts = 0.0;
};

class IrcomMedium {
  public:
    IrcomMedium(const World& world, bool changes);

    IrcomScene& scene() { return scene_; }
    const IrcomScene& scene() const { return scene_; }

    /// Takes effect with the next update().
    void set(std::size_t device, std::size_t line, bool lit);
    bool lit(std::size_t device) const { return lit_[device] != 0; }
    bool any_lit() const;
    /// Light as it is now at `device`'s sensor.
    double light(std::size_t device, std::size_t sensor) const {
        return light_[device * kProximitySensors + sensor];
    }
    /// The brightest of a device's sensors.
    double brightest(std::size_t device) const;
    /// What one sender by itself brings to the brightest sensor of `receiver` with the lines that it has lit.
    double from(std::size_t sender, std::size_t receiver) const;

    /// Appends what has changed, by device and sensor.
    void update(std::vector<IrcomLight>& changed);

    template <class Archive>
    void state(Archive& archive) {
        archive(scene_, lit_, light_);
    }

  private:
    IrcomScene scene_;
    std::vector<std::uint8_t> lit_;  ///< bit by line
    std::vector<double> light_;      ///< [device][sensor]
    std::vector<double> sum_;        ///< scratch
};

}  // namespace puckloop::physics
