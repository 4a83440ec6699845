#pragma once
// What the scores of an experiment show: medians with intervals, tests, and the comparison with a reference.

#include "campaigns/experiment/experiment_run.h"
#include "campaigns/experiment/reference.h"
#include "campaigns/statistics/friedman.h"
#include "campaigns/statistics/intervals.h"
#include "campaigns/statistics/wilcoxon.h"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::swarm {

/// Everything that is reported.
struct Findings {
    Experiment experiment;
    std::filesystem::path out;
    std::map<int, RunResult> results;  ///< by number of the run
};

/// One program under one condition.
struct Cell {
    std::size_t program = 0, condition = 0;
    std::map<std::uint64_t, double> scores;  ///< by seed, of runs that have one
    std::size_t failed = 0;
    double wall = 0.0;  ///< s, of all its runs
    std::vector<double> values() const;
};

/// By program, then condition.
std::vector<Cell> cells_of(const Findings& findings);
const Cell& cell_of(const std::vector<Cell>& cells, std::size_t program, std::size_t condition);

/// As the file states, or else the runs' mission.
bool more_is_better(const Findings& findings);

/// Several treatments over the same seeds: programs under one condition, or conditions of one program.
struct Comparison {
    std::string of;  ///< "programs, as it is" or "conditions, aggregate"
    std::vector<std::string> treatments;
    std::size_t seeds = 0;                           ///< that all treatments have a score for
    std::optional<statistics::Friedman> friedman{};  ///< of three treatments and more
    struct Pair {
        std::size_t a = 0, b = 0;
        statistics::RankTest test;
        double adjusted = 1.0;            ///< p by Holm over the pairs of this comparison
        double difference = 0.0;          ///< median of a's score minus b's, seed by seed
        statistics::Interval interval{};  ///< of that median
    };
    std::vector<Pair> pairs;
};

/// Those with two treatments at least.
std::vector<Comparison> comparisons_of(const Findings& findings, const std::vector<Cell>& cells);

/// Of one program beside the reference's.
struct Drop {
    std::string program, condition;
    std::size_t here = 0, there = 0;  ///< scores of each
    double median_here = 0.0, median_there = 0.0;
    double drop = 0.0;                ///< how much worse the reference's median is; negative: better
    statistics::Interval interval{};  ///< bootstrap
    statistics::RankTest test;        ///< rank-sum
};

struct Agreement {
    std::vector<Drop> drops;
    double rank_correlation = 0.0;  ///< Spearman's, of the programs' medians; NaN of one program
    statistics::Interval rank_interval{};
    double mean_error = 0.0;  ///< mean of the reference's medians minus ours
    statistics::Interval error_interval{};
    double mean_absolute = 0.0;  ///< mean of the sizes of these differences
    statistics::Interval absolute_interval{};
    std::vector<std::string> only_here, only_there;  ///< what could not be compared
};

/// Rows are matched by the names of program and condition; without a column for conditions, the reference is
/// compared with the first. InputError where no name is common to both.
Agreement agreement_of(const Findings& findings, const std::vector<Cell>& cells, const Reference& reference);

}  // namespace puckloop::swarm
