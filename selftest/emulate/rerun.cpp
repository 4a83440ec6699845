#include "selftest/emulate/rerun.h"

#include "base/error.h"
#include "gap/overlay/overlay.h"
#include "gap/overlay/overlay_parts.h"
#include "physics/description/parameters.h"
#include "selftest/emulate/comparison.h"
#include "selftest/emulate/reacts.h"
#include "selftest/emulate/rerun_rab.h"

#include <fmt/format.h>

#include <algorithm>

namespace puckloop::gap::emulate {

namespace {

/// What the experiment says of its robot, as far as the simulator has it.
Robot nominal_robot(const Experiment& experiment, const RerunOptions& options) {
    Robot robot;
    robot.firmware = options.firmware;
    for (const auto& [name, value] : experiment.nominal) {
        int index = -1;
        if (physics::find_parameter(name, index) != nullptr && !made_by_firmware(name))
            robot.parameters[name] = value;
    }
    return robot;
}

/// What warms up is looked at as late as it was measured; else any moment will do.
double longest_stand(const Verdict& verdict, bool by_time) {
    constexpr double kLongest = 20.0;  // s
    if (by_time) return kLongest;
    for (const Cause& cause : verdict.causes)
        for (const FittedParameter& parameter : cause.parameters)
            if (parameter.name.find("warmup") != std::string::npos) return kLongest;
    for (const Extended& one : verdict.extension.observables)
        for (const LearntTable& table : one.tables)
            if (std::ranges::find(table.over, "time") != table.over.end()) return kLongest;
    return 0.0;
}

/// Parameters that neither an overlay's run nor this one takes.
std::vector<std::string> left_out(const Experiment& experiment, const Verdict& verdict) {
    const std::string text = overlay_toml(experiment, verdict);
    std::vector<std::string> names;
    const auto measuring = text.find("\n[measurement]\n");
    if (measuring == std::string::npos) return names;
    for (std::size_t from = text.find('"', measuring); from != std::string::npos;) {
        const std::size_t to = text.find('"', from + 1);
        const std::string name = text.substr(from + 1, to - from - 1);
        if (name != kFetchTime) names.push_back(name);  // it is the host's, and performed
        from = text.find('"', to + 1);
    }
    return names;
}

Rerun not_done(const RerunOptions& options, const char* why) {
    std::error_code ignored;
    std::filesystem::remove_all(options.scratch, ignored);
    Rerun result;
    result.asked = true;
    result.not_done = why;
    return result;
}

/// As many as `longest` seconds allow, from all over; at least one.
std::vector<React> chosen(const std::vector<React>& all, double longest) {
    for (std::size_t count = all.size(); count > 0; --count) {
        auto some = spread_of(all, count);
        double seconds = 0.0;
        for (const React& react : some)
            seconds += react.act.commands.back().seconds;
        if (longest <= 0 || seconds <= longest || count == 1) return some;
    }
    return all;
}

}  // namespace

std::vector<std::uint64_t> seeds_of(const RerunOptions& options) {
    constexpr std::uint64_t kApart = 1'000'000;  // further than an experiment has runs
    std::vector<std::uint64_t> seeds(kTrueSide, options.seed);
    for (std::size_t k = 0; options.truth && k < kTruePerformances; ++k)
        seeds.push_back(options.seed + k * kApart);
    return seeds;
}

RerunObservable observable_of(const std::string& name, const std::string& unit,
                              const std::vector<double>& errors) {
    RerunObservable one{name, unit, errors[0], errors[kOverlaySide]};
    if (errors.size() <= kTrueSide) return one;
    const Floor floor = floor_of({errors.begin() + static_cast<std::ptrdiff_t>(kTrueSide), errors.end()});
    one.floor = floor.mean;
    one.floor_limit = floor.limit;
    return one;
}

Rerun rerun(const Experiment& experiment, const Verdict& verdict, const RerunOptions& options) try {
    Rerun result;
    result.asked = true;
    if (verdict.causes.empty() && !verdict.extension.enters()) {
        result.not_done = "nothing was named or learnt that a run takes, so there is nothing to add to the "
                          "simulation";
        return result;
    }
    if (experiment.kind == Kind::Motion && options.firmware.empty() &&
        experiment.nominal_or("firmware.agenda", 1.0) != 0) {
        result.not_done = "the robot ran another firmware than the project's own; name its image";
        return result;
    }
    if (experiment.kind == Kind::Rab) {
        result = rerun_rab(experiment, verdict, options);
        result.left_out = left_out(experiment, verdict);
        return result;
    }
    const auto all = reacts_of(experiment, longest_stand(verdict, options.by_time), result.not_done);
    if (!result.not_done.empty()) return result;
    const auto reacts = chosen(all, options.longest);
    const auto names = compared(experiment.kind);
    const auto seeds = seeds_of(options);
    std::vector<std::vector<Comparison>> comparisons(seeds.size(), std::vector<Comparison>(names.size()));
    std::size_t done = 0;
    for (std::size_t k = 0; k < reacts.size(); ++k) {
        Performed plain;
        for (std::size_t side = 0; side < seeds.size(); ++side) {
            Robot robot = side < kTrueSide ? nominal_robot(experiment, options) : *options.truth;
            if (side == kOverlaySide) robot.overlay = options.overlay;
            if (robot.period == Robot().period) robot.period = reacts[k].period;
            Performed performed;
            performed.rows = perform(robot, reacts[k].act, options.tools, seeds[side] + k, options.scratch);
            if (reacts[k].line) performed.answers = serial_answers(options.scratch / "out" / "trace.csv");
            if (side == 0) plain = performed;
            compare(experiment, reacts[k], performed, plain, comparisons[side]);
            std::filesystem::remove_all(options.scratch);
            if (options.done) options.done(++done, seeds.size() * reacts.size());
        }
    }
    result.runs = reacts.size();
    result.of_runs = all.size();
    result.rows = comparisons[0][0].rows();
    for (std::size_t o = 0; o < names.size(); ++o) {
        std::vector<double> errors;
        for (const auto& side : comparisons)
            if (const auto error = side[o].off_by()) errors.push_back(*error);
        if (errors.size() == seeds.size())
            result.observables.push_back(observable_of(names[o].first, names[o].second, errors));
    }
    result.left_out = left_out(experiment, verdict);
    return result;
} catch (const RunError& error) {  // an overlay may stop the robot's line altogether
    return not_done(options, error.what());
} catch (const InputError& error) {  // no tools, or what a run does not take
    return not_done(options, error.what());
}

}  // namespace puckloop::gap::emulate
