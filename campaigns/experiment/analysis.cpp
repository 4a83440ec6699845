#include "campaigns/experiment/analysis.h"

#include "base/error.h"
#include "base/quantile.h"
#include "campaigns/statistics/correlation.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace puckloop::swarm {

namespace {

constexpr std::uint64_t kBootstrapSeed = 1;  // the same report each time

Comparison compare(std::string of, const std::vector<std::string>& names,
                   const std::vector<const Cell*>& treatments) {
    Comparison comparison{std::move(of), names, 0, {}, {}};
    std::vector<std::vector<double>> blocks;
    for (const auto& [seed, score] : treatments[0]->scores) {
        std::vector<double> block;
        for (const Cell* treatment : treatments)
            if (const auto found = treatment->scores.find(seed); found != treatment->scores.end())
                block.push_back(found->second);
        if (block.size() == treatments.size()) blocks.push_back(std::move(block));
    }
    comparison.seeds = blocks.size();
    if (treatments.size() > 2) comparison.friedman = statistics::friedman(blocks);
    std::vector<double> p;
    for (std::size_t a = 0; a < treatments.size(); ++a)
        for (std::size_t b = a + 1; b < treatments.size(); ++b) {
            std::vector<double> differences;
            for (const std::vector<double>& block : blocks)
                differences.push_back(block[a] - block[b]);
            comparison.pairs.push_back({a, b, statistics::signed_rank(differences), 1.0, median(differences),
                                        statistics::median_interval(differences)});
            p.push_back(comparison.pairs.back().test.p);
        }
    const std::vector<double> adjusted = statistics::holm(p);
    for (std::size_t i = 0; i < adjusted.size(); ++i)
        comparison.pairs[i].adjusted = adjusted[i];
    return comparison;
}

std::vector<std::string> names_of(const std::vector<Variant>& variants) {
    std::vector<std::string> names;
    for (const Variant& variant : variants)
        names.push_back(variant.name);
    return names;
}

std::string title_of(const std::string& program, const std::string& condition) {
    return condition.empty() ? program : fmt::format("{}, {}", program, condition);
}

/// Samples are ours and the reference's by turns, two per program.
using Samples = std::vector<std::vector<double>>;

std::vector<double> medians(const Samples& samples, std::size_t first) {
    std::vector<double> values;
    for (std::size_t i = first; i < samples.size(); i += 2)
        values.push_back(median(samples[i]));
    return values;
}

double rank_agreement(const Samples& samples) {
    return statistics::spearman(medians(samples, 0), medians(samples, 1));
}

double mean_of_errors(const Samples& samples, bool sizes) {
    const std::vector<double> ours = medians(samples, 0), theirs = medians(samples, 1);
    double sum = 0.0;
    for (std::size_t i = 0; i < ours.size(); ++i)
        sum += sizes ? std::abs(theirs[i] - ours[i]) : theirs[i] - ours[i];
    return sum / static_cast<double>(ours.size());
}

}  // namespace

std::vector<double> Cell::values() const {
    std::vector<double> list;
    for (const auto& [seed, score] : scores)
        list.push_back(score);
    return list;
}

std::vector<Cell> cells_of(const Findings& findings) {
    std::vector<Cell> cells;
    for (const Run& run : runs_of(findings.experiment)) {
        if (cells.empty() || cells.back().program != run.program || cells.back().condition != run.condition)
            cells.push_back({run.program, run.condition, {}, 0, 0.0});
        const auto found = findings.results.find(run.id);
        if (found == findings.results.end()) continue;
        cells.back().wall += found->second.wall;
        if (found->second.score)
            cells.back().scores[run.seed] = *found->second.score;
        else
            ++cells.back().failed;
    }
    return cells;
}

const Cell& cell_of(const std::vector<Cell>& cells, std::size_t program, std::size_t condition) {
    return *std::find_if(cells.begin(), cells.end(), [&](const Cell& cell) {
        return cell.program == program && cell.condition == condition;
    });
}

bool more_is_better(const Findings& findings) {
    if (findings.experiment.more_is_better) return *findings.experiment.more_is_better;
    return std::all_of(findings.results.begin(), findings.results.end(),
                       [](const auto& result) { return result.second.more_is_better; });
}

std::vector<Comparison> comparisons_of(const Findings& findings, const std::vector<Cell>& cells) {
    const Experiment& experiment = findings.experiment;
    const std::vector<std::string> programs = names_of(experiment.programs),
                                   conditions = names_of(experiment.conditions);
    std::vector<Comparison> comparisons;
    if (programs.size() > 1)
        for (std::size_t condition = 0; condition < conditions.size(); ++condition) {
            std::vector<const Cell*> treatments;
            for (std::size_t program = 0; program < programs.size(); ++program)
                treatments.push_back(&cell_of(cells, program, condition));
            comparisons.push_back(compare("programs, " + conditions[condition], programs, treatments));
        }
    if (conditions.size() > 1)
        for (std::size_t program = 0; program < programs.size(); ++program) {
            std::vector<const Cell*> treatments;
            for (std::size_t condition = 0; condition < conditions.size(); ++condition)
                treatments.push_back(&cell_of(cells, program, condition));
            comparisons.push_back(compare("conditions, " + programs[program], conditions, treatments));
        }
    return comparisons;
}

Agreement agreement_of(const Findings& findings, const std::vector<Cell>& cells, const Reference& reference) {
    const Experiment& experiment = findings.experiment;
    const double sign = more_is_better(findings) ? 1.0 : -1.0;
    Agreement agreement;
    Scores left = reference.scores;
    Samples samples;
    for (const Cell& cell : cells) {
        if (!reference.has_conditions && cell.condition != 0) continue;
        const std::string& program = experiment.programs[cell.program].name;
        const std::string condition =
            reference.has_conditions ? experiment.conditions[cell.condition].name : std::string();
        const auto found = left.find({program, condition});
        if (found == left.end() || cell.scores.empty()) {
            agreement.only_here.push_back(title_of(program, condition));
            continue;
        }
        const std::vector<double> here = cell.values(), there = found->second;
        Drop drop{program, condition, here.size(), there.size(), median(here), median(there), 0.0, {}, {}};
        drop.drop = sign * (drop.median_here - drop.median_there);
        drop.interval = statistics::bootstrap(
            {here, there}, RandomStream(kBootstrapSeed, "drop " + title_of(program, condition)),
            [&](const Samples& drawn) { return sign * (median(drawn[0]) - median(drawn[1])); });
        drop.test = statistics::rank_sum(here, there);
        agreement.drops.push_back(std::move(drop));
        samples.push_back(here);
        samples.push_back(there);
        left.erase(found);
    }
    for (const auto& [name, scores] : left)
        agreement.only_there.push_back(title_of(name.first, name.second));
    if (samples.empty())
        throw InputError(reference.file.string(), "",
                         fmt::format("no program of the experiment is in it; it has {}",
                                     fmt::join(agreement.only_there, "; ")),
                         fmt::format("{}", fmt::join(agreement.only_here, "; ")));
    const auto errors = [](bool sizes) {
        return [sizes](const Samples& drawn) { return mean_of_errors(drawn, sizes); };
    };
    agreement.rank_correlation = rank_agreement(samples);
    agreement.rank_interval =
        statistics::bootstrap(samples, RandomStream(kBootstrapSeed, "rank correlation"), rank_agreement);
    agreement.mean_error = mean_of_errors(samples, false);
    agreement.error_interval =
        statistics::bootstrap(samples, RandomStream(kBootstrapSeed, "mean error"), errors(false));
    agreement.mean_absolute = mean_of_errors(samples, true);
    agreement.absolute_interval =
        statistics::bootstrap(samples, RandomStream(kBootstrapSeed, "mean absolute error"), errors(true));
    return agreement;
}

}  // namespace puckloop::swarm
