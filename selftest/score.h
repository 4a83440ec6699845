#pragma once
// From verdicts to rates: what the tool said against what was hidden.

#include "gap/verdict/verdict.h"
#include "selftest/benches/hidden_case.h"

#include <string>
#include <vector>

namespace puckloop::gap::selftest {

/// What was said of a parameter whose true value is known.
struct Estimate {
    std::string parameter;
    double truth, value, low, high;
    bool covered() const { return low <= truth && truth <= high; }
};

/// One case judged. The experiment itself is gone by then.
struct Judged {
    std::string kind;
    Expect expect;
    Strength strength;
    double ratio;
    std::vector<int> numbers;
    std::vector<std::string> labels;
    std::string error;                ///< not empty: the analysis failed
    std::string said;                 ///< decision
    std::vector<int> named;           ///< effects named as causes, the first one first
    std::vector<int> listed;          ///< the first cause and its best rival
    std::vector<std::string> names;   ///< of the causes
    bool first_right = false;         ///< decision "named", the first cause is (one of) the hidden
    bool ranked_right = false;        ///< the first in the list is, whatever the decision
    bool listed_right = false;        ///< it is among the two listed
    bool both_named = false;          ///< of a pair
    std::vector<Estimate> estimates;  ///< of the true parameters, when named first
    double wall_s = 0.0;
};

Judged judge(const HiddenCase& hidden, const Verdict& verdict);

/// A requirement with what was reached.
struct Requirement {
    std::string what;
    double reached, low, high;  ///< shares; met when low <= reached <= high
    int of;                     ///< cases it was taken over
    bool met() const { return of == 0 || (reached >= low && reached <= high); }
};

std::vector<Requirement> requirements(const std::vector<Judged>& cases);

/// One case in one line, for progress.
std::string case_line(const Judged& judged);

/// The whole result as text: requirements, rates by strength and kind, confusion matrix, misses.
std::string report_text(const std::vector<Judged>& cases, std::uint64_t seed);
/// The same for programs.
std::string report_json(const std::vector<Judged>& cases, std::uint64_t seed);

}  // namespace puckloop::gap::selftest
