#pragma once
// Looks for a booth (a TAM) that offers a task: wanders until the camera sees one shine green or blue, drives
// onto the axis of its opening and in, serves there once (serve.h), turns away and looks for the next. Where
// a side of the booth hides all lights but one, it tries one side and then the other. It waits where it sees
// others work. A booth that it came to askew, so that one of its sides was in the way, it comes to again from
// farther to the other side.

#include "linuxboard/control/behaviours/booth_lights.h"
#include "linuxboard/control/behaviours/serve.h"

#include <optional>

namespace puckloop::control {

class Seek : public Behaviour {
  public:
    Seek();
    Actuators step(const Sensors& sensors, double t) override;
    /// How often it has stood inside a booth.
    unsigned visits() const { return visits_; }
    bool may_send() const override { return state_ == State::Serve && serve_.may_send(); }

  private:
    enum class State { Search, Approach, Retreat, Serve, Sidestep, Turn, Rest };
    void enter(State state, double t);
    Actuators approach(const BoothLights* booth, const Sensors& sensors, const Actuators& wandering,
                       double t);
    Actuators wrong_guess(double t);
    Actuators retreat(double t);
    bool waits(const std::vector<BoothLights>& booths, double t);
    void look(const BoothLights& booth, double t);
    Actuators serve(const Sensors& sensors, double t);
    Actuators sidestep(double t);
    void feel_edge();

    Wander wander_;
    Serve serve_;
    State state_ = State::Search;
    double since_ = 0;          // of the state
    double seen_ = 0;           // when an offer was last seen
    double busy_seen_ = -1e9;   // when lights of any colour were last seen
    double waiting_since_ = 0;  // before them
    double askew_ = 0;          // rad, of the booth's axis (booth_lights.h)
    bool known_ = false;        // askew_ has been seen
    double guess_ = 0.5;        // rad, in its place: about where a single light is seen from
    bool guessing_ = false;     // it drives by the guess
    double edge_ = 0;           // counts: the most that was felt on the way in; > 0 on the right
    unsigned visits_ = 0;
};

}  // namespace puckloop::control
