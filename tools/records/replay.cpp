// puckloop replay: one node of a recorded run, alone.

#include "replay/replay.h"

#include "base/error.h"
#include "base/json.h"
#include "replay/dump.h"
#include "run/factory/node_factory.h"
#include "run/report/results_folder.h"
#include "run/run_scenario.h"
#include "run/setup.h"
#include "tools/cli/check.h"
#include "tools/cli/command.h"
#include "tools/cli/other_programs.h"
#include "tools/cli/time_check.h"
#include "tools/records/records.h"
#include "traces/recorded_trace.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>

namespace puckloop::tools {

namespace {

constexpr double kLatestReplayed = 9e6;  // s

struct ReplayCommandOptions {
    RunRequest request;
    std::string folder, node, linux_program;
    std::vector<std::string> linux_args;
    double from = 0.0, until = kLatestReplayed;
    std::string vcd;
    std::vector<std::string> registers;
    bool list_registers = false;
};

const PlannedNode& find_node(const RunSetup& setup, const std::string& name) {
    std::vector<std::string> names;
    for (const PlannedNode& node : setup.nodes) {
        if (node.name == name) return node;
        names.push_back(node.name);
    }
    throw InputError(setup.scenario.file.string(), "--node", fmt::format("no node is called '{}'", name),
                     fmt::format("one of {}", fmt::join(names, ", ")));
}

void check_options(const ReplayCommandOptions& options) {
    if (options.vcd.empty() && !options.registers.empty())
        throw InputError("", "--registers", "there is no --vcd to write them to", "--vcd FILE");
    if (options.vcd.empty() && options.from > 0)
        throw InputError("", "--from",
                         "a replay begins where the run began; without --vcd nothing begins at "
                         "another time",
                         "--vcd FILE, or --from-state FILE");
    if (options.until <= options.from)
        throw InputError("", "--to", fmt::format("{} s is not after --from", options.until),
                         fmt::format("more than {} s", options.from));
}

/// The node's links of which something was recorded, within the time that the dump is of.
TraceSelection lines_of(const ReplayCommandOptions& options, const RunSetup& setup,
                        const ReplayResult& result) {
    TraceSelection selection;
    for (const cosim::LinkSpec& link : setup.links)
        if ((link.a.node == options.node || link.b.node == options.node) && result.links.contains(link.name))
            selection.links.push_back(link.name);
    selection.from_s = options.from;
    selection.until_s = std::min(options.until, cosim::to_seconds(result.until + cosim::kNanosecond));
    return selection;
}

/// The run's report; no object if it left none.
nlohmann::json report_of(const std::filesystem::path& folder) {
    std::ifstream in(folder / "report.json");
    return nlohmann::json::parse(in, nullptr, false);
}

/// That the record is of a run of this scenario, by content or by place, with this seed. A run that was
/// killed left no report, and one of an older build none with the scenario's content: they are not compared.
void check_origin(const nlohmann::json& report, const std::filesystem::path& record, const RunSetup& setup) {
    if (!report.is_object()) return;
    const auto field = [&](const char* key) { return report.value(key, nlohmann::json()); };
    const nlohmann::json content = field("scenario_sha256"), file = field("scenario"), seed = field("seed");
    std::error_code gone;
    if (content.is_string() && content != setup.scenario_sha256 && file.is_string() &&
        !std::filesystem::equivalent(file.get<std::string>(), setup.scenario.file, gone))
        throw InputError(record.string(), "",
                         fmt::format("is of a run of {}, not of {}", file.get<std::string>(),
                                     setup.scenario.file.string()),
                         "the scenario of that run");
    if (seed.is_number_unsigned() && seed != setup.scenario.seed)
        throw InputError(record.string(), "",
                         fmt::format("is of a run with seed {}, and this replay has seed {}", seed.dump(),
                                     setup.scenario.seed),
                         fmt::format("--seed {}", seed.dump()));
}

/// A time of the run's report, in seconds; nothing if there is none.
std::optional<cosim::Time> reported(const nlohmann::json& report, const char* key) {
    if (!report.is_object()) return std::nullopt;
    const auto found = report.find(key);
    if (found == report.end() || !found->is_number()) return std::nullopt;
    const double seconds = *found;
    if (!(seconds > 0 && seconds < kLatestReplayed)) return std::nullopt;
    return cosim::from_seconds(seconds);
}

/// A dump cannot replace what it is made from.
void check_output(const std::string& vcd, const std::filesystem::path& record) {
    std::error_code error;
    if (vcd != "-" && std::filesystem::equivalent(record, vcd, error))
        throw InputError(vcd, "--vcd", "is the record itself", "another file");
    if (!vcd.empty()) check_output_file(vcd);
}

int run_replay(ReplayCommandOptions& options) {
    check_options(options);
    RunRequest& request = options.request;
    if (!options.linux_program.empty()) {
        request.linux_command = {options.linux_program};
        request.linux_command.insert(request.linux_command.end(), options.linux_args.begin(),
                                     options.linux_args.end());
    }
    const std::filesystem::path file = std::filesystem::path(options.folder) / "record.csv";
    if (!std::filesystem::exists(file))
        throw InputError(file.string(), "", "no such file", "the results folder of a run with --record");
    check_output(options.vcd, file);
    TraceSelection selection;
    selection.until_s = options.until;
    const RecordedTrace record(file, selection);
    if (request.out.empty()) request.out = std::filesystem::path(options.folder) / "replay";
    const RunSetup setup = set_up(request);
    const nlohmann::json report = report_of(options.folder);
    check_origin(report, file, setup);
    const NodeDescription& description = find_node(setup, options.node).what;
    if (std::error_code none; std::filesystem::equivalent(setup.out, options.folder, none))
        throw InputError(setup.out.string(), "--out", "is the recorded run's own folder", "another folder");
    const ResultsFolder results(setup.out, result_files(setup), kept_results(setup));
    make_work_folders(setup);
    const auto node = make_node(description);
    if (options.list_registers) {
        fmt::print("{}", list_of(view_of(description, *node)));
        return 0;
    }
    std::optional<Watch> watch;
    ReplayWatch looks;
    if (!options.registers.empty()) {
        watch.emplace(view_of(description, *node), options.registers);
        looks.from = std::max(cosim::from_seconds(options.from), watch->first());
        looks.next = [&](cosim::Time now) { return watch->next(now); };
        looks.look = [&](cosim::Time now) { watch->sample(now); };
    }
    ReplayOptions how;
    how.wind_up = reported(report, "programs_asked_to_end_s");
    how.watch = watch ? &looks : nullptr;
    how.end = reported(report, "simulated_s").value_or(cosim::kNever);
    for (const cosim::FaultSpec& fault : setup.scenario.faults)
        how.links_with_faults.insert(fault.link);
    const ReplayResult result = replay(*node, setup.links, record, how);
    if (!options.vcd.empty()) {
        if (cosim::to_seconds(result.until) <= options.from)
            throw InputError(file.string(), "--from",
                             fmt::format("the replay ended at {:.6f} s", cosim::to_seconds(result.until)),
                             "an earlier time");
        const RecordedTrace lines(file, lines_of(options, setup, result));
        write_dump(options.vcd, lines, options.node, watch ? &*watch : nullptr);
    }
    node->finish();
    std::FILE* out = options.vcd == "-" ? stderr : stdout;
    const std::string counts = fmt::format("{} messages in, {} out as recorded, until {:.6f} s",
                                           result.received, result.equal, cosim::to_seconds(result.until));
    fmt::print(out, "{}: {}\n", options.node, counts);
    if (watch)
        fmt::print(out, "{} changes of {} values in {}\n", watch->log().size(), watch->values().size(),
                   options.vcd);
    if (!result.difference) return 0;
    const ReplayDifference& first = *result.difference;
    const auto shown = [](const std::string& row) { return row.empty() ? std::string("no message") : row; };
    fmt::print(out, "first difference at {} s, message {} on {}\n  recorded: {}\n  replayed: {}\n",
               cosim::format_seconds(first.time), first.message, first.link, shown(first.recorded),
               shown(first.replayed));
    return 1;
}

/// What the run was given has to be given again.
void declare_run_options(Command& command, ReplayCommandOptions& options) {
    RunRequest& request = options.request;
    command.add_option("--firmware", request.firmware, "as of `run`: BOARD=IMAGE")->type_name("BOARD=IMAGE");
    command.add_option("--linux", options.linux_program, "as of `run`")->type_name("PROGRAM [ARG]...");
    command.add_option("--linux-arg", options.linux_args)->group("");
    command.add_option("--fault", request.faults, "as of `run`; repeatable")
        ->type_name("\"KIND KEY=VALUE...\"")
        ->allow_extra_args(false);
    command.add_option("--events", request.events, "as of `run`")->type_name("FILE");
    command.add_option("--seed", request.seed, "as of `run`")
        ->check(count_up_to(~std::uint64_t{0}))
        ->type_name("N");
    command.add_option("--model", request.overlay, "as of `run`: overlay of physical parameters")
        ->type_name("OVERLAY");
    command
        .add_option(
            "--from-state", request.from_state,
            "a file of `run --save-state`: the board takes its state over, and nothing before that is "
            "executed")
        ->check(not_empty())
        ->type_name("FILE");
}

}  // namespace

void declare_replay(Command& app, int& status) {
    auto options = std::make_shared<ReplayCommandOptions>();
    Command* command = app.add_subcommand("replay", about("replay"));
    command->add_option("scenario", options->request.scenario, "the scenario that was run")
        ->required()
        ->type_name("SCENARIO");
    command->add_option("folder", options->folder, "results folder of `run SCENARIO --record`")
        ->required()
        ->type_name("DIR");
    command->add_option("--node", options->node, "the node, such as robot0.pic")
        ->required()
        ->type_name("NAME");
    declare_run_options(*command, *options);
    command->add_option("--to", options->until, "simulated seconds; else all that was recorded")
        ->check(seconds_between(1e-9, kLatestReplayed))
        ->type_name("TIME");
    command
        ->add_option("--vcd", options->vcd,
                     "write the node's lines, signals and --registers for GTKWave; - is the standard output")
        ->type_name("FILE");
    command
        ->add_option("--registers", options->registers,
                     "registers and variables in the dump, every change to the cycle: PORTB,U1STA,PC,counter,"
                     "buffer+4:2,0x0850 (docs/traces.md); repeatable")
        ->delimiter(',')
        ->allow_extra_args(false)
        ->type_name("NAME,...");
    command->add_option("--from", options->from, "where the dump begins, simulated seconds")
        ->check(seconds_between(0.0, kLatestReplayed))
        ->type_name("TIME");
    command->add_flag("--list-registers", options->list_registers,
                      "print what --registers takes for this node and its firmware");
    command->add_option("--out", options->request.out, "folder for the node's log (default: DIR/replay)")
        ->type_name("DIR");
    command->callback([options, &status] { status = run_replay(*options); });
}

}  // namespace puckloop::tools
