#include "benchmark/speeds/board_replay.h"

#include "base/error.h"
#include "base/json.h"
#include "cosim/interrupt.h"
#include "cosim/resume/state_file.h"
#include "run/factory/node_factory.h"
#include "run/run_scenario.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <ctime>

namespace puckloop::tools {

namespace {

using nlohmann::json;

double thread_seconds() {
    timespec time{};
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    constexpr double kNano = 1e-9;
    return static_cast<double>(time.tv_sec) + kNano * static_cast<double>(time.tv_nsec);
}

bool earlier(const cosim::Message& a, const cosim::Message& b) {
    return a.time < b.time;
}

/// Of what was handed out ahead of its time, nothing counts from the end on.
bool same_sent(std::vector<cosim::Message> sent, const cosim::BoardState& life) {
    using Messages = std::vector<cosim::Message>;
    std::stable_sort(sent.begin(), sent.end(), earlier);
    const Messages& alone = sent;
    const auto end = [&](const Messages& messages) {
        return std::find_if(messages.begin(), messages.end(),
                            [&](const cosim::Message& message) { return message.time >= life.time; });
    };
    return std::equal(alone.begin(), end(alone), life.sent.begin(), end(life.sent));
}

}  // namespace

Recording record_boards(const std::filesystem::path& scenario, double simulated_s,
                        const std::filesystem::path& folder) {
    std::filesystem::create_directories(folder);
    RunRequest request;
    request.scenario = scenario;
    request.out = folder / "recorded";
    request.duration = simulated_s;
    request.in_process = true;
    request.save_state = folder / "boards.state";
    request.save_at = simulated_s;
    const RunSetup setup = set_up(request);
    const cosim::InterruptGuard interrupt;
    const cosim::Outcome outcome = run_scenario(setup, request, {}, &interrupt);
    if (!outcome.success || outcome.reason == cosim::EndReason::Interrupted) throw RunError(outcome.text);
    Recording recording{simulated_s, {}};
    for (cosim::BoardState& life : cosim::read_state_file(request.save_state).boards) {
        const auto node = std::find_if(setup.nodes.begin(), setup.nodes.end(),
                                       [&](const PlannedNode& spec) { return spec.name == life.board.node; });
        NodeDescription description = without_files(node->what);
        description.care = {};
        life.memory = {};
        recording.boards.push_back({std::move(description), std::move(life)});
    }
    return recording;
}

ReplayTiming replay_boards(const Recording& recording) {
    using Clock = std::chrono::steady_clock;
    ReplayTiming timing;
    for (const RecordedBoard& recorded : recording.boards) {
        const auto board = make_board(recorded.description);
        std::vector<cosim::Message> sent;
        const double cpu = thread_seconds();
        const auto start = Clock::now();
        board->advance(recorded.life.time, recorded.life.received, sent);
        timing.wall_s += std::chrono::duration<double>(Clock::now() - start).count();
        timing.cpu_s += thread_seconds() - cpu;
        if (!same_sent(std::move(sent), recorded.life))
            throw RunError(
                fmt::format("{} alone sends something else than it did in the run", board->name()));
        const json report = json::parse(board->finish());
        timing.instructions += report.value("instructions", std::uint64_t{0});
        timing.cycles += report.value("cycles", std::uint64_t{0});
    }
    return timing;
}

}  // namespace puckloop::tools
