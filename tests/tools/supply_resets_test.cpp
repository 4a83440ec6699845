// The lines of a run's summary about boards that their supply reset.

#include "run/report/supply_resets.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <algorithm>

using namespace puckloop;

namespace {

cosim::Outcome::NodeReport node(const std::string& name, const std::string& resets) {
    cosim::Outcome::NodeReport report;
    report.name = name;
    report.json = resets.empty() ? "{}" : "{\"resets\": [" + resets + "]}";
    return report;
}

std::string reset(double seconds, const std::string& cause, const std::string& more = {}) {
    return fmt::format(R"({{"time_s": {}, "cause": "{}", "pc": "0x01f2"{}}})", seconds, cause, more);
}

}  // namespace

TEST_CASE("boards that their supply reset are named by cause, instant and place") {
    cosim::Outcome outcome;
    outcome.nodes = {node("world", ""),
                     node("robot0.pic", reset(0, "POR") + "," + reset(1, "EXTR") + "," + reset(1.5, "WDTO")),
                     node("robot1.pic", reset(0, "POR") + "," + reset(2, "BOR", R"(, "symbol": "move+0x6")") +
                                            "," + reset(2.5, "POR") + "," + reset(3, "BOR")),
                     node("tam0.avr", reset(0.3, "power-on") + "," + reset(4, "brown-out") + "," +
                                          reset(5, "watchdog") + "," + reset(6, "power-on"))};
    outcome.nodes.emplace_back().name = "lost.pic";  // it left no report
    CHECK(tools::supply_resets_summary(outcome) ==
          "\nreset: robot1.pic, brown-out (BOR) 2 times, first at pc 0x01f2 in move+0x6 (2.000000 s)"
          "\nreset: robot1.pic, power-on (POR) once, first at pc 0x01f2 (2.500000 s)"
          "\nreset: tam0.avr, brown-out (BORF) once, first at pc 0x01f2 (4.000000 s)"
          "\nreset: tam0.avr, power-on (PORF) once, first at pc 0x01f2 (6.000000 s)");
}

TEST_CASE("a room of boards without supply leaves ten lines and their number") {
    cosim::Outcome outcome;
    for (int i = 0; i < 14; ++i)
        outcome.nodes.push_back(node(fmt::format("robot{}.pic", i), reset(0, "POR") + "," + reset(1, "BOR")));
    const std::string text = tools::supply_resets_summary(outcome);
    CHECK(std::count(text.begin(), text.end(), '\n') == 11);
    CHECK(text.ends_with("\nreset: and 4 more in report.json"));
}
