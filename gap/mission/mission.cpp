#include "gap/mission/mission.h"

#include "base/error.h"
#include "base/json.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace puckloop::gap::mission {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kShown = 8;  // differences on a terminal

const char* name_of(Finding finding) {
    switch (finding) {
    case Finding::Same:
        return "no_difference_shown";
    case Finding::Named:
        return "named";
    case Finding::CannotTell:
        return "cannot_tell";
    case Finding::Unexplained:
        break;
    }
    return "unexplained";
}

using Rows = std::vector<const Run*>;

Group group_of(const Rows& rows, const std::vector<std::size_t>& columns) {
    Group group(static_cast<Eigen::Index>(rows.size()), static_cast<Eigen::Index>(columns.size()));
    for (std::size_t r = 0; r < rows.size(); ++r)
        for (std::size_t c = 0; c < columns.size(); ++c)
            group(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c)) = rows[r]->values[columns[c]];
    return group;
}

/// Statistics that every run of both sides has and that are not the same in all of a side.
std::vector<std::size_t> comparable(const MissionRuns& measured, const MissionRuns& simulated,
                                    std::vector<std::string>& cautions) {
    std::vector<std::size_t> columns;
    for (std::size_t k = 0; k < simulated.statistics.size(); ++k) {
        const auto lacks = [k](const MissionRuns& side) {
            return std::any_of(side.runs.begin(), side.runs.end(),
                               [k](const Run& run) { return !std::isfinite(run.values[k]); });
        };
        const auto constant = [k](const MissionRuns& side) {
            return std::all_of(side.runs.begin(), side.runs.end(),
                               [&](const Run& run) { return run.values[k] == side.runs.front().values[k]; });
        };
        const std::string& name = simulated.statistics[k].name;
        if (lacks(measured) || lacks(simulated))
            cautions.push_back(fmt::format("{} is not compared: {} runs do not have it", name,
                                           lacks(measured) ? "measured" : "simulated"));
        else if (constant(measured) || constant(simulated))
            cautions.push_back(fmt::format("{} is not compared: it is the same in all {} runs", name,
                                           constant(measured) ? "measured" : "simulated"));
        else
            columns.push_back(k);
    }
    return columns;
}

std::string share_text(const Amount& amount) {
    return fmt::format("{:.2f} ({:.2f} to {:.2f})", amount.share, amount.low, amount.high);
}

std::string largest_difference(const MissionVerdict& verdict) {
    const Difference& first = verdict.comparison.differences.front();
    const Statistic& statistic = verdict.statistics[first.statistic];
    return fmt::format("{} of program {} is {:.4g} measured and {:.4g} simulated{}", statistic.name,
                       verdict.programs[first.program], first.measured, first.simulated,
                       statistic.unit == "1" || statistic.unit == "share" ? "" : " " + statistic.unit);
}

Json amounts_json(const MissionVerdict& verdict, const std::vector<Amount>& amounts) {
    Json list = Json::array();
    for (const Amount& amount : amounts)
        list.push_back({{"effect", verdict.effects[amount.effect]},
                        {"share", amount.share},
                        {"low", amount.low},
                        {"high", amount.high},
                        {"gain_nats", amount.gain},
                        {"gain_low", amount.gain_low},
                        {"wins", amount.wins}});
    return list;
}

}  // namespace

MissionVerdict judge(const MissionRuns& measured, const MissionRuns& simulated, std::uint64_t seed) {
    MissionVerdict verdict;
    const std::string file = (measured.folder / "results.csv").string();
    for (const std::string& program : simulated.programs) {
        const bool both =
            std::find(measured.programs.begin(), measured.programs.end(), program) != measured.programs.end();
        if (both) verdict.programs.push_back(program);
    }
    if (verdict.programs.empty())
        throw InputError(file, "column program",
                         fmt::format("none of {} is simulated", fmt::join(measured.programs, ", ")),
                         fmt::format("names of {}: {}", (simulated.folder / "results.csv").string(),
                                     fmt::join(simulated.programs, ", ")));
    for (const std::string& program : measured.programs)
        if (std::find(verdict.programs.begin(), verdict.programs.end(), program) == verdict.programs.end())
            verdict.cautions.push_back(fmt::format("program {} was not simulated: left out", program));
    if (verdict.programs.size() == 1)
        verdict.cautions.emplace_back(
            "one program: what is named is confirmed on the other half of the runs only, not on other "
            "programs");
    for (const MissionRuns* side : {&measured, &simulated})
        if (side->failed > 0)
            verdict.cautions.push_back(fmt::format("{} failed run{} of {} left out", side->failed,
                                                   side->failed == 1 ? "" : "s", side->folder.string()));
    const auto columns = comparable(measured, simulated, verdict.cautions);
    if (columns.empty())
        throw InputError(file, "", "has nothing that can be compared",
                         "tracks of robots that move, or scores that differ");
    for (const std::size_t column : columns)
        verdict.statistics.push_back(simulated.statistics[column]);
    verdict.base = simulated.conditions.front();
    verdict.effects.assign(simulated.conditions.begin() + 1, simulated.conditions.end());
    Groups groups;
    groups.effects.resize(verdict.effects.size());
    for (const std::string& program : verdict.programs) {
        const Rows real = runs_of(measured, program, nullptr);
        const Rows base = runs_of(simulated, program, &verdict.base);
        verdict.measured_runs += real.size();
        verdict.simulated_runs += base.size();
        groups.measured.push_back(group_of(real, columns));
        groups.simulated.push_back(group_of(base, columns));
        for (std::size_t e = 0; e < verdict.effects.size(); ++e) {
            const Rows changed = runs_of(simulated, program, &verdict.effects[e]);
            verdict.simulated_runs += changed.size();
            groups.effects[e].push_back(group_of(changed, columns));
        }
    }
    constexpr Eigen::Index kFewestOfHalf = 4;  // two in each
    if (verdict.programs.size() == 1 && groups.measured.front().rows() < kFewestOfHalf)
        throw InputError(file, "", fmt::format("has {} runs of one program", groups.measured.front().rows()),
                         "four or more, or several programs");
    verdict.comparison = compare(groups, seed);
    return verdict;
}

std::string summary_of(const MissionVerdict& verdict) {
    const Comparison& c = verdict.comparison;
    const auto names = [&](const std::vector<Amount>& amounts) {
        std::string text;
        for (std::size_t i = 0; i < amounts.size(); ++i)
            text += fmt::format("{}{}, {} of what that condition changes", i == 0 ? "" : "; ",
                                verdict.effects[amounts[i].effect], share_text(amounts[i]));
        return text;
    };
    switch (c.finding) {
    case Finding::Same:
        return fmt::format(
            "No difference is shown (p = {:.2g}). Differences of means of {:.2f} standard deviations between "
            "runs would have been seen 19 times in 20.",
            c.p, c.visible);
    case Finding::Named:
        return fmt::format(
            "The simulation differs (p = {:.2g}). Of the effects that were tried this brings it "
            "closer on programs that had no part in it: {}. {:.0f} % of what differs is explained{}.",
            c.p, names(c.together), 100 * c.explained, c.left_p < 0.05 ? ", and something is left" : "");
    case Finding::CannotTell: {
        std::string others;
        for (const std::size_t effect : c.as_good)
            others += ", " + verdict.effects[effect];
        return fmt::format(
            "The simulation differs (p = {:.2g}). These data do not tell which of these it is: "
            "{}{}.",
            c.p, verdict.effects[c.together.front().effect], others);
    }
    case Finding::Unexplained:
        break;
    }
    std::string nearest;
    if (!c.together.empty())
        nearest = fmt::format(" The nearest, {}, explains {:.0f} %.",
                              verdict.effects[c.together.front().effect], 100 * c.explained);
    return fmt::format(
        "The simulation differs (p = {:.2g}): {}. None of the effects that were tried accounts "
        "for it: unexplained.{}",
        c.p, largest_difference(verdict), nearest);
}

std::string verdict_text(const MissionVerdict& verdict) {
    const Comparison& c = verdict.comparison;
    std::string text =
        fmt::format("{} measured and {} simulated runs of {} program{}\n", verdict.measured_runs,
                    verdict.simulated_runs, verdict.programs.size(), verdict.programs.size() == 1 ? "" : "s");
    for (const std::string& caution : verdict.cautions)
        text += fmt::format("caution: {}\n", caution);
    text += fmt::format("verdict: {}\n{}\n", name_of(c.finding), summary_of(verdict));
    text += fmt::format("\n{:<16} {:<14} {:>10} {:>10} {:>7}  p\n", "program", "statistic", "measured",
                        "simulated", "errors");
    for (std::size_t i = 0; i < std::min(kShown, c.differences.size()); ++i) {
        const Difference& one = c.differences[i];
        text += fmt::format("{:<16} {:<14} {:>10.4g} {:>10.4g} {:>+7.1f}  {:.2g}\n",
                            verdict.programs[one.program], verdict.statistics[one.statistic].name,
                            one.measured, one.simulated, one.errors, one.p);
    }
    if (c.alone.empty()) return text;
    text += fmt::format("\n{:<24} {:>24} {:>10} {:>8}\n", "effect, by itself", "share of the condition",
                        "gain, nats", "at least");
    for (const Amount& amount : c.alone)
        text += fmt::format("{:<24} {:>24} {:>10.1f} {:>8.1f}\n", verdict.effects[amount.effect],
                            share_text(amount), amount.gain, amount.gain_low);
    return text;
}

std::string verdict_json(const MissionVerdict& verdict) {
    const Comparison& c = verdict.comparison;
    Json differences = Json::array();
    for (const Difference& one : c.differences)
        differences.push_back({{"program", verdict.programs[one.program]},
                               {"statistic", verdict.statistics[one.statistic].name},
                               {"unit", verdict.statistics[one.statistic].unit},
                               {"measured", one.measured},
                               {"simulated", one.simulated},
                               {"standard_errors", one.errors},
                               {"p", one.p}});
    Json as_good = Json::array();
    for (const std::size_t effect : c.as_good)
        as_good.push_back(verdict.effects[effect]);
    const Json json{{"verdict", name_of(c.finding)},
                    {"summary", summary_of(verdict)},
                    {"p", c.p},
                    {"differences", differences},
                    {"base", verdict.base},
                    {"alone", amounts_json(verdict, c.alone)},
                    {"together", amounts_json(verdict, c.together)},
                    {"as_good", as_good},
                    {"explained", c.explained},
                    {"left_p", c.left_p},
                    {"visible_sd", c.visible},
                    {"measured_runs", verdict.measured_runs},
                    {"simulated_runs", verdict.simulated_runs},
                    {"cautions", verdict.cautions}};
    return json.dump(2) + "\n";
}

}  // namespace puckloop::gap::mission
