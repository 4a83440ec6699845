#include "tools/gap/selftest/run_cases.h"

#include "gap/fit/parallel.h"
#include "gap/pipeline/analyse.h"

#include <fmt/format.h>

#include <chrono>
#include <exception>
#include <mutex>

namespace puckloop::gap::selftest {

namespace {

/// The tool sees a folder with a name that says nothing.
Judged run_one(const CasePlan& plan, std::size_t index, const RunOptions& options) {
    const HiddenCase hidden = make_case(plan);
    const auto folder = options.scratch / fmt::format("case{:03}", index);
    write_folder(hidden.experiment, folder);
    Judged judged;
    try {
        Options analysis;
        analysis.seed = plan.seed;
        const auto begin = std::chrono::steady_clock::now();
        judged = judge(hidden, analyse(read_experiment(folder), analysis));
        judged.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    } catch (const std::exception& error) {
        judged = judge(hidden, Verdict{});
        judged.said = "error";
        judged.error = error.what();
    }
    if (!options.keep) std::filesystem::remove_all(folder);
    return judged;
}

}  // namespace

std::vector<Judged> run_cases(const std::vector<CasePlan>& plans, const RunOptions& options) {
    (void)benches();  // made once, before the workers
    std::vector<Judged> results(plans.size());
    std::size_t finished = 0;
    std::mutex telling;
    in_parallel(plans.size(), options.workers, [&](std::size_t k) {
        results[k] = run_one(plans[k], k, options);
        const std::lock_guard lock(telling);
        if (options.done) options.done(k, results[k], ++finished, plans.size());
    });
    return results;
}

}  // namespace puckloop::gap::selftest
