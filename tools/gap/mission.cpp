// puckloop gap mission: swarms of real robots beside simulated ones.

#include "gap/mission/mission.h"
#include "base/error.h"
#include "tools/cli/check.h"
#include "tools/cli/command.h"
#include "tools/gap/folders.h"
#include "tools/gap/subcommands.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>

namespace puckloop::tools {

namespace {

struct MissionRequest {
    std::filesystem::path measured, simulated, out;
    std::uint64_t seed = 1;
    bool json = false;
};

void compare_missions(const MissionRequest& request) {
    const auto measured = gap::mission::read_mission_runs(request.measured);
    const auto simulated = gap::mission::read_mission_runs(request.simulated);
    const auto verdict = gap::mission::judge(measured, simulated, request.seed);
    if (!request.out.empty()) {
        write_beside(request.out, gap::mission::verdict_json(verdict));
        put_in_place(request.out);
    }
    fmt::print("{}",
               request.json ? gap::mission::verdict_json(verdict) : gap::mission::verdict_text(verdict));
}

}  // namespace

void declare_gap_mission(Command& gap, int& status) {
    Command* command = gap.add_subcommand(
        "mission", "Measured runs of a swarm beside simulated ones: what differs, and which effect brings "
                   "them closer");
    auto request = std::make_shared<MissionRequest>();
    command->add_option("measured", request->measured, "folder with results.csv and tracks (docs/swarm.md)")
        ->type_name("DIR")
        ->check(not_empty())
        ->required();
    command
        ->add_option(
            "simulated", request->simulated,
            "results of `puckloop experiment` with keep = true: the first condition is the simulation "
            "as it is, every other one effect")
        ->type_name("DIR")
        ->check(not_empty())
        ->required();
    command->add_option("--out", request->out, "the verdict as JSON")->type_name("FILE")->check(not_empty());
    command->add_option("--seed", request->seed, "of the draws (1)")->type_name("N");
    command->add_flag("--json", request->json, "print the verdict as JSON");
    command->callback([request, &status] {
        status = 0;
        compare_missions(*request);
    });
}

}  // namespace puckloop::tools
