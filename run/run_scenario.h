#pragma once
// One run from its setup to its outcome, without output: what `run` and `bench` share.

#include "cosim/conductor.h"
#include "cosim/interrupt.h"
#include "run/setup.h"

#include <functional>

namespace puckloop::tools {

/// Every name that nodes and the run itself may give a file in the results folder.
std::vector<std::string> result_files(const RunSetup& setup);

/// What else a run has there, files and folders, which the next run does not remove.
std::vector<std::string> kept_results(const RunSetup& setup);

/// The folders below the results that programs work in. Throws InputError.
void make_work_folders(const RunSetup& setup);

/// Runs, records trace.csv in the run's folder (made if absent), writes report.json and draws trajectory.svg.
/// Throws InputError before the run; what happens during it is in the outcome. `interrupt` may be null.
/// `driven_by_client`: `setup` is as let_client_drive() leaves it (run/driven/driven_run.h).
cosim::Outcome run_scenario(const RunSetup& setup, const RunRequest& request,
                            const std::function<void(const cosim::Progress&)>& progress,
                            const cosim::InterruptGuard* interrupt, bool driven_by_client = false);

}  // namespace puckloop::tools
