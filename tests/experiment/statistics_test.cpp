// The tests and intervals against worked examples of textbooks and against counts by hand.

#include "campaigns/statistics/correlation.h"
#include "campaigns/statistics/distributions.h"
#include "campaigns/statistics/friedman.h"
#include "campaigns/statistics/intervals.h"
#include "campaigns/statistics/ranks.h"
#include "campaigns/statistics/wilcoxon.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>

using namespace puckloop;
using namespace puckloop::statistics;

TEST_CASE("tails of distributions are those of printed tables") {
    CHECK(chi_square_above(3.841459, 1) == Approx(0.05).epsilon(1e-6));
    CHECK(chi_square_above(5.991465, 2) == Approx(0.05).epsilon(1e-6));
    CHECK(chi_square_above(18.307038, 10) == Approx(0.05).epsilon(1e-6));
    CHECK(chi_square_above(2.0, 2) == Approx(std::exp(-1.0)));  // of two degrees it is exp(-x / 2)
    CHECK(chi_square_above(40.0, 2) == Approx(std::exp(-20.0)));
    CHECK(chi_square_above(0.0, 3) == 1.0);
    CHECK(normal_above(1.959964) == Approx(0.025).epsilon(1e-6));
    CHECK(fair_binomial_up_to(1, 10) == Approx(11.0 / 1024));
}

TEST_CASE("ties share the mean of their ranks") {
    const std::vector<double> values{5, 2, 5, 1};
    CHECK(midranks(values) == std::vector<double>{3.5, 2, 3.5, 1});
    CHECK(tie_sum(values) == 6.0);
}

TEST_CASE("signed-rank: depression scale before and after (Hollander and Wolfe 1973, p. 29)") {
    const std::vector<double> before{1.83, 0.50, 1.62, 2.48, 1.68, 1.88, 1.55, 3.06, 1.30};
    const std::vector<double> after{0.878, 0.647, 0.598, 2.05, 1.06, 1.29, 1.06, 3.14, 1.29};
    std::vector<double> differences;
    for (std::size_t i = 0; i < before.size(); ++i)
        differences.push_back(before[i] - after[i]);
    const RankTest test = signed_rank(differences);
    CHECK(test.statistic == 40.0);
    CHECK(test.p == Approx(2 * 0.01953125));  // one-sided 0.0195 in the book
    CHECK(test.n == 9);
    CHECK(test.method == "Wilcoxon signed-rank, exact");
}

TEST_CASE("signed-rank leaves out zeros, counts ties, and is symmetric") {
    // Of three equal differences the sum is 6 in one of eight ways.
    CHECK(signed_rank(std::vector<double>{2, 2, 0, 2}).p == Approx(0.25));
    CHECK(signed_rank(std::vector<double>{2, 2, 0, 2}).n == 3);
    CHECK(signed_rank(std::vector<double>{-2, -2, -2}).p == Approx(0.25));
    CHECK(signed_rank(std::vector<double>{0, 0}).p == 1.0);
    CHECK(signed_rank({}).p == 1.0);
    std::vector<double> many;
    for (int i = 1; i <= 201; ++i)
        many.push_back(i % 9 < 4 ? -i : i);
    const RankTest approximate = signed_rank(many);
    CHECK(approximate.method == "Wilcoxon signed-rank, normal approximation");
    CHECK(approximate.p < 0.5);
    many.pop_back();
    const RankTest exact = signed_rank(many);
    CHECK(exact.method == "Wilcoxon signed-rank, exact");
    // The same 200 differences by the normal approximation, which is good to 0.001 there.
    const double mean = 200 * 201 / 4.0, deviation = std::sqrt(200 * 201 * 401 / 24.0);
    const double z = (std::abs(exact.statistic - mean) - 0.5) / deviation;
    CHECK(exact.p == Approx(std::erfc(z / std::numbers::sqrt2)).margin(0.001));
}

TEST_CASE("rank-sum: permeability of membranes (Hollander and Wolfe 1973, p. 69)") {
    const std::vector<double> at_term{0.80, 0.83, 1.89, 1.04, 1.45, 1.38, 1.91, 1.64, 0.73, 1.46};
    const std::vector<double> earlier{1.15, 0.88, 0.90, 0.74, 1.21};
    const RankTest test = rank_sum(at_term, earlier);
    CHECK(test.statistic == 35.0);
    CHECK(test.p == Approx(2 * 0.1272).epsilon(0.001));
    CHECK(rank_sum(earlier, at_term).p == Approx(test.p));
    CHECK(rank_sum(std::vector<double>{1, 2}, std::vector<double>{3, 4}).p == Approx(2.0 / 6));
    CHECK(rank_sum({}, earlier).p == 1.0);
}

TEST_CASE("Friedman: rounding first base (Hollander and Wolfe 1973, p. 140)") {
    const std::vector<std::vector<double>> times{
        {5.40, 5.50, 5.55}, {5.85, 5.70, 5.75}, {5.20, 5.60, 5.50}, {5.55, 5.50, 5.40}, {5.90, 5.85, 5.70},
        {5.45, 5.55, 5.60}, {5.40, 5.40, 5.35}, {5.45, 5.50, 5.35}, {5.25, 5.15, 5.00}, {5.85, 5.80, 5.70},
        {5.25, 5.20, 5.10}, {5.65, 5.55, 5.45}, {5.60, 5.35, 5.45}, {5.05, 5.00, 4.95}, {5.50, 5.50, 5.40},
        {5.45, 5.55, 5.50}, {5.55, 5.55, 5.35}, {5.45, 5.50, 5.55}, {5.50, 5.45, 5.25}, {5.65, 5.60, 5.40},
        {5.70, 5.65, 5.55}, {6.30, 6.30, 6.25}};
    const Friedman test = friedman(times);
    CHECK(test.chi_square == Approx(11.143).epsilon(1e-4));
    CHECK(test.freedom == 2);
    CHECK(test.p == Approx(0.003805).epsilon(1e-3));
    CHECK(test.blocks == 22);
    CHECK(friedman({{1, 1}, {2, 2}}).p == 1.0);
    CHECK(friedman({{1, 2, 3}}).p == 1.0);
}

TEST_CASE("Spearman: quality of canned tuna (Hollander and Wolfe 1973, p. 187)") {
    const std::vector<double> lightness{44.4, 45.9, 41.9, 53.3, 44.7, 44.1, 50.7, 45.2, 60.1};
    const std::vector<double> quality{2.6, 3.1, 2.5, 5.0, 3.6, 4.0, 5.2, 2.8, 3.8};
    CHECK(spearman(lightness, quality) == Approx(0.6));
    CHECK(spearman(std::vector<double>{1, 2, 3}, std::vector<double>{3, 2, 1}) == Approx(-1.0));
    CHECK(std::isnan(spearman(std::vector<double>{1, 2}, std::vector<double>{1, 1})));
}

TEST_CASE("Holm's adjustment") {
    const std::vector<double> adjusted = holm(std::vector<double>{0.01, 0.02, 0.03, 0.04, 0.05});
    const std::vector<double> expected{0.05, 0.08, 0.09, 0.09, 0.09};
    for (std::size_t i = 0; i < expected.size(); ++i)
        CHECK(adjusted[i] == Approx(expected[i]));
    CHECK(holm(std::vector<double>{0.9, 0.8})[0] == 1.0);
}

TEST_CASE("the median's interval is between order statistics, with the coverage of printed tables") {
    const auto of = [](int n) {
        std::vector<double> values;
        for (int i = n; i >= 1; --i)
            values.push_back(i);
        return median_interval(values);
    };
    CHECK(of(10).low == 2.0);
    CHECK(of(10).high == 9.0);
    CHECK(of(10).coverage == Approx(0.9785).epsilon(1e-4));
    CHECK(of(20).low == 6.0);
    CHECK(of(20).high == 15.0);
    CHECK(of(20).coverage == Approx(0.9586).epsilon(1e-4));
    CHECK(of(5).low == 1.0);
    CHECK(of(5).high == 5.0);
    CHECK(of(5).coverage == Approx(0.9375));
    CHECK(of(1).coverage == 0.0);
    CHECK(std::isnan(median_interval({}).low));
}

TEST_CASE("a bootstrap interval of a mean has the width that theory gives, and is the same each time") {
    std::vector<double> values;
    RandomStream random(Catch::rngSeed(), "bootstrap test");
    for (int i = 0; i < 400; ++i)
        values.push_back(random.normal());
    const auto mean = [](const std::vector<std::vector<double>>& samples) {
        double sum = 0.0;
        for (const double value : samples[0])
            sum += value;
        return sum / static_cast<double>(samples[0].size());
    };
    const auto interval = [&] { return bootstrap({values}, RandomStream(1, "test"), mean); };
    CHECK(interval().high - interval().low == Approx(2 * 1.96 / 20).epsilon(0.2));
    CHECK(interval().low < mean({values}));
    CHECK(interval().high > mean({values}));
}
