#pragma once
// Serves at a booth (a TAM) that stands ahead: drives in, stays, backs out, pauses, and comes again. With a
// camera it drives towards a booth that shines green or blue, which offers a task, and stays until it is
// dark; without one it drives straight on and stays for 8 s.

#include "linuxboard/control/behaviours/wander.h"

namespace puckloop::control {

class Serve : public Behaviour {
  public:
    Actuators step(const Sensors& sensors, double t) override;
    /// How often it has stood inside.
    unsigned visits() const { return visits_; }
    /// It has backed out, or has found no way in, and waits before it comes again.
    bool pausing() const { return state_ == State::Pause; }
    /// Before the booth, and none offers a task any more.
    bool waiting() const { return waiting_; }
    /// It stands inside.
    bool may_send() const override { return state_ == State::Stay; }

  private:
    enum class State { Approach, Stay, Leave, Pause };
    void enter(State state, double t);
    /// The booth's sides are to the left and the right.
    bool between() const;
    Actuators approach(const Sensors& sensors, double t);
    /// Towards the booth that offers a task; none: there is none to be seen.
    std::optional<Actuators> towards_light(const Sensors& sensors) const;
    bool done(const Sensors& sensors, double t);
    Actuators align() const;

    ProximityBaseline baseline_;
    std::array<double, 8> above_{};
    State state_ = State::Approach;
    double since_ = 0;           // of the state
    double blocked_since_ = -1;  // something ahead that is no booth; < 0: nothing
    bool waiting_ = false;
    double lit_ = 0;   // when the booth around it was last seen to shine
    double bend_ = 0;  // mm/s, of the way back
    unsigned visits_ = 0;
};

}  // namespace puckloop::control
