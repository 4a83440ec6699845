#pragma once
// Sums that drift: a random walk seen with carried-over errors, and the same where something may have pushed.
// Variances in units of the error's.

#include <cstddef>
#include <vector>

namespace puckloop::gap {

/// Random walk plus carried-over measurement error.
struct Walk {
    double level = 0.0, error = 0.0;
    double p00 = 1.0, p01 = -1.0, p11 = 1.0;

    /// The first row: level and error are known only together.
    void begin(double value) { *this = {value, 0.0, 1.0, -1.0, 1.0}; }

    /// Returns the innovation's variance. `tail`: degrees of freedom of the errors' Student t.
    double filter(double value, double drift, double memory, double tail, double& innovation);
};

/// What a sum may be: it goes on, or something pushed it by an unknown amount in one of the last rows. Each
/// history is a Walk with a weight; the likely ones are kept.
class PushedWalk {
  public:
    struct Row {
        double cost;        ///< minus ln density, without the density's constant
        double innovation;  ///< standardised, the mean over histories
    };

    void begin(double value);
    /// `chance` that the row was pushed, by an amount of variance `push`; the rest as Walk::filter.
    Row filter(double value, double drift, double memory, double tail, double chance, double push);

  private:
    struct History {
        Walk walk;
        double weight;
    };
    std::vector<History> kept_, next_;
};

}  // namespace puckloop::gap
