#include "campaigns/engine/plan.h"

#include "base/error.h"
#include "base/random.h"
#include "campaigns/engine/case_run.h"
#include "campaigns/engine/findings.h"
#include "campaigns/engine/positions.h"
#include "cosim/faults/kinds/kind_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace puckloop::faults {

using nlohmann::json;

namespace {

/// Every combination of the sweep's lists, the last key fastest.
std::vector<json> combinations(const Sweep& sweep) {
    std::vector<json> faults{sweep.fault};
    for (const auto& [key, values] : sweep.over) {
        std::vector<json> more;
        for (const json& fault : faults)
            for (const json& value : values) {
                more.push_back(fault);
                more.back()[key] = value;
            }
        faults = std::move(more);
    }
    return faults;
}

struct Placed {
    json fault;
    std::string place;
    std::string pruned;
};

/// One fault at all its times or positions.
std::vector<Placed> placed(const Sweep& sweep, const json& fault, const Profile& nominal) {
    std::vector<Placed> list;
    if (sweep.positions) {
        for (const Position& position : positions_of(sweep, fault, nominal)) {
            Placed one{fault, position.name, position.missing};
            one.fault["begin"] = position.begin;
            list.push_back(std::move(one));
        }
        return list;
    }
    if (sweep.times.empty()) return {{fault, fault.contains("begin") ? value_text(fault["begin"]) : "", ""}};
    for (const std::string& time : sweep.times) {
        list.push_back({fault, time, ""});
        list.back().fault["begin"] = time;
    }
    return list;
}

/// Of more cases than the budget, a drawn sample is run: positions in `from`, ascending.
std::vector<std::size_t> sample(std::size_t from, std::size_t budget, std::uint64_t seed,
                                const char* stream) {
    std::set<std::size_t> chosen;
    if (from <= budget) {
        for (std::size_t i = 0; i < from; ++i)
            chosen.insert(i);
    } else {  // Floyd's algorithm
        RandomStream random(seed, stream);
        for (std::size_t i = from - budget; i < from; ++i) {
            const std::size_t drawn = random.below(i + 1);
            chosen.insert(chosen.contains(drawn) ? i : drawn);
        }
    }
    return {chosen.begin(), chosen.end()};
}

}  // namespace

void check_sweep(const Campaign& campaign, const scenarios::Scenario& scenario, const Sweep& sweep,
                 const std::filesystem::path& folder) {
    std::vector<std::pair<json, int>> of_nodes;
    for (const json& fault : combinations(sweep)) {
        check_fault(campaign, scenario, fault, sweep.line);
        if (sweep.positions && (!fault.contains("link") || !fault.contains("from")))
            throw InputError(campaign.file.string(), fmt::format("line {}", sweep.line),
                             "byte positions of nobody's records", "a fault with 'link' and 'from'");
        if (!fault.contains("node")) continue;
        of_nodes.emplace_back(fault, sweep.line);
        if (!sweep.times.empty()) of_nodes.back().first["begin"] = sweep.times.front();
    }
    if (!of_nodes.empty()) check_faults_of_nodes(campaign, of_nodes, folder);
}

std::vector<Case> plan_singles(const Campaign& campaign, const scenarios::Scenario& scenario,
                               const Nominals& nominals) {
    std::vector<Case> cases;
    std::set<std::string> known;
    std::vector<std::size_t> runnable;
    for (const Sweep& sweep : campaign.sweeps)
        for (const json& fault : combinations(sweep)) {
            check_fault(campaign, scenario, fault, sweep.line);
            for (const std::uint64_t seed : campaign.seeds)
                for (Placed& place : placed(sweep, fault, nominals.at(seed))) {
                    check_fault(campaign, scenario, place.fault, sweep.line);
                    if (!known.insert(fmt::format("{} {}", seed, place.fault.dump())).second) continue;
                    Case one{.id = static_cast<int>(cases.size()) + 1,
                             .phase = "single",
                             .sweep = sweep.name,
                             .place = place.place,
                             .seed = seed,
                             .faults = {place.fault},
                             .of = 0,
                             .pruned = place.pruned};
                    if (one.pruned.empty()) one.pruned = useless(place.fault, nominals.at(seed));
                    if (one.pruned.empty()) runnable.push_back(cases.size());
                    cases.push_back(std::move(one));
                }
        }
    const auto chosen = sample(runnable.size(), campaign.cases, campaign.sample_seed, "campaign.singles");
    std::set<std::size_t> run;
    for (const std::size_t i : chosen)
        run.insert(runnable[i]);
    for (const std::size_t i : runnable)
        if (!run.contains(i))
            cases[i].pruned = fmt::format("not in the sample of {} of {}", campaign.cases, runnable.size());
    return cases;
}

namespace {

/// How often a case's fault may fire.
std::uint64_t allowed(const Case& one) {
    const auto count = one.faults[0].find("count");
    return count != one.faults[0].end() && count->is_number_integer() ? count->get<std::uint64_t>()
                                                                      : UINT64_MAX;
}

/// What holds at a board during a window does so however often it is seen to.
bool is_counted(const json& fault) {
    if (!fault.contains("node")) return true;
    const std::string kind = value_text(fault.value("kind", json("drop")));
    const auto& kinds = cosim::all_kinds();
    return std::none_of(kinds.begin(), kinds.end(), [&](const cosim::KindInfo& info) {
        return info.name == kind && info.style == cosim::Style::Hold;
    });
}

/// Counts to try between what shows the finding and what does not.
std::vector<std::uint64_t> fewer_counts(const CaseResult& found, const std::vector<CaseResult>& results) {
    const int origin = found.one.of != 0 ? found.one.of : found.one.id;
    const std::uint64_t most =
        std::min(allowed(found.one), found.verdict.fired.empty() ? 0 : found.verdict.fired[0]);
    std::uint64_t below = 0;
    bool tried = false;
    for (const CaseResult& result : results)
        if (result.one.of == origin) {
            tried = true;
            if (allowed(result.one) < most) below = std::max(below, allowed(result.one));
        }
    std::vector<std::uint64_t> counts;
    if (!tried)
        for (std::uint64_t count = 1; count < most; count *= 2)
            counts.push_back(count);
    else if (most - below > 1)
        counts.push_back(below + (most - below) / 2);
    return counts;
}

}  // namespace

std::vector<Case> plan_fewer(const Campaign& campaign, const scenarios::Scenario& scenario,
                             const std::vector<CaseResult>& results, int first_id, const std::string& phase) {
    std::vector<Case> cases;
    std::set<std::string> known;
    for (const Finding& finding : findings_of(results)) {
        const CaseResult& found = *finding.smallest;
        if (found.one.faults.size() != 1 || !is_counted(found.one.faults[0])) continue;
        for (const std::uint64_t count : fewer_counts(found, results)) {
            Case one = found.one;
            one.id = first_id + static_cast<int>(cases.size());
            one.phase = phase;
            one.of = found.one.of != 0 ? found.one.of : found.one.id;
            one.faults[0]["count"] = count;
            try {
                check_fault(campaign, scenario, one.faults[0], 0);
            } catch (const InputError&) {
                break;  // a kind that does not count
            }
            if (!known.insert(fmt::format("{} {}", one.seed, one.faults[0].dump())).second) continue;
            cases.push_back(std::move(one));
        }
    }
    return cases;
}

std::vector<Case> plan_pairs(const Campaign& campaign, const std::vector<CaseResult>& singles, int first_id) {
    std::map<std::uint64_t, std::vector<const Case*>> survivors;
    for (const CaseResult& result : singles)
        if (result.one.phase == "single" && !is_finding(result.verdict.outcome) &&
            result.verdict.outcome != Outcome::NotFired)
            survivors[result.one.seed].push_back(&result.one);
    std::size_t all = 0;
    for (const auto& [seed, list] : survivors)
        all += list.size() * (list.size() - 1) / 2;
    const std::vector<std::size_t> chosen =
        sample(all, campaign.pairs, campaign.sample_seed, "campaign.pairs");
    std::vector<Case> cases;
    std::size_t index = 0;
    auto next = chosen.begin();
    for (const auto& [seed, list] : survivors)
        for (std::size_t a = 0; a < list.size(); ++a)
            for (std::size_t b = a + 1; b < list.size(); ++b, ++index) {
                if (next == chosen.end()) return cases;
                if (*next != index) continue;
                ++next;
                cases.push_back({.id = first_id + static_cast<int>(cases.size()),
                                 .phase = "pair",
                                 .sweep = list[a]->sweep == list[b]->sweep
                                              ? list[a]->sweep
                                              : list[a]->sweep + " + " + list[b]->sweep,
                                 .place = list[a]->place + " + " + list[b]->place,
                                 .seed = seed,
                                 .faults = {list[a]->faults[0], list[b]->faults[0]},
                                 .of = 0,
                                 .pruned = ""});
            }
    return cases;
}

}  // namespace puckloop::faults
