#include "gap/reading/read_experiment.h"

#include "gap/data/problems.h"
#include "gap/sync/sync.h"
#include "gap/validate/checks.h"

namespace puckloop::gap {

Experiment read_experiment(const std::filesystem::path& folder) {
    Problems problems;
    Experiment experiment = survey_experiment(folder, problems);
    if (!problems.empty()) throw InputError(problems.first());
    align_times(experiment);
    find_pauses(experiment);
    return experiment;
}

Experiment survey_experiment(const std::filesystem::path& folder, Problems& problems) {
    Experiment experiment = read_folder(folder, problems);
    if (!experiment.runs.empty()) check(experiment, problems);
    return experiment;
}

}  // namespace puckloop::gap
