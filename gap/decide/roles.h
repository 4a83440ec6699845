#pragma once
// Does each chosen effect do what it is said to do? One that moves means gains by the means that it moves;
// one that only scatters gains by what comes anew at each reading, not by a mean that the model lacks, which
// larger errors would cover as well.

#include "gap/findings/findings.h"
#include "gap/fit/study.h"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace puckloop::gap {

/// Effects of a fit that are out of their role, and why, in words that follow "but".
struct OutOfRole {
    std::vector<std::size_t> effects;
    std::string why;
    bool law_alone = false;  ///< all that was gained, a law of errors without a mechanism gains
};

/// Does an effect move means, or widen errors that lie within a step, by less than their rounding wherever it
/// acts? Which way ties go, or whether readings are rounded down, is not known.
bool within_rounding(const Study& study, const Fit& fit, std::size_t effect);

/// `held`: of the fit. `leftovers`: structures left by it. Empty when all keep to their roles.
OutOfRole out_of_role(const Study& study, const Fit& fit, const HeldOut& held,
                      const std::vector<Leftover>& leftovers, std::uint64_t seed);

/// Is a structure left for sure? A walk needs a smaller p value than others.
bool is_sure(const Leftover& left);

/// nats that corrections by functions of covariates gain, the clear ones.
double gained_by_shape(const std::vector<FreeForm>& forms);

/// nats that the surest of structures may stand for: of a p value at most -ln(-e p ln p) (Sellke, Bayarri and
/// Berger, Am. Stat. 55, 2001). 0: none is sure.
double most_by_structure(const std::vector<Leftover>& leftovers);

/// The larger of both, of what belongs to observables that `own` holds for.
double left_of(std::vector<FreeForm> forms, std::vector<Leftover> leftovers,
               const std::function<bool(const std::string&)>& own);

}  // namespace puckloop::gap
