#include "selftest/grammar/laboratory.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace puckloop::gap::selftest::grammar {

namespace {

/// Step that a coarse instrument reports, for columns whose noise is about as large.
struct Step {
    const char* column;
    double step;
};
constexpr std::array kCoarse{Step{"x_m", 1e-3},  Step{"y_m", 1e-3}, Step{"theta_rad", 0.0087266},
                             Step{"reading", 4}, Step{"level", 4},  Step{"ax", 4},
                             Step{"ay", 4},      Step{"az", 4},     Step{"strength", 4}};
constexpr std::array kClocks{"t_s", "t_host_s", "t_robot_s"};

}  // namespace

Laboratory Laboratory::draw(RandomStream& random) {
    Laboratory lab;
    lab.clock = random.uniform() < 0.3 ? 1e-3 : 0.0;
    lab.coarse = random.uniform() < 0.25;
    lab.stated = random.uniform() < 0.5;
    lab.one_pass = random.uniform() < 0.2;
    return lab;
}

namespace {
/// Where the second half of the runs is another session, each session has one pass already.
bool two_sessions(const std::vector<WrittenRun>& runs) {
    const WrittenColumn *first = runs.front().find("session"), *last = runs.back().find("session");
    return first != nullptr && last != nullptr && first->values.front() != last->values.front();
}
}  // namespace

void Laboratory::plan(WrittenExperiment& experiment) {
    auto& runs = experiment.runs;
    one_pass = one_pass && !two_sessions(runs);
    if (one_pass) runs.resize((runs.size() + 1) / 2);
    constexpr double kFewest = 2;
    if (!fewer || static_cast<double>(runs.size()) <= kFewest) return;
    RandomStream random = *fewer;
    const double all = static_cast<double>(runs.size());
    const auto left =
        static_cast<std::size_t>(std::lround(kFewest * std::pow(all / kFewest, random.uniform())));
    while (runs.size() > left)
        runs.erase(runs.begin() + static_cast<std::ptrdiff_t>(random.below(runs.size())));
}

void Laboratory::keep(WrittenExperiment& experiment) const {
    const auto round_to = [&](WrittenRun& run, const char* name, double step) {
        if (run.find(name) == nullptr) return false;
        // Readings are whole counts already: of those half way every other one goes up, or all would read
        // high by an eighth of the step.
        for (double& value : run.column(name).values)
            value = std::nearbyint(value / step) * step;
        return true;
    };
    for (WrittenRun& run : experiment.runs) {
        if (clock > 0)
            for (const char* name : kClocks)
                round_to(run, name, clock);
        if (!coarse) continue;
        for (const Step& one : kCoarse)
            round_to(run, one.column, one.step);
    }
    if (!coarse) return;
    for (WrittenInstrument& instrument : experiment.instruments)
        for (const Step& one : kCoarse)
            if (instrument.column == one.column && instrument.quantum > 0)
                instrument.quantum = stated ? one.step : 0.0;
}

std::string Laboratory::text() const {
    std::string text;
    if (clock > 0) text += " clock in ms;";
    if (coarse) text += stated ? " coarse;" : " coarse, not stated;";
    if (one_pass) text += " one pass;";
    return text;
}

}  // namespace puckloop::gap::selftest::grammar
