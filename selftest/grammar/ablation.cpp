#include "selftest/grammar/ablation.h"

namespace puckloop::gap::selftest::grammar {

std::span<const Rule> rules() {
    static constexpr Rule kRules[] = {
        {"standard errors of the gain", [](Grounds& g) { g.gain.sd = 0.0; }},
        {"price of the catalogue's size", [](Grounds& g) { g.candidates = g.causes; }},
        {"error falls for sure (few runs)", [](Grounds& g) { g.error_falls = true; }},
        {"more than the rounding", [](Grounds& g) { g.in_rounding = false; }},
        {"nothing merely assumed", [](Grounds& g) { g.assumed.clear(); }},
        {"share left: functions of covariates",
         [](Grounds& g) { g.left_by_shape = g.left_of_readings = 0.0; }},
        {"share left: readings beside sums", [](Grounds& g) { g.left_of_readings = 0.0; }},
        {"share left: structures", [](Grounds& g) { g.left_by_structure = 0.0; }},
        {"share left: bent forms", [](Grounds& g) { g.left_by_form = 0.0; }},
        {"share left: numbers of runs", [](Grounds& g) { g.left_by_run = 0.0; }},
        {"stopped at the end of its range", [](Grounds& g) { g.stopped_at_end = false; }},
        {"identified by these data", [](Grounds& g) { g.not_identified.clear(); }},
        {"role", [](Grounds& g) { g.out_of_role.clear(); }},
        {"confirmation", [](Grounds& g) { g.not_confirmed.clear(); }},
        {"no rival", [](Grounds& g) { g.rival = false; }},
    };
    return kRules;
}

namespace {
bool named(const Grounds& g) {
    return decision_of(g, doubt_of(g)) == Decision::Named;
}
}  // namespace

std::vector<std::string> alone_against(const Grounds& grounds) {
    std::vector<std::string> alone;
    if (grounds.causes == 0 || named(grounds)) return alone;
    for (const Rule& rule : rules()) {
        Grounds without = grounds;
        rule.leave_out(without);
        if (named(without)) alone.emplace_back(rule.name);
    }
    return alone;
}

std::vector<std::string> enough_against(const Grounds& grounds) {
    std::vector<std::string> enough;
    if (grounds.causes == 0) return enough;
    for (const Rule& rule : rules()) {
        Grounds only = grounds;
        for (const Rule& other : rules())
            if (&other != &rule) other.leave_out(only);
        if (!named(only)) enough.emplace_back(rule.name);
    }
    return enough;
}

}  // namespace puckloop::gap::selftest::grammar
