#pragma once
// What becomes of one burst of light between two range-and-bearing boards, beside what distance, bodies and
// walls make of it: lost by chance (ir.loss), lost in a spell (ir.spell, ir.spell_time), or come by a
// reflection that the world does not show (ir.stray, ir.stray_loss). All zero: nothing is drawn.
// Source: sheet of effects 51, 53, 55.
//
// Deviation: a reflection turns the light by whole receivers, 30 degrees each on average.

#include "base/random.h"
#include "physics/description/parameters.h"

#include <cstdint>
#include <string_view>

namespace puckloop::physics {

struct BurstOutcome {
    bool lost = false;
    std::size_t turn = 0;  ///< receivers by which the light is turned, 0..11
    float strength = 1.0F;
};

/// Of the bursts from one board to another.
class BurstOutcomes {
  public:
    /// `pair` names the random stream: "a>b".
    BurstOutcomes(const IrParameters& receiver, std::uint64_t seed, std::string_view pair);

    BurstOutcome next();

  private:
    double loss_, stray_, stray_strength_;
    RandomStream random_;
};

/// Spells in which two boards do not hear each other, both ways: the share ir.spell of all time, remembered
/// for ir.spell_time, as two crystals' beat makes them.
class IrSpell {
  public:
    /// By the values of the pair's first board; `pair` names the random stream: "a,b".
    IrSpell(const IrParameters& first, std::uint64_t seed, std::string_view pair);

    /// Is the pair in one at `seconds`? Times must not decrease.
    bool at(double seconds);

  private:
    double share_, time_;
    RandomStream random_;
    double last_ = -1e9;  // s, when asked last
    bool now_ = false;
};

}  // namespace puckloop::physics
