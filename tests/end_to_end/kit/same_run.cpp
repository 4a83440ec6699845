#include "tests/end_to_end/kit/same_run.h"

#include <catch2/catch.hpp>

namespace puckloop::tests {

void check_same_run(const Workbench& bench, const std::string& a, const std::string& b) {
    INFO(a << " and " << b);
    CHECK(bench.report(a)["trace_sha256"] == bench.report(b)["trace_sha256"]);
    for (const char* name : {"trace.csv", "trajectory.csv", "sensors.csv"}) {
        INFO(name);
        const std::string text = text_of(bench.out(a) / name);
        CHECK(!text.empty());
        // Not CHECK(x == y): megabytes would be printed.
        const bool same = text == text_of(bench.out(b) / name);
        CHECK(same);
    }
}

}  // namespace puckloop::tests
