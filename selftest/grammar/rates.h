#pragma once
// Rates of verdicts over drawn cases with exact binomial intervals, calibration of intervals.

#include "gap/stats/rate.h"
#include "selftest/grammar/outcome.h"

#include <array>
#include <string>
#include <vector>

namespace puckloop::gap::selftest::grammar {

struct Target {
    std::string what;
    Rate rate;
    double least, most;    ///< of the share
    double highest = 1.0;  ///< of the interval's upper end
    bool met() const;      ///< true where there are no cases
};
std::vector<Target> targets(const std::vector<Outcome>& cases);

/// Ranks of true parameters, ten bins.
std::array<int, 10> rank_histogram(const std::vector<Outcome>& cases);
/// p value of a uniform histogram (chi squared).
double uniformity(const std::array<int, 10>& histogram);

/// One case in one line.
std::string outcome_line(const Outcome& outcome);
std::string rates_text(const std::vector<Outcome>& cases, const std::string& seeds);
std::string rates_json(const std::vector<Outcome>& cases, std::uint64_t seed);
/// The cases of such a text, to be counted together with others. Throws InputError, which names `file`.
std::vector<Outcome> outcomes_from_json(const std::string& text, const std::string& file);

}  // namespace puckloop::gap::selftest::grammar
