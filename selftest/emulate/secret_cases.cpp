#include "selftest/emulate/secret_cases.h"

#include "base/random.h"
#include "gap/overlay/overlay.h"
#include "gap/pipeline/analyse.h"
#include "gap/reading/read_experiment.h"
#include "selftest/emulate/rerun.h"
#include "selftest/grammar/drawn_case.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <fstream>

namespace puckloop::gap::emulate {

namespace {

/// What the recording does better than the model that is fitted: poses blurred over an exposure, fifteen rays
/// a sensor in place of five.
std::vector<std::string> finer(const std::string& kind, RandomStream& random) {
    constexpr double kShortest = 0.01, kLongest = 0.04;  // s, of a camera indoors
    if (kind == "motion")
        return {
            fmt::format("tracker.exposure={:.4f}", kShortest + (kLongest - kShortest) * random.uniform())};
    if (kind == "proximity") return {"proximity.rays=15"};
    return {};
}

/// An effect drawn from the grammar on top of what was recorded, 1 to 8 times the self test's noise.
std::string add_unknown(WrittenExperiment& recorded, RandomStream& random) {
    namespace gr = selftest::grammar;
    const auto sites = gr::sites_of(recorded.kind);
    const gr::Site site = sites[random.below(sites.size())];
    const gr::Field field = gr::drawn_field(recorded, gr::covariates_of(recorded), random);
    const double strength = std::pow(8.0, random.uniform());
    double reached = 0.0;
    const RandomStream chance(random.next(), "chance");
    const double a =
        gr::amplitude_for(recorded, site, field, strength, gr::floor_of(recorded.kind), chance, reached);
    recorded = gr::with_effect(recorded, site, field, a, chance);
    return fmt::format("{}{} ({:.1f} times the noise)", site.text(), field.text, reached);
}

constexpr std::uint64_t kSeeds = 1'000'000'000;

/// Errors with the overlay are no more than this over those of the true robot, whose chance may be more.
constexpr double kAboveFloor = 1.25;

double most_of(const RerunObservable& o) {
    return std::max(kAboveFloor * o.floor, o.floor_limit);
}

/// What a performance with the overlay shows of the change.
struct Shown {
    std::string moved;  ///< observables beyond the limit without the overlay
    std::string left;   ///< beyond it with the overlay
    bool back() const { return left.empty() && !moved.empty(); }
    bool nothing() const { return left.empty() && moved.empty(); }
};

Shown shown_by(const Rerun& again) {
    Shown shown;
    for (const RerunObservable& o : again.observables) {
        const auto note = [&](double error, std::string& names) {
            if (error > most_of(o)) names += (names.empty() ? "" : ", ") + o.name;
        };
        note(o.before, shown.moved);
        note(o.after, shown.left);
    }
    return shown;
}

std::string joined(const std::vector<std::string>& words) {
    std::string text;
    for (const std::string& word : words)
        text += (text.empty() ? "" : " ") + word;
    return text;
}

}  // namespace

Rerun performed_again(const Experiment& measured, const Verdict& verdict, const RecordOptions& recorded,
                      bool by_time) {
    constexpr double kBrief = 20.0;  // s of simulated time for each of the three
    const auto file = recorded.scratch / "overlay.toml";
    std::ofstream(file) << overlay_toml(measured, verdict);
    RerunOptions how;
    how.tools = recorded.tools;
    how.overlay = file;
    how.scratch = recorded.scratch / "again";
    how.seed = recorded.seed + 1;
    how.longest = recorded.brief ? kBrief : 0.0;  // an effect may show in a few runs only
    how.truth = recorded.robot;
    how.by_time = by_time;
    return rerun(measured, verdict, how);
}

bool is_back(const Rerun& again) {
    return !again.observables.empty() && shown_by(again).back();
}

bool shows_nothing(const Rerun& again) {
    return !again.observables.empty() && shown_by(again).nothing();
}

std::string again_text(const Rerun& again) {
    if (!again.asked) return {};
    std::string text = fmt::format("{:>13}performed again", "");
    if (!again.not_done.empty()) return text + ": not, " + again.not_done + "\n";
    for (const RerunObservable& o : again.observables)
        text += fmt::format("{} {} off by {:.3g} {} before, {:.3g} with the overlay, {:.3g} (at most {:.3g}) "
                            "the true robot",
                            &o == again.observables.data() ? ":" : ";", o.name, o.before, o.unit, o.after,
                            o.floor, most_of(o));
    const Shown shown = shown_by(again);
    const std::string verdict = shown.back()      ? "back: " + shown.moved
                                : shown.nothing() ? "the change does not show in what is performed"
                                                  : "NOT back: " + shown.left;
    return text + fmt::format("\n{:>13}{}\n", "", verdict);
}

SecretResult try_secret(std::size_t number, bool closed_loop, const RecordOptions& given) {
    const Secret& secret = secrets()[number];
    SecretResult result;
    result.secret = &secret;
    try {
        RecordOptions options = given;
        RandomStream random(given.seed, fmt::format("fidelity {}", number));
        // Drives, laboratory and noise of its own: one chance of a seed is not to count in every case.
        options.seed = random.below(kSeeds);
        auto assignments =
            closed_loop ? closed_assignments(secret) : drawn_assignments(secret, number, given.seed);
        if (!closed_loop)
            for (std::string& more : finer(secret.kind, random))
                assignments.push_back(std::move(more));
        for (const std::string& assignment : assignments)
            set_parameter(options.robot, assignment);
        result.changed = joined(assignments);
        const auto folder = given.scratch / "experiment";
        auto experiment = record(secret.kind, options);
        if (secret.unknown) result.changed += " " + add_unknown(experiment, random);
        write_folder(experiment, folder);
        Options analysis;
        analysis.seed = given.seed;
        const Experiment measured = read_experiment(folder);
        const Verdict verdict = analyse(measured, analysis);
        result.decision = std::string(decision_name(verdict.decision));
        for (const Cause& cause : verdict.causes) {
            result.named.push_back(cause.name);
            for (const FittedParameter& p : cause.parameters)
                result.told.push_back(
                    fmt::format("{} {:.4g} ({:.4g}..{:.4g}) {}", p.name, p.value, p.low, p.high, p.unit));
        }
        if (secret.unknown)
            result.found =
                verdict.decision == Decision::Unexplained || verdict.decision == Decision::CannotTell;
        else if (secret.names.empty())
            result.found = verdict.decision == Decision::NoEffect;
        else
            result.found = verdict.decision == Decision::Named &&
                           std::find(secret.names.begin(), secret.names.end(), result.named.front()) !=
                               secret.names.end();
        if (verdict.decision == Decision::Named) result.again = performed_again(measured, verdict, options);
    } catch (const std::exception& error) {
        result.decision = "error";
        result.error = error.what();
    }
    if (!given.keep) std::filesystem::remove_all(given.scratch);
    return result;
}

std::string secret_line(const SecretResult& r) {
    constexpr std::size_t kMostTold = 4;
    std::string names;
    for (const std::string& name : r.named)
        names += (names.empty() ? "" : ", ") + name;
    std::string text = fmt::format("{:<14}{:<38}{:<8}{:<12} {}{}\n", r.secret->kind, r.secret->what,
                                   r.found ? "found" : "MISSED", r.decision, names, r.error);
    if (!r.changed.empty()) text += fmt::format("{:>13}{}\n", "", r.changed);
    for (std::size_t k = 0; k < std::min(r.told.size(), kMostTold); ++k)
        text += fmt::format("{:>13}{}\n", "", r.told[k]);
    return text + again_text(r.again);
}

std::string secrets_text(const std::vector<SecretResult>& results) {
    int changed = 0, found = 0, plain = 0, quiet = 0, beyond = 0, seen = 0, again = 0, back = 0, hardly = 0;
    std::string text;
    for (const SecretResult& r : results) {
        const bool hidden = !r.secret->names.empty(), unknown = r.secret->unknown;
        (unknown ? beyond : hidden ? changed : plain) += 1;
        (unknown ? seen : hidden ? found : quiet) += r.found ? 1 : 0;
        text += secret_line(r);
        if (!hidden || !r.found) continue;
        ++again;
        if (r.again.observables.empty()) continue;
        back += shown_by(r.again).back() ? 1 : 0;
        hardly += shown_by(r.again).nothing() ? 1 : 0;
    }
    return fmt::format(
        "secret changes found: {} of {}; changes beyond the catalogue called unexplained: {} "
        "of {}; robots left alone called so: {} of {}; of {} right names performed again with "
        "their overlay {} are back at the true robot's floor (within {:.0f} % or its chance), {} "
        "do not show in what is performed\n\n{}",
        found, changed, seen, beyond, quiet, plain, again, back, 100 * (kAboveFloor - 1), hardly, text);
}

}  // namespace puckloop::gap::emulate
