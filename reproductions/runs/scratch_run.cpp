#include "reproductions/runs/scratch_run.h"

#include "base/error.h"
#include "base/files/text_file.h"
#include "run/run_scenario.h"

#include <system_error>

namespace puckloop::tools {

namespace fs = std::filesystem;

void empty_folder(const fs::path& folder) {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
    make_folder(folder);
}

fs::path run_beside(const fs::path& scenario, const fs::path& overlay) {
    RunRequest request;
    request.scenario = scenario;
    request.out = scenario.parent_path() / "results";
    request.overlay = overlay;
    request.in_process = true;
    const RunSetup setup = set_up(request);
    const cosim::InterruptGuard interrupt;
    const cosim::Outcome outcome = run_scenario(setup, request, {}, &interrupt);
    if (!outcome.success || outcome.reason == cosim::EndReason::Interrupted) throw RunError(outcome.text);
    return request.out;
}

}  // namespace puckloop::tools
