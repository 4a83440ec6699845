#pragma once
// What came of a run's faults.

#include "cosim/conductor.h"
#include "run/description/run_setup.h"

#include <nlohmann/json_fwd.hpp>

#include <filesystem>
#include <string>

namespace puckloop::tools {

/// Takes what nodes say of their faults into the outcome's reports. A run in which a fault never fired that
/// had to is no success.
void take_fault_results(const RunSetup& setup, cosim::Outcome& outcome);

/// A line for each of the first faults that fired: how often, and when first; each begins with a line end.
std::string faults_summary(const cosim::Outcome& outcome);
/// For report.json: one object a fault, with its first firings.
nlohmann::ordered_json faults_json(const cosim::Outcome& outcome);
/// All firings that are known in detail, one a line. Throws RunError.
void write_faults_csv(const cosim::Outcome& outcome, const std::filesystem::path& file);

}  // namespace puckloop::tools
