#pragma once
// Which lines are lit, and what light that makes at every phototransistor: a function of the two alone. Knows
// no time but that of the scene.

#include "physics/ircom/scene.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace puckloop::physics {

/// The light at a phototransistor has become `counts`.
struct IrcomLight {
    std::size_t device = 0, sensor = 0;
    double counts = 0.0;
};

/// A fault lights the lines of a device once more, for all others or one.
struct IrcomCopy {
    std::size_t device = 0;
    std::uint8_t lines = 0;  ///< bit by line
    std::optional<std::size_t> to{};
};

class IrcomMedium {
  public:
    IrcomMedium(const World& world, bool changes);

    IrcomScene& scene() { return scene_; }
    const IrcomScene& scene() const { return scene_; }

    /// Takes effect with the next update().
    void set(std::size_t device, std::size_t line, bool lit);
    bool lit(std::size_t device) const { return lit_[device] != 0; }
    std::uint8_t lines(std::size_t device) const { return lit_[device]; }
    bool any_lit() const;

    // For faults (physics/ircom/faults.h); like set(), they take effect with the next update().
    void expect_faults(std::vector<IrcomCopy> copies);
    IrcomCopy& copy(std::size_t number) { return copies_[number]; }
    /// A sender's own light does not reach a receiver as long as any block is on.
    void block(std::size_t sender, std::size_t receiver, bool on);
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
        archive(scene_, lit_, light_, blocks_);
        for (IrcomCopy& copy : copies_)
            archive(copy.lines);
    }

  private:
    bool blocked(std::size_t sender, std::size_t receiver) const {
        return !blocks_.empty() && blocks_[sender * lit_.size() + receiver] != 0;
    }

    IrcomScene scene_;
    std::vector<std::uint8_t> lit_;      ///< bit by line
    std::vector<double> light_;          ///< [device][sensor]
    std::vector<double> sum_;            ///< scratch
    std::vector<std::uint16_t> blocks_;  ///< [sender][receiver]: so many; empty without faults
    std::vector<IrcomCopy> copies_;
};

}  // namespace puckloop::physics
