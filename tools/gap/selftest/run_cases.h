#pragma once
// Makes cases, writes each to a folder of its own, has the tool read and judge it, and removes it.

#include "tools/gap/selftest/case_list.h"
#include "tools/gap/selftest/score.h"

#include <filesystem>
#include <functional>
#include <vector>

namespace puckloop::gap::selftest {

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
