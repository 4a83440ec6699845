#pragma once
// Jobs as a job array of a Slurm cluster.

#include "campaigns/jobs/job.h"

#include <filesystem>
#include <vector>

namespace puckloop::jobs {

struct SlurmOptions {
    Crew crew;
    std::filesystem::path out;  ///< the results folder, the same on all machines
    int tasks = 8;
    const volatile int* interrupted = nullptr;
    DeadlyResult deadly{};  ///< of a job whose process died, as the last that its tasks say of it
};

/// Throws InputError if sbatch, squeue or scancel is missing.
void check_slurm();

/// After a kill: ends tasks of this folder that still run. Until then they write below its folder.
void end_tasks(const SlurmOptions& options);
/// The same, and hands over what tasks have left.
void resume_slurm(const SlurmOptions& options, const TakeResult& take);

/// Carries out the jobs; what no task brought is submitted again, three times in all. RunError if any but
/// those of `deadly` is still missing then, if the cluster holds the tasks back for good, or on a signal; the
/// tasks are ended then.
void run_slurm(const SlurmOptions& options, const std::vector<Job>& jobs, const TakeResult& take);

}  // namespace puckloop::jobs
