// The other commands as a user meets them first: each does its work, and reports wrong use in one line.

#include "tests/end_to_end/kit/one_line.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <sstream>

using namespace puckloop::tests;
using Catch::Contains;

namespace {
const std::string kImage = PUCKLOOP_SOURCE "/firmware/epuck/epuck.hex";
const std::string kHello = PUCKLOOP_SOURCE "/scenarios/hello.toml";
}  // namespace

TEST_CASE("every command has a help of its own") {
    const Workbench bench;
    for (const char* command : {"run", "exec", "step", "asm", "disasm", "trace", "bench"}) {
        const Ended ended = bench.puckloop({command, "--help"});
        INFO(command);
        CHECK(ended.status == 0);
        CHECK_THAT(ended.out, Contains("--help"));
        CHECK(ended.err.empty());
    }
    CHECK_THAT(bench.puckloop({"--help"}).out, Contains("run"));
}

TEST_CASE("check takes the shipped experiment files of ARGoS") {
    const Workbench bench;
    for (const char* name : {"aggregation", "foraging", "grid_exploration"}) {
        const Ended ended =
            bench.puckloop({"check", PUCKLOOP_SOURCE "/scenarios/" + std::string(name) + ".argos"});
        INFO(name << ": " << ended.err);
        CHECK(ended.status == 0);
        CHECK_THAT(ended.out, Contains("20 robots"));
    }
}

TEST_CASE("standard output that takes nothing is one line and a status") {
    const Workbench bench;
    for (const Words& words : {Words{"--help"},
                               {"--version"},
                               {"run", "--help"},
                               {"run", "--list-parameters"},
                               {"frames", "rab", "encode", "--payload", "1234"}}) {
        Words all{"/bin/sh", "-c", "exec \"$0\" \"$@\" > /dev/full", PUCKLOOP_PROGRAM};
        all.insert(all.end(), words.begin(), words.end());
        INFO(words.back());
        check_one_line(Process(all, bench.folder()).wait(), 1, {"standard output: cannot "});
    }
}

TEST_CASE("the list of parameters has the values in force with a scenario and an overlay") {
    const Workbench bench;
    const auto rows = [&](Words words, const std::string& parameter) {
        words.insert(words.begin(), {"run", "--list-parameters"});
        const Ended ended = bench.puckloop(words);
        INFO(ended.err);
        CHECK(ended.status == 0);
        std::string found;
        std::istringstream lines(ended.out);
        for (std::string line, name; std::getline(lines, line);) {
            std::istringstream(line) >> name;
            if (name != parameter) continue;
            line.erase(
                std::unique(line.begin(), line.end(), [](char a, char b) { return a == ' ' && b == ' '; }),
                line.end());
            found += line + "|";
        }
        return found;
    };
    const std::string scenario = bench.hello(
        "[[robot]]\nname = \"two\"\nposition = [\"30 cm\", \"30 cm\"]\n[robot.pic]\nfirmware = \"" + kImage +
        "\"\n[parameters]\nrobot.axle_length = \"54 mm\"\n");
    const std::string overlay = bench.file(
        "overlay.toml", "[parameters]\nproximity.gain3 = 1.5\nworld.gravity = 9.7\n[[robot]]\nname = "
                        "\"two\"\nparameters = { \"robot.axle_length\" = \"52 mm\" }\n");
    CHECK_THAT(rows({}, "robot.axle_length"), Catch::StartsWith("robot.axle_length m 0.053 0.0"));
    CHECK_THAT(rows({scenario}, "robot.axle_length"),
               Catch::StartsWith("robot.axle_length m 0.053 0.054 0.0"));
    CHECK_THAT(rows({scenario, "--model", overlay}, "robot.axle_length"),
               Catch::StartsWith("robot.axle_length m 0.053 0.054 0.0") &&
                   Catch::EndsWith("|robot.axle_length m 0.052 of two|"));
    CHECK_THAT(rows({scenario, "--model", overlay}, "proximity.gain0..7"),
               Catch::StartsWith("proximity.gain0..7 1 1 1 1 1 1.5 1 1 1 1 0"));
    CHECK_THAT(rows({scenario, "--model", overlay}, "world.gravity"), Contains(" 9.81 9.7 "));
    check_one_line(bench.puckloop({"run", "--list-parameters", "--model", overlay}), 2,
                   {"--model", "no scenario"});
    check_one_line(bench.puckloop({"run", "--list-parameters", "nowhere.toml"}), 2, {"nowhere.toml"});
}

TEST_CASE("exec runs an image on the bench and reports it") {
    const Workbench bench;
    const Ended ended = bench.puckloop({"exec", "--board", "pic", kImage, "--seconds", "0.5", "--json"});
    REQUIRE(ended.status == 0);
    const auto report = nlohmann::json::parse(ended.out);
    CHECK(report["stopped"] == "budget");
    CHECK(report["simulated_s"].get<double>() == Approx(0.5).margin(0.001));
    check_one_line(bench.puckloop({"exec", "--board", "pic", "nowhere.hex", "--seconds", "1"}), 2,
                   {"nowhere.hex"});
    check_one_line(bench.puckloop({"exec", "--mcu", "dspic30f9999", kImage, "--seconds", "1"}), 2,
                   {"dspic30f9999"});
}

TEST_CASE("what asm makes, disasm reads") {
    const Workbench bench;
    const std::string source =
        bench.file("x.s", "start: mov #0x1234, w0\n       add w0, w1, w2\n       bra start\n");
    const std::string image = bench.folder() / "x.hex";
    REQUIRE(bench.puckloop({"asm", source, "-o", image}).status == 0);
    const Ended listing = bench.puckloop({"disasm", image});
    CHECK(listing.status == 0);
    CHECK_THAT(listing.out, Contains("mov") && Contains("#0x1234") && Contains("add"));
    check_one_line(bench.puckloop({"asm", bench.file("y.s", "mvo w0, w1\n")}), 2, {"line 1", "mvo"});
    check_one_line(bench.puckloop({"disasm", "nowhere.hex"}), 2, {"nowhere.hex"});
}

TEST_CASE("step answers a damaged vector with an error line and goes on") {
    const Workbench bench;
    const Ended ended = bench.puckloop({"step", "--mcu", "dspic30f6014a"}, "a no vector\nb neither\n");
    CHECK(ended.status == 0);
    CHECK_THAT(ended.out, Catch::StartsWith("a error ") && Contains("\nb error "));
    check_one_line(bench.puckloop({"step", "--mcu", "dspic30f9999"}), 2, {"dspic30f9999", "dspic30f6014a"});
}

TEST_CASE("trace reads what a run recorded") {
    const Workbench bench;
    REQUIRE(bench.run("o", {kHello, "--duration", "2", "--in-process"}).status == 0);
    const std::string file = bench.out("o") / "trace.csv";
    const Ended uart = bench.puckloop({"trace", file, "--link", "robot0.uart"});
    CHECK(uart.status == 0);
    CHECK_THAT(uart.out, Contains("robot0.uart") && !Contains("robot0.world"));
    check_one_line(bench.puckloop({"trace", "nowhere.csv"}), 2, {"nowhere.csv"});
    check_one_line(bench.puckloop({"trace", bench.file("x.csv", "a,b\n1,2\n")}), 2, {"x.csv", "line 1"});
}
