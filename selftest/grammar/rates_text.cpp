#include "selftest/grammar/curves.h"
#include "selftest/grammar/rates.h"

#include "base/error.h"
#include "base/json.h"
#include "selftest/grammar/ablation.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>

namespace puckloop::gap::selftest {
template <class Json>
void to_json(Json& json, const Estimate& e) {
    json = Json{
        {"parameter", e.parameter}, {"truth", e.truth}, {"value", e.value}, {"low", e.low}, {"high", e.high}};
}
template <class Json>
void from_json(const Json& json, Estimate& e) {
    e = {json.at("parameter"), json.at("truth"), json.at("value"), json.at("low"), json.at("high")};
}
}  // namespace puckloop::gap::selftest

namespace puckloop::gap::selftest::grammar {

namespace {

std::string rate_text(const Rate& rate) {
    if (rate.of == 0) return "no case";
    return fmt::format("{:5.1f} % ({:.1f}..{:.1f}, {} of {})", 100 * rate.share(), 100 * rate.low,
                       100 * rate.high, rate.hits, rate.of);
}

/// Every class in every kind: what was said how often.
std::string by_kind(const std::vector<Outcome>& cases) {
    std::map<std::pair<std::string, Class>, std::map<std::string, int>> count;
    for (const Outcome& one : cases)
        ++count[{one.kind, one.of}][one.said];
    std::string text = "\nwhat was said\n";
    for (const auto& [key, said] : count) {
        text += fmt::format("  {:<14}{:<10}", key.first, class_name(key.second));
        for (const auto& [word, times] : said)
            text += fmt::format(" {} {}", times, word);
        text += "\n";
    }
    return text;
}

/// Rules that could go together, in the order of the decision, so that of what is refused only known effects
/// would be named besides.
std::string could_go(const std::vector<Outcome>& cases) {
    std::vector<std::string> gone;
    const auto is_gone = [&](const std::string& rule) {
        return std::find(gone.begin(), gone.end(), rule) != gone.end();
    };
    const auto named = [&](const Outcome& one) {
        const auto& enough = one.enough_against;
        return one.of != Class::Known &&
               (std::any_of(one.alone_against.begin(), one.alone_against.end(), is_gone) ||
                (!enough.empty() && std::all_of(enough.begin(), enough.end(), is_gone)));
    };
    std::string text = "\nrules without which, all together, no case but known ones would be named besides\n";
    for (const Rule& rule : rules()) {
        gone.emplace_back(rule.name);
        if (std::any_of(cases.begin(), cases.end(), named))
            gone.pop_back();
        else
            text += fmt::format("  {}\n", rule.name);
    }
    return text;
}

/// What would be named besides, were a rule of the decision left out.
std::string ablation(const std::vector<Outcome>& cases) {
    std::string text = "\nwould be named without one rule (at most, unless --ablation: what is asked after "
                       "it was not asked)\n";
    text += fmt::format("  {:<38}{:>8}{:>8}{:>10}{:>10}\n", "", "unknown", "nothing", "near miss", "known");
    for (const Rule& rule : rules()) {
        std::map<Class, int> count;
        for (const Outcome& one : cases)
            if (std::find(one.alone_against.begin(), one.alone_against.end(), rule.name) !=
                one.alone_against.end())
                ++count[one.of];
        text += fmt::format("  {:<38}{:>8}{:>8}{:>10}{:>10}\n", rule.name, count[Class::Unknown],
                            count[Class::Null], count[Class::NearMiss], count[Class::Known]);
    }
    return text;
}

/// What a result says of a case beside its number and class: written, and read again, by these names.
template <class One, class Field>
void for_each_field(One& one, const Field& field) {
    field("kind", one.kind);
    field("hidden", one.text);
    field("effect", one.effect);
    field("family", one.family);
    field("asked", one.asked);
    field("strength", one.ratio);
    field("likeness", one.likeness);
    field("runs", one.runs);
    field("redrawn", one.redrawn);
    field("said", one.said);
    field("names", one.names);
    field("right", one.right);
    field("wrong_family", one.wrong_family);
    field("other_family", one.other_family);
    field("ranks", one.ranks);
    field("covered", one.covered);
    field("estimates", one.estimates);
    field("alone_against", one.alone_against);
    field("enough_against", one.enough_against);
    field("wall_s", one.wall_s);
    field("error", one.error);
}

/// What the targets hold against the analysis; weaker effects may be passed over.
bool missed(const Outcome& one) {
    if (one.of == Class::NoisyInput) return !rightly(one);
    if (one.of == Class::NearMiss) return one.wrong_family || said_of(one) == Said::Failed;
    return !rightly(one) && (one.of == Class::Null || one.ratio >= 1);
}

}  // namespace

std::string outcome_line(const Outcome& one) {
    return fmt::format("{:>4} {:<14}{:<10}{:>5.2f}  said {:<12}{:<28} {:5.1f} s  hidden: {}", one.number,
                       one.kind, class_name(one.of), one.ratio, one.said,
                       fmt::format("{}", fmt::join(one.names, ", ")), one.wall_s,
                       one.error.empty() ? one.text : one.text + " | " + one.error);
}

std::string rates_text(const std::vector<Outcome>& cases, const std::string& seeds) {
    std::string text =
        fmt::format("{} drawn cases, seed {}; 95 % binomial intervals\n\n", cases.size(), seeds);
    for (const Target& target : targets(cases))
        text += fmt::format("{:<66} {:<36} {}\n", target.what, rate_text(target.rate),
                            target.rate.of == 0 ? ""
                            : target.met()      ? "met"
                                                : "MISSED");
    text += curves_text(cases) + by_kind(cases);
    const auto histogram = rank_histogram(cases);
    text += fmt::format("\nranks of true parameters (uniform if honest): {}; p = {:.3g}\n",
                        fmt::join(histogram, " "), uniformity(histogram));
    int other = 0, near = 0;
    for (const Outcome& one : cases) {
        near += one.of == Class::NearMiss ? 1 : 0;
        other += one.other_family ? 1 : 0;
    }
    text += fmt::format(
        "near misses named of another family than the effect they were made from, whatever else could "
        "do as much: {}\n",
        rate_text(rate_of(other, near)));
    int redrawn = 0;
    for (const Outcome& one : cases)
        redrawn += one.redrawn;
    text +=
        fmt::format("drawn again, because one effect of the catalogue could do more than half of it or the "
                    "strength could not be had: {}\n",
                    redrawn);
    text += ablation(cases) + could_go(cases) + "\nmissed\n";
    for (const Outcome& one : cases)
        if (missed(one)) text += outcome_line(one) + "\n";
    return text;
}

std::string rates_json(const std::vector<Outcome>& cases, std::uint64_t seed) {
    using Json = nlohmann::ordered_json;
    Json all = Json::array(), wanted = Json::array();
    for (const Outcome& one : cases) {
        Json row{{"number", one.number}, {"class", class_name(one.of)}};
        for_each_field(one, [&](const char* name, const auto& value) { row[name] = value; });
        all.push_back(std::move(row));
    }
    for (const Target& target : targets(cases))
        wanted.push_back({{"what", target.what},
                          {"share", target.rate.share()},
                          {"low", target.rate.low},
                          {"high", target.rate.high},
                          {"cases", target.rate.of},
                          {"met", target.met()}});
    return Json{{"seed", seed}, {"targets", wanted}, {"ranks", rank_histogram(cases)}, {"cases", all}}.dump(
        1);
}

std::vector<Outcome> outcomes_from_json(const std::string& text, const std::string& file) try {
    std::vector<Outcome> cases;
    const auto result = nlohmann::json::parse(text);
    for (const auto& one : result.at("cases")) {
        Outcome out;
        out.number = one.at("number");
        for (const Class of : {Class::Null, Class::Known, Class::NearMiss, Class::Unknown, Class::NoisyInput})
            if (one.at("class") == class_name(of)) out.of = of;
        for_each_field(out, [&](const char* name, auto& value) { one.at(name).get_to(value); });
        cases.push_back(std::move(out));
    }
    return cases;
} catch (const nlohmann::json::exception&) {
    throw InputError(file, "", "is no result of drawn cases", "gap selftest --grammar --json");
}

}  // namespace puckloop::gap::selftest::grammar
