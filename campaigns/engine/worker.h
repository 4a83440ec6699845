#pragma once
// A process that runs cases: locally it takes them from its standard input, in a job array from a file.

#include "campaigns/jobs/job_worker.h"

#include <cstdint>
#include <filesystem>
#include <string>

namespace puckloop::faults {

struct WorkerTask {
    std::filesystem::path campaign;
    std::filesystem::path out;  ///< the campaign's results folder
    jobs::WorkerTask share;
};

/// Returns when there are no more cases (campaigns/jobs/job_worker.h).
void work(const WorkerTask& task);

/// Folders of a campaign.
std::filesystem::path nominal_folder(const std::filesystem::path& out, std::uint64_t seed);
std::filesystem::path boots_folder(const std::filesystem::path& out);
std::filesystem::path work_folder(const std::filesystem::path& out);

}  // namespace puckloop::faults
