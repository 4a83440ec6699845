#include "campaigns/experiment/again.h"

#include "base/error.h"
#include "base/files/claimed_folder.h"
#include "campaigns/experiment/experiment_store.h"
#include "run/report/results_folder.h"

#include <fmt/format.h>

#include <algorithm>

namespace puckloop::swarm {

namespace fs = std::filesystem;

Findings read_findings(const fs::path& out) {
    const ExperimentStore store(out / "experiment.db", ExperimentStore::Access::Read);
    const auto file = store.note("file");
    if (!file)
        throw InputError(out.string(), "",
                         "the experiment was ended before it began, or is of an older version",
                         "start it again");
    const auto changes = store.note("changes");
    return {read_experiment(*file, changes ? changes_from_json(nlohmann::json::parse(*changes)) : Changes{}),
            fs::absolute(out).lexically_normal(), store.results()};
}

std::string served_report(const Findings& findings, const PageOfRun& page) {
    const std::vector<Cell> cells = cells_of(findings);
    return report_html(findings, cells, comparisons_of(findings, cells), std::nullopt, {}, page);
}

RunResult run_again(const Findings& findings, int id, const fs::path& folder) {
    const std::vector<Run> runs = runs_of(findings.experiment);
    const auto run = std::find_if(runs.begin(), runs.end(), [id](const Run& one) { return one.id == id; });
    if (run == runs.end() || !findings.results.contains(id))
        throw InputError(findings.out.string(), fmt::format("run {}", id), "there is no result of it",
                         "a run of results.csv");
    refuse_to_empty(folder, tools::kRunMark, "--out with a folder of its own");
    return execute(findings.experiment, *run, folder, findings.out / "boots");
}

}  // namespace puckloop::swarm
