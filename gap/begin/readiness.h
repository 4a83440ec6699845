#pragma once
// Is a folder ready for an analysis? What is wrong with it, what can be used with care, and what can be
// learnt from it, without fitting anything.

#include "gap/data/experiment.h"

#include <cstddef>
#include <string>
#include <vector>

namespace puckloop::gap {

struct Readiness {
    std::vector<std::string>
        problems;  ///< one line each, with file, row, column and remedy; empty: it can be used
    std::vector<std::string> cautions;

    /// A cause of the catalogue, and why it cannot be found in this data.
    struct Blind {
        std::string name, title, why;
    };
    std::vector<std::string> looked_for;  ///< names of causes that can be tried
    std::vector<Blind> blind;

    std::string title, kind;
    std::size_t runs = 0, rows = 0;
    double seconds = 0.0;  ///< expected for the verdict; 0 where it cannot be used
};

Readiness readiness_of(const std::filesystem::path& folder, unsigned threads);

/// As lines for a person.
std::string readiness_text(const Readiness& readiness);

}  // namespace puckloop::gap
