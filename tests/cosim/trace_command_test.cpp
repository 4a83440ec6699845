// `puckloop trace` as a user calls it.

#include "toy_run.h"

#include "cosim/trace/trace_csv.h"
#include "tests/kit/shell.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <filesystem>
#include <fstream>

#include <unistd.h>

using namespace puckloop;
using namespace puckloop::cosim;

namespace {

tests::Ran call(const std::string& arguments) {
    return tests::run_in_shell(fmt::format("{} trace {}", PUCKLOOP_CLI, arguments));
}

}  // namespace

TEST_CASE("puckloop trace counts, filters and converts what a run recorded") {
    const std::string path =
        (std::filesystem::temp_directory_path() / fmt::format("command.{}.csv", getpid())).string();
    toy::Run run{{{"left", "echo first=1"}, {"right", "echo delay_us=100"}},
                 {toy::uart("wire", {"left", "uart0"}, {"right", "uart0"})}};
    run.options.duration = 10 * kMillisecond;
    run.options.in_process = true;
    {
        TraceCsvSink csv(path);
        Conductor conductor(run.nodes, run.links, {}, run.options, toy::make);
        conductor.add_sink(csv);
        REQUIRE(conductor.run().reason == EndReason::Duration);
    }
    const tests::Ran counts = call(path);
    CHECK(counts.status == 0);
    CHECK_THAT(counts.output, Catch::Contains("wire  left") && Catch::Contains("wire  right"));
    const tests::Ran json = call(path + " --json --from-node left --to 0.001");
    CHECK_THAT(json.output, Catch::Contains("\"messages\": 4,") && !Catch::Contains("right"));
    const tests::Ran rows = call(path + " --csv - --from 0.009 --link wire --kind uart");
    CHECK_THAT(rows.output, Catch::StartsWith(std::string(kTraceColumns)) && Catch::Contains("\n0.009") &&
                                !Catch::Contains("\n0.008"));
    CHECK(call(path + " --vcd - --kind i2c").output.find("$enddefinitions") != std::string::npos);
    CHECK(call(path + " --vcd /dev/full").status == 1);
    CHECK(call(path + " --kind smoke").status == 2);
    CHECK(call("/nonexistent.csv").status == 2);
    {
        std::ofstream damage(path, std::ios::app);
        damage << "rubbish\n";
    }
    const tests::Ran damaged = call(path);
    CHECK(damaged.status == 2);
    CHECK_THAT(damaged.output,
               Catch::StartsWith("puckloop: " + path + ": line ") && Catch::Contains("1 fields"));
    std::filesystem::remove(path);
}
