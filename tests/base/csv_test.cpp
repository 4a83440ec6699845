// Cells, numbers and columns of tables as text.

#include "base/random.h"
#include "base/text/csv.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <limits>

using namespace puckloop;

TEST_CASE("cells are trimmed, empty ones kept but between blanks") {
    CHECK(csv_cells("a, \"b\" ,,c\r", ',') == std::vector<std::string_view>{"a", "b", "", "c"});
    CHECK(csv_cells(R"("0,123",5," a;b ";"c")", ',') ==
          std::vector<std::string_view>{"0,123", "5", "a;b \";\"c"});
    CHECK(csv_cells("", ',') == std::vector<std::string_view>{""});
    CHECK(csv_cells("  1 \t 2\t", ' ') == std::vector<std::string_view>{"1", "2"});
    CHECK(csv_cells("   ", ' ').empty());
    CHECK(csv_trimmed(" \t\"x y\" \r\n") == "x y");
}

TEST_CASE("a cell is a number or is not") {
    double value = 0.0;
    CHECK((csv_number("+1.5e3", value) && value == 1500));
    CHECK((csv_number("-0", value) && value == 0));
    for (const char* cell : {"", "+", "1,5", "1 2", "x", "0x10", "1e", "--1"})
        CHECK_FALSE(csv_number(cell, value));
}

TEST_CASE("what is written is read back to the last bit, and gaps stay gaps") {
    RandomStream random(1, "csv");
    std::vector<double> a, b;
    for (int k = 0; k < 200; ++k) {
        a.push_back((random.uniform() - 0.5) * std::pow(10.0, static_cast<double>(random.below(40)) - 20));
        b.push_back(k % 7 == 0 ? std::numeric_limits<double>::quiet_NaN() : random.normal());
    }
    const CsvColumn columns[] = {{"a", a}, {"b", b}};
    std::string text = csv_text(columns);
    std::vector<std::string_view> lines;
    for (std::size_t at = 0; at < text.size(); at = text.find('\n', at) + 1)
        lines.push_back(std::string_view(text).substr(at, text.find('\n', at) - at));
    REQUIRE(lines.size() == 201);
    CHECK(lines[0] == "a,b");
    for (std::size_t k = 0; k < 200; ++k) {
        const auto cells = csv_cells(lines[k + 1], ',');
        double value = 0.0;
        REQUIRE(cells.size() == 2);
        CHECK((csv_number(cells[0], value) && value == a[k]));
        CHECK(std::isnan(b[k]) == cells[1].empty());
    }
    const std::vector<double> third{1.0 / 3};
    const CsvColumn one[] = {{"x", third}};
    CHECK(csv_text(one, 4) == "x\n0.3333\n");
}
