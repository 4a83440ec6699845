#pragma once
// Worker processes on this machine.

#include "campaigns/jobs/job.h"

#include <functional>
#include <string>
#include <vector>

namespace puckloop::jobs {

struct PoolOptions {
    Crew crew;
    int jobs = 1;
    DeadlyResult deadly{};  ///< without it a job whose process died each time ends the work
    const volatile int* interrupted = nullptr;  ///< set to a signal's number when the user wants it to end
};

/// Carries out the jobs, in their order, on `jobs` processes and hands over each result when it comes. A
/// worker that dies is replaced and its job carried out again. RunError if a job's process died (see
/// `deadly`) or it could not be carried out, three times, or on a signal; the results handed over before are
/// valid.
void run_local(const PoolOptions& options, const std::vector<Job>& jobs, const TakeResult& take);

}  // namespace puckloop::jobs
