#pragma once
// `puckloop faults campaign`: nominal run, single faults, smaller ones, pairs.

#include "campaigns/engine/store.h"

#include <filesystem>
#include <vector>

namespace puckloop::faults {

struct CampaignOptions {
    std::filesystem::path file;
    std::filesystem::path out;  ///< empty: out/<name of the file>
    int jobs = 0;               ///< 0: as many as there are cores
    bool slurm = false;
    int tasks = 8;          ///< of the job array
    bool snapshots = true;  ///< cases go on from snapshots of what they share
    bool fresh = false;     ///< what is in the folder is dropped
};

/// Runs what is left of it, writes results.csv and report.html, prints a summary. InputError for what the
/// user gave, RunError where it could not be finished.
void run_campaign(const CampaignOptions& options);

/// What an existing results folder holds.
struct Results {
    Campaign campaign;
    std::filesystem::path out;
    std::vector<CaseResult> results;
    std::vector<Case> pruned;
};
Results read_results(const std::filesystem::path& out);

/// Runs a case again, with all files of a run in `folder`, and returns its verdict.
Verdict replay(const Results& results, int id, const std::filesystem::path& folder);

}  // namespace puckloop::faults
