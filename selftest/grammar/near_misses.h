#pragma once
// Forms of the catalogue's effects with another exponent or another covariate.

#include "selftest/grammar/site.h"

#include <string>

namespace puckloop::gap::selftest::grammar {

struct NearMiss {
    Site site;
    Field field;
    std::string text;
    std::string family;  ///< of the catalogue's effect
};

/// Of an exact experiment: an effect of its kind, with an exponent that is not the catalogue's, or with
/// another covariate in the place of its own.
NearMiss drawn_near_miss(const WrittenExperiment& exact, RandomStream& random);

}  // namespace puckloop::gap::selftest::grammar
