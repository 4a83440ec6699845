// `run --gdb NODE=PLACE`: a board of a run stands still, and everybody with it; the trace stays.

#include "base/json.h"
#include "tests/debug/gdb_client.h"
#include "tests/exec/command.h"

#include <catch2/catch.hpp>

#include <cstdlib>

using namespace puckloop;
using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;
using exec::text_of;
using exec::Workbench;

namespace {

constexpr unsigned kPc = 16;

std::string robot(const std::string& name, int x_cm) {
    return "[[robot]]\nname = \"" + name + "\"\nposition = [\"" + std::to_string(x_cm) +
           " cm\", \"0 cm\"]\n[robot.pic]\nfirmware = \"" + PUCKLOOP_SOURCE + "/firmware/epuck/epuck.hex\"\n";
}

std::string hash_of(const std::string& folder) {
    return nlohmann::json::parse(text_of(folder + "/report.json")).at("trace_sha256");
}

}  // namespace

TEST_CASE("a board of a run under a debugger, and the trace of the run without one") {
    const Workbench bench;
    const std::string scenario = bench.file("two.toml", std::string("[arena]\nsize = [\"1 m\", \"1 m\"]\n") +
                                                            robot("robot0", 20) + robot("robot1", -20));
    const std::string what = "run " + scenario + " --duration 0.3 --no-cache ";
    const std::string plain = std::string(PUCKLOOP_PROGRAM) + " " + what + "--in-process --out " +
                              bench.folder + "/plain >/dev/null 2>&1";
    REQUIRE(std::system(plain.c_str()) == 0);
    for (const char* placement : {"", "--in-process "}) {
        tests::GdbServer server(
            bench.folder, what + placement + "--out " + bench.folder + "/debugged --gdb robot0.pic=unix:{}",
            tests::GdbServer::Whole{});
        tests::GdbClient gdb(server.socket());
        CHECK(gdb.register_value(kPc) == 0);
        CHECK_THAT(gdb.ask("s"), StartsWith("T05"));
        CHECK(gdb.ask("Z2,800800,400") == "OK");  // the first write to RAM
        CHECK_THAT(gdb.ask("c"), StartsWith("T05watch:800"));
        CHECK(gdb.ask("z2,800800,400") == "OK");
        CHECK_THAT(gdb.monitor("time"), Contains("0.0"));
        gdb.send("c");
        gdb.send_raw("\x03");
        CHECK_THAT(*gdb.receive(), StartsWith("T02"));
        CHECK(gdb.ask("D") == "OK");
        INFO(server.err());
        CHECK(server.wait() == 0);
        CHECK(hash_of(bench.folder + "/debugged") == hash_of(bench.folder + "/plain"));
    }
    const std::string wrong =
        std::string(PUCKLOOP_PROGRAM) + " " + what + "--gdb world=:0 2>" + bench.folder + "/wrong >/dev/null";
    CHECK(std::system(wrong.c_str()) / 256 == 2);
    CHECK_THAT(text_of(bench.folder + "/wrong"),
               Contains("'world=:0' names no board") && Contains("robot0.pic"));
}

TEST_CASE("a run that its debugger kills names the instant at which the board stood, in every placement") {
    const Workbench bench;
    const std::string scenario =
        bench.file("one.toml", std::string("[arena]\nsize = [\"1 m\", \"1 m\"]\n") + robot("robot0", 20));
    for (const char* placement : {"", "--in-process "}) {
        tests::GdbServer server(bench.folder,
                                "run " + scenario + " --duration 30 --no-cache " + placement + "--out " +
                                    bench.folder + "/killed --gdb robot0.pic=unix:{}",
                                tests::GdbServer::Whole{});
        tests::GdbClient gdb(server.socket());
        CHECK(gdb.ask("Z2,800800,400") == "OK");
        CHECK_THAT(gdb.ask("c"), StartsWith("T05watch:800"));
        std::string instant = gdb.monitor("time");
        REQUIRE(instant.ends_with(" s\n"));
        instant.pop_back();
        CHECK(gdb.ask("vKill;1") == "OK");
        CHECK(server.wait() == 1);
        CHECK_THAT(server.err(),
                   Contains("node robot0.pic stopped at " + instant + ": killed by its debugger\n"));
        const auto report = nlohmann::json::parse(text_of(bench.folder + "/killed/report.json"));
        CHECK(report.at("simulated_s") == Approx(std::stod(instant) + 0.01));  // the stop latency
    }
}
