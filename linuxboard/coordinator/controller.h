#pragma once
// What an experiment consists of: one Controller for each TAM, and the Experiment that ties them together.
// How to write one: docs/coordinator.md.

#include "linuxboard/coordinator/tam.h"

#include <memory>
#include <string>

namespace puckloop::coordinator {

/// What a TAM is to a robot just now: the colour of its bar in the picture.
enum class Activity : std::uint8_t {
    Closed,   ///< no task here
    Free,     ///< a task is offered
    Working,  ///< a robot works
    Done,     ///< the task is over, the robot has not left yet
    Pause     ///< nothing is offered for a time
};

/// "closed", "free", "working", "done", "pause".
std::string_view name_of(Activity activity);

struct State {
    std::string name;  ///< the controller's own word, such as "offer green"
    Activity activity = Activity::Closed;
    bool operator==(const State&) const = default;
};

class Controller {
  public:
    virtual ~Controller() = default;
    /// Called every 10 ms, from the TAM's first report on. `now` is s since the program began. It returns at
    /// once; what lasts is a state.
    virtual void step(double now) = 0;
    virtual State state() const = 0;
};

class Experiment {
  public:
    virtual ~Experiment() = default;
    /// The controller of a TAM that was found; null leaves it alone, dark. The TAM outlives the controller.
    virtual std::unique_ptr<Controller> attach(Tam& tam) = 0;
    /// Called every 10 ms, before the controllers.
    virtual void step(double /*now*/) {}
    /// The experiment is over.
    virtual bool finished() const { return false; }
};

}  // namespace puckloop::coordinator
