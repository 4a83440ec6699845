#pragma once
// A named effect: a mechanism that makes a simulation wrong, as data. It frees parameters of the forward
// models; the maths of how a parameter acts stands in gap/models and, where the simulator has it, in
// physics/.

#include "gap/kinds/kind.h"

#include <vector>

namespace puckloop::gap {

/// A parameter that an effect estimates. "name*" = one for each sensor, object, ... in the data; "a*|b": b
/// where the model has no a.
struct EffectParameter {
    const char* name;
    double low, high;              ///< beyond the simulator's neutral value these are not believed
    double prior_sd;               ///< width of the weak prior about neutral
    const char* source;            ///< of the range
    std::vector<double> starts{};  ///< where a fit begins, in the parameter's unit; several: tried one by one
    const char* unless = nullptr;  ///< not freed where the model has this parameter, which does the same
    double resolution = 0.0;       ///< the model says no finer what it is, parameter's unit
    bool threshold = false;        ///< acts only where something tried meets it: no row moves between
    double possible = 0.0;         ///< within this factor of what the experiment states; 0: anything
};

/// What an effect is said to do to the measurements.
enum class EffectRole {
    Mean,     ///< moves means; scatter may go with them
    Scatter,  ///< makes errors larger, or other, and may move means besides
    Outlier,  ///< makes single errors large, at moments of their own
};

struct Effect {
    const char* name;   ///< "wheel_scale"
    int number;         ///< in the sheet of effects this catalogue follows
    const char* title;  ///< plain words, as a sentence would name it
    std::vector<EffectParameter> parameters;
    const char* enters;        ///< where it enters the simulator
    const char* separated_by;  ///< the experiment that tells it from those that can look the same
    /// Columns that must be there and vary; "a|b": one of them; "+a": it must be there, varying or not.
    std::vector<const char*> needs{};
    EffectRole role = EffectRole::Mean;
    bool fitted_along = false;  ///< beside every cause where the data can part them (the measuring chain's)
    std::vector<Kind::Builtin> kinds{};  ///< that of its table first; a table names only the others
    /// What the catalogue does not have and is taken for it, and what separates the two: a caution of any
    /// verdict that names it. nullptr: nothing is known.
    const char* mistaken = nullptr;
    /// Multiplies what the wheels are said to have gone, so that errors of the counters draw its numbers to
    /// nothing (gap/identify).
    bool through_counts = false;
    /// Rests on when single frames were made, by the robot's clock (gap/identify/robot_clock.h).
    bool rests_on_clock = false;
};

}  // namespace puckloop::gap
