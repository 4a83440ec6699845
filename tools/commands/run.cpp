// `puckloop run SCENARIO`: the main job.

#include "base/error.h"
#include "base/logs/log.h"
#include "base/plain_text.h"
#include "cosim/interrupt.h"
#include "run/driven/driven_run.h"
#include "run/factory/node_process.h"
#include "run/plan/overrides.h"
#include "run/plan/parameter_list.h"
#include "run/report/report.h"
#include "run/report/status_line.h"
#include "run/run_scenario.h"
#include "run/setup.h"
#include "run/snapshots/snapshot_plan.h"
#include "scenarios/argos/import.h"
#include "scenarios/reader/read_scenario.h"
#include "scenarios/values/quantity.h"
#include "tools/cli/check.h"
#include "tools/cli/command.h"
#include "tools/cli/log_options.h"
#include "tools/cli/other_programs.h"
#include "tools/cli/time_check.h"
#include "tools/commands.h"
#include "tools/files/scenario_name.h"
#include "tools/shell/client_run.h"
#include "tools/shell/shell.h"
#include "traces/formats/export.h"
#include "view/server/loopback_port.h"

#include <fmt/format.h>

#include <exception>
#include <filesystem>
#include <memory>

namespace puckloop::tools {

namespace {

constexpr std::size_t kLongestSummary = 1 << 20;  ///< bytes

constexpr double kShortestStall = 1e-3;
constexpr double kShortestRun = 1e-9, kLongestDuration = 720 * 3600.0;  // seconds

struct RunOptions {
    RunRequest request;
    std::string linux_program;
    std::vector<std::string> linux_args;
    LogOptions log;
    std::string save_at;
    std::vector<std::string> snapshot_at;
    bool no_cache = false;
    bool interpret = false;
    bool json = false;
    bool list_parameters = false;
    bool control = false;
    bool view = false;
    bool shell = false;
    int view_port = 0;
};

/// Exit status: 0 success, 1 the run failed; signals (Ctrl-C) count as a shell would count them.
int status_of(const cosim::Outcome& outcome, int signal) {
    constexpr int kShellSignal = 128;
    if (outcome.reason == cosim::EndReason::Interrupted) return kShellSignal + signal;
    return outcome.success ? 0 : 1;
}

/// "40", "40s", "40 s" or "1500 ms", in seconds.
double time_of(const std::string& option, const std::string& text) {
    const bool bare = text.find_first_not_of("0123456789.") == std::string::npos;
    try {
        const double seconds =
            scenarios::parse_quantity(bare ? text + " s" : text, scenarios::Dimension::Time);
        if (seconds > 0 && seconds <= kLongestDuration) return seconds;
    } catch (const scenarios::QuantityError&) {
    }
    throw InputError("", option, fmt::format("'{}' is no time within a run", text), "such as 40s");
}

void export_trace(const std::filesystem::path& out, const std::vector<std::string>& formats) {
    if (formats.empty() || !std::filesystem::exists(out / "trace.csv")) return;  // the run did not begin
    const RecordedTrace trace(out, {});
    for (const std::string& format : formats) {
        const std::string file = (out / ("trace." + format)).string();
        if (format == "sr")
            export_sr(trace, file, 0);
        else
            write_output(file, [&](std::ostream& to) {
                format == "vcd" ? export_vcd(trace, to) : export_pcapng(trace, to);
            });
    }
}

/// The defaults, or with a scenario the values in force.
int list_parameters(const RunRequest& request) {
    if (!request.from.empty())
        throw InputError("", "--list-parameters", "does not go with --from", "the snapshot's scenario");
    if (request.scenario.empty()) {
        if (!request.overlay.empty())
            throw InputError("", "--model", "no scenario is given whose values it changes",
                             "a scenario beside it");
        print_parameters(nullptr);
        return 0;
    }
    scenarios::Scenario scenario = scenarios::read_scenario(request.scenario, settings_of(request));
    apply(request, scenario);
    print_parameters(&scenario.world);
    return 0;
}

/// What needs a board in this very process, or a process of its own for it.
void check_hosts(const RunOptions& options) {
    const RunRequest& request = options.request;
    const auto refuse = [](const char* option, const char* why) {
        throw InputError("", option, fmt::format("does not go with nodes on several hosts: {}", why));
    };
    if (options.view || options.shell || options.control)
        refuse(options.view    ? "--view"
               : options.shell ? "--shell"
                               : "--control",
               "their boards are out of reach");
    if (!request.gdb.empty()) refuse("--gdb", "their boards are out of reach");
    if (request.in_process) refuse("--in-process", "it puts all of them into one process");
    if (request.realtime || request.paced)
        refuse(request.paced ? "--paced" : "--realtime", "only one process keeps pace");
}

int run_scenario_file(RunOptions& options) {
    RunRequest& request = options.request;
    request.scenario = scenario_named(request.scenario);
    request.mission = mission_named(request.mission);
    if (options.list_parameters) return list_parameters(request);
    if (request.scenario.empty() && request.from.empty())
        throw InputError("", "run", "no scenario given", "a file such as scenarios/hello.toml");
    if (!options.linux_program.empty()) {
        request.linux_command = {options.linux_program};
        request.linux_command.insert(request.linux_command.end(), options.linux_args.begin(),
                                     options.linux_args.end());
    }
    if (request.threads != 0 && !request.in_process)
        throw InputError("", "--threads", "nodes in processes of their own share no threads",
                         "--in-process with it");
    start_log("puckloop", options.log);
    if (!request.in_process) log::share_with_children();
    if (options.interpret) interpret_from_here(!request.in_process);
    if (!options.save_at.empty()) request.save_at = time_of("--at", options.save_at);
    for (const std::string& at : options.snapshot_at)
        request.snapshot_at.push_back(time_of("--save-at", at));
    request.cache = !options.no_cache && !options.control;
    if (!request.from.empty()) request = going_on(request);
    RunSetup setup = set_up(request);
    if (options.control) let_client_drive(setup, request);
    for (const std::string& note : setup.scenario.not_taken)
        fmt::print(stderr, "{}: {}\n", request.scenario.string(), note);
    if (argos::is_experiment(request.scenario) && request.linux_command.empty())
        fmt::print(
            stderr,
            "{}: note: nobody drives: the simulator's controllers are not executed, and no --linux PROGRAM "
            "(built for the real robot) is given\n",
            request.scenario.string());
    const cosim::InterruptGuard interrupt;
    if (setup.ready > 0)
        fmt::print(stderr, "the first {:g} s are not paced: the boards boot\n",
                   cosim::to_seconds(setup.ready));
    StatusLine status_line(setup.scenario.duration);
    cosim::Outcome outcome;
    try {
        outcome = run_scenario(
            setup, request, [&](const cosim::Progress& progress) { status_line.show(progress); }, &interrupt,
            options.control);
    } catch (const RunError& error) {  // Ctrl-C before it began, while it waited for a reader of --live
        if (*interrupt.flag() == 0) throw;
        fmt::print(stderr, "puckloop: {}\n", plain_lines(error.what(), kLongestMessage));
        return 128 + *interrupt.flag();
    }
    status_line.clear();
    std::exception_ptr failed;  // of an export: what came of the run is shown first
    try {
        export_trace(setup.out, request.trace_formats);
    } catch (...) {
        failed = std::current_exception();
    }
    std::FILE* said = request.live == "-" ? stderr : stdout;  // the trace's own
    if (options.json)
        fmt::print(said, "{}\n", (setup.out / "report.json").string());
    else
        fmt::print(
            said, "{}\n",
            plain_lines(summary(setup, outcome) + snapshots_summary(request, outcome), kLongestSummary));
    const int status = status_of(outcome, *interrupt.flag());
    if (status != 0) fmt::print(stderr, "puckloop: {}\n", plain_lines(outcome.text, kLongestMessage));
    if (failed) std::rethrow_exception(failed);
    return status;
}

/// The same with a page or a shell that drives it.
int run_driven(RunOptions& options) {
    options.control = true;
    const auto results = [&] {
        RunRequest request = options.request;
        request.scenario = scenario_named(request.scenario);
        if (!request.from.empty()) request = going_on(request);
        return set_up(request).out;
    };
    const auto client = [&](const std::filesystem::path& folder, pid_t run) {
        if (options.shell) return run_shell(folder);
        become_puckloop({"view", folder.string(), "--port", std::to_string(options.view_port),
                         "--run-process", std::to_string(run)});
    };
    return run_with_client({[&] { return run_scenario_file(options); }, results, client});
}

}  // namespace

void declare_run(Command& app, int& status) {
    declare_run_on(app, status, nullptr);
}

void declare_run_on(Command& app, int& status, cosim::NodeHosts* hosts) {
    Command* command =
        app.add_subcommand("run", "run a scenario: boards, Linux programs and the world together");
    auto options = std::make_shared<RunOptions>();
    RunRequest& request = options->request;
    request.hosts = hosts;
    command->add_option("scenario", request.scenario, "scenario file (docs/scenario.md)")
        ->type_name("SCENARIO");
    command
        ->add_option("--firmware", request.firmware,
                     "BOARD=IMAGE, such as robot0.pic=my.hex or tam0=my.elf, or pic=my.hex for all of a kind")
        ->type_name("BOARD=IMAGE");
    command
        ->add_option("--linux", options->linux_program,
                     "PROGRAM [ARG]...: the Linux program in place of the scenario's; the words after it are "
                     "its arguments "
                     "up to the next option of this list, and all the rest after a --")
        ->type_name("PROGRAM [ARG]...");
    command->add_option("--linux-arg", options->linux_args)->group("");
    command
        ->add_option(
            "--linux-start", request.linux_start,
            "simulated second at which every robot's Linux program is started (default: the scenario's)")
        ->check(number_between(0.0, kLongestDuration))
        ->type_name("S");
    command
        ->add_option("--mission", request.mission,
                     "file whose table [mission] scores the run in place of the scenario's (docs/swarm.md)")
        ->check(not_empty())
        ->type_name("FILE");
    command
        ->add_option("--floor", request.floor,
                     "PNG file for the floor of an ARGoS experiment (docs/swarm.md)")
        ->check(not_empty())
        ->type_name("FILE");
    command
        ->add_option("--floor-scale", request.floor_scale,
                     "pixels a metre of --floor (default: it covers the arena)")
        ->check(positive_number())
        ->type_name("N");
    command->add_flag("--in-process", request.in_process,
                      "all nodes in this process (default: each in its own)");
    command
        ->add_option("--threads", request.threads,
                     "with --in-process: threads for the boards (default: by the number of boards)")
        ->check(whole_number_between(1, 16))
        ->type_name("N");
    command->add_flag(
        "--no-translate", options->interpret,
        "interpret every instruction of the chips (default: hot code is translated to this machine's; "
        "the run is the same)");
    Option* realtime =
        command->add_flag("--realtime", request.realtime, "pace simulated time by the wall clock");
    command
        ->add_flag("--paced", request.paced,
                   "the same, but Linux programs stay in simulated time: the run can be repeated")
        ->excludes(realtime);
    command
        ->add_option(
            "--join", request.joins,
            "PORT=HOST:PORT: 127.0.0.1:PORT leads to a port in the run's network while it goes on, with "
            "--paced or --realtime (docs/network.md); repeatable")
        ->allow_extra_args(false)
        ->type_name("PORT=HOST:PORT");
    command
        ->add_option("--events", request.events,
                     "[[event]] tables in place of the scenario's, such as events.toml of an earlier run")
        ->check(not_empty())
        ->type_name("FILE");
    command
        ->add_option("--fault", request.faults,
                     "a fault besides the scenario's, with the keys of a [[fault]] table: "
                     "\"drop link=robot0.uart from=robot0.linux at=2s\"; may be given several times")
        ->type_name("\"KIND KEY=VALUE...\"")
        ->allow_extra_args(false);
    command->add_option("--duration", request.duration, "simulated time of the run, such as 30 s")
        ->check(seconds_between(kShortestRun, kLongestDuration))
        ->type_name("TIME");
    command
        ->add_option("--set", request.variables,
                     "NAME=VALUE: a variable of the scenario's [variables]; may be given several times")
        ->allow_extra_args(false)
        ->check(not_empty())
        ->type_name("NAME=VALUE");
    command->add_option("--seed", request.seed, "seed of every random stream")
        ->check(count_up_to(~std::uint64_t{0}))
        ->type_name("N");
    command
        ->add_option("--trace-format", request.trace_formats,
                     "write the trace also as sr (sigrok), pcapng or vcd when the run ends (repeatable)")
        ->allow_extra_args(false)
        ->check(one_of({"sr", "pcapng", "vcd"}));
    command
        ->add_option("--junit", request.junit,
                     "write the run and its [[expect]] tables as a test suite, JUnit's XML (docs/expect.md)")
        ->check(not_empty())
        ->type_name("FILE");
    command->add_option("--tap", request.tap, "the same as TAP")->check(not_empty())->type_name("FILE");
    command
        ->add_option("--live", request.live,
                     "write the trace as pcapng while the run goes on: to a named pipe that Wireshark reads, "
                     "to - (the standard output) or a file")
        ->check(not_empty())
        ->type_name("FILE");
    command->add_flag("--record", request.record, "write every message to record.csv, for `puckloop replay`");
    command->add_option("--model", request.overlay, "overlay of physical parameters")
        ->check(not_empty())
        ->type_name("OVERLAY");
    command->add_option("--out", request.out, "folder for the results (default: out/<scenario>)")
        ->check(not_empty())
        ->type_name("DIR");
    command
        ->add_option("--stall", request.stall_seconds,
                     "wall-clock seconds after which a silent node ends the run")
        ->check(seconds_between(kShortestStall, kLongestDuration))
        ->type_name("TIME");
    command
        ->add_option("--gdb", request.gdb,
                     "NODE=PLACE: the run waits for GDB at PLACE, unix:PATH (this user's alone) or :PORT (on "
                     "127.0.0.1: open to every user of this machine), and waits "
                     "whenever that stops the board NODE (robot0.pic, tam0.avr, ...); repeatable "
                     "(docs/debugging.md)")
        ->allow_extra_args(false)
        ->type_name("NODE=PLACE");
    command
        ->add_option("--stats", request.stats,
                     "NODE: into report.json what the board's program costs, how deep its stack goes, and "
                     "what it reads of RAM before writing it; NODE is robot0.pic, tam0.avr, ..., pic, rab or "
                     "tam for all of a kind, or all; repeatable (docs/debugging.md)")
        ->allow_extra_args(false)
        ->check(not_empty())
        ->type_name("NODE");
    command->add_flag("--control", options->control,
                      "a client drives the run: it waits at its beginning until one comes to the socket that "
                      "control.json in the results names (docs/control_protocol.md)");
    command->add_flag("--view", options->view,
                      "open a page in the browser that shows the run and drives it: play, "
                      "step, back, faults, registers; it "
                      "stands still until the page lets it go on (docs/view.md)");
    command->add_flag("--shell", options->shell,
                      "drive the run by commands from the terminal or standard input (docs/view.md)");
    command
        ->add_option("--view-port", options->view_port, "port of --view on 127.0.0.1 (default: a free one)")
        ->check(whole_number_between(0, 65535))
        ->type_name("N");
    command->add_flag("--strict", request.strict,
                      "status 1 if there is anything to warn of: firmware that hangs, registers without a "
                      "model, I2C addresses that nobody acknowledges, ...");
    command
        ->add_option("--save-state", request.save_state,
                     "file for the states of all boards at --at; the run goes on")
        ->check(not_empty())
        ->type_name("FILE");
    command->add_option("--at", options->save_at, "simulated time of --save-state, such as 40s")
        ->check(not_empty())
        ->type_name("TIME");
    command
        ->add_option("--from-state", request.from_state,
                     "start the boards from a file of --save-state: until its time they send what was "
                     "recorded, without being executed")
        ->check(not_empty())
        ->type_name("FILE");
    command
        ->add_option("--save-at", options->snapshot_at,
                     "simulated time at which the whole run is saved into --save, such as 10s; the run goes "
                     "on; may be given several times (docs/snapshots.md)")
        ->check(not_empty())
        ->type_name("TIME")
        ->allow_extra_args(false);
    command
        ->add_option("--save", request.save,
                     "file of the snapshot; with several --save-at FILE-10s, FILE-20s, ...")
        ->check(not_empty())
        ->type_name("FILE");
    command
        ->add_option("--from", request.from,
                     "go on from a snapshot, in place of a scenario: the trace is that of the whole run; "
                     "--duration and faults that begin later may be others")
        ->check(not_empty())
        ->type_name("FILE");
    command->add_flag("--no-cache", options->no_cache,
                      "execute every board's boot, and keep none in the cache (docs/scenario.md)");
    command->add_flag(
        "--list-parameters", options->list_parameters,
        "print every physical parameter with its default, its range and where they come from; with "
        "a scenario, and --model, also the value in force");
    command->add_flag("--json", options->json, "print only the path of report.json");
    declare_log_options(*command, options->log);
    command->footer(
        "Examples:\n"
        "  puckloop run hello --in-process\n"
        "  puckloop run scenarios/own_binaries.toml --firmware pic=my.hex --linux ./controller -x 1\n"
        "  puckloop run hello --duration 5s --record --fault \"drop link=robot0.uart at=2s\"");
    command->callback([options, &status] {
        // Before the run begins and writes over the results of another.
        if (options->view) check_built("view", "--view");
        if (options->view) view::check_port(static_cast<std::uint16_t>(options->view_port), "--view-port");
        if (options->view_port != 0 && !options->view)
            throw InputError("", "--view-port", "there is no page", "--view with it");
        if (options->view && options->shell)
            throw InputError("", "--shell", "the page drives", "one of them");
        if (options->request.hosts) check_hosts(*options);
        status = options->view || options->shell ? run_driven(*options) : run_scenario_file(*options);
    });
}

}  // namespace puckloop::tools
