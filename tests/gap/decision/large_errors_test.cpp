// Errors of which a few are larger: their law gains on runs that were not fitted where errors follow it, and
// nowhere else; and a cause that gains no more than it is none.

#include "base/random.h"
#include "gap/decide/decide.h"
#include "gap/decide/no_mechanism.h"
#include "gap/decide/roles.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <functional>
#include <numeric>

using namespace puckloop;
using namespace puckloop::gap;

namespace {

double gained(std::uint64_t seed, const std::function<double(RandomStream&)>& error) {
    RandomStream random(seed, "large errors test");
    Experiment experiment;
    experiment.kind = Kind::Ground;
    experiment.instruments["reading"] = {0, 967, 1};
    for (int r = 0; r < 8; ++r) {
        Run run;
        run.name = "run" + std::to_string(r);
        run.rows = 200;
        for (int k = 0; k < 200; ++k) {
            const double grey = 0.3 + 0.4 * random.uniform();
            run.columns["t_s"].push_back(0.1 * k);
            run.columns["grey"].push_back(grey);
            run.columns["reading"].push_back(std::round(329 + (953 - 329) * grey + 3 * error(random)));
        }
        experiment.runs.push_back(std::move(run));
    }
    const Study study(experiment, 1);
    const Fit none = study.fit_none();
    const auto scores = scores_with_large_errors(study, none, {"reading"});
    return std::accumulate(scores.begin(), scores.end(), 0.0) -
           log_likelihood(study.model(), none.fitted.state);
}

/// Strengths of messages that come by another path with this chance; one error in forty is `factor` larger.
bool keeps_reflections(std::uint64_t seed, double reflected, double factor) {
    RandomStream random(seed, "large errors test/reflections");
    Experiment experiment;
    experiment.kind = Kind::Rab;
    for (int r = 0; r < 8; ++r) {
        Run run;
        run.name = "run" + std::to_string(r);
        run.rows = 150;
        for (int k = 0; k < 150; ++k) {
            run.columns["t_s"].push_back(0.1 * k);
            run.columns["distance_m"].push_back(0.2);
            const double usual = 0.12 * random.normal() * (random.uniform() < 0.025 ? factor : 1);
            const double lost = random.uniform() < reflected ? 1.0 : 0.0;
            run.columns["strength"].push_back(std::round(std::exp(6.98 + usual - lost)));
        }
        experiment.runs.push_back(std::move(run));
    }
    const Study study(experiment, 1);
    const auto candidates = study.candidates();
    std::size_t multipath = 0;
    while (candidates[multipath].effect->name != std::string_view("multipath"))
        ++multipath;
    const Fit fit = study.fit_set({multipath}, study.fit_none().fitted.state);
    const auto share = *study.model().find("rab.multipath");
    return fit.fitted.state.values[share] > 0 &&
           out_of_role(study, fit, study.hold_out(fit), {}, 1).effects.empty();
}

}  // namespace

TEST_CASE("a cause of large errors stands beside others that a law makes, not in their place") {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        CHECK(keeps_reflections(seed, 0.03, 1));
        CHECK(keeps_reflections(seed, 0.03, 8));
        CHECK_FALSE(keeps_reflections(seed, 0.0, 8));
    }
}

TEST_CASE("a law of a few larger errors gains where errors follow it, and only there") {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        CHECK(gained(seed, [](RandomStream& r) { return r.normal() * (r.uniform() < 0.02 ? 8 : 1); }) > 8);
        CHECK(gained(seed, [](RandomStream& r) { return r.normal(); }) < 3);
        CHECK(gained(seed, [](RandomStream& r) {
                  double squares = 0;
                  for (int k = 0; k < 5; ++k)
                      squares += std::pow(r.normal(), 2);
                  return r.normal() / std::sqrt(squares / 5);
              }) < 6);
    }
    const auto none = gained(1, [](RandomStream& r) { return r.normal(); });
    CHECK(none == gained(1, [](RandomStream& r) { return r.normal(); }));
}

TEST_CASE("a cause that gains no more than a law of errors is no effect, unless something else is left") {
    Grounds grounds;
    grounds.causes = 1;
    grounds.candidates = 19;
    grounds.gain = gain_of({9, 8, 7, 9, 8, 9});
    CHECK(decision_of(grounds, doubt_of(grounds)) == Decision::Named);
    grounds.out_of_role = "explains no more";
    CHECK(decision_of(grounds, doubt_of(grounds)) == Decision::Unexplained);
    grounds.law_alone = true;
    CHECK(decision_of(grounds, doubt_of(grounds)) == Decision::NoEffect);
    grounds.structure = true;
    CHECK(decision_of(grounds, doubt_of(grounds)) == Decision::Unexplained);
}
