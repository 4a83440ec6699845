#pragma once
// Effects that change no mean: they only make errors larger, rarer or more regular. A mean that the model
// lacks looks like them, for larger errors are all that a fit can make of it.

#include "gap/fit/study.h"

#include <span>
#include <string>
#include <vector>

namespace puckloop::gap {

/// What a fit predicts with some of its effects and without them.
struct Contrast {
    Prediction with, without;

    /// Does the mean of observable `o` differ in any row?
    bool moves_mean(std::size_t o) const;
    /// Does anything else of it: its noise, its chances?
    bool moves_rest(std::size_t o) const;
    /// The same of any observable.
    bool moves_means() const;
    bool moves_more_than_means() const;
};

/// `effects`: of the fit; their parameters go back to neutral.
Contrast contrast(const Study& study, const Fit& fit, std::span<const std::size_t> effects);
inline Contrast contrast(const Study& study, const Fit& fit, std::size_t effect) {
    return contrast(study, fit, {&effect, 1});
}

/// Makes single errors large at moments of their own. A mean may follow, where a sum goes on from there.
bool is_outlier(const Study& study, std::size_t effect);

/// The effects of a fit that move no prediction's mean by themselves.
std::vector<std::size_t> scatter_effects(const Study& study, const Fit& fit);

/// Names of the observables whose noise or chances differ by these effects of a fit.
std::vector<std::string> scattered_by(const Study& study, const Fit& fit,
                                      const std::vector<std::size_t>& effects);

/// Does the fit take single rows for lapses, each by a chance of its own, that none were without it?
bool lapses(const Study& study, const Fit& fit);

/// The fit's other effects, fitted again without them.
Fit without_effects(const Study& study, const Fit& fit, const std::vector<std::size_t>& dropped);

/// Does what passes for scatter repeat at once? Noise that grows with a reading errs anew each time; a mean
/// that the model lacks is there again when the same is read again.
///
/// How many standard deviations of chance the errors of rows agree better with those of the rows just before,
/// both of one stimulus and truth, where the effects `scatter` make most of their noise than where they make
/// little of it. (The same everywhere is noise that carries over.)
double repeats_at_once(const Study& study, const Fit& fit, const std::vector<std::size_t>& scatter);

}  // namespace puckloop::gap
