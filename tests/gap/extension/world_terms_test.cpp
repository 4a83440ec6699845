// What a term does to a robot in the world is what its table makes of the rows that a tracker without noise
// sees: the way from a learnt table to the overlay, and back, loses nothing.

#include "gap/extension/table_basis.h"
#include "tests/gap/models/made_table.h"
#include "tests/physics/worlds.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <functional>

using namespace puckloop;
using namespace puckloop::gap;
using puckloop::gap::tests::experiment_of;
using puckloop::gap::tests::Table;

namespace {

struct ShortLeg {
    double seconds, left, right;
};

constexpr int kTermRow = 100;  // ms

/// Many starts, stops and turns: what they cost adds up. Speeds that the firmware's timers make exactly.
const std::vector<ShortLeg>& short_legs() {
    static const std::vector<ShortLeg> list{{0.5, 0, 0},     {0.6, 300, 300}, {0.5, 0, 0},  {0.4, 600, 600},
                                            {0.5, 0, 0},     {3, -450, 450},  {0.5, 0, 0},  {2, 600, -600},
                                            {2, 300, 450},   {1, -300, -300}, {1, 80, 240}, {0.5, 0, 0},
                                            {0.3, 450, 450}, {0.5, 0, 0},     {2, 40, 40},  {0.5, 0, 0}};
    return list;
}

Experiment driven_with(const std::vector<physics::ExtensionTerm>& terms) {
    auto description = physics::test::world_with_robot(6, 6);
    description.robots[0].heading = 0.7;
    description.extension = terms;
    physics::WorldModel model(description);
    physics::test::Driver driver(model);
    Table table;
    const auto row = [&](const ShortLeg& leg) {
        const auto& state = model.state(0);
        table["t_s"].push_back(model.seconds());
        table["x_m"].push_back(state.x);
        table["y_m"].push_back(state.y);
        table["theta_rad"].push_back(state.heading);
        table["cmd_left"].push_back(leg.left);
        table["cmd_right"].push_back(leg.right);
    };
    for (const ShortLeg& leg : short_legs())
        for (int ms = 0; ms < std::lround(leg.seconds * 1e3); ++ms) {
            if (ms % kTermRow == 0) row(leg);
            driver.feed(leg.left, leg.right);
            model.step();
        }
    row({});
    return experiment_of(Kind::Motion, table, {{"firmware.agenda", 0}, {"firmware.start_loss", 1.1}});
}

std::vector<Subject> seen(const Experiment& experiment) {
    const auto model = make_model(experiment);
    auto values = model->neutral();
    values[*model->find("tracker.heading_span")] = std::log(0.02);  // a tracker without noise
    return subjects_of(experiment, *model, values, model->predicted(values));
}

/// Largest difference between what the term did and what its table makes of the rows, over the most it did.
double misfit_of(const std::string& quantity, const std::string& over,
                 const std::function<double(double)>& value) {
    const auto without = seen(driven_with({}));
    const std::size_t s = quantity == "motion.forward" ? 0 : quantity == "motion.left" ? 1 : 2;
    const auto found = std::ranges::find(without[s].covariates, over, &WorldCovariate::name);
    REQUIRE(found != without[s].covariates.end());
    const TableShape shape{{static_cast<std::size_t>(found - without[s].covariates.begin())}};
    const std::vector<char> all(without[s].error.size(), 1);
    LaidAxes axes(without[s], all);
    const TableBasis basis(axes, shape, 60);
    physics::ExtensionTerm term{quantity, -1, {}, {{over, basis.places()[0]}}};
    for (const double at : basis.places()[0])
        term.value.push_back(value(at));
    const Subject with = seen(driven_with({term}))[s];
    double sum = 0.0, most = 0.0, apart = 0.0;
    for (std::size_t i = 0; i < with.error.size(); ++i) {
        basis.of_row(with, i, [&](std::size_t k, double weight) { sum += weight * term.value[k]; });
        const double did = with.error[i] - without[s].error[i];
        most = std::max(most, std::abs(did));
        apart = std::max(apart, std::abs(did - sum));
    }
    CAPTURE(quantity, over, most, apart);
    REQUIRE(most > 0.0);
    return apart / most;
}

}  // namespace

TEST_CASE("a term of a drive is its table, over whatever it depends on", "[gap][extension]") {
    const auto even = [](double) { return 0.01; };
    const auto bump = [](double speed) { return 0.01 * std::exp(-std::pow((speed - 0.03) / 0.02, 2)); };
    const auto wave = [](double heading) { return 0.01 * std::sin(2 * heading); };
    const auto step = [](double time) { return time > 7 ? 0.01 : -0.005; };
    CHECK(misfit_of("motion.forward", "speed", even) < 0.01);
    CHECK(misfit_of("motion.forward", "speed", bump) < 0.015);
    CHECK(misfit_of("motion.forward", "heading", wave) < 0.02);
    CHECK(misfit_of("motion.left", "turn_rate", even) < 0.02);
    CHECK(misfit_of("motion.turn", "time", step) < 0.015);
    CHECK(misfit_of("motion.turn", "speed", bump) < 0.015);
    CHECK(misfit_of("motion.turn", "travelled", even) < 0.01);
}
