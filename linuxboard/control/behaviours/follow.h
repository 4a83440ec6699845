#pragma once
// Follow the leader: a robot follows the one with the next lower id that it hears; who hears no lower id
// leads and wanders. Robots 1, 2, 3 form a chain behind 1. A robot that has lost its leader turns to where it
// heard it last, then wanders on.

#include "linuxboard/control/behaviours/wander.h"

namespace puckloop::control {

class Follow : public Behaviour {
  public:
    explicit Follow(int own_id) : own_id_(own_id) {}
    Actuators step(const Sensors& sensors, double t) override;

  private:
    Actuators pursue(const Neighbour& leader, const Actuators& wandering);
    Actuators lead_or_search(double t, Actuators wandering) const;

    int own_id_;
    Wander wander_;
    double heard_ = -1;  // when a leader was heard last, s; negative: never
    double last_bearing_ = 0;
};

}  // namespace puckloop::control
