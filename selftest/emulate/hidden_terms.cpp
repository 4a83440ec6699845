#include "selftest/emulate/hidden_terms.h"

#include "base/files/text_file.h"
#include "base/random.h"
#include "gap/pipeline/analyse.h"
#include "gap/reading/read_experiment.h"
#include "gap/stats/rate.h"
#include "selftest/emulate/secret_cases.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <filesystem>
#include <numbers>
#include <string_view>

namespace puckloop::gap::emulate {

namespace {

constexpr std::size_t kPlaces = 25, kPlacesOfTwo = 9;  // of a table over one covariate, and over each of two
constexpr double kTwo = 0.3;                           // of the terms are over two
constexpr std::uint64_t kTermSeeds = 1'000'000'000;

/// A covariate with the values that the recorded experiments try.
struct Tried {
    const char* name;
    double low, high;
};

/// A quantity, what it may depend on, and how large the term may be, root mean square in its unit.
struct TermSite {
    const char *kind, *quantity;
    double least, most;
    std::vector<Tried> over;
};

const std::vector<TermSite>& places() {
    static const Tried kSpeed{"speed", -0.13, 0.13}, kTurn{"turn_rate", -3, 3},
        kHeading{"heading", -std::numbers::pi, std::numbers::pi}, kTime{"time", 0, 16},
        kDistance{"distance", 0, 0.11}, kAngle{"angle", 0, 1.1}, kGrey{"grey", 0, 1},
        kPitch{"pitch", -0.4, 0.4}, kRoll{"roll", -0.4, 0.4};
    // Sizes: a few to some ten times the noise of each; of levels, whose windows scatter by 12 %, one to four
    // times.
    static const std::vector<TermSite> all{
        {"motion", "motion.forward", 0.002, 0.01, {kSpeed, kTurn, kHeading, kTime}},
        {"motion", "motion.turn", 0.03, 0.15, {kSpeed, kTurn, kHeading, kTime}},
        {"proximity", "proximity.reading", 20, 120, {kDistance, kAngle, kTime}},
        {"ground", "ground.reading", 10, 50, {kGrey, kSpeed, kTime}},
        {"accelerometer", "accelerometer.x", 20, 80, {kPitch, kRoll, kTime}},
        {"accelerometer", "accelerometer.y", 20, 80, {kPitch, kRoll, kTime}},
        {"microphone", "microphone.level", 50, 200, {kTime}},
    };
    return all;
}

constexpr std::array<const char*, 5> kKindsInTurn{"motion", "proximity", "ground", "accelerometer",
                                                  "microphone"};

bool knows(const char* quantity, const char* covariate) {
    const auto extended = physics::extended_named(quantity);
    const auto known = physics::known_named(covariate);
    if (!extended || !known) return false;
    const auto& all = physics::extended_quantities()[static_cast<std::size_t>(*extended)].knows;
    return std::find(all.begin(), all.end(), *known) != all.end();
}

/// A form over 0 to 1, about nothing on average. `round`: both ends are one place, so that a wave has whole
/// waves, and what steps up steps down again; a robot would be held where they are not.
struct Form {
    int shape;
    double at, waves;
    bool round = false;
    double operator()(double u) const {
        constexpr double kRise = 0.04;
        const double turn = 2 * std::numbers::pi;
        if (shape == 0) return std::sin(turn * ((round ? std::round(waves) : waves) * u + at));
        if (shape == 1) return std::exp(-std::pow((u - at) / 0.12, 2)) - 0.2;
        return std::tanh((round ? std::sin(turn * (u - at)) / turn : u - at) / kRise);  // a step
    }
    const char* words() const { return shape == 0 ? "a wave" : shape == 1 ? "a bump" : "a step"; }
};

Form drawn_form(RandomStream& random) {
    return {static_cast<int>(random.below(3)), 0.25 + 0.5 * random.uniform(), 1.2 + 1.3 * random.uniform()};
}

std::vector<double> spread_over(const Tried& one, std::size_t count) {
    std::vector<double> at;
    for (std::size_t k = 0; k < count; ++k)
        at.push_back(one.low +
                     (one.high - one.low) * static_cast<double>(k) / static_cast<double>(count - 1));
    return at;
}

}  // namespace

HiddenTerm drawn_term(std::size_t number, std::uint64_t seed) {
    RandomStream random(seed, fmt::format("hidden term {}", number));
    HiddenTerm hidden;
    hidden.kind = kKindsInTurn[number % kKindsInTurn.size()];
    std::vector<const TermSite*> own;
    for (const TermSite& place : places())
        if (place.kind == hidden.kind) own.push_back(&place);
    const TermSite& place = *own[random.below(own.size())];
    std::vector<Tried> tried;
    for (const Tried& one : place.over)
        if (knows(place.quantity, one.name)) tried.push_back(one);
    const std::size_t first = random.below(tried.size());
    const bool two = tried.size() > 1 && random.uniform() < kTwo;
    const std::size_t second =
        (first + 1 + random.below(std::max<std::size_t>(tried.size() - 1, 1))) % tried.size();
    Form form = drawn_form(random), other = drawn_form(random);
    form.round = std::string_view(tried[first].name) == "heading";
    other.round = std::string_view(tried[second].name) == "heading";
    const double size = place.least * std::pow(place.most / place.least, random.uniform());
    const std::size_t count = two ? kPlacesOfTwo : kPlaces;
    hidden.term.adds_to = place.quantity;
    hidden.term.over.push_back({tried[first].name, spread_over(tried[first], count)});
    if (two) hidden.term.over.push_back({tried[second].name, spread_over(tried[second], count)});
    double sum = 0.0;
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t j = 0; j < (two ? count : 1); ++j) {
            const auto share = [&](std::size_t k) {
                return static_cast<double>(k) / static_cast<double>(count - 1);
            };
            hidden.term.value.push_back(form(share(i)) * (two ? other(share(j)) : 1.0));
            sum += hidden.term.value.back() * hidden.term.value.back();
        }
    const double scale = size / std::sqrt(sum / static_cast<double>(hidden.term.value.size()));
    for (double& value : hidden.term.value)
        value *= scale;
    const auto unit =
        physics::extended_quantities()[static_cast<std::size_t>(*physics::extended_named(place.quantity))]
            .unit;
    hidden.words = fmt::format("{}: {} over {}{}, {:.3g} {}", place.quantity, form.words(), tried[first].name,
                               two ? fmt::format(" times {} over {}", other.words(), tried[second].name) : "",
                               size, unit);
    return hidden;
}

std::string term_toml(const physics::ExtensionTerm& term) {
    std::vector<std::string> over, at;
    for (const physics::ExtensionAxis& axis : term.over) {
        over.push_back(fmt::format("\"{}\"", axis.over));
        at.push_back(fmt::format("[{:.9g}]", fmt::join(axis.at, ", ")));
    }
    return fmt::format("[[extension]]\nadds_to = \"{}\"\nover = [{}]\nat = [{}]\nvalue = [{:.9g}]\n",
                       term.adds_to, fmt::join(over, ", "), fmt::join(at, ", "), fmt::join(term.value, ", "));
}

TermResult try_term(std::size_t number, const RecordOptions& given) {
    TermResult result;
    result.hidden = drawn_term(number, given.seed);
    try {
        RecordOptions options = given;
        RandomStream random(given.seed, fmt::format("hidden term's laboratory {}", number));
        options.seed = random.below(kTermSeeds);
        std::filesystem::create_directories(given.scratch);
        options.robot.overlay = given.scratch / "hidden.toml";
        write_file(options.robot.overlay, term_toml(result.hidden.term));
        const auto folder = given.scratch / "experiment";
        write_folder(record(result.hidden.kind, options), folder);
        Options analysis;
        analysis.seed = given.seed;
        const Experiment measured = read_experiment(folder);
        const Verdict verdict = analyse(measured, analysis);
        result.decision = std::string(decision_name(verdict.decision));
        for (const Cause& cause : verdict.causes)
            result.named.push_back(cause.name);
        const auto& over = result.hidden.term.over;
        result.again =
            performed_again(measured, verdict, options,
                            std::ranges::find(over, "time", &physics::ExtensionAxis::over) != over.end());
    } catch (const std::exception& error) {
        result.decision = "error";
        result.error = error.what();
    }
    if (!given.keep) std::filesystem::remove_all(given.scratch);
    return result;
}

std::string term_line(const TermResult& r) {
    return fmt::format("{:<14}{}: {}{}{}{}\n", r.hidden.kind, r.hidden.words, r.decision,
                       r.named.empty() ? "" : " ", fmt::join(r.named, ", "),
                       r.error.empty() ? "" : ": " + r.error) +
           again_text(r.again);
}

std::string terms_text(const std::vector<TermResult>& results) {
    const auto count = [&](const auto& is) {
        return static_cast<int>(std::count_if(results.begin(), results.end(), is));
    };
    const int all = static_cast<int>(results.size());
    const int back = count([](const TermResult& r) { return is_back(r.again); });
    const int unseen = count([](const TermResult& r) { return shows_nothing(r.again); });
    const int named = count([](const TermResult& r) { return !r.named.empty(); });
    const int unexplained = count([](const TermResult& r) {
        return r.decision == decision_name(Decision::Unexplained) ||
               r.decision == decision_name(Decision::CannotTell);
    });
    const int failed = count([](const TermResult& r) { return !r.error.empty(); });
    return fmt::format(
        "{} robots with a term that is in no catalogue; shares with 95 % limits\n"
        "back at the true robot's floor with the overlay  {}\n"
        "the same without those where the term does not show in what is performed  {}\n"
        "called unexplained or cannot tell  {}\n"
        "given a name  {}\n"
        "failed  {}\n"
        "The hidden term is a table of the same form as those of an overlay, at the same place in the "
        "world: that favours the method.\n",
        all, share_text(rate_of(back, all)), share_text(rate_of(back, all - unseen)),
        share_text(rate_of(unexplained, all)), share_text(rate_of(named, all)),
        share_text(rate_of(failed, all)));
}

}  // namespace puckloop::gap::emulate
