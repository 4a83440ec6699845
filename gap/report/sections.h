#pragma once
// The report's parts as HTML, each empty where it has nothing to say.

#include "gap/data/experiment.h"
#include "gap/verdict/verdict.h"

#include <string>

namespace puckloop::gap::report {

std::string header_section(const Experiment& experiment, const Verdict& verdict);
/// What to do next, in order: the first thing a reader needs.
std::string next_section(const Verdict& verdict);
std::string verdict_section(const Verdict& verdict);
std::string cautions_section(const Verdict& verdict);
std::string gain_section(const Verdict& verdict);
/// The experiment performed again on the emulator; empty when it was not asked for.
std::string rerun_section(const Verdict& verdict);
std::string parameters_section(const Verdict& verdict);
std::string rivals_section(const Verdict& verdict);
/// Noise floor and structure tests, before and after.
std::string structure_section(const Experiment& experiment, const Verdict& verdict);
/// Data replicated from the fitted model against what was measured: p values and pictures.
std::string predictive_section(const Verdict& verdict);
/// What came nearest where nothing is named, and the free-form correction of what is left.
std::string free_form_section(const Verdict& verdict);
/// Errors as it is, with the named causes, with a term without a mechanism; the term in pictures.
std::string extension_section(const Verdict& verdict);
std::string evidence_section(const Verdict& verdict);
std::string reading_section();

}  // namespace puckloop::gap::report
