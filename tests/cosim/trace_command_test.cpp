// `puckloop trace` as a user calls it.

#include "toy_run.h"

#include "cosim/trace/trace_csv.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <fstream>

#include <sys/wait.h>
#include <unistd.h>

using namespace puckloop::cosim;

namespace {

struct Called {
    int status = -1;
    std::string out;  ///< standard output and error
};

Called call(const std::string& arguments) {
    const std::string command = fmt::format("{} trace {} 2>&1", PUCKLOOP_CLI, arguments);
    std::FILE* pipe = popen(command.c_str(), "r");
    REQUIRE(pipe);
    Called called;
    for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe))
        called.out += static_cast<char>(c);
    called.status = WEXITSTATUS(pclose(pipe));
    return called;
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
    const Called counts = call(path);
    CHECK(counts.status == 0);
    CHECK_THAT(counts.out, Catch::Contains("wire  left") && Catch::Contains("wire  right"));
    const Called json = call(path + " --json --from-node left --to 0.001");
    CHECK_THAT(json.out, Catch::Contains("\"messages\": 4,") && !Catch::Contains("right"));
    const Called rows = call(path + " --csv - --from 0.009 --link wire --kind uart");
    CHECK_THAT(rows.out, Catch::StartsWith(std::string(kTraceColumns)) && Catch::Contains("\n0.009") &&
                             !Catch::Contains("\n0.008"));
    CHECK(call(path + " --vcd - --kind i2c").out.find("$enddefinitions") != std::string::npos);
    CHECK(call(path + " --vcd /dev/full").status == 1);
    CHECK(call(path + " --kind smoke").status == 2);
    CHECK(call("/nonexistent.csv").status == 2);
    {
        std::ofstream damage(path, std::ios::app);
        damage << "rubbish\n";
    }
    const Called damaged = call(path);
    CHECK(damaged.status == 2);
    CHECK_THAT(damaged.out,
               Catch::StartsWith("puckloop: " + path + ": line ") && Catch::Contains("1 fields"));
    std::filesystem::remove(path);
}
