// Every outcome that there is, each from a real run.

#include "tests/campaign/small_campaign.h"

#include <catch2/catch.hpp>

#include <sstream>

using namespace puckloop::tests;

TEST_CASE("runs reach every outcome") {
    const Workbench bench;
    bench.hello();
    const auto file = bench.file("classes.toml", R"([campaign]
scenario = "hello.toml"
duration = "2.6 s"

[limits]
silence = "400 ms"

[[metric]]
name = "path"
robot = "robot0"
tolerance = "30 %"

[[sweep]]
name = "masked"
fault = { link = "robot0.uart", from = "robot0.linux", kind = "delay", delay = "100 us", position = 11, begin = "1.5 s", count = 1 }

[[sweep]]
name = "detected"
fault = { link = "robot0.uart", from = "robot0.pic", kind = "drop", begin = "1.5 s", count = 1 }

[[sweep]]
name = "recovered"
fault = { link = "robot0.uart", kind = "disconnect", begin = "1.5 s", for = "100 ms" }

[[sweep]]
name = "degraded"
fault = { node = "robot0.pic", kind = "wheel_stall", motor = "left", begin = "1.4 s" }

[[sweep]]
name = "silent corruption"
fault = { node = "robot0.pic", kind = "wheel_stall", motor = "left", begin = "1.4 s", for = "150 ms" }

[[sweep]]
name = "hang"
fault = { node = "robot0.pic", kind = "hang", at = "1.5 s" }

[[sweep]]
name = "reset loop"
fault = { node = "robot0.pic", kind = "reset", at = "1.5 s", period = "200 ms" }

[[sweep]]
name = "crash"
fault = { node = "robot0.linux", kind = "kill", at = "1.8 s" }

[[sweep]]
name = "not fired"
fault = { link = "robot0.uart", kind = "drop", match = "00 01 02 03 04 05 06 07" }
)");
    const std::string table = reference_table(bench, file);
    INFO(table);
    std::istringstream rows(table);
    std::string row;
    std::getline(rows, row);
    int singles = 0;
    while (std::getline(rows, row)) {
        std::istringstream cells(row);
        std::string id, phase, sweep, place, faults, seed, outcome;
        for (std::string* cell : {&id, &phase, &sweep, &place, &faults, &seed, &outcome})
            std::getline(cells, *cell, ',');
        if (phase != "single") continue;
        ++singles;
        CHECK(outcome == sweep);
    }
    CHECK(singles == 9);
}
