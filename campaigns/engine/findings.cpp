#include "campaigns/engine/findings.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <tuple>

namespace puckloop::faults {

namespace {

/// Of what differs between cases of the same thing (how far a path was, which words a log had besides) only
/// the senders that fell silent, the boards and counters count; a few symptoms say what it was.
std::string signature(const Verdict& verdict) {
    constexpr std::size_t kMost = 4;
    std::string text;
    std::size_t used = 0;
    for (const std::string& symptom : verdict.symptoms) {
        if (symptom.starts_with("log of ") || symptom.find(" pauses") != std::string::npos) continue;
        if (used++ == kMost) break;
        text += (text.empty() ? "" : ", ") + symptom;
    }
    return text;
}

std::uint64_t firings(const CaseResult& result) {
    return std::accumulate(result.verdict.fired.begin(), result.verdict.fired.end(), std::uint64_t{0});
}

bool smaller(const CaseResult& a, const CaseResult& b) {
    return std::tuple(a.one.faults.size(), firings(a), a.one.id) <
           std::tuple(b.one.faults.size(), firings(b), b.one.id);
}

}  // namespace

std::vector<Finding> findings_of(const std::vector<CaseResult>& results) {
    std::map<std::tuple<Outcome, std::string, std::size_t, std::string, std::string>, Finding> groups;
    for (const CaseResult& result : results) {
        if (!is_finding(result.verdict.outcome)) continue;
        std::vector<std::string> kinds;
        for (const auto& fault : result.one.faults)
            kinds.push_back(kind_and_link(fault));
        std::sort(kinds.begin(), kinds.end());
        std::string faults;
        for (const std::string& kind : kinds)
            faults += (faults.empty() ? "" : " + ") + kind;
        const std::string symptoms = signature(result.verdict);
        Finding& finding =
            groups[{result.verdict.outcome, result.verdict.cause, kinds.size(), faults, symptoms}];
        finding.outcome = result.verdict.outcome;
        finding.cause = result.verdict.cause;
        finding.faults = faults;
        finding.symptoms = symptoms;
        finding.cases.push_back(&result);
        if (finding.smallest == nullptr || smaller(result, *finding.smallest)) finding.smallest = &result;
    }
    std::vector<Finding> list;
    for (auto& [key, finding] : groups)
        list.push_back(std::move(finding));
    return list;
}

std::vector<Cause> causes_of(const std::vector<Finding>& findings) {
    std::vector<Cause> causes;
    for (const Finding& finding : findings) {
        if (causes.empty() || causes.back().outcome != finding.outcome || causes.back().what != finding.cause)
            causes.push_back({finding.outcome, finding.cause, {}, 0});
        causes.back().findings.push_back(&finding);
        causes.back().cases += finding.cases.size();
    }
    return causes;
}

}  // namespace puckloop::faults
