#pragma once
// Rates of verdicts over drawn cases with exact binomial intervals, calibration of intervals.

#include "selftest/grammar/outcome.h"

#include <array>
#include <string>
#include <vector>

namespace puckloop::gap::selftest::grammar {

/// Clopper and Pearson, 95 %, two-sided.
struct Rate {
    int hits = 0, of = 0;
    double low = 0.0, high = 1.0;
    double share() const { return of == 0 ? 0.0 : static_cast<double>(hits) / of; }
};
Rate rate_of(int hits, int of);
/// "88 % (73 to 96; 35 of 40)": share, limits, counts.
std::string share_text(const Rate& rate);

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
