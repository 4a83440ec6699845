#pragma once
// Drive to light: turn towards the brightest direction, go there, stop where it is bright; obstacles first.

#include "linuxboard/control/wander.h"

namespace puckloop::control {

class DriveToLight : public Behaviour {
  public:
    Actuators step(const Sensors& sensors, double t) override;

  private:
    Wander wander_;
    bool arrived_ = false;
};

}  // namespace puckloop::control
