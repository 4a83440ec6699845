#include "gap/selftest/run_cases.h"

#include "gap/pipeline/analyse.h"

#include <fmt/format.h>

#include <atomic>
#include <chrono>
#include <exception>
#include <mutex>
#include <thread>

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
    std::atomic<std::size_t> next{0};
    std::size_t finished = 0;
    std::mutex telling;
    std::exception_ptr failure;
    const auto work = [&] {
        for (std::size_t k = next++; k < plans.size(); k = next++) {
            try {
                results[k] = run_one(plans[k], k, options);
            } catch (...) {
                const std::lock_guard lock(telling);
                failure = std::current_exception();
                next = plans.size();
                return;
            }
            const std::lock_guard lock(telling);
            if (options.done) options.done(k, results[k], ++finished, plans.size());
        }
    };
    std::vector<std::thread> threads;
    for (unsigned k = 1; k < options.workers; ++k)
        threads.emplace_back(work);
    work();
    for (std::thread& thread : threads)
        thread.join();
    if (failure) std::rethrow_exception(failure);
    return results;
}

}  // namespace puckloop::gap::selftest
