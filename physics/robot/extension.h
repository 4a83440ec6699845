#pragma once
// The terms without a mechanism (physics/description/extension.h) of one robot, ready to be asked.

#include "base/random.h"
#include "physics/description/description.h"

#include <array>
#include <string>
#include <vector>

namespace puckloop::physics {

/// s over which Known::Speed and TurnRate are means: what a log at the control period calls speed.
inline constexpr double kSpeedWindow = 0.1;

/// What is known at a moment, in the order of Known; what the quantity does not know is not read.
using Moment = std::array<double, kKnown>;

class Extension {
  public:
    /// `robot`: its name, for the stream of what is drawn once a run.
    Extension(const std::vector<ExtensionTerm>& terms, std::uint64_t seed, const std::string& robot);

    /// Does any term add to this?
    bool adds_to(Extended quantity) const { return !terms_[index_of(quantity)].empty(); }
    bool moves() const {
        return adds_to(Extended::Forward) || adds_to(Extended::Left) || adds_to(Extended::Turn);
    }
    /// Does a term of this depend on that?
    bool asks(Extended quantity, Known covariate) const;
    /// What all terms add to it, the quantity's unit.
    double of(Extended quantity, int sensor, const Moment& now) const;

  private:
    struct Table {
        ExtensionTerm term;
        std::array<Known, 2> over{};
        int times = -1;              // a Known; -1: none
        std::vector<double> offset;  // of each sensor, this run's
    };
    static std::size_t index_of(Extended quantity) { return static_cast<std::size_t>(quantity); }

    std::array<std::vector<Table>, kExtended> terms_;
};

inline double& known(Moment& moment, Known one) {
    return moment[static_cast<std::size_t>(one)];
}

}  // namespace puckloop::physics
