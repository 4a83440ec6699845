#include "selftest/grammar/noisy_inputs.h"

#include "selftest/benches/rig.h"
#include "selftest/case_list.h"
#include "selftest/grammar/laboratory.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::gap::selftest::grammar {

namespace {

constexpr double kDegrees = std::numbers::pi / 180;

/// What was noted with errors, and how large they may be, in the column's unit.
struct Input {
    const char* kind;
    std::vector<const char*> columns;  ///< each with errors of its own
    double least, most;
    bool sums = false;  ///< errors stay in a counter
};

const std::vector<Input>& inputs() {
    static const std::vector<Input> all{
        {"motion", {"steps_left", "steps_right"}, 0.4, 4.0, true},
        {"motion", {"cmd_left", "cmd_right"}, 2.0, 40.0},
        {"proximity", {"distance_m"}, 1e-4, 2e-3},
        {"proximity", {"angle_rad"}, 1 * kDegrees, 8 * kDegrees},
        {"rab", {"distance_m"}, 2e-3, 3e-2},
        {"rab", {"true_bearing_rad"}, 0.5 * kDegrees, 5 * kDegrees},
        {"rab", {"sender_bearing_rad"}, 0.5 * kDegrees, 5 * kDegrees},
        {"microphone", {"distance_m"}, 1e-3, 2e-2},
        {"microphone", {"angle_rad"}, 1 * kDegrees, 10 * kDegrees},
        {"ground", {"grey"}, 5e-3, 5e-2},
        {"ground", {"grey_rate"}, 1.0, 20.0},
        {"accelerometer", {"pitch_rad"}, 0.2 * kDegrees, 2 * kDegrees},
        {"accelerometer", {"roll_rad"}, 0.2 * kDegrees, 2 * kDegrees},
        {"timing", {"t_robot_s"}, 5e-5, 2e-3},
    };
    return all;
}

double between(RandomStream& random, double low, double high) {
    return low * std::pow(high / low, random.uniform());
}

/// Errors in a column of a run; with `held`, rows of one value that follow each other share theirs.
void blur(std::vector<double>& values, double sd, bool sums, bool held, RandomStream random) {
    double error = 0.0, last = NAN;
    for (double& value : values) {
        const double noted = value;
        const bool same = noted == last;
        last = noted;
        if (sums)
            error += std::isnan(noted) ? 0.0 : sd * random.normal();
        else if (!held || !same)
            error = sd * random.normal();
        value += error;
    }
}

/// Nearly straight drives, which show little of how a robot turns, by counters that err in each row.
WrittenExperiment straight_drives(RandomStream& random, std::string& text) {
    constexpr double kCount = 1e-5, kRadius = 0.022;  // m
    const double axle = between(random, 0.05, 0.2), errs = between(random, 5e-5, 5e-4),
                 ahead = between(random, 2e-3, 1e-2), turns = between(random, 1e-3, 4e-3),
                 seen = between(random, 2e-4, 1e-3), seen_heading = between(random, 2e-3, 6e-3),
                 row = between(random, 0.1, 0.5);
    const auto smooth = static_cast<std::size_t>(between(random, 5, 41)), runs = 4 + random.below(5),
               rows = 150 + random.below(301);
    text = fmt::format("counters err by {:.2f} mm a row on nearly straight drives, axle {:.0f} mm",
                       errs * 1e3, axle * 1e3);
    WrittenExperiment experiment;
    experiment.kind = "motion";
    experiment.nominal = {{"robot.wheel_radius_left", kRadius},
                          {"robot.wheel_radius_right", kRadius},
                          {"robot.axle_length", axle},
                          {"inverse_friction", 0.0},
                          {"robot.steps_per_turn", 2 * std::numbers::pi * kRadius / kCount}};
    for (std::size_t r = 0; r < runs; ++r) {
        std::vector<double> each(rows + smooth);
        for (double& one : each)
            one = turns * random.normal();
        WrittenRun run;
        double x = 0, y = 0, heading = 0;
        std::array<double, 2> counted{};
        for (std::size_t i = 0; i < rows; ++i) {
            double turn = 0.0;
            for (std::size_t k = 0; k < smooth; ++k)
                turn += each[i + k] / static_cast<double>(smooth);
            if (i > 0) {
                x += ahead * std::cos(heading + turn / 2);
                y += ahead * std::sin(heading + turn / 2);
                heading += turn;
                counted[0] += ahead - turn * axle / 2 + errs * random.normal();
                counted[1] += ahead + turn * axle / 2 + errs * random.normal();
            }
            run.row({{"t_s", row * static_cast<double>(i)},
                     {"x_m", x + seen * random.normal()},
                     {"y_m", y + seen * random.normal()},
                     {"theta_rad", heading + seen_heading * random.normal()},
                     {"steps_left", std::round(counted[0] / kCount)},
                     {"steps_right", std::round(counted[1] / kCount)}});
        }
        experiment.runs.push_back(std::move(run));
    }
    return experiment;
}

bool varies(const WrittenExperiment& experiment, const char* name) {
    double low = INFINITY, high = -INFINITY;
    for (const WrittenRun& run : experiment.runs)
        if (const WrittenColumn* column = run.find(name))
            for (const double one : column->values) {
                low = std::min(low, one);
                high = std::max(high, one);
            }
    return high > low;
}

}  // namespace

DrawnCase noisy_input_case(std::size_t number, std::uint64_t seed) {
    const std::size_t bench = number % benches().size();
    RandomStream random(seed, fmt::format("noisy inputs {}", number));
    DrawnCase drawn;
    drawn.of = Class::NoisyInput;
    drawn.hidden.kind = benches()[bench]->kind();
    drawn.hidden.expect = Expect::NoEffect;
    if (drawn.hidden.kind == "motion" && random.uniform() < 0.5) {
        drawn.hidden.experiment = straight_drives(random, drawn.text);
        drawn.runs = drawn.hidden.experiment.runs.size();
        return drawn;
    }
    WrittenExperiment& experiment = drawn.hidden.experiment = benches()[bench]->exact(random.next());
    Laboratory laboratory = Laboratory::draw(random);
    laboratory.plan(experiment);
    benches()[bench]->measure(experiment, NoiseStyle::draw(random), random.next());
    std::vector<Input> open;
    for (const Input& one : inputs())
        if (drawn.hidden.kind == one.kind && varies(experiment, one.columns.front())) open.push_back(one);
    const Input& input = open[random.below(open.size())];
    const double sd = between(random, input.least, input.most);
    const bool held = !input.sums && random.uniform() < 0.5;
    for (std::size_t r = 0; r < experiment.runs.size(); ++r)
        for (const char* name : input.columns)
            for (WrittenColumn& column : experiment.runs[r].columns) {
                if (column.name != name) continue;
                blur(column.values, sd, input.sums, held,
                     RandomStream(seed, fmt::format("input {} {} {}", number, r, name)));
                // Commands are noted beside what was done, which counters would give away.
                if (std::string_view(name).starts_with("cmd")) {
                    std::erase_if(experiment.runs[r].columns,
                                  [](const WrittenColumn& other) { return other.name.starts_with("steps"); });
                    break;
                }
                if (std::string_view(name).starts_with("steps"))
                    for (double& one : column.values)
                        one = std::round(one);
            }
    for (WrittenRun& run : experiment.runs)  // no ruler shows less than nothing
        for (WrittenColumn& column : run.columns)
            if (column.name == "distance_m" || column.name == "grey")
                for (double& one : column.values)
                    one = std::max(one, 0.0);
    laboratory.keep(experiment);
    drawn.text = fmt::format("{} noted with errors of {:.3g}{}", input.columns.front(), sd,
                             held ? ", the same while it stands" : "") +
                 laboratory.text();
    drawn.runs = experiment.runs.size();
    return drawn;
}

}  // namespace puckloop::gap::selftest::grammar
