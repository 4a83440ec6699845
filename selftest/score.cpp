#include "selftest/score.h"

#include <algorithm>

namespace puckloop::gap::selftest {

namespace {

/// Is this cause the hidden effect `k`?
bool is(const HiddenCase& hidden, std::size_t k, const Cause& cause) {
    if (hidden.numbers[k] != cause.number) return false;
    return k >= hidden.called.size() || hidden.called[k].empty() || hidden.called[k] == cause.name;
}

/// Any of the hidden effects; of a pair that the experiment cannot tell apart only the hidden one.
bool is_hidden(const HiddenCase& hidden, const Cause& cause) {
    const std::size_t most = hidden.expect == Expect::CannotTell ? 1 : hidden.numbers.size();
    for (std::size_t k = 0; k < std::min(most, hidden.numbers.size()); ++k)
        if (is(hidden, k, cause)) return true;
    return false;
}

void count_intervals(const HiddenCase& hidden, const Verdict& verdict, Judged& judged) {
    for (const Truth& truth : hidden.truths)
        for (const Cause& cause : verdict.causes) {
            if (!is_hidden(hidden, cause)) continue;
            for (const FittedParameter& p : cause.parameters) {
                if (p.name != truth.parameter) continue;
                judged.estimates.push_back({p.name, truth.value, p.value, p.low, p.high});
            }
        }
}

}  // namespace

Judged judge(const HiddenCase& hidden, const Verdict& verdict) {
    Judged j;
    j.kind = hidden.kind;
    j.expect = hidden.expect;
    j.strength = hidden.strength;
    j.ratio = hidden.ratio;
    j.numbers = hidden.numbers;
    j.labels = hidden.labels;
    j.said = std::string(decision_name(verdict.decision));
    for (const Cause& cause : verdict.causes) {
        j.named.push_back(cause.number);
        j.names.push_back(cause.name);
    }
    if (!verdict.causes.empty()) {
        const Cause& first = verdict.causes.front();
        j.listed.push_back(first.number);
        j.ranked_right = j.listed_right = is_hidden(hidden, first);
        for (const Rival& rival : verdict.rivals) {
            if (rival.instead_of != first.name && !rival.instead_of.empty()) continue;
            j.listed.push_back(rival.cause.number);
            j.listed_right = j.listed_right || is_hidden(hidden, rival.cause);
            break;
        }
    }
    j.first_right = j.ranked_right && verdict.decision == Decision::Named;
    j.both_named = true;
    for (std::size_t k = 0; k < hidden.numbers.size(); ++k)
        j.both_named = j.both_named && std::any_of(verdict.causes.begin(), verdict.causes.end(),
                                                   [&](const Cause& cause) { return is(hidden, k, cause); });
    if (j.first_right) count_intervals(hidden, verdict, j);
    return j;
}

std::vector<Requirement> requirements(const std::vector<Judged>& cases) {
    const auto share = [&](auto belongs, auto right) {
        int of = 0, good = 0;
        for (const Judged& j : cases)
            if (belongs(j)) {
                ++of;
                good += right(j) ? 1 : 0;
            }
        return std::pair{of == 0 ? 0.0 : static_cast<double>(good) / of, of};
    };
    std::vector<Requirement> list;
    const auto add = [&](const char* what, double low, double high, auto belongs, auto right) {
        const auto [reached, of] = share(belongs, right);
        list.push_back({what, reached, low, high, of});
    };
    const auto alone = [](Strength s) {
        return [s](const Judged& j) {
            return j.expect == Expect::Named && j.strength == s && j.numbers.size() == 1;
        };
    };
    const auto strong = [](const Judged& j) {
        return (j.expect == Expect::Named || j.expect == Expect::CannotTell) && j.strength != Strength::Low;
    };
    const auto null = [](const Judged& j) { return j.expect == Expect::NoEffect; };
    const auto unknown = [](const Judged& j) { return j.expect == Expect::Unexplained; };
    add("right cause named first, medium strength", 0.90, 1, alone(Strength::Medium),
        [](const Judged& j) { return j.first_right; });
    add("right cause named first, high strength", 0.97, 1, alone(Strength::High),
        [](const Judged& j) { return j.first_right; });
    add("true cause among the two listed, medium and high", 0.97, 1, strong,
        [](const Judged& j) { return j.listed_right; });
    add("false alarms where nothing was hidden", 0, 0.05, null,
        [](const Judged& j) { return j.said != "no_effect"; });
    add("unknown effects called unexplained", 0.90, 1, unknown,
        [](const Judged& j) { return j.said == "unexplained"; });
    add("unknown effects given a wrong name", 0, 0.05, unknown,
        [](const Judged& j) { return !j.named.empty(); });
    int intervals = 0, covered = 0;
    for (const Judged& j : cases)
        for (const Estimate& estimate : j.estimates) {
            ++intervals;
            covered += estimate.covered() ? 1 : 0;
        }
    list.push_back({"90 % intervals that hold the true parameter",
                    intervals == 0 ? 0.0 : static_cast<double>(covered) / intervals, 0.85, 0.95, intervals});
    return list;
}

}  // namespace puckloop::gap::selftest
