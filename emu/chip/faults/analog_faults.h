#pragma once
// Faults of analog inputs, between the pin and the converter: each sample of the channel may suffer.
//   adc_stuck `value`, adc_offset `value`, adc_gain `factor`, adc_noise `sigma`; values are shares of full
//   scale, 0 to 1

#include "cosim/core/clock.h"
#include "emu/chip/faults/carried.h"

#include <cstdint>
#include <string_view>
#include <vector>

namespace puckloop::chip {

class AnalogFaults {
  public:
    /// True of the kinds that belong here.
    static bool takes(std::string_view kind) { return kind.starts_with("adc_"); }
    /// The cycles of `clock` begin at `origin` in the run's time.
    void begin(std::vector<cosim::CarriedFault> faults, const cosim::ClockDomain& clock,
               cosim::Time origin = 0);

    bool any() const { return !faults_.empty(); }
    /// What the converter sees in place of `reading`, both in shares of full scale.
    double apply(int channel, double reading, std::uint64_t cycle);

    const std::vector<cosim::CarriedFault>& faults() const { return faults_; }

    template <class Archive>
    void state(Archive& archive) {
        list_faults(archive, faults_);
    }

  private:
    std::vector<cosim::CarriedFault> faults_;
    const cosim::ClockDomain* clock_ = nullptr;
    cosim::Time origin_ = 0;
};

}  // namespace puckloop::chip
