// The ground model reads the grey ahead and behind off the sensor's own track: a wave on the floor is known
// everywhere, so that what it says can be held to the truth.

#include "gap/models/model.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

using namespace puckloop;

namespace {

constexpr double kPeriod = 0.1;       // s
constexpr double kWaveLength = 0.08;  // m
constexpr double kBlack = 329, kWhite = 953;

double grey_at(double x) {
    return 0.5 + 0.4 * std::sin(2 * std::numbers::pi * x / kWaveLength);
}

/// Stands, drives on at a steady speed, stands again.
gap::Experiment drive(double speed) {
    gap::Experiment experiment;
    experiment.kind = gap::Kind::Ground;
    gap::Run run;
    run.name = "drive";
    double x = 0.0;
    for (int k = 0; k < 60; ++k) {
        const double v = k >= 10 && k < 50 ? speed : 0.0;
        const double before = k > 10 && k < 51 ? speed : 0.0;
        x += (v + before) / 2 * kPeriod;
        run.columns["t_s"].push_back(k * kPeriod);
        run.columns["reading"].push_back(500 + k % 3);
        run.columns["grey"].push_back(grey_at(x));
        run.columns["grey_rate"].push_back(0.4 * 2 * std::numbers::pi / kWaveLength *
                                           std::cos(2 * std::numbers::pi * x / kWaveLength));
        run.columns["speed"].push_back(v);
        run.columns["truth_x"].push_back(x);
    }
    run.rows = 60;
    experiment.runs.push_back(run);
    return experiment;
}

std::vector<double> said(const gap::Experiment& experiment, const char* parameter, double value) {
    const auto model = gap::make_model(experiment);
    auto values = model->neutral();
    values[*model->find(parameter)] = value;
    gap::Prediction prediction;
    model->predict(values, prediction);
    return prediction[0].mean;
}

}  // namespace

TEST_CASE("a sensor that stands ahead or back sees the grey there") {
    const gap::Experiment experiment = drive(0.08);
    const auto& x = experiment.runs[0].column("truth_x");
    for (const double ahead : {0.006, 0.0005, -0.0005, -0.006}) {
        INFO("ahead " << ahead);
        const auto mean = said(experiment, "ground.forward_error", ahead);
        for (std::size_t k = 12; k < 46; ++k)  // beyond the ends of the track nothing is known
            CHECK(mean[k] == Approx(kBlack + (kWhite - kBlack) * grey_at(x[k] + ahead)).margin(1.5));
    }
}

TEST_CASE("a sensor that answers late sees the grey where it was") {
    const gap::Experiment experiment = drive(0.08);
    const auto& x = experiment.runs[0].column("truth_x");
    const double lag = 0.07;
    const auto mean = said(experiment, "ground.lag", lag);
    for (std::size_t k = 12; k < 48; ++k)
        CHECK(mean[k] == Approx(kBlack + (kWhite - kBlack) * grey_at(x[k] - lag * 0.08)).margin(1.5));
    for (std::size_t k = 0; k < 10; ++k)  // standing, it is late for nothing
        CHECK(mean[k] == Approx(kBlack + (kWhite - kBlack) * grey_at(x[k])).margin(1e-6));
}

TEST_CASE("the reading of the grey ahead changes smoothly with the shift") {
    const gap::Experiment experiment = drive(0.05);
    const double step = 1e-6;
    for (double ahead = -0.01; ahead < 0.01; ahead += 0.0013) {
        const auto one = said(experiment, "ground.forward_error", ahead),
                   other = said(experiment, "ground.forward_error", ahead + step);
        for (std::size_t k = 0; k < one.size(); ++k)
            CHECK(std::abs(other[k] - one[k]) <
                  2 * (kWhite - kBlack) * 0.4 * 2 * std::numbers::pi / kWaveLength * step);
    }
}
