#include "gap/mission/power.h"

#include "base/error.h"
#include "base/random.h"
#include "gap/mission/mission.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace puckloop::gap::mission {

namespace {

constexpr std::size_t kFewestRunsEach = 4;  // of a program under a condition

using Values = std::vector<double>;

/// Of the runs of a program: means by condition, and what single runs differ from theirs by.
class Source {
  public:
    Source(const MissionRuns& runs, const std::string& program) {
        for (const std::string& condition : runs.conditions) {
            const std::vector<const Run*> rows = runs_of(runs, program, &condition);
            if (rows.size() < kFewestRunsEach)
                throw InputError(
                    (runs.folder / "results.csv").string(), "",
                    fmt::format("program {}, condition {} has {} runs", program, condition, rows.size()),
                    "four or more");
            const auto count = static_cast<double>(rows.size());
            Values mean(runs.statistics.size(), 0.0);
            for (const Run* row : rows)
                for (std::size_t k = 0; k < mean.size(); ++k)
                    mean[k] += row->values[k] / count;
            // Deviations from their own mean scatter too little.
            const double widened = std::sqrt(count / (count - 1.0));
            for (const Run* row : rows) {
                Values residual(mean.size());
                for (std::size_t k = 0; k < mean.size(); ++k)
                    residual[k] = widened * (row->values[k] - mean[k]);
                residuals_.push_back(std::move(residual));
            }
            means_.push_back(std::move(mean));
        }
    }

    /// One run in which `share` of what `condition` changes is hidden.
    Values draw(std::size_t condition, double share, RandomStream& random) const {
        const Values& residual = residuals_[random.below(residuals_.size())];
        Values values(means_.front());
        for (std::size_t k = 0; k < values.size(); ++k)
            values[k] += share * (means_[condition][k] - means_.front()[k]) + residual[k];
        return values;
    }

  private:
    std::vector<Values> means_;  ///< by condition
    std::vector<Values> residuals_;
};

MissionRuns measured_runs(const MissionRuns& all, const std::vector<Source>& sources, std::size_t condition,
                          double share, std::size_t runs, RandomStream& random) {
    MissionRuns measured{"drawn", all.statistics, all.programs, {}, {}, 0};
    for (std::size_t p = 0; p < sources.size(); ++p)
        for (std::size_t i = 0; i < runs; ++i)
            measured.runs.push_back(
                {all.programs[p], "", fmt::format("{}", i), sources[p].draw(condition, share, random)});
    return measured;
}

/// The experiment once more, by chance.
MissionRuns simulated_runs(const MissionRuns& all, const std::vector<Source>& sources, RandomStream& random) {
    const auto place = [](const std::vector<std::string>& names, const std::string& name) {
        return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
    };
    MissionRuns simulated(all);
    for (Run& run : simulated.runs)
        run.values =
            sources[place(all.programs, run.program)].draw(place(all.conditions, run.condition), 1.0, random);
    return simulated;
}

void count(PowerPoint& point, const Comparison& verdict, std::size_t condition) {
    const bool nothing = condition == 0;
    ++point.cases;
    switch (verdict.finding) {
    case Finding::Same:
        ++point.same;
        if (nothing) ++point.right;
        return;
    case Finding::Named:
        ++(!nothing && verdict.together.front().effect + 1 == condition ? point.right : point.wrong);
        return;
    case Finding::CannotTell:
    case Finding::Unexplained:
        ++point.open;
    }
}

}  // namespace

Power power_of(const MissionRuns& simulated, const PowerRequest& request) {
    if (simulated.conditions.size() < 2)
        throw InputError((simulated.folder / "results.csv").string(), "column condition",
                         "has one condition: there is no effect to hide", "an experiment with several");
    constexpr std::size_t kFewestOfOne = 4;  // judge() halves those
    if (simulated.programs.size() == 1 && request.runs.front() < kFewestOfOne)
        throw InputError("", "--runs", fmt::format("{} runs of one program", request.runs.front()),
                         "four or more, or an experiment with several programs");
    std::vector<Source> sources;
    for (const std::string& program : simulated.programs)
        sources.emplace_back(simulated, program);
    Power power{request, {}, simulated.programs.size(), simulated.runs.size()};
    std::size_t done = 0;
    for (std::size_t i = 1; i <= simulated.conditions.size(); ++i) {
        const std::size_t condition = i % simulated.conditions.size();  // nothing hidden comes last
        PowerCurve curve{condition == 0 ? "" : simulated.conditions[condition], {}};
        RandomStream random(request.seed, fmt::format("gap/mission/power/{}", condition));
        for (const std::size_t runs : request.runs) {
            PowerPoint point{runs};
            for (std::size_t k = 0; k < request.cases; ++k) {
                const MissionRuns measured =
                    measured_runs(simulated, sources, condition, request.share, runs, random);
                const MissionRuns again = simulated_runs(simulated, sources, random);
                count(point, judge(measured, again, request.seed + k).comparison, condition);
            }
            curve.points.push_back(point);
            if (request.progress) request.progress(++done, simulated.conditions.size() * request.runs.size());
        }
        power.curves.push_back(std::move(curve));
    }
    return power;
}

}  // namespace puckloop::gap::mission
