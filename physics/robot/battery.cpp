#include "physics/robot/battery.h"

#include "physics/dynamics/dynamics.h"

#include <algorithm>
#include <cmath>

namespace puckloop::physics {

namespace {

constexpr double kSecondsPerHour = 3600;

struct CellPoint {
    double charge, volts;
};
/// Open-circuit voltage of a Li-ion cell, typical.
constexpr CellPoint kOpenCircuit[] = {{0.0, 3.00}, {0.05, 3.35}, {0.1, 3.48}, {0.2, 3.60},
                                      {0.4, 3.70}, {0.6, 3.83},  {0.8, 3.98}, {1.0, 4.18}};

double open_circuit(double charge) {
    for (std::size_t i = 1; i < std::size(kOpenCircuit); ++i) {
        const auto& a = kOpenCircuit[i - 1];
        const auto& b = kOpenCircuit[i];
        if (charge <= b.charge)
            return a.volts + (b.volts - a.volts) * (charge - a.charge) / (b.charge - a.charge);
    }
    return kOpenCircuit[std::size(kOpenCircuit) - 1].volts;
}

}  // namespace

Battery::Battery(const BatteryParameters& parameters) : parameters_(parameters), charge_(parameters.charge) {
    load(parameters.idle_power);
}

void Battery::load(double watts) {
    // V = E - R P / V: the upper root; at a load the cell cannot carry, half of E is the most it gives.
    const double e = open_circuit(charge_);
    const double under = e * e - 4 * parameters_.resistance * watts;
    voltage_ = (e + std::sqrt(std::max(under, 0.0))) / 2;
}

double Battery::draw(int running) {
    const double watts = parameters_.idle_power + parameters_.motor_power * running;
    charge_ = std::max(0.0, charge_ - watts * kStepSeconds / (parameters_.capacity * kSecondsPerHour));
    load(watts);
    return voltage_;
}

}  // namespace puckloop::physics
