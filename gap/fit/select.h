#pragma once
// Which effects: forward selection by held-out score and BIC, then each choice against its rivals.

#include "gap/fit/study.h"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace puckloop::gap {

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
    std::vector<Draw> draws;    ///< empty until Search::find_rivals
};

/// The search for the set of effects. Several searches on models of the same rows (frames of view) compete by
/// the log score of held-out rows.
class Search {
  public:
    using Progress = std::function<void(const std::string&, double)>;

    /// `study` and `progress` must outlive it.
    Search(const Study& study, const Progress& progress);
    ~Search();

    /// The first step: nothing, or the best effect (or pair). Returns the log score of all held-out rows.
    double first();
    /// All further steps; once.
    Selection rest();
    /// What the data does not refuse in the place of what was chosen; once, after rest().
    void find_rivals(Selection& selection);

  private:
    class Steps;
    std::unique_ptr<Steps> steps_;
};

}  // namespace puckloop::gap
