#pragma once
// Is a folder ready for an analysis? What is wrong with it, what can be used with care, and what can be
// learnt from it, without fitting anything.

#include "gap/begin/expected_time.h"
#include "gap/data/experiment.h"

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::gap {

struct Readiness {
    /// One line each, with file, row, column and remedy; empty: it can be used.
    std::vector<std::string> problems;
    std::optional<Experiment> experiment;  ///< as far as it could be read
    std::vector<std::string> looked_for;   ///< names of the catalogue's causes that can be tried
    std::map<std::string, std::vector<std::string>> blind;   ///< of the others, by why they cannot be found
    std::map<std::string, std::vector<std::string>> absent;  ///< that did not happen, by what shows it
    ExpectedTime seconds;                                    ///< for the verdict; 0 where it cannot be used
};

Readiness readiness_of(const std::filesystem::path& folder, unsigned threads);

/// As lines for a person.
std::string readiness_text(const Readiness& readiness);

}  // namespace puckloop::gap
