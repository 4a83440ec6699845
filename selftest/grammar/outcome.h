#pragma once
// What the analysis said of a drawn case, and how it is counted.

#include "gap/verdict/verdict.h"
#include "selftest/grammar/drawn_case.h"
#include "selftest/score.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::gap::selftest::grammar {

struct Outcome {
    std::size_t number = 0;
    Class of = Class::Null;
    std::string kind, text, family;
    std::string effect;  ///< of a known one
    double asked = 0.0, ratio = 0.0, likeness = 0.0;
    std::size_t runs = 0;
    int redrawn = 0;
    std::string said;  ///< decision, or "error"
    std::string error;
    std::vector<std::string> names;  ///< of the causes, first one first
    bool right = false;              ///< a known effect named first
    bool other_family = false;       ///< "named", and the first cause is of another family than the near miss
    bool wrong_family = false;       ///< and no effect of that family could do more than half of it
    std::vector<double> ranks;       ///< of true parameters in what is said of them: 0..1, uniform if honest
    int covered = 0;                 ///< of them within the 90 % interval
    std::vector<Estimate> estimates;          ///< what these rest on
    std::vector<std::string> alone_against;   ///< rules without each of which the causes would be named
    std::vector<std::string> enough_against;  ///< rules each of which would refuse them by itself
    double wall_s = 0.0;
};

Outcome outcome_of(const DrawnCase& drawn, const Verdict& verdict);

/// Place of the truth in an estimate with a 90 % interval, each side taken as half of a normal distribution.
double rank_in(double truth, double value, double low, double high);

struct Drawing {
    std::size_t cases = 0;
    std::uint64_t seed = 0;
    std::string kind;               ///< only this; "": all
    std::optional<Class> of;        ///< only this
    bool draw_runs = false;         ///< how many runs a case has is drawn, too
    bool ask_all = false;           ///< what each rule of the decision is worth
    std::vector<std::size_t> only;  ///< numbers; empty: all
    std::filesystem::path scratch;
    unsigned workers = 1;
    bool keep = false;
    std::function<void(const Outcome&, std::size_t done, std::size_t all)>
        done;  ///< from one thread at a time
};

/// Numbers of runs for the power against them.
inline constexpr std::array<std::size_t, 6> kPowerRuns{4, 6, 8, 12, 16, 24};
/// Each case drawn with as many runs as the last of these, then analysed with so many of them: an outcome
/// each, in order of the cases' numbers, then of the runs.
std::vector<Outcome> run_power(const Drawing& drawing);

/// Draws, has analysed and judges; in order of their numbers.
std::vector<Outcome> run_drawn(const Drawing& drawing);

}  // namespace puckloop::gap::selftest::grammar
