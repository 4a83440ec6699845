// The free-form correction: finds what is there on runs it did not see, and nothing in noise.

#include "base/random.h"
#include "gap/residual_model/free_form_cells.h"
#include "gap/stats/boosting.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numeric>

using namespace puckloop;
using namespace puckloop::gap::stats;

namespace {

constexpr int kRuns = 8, kRows = 100, kCells = 8;

/// Rows of eight runs: two covariates in cells at random and errors that carry over.
struct Made {
    ErrorRows rows;
    std::vector<Component> components;
};

Made made(double carry, std::uint64_t seed, double (*effect)(int a, int b)) {
    RandomStream random(seed, "boosting test");
    Made m;
    m.rows.carry = carry;
    Component a{"a", {}, {}, {}, {}, kCells, true}, b{"b", {}, {}, {}, {}, 2, false},
        both{"a and b", {}, {}, {}, {}, 2 * kCells, false};
    for (int run = 0; run < kRuns; ++run) {
        double noise = random.normal();
        for (int i = 0; i < kRows; ++i) {
            const auto cell = static_cast<int>(random.below(kCells)),
                       side = static_cast<int>(random.below(2));
            a.cell.push_back(cell);
            b.cell.push_back(side);
            both.cell.push_back(2 * cell + side);
            m.rows.error.push_back(noise + effect(cell, side));
            m.rows.follows.push_back(i > 0 ? 1 : 0);
            m.rows.run.push_back(run);
            noise = carry * noise + std::sqrt(1 - carry * carry) * random.normal();
        }
    }
    m.components = {a, b, both};
    return m;
}

double nothing(int, int) {
    return 0.0;
}
double hump(int a, int) {
    return a == 3 || a == 4 ? 1.0 : 0.0;
}
double only_together(int a, int b) {
    return (a < kCells / 2) == (b == 0) ? 0.5 : -0.5;
}

double won(const Boosted& fit) {
    return std::accumulate(fit.gains.begin(), fit.gains.end(), 0.0);
}

}  // namespace

TEST_CASE("boosting finds nothing in noise, white or carried over") {
    for (const double carry : {0.0, 0.8})
        for (std::uint64_t seed = 1; seed <= 6; ++seed) {
            const Made m = made(carry, seed, nothing);
            INFO("carry " << carry << " seed " << seed);
            CHECK(won(boosted(m.rows, m.components, 1)) < 6);
        }
}

TEST_CASE("boosting learns a hump and names its covariate") {
    const Made m = made(0.4, 3, hump);
    const Boosted fit = boosted(m.rows, m.components, 1);
    CHECK(won(fit) > 20);
    CHECK(fit.weight[0] + fit.weight[2] > 10 * fit.weight[1]);
    double inside = 0, outside = 0, n_in = 0, n_out = 0;
    for (std::size_t i = 0; i < fit.correction.size(); ++i) {
        const bool in = m.components[0].cell[i] == 3 || m.components[0].cell[i] == 4;
        (in ? inside : outside) += fit.correction[i];
        (in ? n_in : n_out) += 1;
    }
    CHECK(inside / n_in - outside / n_out == Approx(1.0).margin(0.3));
}

TEST_CASE("boosting sees what two covariates do only together") {
    const Made m = made(0.0, 5, only_together);
    const Boosted fit = boosted(m.rows, m.components, 1);
    CHECK(won(fit) > 20);
    CHECK(fit.weight[2] > 10 * (fit.weight[0] + fit.weight[1]));
}

TEST_CASE("a structure that made errors look carried over is found all the same") {
    // A level for whole runs, and a noise model that took it for carry-over.
    Made m = made(0.0, 7, nothing);
    Component kind{"kind of run", {}, {}, {}, {}, 2, false};
    for (std::size_t i = 0; i < m.rows.error.size(); ++i) {
        kind.cell.push_back(m.rows.run[i] % 2);
        if (kind.cell.back() == 1) m.rows.error[i] += 2;
    }
    m.components.push_back(kind);
    m.rows.carry = 0.5;
    const Boosted fit = boosted(m.rows, m.components, 1);
    CHECK(won(fit) > 20);
    CHECK(fit.carry < 0.4);
}

TEST_CASE("what is peculiar to one run is not learnt") {
    Made m = made(0.0, 9, nothing);
    Component place{"row", {}, {}, {}, {}, 10, true};
    for (std::size_t i = 0; i < m.rows.error.size(); ++i) {
        place.cell.push_back(static_cast<int>(i % kRows) / 10);
        m.rows.error[i] += 0.7 * std::sin(2.0 * m.rows.run[i] + 0.6 * place.cell.back());
    }
    m.components = {place};
    CHECK(won(boosted(m.rows, m.components, 1)) < 6);
}

TEST_CASE("errors of a tracker about a place choose no cell") {
    puckloop::gap::Experiment experiment;
    experiment.kind = puckloop::gap::Kind::Motion;
    puckloop::gap::Run run;
    puckloop::gap::Series rows;
    std::vector<char> starts;
    for (std::size_t k = 0; k < 40; ++k) {
        run.columns["x_m"].push_back(k % 2 == 0 ? 3e-4 : -3e-4);
        run.columns["y_m"].push_back(k % 3 == 0 ? 2e-4 : -2e-4);
        run.columns["theta_rad"].push_back(0.4);
        run.columns["t_s"].push_back(0.1 * static_cast<double>(k));
        rows.run.push_back(0);
        rows.row.push_back(static_cast<std::uint32_t>(k));
        starts.push_back(k == 0 ? 1 : 0);
    }
    run.rows = 40;
    experiment.runs.push_back(std::move(run));
    for (const auto& component : puckloop::gap::free_form_cells(experiment, rows, starts)) {
        INFO(component.name);
        CHECK(component.name.find("origin") == std::string::npos);
        CHECK(component.name.find("position x") == std::string::npos);
    }
}
