#pragma once
// A build of puckloop run as a program of its own, timed from outside and by its report. What a run costs
// does not depend on what the measuring process did before, and another build can be measured the same way.

#include "cosim/core/time.h"

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <sys/types.h>

namespace puckloop::tools {

struct ProgramTiming {
    double wall_s = 0;   ///< from its start to its end
    double cpu_s = 0;    ///< user and system, with the processes that it waited for
    std::string output;  ///< what it wrote to standard output
};

/// Runs `words` and waits; while it does, calls `watch` (may be null) with the process's number at most every
/// `period_ms`. Throws RunError with the last line of its standard error unless it ended with status 0, and
/// when a signal asked this process to end.
ProgramTiming time_program(const std::vector<std::string>& words,
                           const std::function<void(pid_t)>& watch = {}, int period_ms = 20);

struct RunSpec {
    std::filesystem::path scenario;
    double simulated_s = 1;
    bool in_process = true;
    unsigned threads = 0;                ///< 0: as many as the build chooses
    std::vector<std::string> options{};  ///< further ones of `puckloop run`
};

struct RunTiming {
    ProgramTiming program;
    double simulated_s = 0;
    double wall_s = 0;  ///< without start-up and report, as the run's own summary has it
    std::string trace_sha256;

    double real_time_factor() const { return simulated_s / wall_s; }
};

/// `program run ...`, its results in `folder`, which is emptied first.
RunTiming time_run(const std::filesystem::path& program, const RunSpec& spec,
                   const std::filesystem::path& folder, const std::function<void(pid_t)>& watch = {});

}  // namespace puckloop::tools
