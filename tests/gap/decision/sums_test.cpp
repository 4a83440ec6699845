// What sums of a drive say of pushes and of way lost in some rows, on toy drives there and back.

#include "gap/diagnostics/pushes.h"
#include "gap/evidence/thresholds.h"
#include "gap/fit/intervals.h"
#include "gap/fit/study.h"
#include "gap/fit_test/wander.h"
#include "gap/residual_model/free_form.h"
#include "tests/gap/candidate.h"
#include "tests/gap/decision/toy_drives.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>

using namespace puckloop;
using namespace puckloop::gap;

namespace {

/// Fitted without effects, but taking jumps for pushes of 6 mm.
State pushed_state(const Study& study) {
    State state = study.fit_none().fitted.state;
    const auto set = [&](const char* name, double value) { state.values[*study.model().find(name)] = value; };
    set("push.rate", 0.1);
    set("push.size", 0.006);
    for (auto& noise : state.noise)
        noise.carry = std::min(noise.carry, std::log(1e-4));
    return state;
}

Fit fit_of_pushes(const Study& study) {
    return study.fit_set({candidate(study, "collision_push")}, study.fit_none().fitted.state);
}

double any_way(RandomStream& random) {
    return 2 * std::numbers::pi * random.uniform();
}

const FreeForm& form_of(const std::vector<FreeForm>& forms, const std::string& observable) {
    return *std::find_if(forms.begin(), forms.end(),
                         [&](const FreeForm& form) { return form.observable == observable; });
}

}  // namespace

TEST_CASE("pushes by chance keep to nothing, those before a reversal do", "[gap][pushes]") {
    const bool by_chance = GENERATE(true, false);
    const Experiment experiment = toy_drives([&](RandomStream& random, int, int k, double) {
        const bool now = by_chance ? random.uniform() < 1.0 / kToyLeg : k == kToyLeg - 1;
        return Made{1.0, now ? 0.01 : 0.0, any_way(random)};
    });
    const Study study(experiment, 1);
    const auto pattern = push_pattern(experiment, study.model(), pushed_state(study));
    if (by_chance) {
        CHECK_FALSE(pattern.has_value());
        return;
    }
    REQUIRE(pattern.has_value());
    CHECK(pattern->where.starts_with("time since cmd"));
    CHECK(pattern->expected < 0.2 * pattern->pushes);
}

TEST_CASE("pushes each of which takes the one before back are none", "[gap][pushes]") {
    double way = 0.0;  // rad
    const Experiment experiment = toy_drives([&](RandomStream& random, int, int, double) {
        const bool now = random.uniform() < 0.03;
        if (now) way += std::numbers::pi + random.uniform();
        return Made{1.0, now ? 0.012 : 0.0, way};
    });
    const Study study(experiment, 1);
    const auto pattern = push_pattern(experiment, study.model(), fit_of_pushes(study).fitted.state);
    REQUIRE(pattern.has_value());
    CHECK(pattern->where == "against the push before");
    CHECK(pattern->pushes > 1.5 * pattern->expected);
}

TEST_CASE("a tracker that loses its place for some rows and comes back is no push", "[gap][pushes]") {
    const bool heading_too = GENERATE(false, true);
    Experiment experiment = toy_drives([](RandomStream&, int, int, double) { return Made{}; });
    RandomStream random(3, "lost places");
    for (std::size_t r = 0; r < 5; ++r) {
        const auto first = static_cast<std::size_t>(5 + 90 * random.uniform());
        const double way = any_way(random), off = heading_too ? random.normal() : 0.0;
        auto& columns = experiment.runs[r].columns;
        for (std::size_t i = first; i < first + 4 + r; ++i) {
            columns["x_m"][i] += 0.02 * std::cos(way);
            columns["y_m"][i] += 0.02 * std::sin(way);
            columns["theta_rad"][i] += off;
        }
    }
    const Study study(experiment, 1);
    const auto pattern = push_pattern(experiment, study.model(), fit_of_pushes(study).fitted.state);
    REQUIRE(pattern.has_value());
    // A heading that is off keeps to itself as well.
    if (!heading_too) CHECK(pattern->where == "back to where one before began");
}

TEST_CASE("pushes along one line or in one run of eight are none", "[gap][pushes]") {
    const bool along = GENERATE(true, false);
    int row = 0;
    const Experiment experiment = toy_drives([&](RandomStream& random, int, int, double) {
        const bool first_run = row++ < kToyLegs * kToyLeg;
        const bool now = random.uniform() < (along ? 0.03 : first_run ? 0.24 : 0.0);
        const double either = random.uniform() < 0.5 ? 0.0 : std::numbers::pi;
        return Made{1.0, now ? 0.012 : 0.0, along ? either : any_way(random)};
    });
    const Study study(experiment, 1);
    const auto pattern = push_pattern(experiment, study.model(), pushed_state(study));
    REQUIRE(pattern.has_value());
    CHECK(pattern->where == (along ? "along one line of the robot" : "some runs"));
}

TEST_CASE("jumps no larger than the noise are no pushes", "[gap][pushes]") {
    const Experiment experiment = toy_drives([&](RandomStream& random, int, int, double) {
        return Made{1.0, 3e-4 * random.normal(), any_way(random)};
    });
    const Study study(experiment, 1);
    State state = pushed_state(study);
    state.values[*study.model().find("push.size")] = 1e-3;
    state.values[*study.model().find("push.rate")] = 0.3;
    const auto pattern = push_pattern(experiment, study.model(), state);
    REQUIRE(pattern.has_value());
    CHECK(pattern->where == "rows that were as likely not pushed");
}

TEST_CASE("pushes are as large as they were made, however sharp the tracker", "[gap][pushes]") {
    const double size = 0.012;  // m, along each axis
    double squares = 0.0, pushes = 0.0;
    const Experiment experiment = toy_drives([&](RandomStream& random, int, int, double) {
        if (random.uniform() > 0.03) return Made{1.0, 0.0, 0.0};
        const double forward = size * random.normal(), aside = size * random.normal();
        squares += forward * forward + aside * aside;
        pushes += 1;
        return Made{1.0, std::hypot(forward, aside), std::atan2(aside, forward)};
    });
    const Study study(experiment, 1);
    const Fit fit = fit_of_pushes(study);
    const double made = std::sqrt(squares / (2 * pushes));
    CHECK(fit.fitted.state.values[*study.model().find("push.size")] == Approx(made).epsilon(0.1));
}

TEST_CASE("how often a robot is pushed is known as well as so few pushes can say", "[gap][pushes]") {
    const double rate = 0.03;  // a row
    double pushes = 0.0;
    const Experiment experiment = toy_drives([&](RandomStream& random, int, int, double) {
        const bool now = random.uniform() < rate;
        pushes += now ? 1 : 0;
        return Made{1.0, now ? 0.012 : 0.0, any_way(random)};
    });
    const Study study(experiment, 1);
    const Fit fit = fit_of_pushes(study);
    const Precision precision = precision_of(study, fit);
    const std::size_t index = *study.model().find("push.rate");
    for (std::size_t j = 0; j < fit.freed.size(); ++j) {
        if (fit.freed[j].index != index) continue;
        const Interval interval = interval_of(study, fit, precision, j);
        const double value = fit.fitted.state.values[index];
        INFO(pushes << " pushes, " << value << " a second, " << interval.low << " to " << interval.high);
        // Of N events the number is known to its root, 90 % to 1.645 of these.
        const double known = (interval.high - interval.low) / 2 / value * std::sqrt(pushes) / 1.645;
        CHECK(known > 0.6);
        CHECK(known < 2.0);
    }
}

TEST_CASE("commands lost for three rows on end are as rare as they were", "[gap]") {
    Experiment experiment;
    experiment.kind = Kind::Motion;
    experiment.nominal["inverse_friction"] = 0.0;
    double lost = 0.0, sent = 0.0;
    RandomStream random(4, "commands lost in threes");
    for (int r = 0; r < kToyRuns; ++r) {
        Run run;
        run.name = "run" + std::to_string(r);
        double way = 0.0, speed = 0.0;
        int silent = 0;  // rows
        for (int k = 0; k < 240; ++k) {
            const double command = k / 8 % 2 == 0 ? kToySpeed : 0.0;
            if (silent == 0 && random.uniform() < 0.03) silent = 3;
            sent += 1;
            if (silent > 0)
                --silent, lost += 1;
            else
                speed = command;
            run.columns["t_s"].push_back(kToyRow * k);
            run.columns["cmd_left"].push_back(command);
            run.columns["cmd_right"].push_back(command);
            run.columns["x_m"].push_back(way + 1e-3 * random.normal());
            run.columns["y_m"].push_back(1e-3 * random.normal());
            run.columns["theta_rad"].push_back(5e-3 * random.normal());
            way += speed * kToyRow * kToyMetre;
            ++run.rows;
        }
        experiment.runs.push_back(std::move(run));
    }
    const Study study(experiment, 1);
    const Fit fit = study.fit_set({candidate(study, "command_loss")}, study.fit_none().fitted.state);
    const Precision precision = precision_of(study, fit);
    const auto interval = [&](const char* name) {
        const auto j = std::ranges::find(fit.freed, *study.model().find(name), &Freed::index);
        REQUIRE(j != fit.freed.end());
        return interval_of(study, fit, precision, static_cast<std::size_t>(j - fit.freed.begin()));
    };
    CHECK(interval("command.loss").low < lost / sent);
    CHECK(interval("command.loss").high > lost / sent);
    CHECK(interval("command.loss_burst").low > 0.1);
}

TEST_CASE("where pushes turn the robot its way goes on as it was turned: no sum wanders for sure",
          "[gap][pushes]") {
    const Experiment experiment = toy_drives([&](RandomStream& random, int, int k, double) {
        const bool at_one_speed = k > 2 && k < kToyLeg - 2;  // else none is looked for
        const bool now = random.uniform() < 0.02 && at_one_speed;
        return Made{1.0, now ? 0.02 : 0.0, any_way(random), now ? 0.1 * random.normal() : 0.0};
    });
    const Study study(experiment, 1, 1, MotionView::Room);
    const auto nothing_named = wandering(study, study.fit_none());
    CHECK(std::any_of(nothing_named.begin(), nothing_named.end(),
                      [](const Leftover& one) { return one.p_value < thresholds::kSureWalk; }));
    for (const Leftover& left : wandering(study, fit_of_pushes(study))) {
        INFO(left.observable << " " << left.shape << ", p " << left.p_value);
        CHECK(left.p_value > thresholds::kSureWalk);
    }
}

TEST_CASE("way lost beyond a place adds up to a free form, nothing lost to none", "[gap][free form]") {
    const double share = GENERATE(1.0, 0.96);
    const Experiment experiment = toy_drives([&](RandomStream&, int, int, double x) {
        return Made{x > 0.0 ? share : 1.0, 0.0};
    });
    const Study study(experiment, 1);
    const auto forms = free_forms_of(experiment, study.model(), study.fit_none().fitted.state, 1);
    const FreeForm& along = form_of(forms, "along");
    CHECK(along.clear == (share < 1.0));
    if (share < 1.0)
        CHECK_THAT(along.shape,
                   Catch::Contains("% of distance along the heading from") && Catch::Contains("position x"));
    CHECK_FALSE(form_of(forms, "heading").clear);
}

TEST_CASE("an outlier in a run's first row is no push", "[gap][pushes]") {
    Experiment experiment = toy_drives([](RandomStream&, int, int, double) { return Made{}; });
    for (const std::size_t r : {1U, 4U})
        experiment.runs[r].columns["x_m"][0] -= 0.012;
    const Study study(experiment, 1);
    const Fit none = study.fit_none();
    const Fit pushed = study.fit_set({candidate(study, "collision_push")}, none.fitted.state, kQuick);
    CHECK(none.bic - pushed.bic < 0);
}
