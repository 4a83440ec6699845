// Quantiles, and text files that are written whole.

#include "base/error.h"
#include "base/quantile.h"
#include "base/text_file.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace puckloop;

TEST_CASE("quantiles lie between the values, NaN left out") {
    CHECK(median({3, NAN, 1, 2}) == 2);
    CHECK(median({4, 1, 2, 3}) == 2.5);
    CHECK(upper_median({4, 1, 2, 3}) == 3);
    CHECK(quantile({0, 10, 20}, 0.25) == 5);
    CHECK(quantile({5, 7}, 0) == 5);
    CHECK(quantile({5, 7}, 1) == 7);
    CHECK((std::isnan(median({NAN})) && std::isnan(upper_median({}))));
}

TEST_CASE("a file or folder that cannot be made is named with the reason") {
    CHECK_THROWS_WITH(write_file("/dev/full", std::string(100000, 'x')),
                      "/dev/full: cannot be written: No space left on device");
    CHECK_THROWS_WITH(write_file("/nowhere/file", ""),
                      "/nowhere/file: cannot be written: No such file or directory");
    CHECK_THROWS_AS(make_folder("/dev/null/folder"), RunError);
}
