#pragma once
// Who is interested in what a world step costs, part by part (`puckloop bench --case world`). The world
// itself never looks at a clock.

#include <array>
#include <cstdint>
#include <string_view>

namespace puckloop::physics {

/// The parts of a step, in the order in which they are done.
enum class StepPart : std::uint8_t {
    Inputs,    ///< messages from the boards, drives, motion of the floor
    Contacts,  ///< who touches what
    Solve,     ///< the dynamics library's step
    Poses,     ///< bodies read back; events
    Around,    ///< proximity sensors
    Light,     ///< ambient light
    Ground,    ///< grey under the robots
    Readings,  ///< noise, accelerometer, microphones, battery: what changes by itself
    Publish,   ///< values that changed become messages
    Record     ///< files and log
};
inline constexpr std::size_t kStepParts = 10;
inline constexpr std::array<std::string_view, kStepParts> kStepPartNames{
    "inputs", "contacts", "solve", "poses", "around", "light", "ground", "readings", "publish", "record"};

class StepObserver {
  public:
    virtual ~StepObserver() = default;
    /// The part has just been done; several times a step for some.
    virtual void done(StepPart part) = 0;
};

}  // namespace puckloop::physics
