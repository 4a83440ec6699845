#pragma once
// Learns a term without a mechanism from errors: a sum of tables over what the world knows. Which tables, how
// smooth they are and how large, is decided by the evidence of the rows that are used, and by nothing else.
//
// Deviations: 1. of many rows stretches from all over are used. 2. A table joins by its own evidence beside
// those that are there; all values are then fitted together. 3. Rows weigh by Student's law at the fit
// before.

#include "gap/extension/learning_rows.h"
#include "gap/extension/table_basis.h"

#include <optional>
#include <vector>

namespace puckloop::gap {

/// One table with what it was found to hold.
struct LearntPart {
    TableBasis basis;
    Kernel kernel{};
    double size = 1.0;              ///< prior sd of a value over sd of the errors
    double spread = 0.0;            ///< prior sd of a value, quantity's unit
    Eigen::VectorXd value{}, sd{};  ///< one table after another
};

struct Learnt {
    std::vector<LearntPart> parts;
    ErrorsLaw law;          ///< of the errors beside the term
    ErrorsLaw law_without;  ///< without it
    double evidence = 0.0;  ///< nats by which the rows used are likelier with it, what it is allowed paid
    double freedom = 0.0;   ///< numbers that the rows decide, of all in the tables but those of runs
    /// How well all tables' values are known, one part after another, runs' left out.
    Eigen::MatrixXd covariance{};

    /// What the term adds to each row's prediction: of sums, all that rows since the chain's beginning
    /// gained. A run that was not used has no offset of its own.
    std::vector<double> in_rows(const Subject& subject) const;
};

/// Errors of these rows less what the parts make of them, each stretch from its own beginning. `runs_only`:
/// less what runs have for themselves.
std::vector<double> left_beside(const Subject& subject, const LearningRows& rows,
                                const std::vector<LearntPart>& parts, bool runs_only = false);

/// `used`: 1 for each row to learn from.
Learnt learnt_from(const Subject& subject, const std::vector<char>& used);

}  // namespace puckloop::gap
