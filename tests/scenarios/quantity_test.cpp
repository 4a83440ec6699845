#include "scenarios/values/quantity.h"

#include <catch2/catch.hpp>

#include <numbers>

using namespace puckloop::scenarios;

TEST_CASE("quantities are read in SI units") {
    CHECK(parse_quantity("60 s", Dimension::Time) == 60.0);
    CHECK(parse_quantity("20ms", Dimension::Time) == Approx(0.020));
    CHECK(parse_quantity("25 cm", Dimension::Length) == Approx(0.25));
    CHECK(parse_quantity(" -45 deg ", Dimension::Angle) == Approx(-std::numbers::pi / 4));
    CHECK(parse_quantity("+1.5e2 g", Dimension::Mass) == Approx(0.15));
    CHECK(parse_quantity("50 %", Dimension::Ratio) == Approx(0.5));
    CHECK(parse_quantity("20 ppm", Dimension::Ratio) == Approx(20e-6));
    CHECK(parse_quantity("0.25", Dimension::Number) == 0.25);
}

TEST_CASE("a quantity without a unit, or with the wrong one, is refused with an example") {
    const auto problem = [](std::string_view text, Dimension dimension) {
        try {
            parse_quantity(text, dimension);
        } catch (const QuantityError& error) {
            return error.problem + "|" + error.expected;
        }
        return std::string("accepted");
    };
    CHECK(problem("60", Dimension::Time) == "'60' has no unit|a time such as \"20 ms\"");
    CHECK(problem("60 m", Dimension::Time) == "'60 m' is a length|a time such as \"20 ms\"");
    CHECK(problem("60 sec", Dimension::Time) == "unknown unit 'sec'|one of s, ms, us, min, h");
    CHECK(problem("fast", Dimension::Time) == "'fast' does not begin with a number|a time such as \"20 ms\"");
    CHECK(problem("nan s", Dimension::Time).starts_with("'nan s' does not begin with a number"));
    CHECK(problem("1e999 s", Dimension::Time).starts_with("'1e999 s' does not begin with a number"));
    CHECK(problem("", Dimension::Length).starts_with("'' does not begin with a number"));
    CHECK(problem("3 m", Dimension::Number).starts_with("'3 m' is a length"));
    CHECK(problem("3 apples", Dimension::Number).starts_with("'3 apples' has a unit where none belongs"));
}
