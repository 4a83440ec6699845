#pragma once
// A phase of a campaign as a job array of a Slurm cluster.

#include "campaigns/engine/case.h"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace puckloop::faults {

struct SlurmOptions {
    std::filesystem::path campaign, out;
    int tasks = 8;
    const volatile int* interrupted = nullptr;
};

using TakeVerdict = std::function<void(int id, const nlohmann::json& verdict)>;

/// Throws InputError if sbatch, squeue or scancel is missing.
void check_slurm();

/// After a kill: ends tasks of this campaign that still run. Until then they write below its folder.
void end_tasks(const SlurmOptions& options);
/// The same, and hands over what tasks have left.
void resume_slurm(const SlurmOptions& options, const TakeVerdict& take);

/// Runs the cases; what no task brought is submitted again, three times in all. RunError if cases are still
/// missing then, if the cluster holds the tasks back for good, or on a signal; the tasks are ended then.
void run_slurm(const SlurmOptions& options, const std::vector<Case>& cases, const TakeVerdict& take);

}  // namespace puckloop::faults
