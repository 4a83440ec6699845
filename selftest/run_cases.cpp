#include "selftest/run_cases.h"

#include "gap/pipeline/analyse.h"
#include "gap/reading/read_experiment.h"

#include <fmt/format.h>

#include <chrono>
#include <exception>

namespace puckloop::gap::selftest {

Analysed analysed(const WrittenExperiment& experiment, const std::filesystem::path& folder,
                  std::uint64_t seed, bool keep, bool ask_all) {
    Analysed result;
    write_folder(experiment, folder);
    try {
        Options options;
        options.seed = seed;
        options.ask_all = ask_all;
        const auto begin = std::chrono::steady_clock::now();
        result.verdict = analyse(read_experiment(folder), options);
        result.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    } catch (const std::exception& error) {
        result.error = error.what();
    }
    if (!keep) std::filesystem::remove_all(folder);
    return result;
}

std::vector<Judged> run_cases(const std::vector<CasePlan>& plans, const RunOptions& options) {
    const auto one = [&](std::size_t k) {
        const HiddenCase hidden = make_case(plans[k]);
        // The tool sees a folder with a name that says nothing.
        const auto said = analysed(hidden.experiment, options.scratch / fmt::format("case{:03}", k),
                                   plans[k].seed, options.keep);
        Judged judged = judge(hidden, said.verdict);
        judged.wall_s = said.wall_s;
        judged.error = said.error;
        if (!said.error.empty()) judged.said = "error";
        return judged;
    };
    return run_all(plans.size(), options.workers, one,
                   [&](std::size_t k, const Judged& judged, std::size_t done) {
                       if (options.done) options.done(k, judged, done, plans.size());
                   });
}

}  // namespace puckloop::gap::selftest
