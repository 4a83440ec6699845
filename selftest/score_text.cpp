// The result of a self test as text and as JSON.

#include "base/json.h"
#include "selftest/score.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

namespace puckloop::gap::selftest {

namespace {

std::string joined(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words)
        text += (text.empty() ? "" : ", ") + word;
    return text;
}

/// What stands in a confusion matrix's column: the decision, or the number of the first cause.
std::string column_of(const Judged& j) {
    if (!j.error.empty()) return "error";
    if (j.said == "named" && !j.named.empty()) return fmt::format("{}", j.named.front());
    if (j.said == "cannot_tell") return "?";
    return j.said == "no_effect" ? "none" : "unexpl";
}

std::string row_of(const Judged& j) {
    if (j.expect == Expect::NoEffect) return "none";
    if (j.expect == Expect::Unexplained) return "unknown";
    if (j.expect == Expect::CannotTell) return fmt::format("{}={}", j.numbers.front(), j.numbers.back());
    if (j.numbers.size() > 1) return "pairs";
    return fmt::format("{}", j.numbers.front());
}

/// Numbers in their order, words behind them.
bool before(const std::string& a, const std::string& b) {
    const int x = std::atoi(a.c_str()), y = std::atoi(b.c_str());
    if ((x == 0) != (y == 0)) return y == 0;
    return x != y ? x < y : a < b;
}

using Order = bool (*)(const std::string&, const std::string&);

std::string confusion(const std::vector<Judged>& cases, const std::string& kind) {
    std::set<std::string, Order> columns(before), rows(before);
    std::map<std::pair<std::string, std::string>, int> count;
    for (const Judged& j : cases) {
        if (j.kind != kind || j.strength == Strength::Low) continue;
        columns.insert(column_of(j));
        rows.insert(row_of(j));
        ++count[{row_of(j), column_of(j)}];
    }
    std::string text =
        fmt::format("\n{}: hidden (rows) and said (columns), without low strength\n\n{:>9}", kind, "");
    for (const std::string& c : columns)
        text += fmt::format("{:>7}", c);
    text += '\n';
    for (const std::string& r : rows) {
        text += fmt::format("{:>9}", r);
        for (const std::string& c : columns) {
            const auto found = count.find({r, c});
            text += found == count.end() ? fmt::format("{:>7}", ".") : fmt::format("{:>7}", found->second);
        }
        text += '\n';
    }
    return text;
}

std::string by_strength(const std::vector<Judged>& cases) {
    std::string text = "\nEffects alone: named first / first in the list / among two / cases\n\n";
    std::set<std::string> kinds;
    for (const Judged& j : cases)
        kinds.insert(j.kind);
    kinds.insert("all");
    for (const std::string& kind : kinds) {
        text += fmt::format("{:>14}", kind);
        for (const Strength s : {Strength::Low, Strength::Medium, Strength::High}) {
            int named = 0, ranked = 0, listed = 0, of = 0;
            for (const Judged& j : cases) {
                if ((kind != "all" && j.kind != kind) || j.expect != Expect::Named || j.numbers.size() != 1 ||
                    j.strength != s)
                    continue;
                ++of;
                named += j.first_right;
                ranked += j.ranked_right;
                listed += j.listed_right;
            }
            text +=
                fmt::format("   {:>6} {:>3}/{:>3}/{:>3}/{:>3}", strength_name(s), named, ranked, listed, of);
        }
        text += '\n';
    }
    return text;
}

bool missed(const Judged& j) {
    if (!j.error.empty()) return true;
    switch (j.expect) {
    case Expect::Named:
        return j.strength != Strength::Low && !(j.numbers.size() > 1 ? j.both_named : j.first_right);
    case Expect::NoEffect:
        return j.said != "no_effect";
    case Expect::Unexplained:
        return j.said != "unexplained" || !j.named.empty();
    case Expect::CannotTell:
        return j.said != "cannot_tell" || !j.listed_right;
    }
    return false;
}

}  // namespace

std::string case_line(const Judged& j) {
    std::string text = fmt::format("{:<14}{:<34}{:>7}  expected {:<12} said {:<12} {}{}  {:.1f} s{}", j.kind,
                                   j.labels.empty() ? "nothing" : joined(j.labels), strength_name(j.strength),
                                   expect_name(j.expect), j.said, joined(j.names), j.error, j.wall_s,
                                   missed(j) ? "  MISSED" : "");
    for (const Estimate& e : j.estimates)
        text += fmt::format("\n      {:<28} true {:>11.5g}  said {:>11.5g} ({:.5g}..{:.5g}){}", e.parameter,
                            e.truth, e.value, e.low, e.high, e.covered() ? "" : "  outside");
    return text;
}

std::string report_text(const std::vector<Judged>& cases, std::uint64_t seed) {
    std::string text = fmt::format("{} cases, seed {}\n\n", cases.size(), seed);
    for (const Requirement& r : requirements(cases))
        text += fmt::format("{:<52} {:>6.1f} %  (asked {:.0f}..{:.0f} %, {} cases)  {}\n", r.what,
                            100 * r.reached, 100 * r.low, 100 * r.high, r.of,
                            r.of == 0 ? "not tried"
                            : r.met() ? "met"
                                      : "MISSED");
    int pairs = 0, one = 0, both = 0, twins = 0, drawn = 0, twin_listed = 0;
    double wall = 0.0;
    for (const Judged& j : cases) {
        wall = std::max(wall, j.wall_s);
        if (j.expect == Expect::Named && j.numbers.size() > 1) {
            ++pairs;
            one += j.ranked_right;
            both += j.both_named;
        }
        if (j.expect == Expect::CannotTell) {
            ++twins;
            drawn += j.said == "cannot_tell";
            twin_listed += j.listed_right;
        }
    }
    text +=
        fmt::format("\npairs: {} of {} with one of the two first, {} with both named\n", one, pairs, both);
    text += fmt::format("experiments that cannot tell: {} of {} said so, {} with the hidden one listed\n",
                        drawn, twins, twin_listed);
    text += fmt::format("slowest verdict {:.1f} s\n", wall);
    text += by_strength(cases);
    std::set<std::string> kinds;
    for (const Judged& j : cases)
        kinds.insert(j.kind);
    for (const std::string& kind : kinds)
        text += confusion(cases, kind);
    text += "\nMissed (low strength left out)\n\n";
    for (const Judged& j : cases)
        if (missed(j))
            text += fmt::format("{:<14}{:<34}{:>7} {:>6.2f}  expected {:<12} said {:<12} {}{}\n", j.kind,
                                joined(j.labels), strength_name(j.strength), j.ratio, expect_name(j.expect),
                                j.said, joined(j.names), j.error);
    return text;
}

std::string report_json(const std::vector<Judged>& cases, std::uint64_t seed) {
    nlohmann::ordered_json root{{"seed", seed}, {"cases", cases.size()}};
    bool all = true;
    for (const Requirement& r : requirements(cases)) {
        root["requirements"].push_back({{"what", r.what},
                                        {"reached", r.reached},
                                        {"low", r.low},
                                        {"high", r.high},
                                        {"of", r.of},
                                        {"met", r.met()}});
        all = all && r.met();
    }
    root["met"] = all;
    for (const Judged& j : cases)
        root["results"].push_back({{"kind", j.kind},
                                   {"hidden", j.labels},
                                   {"numbers", j.numbers},
                                   {"strength", strength_name(j.strength)},
                                   {"ratio", j.ratio},
                                   {"expected", expect_name(j.expect)},
                                   {"said", j.said},
                                   {"causes", j.names},
                                   {"listed", j.listed},
                                   {"error", j.error},
                                   {"missed", missed(j)}});
    for (std::size_t k = 0; k < cases.size(); ++k)
        for (const Estimate& e : cases[k].estimates)
            root["results"][k]["estimates"].push_back({{"parameter", e.parameter},
                                                       {"true", e.truth},
                                                       {"value", e.value},
                                                       {"low", e.low},
                                                       {"high", e.high}});
    return root.dump(1);
}

}  // namespace puckloop::gap::selftest
