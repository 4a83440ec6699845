#include "gap/verdict/verdict.h"

#include "base/json.h"

#include <algorithm>
#include <iterator>
#include <map>

namespace puckloop::gap {

using Json = nlohmann::ordered_json;  // writes NaN and infinity as null

// Found by the library for each entry of a list.
static void to_json(Json& json, const FittedParameter& p) {
    json = {{"name", p.name},
            {"value", p.value},
            {"low", p.low},
            {"high", p.high},
            {"unit", p.unit},
            {"neutral", p.neutral},
            {"in_simulator", p.in_simulator},
            {"as_likely", p.as_likely}};
}

static void to_json(Json& json, const Cause& cause) {
    json = {{"name", cause.name},
            {"number", cause.number},
            {"title", cause.title},
            {"evidence",
             {{"delta_bic", cause.evidence},
              {"score_gain", cause.score_gain},
              {"score_low", cause.score_low},
              {"score_high", cause.score_high}}},
            {"parameters", cause.parameters},
            {"sentence", cause.sentence},
            {"form", cause.form}};
}

static void to_json(Json& json, const Rival& rival) {
    json = rival.cause;
    json["instead_of"] = rival.instead_of;
    json["delta_bic"] = rival.delta_bic;
    json["separated_by"] = rival.separated_by;
}

static void to_json(Json& json, const HeldObservable& one) {
    json = {{"name", one.name},   {"unit", one.unit}, {"before", one.before}, {"after", one.after},
            {"ratio", one.ratio}, {"low", one.low},   {"high", one.high}};
}

static void to_json(Json& json, const Suggestion& one) {
    json = {{"what", one.what}, {"bits", one.bits}, {"between", one.between}, {"rank", one.rank}};
}

static void to_json(Json& json, const Leftover& left) {
    json = {{"observable", left.observable},
            {"covariate", left.covariate},
            {"p_value", left.p_value},
            {"shape", left.shape}};
}

static void to_json(Json& json, const Tried& tried) {
    json = {{"name", tried.name},           {"number", tried.number},
            {"delta_bic", tried.delta_bic}, {"score_gain", tried.score_gain},
            {"p_value", tried.p_value},     {"remark", tried.remark}};
}

static void to_json(Json& json, const RerunObservable& one) {
    json = {{"name", one.name},
            {"unit", one.unit},
            {"before", one.before},
            {"after", one.after},
            {"ratio", one.after / one.before}};
}

static void to_json(Json& json, const PredictiveCheck& check) {
    Json p = Json::object();
    for (const auto& curve : check.curves)
        p[curve.name] = curve.p;
    json = {{"observable", check.observable},
            {"with_causes", check.extended},
            {"replicates", check.replicates},
            {"p", p}};
}

static void to_json(Json& json, const FreeFormTerm& term) {
    Json cells = Json::array();
    for (std::size_t k = 0; k < term.values.size(); ++k)
        cells.push_back({{"at", term.where[k]}, {"value", term.values[k]}});
    json = {{"over", term.over}, {"share", term.share}, {"shape", term.shape}, {"cells", cells}};
}

static void to_json(Json& json, const FreeForm& form) {
    json = {{"observable", form.observable},
            {"unit", form.unit},
            {"score_gain", form.gain},
            {"sd", form.sd},
            {"size", form.size},
            {"shape", form.shape},
            {"terms", form.terms}};
}

static void to_json(Json& json, const LearntTable& table) {
    json = Json::object();
    if (table.sensor >= 0) json["sensor"] = table.sensor;
    json["times"] = table.times;
    json["over"] = table.over;
    json["at"] = table.at;
    json["value"] = table.value;
    json["sd"] = table.sd;
    json["run_spread"] = table.run_spread;
}

static void to_json(Json& json, const Extended& one) {
    json = {{"observable", one.observable},
            {"unit", one.unit},
            {"adds_to", one.quantity},
            {"adds_to_unit", one.quantity_unit},
            {"before", one.before},
            {"named", one.named},
            {"extended", one.extended},
            {"ratio", one.ratio},
            {"low", one.low},
            {"high", one.high},
            {"score_gain", one.gain},
            {"sd", one.gain_sd},
            {"blocks_better", one.better},
            {"blocks", one.blocks},
            {"kept", one.kept},
            {"formula", one.formula},
            {"tables", one.tables}};
}

namespace {

/// Less than this share of an error is no change.
constexpr double kNoChange = 0.01;

Json held_json(const Held& held, const std::vector<HeldObservable>& observables) {
    return {{"before", held.before},
            {"after", held.after},
            {"ratio", held.ratio},
            {"low", held.low},
            {"high", held.high},
            {"score_before", held.score_before},
            {"score_after", held.score_after},
            {"score_gain_low", held.score_low},
            {"score_gain_high", held.score_high},
            {"runs", held.runs},
            {"runs_better", held.runs_better},
            {"gain", held.gain},
            {"sentence", held.sentence},
            {"observables", observables}};
}

Json grounds_json(const Grounds& g) {
    return {{"causes", g.causes},
            {"candidates", g.candidates},
            {"gain", g.gain.sum},
            {"gain_sd", g.gain.sd},
            {"rival", g.rival},
            {"error_falls", g.error_falls},
            {"stopped_at_end", g.stopped_at_end},
            {"left_by_shape", g.left_by_shape},
            {"left_by_form", g.left_by_form},
            {"left_by_run", g.left_by_run},
            {"left_of_readings", g.left_of_readings},
            {"sums", g.sums},
            {"structure", g.structure},
            {"only_wanders", g.only_wanders},
            {"assumed", g.assumed},
            {"law_alone", g.law_alone},
            {"not_identified", g.not_identified},
            {"out_of_role", g.out_of_role},
            {"not_confirmed", g.not_confirmed}};
}

Json rerun_json(const Rerun& rerun) {
    if (!rerun.asked) return nullptr;
    if (!rerun.not_done.empty()) return {{"done", false}, {"why", rerun.not_done}};
    return {{"done", true},
            {"runs", rerun.runs},
            {"of_runs", rerun.of_runs},
            {"rows", rerun.rows},
            {"observables", rerun.observables},
            {"left_out", rerun.left_out},
            {"caution", rerun.caution()}};
}

}  // namespace

std::string_view decision_name(Decision decision) {
    constexpr std::string_view kNames[] = {"named", "cannot_tell", "no_effect", "unexplained",
                                           "not_identifiable"};
    return kNames[static_cast<std::size_t>(decision)];
}

std::string to_json(const Verdict& verdict) {
    std::vector<FreeForm> clear;
    std::copy_if(verdict.free_forms.begin(), verdict.free_forms.end(), std::back_inserter(clear),
                 [](const FreeForm& form) { return form.clear; });
    const Json json{
        {"verdict", decision_name(verdict.decision)},
        {"kind", kind_name(verdict.kind)},
        {"seed", verdict.seed},
        {"summary", verdict.summary},
        {"causes", verdict.causes},
        {"rivals", verdict.rivals},
        {"heldout", held_json(verdict.heldout, verdict.observables)},
        {"suggested_experiment", verdict.suggestions.empty() ? "" : verdict.suggestions.front().what},
        {"suggestions", verdict.suggestions},
        {"leftovers", verdict.leftovers},
        {"free_form",
         {{"label", "unexplained: a correction without a mechanism"},
          {"share", verdict.unexplained_share},
          {"forms", clear}}},
        {"grounds", grounds_json(verdict.grounds)},
        {"doubt", verdict.doubt},
        {"nearest", verdict.nearest},
        {"confirmation",
         {{"runs", verdict.confirmation.runs},
          {"scored", verdict.confirmation.scored},
          {"chosen", verdict.confirmation.chosen},
          {"gain", verdict.confirmation.gain},
          {"sentence", verdict.confirmation.sentence}}},
        {"extension",
         {{"not_asked", verdict.extension.not_asked},
          {"by_runs", verdict.extension.by_runs},
          {"sentence", verdict.extension.sentence},
          {"observables", verdict.extension.observables}}},
        {"tried", verdict.tried},
        {"nuisance", verdict.nuisance},
        {"posterior_predictive", verdict.predictive},
        {"cautions", verdict.cautions},
        {"rerun", rerun_json(verdict.rerun)}};
    return json.dump(2) + "\n";
}

bool doubtful(const Verdict& verdict) {
    constexpr double kSmallPart = 0.2;
    double all = 0.0;
    for (const Cause& cause : verdict.causes)
        all += std::max(cause.score_gain, 0.0);
    return std::any_of(verdict.rivals.begin(), verdict.rivals.end(), [&](const Rival& rival) {
        return std::any_of(verdict.causes.begin(), verdict.causes.end(), [&](const Cause& cause) {
            const bool matters = &cause == &verdict.causes.front() || cause.score_gain > kSmallPart * all;
            return cause.name == rival.instead_of && matters;
        });
    });
}

std::string Rerun::caution() const {
    const auto same = [](const RerunObservable& o) {
        return std::abs(o.after - o.before) <= kNoChange * std::max(o.before, o.after);
    };
    const auto worse = [](const RerunObservable& o) { return o.after > (1 + kNoChange) * o.before; };
    if (!not_done.empty() || observables.empty()) return {};
    if (std::all_of(observables.begin(), observables.end(), same))
        return "what was performed does not show the cause: it acts elsewhere, or moves no mean of what "
               "stands still";
    if (std::all_of(observables.begin(), observables.end(),
                    [&](const RerunObservable& o) { return same(o) || worse(o); }))
        return "the error does not fall: what comes at random moments comes at others when it is performed "
               "again";
    return {};
}

}  // namespace puckloop::gap
