#pragma once
// The Li-ion cell: charge drawn by electronics and motors, voltage from charge and load. Source: physics
// facts section 7.
//
// Deviations: 1. no temperature, ageing or relaxation. 2. A motor draws its power whenever it steps.

#include "physics/description/parameters.h"

namespace puckloop::physics {

class Battery {
  public:
    explicit Battery(const BatteryParameters& parameters);

    /// `running` motors (0..2) for one physics step; returns the voltage at the terminals.
    double draw(int running);
    void set_parameters(const BatteryParameters& parameters) { parameters_ = parameters; }
    /// Another cell is put in; `charge` 0..1 of its capacity.
    void set_charge(double charge) { charge_ = charge; }
    double voltage() const { return voltage_; }
    bool low() const { return voltage_ < parameters_.low_voltage; }

  private:
    void load(double watts);

    BatteryParameters parameters_;
    double charge_;  // share of capacity
    double voltage_ = 0.0;
};

}  // namespace puckloop::physics
