#pragma once
// Aggregation: drive to the nearest robot heard and stop beside it; leave a group for a larger one.
//
// Each robot sends how many others stand close to it. A robot goes to a neighbour outside its own group only
// if that one's group is larger, or as large and the neighbour's id is the lowest of all concerned: two
// groups that hear each other become one. With one payload byte nobody sends anything, and groups stay as
// they form. Alone it wanders.

#include "linuxboard/control/behaviours/wander.h"

namespace puckloop::control {

class Aggregate : public Behaviour {
  public:
    explicit Aggregate(int own_id) : own_id_(own_id) {}
    Actuators step(const Sensors& sensors, double t) override;
    /// True while it stands beside another robot.
    bool in_group() const { return in_group_; }

  private:
    bool beside(const Neighbour& neighbour) const;
    const Neighbour* destination(const std::vector<Neighbour>& neighbours) const;

    int own_id_;
    Wander wander_;
    bool in_group_ = false;
};

}  // namespace puckloop::control
