// The end of a run as its programs see it: a signal, time to react, then SIGKILL.

#include "tests/end_to_end/kit/one_line.h"
#include "tests/end_to_end/kit/same_run.h"

#include <catch2/catch.hpp>

#include <fmt/format.h>

#include <chrono>
#include <csignal>
#include <thread>

using namespace puckloop::tests;
using Catch::Contains;

namespace {

std::string log_of(const Workbench& bench, const std::string& run, const std::string& robot = "robot0") {
    return text_of(bench.out(run) / (robot + ".linux.log"));
}

/// Starts a long run of the program `how` and interrupts it once it has begun.
std::unique_ptr<Process> interrupted_run(const Workbench& bench, const std::string& how,
                                         const std::string& saved, const Words& more = {}) {
    Words words{"run", bench.hello("grace = \"3000 s\"\n"), "--duration", "36000", "--out", bench.out("o")};
    words.insert(words.end(), more.begin(), more.end());
    words.insert(words.end(), {"--linux", PUCKLOOP_POLITE, how, saved});
    auto process = bench.start(words);
    const double begun = wall_seconds();
    while (text_of(bench.out("o") / "trajectory.csv").find("\n2.000,") == std::string::npos &&
           wall_seconds() - begun < 60.0)
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    process->signal(SIGINT);
    return process;
}

}  // namespace

TEST_CASE("at --duration programs get SIGTERM, send R and save, the same in both placements") {
    const Workbench bench;
    const std::string saved = bench.folder() / "saved.xml";
    for (const char* placement : {"--in-process", "--json"}) {
        std::filesystem::remove(saved);
        const Ended ended = bench.run(placement, {bench.hello(), "--duration", "2", placement, "--linux",
                                                  PUCKLOOP_POLITE, "handler", saved});
        CHECK(ended.status == 0);
        CHECK(text_of(saved) == "calibration\n");
        CHECK_THAT(log_of(bench, placement), Contains("asked by 15 at 2000 ms"));
        const auto report = bench.report(placement);
        CHECK(report["ended_by"] == "duration");
        CHECK(report["programs_asked_to_end_s"] == 2.0);
        CHECK(report["simulated_s"].get<double>() == Approx(2.01).margin(0.005));
        const std::vector<int> sent =
            bytes_sent(bench.csv(placement, "trace.csv"), "robot0.uart", "robot0.linux");
        REQUIRE(!sent.empty());
        CHECK(sent.back() == 'R');
    }
    check_same_run(bench, "--in-process", "--json");
}

TEST_CASE("a program that does not listen is killed after the scenario's grace period") {
    const Workbench bench;
    const Ended ended = bench.run("o", {bench.hello("grace = \"300 ms\"\nend_signal = \"INT\"\n"),
                                        "--duration", "2", "--linux", PUCKLOOP_POLITE, "deaf"});
    CHECK(ended.status == 0);
    CHECK_THAT(ended.out, Contains("had not ended 0.3 s after SIGINT"));
    CHECK(bench.report("o")["simulated_s"].get<double>() == Approx(2.31).margin(0.001));
}

TEST_CASE("Ctrl-C lets a program save its result") {
    const Workbench bench;
    const Words placement = GENERATE(Words{}, Words{"--in-process"});
    const std::string saved = bench.folder() / "saved.xml";
    const Ended ended = interrupted_run(bench, "handler", saved, placement)->wait(30.0);
    check_one_line(ended, 130, {"interrupted (SIGINT) at"}, 60);
    CHECK(text_of(saved) == "calibration\n");
    CHECK_THAT(log_of(bench, "o"), Contains("asked by 2 at"));
    CHECK(bench.report("o")["programs_asked_to_end_s"].get<double>() >= 1.9);
}

TEST_CASE("a second Ctrl-C ends the run at once, with its report") {
    const Workbench bench;
    const auto process = interrupted_run(bench, "deaf", "none");
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    process->signal(SIGINT);
    const Ended ended = process->wait(20.0);
    CHECK(!ended.timed_out);
    check_one_line(ended, 130, {"interrupted (SIGINT) at"}, 60);
    CHECK(bench.report("o")["ended_by"] == "interrupted");
}

TEST_CASE("a scenario sends signals at simulated times") {
    const Workbench bench;
    const Ended ended = bench.run("o", {bench.hello("signals = [{ at = \"1500 ms\", send = \"INT\" }]\n"),
                                        "--linux", PUCKLOOP_POLITE, "handler"});
    CHECK(ended.status == 0);
    CHECK_THAT(log_of(bench, "o"), Contains("asked by 2 at 1500 ms"));
    CHECK(bench.report("o")["programs_asked_to_end_s"].is_null());
}

TEST_CASE("programs save their files in a folder of their own where the scenario asks for one") {
    const Workbench bench;
    const Ended ended = bench.run("o", {bench.hello("folder = \"robot0/files\"\n"), "--duration", "2",
                                        "--linux", PUCKLOOP_POLITE, "handler", "saved.xml"});
    CHECK(ended.status == 0);
    CHECK(text_of(bench.out("o") / "robot0" / "files" / "saved.xml") == "calibration\n");
    check_one_line(bench.run("p", {bench.hello("folder = \"../files\"\n")}), 2,
                   {"folder", "below the results"});
}

TEST_CASE("signals that cannot be are refused") {
    const Workbench bench;
    const auto refused = [&](const std::string& keys, const Words& words) {
        check_one_line(bench.run("o", {bench.hello(keys)}), 2, words);
        CHECK(!std::filesystem::exists(bench.out("o")));
    };
    refused("signals = [{ at = \"1 s\", send = \"STOPP\" }]\n", {"hello.toml", "STOPP", "INT"});
    refused("signals = [{ at = \"2 s\", send = \"INT\" }, { at = \"1 s\", send = \"INT\" }]\n",
            {"do not rise"});
    refused("signals = [{ at = \"2 s\", say = \"INT\" }]\n", {"send"});
    refused("signals = [{ at = \"2 s\" }]\n", {"send"});
    refused("signals = [{ at = \"2 s\", send = \"STOP\" }]\n", {"'STOP' stops a program"});
    refused("end_signal = \"SIGTSTP\"\n", {"'TSTP' stops a program"});
    refused("end_signal = \"KILLER\"\n", {"KILLER"});
    refused("grace = \"-1 s\"\n", {"grace", "0 s to 1 h"});
}

TEST_CASE("a hundred robots run a hundred programs in one process") {
    constexpr int kRobots = 100;
    const Workbench bench;
    std::string text = "[arena]\nsize = [\"4 m\", \"4 m\"]\n";
    for (int i = 0; i < kRobots; ++i)
        text += fmt::format("[[robot]]\nposition = [\"{} cm\", \"{} cm\"]\n[robot.pic]\nfirmware = "
                            "\"{}/firmware/epuck/epuck.hex\"\n"
                            "[robot.linux]\nprogram = [\"{}\", \"handler\"]\n",
                            -170 + 35 * (i % 10), -170 + 35 * (i / 10), PUCKLOOP_SOURCE, PUCKLOOP_POLITE);
    const Ended ended =
        bench.run("o", {bench.file("hundred.toml", text), "--duration", "0.02", "--in-process"});
    CHECK(ended.err.empty());
    CHECK(ended.status == 0);
    const auto report = bench.report("o");
    for (int i = 0; i < kRobots; ++i)
        CHECK(report["nodes"][fmt::format("robot{}.linux", i)]["end"] ==
              "exited with status 0 after SIGTERM at the end of the run");
}
