#pragma once
// Worker processes on this machine.

#include "campaigns/engine/case.h"

#include <filesystem>
#include <functional>
#include <vector>

namespace puckloop::faults {

struct PoolOptions {
    std::filesystem::path campaign, out;
    int jobs = 1;
    const volatile int* interrupted = nullptr;  ///< set to a signal's number when the user wants it to end
};

/// Runs the cases, in their order, on `jobs` processes and hands over each verdict when it comes. A worker
/// that dies is replaced and its case run again; a case that kills three has the verdict "puckloop failed".
/// RunError if a case could not be run, three times, or on a signal; the verdicts handed over before are
/// valid.
void run_local(const PoolOptions& options, const std::vector<Case>& cases,
               const std::function<void(int id, const nlohmann::json& verdict)>& take);

}  // namespace puckloop::faults
