#include "benchmark/case_kit.h"

#include "base/error.h"
#include "base/files/shipped_files.h"
#include "benchmark/measures/process_memory.h"
#include "benchmark/measures/reference.h"
#include "benchmark/scenarios/wander_scenario.h"
#include "benchmark/speeds/board_replay.h"
#include "benchmark/speeds/mark_speed.h"
#include "benchmark/speeds/rab_speed.h"
#include "emu/dspic/chip/core_bench.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <set>
#include <tuple>

namespace puckloop::tools {

namespace {

constexpr const char* kRealTime = "x real time";

}  // namespace

Kit::Kit(const BenchOptions& options)
    : options_(options),
      folder_(std::filesystem::temp_directory_path() / fmt::format("puckloop_bench_{}", ::getpid())) {
    std::filesystem::create_directories(folder_);
}

Kit::~Kit() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
}

std::filesystem::path Kit::shipped(const std::string& scenario) {
    return shipped_file("scenarios/" + scenario);
}

std::filesystem::path Kit::main_image() {
    return shipped_file("firmware/epuck/epuck.hex");
}

std::filesystem::path Kit::rab_image() const {
    return options_.rab_image.empty() ? shipped_file("firmware/rab/rab.hex") : options_.rab_image;
}

void Kit::add_reference(Figure& figure) const {
    figure.references.push_back(reference_speed(options_.slice_s / 4));
}

void Kit::time_speeds(const std::string& bench_case, const std::vector<Speed>& speeds) {
    std::vector<Figure> figures;
    for (const Speed& speed : speeds)
        figures.push_back({speed.name, speed.unit, {}, {}, {}});
    std::vector<std::string> words{
        options_.peer.string(), "bench", "--case", bench_case, "--rounds", "1", "--json", "--rab-image",
        rab_image().string()};
    if (!options_.image.empty()) words.insert(words.end(), {"--image", options_.image.string()});
    for (int round = 0; round < options_.rounds; ++round) {
        for (std::size_t i = 0; i < speeds.size(); ++i) {
            add_reference(figures[i]);
            figures[i].values.push_back(speeds[i].once());
        }
        if (options_.peer.empty()) continue;
        const std::string json = time_program(words).output;
        for (Figure& figure : figures) {
            if (!figure.note.empty()) continue;
            try {
                figure.peers.push_back(median_in(json, figure.name));
            } catch (const RunError& error) {
                figure.note = error.what();
            }
        }
    }
    figures_.insert(figures_.end(), figures.begin(), figures.end());
}

void Kit::time_core() {
    const auto millions = [](const dspic::CoreBenchResult& result) {
        return result.instructions_per_second() * 1e-6;
    };
    const double slice = options_.slice_s;
    const std::string image = options_.image.string();
    std::vector<Speed> speeds{{"core, compute loop", "M instructions/s",
                               [=] { return millions(dspic::bench_compute_loop(slice)); }}};
    if (!image.empty()) {
        speeds.push_back({"core, image, every cycle", "M instructions/s",
                          [=] { return millions(dspic::bench_image(image, slice)); }});
        speeds.push_back({"chip, image, idle skipped", kRealTime, [=] {
                              constexpr double kCyclesPerSecond = 14'745'600.0;  // FCY of the e-puck
                              const auto result = dspic::bench_image(image, slice, true);
                              return static_cast<double>(result.cycles) / kCyclesPerSecond / result.wall_s;
                          }});
    }
    time_speeds("core", speeds);
}

void Kit::time_boards() {
    // The chosen firmware for the board, and the original where somebody has it.
    std::vector<std::filesystem::path> images{rab_image()};
    if (const char* folder = std::getenv("PUCKLOOP_IMAGES")) {
        const std::filesystem::path original = std::filesystem::path(folder) / "randb.hex";
        if (std::filesystem::exists(original)) images.push_back(original);
    }
    std::vector<Speed> speeds;
    for (const auto& [work, title] :
         {std::pair{RabWork::Idle, "idle"}, std::pair{RabWork::Sending, "sending"}})
        for (const std::filesystem::path& image : images)
            speeds.push_back(
                {fmt::format("rab board, {}, {}", title, image.filename().string()), kRealTime,
                 [=, work = work, slice = options_.slice_s] { return rab_board_speed(image, work, slice); }});
    for (const auto& [board, path, title] : {std::tuple{MarkedBoard::Main, main_image(), "main board"},
                                             std::tuple{MarkedBoard::Rab, rab_image(), "rab board"}})
        for (const auto& [what, verb] :
             {std::pair{GoingBack::Mark, "marked"}, std::pair{GoingBack::Rewind, "taken back"}})
            speeds.push_back({fmt::format("{}, {}", title, verb), "times a us",
                              [=, board = board, path = path, what = what, slice = options_.slice_s] {
                                  return mark_speed(path, board, what, slice);
                              }});
    time_speeds("board", speeds);
}

RunTiming Kit::own_run(const RunSpec& given, const std::function<void(pid_t)>& watch) const {
    RunSpec spec = given;
    if (options_.interpret) spec.options.emplace_back("--no-translate");
    return time_run(main_program(), spec, folder_ / "own", watch);
}

std::optional<RunTiming> Kit::peer_run(const RunSpec& spec, const RunTiming& own, Figure& figure) const {
    if (options_.peer.empty() || (!figure.note.empty() && figure.peers.empty())) return std::nullopt;
    try {
        const RunTiming peer = time_run(options_.peer, spec, folder_ / "peer");
        if (peer.trace_sha256 != own.trace_sha256) figure.note = "the peer's trace is another one";
        return peer;
    } catch (const RunError& error) {
        figure.note = fmt::format("not run by the peer: {}", error.what());
        return std::nullopt;
    }
}

void Kit::time_runs(const std::string& name, const RunSpec& spec) {
    Figure figure{name, kRealTime, {}, {}, {}};
    for (int round = 0; round < options_.rounds; ++round) {
        add_reference(figure);
        const RunTiming own = own_run(spec);
        figure.values.push_back(own.real_time_factor());
        if (const auto peer = peer_run(spec, own, figure)) figure.peers.push_back(peer->real_time_factor());
    }
    figures_.push_back(figure);
}

void Kit::time_overhead(const std::string& name, const std::filesystem::path& scenario, double simulated_s) {
    const Recording recording = record_boards(scenario, simulated_s, folder_ / "recording");
    struct Way {
        RunSpec spec;
        Figure run, factor, cpu;
    };
    // The boards alone take one thread; a run with several may be quicker than them by that alone.
    std::vector<Way> ways;
    for (const unsigned threads : std::set<unsigned>{1, options_.threads}) {
        const std::string title = name + (threads == 1 ? ", 1 thread" : "");
        ways.push_back({{scenario, simulated_s, true, threads},
                        {title, kRealTime, {}, {}, {}},
                        {title + ", overhead factor", "x boards alone", {}, {}, {}},
                        {title + ", overhead in processor time", "x boards alone", {}, {}, {}}});
    }
    Figure alone{name + ", boards alone", kRealTime, {}, {}, {}};
    for (int round = 0; round < options_.rounds; ++round) {
        add_reference(alone);
        const ReplayTiming replay = replay_boards(recording);
        alone.values.push_back(recording.simulated_s / replay.wall_s);
        const auto cpu_factor = [&](const RunTiming& timing) {
            return timing.program.cpu_s / timing.simulated_s / (replay.cpu_s / recording.simulated_s);
        };
        for (Way& way : ways) {
            const RunTiming own = own_run(way.spec);
            way.run.references.push_back(alone.references.back());
            way.run.values.push_back(own.real_time_factor());
            way.factor.values.push_back(alone.values.back() / own.real_time_factor());
            way.cpu.values.push_back(cpu_factor(own));
            const auto peer = peer_run(way.spec, own, way.run);
            if (!peer) continue;
            way.run.peers.push_back(peer->real_time_factor());
            way.factor.peers.push_back(alone.values.back() / peer->real_time_factor());
            way.cpu.peers.push_back(cpu_factor(*peer));
        }
    }
    figures_.push_back(alone);
    for (const Way& way : ways)
        figures_.insert(figures_.end(), {way.run, way.factor, way.cpu});
}

void Kit::time_growth(double simulated_s) {
    struct Size {
        int robots;
        RunSpec spec;
        Figure speed, cost, relative, around;
    };
    std::vector<Size> sizes;
    for (const int robots : options_.robots) {
        const auto scenario = write_wander_scenario(folder_ / "scenario", robots, main_image());
        const std::string name = fmt::format("wander, {} robot{}", robots, robots == 1 ? "" : "s");
        sizes.push_back({robots,
                         {scenario, simulated_s, true, options_.threads},
                         {name, kRealTime, {}, {}, {}},
                         {name + ", wall time a robot", "ms / simulated s", {}, {}, {}},
                         {fmt::format("{}, to {}", name, options_.robots[0]), "x wall a robot", {}, {}, {}},
                         {name + ", start-up and report", "s", {}, {}, {}}});
    }
    constexpr double kMilliseconds = 1e3;
    for (int round = 0; round < options_.rounds; ++round)
        for (Size& size : sizes) {
            add_reference(size.speed);
            const RunTiming own = own_run(size.spec);
            size.speed.values.push_back(own.real_time_factor());
            size.cost.values.push_back(kMilliseconds / own.real_time_factor() / size.robots);
            size.relative.values.push_back(size.cost.values.back() / sizes[0].cost.values.back());
            size.around.values.push_back(own.program.wall_s - own.wall_s);
            const auto peer = peer_run(size.spec, own, size.speed);
            if (!peer) continue;
            size.speed.peers.push_back(peer->real_time_factor());
            size.cost.peers.push_back(kMilliseconds / peer->real_time_factor() / size.robots);
            size.around.peers.push_back(peer->program.wall_s - peer->wall_s);
        }
    for (Size& size : sizes)
        figures_.insert(figures_.end(), {size.speed, size.cost, size.relative, size.around});
}

void Kit::weigh(double simulated_s) {
    std::vector<Figure> peaks;
    for (const int robots : options_.robots) {
        const auto scenario = write_wander_scenario(folder_ / "scenario", robots, main_image());
        Figure peak{fmt::format("peak memory, {} wandering", robots), "MB", {}, {}, {}};
        for (int round = 0; round < options_.rounds; ++round) {
            double most = 0;
            const auto watch = [&](pid_t process) { most = std::max(most, resident_mbytes(process)); };
            const RunSpec spec{scenario, simulated_s, true, options_.threads};
            own_run(spec, watch);
            peak.values.push_back(most);
            if (options_.peer.empty() || !peak.note.empty()) continue;
            most = 0;
            try {
                time_run(options_.peer, spec, folder_ / "peer", watch);
                peak.peers.push_back(most);
            } catch (const RunError& error) {
                peak.note = fmt::format("not run by the peer: {}", error.what());
            }
        }
        peaks.push_back(peak);
    }
    const std::vector<int>& robots = options_.robots;
    Figure each{
        fmt::format("memory a robot, from {} to {}", robots.front(), robots.back()), "MB", {}, {}, {}};
    const int more = robots.back() - robots.front();
    for (int round = 0; more != 0 && round < options_.rounds; ++round) {
        const auto i = static_cast<std::size_t>(round);
        each.values.push_back((peaks.back().values[i] - peaks.front().values[i]) / more);
    }
    figures_.insert(figures_.end(), peaks.begin(), peaks.end());
    figures_.push_back(each);
}

}  // namespace puckloop::tools
