#pragma once
// Looks for a booth (a TAM) that offers a task: wanders until the camera sees one shine green or blue, drives
// towards it, serves there once (serve.h), turns away and looks for the next. A booth that it came to askew,
// so that one of its sides was in the way, it comes to again from farther to the other side.

#include "linuxboard/control/serve.h"

#include <optional>

namespace puckloop::control {

class Seek : public Behaviour {
  public:
    Actuators step(const Sensors& sensors, double t) override;
    /// How often it has stood inside a booth.
    unsigned visits() const { return visits_; }

  private:
    enum class State { Search, Approach, Serve, Sidestep, Turn, Rest };
    void enter(State state, double t);
    Actuators approach(const Sensors& sensors, const Actuators& wandering, double t);
    Actuators serve(const Sensors& sensors, double t);
    Actuators sidestep(double t);
    void feel_edge();

    Wander wander_;
    Serve serve_;
    State state_ = State::Search;
    double since_ = 0;  // of the state
    double seen_ = 0;   // when an offer was last seen
    double edge_ = 0;   // counts: the most that was felt on the way in; > 0 on the right
    unsigned visits_ = 0;
};

}  // namespace puckloop::control
