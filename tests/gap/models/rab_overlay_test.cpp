// An overlay of a verdict on range and bearing, loaded by a scenario of two robots: what board "b" reports of
// board "a", through the medium and the boards' own formula, changes as the verdict says.

#include "gap/overlay/overlay.h"
#include "gap/pipeline/analyse.h"
#include "protocols/infrared/rab_reading.h"
#include "scenarios/reader/read_scenario.h"
#include "tests/kit/scratch.h"
#include "tests/physics/ir_worlds.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <fstream>
#include <numbers>

using namespace puckloop;
using namespace puckloop::gap;
using namespace puckloop::physics::test;

namespace {

using Parameters = std::map<std::string, double>;

struct Reported {
    std::vector<double> strength, error;  // counts; rad
    double heard = 0.0;                   // share of the frames
    double median = 0.0, spread = 0.0, offset = 0.0;
};

scenarios::Scenario scenario_with(double surface, const Parameters& said, bool ideal) {
    scenarios::Scenario scenario;
    scenario.world = rab_pair(surface);
    if (ideal) make_ideal(scenario.world);
    Verdict verdict;
    verdict.decision = Decision::Named;
    verdict.causes.emplace_back();
    for (const auto& [name, value] : said) {
        verdict.causes[0].parameters.emplace_back();
        verdict.causes[0].parameters.back().name = name;
        verdict.causes[0].parameters.back().value = value;
    }
    Experiment experiment;
    experiment.kind = Kind::Rab;
    const auto file = tests::scratch_path("rab_overlay.toml");
    std::ofstream(file) << overlay_toml(experiment, verdict);
    scenarios::apply_overlay(scenario, file);
    return scenario;
}

/// 400 frames at `surface` metres between the bodies; `ideal`: all parts alike and no noise.
Reported reported(double surface, const Parameters& said, bool ideal = true) {
    const scenarios::Scenario scenario = scenario_with(surface, said, ideal);
    physics::IrMedium medium(scenario.world);
    constexpr int kFrames = 400;
    Reported all;
    for (int i = 0; i < kFrames; ++i) {
        const double heading = 2 * std::numbers::pi * i / kFrames;
        medium.move(1, 2 * kBodyRadius + surface, 0, heading);
        const physics::IrLight& light = shine(medium);
        const auto& p = medium.parameters(1);
        std::array<int, 12> peaks{};
        bool heard = false;
        for (std::size_t k = 0; k < 12; ++k) {
            if (light.carrier[k] < p.threshold) continue;
            heard = true;
            const double dark = std::round(p.baseline[k]);
            peaks[k] = static_cast<int>(std::min(p.rail, std::round(light.level[k]) + dark) - dark);
        }
        if (!heard) continue;
        all.heard += 1.0 / kFrames;
        const auto reading = protocols::rab_reading(peaks);
        all.strength.push_back(std::log(reading.range));
        all.error.push_back(
            std::remainder(reading.bearing * 1e-4 - (std::numbers::pi - heading), 2 * std::numbers::pi));
    }
    double square = 0.0, mean = 0.0;
    const double share = 1 / static_cast<double>(std::max<std::size_t>(all.strength.size(), 1));
    for (std::size_t i = 0; i < all.strength.size(); ++i) {
        mean += all.strength[i] * share;
        square += all.strength[i] * all.strength[i] * share;
        all.offset += all.error[i] * share;
    }
    all.spread = std::sqrt(std::max(square - mean * mean, 0.0));
    std::sort(all.strength.begin(), all.strength.end());
    all.median = all.strength.empty() ? 0.0 : all.strength[all.strength.size() / 2];
    return all;
}

}  // namespace

TEST_CASE("an overlay's strength gain and receivers' gains change what a board reports by as much") {
    const Reported before = reported(0.30, {}), after = reported(0.30, {{"rab.strength_gain", -0.4}});
    CHECK(after.median - before.median == Approx(-0.4).margin(0.01));
    // All receivers weaker by 20 %, told one by one.
    Parameters each;
    for (int r = 1; r <= 12; ++r)
        each["rab.receiver_gain" + std::to_string(r)] = 0.8;
    CHECK(reported(0.30, each).median - before.median == Approx(std::log(0.8)).margin(0.01));
    // One louder receiver is louder where it faces the sender.
    const Reported one = reported(0.30, {{"rab.receiver_gain6", 1.5}});
    // A receiver's neighbour adds up to 19 % to the register, so the louder one adds a little less than 1.5.
    CHECK(one.strength.back() - before.strength.back() > std::log(1.5) - std::log(1.19));
    CHECK(one.strength.back() - before.strength.back() < std::log(1.5));
    CHECK(one.median - before.median == Approx(0).margin(0.05));
}

TEST_CASE("an overlay's far floor keeps far strengths up and leaves near ones") {
    const Parameters floor{{"rab.far_floor", 1100}};
    CHECK(reported(0.60, floor).median - reported(0.60, {}).median ==
          Approx(std::log(1100) - 6.82855).margin(0.02));
    CHECK(reported(0.05, floor).median == Approx(reported(0.05, {}).median).margin(0.01));
}

TEST_CASE("an overlay's rail cuts near strengths") {
    const Reported cut = reported(0.0, {{"rab.saturation", 1200}});
    // The register of a sender between two receivers is up to 1.24 of one alone.
    CHECK(std::exp(cut.strength.back()) == Approx(1200).epsilon(0.15));
    CHECK(std::exp(reported(0.0, {}).strength.back()) > 1700);
    CHECK(reported(0.60, {{"rab.saturation", 1200}}).median ==
          Approx(reported(0.60, {}).median).margin(0.01));
}

TEST_CASE("an overlay's bearing offset turns what a board reports") {
    const double turned = reported(0.30, {{"rab.bearing_offset", 0.15}}).offset - reported(0.30, {}).offset;
    CHECK(turned == Approx(0.15).margin(0.01));
}

TEST_CASE("an overlay's spread and loss act on every frame") {
    const Reported before = reported(0.15, {}, false),
                   after = reported(0.15, {{"rab.strength_spread", 1}}, false);
    // Parts differ as before; what varies from frame to frame doubles.
    CHECK(after.spread > 1.5 * before.spread);
    CHECK(after.spread < 2.05 * before.spread);
    CHECK(before.heard == Approx(1.0));
    // 400 frames: 0.023 is one sd.
    CHECK(reported(0.15, {{"rab.random_loss", 0.3}}).heard == Approx(0.7).margin(0.07));
}

TEST_CASE("what the medium cannot have is cut with a comment") {
    Experiment experiment;
    experiment.kind = Kind::Rab;
    Verdict verdict;
    verdict.causes.emplace_back();
    FittedParameter gain;
    gain.name = "rab.receiver_gain3", gain.value = 1e4;
    verdict.causes.front().parameters = {gain};
    const std::string text = overlay_toml(experiment, verdict);
    CHECK_THAT(text, Catch::Matchers::Contains(
                         "# ir.receiver_gain2 = 10000 was found or stated; the simulator takes"));
}

TEST_CASE("what the medium has nothing for stays with the measurement") {
    Verdict verdict;
    verdict.causes.emplace_back();
    verdict.causes[0].parameters.emplace_back();
    verdict.causes[0].parameters[0].name = "rab.fetch_time";
    verdict.causes[0].parameters[0].value = 0.02;
    Experiment experiment;
    experiment.kind = Kind::Rab;
    const std::string text = overlay_toml(experiment, verdict);
    CHECK(text.find("[measurement]\n\"rab.fetch_time\" = 0.02") != std::string::npos);
}
