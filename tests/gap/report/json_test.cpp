// gap.json holds what docs/gap.md lists.

#include "base/json.h"
#include "tests/gap/report/made_verdict.h"

#include <catch2/catch.hpp>

#include <fstream>
#include <iterator>
#include <set>
#include <string>

using namespace puckloop::gap;
using Json = nlohmann::json;

namespace {

/// A verdict that leaves no list empty.
Verdict full_verdict() {
    Verdict v = tests::made_verdict(tests::made_experiment());
    v.nearest = v.causes;
    v.nuisance = v.causes.front().parameters;
    v.leftovers = {{"reading", "distance", 1e-6, "rises"}};
    FreeForm form;
    form.observable = "reading";
    form.clear = true;
    form.terms = {{"distance", 0.5, {"distance 0.1"}, {3.0}, "rises"}};
    v.free_forms = {form};
    PredictiveCheck check;
    check.observable = "reading";
    check.curves.push_back({.name = "marginal law", .x_label = "", .y_label = "", .residual = {}});
    v.predictive = {check};
    v.rerun.asked = true;
    v.rerun.observables = {{"reading", "counts", 5.0, 2.0, 0.0}};
    return v;
}

void gather(const Json& json, std::set<std::string>& keys) {
    for (const auto& [key, value] : json.items()) {
        if (json.is_object()) keys.insert(key);
        if (key != "p" && value.is_structured())
            gather(value, keys);  // by discrepancy, whose names are the data's
    }
}

std::string section_of_docs() {
    std::ifstream stream(PUCKLOOP_SOURCE "/docs/gap.md");
    const std::string text{std::istreambuf_iterator<char>(stream), {}};
    const auto begin = text.find("\n## gap.json\n");
    return text.substr(begin, text.find("\n## ", begin + 1) - begin);
}

}  // namespace

TEST_CASE("every key of gap.json is named in its section of docs/gap.md") {
    Verdict verdict = full_verdict();
    std::set<std::string> keys;
    gather(Json::parse(to_json(verdict)), keys);
    verdict.rerun.not_done = "no firmware";
    gather(Json::parse(to_json(verdict)), keys);
    CHECK(keys.contains("grounds"));
    CHECK(keys.contains("cells"));
    CHECK(keys.contains("why"));
    const std::string docs = section_of_docs();
    for (const std::string& key : keys) {
        INFO(key);
        CHECK(docs.find("`" + key + "`") != std::string::npos);
    }
}

TEST_CASE("an effect whose fit failed has no figure") {
    Verdict verdict = full_verdict();
    verdict.tried.front().delta_bic = std::nan("");
    CHECK(Json::parse(to_json(verdict)).at("tried").at(0).at("delta_bic").is_null());
}
