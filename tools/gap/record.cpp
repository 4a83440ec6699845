// puckloop gap record: an experiment performed on the emulator, firmware in the loop.

#include "selftest/emulate/record.h"
#include "base/error.h"
#include "base/files/shipped_files.h"
#include "base/logs/log.h"
#include "run/files/program_path.h"
#include "tools/cli/check.h"
#include "tools/cli/command.h"
#include "tools/cli/log_options.h"
#include "tools/gap/folders.h"
#include "tools/gap/subcommands.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>
#include <unistd.h>

namespace puckloop::tools {

namespace {

namespace fs = std::filesystem;

struct RecordRequest {
    std::string kind;
    fs::path out, firmware, rab;
    std::vector<std::string> changes;
    std::uint64_t seed = 1;
    bool brief = false;
    LogOptions log;
};

/// A run that fails under faults of the line fails for them, most often.
gap::WrittenExperiment recorded(const std::string& kind, const RecordRequest& request,
                                const gap::emulate::RecordOptions& options) {
    try {
        return gap::emulate::record(kind, options);
    } catch (const RunError& error) {
        const auto fault = std::find_if(request.changes.begin(), request.changes.end(),
                                        [](const auto& change) { return change.starts_with("uart."); });
        if (fault == request.changes.end()) throw;
        throw InputError("", "--set " + *fault, error.what(),
                         "a line on which most answers arrive: uart.loss and uart.edge_loss are chances of a "
                         "byte, of which an answer has some 80, so 0.001 loses one answer in 13");
    }
}

void record_kind(const std::string& kind, const fs::path& out, const RecordRequest& request,
                 const gap::emulate::RecordOptions& options) {
    const auto experiment = recorded(kind, request, options);
    gap::write_folder(experiment, out);
    std::size_t rows = 0;
    for (const auto& run : experiment.runs)
        rows += run.rows();
    fmt::print("{}: kind {}, {} runs, {} rows\n", out.string(), kind, experiment.runs.size(), rows);
}

/// A change that the recording does not hold would make the verdict "no effect" look like a failure.
void warn_of_unseen(const RecordRequest& request, const std::string& change) {
    const std::string name = change.substr(0, change.find('='));
    const auto kinds = gap::emulate::kinds_showing(name);
    if (kinds.empty() || std::find(kinds.begin(), kinds.end(), request.kind) != kinds.end()) return;
    fmt::print(stderr, "warning: --set {}: a recording of {} does not show {}; kinds that do: {}\n", change,
               request.kind, name, fmt::join(kinds, ", "));
}

void record(const RecordRequest& request) {
    gap::emulate::RecordOptions options;
    options.tools = emulation_tools();
    options.seed = request.seed;
    options.brief = request.brief;
    options.robot.firmware = request.firmware.empty() ? fs::path() : fs::absolute(request.firmware);
    options.robot.rab = request.rab.empty() ? fs::path() : fs::absolute(request.rab);
    for (const std::string& change : request.changes)
        gap::emulate::set_parameter(options.robot, change);
    const bool terminal = ::isatty(STDERR_FILENO) != 0;
    options.done = [terminal](std::size_t done, std::size_t all) {
        log::info("{} of {} runs recorded", done, all);
        if (terminal && !log::wants(log::Level::Info)) fmt::print(stderr, "\r{} of {} runs ", done, all);
    };
    const bool all = request.kind == "all";
    const auto& kinds = gap::emulate::recordable_kinds();
    if (!all && std::find(kinds.begin(), kinds.end(), request.kind) == kinds.end())
        (void)gap::emulate::acts_of(request.kind, request.seed, true);  // says what is wrong
    if (!request.rab.empty() && !all && request.kind != "rab")
        throw InputError("", "--rab-firmware", fmt::format("has no use in a recording of {}", request.kind),
                         "kind rab");
    const auto folder = [&](const std::string& kind) { return all ? request.out / kind : request.out; };
    for (const std::string& kind : kinds)
        if (all || kind == request.kind) refuse_experiment_in(folder(kind));
    prepare_folder(request.out);
    for (const std::string& change : request.changes)
        if (!all) warn_of_unseen(request, change);
    for (const std::string& kind : kinds) {
        if (!all && kind != request.kind) continue;
        options.scratch = folder(kind) / "emulated";
        record_kind(kind, folder(kind), request, options);
    }
}

}  // namespace

gap::emulate::Tools emulation_tools() {
    return {find_program("puckloop-record", "."), shipped_file("firmware/epuck/epuck.hex"),
            shipped_file("firmware/rab/rab.hex")};
}

void declare_gap_record(Command& gap, int& status) {
    Command* command = gap.add_subcommand(
        "record", "Perform an experiment on the emulator, firmware in the loop, and write its folder");
    auto request = std::make_shared<RecordRequest>();
    command
        ->add_option("kind", request->kind,
                     "motion, proximity, ground, microphone, accelerometer, timing, serial, rab or all")
        ->type_name("KIND")
        ->required();
    command
        ->add_option("--out", request->out,
                     "where the experiment goes; what the runs left is in DIR/emulated")
        ->type_name("DIR")
        ->check(not_empty())
        ->required();
    command->add_option("--set", request->changes,
                        "PARAMETER=NUMBER: a physical parameter (puckloop run --list-parameters), "
                        "board.crystal_ppm, host.period, host.rab_poll, uart.factor, uart.loss, uart.delay, "
                        "uart.cut, uart.cut_again, uart.edge_loss, linux.tty_batch, linux.i2c_hold, "
                        "linux.oversleep, linux.oversleep_jitter, tracker.exposure");
    command->add_option("--firmware", request->firmware, "image for the main board (the project's own)")
        ->type_name("IMAGE");
    command
        ->add_option("--rab-firmware", request->rab,
                     "image for the range-and-bearing boards (the project's own)")
        ->type_name("IMAGE");
    command->add_option("--seed", request->seed, "of drives, sensors' noise and the tracker's")
        ->check(count_up_to(kLargestSeed))
        ->type_name("N");
    command->add_flag("--brief", request->brief, "few and short runs: to look at, too few for a verdict");
    declare_log_options(*command, request->log);
    command->callback([request, &status] {
        status = 0;
        start_log("gap", request->log);
        record(*request);
    });
}

}  // namespace puckloop::tools
