#include "gap/sync/pauses.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace puckloop::gap {

namespace {

constexpr double kPause = 0.5;   // of a period: less is lateness
constexpr double kPeriod = 0.1;  // s, where none is stated

}  // namespace

void find_pauses(Experiment& experiment) {
    if (experiment.kind != Kind::Timing || experiment.has("t_robot_s")) return;
    std::size_t pauses = 0, runs = 0;
    double shortest = std::numeric_limits<double>::infinity(), longest = 0.0;
    for (Run& run : experiment.runs) {
        const auto &host = run.column("t_host_s"), &seq = run.column("seq"),
                   &nominal = run.column("nominal_period");
        if (host.empty()) continue;
        const auto number = [&](std::size_t row) {
            return seq.empty() || std::isnan(seq[row]) ? static_cast<double>(row) : seq[row];
        };
        std::size_t last = run.rows;
        for (std::size_t row = 0; row < run.rows; ++row) {
            if (std::isnan(host[row])) continue;
            if (last < run.rows && number(row) > number(last) + 1) {
                const double late = host[row] - host[last] - (number(row) - number(last)) * nominal[row];
                if (late > kPause * nominal[row]) {
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
