// Formulas of described kinds: what they mean, what is refused, and that threads do not disturb each other.

#include "gap/kinds/formula.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>
#include <numbers>
#include <thread>
#include <vector>

using namespace puckloop::gap;
using Catch::Matchers::Contains;

namespace {

const std::vector<std::string> kVariables{"x", "distance_m", "gain"};

double value_of(const std::string& text, double x) {
    const Formula formula(text, kVariables);
    std::vector<Formula::Input> inputs(formula.used().size(), {nullptr, x});
    double out = 0.0;
    formula.evaluate(inputs, {&out, 1});
    return out;
}

std::string refusal(const std::string& text) {
    try {
        const Formula formula(text, kVariables);
    } catch (const FormulaError& error) {
        return error.what() + std::string("; expected ") + error.expected();
    }
    return "none";
}

}  // namespace

TEST_CASE("operators and functions mean what the page says") {
    CHECK(value_of("-x^2", 3) == -9);
    CHECK(value_of("2^3^2", 0) == 512);
    CHECK(value_of("x > 2 && x < 4 ? 10 : 20", 3) == 10);
    CHECK(value_of("x != 3 || x == 3", 3) == 1);
    CHECK(value_of("sin(pi / 2) + 1e-3", 0) == 1.001);
    CHECK(value_of("log(exp(x))", 2) == Approx(2));
    CHECK(value_of("log10(x)", 1000) == Approx(3));
    CHECK(value_of("step(x)", 0) == 1);
    CHECK(value_of("step(x)", -1e-9) == 0);
    CHECK(value_of("clip(x, 0, 2)", 5) == 2);
    CHECK(value_of("max(1, x, 2) - min(x, 4)", 3) == 0);
    CHECK(value_of("hyperbola(x, 2)", 2) == 0.5);
    CHECK(value_of("round(x)", 2.5) == 3);
    CHECK(value_of("wrap(x)", 2 * std::numbers::pi + 0.1) == Approx(0.1));
    CHECK(value_of("logistic(x)", 0) == 0.5);
    CHECK(value_of("normal(x)", 0) == 0.5);
    CHECK(value_of("x * hypot(3, 4)", 2) == 10);
}

TEST_CASE("what is not defined is no number, not a wrong one") {
    CHECK(std::isnan(value_of("sqrt(x)", -1)));
    CHECK(std::isinf(value_of("1 / x", 0)));
    CHECK(std::isnan(value_of("step(x)", std::numeric_limits<double>::quiet_NaN())));
}

TEST_CASE("refusals say what and where, and the nearest name") {
    CHECK_THAT(refusal("distance * 2"), Contains("\"distance\" at character 1") && Contains("distance_m"));
    CHECK_THAT(refusal("2 + sqr(x)"), Contains("\"sqr\" at character 5") && Contains("\"sqrt\""));
    CHECK_THAT(refusal("x = 3"), Contains("\"=\" at character 3") && Contains("=="));
    CHECK_THAT(refusal("x = = 3"), Contains("\"=\""));
    CHECK_THAT(refusal("x, 2"), Contains("several values"));
    CHECK_THAT(refusal("(x"), Contains("is no formula"));
    CHECK_THAT(refusal("x +"), Contains("is no formula"));
    CHECK_THAT(refusal("2x"), Contains("right after a number"));
    CHECK_THAT(refusal("\"x\""), Contains("at character 1"));
    CHECK_THAT(refusal("sqrt + 1"), Contains("without \"(\""));
    CHECK_THAT(refusal("x\n"), Contains("no text"));
    CHECK_THAT(refusal("  "), Contains("is empty"));
    CHECK_THAT(refusal(std::string(Formula::kLongest + 1, '1')), Contains("characters"));
    CHECK_THAT(refusal(std::string(900, '(') + "x" + std::string(900, ')')), Contains("none"));
    CHECK(refusal("x + gain") == "none");
}

TEST_CASE("names that a formula can have") {
    CHECK(is_variable_name("distance_m"));
    CHECK(is_variable_name("a1"));
    for (const char* name : {"", "1a", "_a", "a-b", "a b", "pi", "sqrt", "min", "\xc3\xa9"})
        CHECK_FALSE(is_variable_name(name));
    CHECK_FALSE(is_variable_name(std::string(41, 'a')));
}

TEST_CASE("many threads get what one gets, to the last bit") {
    const Formula formula("gain * exp(-distance_m / 3) + sin(x)", kVariables);
    constexpr std::size_t kRows = 2000;
    std::vector<double> x, distance;
    for (std::size_t i = 0; i < kRows; ++i)
        x.push_back(0.01 * static_cast<double>(i)), distance.push_back(1.0 / static_cast<double>(i + 1));
    const auto evaluated = [&](double gain) {
        std::vector<double> out(kRows);
        const Formula::Input inputs[] = {{x.data()}, {distance.data()}, {nullptr, gain}};
        formula.evaluate(inputs, out);
        return out;
    };
    std::vector<std::vector<double>> alone, together(8);
    for (int k = 0; k < 8; ++k)
        alone.push_back(evaluated(k));
    std::vector<std::thread> threads;
    for (int k = 0; k < 8; ++k)
        threads.emplace_back([&, k] {
            for (int again = 0; again < 5; ++again)
                together[static_cast<std::size_t>(k)] = evaluated(k);
        });
    for (std::thread& thread : threads)
        thread.join();
    CHECK(together == alone);
}
