// A term without a mechanism is learnt where there is one, from the rows that are given, and from nothing
// else.

#include "base/random.h"
#include "gap/extension/formula.h"
#include "gap/extension/held_costs.h"
#include "gap/extension/learn.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

using namespace puckloop;
using namespace puckloop::gap;

namespace {

/// Ten runs; what a row gains by its covariates "speed" (-0.1 to 0.1), "time" (0 to 20) and, of readings, of
/// two sensors. Sums are noisy by 1 and wander a little; readings carry 0.5 over.
Subject made(bool sums, const std::function<double(double speed, double time, int sensor)>& gains,
             std::uint64_t seed, double noise = 1.0) {
    RandomStream random(seed, "learning");
    constexpr int kRuns = 10, kRows = 200;
    Subject subject;
    subject.quantity = sums ? "motion.turn" : "ground.reading";
    subject.sums = sums;
    subject.covariates = {{"speed", "m/s", {}, sums}, {"time", "s", {}}};
    subject.sensors = sums ? 1 : 2;
    for (int r = 0; r < kRuns; ++r)
        for (int sensor = 0; sensor < subject.sensors; ++sensor) {
            double speed = 0.0, sum = 0.0, kept = 0.0;
            for (int i = 0; i < kRows; ++i) {
                if (i % 20 == 0) speed = 0.2 * random.uniform() - 0.1;
                const double time = 0.1 * i;
                subject.covariates[0].value.push_back(speed);
                subject.covariates[1].value.push_back(time);
                subject.weight.push_back(i == 0 && sums ? 0.0 : 1.0);
                subject.moments.push_back(static_cast<std::uint32_t>(subject.moments.size()));
                sum += i == 0 ? 0.0 : gains(speed, time, sensor) + 0.02 * noise * random.normal();
                kept = 0.5 * kept + random.normal();
                subject.error.push_back(sums ? sum + noise * random.normal()
                                             : gains(speed, time, sensor) + noise * kept);
                subject.run.push_back(static_cast<std::uint32_t>(r));
                subject.starts.push_back(i == 0 ? 1 : 0);
                subject.sensor.push_back(sensor);
            }
        }
    subject.moments.push_back(static_cast<std::uint32_t>(subject.moments.size()));
    return subject;
}

std::vector<char> runs_below(const Subject& subject, std::uint32_t most) {
    std::vector<char> used;
    for (const auto run : subject.run)
        used.push_back(run < most ? 1 : 0);
    return used;
}

/// rms of what a row's errors are off by, in the runs that were not used.
std::pair<double, double> held_out(const Subject& subject, const std::vector<char>& used,
                                   const Learnt& learnt) {
    const auto added = learnt.in_rows(subject);
    double before = 0.0, after = 0.0, rows = 0.0;
    for (std::size_t i = 0; i < used.size(); ++i) {
        if (used[i] != 0) continue;
        before += subject.error[i] * subject.error[i];
        after += std::pow(subject.error[i] - added[i], 2);
        rows += 1;
    }
    return {std::sqrt(before / rows), std::sqrt(after / rows)};
}

}  // namespace

TEST_CASE("from noise alone nothing is learnt", "[gap][extension]") {
    int learnt = 0;
    for (std::uint64_t seed = 1; seed <= 10; ++seed)
        for (const bool sums : {false, true}) {
            const Subject subject = made(
                sums, [](double, double, int) { return 0.0; }, seed);
            learnt += learnt_from(subject, runs_below(subject, 10)).parts.empty() ? 0 : 1;
        }
    // Evidence of 3 nats beyond the number of tables: one in twenty and less.
    CHECK(learnt <= 2);
}

TEST_CASE("a reading's function of two covariates is learnt and holds on other runs", "[gap][extension]") {
    const auto gains = [](double speed, double time, int) {
        return 4 * std::sin(40 * speed) * (time > 10 ? 1.0 : 0.2);
    };
    const Subject subject = made(false, gains, 3);
    const auto used = runs_below(subject, 7);
    const Learnt learnt = learnt_from(subject, used);
    REQUIRE_FALSE(learnt.parts.empty());
    const auto [before, after] = held_out(subject, used, learnt);
    CHECK(before > 2.0);
    CHECK(after < 1.35);  // the noise is 1 / sqrt(1 - 0.25) = 1.15
    CHECK(learnt.law.number == Approx(0.5).margin(0.15));
}

TEST_CASE("one sensor's term is that sensor's", "[gap][extension]") {
    const Subject subject = made(
        false, [](double speed, double, int sensor) { return sensor == 1 ? 50 * std::abs(speed) : 0.0; }, 4);
    const Learnt learnt = learnt_from(subject, runs_below(subject, 10));
    const auto added = learnt.in_rows(subject);
    double first = 0.0, second = 0.0, rows = 0.0;
    for (std::size_t i = 0; i < added.size(); ++i) {
        const double truth = subject.sensor[i] == 1 ? 50 * std::abs(subject.covariates[0].value[i]) : 0.0;
        (subject.sensor[i] == 0 ? first : second) += std::pow(added[i] - truth, 2);
        rows += 0.5;
    }
    CHECK(std::sqrt(first / rows) < 0.5);
    CHECK(std::sqrt(second / rows) < 0.7);
}

TEST_CASE("what a sum gains in its rows is learnt under its noise and its walk", "[gap][extension]") {
    const auto gains = [](double speed, double, int) { return 0.3 * std::tanh(60 * speed); };
    const Subject subject = made(true, gains, 5);
    const auto used = runs_below(subject, 7);
    const Learnt learnt = learnt_from(subject, used);
    REQUIRE_FALSE(learnt.parts.empty());
    const auto [before, after] = held_out(subject, used, learnt);
    CHECK(before > 5.0);
    CHECK(after < 0.3 * before);
    // Values are known as well as is said.
    const LearntPart& part = learnt.parts.front();
    REQUIRE(part.basis.shape().over.size() == 1);
    REQUIRE(part.basis.shape().over[0] == 0);
    const auto& at = part.basis.places().front();
    double squares = 0.0;
    for (std::size_t k = 1; k + 1 < at.size(); ++k) {
        const auto place = static_cast<Eigen::Index>(k);
        squares += std::pow((part.value[place] - gains(at[k], 0, 0)) / part.sd[place], 2);
    }
    CHECK(squares / static_cast<double>(at.size() - 2) < 6.0);
}

TEST_CASE("a step is learnt as sharp as it is, so that little of it adds up", "[gap][extension]") {
    const auto gains = [](double speed, double, int) { return 0.3 * std::tanh((speed - 0.02) / 0.004); };
    const Subject subject = made(true, gains, 9);
    const auto used = runs_below(subject, 7);
    const auto [before, after] = held_out(subject, used, learnt_from(subject, used));
    CHECK(before > 5.0);
    CHECK(after < 0.25 * before);
}

TEST_CASE("places are where rows are and all over the range, whatever strays", "[gap][extension]") {
    Subject subject = made(
        true, [](double, double, int) { return 0.0; }, 10);
    auto& speed = subject.covariates[0].value;
    for (std::size_t i = 0; i < speed.size(); ++i)
        if (i % 2 == 0) speed[i] = 0.05;  // a crowd
    speed[1] = 5.0;                       // a stray value
    const auto used = runs_below(subject, 10);
    LaidAxes axes(subject, used);
    const TableBasis basis(axes, {{0}}, 32);
    const auto& at = basis.places()[0];
    CHECK(at.front() < -0.08);
    CHECK(at.back() == 5.0);
    CHECK(std::ranges::is_sorted(at));
    CHECK(std::ranges::count_if(at, [](double one) { return one < 0.1; }) >= 5);
}

TEST_CASE("a run that goes where no other went is predicted with doubt", "[gap][extension]") {
    const auto gains = [](double speed, double, int) { return 1.5 * std::sin(60 * speed); };
    Subject subject = made(true, gains, 11);
    const auto used = runs_below(subject, 8);
    // What the learnt runs do beyond 0.03 is not seen; in the ninth run the term differs from any guess
    // there.
    double offset = 0.0;
    for (std::size_t i = 0; i < subject.error.size(); ++i) {
        if (subject.starts[i] != 0) offset = 0.0;
        double& speed = subject.covariates[0].value[i];
        const double was = speed;
        if (subject.run[i] != 8) speed = std::min(speed, 0.03);
        if (subject.run[i] == 8) speed = 0.03 + std::abs(speed) / 2;
        if (subject.starts[i] == 0) offset += gains(speed, 0, 0) - gains(was, 0, 0);
        subject.error[i] += offset;
    }
    const Learnt learnt = learnt_from(subject, used);
    REQUIRE_FALSE(learnt.parts.empty());
    Learnt sure = learnt;  // takes its mean for the truth
    sure.covariance.setZero();
    const auto with = held_costs(subject, used, learnt, true),
               without = held_costs(subject, used, learnt, false),
               surely = held_costs(subject, used, sure, true);
    double known = 0.0, unknown = 0.0, unknown_to_sure = 0.0;
    for (std::size_t i = 0; i < with.size(); ++i) {
        CHECK((used[i] == 0 || (with[i] == 0.0 && without[i] == 0.0)));
        (subject.run[i] == 8 ? unknown : known) += without[i] - with[i];
        if (subject.run[i] == 8) unknown_to_sure += without[i] - surely[i];
    }
    CHECK(known > 50.0);
    CHECK(unknown > -150.0);  // of 200 rows
    CHECK(unknown_to_sure < -2000.0);
}

TEST_CASE("runs that differ by themselves teach a spread and no function", "[gap][extension]") {
    RandomStream random(8, "offsets");
    std::vector<double> offset;
    for (int r = 0; r < 10; ++r)
        offset.push_back(5 * random.normal());
    Subject subject = made(
        false, [](double, double, int) { return 0.0; }, 6);
    for (std::size_t i = 0; i < subject.error.size(); ++i)
        subject.error[i] += offset[subject.run[i]];
    const Learnt learnt = learnt_from(subject, runs_below(subject, 10));
    REQUIRE_FALSE(learnt.parts.empty());
    CHECK(learnt.parts.front().basis.shape().by_run);
    CHECK(learnt.parts.front().spread == Approx(5.0).epsilon(0.5));
    for (const double one : learnt.in_rows(subject))
        CHECK(std::abs(one) < 1.0);  // of another run nothing is known
}

TEST_CASE("a short formula is given where one fits as well, and none where none does", "[gap][extension]") {
    const auto used_all = [](const Subject& subject) { return runs_below(subject, 10); };
    const Subject simple = made(
        true, [](double speed, double time, int) { return 0.4 * speed * time; }, 7);
    const std::string formula = formula_of(simple, used_all(simple), learnt_from(simple, used_all(simple)));
    INFO(formula);
    CHECK(formula.find("speed x time") != std::string::npos);
    REQUIRE_FALSE(formula.empty());
    CHECK(std::stod(formula) == Approx(0.4).margin(0.02));
    // Two zigzags: straight lines between places follow them, powers and roots do not.
    const auto zigzag = [](double speed, double, int) {
        const double share = std::fmod((speed + 0.1) / 0.1, 1.0);
        return 5 * (4 * std::abs(share - 0.5) - 1);
    };
    const Subject bent = made(false, zigzag, 8, 0.2);
    const Learnt tables = learnt_from(bent, used_all(bent));
    REQUIRE_FALSE(tables.parts.empty());
    CHECK(formula_of(bent, used_all(bent), tables).empty());
}
