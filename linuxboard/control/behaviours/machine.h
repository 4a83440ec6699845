#pragma once
// A finite-state machine of six behaviours and six conditions: what automatic design methods of the field
// combine (machine_text.h). The ring shows the state.
//
// All but standing still avoid obstacles: proximity pushes away with five times its weight. What the modules
// see is that of the field's reference models 1.1 and 1.2: proximity and light as one vector each, the floor
// as black, grey or white, neighbours by their number, ranges and bearings.

#include "linuxboard/control/behaviours/behaviour.h"
#include "linuxboard/control/behaviours/machine_text.h"
#include "linuxboard/control/behaviours/wander.h"

#include <cstdint>
#include <random>
#include <vector>

namespace puckloop::control {

class StateMachine : public Behaviour {
  public:
    /// Robots with the same seed draw the same.
    StateMachine(std::vector<MachineState> states, std::uint32_t seed);
    Actuators step(const Sensors& sensors, double t) override;
    int state() const { return state_; }

  private:
    struct Vector {
        double x = 0, y = 0;  ///< ahead, left
    };
    Vector obstacles(const Sensors& sensors);
    static Vector light(const Sensors& sensors);
    static Vector neighbours(const Sensors& sensors, double weight);
    Actuators walk(const Vector& obstacle, double longest);
    bool holds(const MachineCondition& condition, const Sensors& sensors);
    void leave(const Sensors& sensors);
    /// Even in 0..1, 1 left out.
    double draw();

    std::vector<MachineState> states_;
    std::mt19937 random_;
    ProximityBaseline baseline_;
    int state_ = 0;
    bool fresh_ = true;   ///< a state acts for one step before it is left
    int turn_steps_ = 0;  ///< of the walk's turn, left
    int turn_side_ = 1;   ///< 1: to the left
};

}  // namespace puckloop::control
