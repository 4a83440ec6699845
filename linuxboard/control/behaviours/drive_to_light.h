#pragma once
// Drive to light: turn towards the brightest direction, go there, stop at the brightest place; obstacles
// first.

#include "linuxboard/control/behaviours/wander.h"

namespace puckloop::control {

class DriveToLight : public Behaviour {
  public:
    Actuators step(const Sensors& sensors, double t) override;

  private:
    void watch_arrival(double brightest, bool aligned);

    Wander wander_;
    bool arrived_ = false;
    double peak_ = 0;  // the brightest so far, counts
};

}  // namespace puckloop::control
