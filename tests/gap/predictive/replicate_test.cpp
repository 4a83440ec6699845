// Replicated data follow the fitted law of errors: what the likelihood and the filter say of it.

#include "gap/fit/likelihood.h"
#include "gap/predictive/replicate.h"
#include "gap/stats/robust.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

using namespace puckloop;
using namespace puckloop::gap;

namespace {

constexpr std::size_t kRows = 20000, kChain = 500;

Observable chains(NoiseKind kind) {
    Observable o;
    o.noise = kind;
    o.instrument = {NAN, NAN, 0.0};
    for (std::size_t i = 0; i < kRows; ++i) {
        o.y.push_back(0.0);
        o.run.push_back(static_cast<std::uint32_t>(i / kChain));
        o.row.push_back(static_cast<std::uint32_t>(i % kChain));
        o.starts.push_back(i % kChain == 0 ? 1 : 0);
    }
    return o;
}

Predicted level(double mean) {
    Predicted p;
    p.mean.assign(kRows, mean);
    return p;
}

/// Standardised innovations of replicated data by the same law, plain rows only.
std::vector<double> innovations_of(Observable o, const Predicted& p, const NoiseParameters& noise,
                                   RandomStream& random) {
    o.y = replicated(o, p, noise, random);
    Innovations out;
    filter(o, p, noise, out);
    std::vector<double> plain;
    for (std::size_t i = 0; i < out.z.size(); ++i)
        if (out.role[i] == RowRole::Plain) plain.push_back(out.z[i]);
    return plain;
}

/// Of Student's t with `degrees`: share beyond `z` on either side, by summing its density.
double beyond(double degrees, double z) {
    constexpr double kStep = 1e-3;
    const double constant = std::exp(std::lgamma((degrees + 1) / 2) - std::lgamma(degrees / 2)) /
                            std::sqrt(degrees * 3.14159265358979);
    double inside = 0.0;
    for (double x = kStep / 2; x < z; x += kStep)
        inside += kStep * constant * std::pow(1 + x * x / degrees, -(degrees + 1) / 2);
    return 1 - 2 * inside;
}

}  // namespace

TEST_CASE("innovations of replicated data are Student's t and independent", "[gap][predictive]") {
    RandomStream random(Catch::rngSeed(), "test/replicate");
    const bool sums = GENERATE(false, true);
    const double degrees = GENERATE(4.0, 30.0);
    const NoiseParameters noise{std::log(2.0), sums ? std::log(0.05) : 0.6, std::log(degrees),
                                sums ? 0.3 : 0.0};
    const auto z =
        innovations_of(chains(sums ? NoiseKind::Level : NoiseKind::Carry), level(10.0), noise, random);
    REQUIRE(z.size() > kRows / 2);
    for (const double limit : {0.5, 1.0, 2.0}) {
        const double share = static_cast<double>(std::count_if(
                                 z.begin(), z.end(), [&](double one) { return std::abs(one) > limit; })) /
                             static_cast<double>(z.size());
        INFO("sums " << sums << ", degrees " << degrees << ", limit " << limit);
        // Four standard errors of a share of so many rows. Of sums the chain's beginning is only nearly t.
        const double p = beyond(degrees, limit);
        CHECK(share == Approx(p).margin(4 * std::sqrt(p * (1 - p) / static_cast<double>(z.size())) +
                                        (sums ? 0.005 : 0.0)));
    }
    double product = 0.0, square = 0.0;
    for (std::size_t i = 1; i < z.size(); ++i) {
        product += std::clamp(z[i], -3.0, 3.0) * std::clamp(z[i - 1], -3.0, 3.0);
        square += std::pow(std::clamp(z[i], -3.0, 3.0), 2);
    }
    CHECK(std::abs(product / square) < 4 / std::sqrt(static_cast<double>(z.size())));
}

TEST_CASE("replicated readings keep to the instrument's step and range, and spread as the law does",
          "[gap][predictive]") {
    RandomStream random(Catch::rngSeed(), "test/rounded");
    Observable o = chains(NoiseKind::Carry);
    o.instrument = {8.0, 13.0, 1.0};
    o.y.assign(kRows, 9.0);
    const Predicted p = level(10.0);
    const NoiseParameters noise{std::log(1.5), 0.0, std::log(30.0), 0.0};
    const auto y = replicated(o, p, noise, random);
    CHECK(std::all_of(y.begin(), y.end(), [](double one) { return one == std::round(one); }));
    CHECK(*std::min_element(y.begin(), y.end()) == 8.0);
    CHECK(*std::max_element(y.begin(), y.end()) == 13.0);
    o.instrument = {NAN, NAN, 1.0};
    // What rounding adds is in the fitted scale, and is not added twice.
    const double scale = row_sd(o, p, noise, 0);
    CHECK(stats::standard_deviation(replicated(o, p, noise, random)) ==
          Approx(scale * std::sqrt(30.0 / 28.0)).epsilon(0.04));
}

TEST_CASE("what happens or not happens as often as predicted, lapses come at their rate",
          "[gap][predictive]") {
    RandomStream random(Catch::rngSeed(), "test/events");
    Observable event = chains(NoiseKind::Event);
    const auto y = replicated(event, level(0.2), {}, random);
    CHECK(stats::mean(y) == Approx(0.2).margin(4 * std::sqrt(0.16 / kRows)));
    Predicted p = level(0.0);
    p.lapse.assign(kRows, 0.1);
    p.lapse_scale.assign(kRows, 1.0);
    p.lapse_shift.assign(kRows, 100.0);
    const auto lapses = replicated(chains(NoiseKind::Carry), p, {0.0, 0.0, std::log(30.0), 0.0}, random);
    const auto far = std::count_if(lapses.begin(), lapses.end(), [](double one) { return one > 50; });
    CHECK(static_cast<double>(far) / kRows == Approx(0.1).margin(4 * std::sqrt(0.09 / kRows)));
}
