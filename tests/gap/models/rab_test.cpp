// The range-and-bearing model: neutral it says what the default medium and the boards' formula give; each
// parameter acts by the amount of its equation.

#include "base/random.h"
#include "physics/ir/burst_outcomes.h"
#include "physics/ir/published_strengths.h"
#include "protocols/infrared/rab_reading.h"
#include "tests/gap/models/made_table.h"
#include "tests/physics/ir_worlds.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <complex>
#include <numbers>

using namespace puckloop;
using namespace puckloop::gap;
using namespace puckloop::gap::tests;

namespace {

constexpr std::array<double, 12> kDegrees{15, 50, 75, 105, 133, 159, -165, -135, -105, -77, -50, -15};
constexpr std::size_t kStrength = 0, kBearing = 1, kReceived = 2;  // the model's observables

double radians(double degrees) {
    return degrees * std::numbers::pi / 180;
}

/// A message to every receiver in turn at 30 cm, then one at each distance of the table to receiver 1.
Table table() {
    Table rows;
    const auto add = [&](double distance, std::size_t receiver) {
        rows["t_s"].push_back(0.1 * static_cast<double>(rows["t_s"].size()));
        rows["distance_m"].push_back(distance);
        rows["receiver"].push_back(static_cast<double>(receiver));
        rows["true_bearing_rad"].push_back(radians(kDegrees[receiver - 1] + 3));
        rows["bearing_rad"].push_back(radians(kDegrees[receiver - 1] + 3));
        rows["strength"].push_back(900 + static_cast<double>(receiver));
        rows["received"].push_back(1);
        rows["senders"].push_back(1.0 + static_cast<double>(receiver % 3));
        rows["frame_time"].push_back(0.0092);
        rows["send_period"].push_back(0.1);
        rows["arrival_rate"].push_back(20.0 * static_cast<double>(receiver));
    };
    for (std::size_t receiver = 1; receiver <= 12; ++receiver)
        add(0.30, receiver);
    for (const physics::PublishedStrength& one : physics::kPublishedStrengths)
        add(one.distance, 1);
    return rows;
}

/// Bearing of the sum of what receivers of these gains measure of a sender at `bearing`.
double vector_sum(const std::array<double, 12>& gain, double bearing) {
    std::complex<double> sum;
    for (std::size_t r = 0; r < 12; ++r) {
        const double facing = std::cos(bearing - radians(kDegrees[r]));
        if (facing > 0) sum += std::polar(gain[r] * std::sqrt(facing), radians(kDegrees[r]));
    }
    return std::arg(sum);
}

/// Median strength that the default medium and the board's formula give over pairs of boards and headings.
double simulated_median(double surface) {
    constexpr int kPairs = 60, kHeadings = 10;
    std::vector<double> all;
    RandomStream random(5, "headings");
    for (int pair = 0; pair < kPairs; ++pair) {
        physics::World world = physics::test::rab_pair(surface);
        world.seed = 40 + static_cast<std::uint64_t>(pair);
        physics::IrMedium medium(world);
        for (int k = 0; k < kHeadings; ++k) {
            medium.move(0, 0, 0, 2 * std::numbers::pi * random.uniform());
            medium.move(1, 2 * physics::test::kBodyRadius + surface, 0,
                        2 * std::numbers::pi * random.uniform());
            const physics::IrLight& light = physics::test::shine(medium);
            std::array<int, 12> peaks{};
            for (std::size_t r = 0; r < 12; ++r)
                if (light.carrier[r] >= medium.parameters(1).threshold)
                    peaks[r] = static_cast<int>(std::min(4000L, std::lround(light.level[r])));
            all.push_back(protocols::rab_reading(peaks).range);
        }
    }
    std::nth_element(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2), all.end());
    return all[all.size() / 2];
}

}  // namespace

TEST_CASE("neutral, the strength is what the default medium gives a board") {
    const Experiment experiment = experiment_of(Kind::Rab, table());
    const auto model = make_model(experiment);
    const Prediction rest = predicted(*model);
    for (std::size_t k = 0; k < physics::kPublishedStrengths.size(); ++k) {
        CHECK(rest[kStrength].mean[12 + k] == Approx(physics::kPublishedStrengths[k].log_median));
        CHECK(rest[kStrength].factor[12 + k] == Approx(physics::kPublishedStrengths[k].spread));
    }
    // 600 readings: their median's error is 1.7 % at contact and 0.7 % beyond; the medium's own is 1 %.
    for (const std::size_t k : {std::size_t{1}, std::size_t{3}, std::size_t{5}, std::size_t{7}})
        CHECK(simulated_median(physics::kPublishedStrengths[k].distance) ==
              Approx(std::exp(rest[kStrength].mean[12 + k])).epsilon(0.04));
    for (const double error : rest[kBearing].mean)
        CHECK(error == Approx(0).margin(1e-12));
    for (const double share : rest[kReceived].mean)
        CHECK(share == Approx(0.999));
}

TEST_CASE("strength: gains add, a floor lifts, a rail cuts what is shown, spread widens") {
    const Experiment experiment = experiment_of(Kind::Rab, table());
    const auto model = make_model(experiment);
    const Prediction rest = predicted(*model);
    const std::size_t n = rest[kStrength].mean.size();
    const Prediction louder = predicted(*model, {{"rab.strength_gain", 0.2}});
    const Prediction one = predicted(*model, {{"rab.receiver_gain4", 1.5}});
    const Prediction floored = predicted(*model, {{"rab.far_floor", 1000}});
    const Prediction wide = predicted(*model, {{"rab.strength_spread", 0.5}});
    for (std::size_t i = 0; i < n; ++i) {
        const double level = rest[kStrength].mean[i];
        CHECK(louder[kStrength].mean[i] == Approx(level + 0.2));
        CHECK(one[kStrength].mean[i] == Approx(level + (i == 3 ? std::log(1.5) : 0.0)));
        CHECK(floored[kStrength].mean[i] == Approx(std::max(level, std::log(1000.0))));
        CHECK(wide[kStrength].factor[i] == Approx(1.5 * rest[kStrength].factor[i]));
    }
}

TEST_CASE("a rail is looked for only where strengths pile up, and then cuts there") {
    Table rows = table();
    const Experiment plain = experiment_of(Kind::Rab, rows);
    CHECK(!make_model(plain)->find("rab.saturation"));
    for (std::size_t i = 12; i < 18; ++i)
        rows["strength"][i] = 1234.5;
    const Experiment cut = experiment_of(Kind::Rab, rows);
    const auto model = make_model(cut);
    REQUIRE(model->starts("rab.saturation").size() == 1);
    CHECK(model->starts("rab.saturation")[0] == Approx(1234.5));
    const Prediction said = predicted(*model, {{"rab.saturation", 1234.5}});
    CHECK(shown(said[kStrength], 12) == Approx(std::log(1234.5)));
    CHECK(said[kStrength].mean[12] == Approx(physics::kPublishedStrengths[0].log_median));
    CHECK(shown(said[kStrength], 19) == Approx(physics::kPublishedStrengths[7].log_median));
}

TEST_CASE("unequal receivers turn bearings as the boards' vector sum does") {
    const Experiment experiment = experiment_of(Kind::Rab, table());
    const auto model = make_model(experiment);
    std::array<double, 12> equal{}, gain{};
    equal.fill(1);
    gain.fill(1);
    gain[3] = 1.6;
    gain[8] = 0.7;
    const Prediction said = predicted(
        *model, {{"rab.receiver_gain4", 1.6}, {"rab.receiver_gain9", 0.7}, {"rab.bearing_offset", 0.05}});
    double most = 0.0;
    for (std::size_t i = 0; i < 12; ++i) {
        const double bearing = radians(kDegrees[i] + 3);
        const double turned =
            std::remainder(vector_sum(gain, bearing) - vector_sum(equal, bearing), 2 * std::numbers::pi);
        CHECK(said[kBearing].mean[i] ==
              Approx(0.05 + turned).margin(1e-5));  // the table of angles has 5 digits
        most = std::max(most, std::abs(turned));
    }
    CHECK(most > 0.05);
}

TEST_CASE("reception falls by chance, with senders and with the poll's rate") {
    const Experiment experiment = experiment_of(Kind::Rab, table());
    const auto model = make_model(experiment);
    const Table& rows = experiment.runs[0].columns;
    const Prediction lossy = predicted(*model, {{"rab.random_loss", 0.2}});
    const Prediction crowded = predicted(*model, {{"rab.collisions", 0.5}});
    const Prediction slow = predicted(*model, {{"rab.fetch_time", 0.01}});
    for (std::size_t i = 0; i < 12; ++i) {
        const double others = rows.at("senders")[i] - 1, rate = rows.at("arrival_rate")[i];
        CHECK(lossy[kReceived].mean[i] == Approx(0.999 * 0.8));
        CHECK(crowded[kReceived].mean[i] == Approx(0.999 * std::exp(-2 * 0.5 * others * 0.0092 / 0.1)));
        CHECK(slow[kReceived].mean[i] == Approx(0.999 * std::min(1.0, 100 / rate)));
    }
}

namespace {

/// Messages at random headings and distances, by all emitters or by the one that faces the receiver most.
struct Look {
    double distance, bearing, facing;
    int emitter;
};
std::vector<Look> random_looks(std::size_t count) {
    std::vector<Look> looks;
    RandomStream random(9, "looks");
    for (std::size_t k = 0; k < count; ++k) {
        Look look{0.02 + 0.3 * random.uniform(), radians(360 * random.uniform()),
                  radians(360 * random.uniform()), 0};
        if (k % 2 == 1)
            for (std::size_t e = 0; e < 12; ++e)
                if (look.emitter == 0 ||
                    std::cos(look.facing - radians(kDegrees[e])) >
                        std::cos(look.facing - radians(kDegrees[static_cast<std::size_t>(look.emitter) - 1])))
                    look.emitter = static_cast<int>(e) + 1;
        looks.push_back(look);
    }
    return looks;
}

Experiment ring_experiment(const std::vector<Look>& looks) {
    Table rows;
    for (const Look& look : looks) {
        rows["t_s"].push_back(0.1 * static_cast<double>(rows["t_s"].size()));
        rows["distance_m"].push_back(look.distance);
        rows["true_bearing_rad"].push_back(look.bearing);
        rows["bearing_rad"].push_back(look.bearing);
        rows["sender_bearing_rad"].push_back(look.facing);
        rows["emitter"].push_back(look.emitter);
        rows["receiver"].push_back(1.0 + static_cast<double>(rows["receiver"].size() % 12));
        rows["strength"].push_back(1000);
    }
    std::map<std::string, double> plain{{"rab.ring", 1}};
    for (const char* name : {"ir.emitter_spread", "ir.receiver_spread", "ir.demodulator_spread",
                             "ir.frame_noise", "ir.receiver_noise", "ir.carrier_noise", "ir.near_noise"})
        plain[name] = 0.0;
    return experiment_of(Kind::Rab, std::move(rows), plain);
}

/// What the medium and the board's formula give for a look.
protocols::RabReading simulated(const Look& look, const std::map<std::string, double>& parameters) {
    physics::World world = physics::test::rab_pair(look.distance);
    physics::test::make_ideal(world);
    for (const auto& [name, value] : parameters)
        world.parameters[name] = value;
    physics::IrMedium medium(world);
    // The sender is robot 0, to the receiver's west.
    medium.move(0, 0, 0, -look.facing);
    medium.move(1, 2 * physics::test::kBodyRadius + look.distance, 0, std::numbers::pi - look.bearing);
    const auto mask = static_cast<std::uint16_t>(look.emitter == 0 ? physics::test::kAllEmitters
                                                                   : 1U << (look.emitter - 1));
    const physics::IrLight& light = physics::test::shine(medium, mask, 115, 455e3);
    std::array<int, 12> peaks{};
    for (std::size_t r = 0; r < 12; ++r)
        if (light.carrier[r] >= 1)
            peaks[r] = static_cast<int>(std::min<long>(std::lround(light.level[r]),
                                                       4095 - std::lround(medium.parameters(1).baseline[r])));
    return protocols::rab_reading(peaks);
}

}  // namespace

TEST_CASE("with the ring, strength and bearing are those of the medium through the board's formulas") {
    const auto looks = random_looks(40);
    const Experiment experiment = ring_experiment(looks);
    const auto model = make_model(experiment);
    const auto same = [&](const std::map<std::string, double>& ours,
                          const std::map<std::string, double>& theirs) {
        const Prediction said = predicted(*model, ours);
        for (std::size_t i = 0; i < looks.size(); ++i) {
            CAPTURE(i, looks[i].distance, looks[i].bearing, looks[i].facing, looks[i].emitter);
            const auto told = simulated(looks[i], theirs);
            REQUIRE(told.range > 0);
            // Whole counts of twelve peaks, of which the smallest read 100.
            CHECK(std::exp(said[kStrength].mean[i]) == Approx(told.range).epsilon(0.005).margin(2));
            CHECK(std::remainder(said[kBearing].mean[i] + looks[i].bearing - 1e-4 * told.bearing,
                                 2 * std::numbers::pi) == Approx(0).margin(0.005));
        }
    };
    same({}, {});
    same({{"rab.receiver_gain4", 1.4}}, {{"ir.receiver_gain3", 1.4}});
    const int one = looks[1].emitter;
    const double others = std::pow(0.7, 1.0 / 12);  // their mean stays 1
    std::map<std::string, double> emitters;
    for (int e = 0; e < 12; ++e)
        emitters["ir.emitter_gain" + std::to_string(e)] = (e + 1 == one ? 0.7 : 1.0) / others;
    same({{"rab.emitter_gain" + std::to_string(one), 0.7}}, emitters);
    same({{"rab.emitter_lobe", 2.0}, {"rab.receiver_lobe", 1.0}},
         {{"ir.emitter_exponent", 2.0}, {"ir.receiver_exponent", 1.0}});
}

TEST_CASE("with the ring, the noise claimed is what spread parts and the medium's chance make") {
    Experiment experiment = ring_experiment(std::vector<Look>(60, Look{0.30, 0.9, 2.0, 0}));
    experiment.nominal = {{"rab.ring", 1}};
    const auto model = make_model(experiment);
    std::vector<double> all;
    double mean = 0.0, square = 0.0;
    for (int pair = 0; pair < 400; ++pair) {
        physics::World world = physics::test::rab_pair(0.30);
        world.seed = 900 + static_cast<std::uint64_t>(pair);
        physics::IrMedium medium(world);
        medium.move(0, 0, 0, -2.0);
        medium.move(1, 2 * physics::test::kBodyRadius + 0.30, 0, std::numbers::pi - 0.9);
        const physics::IrLight& light = physics::test::shine(medium, physics::test::kAllEmitters, 115, 455e3);
        std::array<int, 12> peaks{};
        for (std::size_t r = 0; r < 12; ++r)
            if (light.carrier[r] >= 1) peaks[r] = static_cast<int>(std::lround(light.level[r]));
        const double strength = std::log(protocols::rab_reading(peaks).range);
        mean += strength / 400;
        square += strength * strength / 400;
    }
    const Prediction said = predicted(*model);
    const double sd = std::sqrt(square - mean * mean);
    // 400 pairs: 5 % of an sd for the mean, 3.5 % for the sd itself.
    CHECK(said[kStrength].mean[0] == Approx(mean).margin(0.2 * sd));
    CHECK(said[kStrength].factor[0] == Approx(sd).epsilon(0.12));
}

TEST_CASE("with the ring, reflections turn bearings as the medium's do") {
    constexpr double kShare = 0.5;
    constexpr int kDraws = 20000;
    physics::IrParameters parameters = physics::Parameters().ir;
    parameters.stray = kShare;
    physics::BurstOutcomes outcomes(parameters, Catch::rngSeed(), "a>b");
    double turned = 0.0, squares = 0.0;
    for (int k = 0; k < kDraws; ++k) {
        const auto parts = static_cast<double>(outcomes.next().turn);
        const double turn = std::remainder(parts * 2 * std::numbers::pi / 12, 2 * std::numbers::pi);
        turned += turn != 0.0 ? 1 : 0;
        squares += turn * turn;
    }
    const auto model = make_model(ring_experiment(random_looks(4)));
    const Prediction said = predicted(*model, {{"rab.multipath", kShare}});
    CHECK(said[kStrength].lapse[0] == kShare);
    CHECK(said[kBearing].lapse[0] == Approx(turned / kDraws).epsilon(0.05));  // 1.2 % by chance
    CHECK(said[kBearing].lapse_scale[0] == Approx(std::sqrt(squares / turned)).epsilon(0.05));
}
