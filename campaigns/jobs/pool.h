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
    /// The result of a job that three workers died of; without it such a job ends the work.
    std::function<nlohmann::json(const Job& job, const std::string& why)> deadly{};
    const volatile int* interrupted = nullptr;  ///< set to a signal's number when the user wants it to end
};

/// Carries out the jobs, in their order, on `jobs` processes and hands over each result when it comes. A
/// worker that dies is replaced and its job carried out again. RunError if a job killed three workers (see
/// `deadly`) or could not be carried out, three times, or on a signal; the results handed over before are
/// valid.
void run_local(const PoolOptions& options, const std::vector<Job>& jobs, const TakeResult& take);

}  // namespace puckloop::jobs
