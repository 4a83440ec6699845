#pragma once
// A process that runs cases: locally it takes them from its standard input, in a job array from a file.

#include <filesystem>
#include <string>

namespace puckloop::faults {

struct WorkerTask {
    std::filesystem::path campaign;
    std::filesystem::path out;      ///< the campaign's results folder
    std::filesystem::path cases;    ///< file of cases, one a line; empty: standard input
    std::filesystem::path results;  ///< file to append to; empty: standard output
    int task = 0, tasks = 1;        ///< of the file's cases, every `tasks`-th from `task` on
};

/// Returns when there are no more cases. Each case in is a line of JSON (Case), each result a line {"id",
/// "verdict"}, or {"id", "problem"} where the run could not be made.
void work(const WorkerTask& task);

/// Folders of a campaign.
std::filesystem::path nominal_folder(const std::filesystem::path& out, std::uint64_t seed);
std::filesystem::path boots_folder(const std::filesystem::path& out);
std::filesystem::path work_folder(const std::filesystem::path& out);

}  // namespace puckloop::faults
