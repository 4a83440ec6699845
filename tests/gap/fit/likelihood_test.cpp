#include "base/random.h"
#include "gap/fit/objective.h"
#include "gap/fit/walk.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

using namespace puckloop;
using namespace puckloop::gap;

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// y = slope * t + offset in one observable; lapses at a rate that can be freed.
class Straight final : public Model {
  public:
    Straight(NoiseKind kind, std::vector<double> y) {
        Observable one;
        one.noise = kind;
        one.instrument = {kNone, kNone, 0.0};
        one.starts.assign(y.size(), 0);
        one.starts[0] = 1;
        one.run.assign(y.size(), 0);
        one.row.assign(y.size(), 0);
        one.y = std::move(y);
        observables_.push_back(std::move(one));
        slope_ = add("slope", "1", 0.0);
        offset_ = add("offset", "1", 0.0);
        rate_ = add("rate", "1", 0.0);
    }
    Observable& only() { return observables_[0]; }
    static double x(std::size_t i) { return std::sin(0.7 * static_cast<double>(i)); }

    void predict(const std::vector<double>& v, Prediction& out) const override {
        const double slope = v[slope_], offset = v[offset_], rate = v[rate_];
        const std::size_t n = observables_[0].y.size();
        out.resize(1);
        out[0].mean.resize(n);
        for (std::size_t i = 0; i < n; ++i)
            out[0].mean[i] = slope * x(i) + offset;
        out[0].lapse.assign(rate > 0 ? n : 0, rate);
        out[0].lapse_scale.assign(rate > 0 ? n : 0, 20.0);
    }

  private:
    std::size_t slope_ = 0, offset_ = 0, rate_ = 0;
};

double student(RandomStream& random, int freedom) {
    double chi = 0.0;
    for (int k = 0; k < freedom; ++k) {
        const double one = random.normal();
        chi += one * one;
    }
    return random.normal() * std::sqrt(freedom / chi);
}

constexpr Freed kSlope{0, -50, 50, 5, 0}, kOffset{1, -50, 50, 5, 0}, kRate{2, 0, 0.5, 0.1, 0};

Fitted fitted(const Model& model, const std::vector<Freed>& freed) {
    return fit(model, freed, neutral_state(model), {});
}

}  // namespace

TEST_CASE("a row's likelihood integrates to one", "[gap][fit]") {
    const double lapse = GENERATE(0.0, 0.1);
    Straight model(NoiseKind::Carry, {0.0});
    Predicted p;
    p.mean = {0.3};
    if (lapse > 0) p.lapse = {lapse}, p.lapse_scale = {4.0};
    const NoiseParameters noise{std::log(0.8), 0.0, std::log(4.0), 0.0};
    double sum = 0.0;
    RowCosts costs;
    constexpr double kStep = 0.01;
    for (double y = -200; y < 200; y += kStep) {
        model.only().y = {y};
        row_costs(model.observables()[0], p, noise, costs);
        sum += std::exp(-costs.cost[0]) * kStep;
    }
    CHECK(sum == Approx(1.0).margin(0.01));
}

TEST_CASE("a fit finds line, carry, size and tails of known noise", "[gap][fit]") {
    RandomStream random(3, "test/carry");
    std::vector<double> y;
    double last = 0.0;
    for (std::size_t i = 0; i < 4000; ++i) {
        last = 0.6 * last + 0.8 * student(random, 4);
        y.push_back(2.0 * Straight::x(i) + 5.0 + 0.5 * last);
    }
    const Straight model(NoiseKind::Carry, std::move(y));
    const Fitted found = fitted(model, {kSlope, kOffset});
    const NoiseParameters& noise = found.state.noise[0];
    CHECK(found.state.values[0] == Approx(2.0).margin(0.06));
    CHECK(found.state.values[1] == Approx(5.0).margin(0.08));
    CHECK(noise.carry == Approx(0.6).margin(0.05));
    CHECK(std::exp(noise.log_sd) == Approx(0.5).epsilon(0.08));
    CHECK(std::exp(noise.log_tail) == Approx(4.0).margin(1.0));
}

TEST_CASE("a fit parts a sum's drift from the noise on it", "[gap][fit]") {
    RandomStream random(3, "test/level");
    std::vector<double> y;
    double sum = 0.0;
    for (std::size_t i = 0; i < 4000; ++i) {
        sum += 0.2 * random.normal();
        y.push_back(1.5 * Straight::x(i) + sum + random.normal());
    }
    const Straight model(NoiseKind::Level, std::move(y));
    const Fitted found = fitted(model, {kSlope});
    CHECK(found.state.values[0] == Approx(1.5).margin(0.08));
    CHECK(std::exp(found.state.noise[0].log_sd) == Approx(1.0).epsilon(0.08));
    CHECK(std::exp(found.state.noise[0].carry / 2) == Approx(0.2).margin(0.05));
}

TEST_CASE("what turning axes add to a sum is no drift", "[gap][fit]") {
    constexpr double kTurn = 0.25, kMemory = 0.7;  // rad a row
    constexpr std::size_t kRows = 3000, kStraight = 1500;
    RandomStream random(3, "test/turning axes");
    std::vector<double> y, turn;
    double sum = 0.0, last_x = 0.0, last_y = 0.0, way = 0.0;
    for (std::size_t i = 0; i < kRows; ++i) {
        turn.push_back(i < kStraight ? 0.0 : kTurn);
        way += turn.back();
        const double rest = std::sqrt(1 - kMemory * kMemory);
        const double x = kMemory * last_x + rest * random.normal(),
                     other = kMemory * last_y + rest * random.normal();
        sum += (x - last_x) * std::cos(way) + (other - last_y) * std::sin(way);
        last_x = x, last_y = other;
        y.push_back(sum);
    }
    Straight model(NoiseKind::Level, std::move(y));
    const Fitted still = fitted(model, {});
    model.only().turn = turn;
    const Fitted turning = fitted(model, {});
    CHECK(turning.log_likelihood > still.log_likelihood + 5);
    CHECK(turning.state.noise[0].carry < still.state.noise[0].carry - 1);
}

TEST_CASE("what a lever does is learnt on the way and doubted until then", "[gap][fit]") {
    constexpr double kDoubt = 0.5, kMemory = 0.6, kManyFreedoms = 1e6;
    constexpr int kChains = 400, kRows = 40;
    RandomStream random(3, "test/lever");
    double squares = 0.0, blind = 0.0, misses = 0.0;
    for (int chain = 0; chain < kChains; ++chain) {
        const double amount = kDoubt * random.normal();
        const double level = random.normal();
        double error = random.normal();
        Walk walk{}, other{};
        Lever lever{};
        walk.begin(level + error, (level + error) / 2, 0.5);
        other.begin(level + error, (level + error) / 2, 0.5);
        lever.begin(0.0, kDoubt * kDoubt);
        for (int i = 1; i < kRows; ++i) {
            error = kMemory * error + std::sqrt(1 - kMemory * kMemory) * random.normal();
            const double arm = 0.3 * i, value = level + error + amount * arm;
            double news = 0.0;
            const double variance = walk.filter(value, arm, lever, 0.0, kMemory, kManyFreedoms, news);
            squares += news * news / variance;
            const double without = other.filter(value, 0.0, kMemory, kManyFreedoms, news);
            blind += news * news / without;
        }
        misses += std::pow(lever.mean - amount, 2) / lever.variance;
    }
    CHECK(squares / (kChains * (kRows - 1)) == Approx(1.0).margin(0.05));
    CHECK(blind / (kChains * (kRows - 1)) > 1.5);
    CHECK(misses / kChains == Approx(1.0).margin(0.25));
}

TEST_CASE("clipped rows say at least this far, not this far", "[gap][fit]") {
    RandomStream random(3, "test/clip");
    std::vector<double> y;
    for (std::size_t i = 0; i < 2000; ++i)
        y.push_back(std::min(3.0 * Straight::x(i) + 1.0 + 0.5 * random.normal(), 2.0));
    Straight model(NoiseKind::Carry, y);
    model.only().instrument.ceiling = 2.0;
    CHECK(fitted(model, {kSlope, kOffset}).state.values[0] == Approx(3.0).margin(0.1));
    Straight naive(NoiseKind::Carry, y);
    CHECK(fitted(naive, {kSlope, kOffset}).state.values[0] < 2.8);
}

TEST_CASE("errors carry over from clipped rows as they do from others", "[gap][fit]") {
    constexpr double kCarry = 0.9, kOff = 0.8;
    double offset = 0.0, carry = 0.0;  // means over the times
    constexpr int kTimes = 8;
    for (int k = 0; k < kTimes; ++k) {
        RandomStream random(k, "test/clipped carry");
        std::vector<double> y;
        double last = random.normal();
        for (std::size_t i = 0; i < 1000; ++i) {
            last = kCarry * last + std::sqrt(1 - kCarry * kCarry) * random.normal();
            y.push_back(std::min(kOff + last, 1.0));
        }
        Straight model(NoiseKind::Carry, std::move(y));
        model.only().instrument.ceiling = 1.0;
        const Fitted found = fitted(model, {kOffset});
        offset += found.state.values[1] / kTimes;
        carry += found.state.noise[0].carry / kTimes;
    }
    // The mean of eight errs by 0.05; were clipped rows the ends of chains, it would read 2.2.
    CHECK(offset == Approx(kOff).margin(0.12));
    CHECK(carry == Approx(kCarry).margin(0.03));
}

TEST_CASE("a fit finds how often rows are lapses", "[gap][fit]") {
    RandomStream random(3, "test/lapse");
    std::vector<double> y;
    for (std::size_t i = 0; i < 3000; ++i)
        y.push_back(random.normal() * (random.uniform() < 0.08 ? 20.0 : 1.0));
    const Straight model(NoiseKind::Carry, std::move(y));
    State start = neutral_state(model);
    start.values[2] = 0.02;
    CHECK(fit(model, {kRate}, start, {}).state.values[2] == Approx(0.08).margin(0.02));
}

TEST_CASE("a lapse's innovation is as far out as the row was unlikely, and the next row's is none",
          "[gap][fit]") {
    constexpr double kCarry = 0.8, kRate = 0.1, kHeight = 15.0;
    constexpr std::size_t kRows = 20000;
    RandomStream random(3, "test/lapses in carried noise");
    std::vector<double> y;
    Predicted p;
    p.lapse_shift.assign(kRows, kHeight);
    p.lapse_both = GENERATE(false, true);
    double last = random.normal();
    for (std::size_t i = 0; i < kRows; ++i) {
        last = kCarry * last + std::sqrt(1 - kCarry * kCarry) * random.normal();
        p.lapse.push_back(i < kRows / 2 ? kRate : 0.0);
        const bool lapse = random.uniform() < p.lapse.back();
        const double side = p.lapse_both && random.uniform() < 0.5 ? -1.0 : 1.0;
        y.push_back(last + (lapse ? side * (kHeight + random.normal()) : 0.0));
    }
    p.mean.assign(kRows, 0.0);
    p.lapse_scale.assign(kRows, 1.0);
    const Straight model(NoiseKind::Carry, std::move(y));
    RowCosts costs;
    row_costs(model.observables()[0], p, {0.0, kCarry, std::log(1e4), 0.0}, costs);
    const std::vector<double>& z = costs.innovation;
    double mean = 0.0, products = 0.0, among_lapses = 0.0, calm = 0.0;
    for (std::size_t i = 1; i < kRows; ++i) {
        mean += z[i] / kRows;
        products += z[i] * z[i - 1] / kRows;
        (i < kRows / 2 ? among_lapses : calm) += z[i] * z[i] / (kRows / 2.0);
    }
    // Standard normal throughout: means of 20 000 err by 0.007, of 10 000 squares by 0.014.
    CHECK(mean == Approx(0.0).margin(0.03));
    CHECK(products == Approx(0.0).margin(0.03));
    CHECK(among_lapses == Approx(1.0).margin(0.06));
    CHECK(calm == Approx(1.0).margin(0.06));
}

TEST_CASE("gradients are the value's own", "[gap][fit]") {
    const NoiseKind kind = GENERATE(NoiseKind::Carry, NoiseKind::Level);
    RandomStream random(3, "test/gradient");
    std::vector<double> y;
    for (std::size_t i = 0; i < 60; ++i)
        y.push_back(Straight::x(i) + student(random, 3));
    Straight model(kind, std::move(y));
    model.only().instrument.ceiling = 2.0;
    const std::vector<Freed> freed{kSlope, kOffset, kRate};
    const Layout layout(model, freed, kThorough);
    State state = neutral_state(model);
    state.noise[0] = {0.1, kind == NoiseKind::Level ? -2.0 : 0.3, 1.5, kind == NoiseKind::Level ? 0.2 : 0.0};
    state.values = {0.4, 0.1, GENERATE(0.0, 0.05)};
    const std::vector<double> x = layout.packed(state);
    Weights weights{std::vector<double>(60, 1.0)};
    weights[0][7] = 0.0;
    Objective objective(model, layout, state, weights);
    Eigen::VectorXd gradient;
    Eigen::MatrixXd curvature, rows;
    objective.slopes(x.data(), gradient, curvature, &rows);
    CHECK(rows.rows() == 60);
    for (std::size_t j = 0; j < layout.size(); ++j) {
        if (j == 2 && state.values[2] == 0.0) continue;  // at its bound
        constexpr double kStep = 1e-4;
        auto up = x, down = x;
        up[j] += kStep;
        down[j] -= kStep;
        const double slope = (objective.value(up.data()) - objective.value(down.data())) / (2 * kStep);
        CHECK(gradient[static_cast<Eigen::Index>(j)] == Approx(slope).margin(0.02).epsilon(0.01));
        CHECK(curvature(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(j)) > 0);
    }
}

TEST_CASE("predictions of a sum filtered side by side give what each gives alone", "[gap][fit]") {
    const bool levered = GENERATE(false, true);
    RandomStream random(5, "test/side by side");
    std::vector<double> y{0.0};
    for (int i = 1; i < 300; ++i)
        y.push_back(y.back() + 0.3 * random.normal() + (i % 90 == 0 ? 20 : 0));
    Straight model(NoiseKind::Level, y);
    model.only().starts[140] = 1;
    std::array<Prediction, kLanes> predictions;
    std::array<const Predicted*, kLanes> predicted{};
    std::array<NoiseParameters, kLanes> noise;
    std::array<Innovations, kLanes> together;
    std::array<Innovations*, kLanes> out{};
    for (std::size_t k = 0; k < kLanes; ++k) {
        const auto some = static_cast<double>(k);
        model.predict({0.1 * some, 0.2, 0.0}, predictions[k]);
        for (int i = 0; levered && i < 300; ++i)
            predictions[k][0].lever.push_back(0.02 * i * some);
        predictions[k][0].lever_sd = 0.3;
        predicted[k] = &predictions[k][0];
        noise[k] = {-0.5 + 0.2 * some, -3 + some, 1.5, 0.2 * some};
        out[k] = &together[k];
    }
    REQUIRE(is_plain_sum(model.only(), *predicted[0]));
    filter_sums(model.only(), predicted, noise, out);
    for (std::size_t k = 0; k < kLanes; ++k) {
        Innovations alone;
        filter(model.only(), *predicted[k], noise[k], alone);
        CHECK(together[k].z == alone.z);
        CHECK(together[k].variance == alone.variance);
        CHECK((together[k].role == alone.role));
    }
}

TEST_CASE("the sum of costs is that of every row's") {
    RandomStream random(6, "cost sums");
    for (const NoiseKind kind : {NoiseKind::Carry, NoiseKind::Level})
        for (const double far : {0.0, 1e30})
            for (const bool lapses : {false, true}) {
                std::vector<double> y{0.0};
                for (int i = 1; i < 400; ++i)
                    y.push_back(y.back() + random.normal() + (i % 100 == 0 ? far : 0));
                Straight model(kind, y);
                Prediction prediction;
                model.predict({0.3, 0.1, lapses ? 0.02 : 0.0}, prediction);
                const NoiseParameters noise{-0.3, kind == NoiseKind::Level ? -2.0 : 0.4, 1.2, 0.3};
                Innovations innovations;
                filter(model.only(), prediction[0], noise, innovations);
                std::vector<double> cost, some;
                costs_of(model.only(), prediction[0], noise, innovations, cost);
                double all = 0.0, part = 0.0;
                for (std::size_t i = 0; i < cost.size(); ++i) {
                    some.push_back(i % 3 == 0 ? 0.0 : i % 7 == 0 ? 0.25 : 1.0);
                    all += cost[i];
                    part += some[i] * cost[i];
                }
                CHECK(cost_sum(model.only(), prediction[0], noise, innovations, {}) ==
                      Approx(all).epsilon(1e-9));
                CHECK(cost_sum(model.only(), prediction[0], noise, innovations, some) ==
                      Approx(part).epsilon(1e-9));
            }
}

TEST_CASE("what is carried over fades over rows that are missing", "[gap][fit]") {
    constexpr double kCarry = 0.8;
    RandomStream random(Catch::rngSeed(), "missing rows");
    std::vector<double> y;
    std::vector<std::uint32_t> steps;
    double error = random.normal();
    std::uint32_t step = 1;
    for (int i = 0; i < 20000; ++i, ++step) {
        error = kCarry * error + std::sqrt(1 - kCarry * kCarry) * random.normal();
        if (random.uniform() < 0.4) continue;
        y.push_back(error);
        steps.push_back(step);
        step = 0;
    }
    Straight model(NoiseKind::Carry, y);
    CHECK(fitted(model, {}).state.noise[0].carry < 0.76);  // taken for neighbours all
    model.only().steps = steps;
    const auto known = fitted(model, {});
    CHECK(known.state.noise[0].carry == Approx(kCarry).margin(0.02));
    CHECK(known.state.noise[0].log_sd == Approx(0.0).margin(0.06));
    const auto costs = costs_at(model, known.state, model.predicted(known.state.values));
    double squares = 0.0;
    for (const double z : costs[0].innovation)
        squares += z * z;
    CHECK(squares / static_cast<double>(y.size()) == Approx(1.0).margin(0.05));
}
