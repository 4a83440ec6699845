#pragma once
// What a wheel's motor did over a run: cumulative steps as a curve over time, from the counter or from
// commands.

#include "gap/data/experiment.h"

#include <cstddef>
#include <string_view>
#include <vector>

namespace puckloop::gap {

/// Speed (steps/s) that the original firmware's 0.1 ms agenda makes of a command: the emulated firmware gives
/// exactly this, it is never fitted.
double agenda_speed(double command);
/// What drives the motors; Timer: the project's own firmware, whole counts of a 230.4 kHz timer a step;
/// Exact: a robot, or a script's, that makes of a command just this speed.
enum class MotorDriver { Agenda, Timer, Exact };

struct Motor {
    MotorDriver driver = MotorDriver::Agenda;
    /// Steps that each start, from standing or the other way round, makes too few at its beginning: the first
    /// comes late, and the rotor runs a step behind its coils.
    double start_loss = 0.0;
};

/// A change of speed, steps/s.
struct SpeedJump {
    double time, change;
    double before = 0.0;
};

struct WheelCurve {
    std::vector<double> time, steps;
    std::vector<SpeedJump> jumps;

    /// From the counter; from commands if there is none.
    static WheelCurve counted(const Run& run, std::string_view counter, std::string_view command,
                              const Motor& motor);
    static WheelCurve commanded(const Run& run, std::string_view command, const Motor& motor);
    /// Puts the fractions of a step back that a counter rounds off: as `asked` has them, wherever counter and
    /// command agree.
    void unround(const WheelCurve& asked);
    /// By how many steps a counter and `asked` part, summed over the rows.
    double strays_from(const WheelCurve& asked) const;
    bool empty() const { return time.empty(); }
};

/// Reads a curve at rising times; before the first and after the last point it goes on at the speed there.
class CurveReader {
  public:
    explicit CurveReader(const WheelCurve& curve) : curve_(curve) {}
    double at(double time);

  private:
    const WheelCurve& curve_;
    std::size_t place_ = 1;
};

}  // namespace puckloop::gap
