#pragma once
// The loop of a worker: locally it takes jobs from its standard input, in a job array from a file.

#include "base/json.h"

#include <filesystem>
#include <functional>

namespace puckloop::jobs {

struct WorkerTask {
    std::filesystem::path jobs;     ///< file of jobs, one per line; empty: standard input
    std::filesystem::path results;  ///< file to append to; empty: standard output
    int task = 0, tasks = 1;        ///< of the file's jobs, every `tasks`-th from `task` on
};

/// Returns when there are no more jobs. Each job in is one line of JSON, each result one line {"id",
/// "verdict"}, or {"id", "problem"} where `carry_out` threw std::runtime_error, with "killed" where that was
/// Killed (isolated.h). `id` is the job's.
void work(const WorkerTask& task, const std::function<nlohmann::json(const nlohmann::json& job)>& carry_out);

/// A worker's own folder below `parent`, unlike that of any other worker of any machine.
std::filesystem::path own_folder(const std::filesystem::path& parent);

}  // namespace puckloop::jobs
