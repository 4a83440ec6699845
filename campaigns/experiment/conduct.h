#pragma once
// `puckloop experiment`: runs what is left of an experiment and reports it.

#include "campaigns/experiment/experiment_file.h"
#include "campaigns/jobs/job_worker.h"

#include <filesystem>

namespace puckloop::swarm {

struct ExperimentOptions {
    std::filesystem::path file;
    std::filesystem::path out;      ///< empty: out/<name of the file>
    std::filesystem::path against;  ///< scores from elsewhere; empty: none
    Changes changes{};
    int jobs = 0;  ///< 0: as many as there are cores
    bool slurm = false;
    int tasks = 8;       ///< of the job array
    bool fresh = false;  ///< what is in the folder is dropped
};

/// Writes experiment.db, results.csv and report.html and prints a summary. InputError for what the user gave,
/// RunError where it could not be finished. Returns whether every run succeeded.
bool run_experiment(const ExperimentOptions& options);

/// A worker of run_experiment: returns when there are no more runs.
void work(const ExperimentOptions& options, const jobs::WorkerTask& share);

}  // namespace puckloop::swarm
