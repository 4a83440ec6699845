#include "gap/verdict/verdict.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace puckloop::gap {

namespace {

using Json = nlohmann::ordered_json;

/// JSON has no NaN or infinity.
Json number(double value) {
    return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json parameter_json(const FittedParameter& parameter) {
    return {{"name", parameter.name},
            {"value", number(parameter.value)},
            {"low", number(parameter.low)},
            {"high", number(parameter.high)},
            {"unit", parameter.unit},
            {"neutral", number(parameter.neutral)},
            {"in_simulator", parameter.in_simulator}};
}

Json cause_json(const Cause& cause) {
    Json parameters = Json::array();
    for (const auto& parameter : cause.parameters)
        parameters.push_back(parameter_json(parameter));
    return {{"name", cause.name},
            {"number", cause.number},
            {"title", cause.title},
            {"evidence",
             {{"delta_bic", number(cause.evidence)},
              {"score_gain", number(cause.score_gain)},
              {"score_low", number(cause.score_low)},
              {"score_high", number(cause.score_high)}}},
            {"parameters", parameters},
            {"sentence", cause.sentence},
            {"form", cause.form}};
}

Json held_json(const Verdict& verdict) {
    const Held& held = verdict.heldout;
    Json observables = Json::array();
    for (const auto& one : verdict.observables)
        observables.push_back({{"name", one.name},
                               {"unit", one.unit},
                               {"before", number(one.before)},
                               {"after", number(one.after)},
                               {"ratio", number(one.ratio)},
                               {"low", number(one.low)},
                               {"high", number(one.high)}});
    return {{"before", number(held.before)},
            {"after", number(held.after)},
            {"ratio", number(held.ratio)},
            {"low", number(held.low)},
            {"high", number(held.high)},
            {"score_before", number(held.score_before)},
            {"score_after", number(held.score_after)},
            {"score_gain_low", number(held.score_low)},
            {"score_gain_high", number(held.score_high)},
            {"runs", held.runs},
            {"runs_better", held.runs_better},
            {"gain", held.gain},
            {"sentence", held.sentence},
            {"observables", observables}};
}

/// Less than this share of an error is no change.
constexpr double kNoChange = 0.01;

Json grounds_json(const Grounds& g) {
    return {{"causes", g.causes},
            {"candidates", g.candidates},
            {"gain", number(g.gain.sum)},
            {"gain_sd", number(g.gain.sd)},
            {"rival", g.rival},
            {"error_falls", g.error_falls},
            {"stopped_at_end", g.stopped_at_end},
            {"left_by_shape", number(g.left_by_shape)},
            {"left_by_form", number(g.left_by_form)},
            {"left_by_run", number(g.left_by_run)},
            {"left_by_jump", number(g.left_by_jump)},
            {"left_of_readings", number(g.left_of_readings)},
            {"sums", g.sums},
            {"structure", g.structure},
            {"assumed", g.assumed},
            {"law_alone", g.law_alone},
            {"out_of_role", g.out_of_role},
            {"not_confirmed", g.not_confirmed}};
}

Json rerun_json(const Rerun& rerun) {
    if (!rerun.asked) return nullptr;
    if (!rerun.not_done.empty()) return {{"done", false}, {"why", rerun.not_done}};
    Json observables = Json::array();
    for (const RerunObservable& one : rerun.observables)
        observables.push_back({{"name", one.name},
                               {"unit", one.unit},
                               {"before", number(one.before)},
                               {"after", number(one.after)},
                               {"ratio", number(one.after / one.before)}});
    return {{"done", true},
            {"runs", rerun.runs},
            {"of_runs", rerun.of_runs},
            {"rows", rerun.rows},
            {"observables", observables},
            {"left_out", rerun.left_out},
            {"caution", rerun.caution()}};
}

Json predictive_json(const PredictiveCheck& check) {
    Json p = Json::object();
    for (const auto& curve : check.curves)
        p[curve.name] = number(curve.p);
    return {{"observable", check.observable},
            {"with_causes", check.extended},
            {"replicates", check.replicates},
            {"p", p}};
}

Json free_form_json(const FreeForm& form) {
    Json terms = Json::array();
    for (const auto& term : form.terms) {
        Json cells = Json::array();
        for (std::size_t k = 0; k < term.values.size(); ++k)
            cells.push_back({{"at", term.where[k]}, {"value", number(term.values[k])}});
        terms.push_back(
            {{"over", term.over}, {"share", number(term.share)}, {"shape", term.shape}, {"cells", cells}});
    }
    return {{"observable", form.observable},
            {"unit", form.unit},
            {"score_gain", number(form.gain)},
            {"sd", number(form.sd)},
            {"size", number(form.size)},
            {"shape", form.shape},
            {"terms", terms}};
}

}  // namespace

std::string_view decision_name(Decision decision) {
    constexpr std::string_view kNames[] = {"named", "cannot_tell", "no_effect", "unexplained"};
    return kNames[static_cast<std::size_t>(decision)];
}

std::string to_json(const Verdict& verdict) {
    Json json{{"verdict", decision_name(verdict.decision)},
              {"kind", kind_name(verdict.kind)},
              {"seed", verdict.seed},
              {"summary", verdict.summary}};
    json["causes"] = Json::array();
    for (const auto& cause : verdict.causes)
        json["causes"].push_back(cause_json(cause));
    json["rivals"] = Json::array();
    for (const auto& rival : verdict.rivals) {
        Json one = cause_json(rival.cause);
        one["instead_of"] = rival.instead_of;
        one["delta_bic"] = number(rival.delta_bic);
        one["separated_by"] = rival.separated_by;
        json["rivals"].push_back(one);
    }
    json["heldout"] = held_json(verdict);
    json["suggested_experiment"] = verdict.suggestions.empty() ? "" : verdict.suggestions.front().what;
    json["suggestions"] = Json::array();
    for (const auto& suggestion : verdict.suggestions)
        json["suggestions"].push_back(
            {{"what", suggestion.what}, {"bits", number(suggestion.bits)}, {"between", suggestion.between}});
    json["leftovers"] = Json::array();
    for (const auto& left : verdict.leftovers)
        json["leftovers"].push_back({{"observable", left.observable},
                                     {"covariate", left.covariate},
                                     {"p_value", number(left.p_value)},
                                     {"shape", left.shape}});
    json["free_form"] = {{"label", "unexplained: a correction without a mechanism"},
                         {"share", number(verdict.unexplained_share)},
                         {"forms", Json::array()}};
    for (const auto& form : verdict.free_forms)
        if (form.clear) json["free_form"]["forms"].push_back(free_form_json(form));
    json["grounds"] = grounds_json(verdict.grounds);
    json["doubt"] = verdict.doubt;
    json["nearest"] = Json::array();
    for (const auto& cause : verdict.nearest)
        json["nearest"].push_back(cause_json(cause));
    json["tried"] = Json::array();
    for (const auto& tried : verdict.tried)
        json["tried"].push_back({{"name", tried.name},
                                 {"number", tried.number},
                                 {"delta_bic", number(tried.delta_bic)},
                                 {"score_gain", number(tried.score_gain)},
                                 {"p_value", number(tried.p_value)},
                                 {"remark", tried.remark}});
    json["nuisance"] = Json::array();
    for (const auto& parameter : verdict.nuisance)
        json["nuisance"].push_back(parameter_json(parameter));
    json["posterior_predictive"] = Json::array();
    for (const auto& check : verdict.predictive)
        json["posterior_predictive"].push_back(predictive_json(check));
    json["cautions"] = verdict.cautions;
    json["rerun"] = rerun_json(verdict.rerun);
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
               "stands "
               "still";
    if (std::all_of(observables.begin(), observables.end(),
                    [&](const RerunObservable& o) { return same(o) || worse(o); }))
        return "the error does not fall: what comes at random moments comes at others when it is performed "
               "again";
    return {};
}

}  // namespace puckloop::gap
