#pragma once
// Rows to learn from: of many, stretches from all over.

#include "gap/extension/errors_law.h"
#include "gap/extension/subjects.h"

#include <cstddef>
#include <vector>

namespace puckloop::gap {

struct LearningRows {
    std::vector<std::size_t> row;  ///< of the subject
    std::vector<double> error;     ///< 0 where it is not known
    std::vector<char> starts, known;

    /// Row `i` of the subject; `follows`: it comes after the last one.
    void add(const Subject& subject, std::size_t i, bool follows);
};

inline constexpr std::size_t kRowsToFit = 6000;  ///< that values are fitted to: some are thinned beyond

/// Of the rows that are `used` (1) about so many, in stretches that are chains of their own.
LearningRows learning_rows(const Subject& subject, const std::vector<char>& used, std::size_t most);

}  // namespace puckloop::gap
