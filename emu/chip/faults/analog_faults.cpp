#include "emu/chip/faults/analog_faults.h"

#include <fmt/format.h>

#include <algorithm>

namespace puckloop::chip {

void AnalogFaults::begin(std::vector<cosim::CarriedFault> faults, const cosim::ClockDomain& clock,
                         cosim::Time origin) {
    faults_ = std::move(faults);
    clock_ = &clock;
    origin_ = origin;
}

double AnalogFaults::apply(int channel, double reading, std::uint64_t cycle) {
    const cosim::Time time = cosim::later(clock_->time_of(cycle), origin_);
    for (cosim::CarriedFault& fault : faults_) {
        const cosim::FaultSpec& spec = fault.spec;
        if (spec.parameters.number("channel") != channel || !fault.trigger.fires(time)) continue;
        const double before = reading;
        if (spec.kind == "adc_stuck")
            reading = spec.parameters.number("value");
        else if (spec.kind == "adc_offset")
            reading += spec.parameters.number("value");
        else if (spec.kind == "adc_gain")
            reading *= spec.parameters.number("factor");
        else
            reading += spec.parameters.number("sigma") * fault.trigger.random().normal();
        reading = std::clamp(reading, 0.0, 1.0);
        fault.fired(time, fault.trigger.fired() - 1,
                    fmt::format("AN{} {:.4f} to {:.4f}", channel, before, reading));
    }
    return reading;
}

}  // namespace puckloop::chip
