// What a verdict's overlay says, and that every effect enters the simulator where its file puts it.

#include "gap/effects/effect.h"
#include "gap/overlay/overlay.h"
#include "gap/overlay/overlay_parts.h"
#include "gap/pipeline/analyse.h"
#include "physics/description/parameters.h"
#include "scenarios/reader/read_scenario.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <regex>

using namespace puckloop;
using namespace puckloop::gap;
using Catch::Matchers::Contains;

namespace {

Verdict said(const std::map<std::string, double>& parameters) {
    Verdict verdict;
    verdict.decision = Decision::Named;
    verdict.causes.emplace_back();
    for (const auto& [name, value] : parameters) {
        verdict.causes[0].parameters.emplace_back();
        verdict.causes[0].parameters.back().name = name;
        verdict.causes[0].parameters.back().value = value;
    }
    return verdict;
}

/// The parameters of a scenario of one robot that loads the overlay.
physics::Parameters loaded(const Experiment& experiment, const std::map<std::string, double>& parameters) {
    scenarios::Scenario scenario;
    scenario.world.arena = physics::rectangular_arena(1, 1);
    const auto file = tests::scratch_path("overlay_test.toml");
    std::ofstream(file) << overlay_toml(experiment, said(parameters));
    scenarios::apply_overlay(scenario, file);
    std::filesystem::remove(file);
    physics::Parameters result;
    for (const auto& [name, value] : scenario.world.parameters)
        result.set(name, value);
    return result;
}

/// "a*|b": one of the first kind, "a0" (boards number from 1).
std::string one_of(std::string name) {
    if (const auto other = name.find('|'); other != std::string::npos) name = name.substr(other + 1);
    if (name.ends_with('*')) name.back() = name.starts_with("rab.") ? '1' : '0';
    return name;
}

/// Nothing of it stands under [measurement].
bool taken_whole(const Effect& effect) {
    std::map<std::string, double> values;
    for (const EffectParameter& p : effect.parameters)
        values[one_of(p.name)] = p.low + 0.4 * (p.high - p.low);
    Experiment experiment;
    experiment.kind = effect.kinds.front();
    return overlay_toml(experiment, said(values)).find("\n[measurement]") == std::string::npos;
}

bool takes_any(const Effect& effect) {
    return std::any_of(effect.parameters.begin(), effect.parameters.end(),
                       [](const EffectParameter& p) { return overlay_takes(one_of(p.name)); });
}

}  // namespace

TEST_CASE("every effect enters the simulator where its file puts it") {
    for (const Effect& effect : catalogue()) {
        INFO(effect.name << ": " << effect.enters);
        const std::string where = effect.enters;
        const bool nowhere = where.starts_with("nothing") || where.starts_with("measuring chain") ||
                             where.starts_with("emerges");
        CHECK(takes_any(effect) == !nowhere);
        // What is named is a parameter of the world.
        static const std::regex name(
            "(contact|ground|ir|light|microphone|proximity|push|robot|world|accelerometer)\\.[a-z_]+");
        for (std::sregex_iterator at(where.begin(), where.end(), name), end; at != end; ++at) {
            int index = -1;
            CHECK(physics::find_parameter(at->str(), index) != nullptr);
        }
    }
}

TEST_CASE("an overlay takes the parameters that it claims to take, and no others") {
    for (const Effect& effect : catalogue()) {
        INFO(effect.name);
        bool all = true;
        for (const EffectParameter& p : effect.parameters)
            all = all && overlay_takes(one_of(p.name));
        CHECK(taken_whole(effect) == all);
    }
}

TEST_CASE("an overlay can be loaded whatever the experiment is called and the fit gives") {
    Experiment experiment;
    experiment.kind = Kind::Ground;
    experiment.title = "floor\n\"ground.white\" = 1\n[parameters]\x1b[31m\ttab";
    experiment.nominal = {{"ground.white", 4095}};  // of a converter that the simulator does not have
    CHECK(loaded(experiment, {{"ground.gain1", 0.9}}).get("ground.gain1") == 0.9);
    CHECK(loaded(experiment, {}).get("ground.white") == 1023);
    CHECK_THAT(overlay_toml(experiment, said({})),
               Contains("ground.white = 4095") && Contains("takes 0 to 1023"));
    experiment.kind = Kind::Motion;
    CHECK(loaded(experiment, {{"inverse_friction", 0.3}}).get("contact.mu") == 3);
    CHECK(loaded(experiment, {{"inverse_friction", 0.0}}).get("contact.mu") == 3);
    CHECK(loaded(experiment, {{"inverse_friction", 2.0}}).get("contact.mu") == 0.5);
}

TEST_CASE("an overlay moves the ground board and lifts it as the forward model does") {
    Experiment experiment;
    experiment.kind = Kind::Ground;
    experiment.nominal = {{"ground.x", 0.029}};
    const auto moved = loaded(experiment, {{"ground.forward_error", 0.004}, {"ground.left_error", -0.003}});
    const physics::Parameters defaults;
    CHECK(moved.ground.x == Approx(0.033));
    for (std::size_t i = 0; i < physics::kGroundSensors; ++i)
        CHECK(moved.ground.y[i] == Approx(defaults.ground.y[i] - 0.003));
    CHECK(loaded(experiment, {{"ground.raised", 0.002}}).ground.height ==
          Approx(defaults.ground.height + 0.002));
}

TEST_CASE("zeros of several sessions become their mean, and stay with the laboratory") {
    Experiment experiment;
    experiment.kind = Kind::Accelerometer;
    experiment.nominal = {{"accelerometer.bias0", 7}};
    // Three sessions: 0, 30, -60 counts on x; two on z: 0, 40.
    const auto drawn = loaded(experiment, {{"accelerometer.session_bias20", 30},
                                           {"accelerometer.session_bias30", -60},
                                           {"accelerometer.session_bias22", 40},
                                           {"accelerometer.bias2", -5}});
    CHECK(drawn.accelerometer.bias[0] == Approx(7 - 10));
    CHECK(drawn.accelerometer.bias[1] == 0);
    CHECK(drawn.accelerometer.bias[2] == Approx(-5 + 20));
    const std::string text = overlay_toml(experiment, said({{"accelerometer.session_bias20", 30}}));
    CHECK(text.find("session_bias20", text.find("[measurement]")) != std::string::npos);
}

TEST_CASE("an overlay's age is what firmware and host do not make by themselves") {
    Experiment experiment;
    experiment.kind = Kind::Proximity;
    CHECK(loaded(experiment, {{"proximity.age", 0.05}}).proximity.age == Approx(0.05 - 0.5 / 63.015));
    CHECK(loaded(experiment, {{"proximity.age", 0.004}}).proximity.age == 0);
    // What is cut has a comment that gives what was found.
    CHECK_THAT(overlay_toml(experiment, said({{"proximity.age", 0.004}})),
               Catch::Matchers::Contains(
                   "# proximity.age = -0.00393462 s, less what firmware and host make, was found "
                   "or stated; the simulator takes 0 to 0.5\n\"proximity.age\" = "));
    CHECK_THAT(overlay_toml(experiment, said({{"proximity.age", 0.05}})),
               !Catch::Matchers::Contains("less what"));
    CHECK(loaded(experiment, {}).proximity.age == 0);
    experiment.nominal = {{"proximity.age", 0.012}};
    CHECK(loaded(experiment, {{"proximity.age", 0.05}}).proximity.age == Approx(0.038));
    CHECK(loaded(experiment, {}).proximity.age == 0);
    experiment.kind = Kind::Ground;
    experiment.nominal = {};
    CHECK(loaded(experiment, {{"ground.lag", 0.1}}).ground.lag == Approx(0.095));
}

TEST_CASE("sensors that no foreign pulse reached are sheltered in a run, too") {
    Experiment experiment;
    experiment.kind = Kind::Proximity;
    experiment.runs.emplace_back();
    Run& run = experiment.runs.back();
    for (int sensor = 0; sensor < 8; ++sensor)
        for (int i = 0; i < 80; ++i, ++run.rows) {
            run.columns["sensor"].push_back(sensor);
            run.columns["distance_m"].push_back(0.03);
            run.columns["t_s"].push_back(8.0 * sensor + 0.1 * i);
            run.columns["reading"].push_back(290 + i * 7 % 5 + (sensor == 4 && i % 8 == 0 ? 60 : 0));
        }
    const auto hit = loaded(experiment, {{"proximity.interference_rate", 0.1}});
    for (std::size_t sensor = 0; sensor < 8; ++sensor)
        CHECK(hit.proximity.interference_share[sensor] == (sensor == 4 ? 1 : 0));
    CHECK(loaded(experiment, {}).proximity.interference_share[0] == 1);
}

TEST_CASE("a drift over a series leaves a run in its middle where the fit does") {
    Experiment experiment;
    experiment.kind = Kind::Proximity;
    for (const double order : {3.0, 5.0, 11.0}) {
        experiment.runs.emplace_back();
        experiment.runs.back().rows = 1;
        experiment.runs.back().columns["order"] = {order};
    }
    const std::map<std::string, double> drift{{"proximity.order_drift", 0.02},
                                              {"proximity.order_zero", -0.5}};
    CHECK(loaded(experiment, drift).proximity.scale == Approx(1 + 0.02 * 0.5 * 4));
    CHECK(overlay_toml(experiment, said(drift)).find("order_drift", 0) != std::string::npos);
    experiment.nominal = {{"proximity.scale", 1.5}};
    CHECK(loaded(experiment, drift).proximity.scale == Approx(1.5 * 1.04));
}

TEST_CASE("an overlay's number that is none is refused in its own file") {
    scenarios::Scenario scenario;
    const auto file = tests::scratch_path("overlay_nan.toml");
    std::ofstream(file) << "[parameters]\n\"ground.gain0\" = nan\n";
    CHECK_THROWS_WITH(scenarios::apply_overlay(scenario, file),
                      Contains(file.string()) && Contains("line 2") && Contains("not finite"));
    std::filesystem::remove(file);
}

TEST_CASE("commands lost one after another are as many in a run") {
    const std::string text = overlay_toml({}, said({{"command.loss", 0.02}, {"command.loss_burst", 0.67}}));
    CHECK_THAT(text, Contains("# 0.67 of command.loss_burst was found") && !Contains("[measurement]"));
    std::smatch byte;
    REQUIRE(std::regex_search(text, byte, std::regex("command_loss = ([0-9.e-]+)")));
    // A command is lost with any of its 12 bytes. In the long run p = 0.02 (1 - p) + (0.02 + 0.67 * 0.98) p.
    CHECK(1 - std::pow(1 - std::stod(byte[1]), 12) == Approx(0.02 / (1 - 0.67 * 0.98)));
}
