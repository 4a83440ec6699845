#include "run/run_scenario.h"
#include "run/control/control_place.h"
#include "run/debugging/run_debuggers.h"
#include "run/driven/driven_run.h"
#include "run/driven/kept_images.h"
#include "run/expectations/judge_expectations.h"
#include "run/expectations/test_report.h"
#include "run/factory/node_factory.h"
#include "run/factory/preflight.h"
#include "run/plan/state_plan.h"
#include "run/report/fault_results.h"
#include "run/report/live_trace.h"
#include "run/report/report.h"
#include "run/report/results_folder.h"
#include "run/report/run_log.h"
#include "run/snapshots/snapshot_plan.h"

#include "base/error.h"
#include "cosim/faults/spec/flash.h"
#include "cosim/resume/run_snapshot.h"
#include "cosim/trace/trace_csv.h"
#include "physics/render/arena_file.h"
#include "physics/render/trajectory_svg.h"

#include <fmt/format.h>

#include <sys/resource.h>

#include <algorithm>
#include <cstring>
#include <optional>
#include <thread>
#include <utility>

namespace puckloop::tools {

namespace {

/// The world with what its events added, for the picture.
physics::World with_added_things(const scenarios::Scenario& scenario) {
    physics::World world = scenario.world;
    const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
    for (const physics::Event& event : scenario.events.events) {
        append(world.boxes, event.action.thing.boxes);
        append(world.cylinders, event.action.thing.cylinders);
        const physics::VirtualThings& added = event.action.thing.virtuals;
        append(world.virtuals.walls, added.walls);
        append(world.virtuals.boxes, added.boxes);
        append(world.virtuals.cylinders, added.cylinders);
        append(world.virtuals.lamps, added.lamps);
    }
    return world;
}

/// Report and picture are made even if the run failed; of what goes wrong with them then only a missing
/// report is news.
void write_results(const RunSetup& setup, cosim::Outcome& outcome, const std::vector<UsedFile>& files,
                   const std::vector<Failure>& failures, const std::vector<ExpectationResult>& expectations,
                   ReservedFile& report) {
    const auto guarded = [&](auto work) {
        try {
            work();
        } catch (const RunError& error) {
            if (outcome.success) outcome.text = error.what();
            outcome.success = false;
        }
    };
    bool drawn = false;
    guarded([&] {
        physics::write_trajectory_svg(with_added_things(setup.scenario), setup.out);
        drawn = true;
    });
    std::error_code ignored;
    if (!drawn) std::filesystem::remove(setup.out / "trajectory.svg", ignored);  // no half a picture
    guarded([&] {
        if (!outcome.faults.empty()) write_faults_csv(outcome, setup.out / "faults.csv");
    });
    try {
        write_report(setup, outcome, files, failures, expectations, report);
    } catch (const RunError& error) {
        outcome.text = outcome.success ? error.what() : fmt::format("{}; {}", outcome.text, error.what());
        outcome.success = false;
    }
}

/// Robots in one process take some six descriptors each; the usual soft limit of 1024 is not meant for them.
void raise_descriptor_limit() {
    rlimit limit{};
    if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
    limit.rlim_cur = limit.rlim_max;
    setrlimit(RLIMIT_NOFILE, &limit);
}

}  // namespace

std::vector<std::string> result_files(const RunSetup& setup) {
    std::vector<std::string> names{"report.json",    "report.json.part", "trace.csv",   "trajectory.csv",
                                   "trajectory.svg", "sensors.csv",      "objects.csv", "ir.csv",
                                   "tams.csv",       "faults.csv",       "record.csv",  "trace.sr",
                                   "trace.vcd",      "trace.pcapng",     "arena.json",  "tracker.csv",
                                   "mission.log",    "pheromones.csv",   "view.events"};
    for (const PlannedNode& node : setup.nodes)
        for (const char* kind : {".log", ".received"})
            names.push_back(node.name + kind);
    for (const scenarios::RobotBoards& robot : setup.scenario.robots) {
        for (const char* ending : {"csv", "ppm"})
            names.push_back(robot.name + ".pic.camera." + ending);
        if (robot.linux_board)
            for (const scenarios::LinuxCamera& camera : robot.linux_board->cameras)
                names.push_back(robot.name + "." + camera.kind + ".csv");
    }
    return names;
}

namespace {

void end_live(LiveTrace& live, cosim::Outcome& outcome) {
    try {
        live.end();
    } catch (const RunError& error) {
        if (outcome.success) outcome.text = error.what();
        outcome.success = false;
    }
}

void tell_met(const std::vector<ExpectationResult>& results, cosim::Outcome& outcome) {
    if (results.empty()) return;
    outcome.text += fmt::format("{}{} met", outcome.text.empty() ? "" : "; ",
                                results.size() == 1 ? "what is expected is"
                                                    : fmt::format("all {} expectations are", results.size()));
}

/// Into files that are new, or hold what is kept of a run that goes back.
void begin_recording(const RunSetup& setup, const RunRequest& request, const RunHistory::Place* kept,
                     std::optional<cosim::TraceCsvSink>& trace, std::optional<cosim::TraceCsvSink>& record) {
    if (kept != nullptr) {
        trace->cut_back(kept->trace);
        if (record) record->cut_back(kept->record);
        return;
    }
    trace.emplace((setup.out / "trace.csv").string());
    if (request.snapshot) trace->begin_with(request.snapshot->trace);
    if (request.record) record.emplace((setup.out / "record.csv").string(), cosim::TraceCsvSink::Rows::All);
}

/// With few boards there is little to do side by side beside the world's step: whether that pays is tried.
void set_threads(cosim::RunOptions& options, const RunSetup& setup, const RunRequest& request) {
    constexpr unsigned kBoardsOfThread = 4, kMost = 4;
    options.threads = 1;
    if (!request.in_process) return;
    const auto& robots = setup.scenario.robots;
    const auto has_rab = [](const auto& robot) { return robot.rab.has_value(); };
    const auto boards = static_cast<unsigned>(robots.size() + setup.scenario.tams.size()) +
                        static_cast<unsigned>(std::count_if(robots.begin(), robots.end(), has_rab));
    const unsigned cores = std::max(1U, std::thread::hardware_concurrency());
    options.threads = std::clamp(boards / kBoardsOfThread, 1U, std::min(cores, kMost));
    if (options.threads == 1 && cores > 1 && !options.realtime) {
        options.threads = 2;
        options.threads_if_faster = true;
    }
    if (request.threads == 0) return;
    options.threads = request.threads;
    options.threads_if_faster = false;
}

}  // namespace

namespace {

/// Below the results: what a program works in.
std::vector<std::string> work_folders(const RunSetup& setup) {
    std::vector<std::string> names;
    for (const auto& robot : setup.scenario.robots)
        if (robot.linux_board) names.push_back(robot.linux_board->folder);
    if (const auto& place = setup.scenario.coordinator; place && place->program)
        names.push_back(place->program->folder);
    std::erase(names, "");
    return names;
}

}  // namespace

std::vector<std::string> kept_results(const RunSetup& setup) {
    std::vector<std::string> names{"control.json", "events.toml", std::string(cosim::kFlashedFolder)};
    for (const std::string& folder : work_folders(setup))
        names.push_back(std::filesystem::path(folder).begin()->string());
    return names;
}

void make_work_folders(const RunSetup& setup) {
    for (const std::string& name : work_folders(setup)) {
        const auto folder = setup.out / name;
        std::error_code error;
        std::filesystem::create_directories(folder, error);
        if (error) throw InputError(folder.string(), "", "cannot be made a folder: " + error.message());
    }
}

cosim::Outcome run_scenario(const RunSetup& planned, const RunRequest& request,
                            const std::function<void(const cosim::Progress&)>& progress,
                            const cosim::InterruptGuard* interrupt, bool driven_by_client) {
    check_files(planned);
    std::vector<UsedFile> files = used_files(planned);
    const ResultsFolder folder(planned.out, result_files(planned), kept_results(planned));
    make_work_folders(planned);
    ReservedFile report(planned.out / "report.json", kReportBytes);

    std::error_code ignored;
    if (!planned.scenario.events.any()) std::filesystem::remove(planned.out / "events.toml", ignored);
    if (flashed_files(planned).empty()) remove_kept_images(planned.out / cosim::kFlashedFolder);
    ControlPlace control(planned.control, planned.out);
    raise_descriptor_limit();
    cosim::RunOptions options;
    if (planned.scenario.duration) options.duration = cosim::from_seconds(*planned.scenario.duration);
    options.in_process = request.in_process;
    options.hosts = request.hosts;
    options.windows = (request.in_process || request.hosts) && request.gdb.empty();
    options.realtime = request.realtime || request.paced;
    options.pace_from = planned.ready;
    set_threads(options, planned, request);
    options.seed = planned.scenario.seed;
    constexpr double kPatience = 1e9;  // a board under a debugger is silent for as long as its user thinks
    options.stall_seconds = request.gdb.empty() ? request.stall_seconds : kPatience;
    if (interrupt != nullptr) {
        options.interrupted = interrupt->flag();
        options.abort_requested = interrupt->again();
    }
    RunLog log(planned, request);
    options.progress = [&](const cosim::Progress& now) {
        log.progress(now);
        if (progress) progress(now);
    };
    std::optional<exec::PortRelay> relay;
    if (!planned.joined.empty()) relay.emplace(planned.joined);
    // Before anything is started: a named pipe may have to wait for its reader.
    std::optional<LiveTrace> live;
    if (!request.live.empty()) live.emplace(request.live, options.interrupted);
    std::optional<cosim::TraceCsvSink> trace;
    use_snapshots(planned, request, trace, options);
    std::optional<cosim::TraceCsvSink> record;
    LineWatch lines(planned.scenario.expectations);
    const std::vector<LineWatch::Watch> nothing_seen = lines.seen();
    std::optional<RunDebuggers> debuggers;
    cosim::NodeFactory factory = make_described;
    if (!request.gdb.empty()) {
        debuggers.emplace(planned, request, options.abort_requested);
        debuggers->keep_past(options, {trace, record, lines});
        factory = [&](const std::string& node) { return debuggers->make_node(node); };
    }
    std::optional<DrivenRun> driven;
    if (driven_by_client) {
        driven.emplace(planned, request, set_up, options.interrupted);
        control.name_client_socket();
        driven->drive(options, {trace, record, lines});
        factory = [&](const std::string& node) { return driven->make_node(node); };
    }
    cosim::Outcome outcome;
    do {
        const bool back = outcome.reason == cosim::EndReason::Reverted;
        const RunHistory::Place* kept = nullptr;
        if (back) {
            options.from = driven ? driven->begin_again() : debuggers->begin_again();
            kept = driven ? driven->kept() : debuggers->kept();
            lines.go_back(kept != nullptr ? kept->lines : nothing_seen);
        }
        const RunSetup& now = driven ? driven->setup() : planned;
        std::optional<cosim::Conductor> conductor;
        try {
            // From the start, so that a run that is killed has it as well.
            if (!back)
                physics::write_arena_file(with_added_things(planned.scenario), planned.out / "arena.json");
            conductor.emplace(node_specs(now), now.links, now.scenario.faults, options, factory);
        } catch (const RunError& error) {  // why it did not begin is in the report, as of one that ended so
            outcome = {};
            outcome.reason = cosim::EndReason::Failed;
            outcome.success = false;
            outcome.text = error.what();
            break;
        }
        // Only now: a run whose nodes do not start has recorded nothing.
        begin_recording(planned, request, kept, trace, record);
        conductor->add_sink(*trace);
        if (record) conductor->add_sink(*record);
        if (live) conductor->add_sink(*live);
        if (driven) conductor->add_sink(driven->sink());
        if (lines.watches()) conductor->add_sink(lines);
        log.started(*conductor);
        outcome = conductor->run();
    } while (outcome.reason == cosim::EndReason::Reverted);
    const RunSetup& setup = driven ? driven->setup() : planned;  // a client may have added faults
    for (UsedFile& file : flashed_files(setup))
        files.push_back(std::move(file));
    if (live) end_live(*live, outcome);
    if (outcome.reason == cosim::EndReason::Interrupted) {
        outcome.success = false;
        outcome.text =
            fmt::format("interrupted (SIG{}) at {:.3f} s of simulated time", sigabbrev_np(*interrupt->flag()),
                        cosim::to_seconds(outcome.stop_time.value_or(outcome.simulated)));
    }
    if (!request.from.empty() && !outcome.went_on) outcome.text = request.from.string() + ": " + outcome.text;
    judge(outcome);
    std::vector<Failure> failures;
    if (outcome.success) failures = failures_of(setup, setup.scenario.allow, outcome);
    judge_failures(failures, outcome);
    if (driven) driven->over(outcome);
    take_fault_results(setup, outcome);
    collect_states(setup, outcome);
    judge_snapshots(request, outcome);
    if (request.strict) judge_strictly(setup, outcome);
    log.ended(outcome);
    TestSuite suite{.name = setup.scenario.name,
                    .trouble = outcome.success ? "" : outcome.text,
                    .scenario = setup.scenario.file.string(),
                    .out = setup.out.string(),
                    .wall_s = outcome.wall_s,
                    .results = judge_expectations(setup, outcome, lines)};
    fail_unmet(setup, suite.results, failures, outcome);
    if (outcome.success) tell_met(suite.results, outcome);
    write_results(setup, outcome, files, failures, suite.results, report);
    write_test_reports(request.junit, request.tap, suite, outcome);
    log.written();
    return outcome;
}

}  // namespace puckloop::tools
