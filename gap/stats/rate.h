#pragma once
// A share of cases with its exact binomial interval.

#include <string>

namespace puckloop::gap {

/// Clopper and Pearson, 95 %, two-sided.
struct Rate {
    int hits = 0, of = 0;
    double low = 0.0, high = 1.0;
    double share() const { return of == 0 ? 0.0 : static_cast<double>(hits) / of; }
};
Rate rate_of(int hits, int of);
/// "88 % (73 to 96; 35 of 40)": share, limits, counts.
std::string share_text(const Rate& rate);

}  // namespace puckloop::gap
