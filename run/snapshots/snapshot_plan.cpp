#include "run/snapshots/snapshot_plan.h"

#include "base/error.h"
#include "cosim/resume/run_snapshot.h"
#include "cosim/resume/snapshot_faults.h"
#include "cosim/resume/state_file.h"
#include "run/files/writable_file.h"
#include "run/nodes/linux_nodes.h"
#include "run/snapshots/origin.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>

namespace puckloop::tools {

namespace {

namespace fs = std::filesystem;

/// Options of `request` that a snapshot has already; empty: none.
std::string decided_by_snapshot(const RunRequest& request) {
    if (!request.scenario.empty()) return "a scenario";
    if (!request.firmware.empty()) return "--firmware";
    if (!request.linux_command.empty()) return "--linux";
    if (!request.overlay.empty()) return "--model";
    if (!request.events.empty()) return "--events";
    if (request.seed) return "--seed";
    return {};
}

void plan_saving(RunSetup& setup, const RunRequest& request) {
    for (const double at : request.snapshot_at) {
        if (setup.scenario.duration && at > *setup.scenario.duration)
            throw InputError(
                "", "--save-at",
                fmt::format("{:g} s is after the end of the run, {:g} s", at, *setup.scenario.duration),
                "a time within the run");
        if (request.snapshot && cosim::from_seconds(at) <= request.snapshot->time)
            throw InputError("", "--save-at",
                             fmt::format("{:g} s is not after the snapshot that the run goes on from, {:g} s",
                                         at, cosim::to_seconds(request.snapshot->time)));
        check_writable(snapshot_file(request, at));
    }
    if (request.realtime && programs_of(setup.scenario) > 0)
        throw InputError("", "--save-at", "what Linux programs do in real time cannot be repeated",
                         "--paced, where they stay in simulated time");
}

/// Live ends heard what they heard; from the snapshot on they are there again.
void quiet_outside(RunSetup& setup, cosim::Time until) {
    setup.ready = std::max(setup.ready, until);
    for (PlannedNode& node : setup.nodes)
        if (auto* outside = std::get_if<OutsideSpec>(&node.what.kind)) outside->quiet = until;
}

void check_faults(const cosim::RunSnapshot& snapshot, const RunSetup& setup, const std::string& file) {
    try {
        cosim::check_link_faults(snapshot, setup.links, setup.scenario.faults, setup.scenario.seed);
    } catch (const InputError& error) {
        throw InputError(file, "", error.what());
    }
}

}  // namespace

RunRequest going_on(const RunRequest& request) {
    const std::string file = request.from.string();
    if (const std::string option = decided_by_snapshot(request); !option.empty())
        throw InputError("", "--from",
                         fmt::format("goes on with the run of {}, whatever {} gives", file, option),
                         "--from without it");
    if (!request.save_state.empty() || !request.from_state.empty())
        throw InputError("", "--from", "does not go with saved states of boards", "one of them");
    if (request.record)
        throw InputError("", "--record", "a run from a snapshot lacks the messages before it",
                         "--record on a whole run");
    const auto snapshot = std::make_shared<cosim::RunSnapshot>(cosim::read_snapshot(request.from));
    RunRequest all = request_from(snapshot->origin, request, file);
    if (all.realtime)
        throw InputError("", "--from", "a run in real time cannot begin in its middle",
                         "--paced, where Linux programs stay in simulated time");
    all.snapshot = snapshot;
    return all;
}

fs::path snapshot_file(const RunRequest& request, double time) {
    if (request.save_name) return request.save_name(time);
    if (request.snapshot_at.size() == 1) return fs::absolute(request.save);
    fs::path file = request.save;
    const std::string ending = file.extension().string();
    file.replace_extension();
    return fs::absolute(file.string() + fmt::format("-{}s", time) + ending);
}

void plan_snapshots(RunSetup& setup, const RunRequest& request) {
    if (request.save.empty() != request.snapshot_at.empty())
        throw InputError("", request.save.empty() ? "--save-at" : "--save", "one goes with the other",
                         "--save-at TIME --save FILE");
    if (!request.save.empty()) plan_saving(setup, request);
    if (!request.snapshot) return;
    const std::string file = request.from.string();
    if (!request.from.empty()) setup.from = fs::absolute(request.from);
    setup.from_time = request.snapshot->time;
    if (!request.same_origin) {
        check_origin(request.snapshot->origin, setup, request.snapshot->time, file);
        check_faults(*request.snapshot, setup, file);
    }
    if (setup.scenario.duration && cosim::from_seconds(*setup.scenario.duration) < request.snapshot->time)
        throw InputError("", "--duration",
                         fmt::format("{:g} s is before the snapshot, {:g} s", *setup.scenario.duration,
                                     cosim::to_seconds(request.snapshot->time)));
    if (request.paced) quiet_outside(setup, request.snapshot->time);
}

void use_snapshots(const RunSetup& setup, const RunRequest& request,
                   std::optional<cosim::TraceCsvSink>& trace, cosim::RunOptions& options) {
    for (const double at : request.snapshot_at)
        options.save_at.push_back(cosim::from_seconds(at));
    std::sort(options.save_at.begin(), options.save_at.end());
    options.from = request.snapshot.get();
    if (options.save_at.empty()) return;
    // Now, not when it is due: files may change under a run.
    options.save = [&request, &trace, origin = origin_of(setup, request)](cosim::RunSnapshot& snapshot) {
        snapshot.build = cosim::build_id();
        snapshot.origin = origin;
        snapshot.trace = trace->written();
        const auto at = std::find_if(request.snapshot_at.begin(), request.snapshot_at.end(),
                                     [&](double time) { return cosim::from_seconds(time) == snapshot.time; });
        cosim::write_snapshot(snapshot_file(request, *at), snapshot);
    };
}

void judge_snapshots(const RunRequest& request, cosim::Outcome& outcome) {
    for (const double at : request.snapshot_at) {
        if (outcome.simulated >= cosim::from_seconds(at) || !outcome.success) continue;
        outcome.success = false;
        outcome.text = fmt::format("no snapshot at {:g} s: the run ended at {:.3f} s", at,
                                   cosim::to_seconds(outcome.simulated));
    }
}

std::string snapshots_summary(const RunRequest& request, const cosim::Outcome& outcome) {
    std::string text;
    if (request.snapshot)
        text +=
            fmt::format("\nwent on from {:g} s ({}), after {:.2f} s",
                        cosim::to_seconds(request.snapshot->time), request.from.string(), outcome.restored_s);
    // A run whose snapshot could not be written has failed at that instant.
    for (const double at : request.snapshot_at)
        if (outcome.simulated > cosim::from_seconds(at) ||
            (outcome.success && outcome.simulated == cosim::from_seconds(at)))
            text += fmt::format("\nsnapshot of {:g} s in {}", at, snapshot_file(request, at).string());
    return text;
}

}  // namespace puckloop::tools
