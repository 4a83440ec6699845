// unifr_epuck2_timing: durations of the stages of an e-puck2 host loop, over WiFi and on a Pi-puck, as JSON
// lists of seconds. From davidfrisch/UNIFR_API_EPUCK, GPL-3.
//
// Lists shorter than the loop count (image and sensor packets by turns, in unknown order) cannot be lined up
// and are left out, as are the start-up times, which are no loop.

#include "base/error.h"
#include "base/json.h"
#include "gap/importers/importers.h"
#include "gap/importers/text_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numeric>

namespace puckloop::gap::importers {

namespace {

using nlohmann::json;

constexpr const char* kFiles = "1_go_on_benchmark/data/results_go_on_*.json";
constexpr double kLongestLeftOut = 0.01;  // share of the loops

/// Total of each loop, over the lists that hold one value a loop.
std::vector<double> loops_of(const std::filesystem::path& file) {
    std::ifstream stream(file);
    json lists;
    try {
        lists = json::parse(stream);
        std::size_t longest = 0;
        for (const auto& [stage, list] : lists.items())
            longest = std::max(longest, list.size());
        if (longest < 10)
            throw InputError(file.string(), "", "has no list of loops", "ten durations or more");
        std::vector<double> total(longest, 0.0);
        for (const auto& [stage, list] : lists.items()) {
            if (list.size() != longest) continue;
            for (std::size_t i = 0; i < longest; ++i) {
                const double duration = list[i].get<double>();
                if (!(duration >= 0) || !std::isfinite(duration))
                    throw InputError(file.string(), fmt::format("{}[{}]", stage, i), "is no duration",
                                     "seconds, not negative");
                total[i] += duration;
            }
        }
        return total;
    } catch (const json::exception& error) {
        throw InputError(file.string(), "", fmt::format("is not what was expected: {}", error.what()),
                         "an object of lists of seconds");
    }
}

double usual_loop(std::vector<double> loops) {
    std::sort(loops.begin(), loops.end());
    const auto kept = static_cast<std::ptrdiff_t>(static_cast<double>(loops.size()) * (1 - kLongestLeftOut));
    return std::accumulate(loops.begin(), loops.begin() + kept, 0.0) / static_cast<double>(kept);
}

WrittenRun read_unifr_run(const std::filesystem::path& file) {
    const std::vector<double> loops = loops_of(file);
    WrittenRun run;
    run.name = file.stem().string().substr(std::string("results_go_on_").size());
    run.constants["nominal_period"] = usual_loop(loops);
    double arrival = 0.0;
    for (const double loop : loops)
        run.row({{"seq", static_cast<double>(run.rows())}, {"t_host_s", arrival += loop}});
    return run;
}

std::vector<WrittenExperiment> read_unifr_timing(const std::filesystem::path& folder) {
    std::vector<WrittenExperiment> all;
    for (const auto& [part, title] : {std::pair{"pipuck", "host loop of an e-puck2 on a Pi-puck"},
                                      std::pair{"wifi", "host loop of an e-puck2 over WiFi"}}) {
        WrittenExperiment e;
        e.folder = fmt::format("unifr_timing_{}", part);
        e.kind = "timing";
        e.title = title;
        e.robot = "e-puck2";
        e.description = "Running sum of the measured stages of each loop; pauses between loops are not "
                        "recorded. The nominal period is the run's own mean (longest 1 % left out): a wrong "
                        "rate cannot be found here, jitter and tails can.";
        e.source = "github.com/davidfrisch/UNIFR_API_EPUCK";
        e.licence = "GPL-3";
        for (const auto& file :
             paths_like(folder, fmt::format("1_go_on_benchmark/data/results_go_on_{}*.json", part)))
            e.runs.push_back(read_unifr_run(file));
        if (!e.runs.empty()) all.push_back(e);
    }
    return all;
}

}  // namespace

const Importer kUnifrTiming{"unifr_epuck2_timing", "durations of an e-puck2 host loop", kFiles, kFiles,
                            read_unifr_timing};

}  // namespace puckloop::gap::importers
