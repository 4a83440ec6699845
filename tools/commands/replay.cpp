// puckloop replay: one node of a recorded run, alone.

#include "tools/replay/replay.h"

#include "base/error.h"
#include "tools/cli/check.h"
#include "tools/cli/command.h"
#include "tools/commands.h"
#include "tools/run/node_factory.h"
#include "tools/run/setup.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>

namespace puckloop::tools {

namespace {

struct Options {
    RunRequest request;
    std::string folder, node;
    double until = 9e6;
};

const cosim::NodeSpec& find_node(const RunSetup& setup, const std::string& name) {
    std::vector<std::string> names;
    for (const cosim::NodeSpec& node : setup.nodes) {
        if (node.name == name) return node;
        names.push_back(node.name);
    }
    throw InputError(setup.scenario.file.string(), "--node", fmt::format("no node is called '{}'", name),
                     fmt::format("one of {}", fmt::join(names, ", ")));
}

int run(Options& options) {
    const std::filesystem::path file = std::filesystem::path(options.folder) / "record.csv";
    if (!std::filesystem::exists(file))
        throw InputError(file.string(), "", "no such file", "the results folder of a run with --record");
    TraceSelection selection;
    selection.until_s = options.until;
    const RecordedTrace record(file, selection);
    if (options.request.out.empty()) options.request.out = std::filesystem::path(options.folder) / "replay";
    const RunSetup setup = set_up(options.request);
    const cosim::NodeSpec& spec = find_node(setup, options.node);
    std::filesystem::create_directories(setup.out);
    const auto node = make_node(spec.json);
    const ReplayResult result = replay(*node, setup.links, record);
    node->finish();
    const std::string counts = fmt::format("{} messages in, {} out as recorded, until {:.6f} s",
                                           result.received, result.equal, cosim::to_seconds(result.until));
    if (!result.difference) {
        fmt::print("{}: {}\n", options.node, counts);
        return 0;
    }
    const ReplayDifference& first = *result.difference;
    const auto shown = [](const std::string& row) { return row.empty() ? std::string("no message") : row; };
    fmt::print("{}: {}\nfirst difference at {} s, message {} on {}\n  recorded: {}\n  replayed: {}\n",
               options.node, counts, cosim::format_seconds(first.time), first.message, first.link,
               shown(first.recorded), shown(first.replayed));
    return 1;
}

}  // namespace

void declare_replay(Command& app, int& status) {
    auto options = std::make_shared<Options>();
    Command* command =
        app.add_subcommand("replay", "execute one node of a recorded run alone, and compare what it sends");
    command->add_option("scenario", options->request.scenario, "the scenario that was run")
        ->required()
        ->type_name("SCENARIO");
    command->add_option("folder", options->folder, "results folder of `run SCENARIO --record`")
        ->required()
        ->type_name("DIR");
    command->add_option("--node", options->node, "the node, such as robot0.pic")
        ->required()
        ->type_name("NAME");
    command->add_option("--firmware", options->request.firmware, "as of `run`: BOARD=IMAGE")
        ->type_name("BOARD=IMAGE");
    command->add_option("--seed", options->request.seed, "as of `run`")
        ->check(count_up_to(~std::uint64_t{0}))
        ->type_name("N");
    command->add_option("--model", options->request.overlay, "as of `run`: overlay of physical parameters")
        ->type_name("OVERLAY");
    command->add_option("--to", options->until, "simulated seconds; else all that was recorded")
        ->check(number_between(1e-9, 9e6))
        ->type_name("S");
    command->add_option("--out", options->request.out, "folder for the node's log (default: DIR/replay)")
        ->type_name("DIR");
    command->callback([options, &status] { status = run(*options); });
}

}  // namespace puckloop::tools
