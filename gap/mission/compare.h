#pragma once
// Do simulated runs behave as measured ones, and which known change of the simulation brings them closer?
// Numbers only: what they mean is for the caller.
//
// 1. Same or not: the largest difference of means, over programs and statistics, in standard errors, against
//    2000 exchanges of runs between measured and simulated within each program (Westfall and Young, 1993).
// 2. An effect is a set of simulated runs with one thing changed. Its trace D is the difference of means that
//    the change makes. The measured difference d is set to a D, with the covariance of means pooled over all
//    groups of runs and shrunk by a fifth to its diagonal; a is fitted by weighted least squares.
// 3. What it gains is asked of programs that had no part in fitting a: the fall of the squared distance, in
//    nats. Its interval is from 400 bootstrap draws of the runs of every group. With one program the two
//    halves of its measured runs take these parts.
// 4. Effects are added one at a time, as long as the next gains for sure beside those before.

#include <Eigen/Dense>

#include <cstdint>
#include <string>
#include <vector>

namespace puckloop::gap::mission {

/// Runs by statistics.
using Group = Eigen::MatrixXd;

struct Groups {
    std::vector<Group> measured, simulated;   ///< by program; at least two runs each
    std::vector<std::vector<Group>> effects;  ///< by effect, by program
};

struct Difference {
    std::size_t program = 0, statistic = 0;
    double measured = 0.0, simulated = 0.0;  ///< means
    double errors = 0.0;                     ///< measured less simulated, in standard errors
    double p = 1.0;                          ///< corrected for all of them
};

struct Amount {
    std::size_t effect = 0;
    double share = 0.0, low = 0.0, high = 0.0;  ///< of the change, 90 %
    double gain = 0.0, gain_low = 0.0;          ///< nats on what had no part in it; 5 %
    double wins = 0.0;                          ///< share of draws in which it gains more than the next best
};

enum class Finding {
    Same,         ///< no difference is shown
    Named,        ///< one effect, or several together
    CannotTell,   ///< several do as well
    Unexplained,  ///< no effect accounts for half of what differs
};

struct Comparison {
    Finding finding = Finding::Same;
    double p = 1.0;                       ///< of the largest difference
    std::vector<Difference> differences;  ///< the clearest first
    std::vector<Amount> alone;            ///< every effect by itself, the best first
    std::vector<Amount> together;         ///< those that were taken, in their order, fitted together
    double left_p = 1.0;                  ///< of the largest difference that is left
    double explained = 0.0;               ///< share of the squared distance beyond chance, held out
    std::vector<std::size_t> as_good;     ///< with CannotTell: effects that do as well as the first
    /// Differences of means that 19 of 20 such comparisons would show, by statistic, in units of its standard
    /// deviation between runs.
    double visible = 0.0;
};

/// All matrices have the same columns, none constant over everything; `seed` decides the draws.
Comparison compare(const Groups& groups, std::uint64_t seed);

}  // namespace puckloop::gap::mission
