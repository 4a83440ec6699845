#pragma once
// Which effects: forward selection by held-out score and BIC, then each choice against its rivals.

#include "gap/fit/study.h"

#include <functional>
#include <string>
#include <vector>

namespace puckloop::gap {

/// BIC by which a set must do better with an effect than without; set by judgement on a few runs without
/// effects (docs/gap.md).
inline constexpr double kEnoughBic = 8.0;

/// How an effect did at the step where it was looked at last.
struct Trial {
    std::size_t effect = 0;
    double delta_bic = 0.0;  ///< of the set without it over the set with it: > 0 speaks for it
    Gain held;               ///< of it; only where it was cross-validated
    bool validated = false;
    std::string remark;
};

/// Another effect in place of a chosen one that the data does not refuse.
struct Draw {
    std::size_t chosen = 0, rival = 0;  ///< candidates
    double delta_bic = 0.0;             ///< of the rival's set over the chosen one's
    Gain held;                          ///< of the chosen over the rival
    Fit fit;                            ///< with the rival
};

struct Selection {
    Fit none, chosen;
    HeldOut held_none, held_chosen;
    std::vector<Trial> trials;  ///< an effect each, the first step's figures for those never chosen
    std::vector<Trial> steps;   ///< the chosen ones, as they were chosen
    std::vector<Draw> draws;
};

Selection select(const Study& study, const std::function<void(const std::string&, double)>& progress);

}  // namespace puckloop::gap
