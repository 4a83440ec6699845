// Warnings that many robots have alike, as one line of a run's summary.

#include "run/report/alike_warnings.h"

#include <catch2/catch.hpp>

using puckloop::tools::alike_as_one;
using Lines = std::vector<std::string>;

TEST_CASE("warnings of boards of a kind that differ in whole numbers are one line with their ranges") {
    CHECK(alike_as_one({"epuck0.linux: 4 of 1651 I2C transfers failed", "epuck0.i2c: addressed 0x20 4 times",
                        "epuck1.linux: 4 of 1478 I2C transfers failed", "epuck1.i2c: addressed 0x20 5 times",
                        "epuck2.linux: 6 of 1500 I2C transfers failed"}) ==
          Lines{"epuck0.linux and 2 more: 4 to 6 of 1478 to 1651 I2C transfers failed",
                "epuck0.i2c and 1 more: addressed 0x20 4 to 5 times"});
}

TEST_CASE("warnings that say something else stay lines of their own, in their order") {
    const Lines lines{"a.linux: 1 of 2 failed",
                      "b.i2c: 1 of 2 failed",
                      "c.linux: 1 of 2 lost",
                      "a scenario of 3 robots",
                      "a scenario of 4 robots",
                      "d.linux: at 0x20 once",
                      "e.linux: at 0x21 once",
                      "f.linux: 0.1 s",
                      "g.linux: 0.2 s",
                      "h.linux: two  spaces",
                      "i.linux: two 7 spaces",
                      "j.linux:",
                      "k.linux: 99999999999999999999 times"};
    CHECK(alike_as_one(lines) == lines);
    CHECK(alike_as_one({}).empty());
}

TEST_CASE("one line is as it was") {
    CHECK(alike_as_one({"a.linux: 007 of  9 "}) == Lines{"a.linux: 007 of  9 "});
}
