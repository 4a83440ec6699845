// The case "wait" of `puckloop bench`: images on the main board that wait for a partner who sends nothing.

#include "base/error.h"
#include "base/files/shipped_files.h"
#include "base/json.h"
#include "benchmark/case_kit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

namespace puckloop::tools {

namespace {

/// Of simulated time: by then epuck_firmware.hex, which resets itself once, is through its second delay.
constexpr double kBootSeconds = 41.0;

/// Of a run's wall time: less than this is the clock's noise.
constexpr double kLeastShare = 1e-3;

struct Waiting {
    double wall_s = 0;
    nlohmann::json work;  ///< what was executed, to be the same for every build
};

Waiting time_exec(const std::filesystem::path& program, const std::filesystem::path& image,
                  double simulated_s, bool interpret) {
    std::vector<std::string> words{program.string(),
                                   "exec",
                                   "--board",
                                   "pic",
                                   image.string(),
                                   "--seconds",
                                   fmt::format("{}", simulated_s),
                                   "--json"};
    if (interpret) words.emplace_back("--no-translate");
    const ProgramTiming timing = time_program(words);
    const auto report = nlohmann::json::parse(timing.output, nullptr, false);
    if (!report.is_object()) throw RunError(fmt::format("{} wrote no report", program.string()));
    return {report.at("wall_s"), {report.at("cycles"), report.at("instructions"), report.at("pc")}};
}

}  // namespace

void Kit::time_waiting() {
    std::vector<std::filesystem::path> images{main_image()};
    if (const char* folder = std::getenv("PUCKLOOP_IMAGES")) {
        const auto original = std::filesystem::path(folder) / "epuck_firmware.hex";
        if (std::filesystem::exists(original)) images.push_back(original);
    }
    const double waits_s = options_.simulated_s;
    for (const auto& image : images) {
        const std::string name = image.filename().string();
        Figure whole{
            fmt::format("{}, {} s from power-up", name, kBootSeconds + waits_s), "x real time", {}, {}, {}};
        Figure waits{fmt::format("{}, its last {} s", name, waits_s), "x real time", {}, {}, {}};
        for (int round = 0; round < options_.rounds; ++round) {
            add_reference(whole);
            waits.references.push_back(whole.references.back());
            const auto time = [&](const std::filesystem::path& program, bool interpret,
                                  std::vector<double>& all, std::vector<double>& rest) {
                const Waiting boot = time_exec(program, image, kBootSeconds, interpret);
                const Waiting run = time_exec(program, image, kBootSeconds + waits_s, interpret);
                all.push_back((kBootSeconds + waits_s) / run.wall_s);
                rest.push_back(waits_s / std::max(run.wall_s - boot.wall_s, kLeastShare * run.wall_s));
                return run.work;
            };
            const nlohmann::json own = time(main_program(), options_.interpret, whole.values, waits.values);
            if (options_.peer.empty() || (!whole.note.empty() && whole.peers.empty())) continue;
            try {
                if (time(options_.peer, false, whole.peers, waits.peers) != own)
                    whole.note = "the peer executed something else";
            } catch (const RunError& error) {
                whole.note = fmt::format("not run by the peer: {}", error.what());
            }
        }
        figures_.push_back(whole);
        figures_.push_back(waits);
    }
}

}  // namespace puckloop::tools
