#pragma once
// What a run does with snapshots of itself: --save-at with --save, and --from (docs/snapshots.md).

#include "cosim/conductor.h"
#include "cosim/trace/trace_csv.h"
#include "run/description/run_request.h"
#include "run/description/run_setup.h"

#include <filesystem>
#include <optional>
#include <string>

namespace puckloop::tools {

/// The request of a run that goes on from `request.from`. Throws InputError: no snapshot of this build,
/// options that the snapshot decides.
RunRequest going_on(const RunRequest& request);

/// The file of the snapshot at `time`: the one asked for, or with several "FILE" with "-10s" before its
/// ending.
std::filesystem::path snapshot_file(const RunRequest& request, double time);

/// Checks times and files before the run, and that it is the run of its snapshot. Throws InputError.
void plan_snapshots(RunSetup& setup, const RunRequest& request);

/// Lets the conductor save and go on. `setup`, `request` and `trace`, which the run begins later and writes,
/// must outlive it.
void use_snapshots(const RunSetup& setup, const RunRequest& request,
                   std::optional<cosim::TraceCsvSink>& trace, cosim::RunOptions& options);

/// After the run: one that ended before a snapshot was due has failed.
void judge_snapshots(const RunRequest& request, cosim::Outcome& outcome);

/// Lines for the terminal.
std::string snapshots_summary(const RunRequest& request, const cosim::Outcome& outcome);

}  // namespace puckloop::tools
