#include "campaigns/engine/table.h"

#include "base/error.h"
#include "base/files/shipped_files.h"
#include "base/plain_text.h"
#include "campaigns/engine/findings.h"
#include "campaigns/jobs/result_files.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>

namespace puckloop::faults {

namespace fs = std::filesystem;

namespace {

std::string seconds(const std::optional<double>& time) {
    return time ? fmt::format("{:.6f}", *time) : std::string();
}

const CaseResult& find(const Results& results, int id) {
    const auto found = std::find_if(results.results.begin(), results.results.end(),
                                    [&](const CaseResult& result) { return result.one.id == id; });
    if (found == results.results.end())
        throw InputError(results.out.string(), fmt::format("case {}", id), "there is no result of it",
                         "a case of results.csv that was run");
    return *found;
}

/// As a shell takes it for one word.
std::string shell_word(const std::string& word) {
    constexpr const char* kPlain = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-./=:,+";
    if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
    std::string quoted = "'";
    for (const char letter : word)
        quoted += letter == '\'' ? std::string("'\\''") : std::string(1, letter);
    return quoted + "'";
}

}  // namespace

using jobs::csv_cell;

std::string table_text(const Results& results) {
    std::string text = "case,phase,sweep,place,faults,seed,outcome,fired,first_s,recovery_s,departure_m";
    for (const Metric& metric : results.campaign.metrics)
        text += "," + csv_cell(metric.name);
    text += ",symptoms,trace_sha256\n";
    std::map<int, std::string> rows;
    const auto head = [](const Case& one) {
        return fmt::format("{},{},{},{},{},{}", one.id, one.phase, csv_cell(one.sweep), csv_cell(one.place),
                           csv_cell(in_one_line(one.faults)), one.seed);
    };
    for (const CaseResult& result : results.results) {
        const Verdict& verdict = result.verdict;
        std::string row = fmt::format("{},{},{},{},{},{:.6f}", head(result.one), name_of(verdict.outcome),
                                      fmt::join(verdict.fired, "+"), seconds(verdict.first_s),
                                      seconds(verdict.recovery_s), verdict.departure_m);
        for (std::size_t i = 0; i < results.campaign.metrics.size(); ++i) {
            const bool known = i < verdict.metrics.size() && verdict.metrics[i].second;
            row += known ? fmt::format(",{:.9g}", *verdict.metrics[i].second) : std::string(",");
        }
        rows[result.one.id] =
            row + fmt::format(",{},{}\n", csv_cell(fmt::format("{}", fmt::join(verdict.symptoms, "; "))),
                              verdict.trace_sha256);
    }
    for (const Case& one : results.pruned)
        rows[one.id] = fmt::format("{},pruned,,,,{},{},\n", head(one),
                                   std::string(results.campaign.metrics.size(), ','), csv_cell(one.pruned));
    for (const auto& [id, row] : rows)
        text += row;
    return text;
}

void write_table(const Results& results) {
    jobs::write_whole(results.out / "results.csv", table_text(results));
}

std::string replay_command(const Results& results, int id) {
    const fs::path relative = results.out.lexically_proximate(fs::current_path());
    const bool outside = relative.string().starts_with("..");
    return fmt::format("puckloop faults replay {} {}",
                       shell_word((outside ? results.out : relative).string()), id);
}

std::string replay_command_anywhere(const Results& results, int id) {
    return fmt::format("{} faults replay {} {}", shell_word(main_program().string()),
                       shell_word(results.out.lexically_normal().string()), id);
}

std::string run_command(const Results& results, int id) {
    const CaseResult& result = find(results, id);
    const Campaign& campaign = results.campaign;
    std::string text = fmt::format("puckloop run {} --in-process --seed {}",
                                   shell_word(campaign.scenario.string()), result.one.seed);
    if (campaign.duration) text += fmt::format(" --duration {:.9g}", *campaign.duration);
    for (const std::string& firmware : campaign.firmware)
        text += " --firmware " + shell_word(firmware);
    for (const nlohmann::json& fault : result.one.faults)
        text += " --fault " + shell_word(as_words(fault));
    if (!campaign.program.empty()) text += " --linux";
    for (const std::string& word : campaign.program)
        text += " " + shell_word(word);
    return text;
}

std::string summary(const Results& results) {
    std::map<Outcome, std::size_t> counts;
    for (const CaseResult& result : results.results)
        ++counts[result.verdict.outcome];
    std::string text = fmt::format("{:<20}{:>6}\n", "outcome", "cases");
    for (const Outcome outcome : kOutcomes)
        if (counts.contains(outcome)) text += fmt::format("{:<20}{:>6}\n", name_of(outcome), counts[outcome]);
    if (!results.pruned.empty()) text += fmt::format("{:<20}{:>6}\n", "pruned", results.pruned.size());
    const std::vector<Finding> findings = findings_of(results.results);
    const std::vector<Cause> causes = causes_of(findings);
    text += fmt::format("findings: {}\ncauses: {}\n", findings.size(), causes.size());
    std::size_t number = 0;
    for (const Cause& cause : causes) {
        text += fmt::format("{}: {} ({} case{})\n", name_of(cause.outcome), cause.what, cause.cases,
                            cause.cases == 1 ? "" : "s");
        for (const Finding* finding : cause.findings)
            text +=
                fmt::format("{:>3}  {}: {} ({} case{})\n     {}\n", ++number, finding->faults,
                            finding->symptoms.empty() ? "departs from the nominal path" : finding->symptoms,
                            finding->cases.size(), finding->cases.size() == 1 ? "" : "s",
                            replay_command(results, finding->smallest->one.id));
    }
    return text + fmt::format("results in {}: report.html, results.csv, campaign.db\n",
                              plain_text(results.out.string(), kLongestMessage));
}

std::string case_text(const Results& results, int id) {
    const CaseResult& result = find(results, id);
    const Verdict& verdict = result.verdict;
    std::string text =
        fmt::format("case {} ({}, sweep {}, seed {}): {}\n{}", id, result.one.phase, result.one.sweep,
                    result.one.seed, name_of(verdict.outcome), as_toml(result.one.faults));
    text += fmt::format("fired {} times", fmt::join(verdict.fired, " + "));
    if (verdict.first_s) text += fmt::format(", first at {:.6f} s", *verdict.first_s);
    if (verdict.recovery_s) text += fmt::format("; recovered after {:.6f} s", *verdict.recovery_s);
    text += fmt::format("\ndeparture from the nominal path {:.6f} m\n", verdict.departure_m);
    for (const auto& [name, value] : verdict.metrics)
        text += fmt::format("{} {}\n", name, value ? fmt::format("{:.9g}", *value) : "none");
    for (std::size_t begin = 0; begin < verdict.detail.size();) {
        const auto end = std::min(verdict.detail.find("; ", begin), verdict.detail.size());
        text += "  " + verdict.detail.substr(begin, end - begin) + "\n";
        begin = end + 2;
    }
    return text + fmt::format("trace {}\n{}\n{}\n", verdict.trace_sha256, replay_command(results, id),
                              run_command(results, id));
}

}  // namespace puckloop::faults
