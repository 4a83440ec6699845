#pragma once
// Makes cases, writes each to a folder of its own, has the tool read and judge it, and removes it.

#include "gap/fit/parallel.h"
#include "selftest/case_list.h"
#include "selftest/score.h"

#include <filesystem>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

namespace puckloop::gap::selftest {

/// What the tool said of an experiment in a folder of its own.
struct Analysed {
    Verdict verdict;
    std::string error;  ///< not empty: it failed
    double wall_s = 0.0;
};
/// `folder` is removed again unless it is to be kept. `ask_all`: as Options::ask_all.
Analysed analysed(const WrittenExperiment& experiment, const std::filesystem::path& folder,
                  std::uint64_t seed, bool keep, bool ask_all = false);

/// `one(k)` for each of `count` cases on a few threads, in their order; `done(k, result, cases done)` from
/// one thread at a time.
template <class One, class Done>
auto run_all(std::size_t count, unsigned workers, const One& one, const Done& done) {
    (void)benches();  // made once, before the workers
    std::vector<decltype(one(count))> results(count);
    std::size_t finished = 0;
    std::mutex telling;
    in_parallel(count, workers, [&](std::size_t k) {
        results[k] = one(k);
        const std::lock_guard lock(telling);
        done(k, results[k], ++finished);
    });
    return results;
}

struct RunOptions {
    std::filesystem::path scratch;
    unsigned workers = 2;
    bool keep = false;  ///< leave the folders
    /// A case is done: its plan's place, how it was judged, cases done, of all. From one thread at a time.
    std::function<void(std::size_t, const Judged&, std::size_t, std::size_t)> done;
};

/// In the order of `plans`. A case that the tool fails on is judged with its error.
std::vector<Judged> run_cases(const std::vector<CasePlan>& plans, const RunOptions& options);

}  // namespace puckloop::gap::selftest
