#pragma once
// Robots with something wrong that is in no catalogue: a term drawn by seed acts in the emulated world
// (physics/description/extension.h) while the experiment is recorded, and the analysis sees the folder
// only. The question is whether what it learns without a name, given to the emulator as the overlay that it
// writes, brings the emulator's runs back to what the robot with the true term itself differs by. The term is
// a table of the same form as the overlay's, which favours the method.

#include "gap/verdict/verdict.h"
#include "physics/description/extension.h"
#include "selftest/emulate/record.h"

#include <cstdint>
#include <string>
#include <vector>

namespace puckloop::gap::emulate {

struct HiddenTerm {
    std::string kind;
    physics::ExtensionTerm term;
    std::string words;  ///< "proximity.reading: a bump over distance, 40 counts"
};

/// Kinds take turns; quantity, covariates, form and size are drawn. No form is a straight line or a product
/// of straight lines, which a gain, an offset or a slope would be.
HiddenTerm drawn_term(std::size_t number, std::uint64_t seed);

/// An overlay that holds the term alone.
std::string term_toml(const physics::ExtensionTerm& term);

struct TermResult {
    HiddenTerm hidden;
    std::string decision, error;
    std::vector<std::string> named;
    Rerun again;
};

/// Records, analyses and performs again case `number`.
TermResult try_term(std::size_t number, const RecordOptions& options);

std::string term_line(const TermResult& result);
/// Shares that are back, unexplained, given a name, failed, each with its 95 % limits.
std::string terms_text(const std::vector<TermResult>& results);

}  // namespace puckloop::gap::emulate
