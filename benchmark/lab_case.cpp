// The case "lab20" of `puckloop bench`: a laboratory's twenty robots, and what their cost is made of.

#include "benchmark/case_kit.h"
#include "benchmark/scenarios/lab_scenario.h"
#include "benchmark/speeds/work_profile.h"
#include "emu/dspic/chip/core_bench.h"

#include <fmt/format.h>

#include <cstdlib>

namespace puckloop::tools {

namespace {

// Of `--duration`, after the start of the programs.
constexpr double kLabShare = 0.05;
// Until the boards with the project's own images are ready.
constexpr double kOwnStart = 0.1;
// epuck_firmware.hex waits twice 17.6 s at its start, and is ready for its program then.
constexpr double kOriginalStart = 42.0;
// Programs start within 0.1 s, and look for their boards in as long.
constexpr double kSettling = 0.2;

struct Lab {
    std::string name;
    LabSpec spec;
};

/// With the project's own images, and with original ones where they are: of the range-and-bearing board, and
/// with a program for it of the main board, too.
std::vector<Lab> labs(const Kit& kit) {
    const BenchOptions& options = kit.options();
    std::vector<Lab> all{{"own images", {20, Kit::main_image(), kit.rab_image(), {}, kOwnStart}}};
    const char* folder = std::getenv("PUCKLOOP_IMAGES");
    if (folder == nullptr) return all;
    const std::filesystem::path images(folder);
    const auto rab = images / "erab_1to4b.hex", main = images / "epuck_firmware.hex";
    if (!std::filesystem::exists(rab)) return all;
    all.push_back({"erab_1to4b.hex", {20, Kit::main_image(), rab, {}, kOwnStart}});
    if (!options.program.empty() && std::filesystem::exists(main))
        all.push_back({"original images", {20, main, rab, options.program, kOriginalStart}});
    return all;
}

}  // namespace

/// Figures of a profile, a row each: for one node of its kind and a simulated second.
void Kit::add_profile(const std::string& title, const WorkProfile& profile) {
    constexpr double kThousand = 1e-3, kMillion = 1e-6;
    for (const KindWork& work : profile.kinds)
        for (const auto& [name, count] : work.counts)
            figures_.push_back({fmt::format("{}, {}: {}", title, work.kind, name),
                                "k a node and s",
                                {kThousand * count / static_cast<double>(work.nodes) / profile.simulated_s},
                                {},
                                {}});
    for (const auto& [link, count] : profile.messages)
        figures_.push_back({fmt::format("{}, messages by {}", title, link),
                            "k a s",
                            {kThousand * count / profile.simulated_s},
                            {},
                            {}});
    const double needed = profile.instructions_needed() / profile.simulated_s;
    const double speed = dspic::bench_compute_loop(options_.slice_s).instructions_per_second();
    figures_.push_back({title + ", instructions to be executed", "M a s", {kMillion * needed}, {}, {}});
    figures_.push_back(
        {title + ", their time on the bare core", "s / simulated s", {needed / speed}, {}, {}});
}

void Kit::time_lab20() {
    int number = 0;
    for (const Lab& lab : labs(*this)) {
        const std::string title = "lab20, " + lab.name;
        const auto scenario = write_lab_scenario(folder_ / fmt::format("lab{}", ++number), lab.spec);
        const RunSpec spec{scenario, lab.spec.start_s + kSettling + kLabShare * options_.simulated_s, true,
                           options_.threads};
        Figure speed{title, "x real time", {}, {}, {}};
        Figure cost{title + ", processor time", "s / simulated s", {}, {}, {}};
        for (int round = 0; round < options_.rounds; ++round) {
            add_reference(speed);
            const RunTiming own = own_run(spec);
            speed.values.push_back(own.real_time_factor());
            cost.values.push_back(own.program.cpu_s / own.simulated_s);
            const auto peer = peer_run(spec, own, speed);
            if (!peer) continue;
            speed.peers.push_back(peer->real_time_factor());
            cost.peers.push_back(peer->program.cpu_s / peer->simulated_s);
        }
        figures_.insert(figures_.end(), {speed, cost});
        RunRequest request;
        request.scenario = scenario;
        request.out = folder_ / "profiled";
        request.duration = spec.simulated_s;
        request.in_process = true;
        request.threads = 1;
        add_profile(title, profile_work(request));
    }
}

}  // namespace puckloop::tools
