// A control loop that has lost its robot's answers gives up, and begins anew some time later. Its frames then
// count their periods from there: what came between is the program's doing, and no other frame shows it.

#include "gap/sync/sync.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace puckloop::gap {

namespace {

constexpr double kPause = 0.5;   // of a period: less is lateness
constexpr double kPeriod = 0.1;  // s, where none is stated

}  // namespace

FrameCount frame_count(const Run& run, std::size_t row) {
    const auto &seq = run.column("seq"), &nominal = run.column("nominal_period");
    return {seq.empty() || std::isnan(seq[row]) ? static_cast<double>(row) : seq[row],
            nominal.empty() || std::isnan(nominal[row]) ? kPeriod : nominal[row]};
}

void find_pauses(Experiment& experiment) {
    if (experiment.kind != Kind::Timing || experiment.has("t_robot_s")) return;
    std::size_t pauses = 0, runs = 0;
    double shortest = std::numeric_limits<double>::infinity(), longest = 0.0;
    for (Run& run : experiment.runs) {
        const auto& host = run.column("t_host_s");
        if (host.empty()) continue;
        std::size_t last = run.rows;
        for (std::size_t row = 0; row < run.rows; ++row) {
            if (std::isnan(host[row])) continue;
            const auto [number, period] = frame_count(run, row);
            if (last < run.rows) {
                const double passed = number - frame_count(run, last).number,
                             late = host[row] - host[last] - passed * period;
                if (passed > 1 && late > kPause * period) {
                    run.begun_anew.push_back(row);
                    shortest = std::min(shortest, late);
                    longest = std::max(longest, late);
                }
            }
            last = row;
        }
        pauses += run.begun_anew.size();
        runs += run.begun_anew.empty() ? 0 : 1;
    }
    if (pauses > 0)
        experiment.caution("the loop paused after broken frames ({} times in {} of {} runs, for {:.3g} to "
                           "{:.3g} s): arrivals are "
                           "counted anew from there, and the pauses themselves are not explained",
                           pauses, runs, experiment.runs.size(), shortest, longest);
}

}  // namespace puckloop::gap
