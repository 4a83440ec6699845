#include "run/plan/state_plan.h"

#include "base/error.h"
#include "base/json.h"
#include "cosim/resume/state_file.h"
#include "run/factory/node_factory.h"
#include "run/files/writable_file.h"
#include "run/states/board_identity.h"
#include "run/states/boot_cache.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace puckloop::tools {

namespace {

using cosim::BoardIdentity;
using cosim::BoardState;
using cosim::Time;
using nlohmann::json;
namespace fs = std::filesystem;

// A program that starts earlier finds its board ready without anybody waiting for it.
constexpr double kShortestBoot = 5.0;  // s

/// How long the user has to wait for a robot's main board: what the scenario states, or until the robot's
/// program starts.
Time boot_of(const scenarios::RobotBoards& robot) {
    if (robot.pic.boot) return cosim::from_seconds(*robot.pic.boot);
    if (robot.linux_board && robot.linux_board->start >= kShortestBoot)
        return cosim::from_seconds(robot.linux_board->start);
    return 0;
}

std::string part_of(const fs::path& file, const std::string& node) {
    return fmt::format("{}.{}.part", file.string(), node);
}

/// The state in `file` for a board: its own by name, else the only one of its kind. Null: none of its kind.
const BoardState* state_for(const cosim::StateFile& file, const BoardIdentity& board, const fs::path& path) {
    const BoardState* found = nullptr;
    std::string others;
    for (const BoardState& state : file.boards) {
        if (state.board.kind != board.kind) continue;
        if (state.board.node == board.node) {
            found = &state;
            others.clear();
            break;
        }
        found = &state;
        others += (others.empty() ? "" : ", ") + state.board.node;
    }
    if (others.find(',') != std::string::npos)
        throw InputError(path.string(), board.node, fmt::format("has {}, none for this board", others),
                         "a state by this name, or one only of a " + board.kind);
    if (!found) return nullptr;
    if (found->board.chip != board.chip)
        throw InputError(path.string(), found->board.node, "a state of the chip " + found->board.chip,
                         "one of the " + board.chip);
    constexpr std::size_t kShown = 16;
    if (found->board.image != board.image)
        throw InputError(
            path.string(), found->board.node,
            fmt::format("a state of other firmware, SHA-256 {}...", found->board.image.substr(0, kShown)),
            fmt::format("{}... for {}", board.image.substr(0, kShown), board.node));
    return found;
}

/// Loads it once, so that what does not fit is refused before the run.
void try_out(const NodeDescription& spec, const BoardState& state, const fs::path& path) {
    const auto board = make_board(without_files(spec));
    try {
        StateReader reader(state.memory);
        board->state(reader);
        reader.end();
    } catch (const StateError& error) {
        throw InputError(path.string(), state.board.node, error.what(),
                         "a state of this version of puckloop");
    }
}

void start_from_file(RunSetup& setup, const RunRequest& request) {
    const fs::path path = fs::absolute(request.from_state);
    const cosim::StateFile file = cosim::read_state_file(path);
    bool used = false;
    for (PlannedNode& node : setup.nodes) {
        if (!has_board(node.what)) continue;
        const BoardIdentity board = identity_of(node.what);
        const BoardState* state = state_for(file, board, path);
        if (!state) {
            setup.warnings.push_back(
                fmt::format("{}: {} has no state for it: it starts from power-up", node.name, path.string()));
            continue;
        }
        if (request.save_at && cosim::from_seconds(*request.save_at) < state->time)
            throw InputError(
                "", "--at",
                fmt::format("{:g} s is before the state that {} starts from", *request.save_at, node.name),
                fmt::format("{:g} s or later", cosim::to_seconds(state->time)));
        try_out(node.what, *state, path);
        if (const std::string names = other_parameters(state->board, node.what); !names.empty())
            setup.warnings.push_back(fmt::format(
                "{}: its state was saved with another {}: clock, signals and modules go on as saved",
                node.name, names));
        node.what.care.from_state = FromState{.path = path.string(), .board = state->board.node};
        setup.ready = std::max(setup.ready, state->time);
        used = true;
    }
    if (!used) throw InputError(path.string(), "", "has no state for any board of this scenario");
}

void save_to_file(RunSetup& setup, const RunRequest& request) {
    const fs::path path = fs::absolute(request.save_state);
    check_writable(path);
    if (setup.scenario.duration && *request.save_at > *setup.scenario.duration)
        throw InputError("", "--at",
                         fmt::format("{:g} s is after the end of the run, {:g} s", *request.save_at,
                                     *setup.scenario.duration),
                         "a time within the run");
    setup.save_state = path;
    setup.save_at = cosim::from_seconds(*request.save_at);
    for (PlannedNode& node : setup.nodes) {
        if (!has_board(node.what)) continue;
        const std::string part = part_of(path, node.name);
        std::error_code ignored;
        fs::remove(part, ignored);
        node.what.care.save_state = SaveState{part, setup.save_at};
    }
    const auto check = [&](const std::string& name, const std::optional<scenarios::LinuxBoard>& board) {
        if (board && board->start < *request.save_at)
            setup.warnings.push_back(fmt::format(
                "{}.linux: runs already at {:g} s and is not part of the state, which holds boards only",
                name, *request.save_at));
    };
    for (const scenarios::RobotBoards& robot : setup.scenario.robots)
        check(robot.name, robot.linux_board);
    if (setup.scenario.coordinator) check("coordinator", setup.scenario.coordinator->program);
}

/// What the boards sense is of this world; where it is recorded does not matter, nor how it is paced.
std::string world_text(const RunSetup& setup) {
    physics::World world = setup.scenario.world;
    world.recording = {};
    physics::EventPlan events = setup.scenario.events;
    events.live = events.repeats = false;
    events.journal.clear();
    return physics::to_json(world) + physics::to_json(events);
}

void use_cache(RunSetup& setup, const RunRequest& request) {
    const std::optional<CacheFolder> folder = cache_folder();
    const std::string world = world_text(setup);
    bool prepared = false;
    for (const scenarios::RobotBoards& robot : setup.scenario.robots) {
        const Time boot = boot_of(robot);
        const Time end =
            setup.scenario.duration ? cosim::from_seconds(*setup.scenario.duration) : cosim::kNever;
        if (boot <= 0 || boot > end) continue;
        setup.ready = std::max(setup.ready, boot);
        // In a run that is saved or goes on, every board is as it is.
        if (!folder || !request.cache || !request.save.empty() || request.snapshot) continue;
        for (PlannedNode& node : setup.nodes) {
            if (node.name != robot.name + ".pic") continue;
            // Memory that lasts comes from its own file.
            if (!robot.pic.nvm.empty()) continue;
            if (!prepared) {
                if (const std::string problem = prepare_cache(folder->path); !problem.empty()) {
                    setup.cache_unused =
                        fmt::format("boot cache {}{}: boots are executed",
                                    folder->path.empty() ? "" : folder->path.string() + ": ", problem);
                    // Homes that cannot be written to are usual on build servers, and no fault of the robots.
                    if (folder->asked_for) setup.warnings.push_back(setup.cache_unused);
                    return;
                }
                prepared = true;
            }
            const std::string file = cached_boot(folder->path, identity_of(node.what), boot, world).string();
            node.what.care.from_state = FromState{.path = file, .cache = true};
            node.what.care.save_state = SaveState{file, boot};
        }
    }
}

}  // namespace

void plan_states(RunSetup& setup, const RunRequest& request) {
    if (!request.save_state.empty() != request.save_at.has_value())
        throw InputError("", request.save_at ? "--at" : "--save-state", "one goes with the other",
                         "--save-state FILE --at TIME");
    if (!request.from_state.empty()) start_from_file(setup, request);
    if (!request.save_state.empty()) save_to_file(setup, request);
    if (request.from_state.empty() && request.save_state.empty()) use_cache(setup, request);
    if (!request.realtime && !request.paced) setup.ready = 0;
    if (setup.ready == 0) return;
    for (PlannedNode& node : setup.nodes)
        if (auto* outside = std::get_if<OutsideSpec>(&node.what.kind)) outside->quiet = setup.ready;
}

void collect_states(const RunSetup& setup, cosim::Outcome& outcome) {
    if (setup.save_state.empty()) return;
    cosim::StateFile file{cosim::build_id(), {}};
    std::error_code ignored;
    bool complete = true;
    for (const PlannedNode& node : setup.nodes) {
        if (!has_board(node.what)) continue;
        const fs::path part = part_of(setup.save_state, node.name);
        try {
            if (fs::exists(part)) {
                for (BoardState& state : cosim::read_state_file(part).boards)
                    file.boards.push_back(std::move(state));
            } else {
                complete = false;
            }
        } catch (const InputError&) {
            complete = false;
        }
        fs::remove(part, ignored);
    }
    const auto fail = [&](const std::string& text) {
        if (outcome.success) outcome.text = text;
        outcome.success = false;
    };
    if (!complete)
        return fail(fmt::format("no state saved: the run ended at {:.3f} s, before {:.3f} s",
                                cosim::to_seconds(outcome.simulated), cosim::to_seconds(setup.save_at)));
    try {
        cosim::write_state_file(setup.save_state, file);
    } catch (const RunError& error) {
        fail(error.what());
    }
}

std::string states_summary(const RunSetup& setup, const cosim::Outcome& outcome) {
    std::string text;
    for (const auto& node : outcome.nodes) {
        if (node.json.empty()) continue;
        const json report = json::parse(node.json);
        if (!report.contains("resumed")) continue;
        const json& resumed = report["resumed"];
        const double at = resumed.at("at_s");
        if (resumed.at("from") == "file")
            text += fmt::format("\n{}: from its state at {:g} s", node.name, at);
        else if (resumed.at("skipped") == true)
            text += fmt::format("\n{}: boot of {:g} s skipped, from cache", node.name, at);
        else if (resumed.contains("difference"))
            text += fmt::format("\n{}: boot executed: it {}, unlike the one in the cache", node.name,
                                resumed["difference"].get<std::string>());
    }
    if (!setup.save_state.empty() && outcome.success)
        text += fmt::format("\nstate of the boards at {:g} s in {}", cosim::to_seconds(setup.save_at),
                            setup.save_state.string());
    return text;
}

}  // namespace puckloop::tools
