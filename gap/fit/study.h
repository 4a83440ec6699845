#pragma once
// One experiment under study: its model, which effects can be tried on it, and fits of sets of effects, whole
// and with parts held out.

#include "gap/effects/effect.h"
#include "gap/evidence/criterion.h"
#include "gap/fit/fit.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::gap {

/// An effect as it applies to this experiment.
struct Candidate {
    const Effect* effect = nullptr;
    std::vector<Freed> freed;
    std::vector<std::vector<double>> starts;  ///< values of `freed` to begin at; at least one
    std::string remark;                       ///< why it cannot be tried; empty: it can
};

/// A set of effects fitted to all rows.
struct Fit {
    std::vector<std::size_t> effects;  ///< indices of candidates, in order of choice
    Fitted fitted;
    std::vector<Freed> freed;
    double bic = 0.0;  ///< -2 log likelihood + parameters ln rows
};

/// Log scores of rows that the fit did not see, an observable each, and what was predicted for them.
struct HeldOut {
    std::vector<std::vector<double>> score, mean;
};

/// Rows that stand or fall together when gains are judged: a run, or a stretch of one where runs are few.
struct Blocks {
    std::vector<std::vector<std::uint32_t>> of;  ///< block of each row, an observable each
    std::size_t count = 0;
};

class Study {
  public:
    /// On `threads` threads; what comes out does not depend on how many.
    Study(const Experiment& experiment, std::uint64_t seed, unsigned threads = 1,
          MotionView view = MotionView::Robot);

    const Experiment& experiment() const { return experiment_; }
    const Model& model() const { return *model_; }
    MotionView view() const { return view_; }
    const std::vector<Candidate>& candidates() const { return candidates_; }
    /// The observables whose predictions change with a candidate's parameters, near neutral or where a fit
    /// begins.
    std::vector<std::size_t> moved_by(const Candidate& candidate) const;
    std::size_t rows() const;  ///< of all observables
    std::size_t folds() const { return folds_; }
    const Blocks& blocks() const { return blocks_; }
    unsigned threads() const { return threads_; }
    /// Which part a row is held out with: an observable each.
    const std::vector<std::vector<int>>& fold_of() const { return fold_; }

    /// The same study on few of the rows, where there are many; else nullptr. Candidates are counted alike.
    /// What it says of a set is a guess, which costs little.
    const Study* part() const { return part_.get(); }
    /// A state of this study, as the part has it.
    State in_part(const State& whole) const;
    /// The set of a fit to all rows, fitted to the part's.
    Fit on_part(const Fit& whole) const;
    /// From the part's fit of a set to one of all rows; the part leaves `from` what it does not know.
    Fit from_part(const Fit& guess, const State& from, const Effort& effort = kThorough) const;

    /// What these effects estimate.
    std::vector<Freed> freed_by(const std::vector<std::size_t>& effects) const;

    /// `state` with one effect's parameters back at neutral.
    State without(std::size_t effect, State state) const;
    /// Fits a set; begins at `from` and, for the last effect of the set, at each of its starts.
    Fit fit_set(const std::vector<std::size_t>& effects, const State& from,
                const Effort& effort = kThorough) const;
    /// A few steps from the last effect's first start only: does the set promise anything beyond `from`? Nats
    /// that it wins.
    double glance(const std::vector<std::size_t>& effects, const State& from) const;
    /// The same set again, from where `quick` ended.
    Fit refined(const Fit& quick) const;
    Fit fit_none() const;
    /// Cross-validation of a set that was fitted to all rows, each part fitted again with `effort` from
    /// there.
    HeldOut hold_out(const Fit& fit, const Effort& effort = kPart) const;
    /// A set fitted to the rows of all folds but one, from where the fit to all rows ended.
    Fitted without_fold(std::size_t fold, const Fit& fit, const Effort& effort = kPart) const;
    /// What `after` gains over `before` on rows that were not fitted, of all observables or of one.
    Gain gain(const HeldOut& before, const HeldOut& after, std::optional<std::size_t> observable = {}) const;

  private:
    /// The part of `whole`.
    Study(std::unique_ptr<Experiment> thin, const Study& whole);
    void make_part();
    void take_candidates(const Study& whole);
    void make_candidates();
    void make_folds(std::uint64_t seed);
    State begun(const Candidate& candidate, const std::vector<double>& start, const State& from) const;
    bool lighten_tails(State& state) const;
    double bic_of(const Fitted& fitted, std::size_t parameters) const;
    std::string missing_for(const Effect& effect) const;

    std::unique_ptr<Experiment> own_;  // of a part
    const Experiment& experiment_;
    MotionView view_;
    std::unique_ptr<Model> model_;
    std::unique_ptr<Study> part_;
    std::vector<std::optional<std::size_t>> place_in_part_;  // of each parameter, where the part has it
    std::vector<Candidate> candidates_;
    std::vector<std::vector<int>> fold_;  // of each row, an observable each
    Blocks blocks_;
    std::size_t folds_ = 0;
    unsigned threads_ = 1;
};

}  // namespace puckloop::gap
