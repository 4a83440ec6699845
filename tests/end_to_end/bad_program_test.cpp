// Linux programs that cannot run, end early, crash or hang.

#include "tests/end_to_end/kit/one_line.h"

#include <catch2/catch.hpp>

#include <sys/stat.h>

using namespace puckloop::tests;
using Catch::Contains;

namespace {

Ended with_program(const Workbench& bench, const Words& options, const Words& program) {
    Words words{bench.hello()};
    words.insert(words.end(), options.begin(), options.end());
    words.push_back("--linux");
    words.insert(words.end(), program.begin(), program.end());
    return bench.run("o", words);
}

/// What was recorded until the failure is there, and the report states how it ended.
void check_kept(const Workbench& bench, double simulated_s) {
    const auto report = bench.report("o");
    CHECK(report["success"] == false);
    CHECK(report["ended_why"].get<std::string>().size() > 10);
    CHECK(report["simulated_s"].get<double>() == Approx(simulated_s).margin(0.05));
    CHECK(bench.csv("o", "trajectory.csv").size() >= static_cast<std::size_t>(simulated_s / 0.1));
    CHECK(bench.csv("o", "trace.csv").size() > 100);
    CHECK_THAT(text_of(bench.out("o") / "trajectory.svg"), Contains("</svg>"));
}

}  // namespace

TEST_CASE("a program that cannot run is refused before the run") {
    const Workbench bench;
    const std::string plain = bench.file("plain", "no program\n");
    const auto refused = [&](const std::string& program, const Words& words) {
        check_one_line(with_program(bench, {}, {program}), 2, words);
        CHECK(!std::filesystem::exists(bench.out("o")));
    };
    refused(bench.folder() / "nowhere", {"robot0.linux: ", "nowhere", "No such file"});
    refused("no-such-program-anywhere", {"no-such-program-anywhere"});
    refused(plain, {"plain", "not executable", "chmod +x"});
    refused(bench.folder(), {"is not a file"});
    refused(PUCKLOOP_STATIC_PROGRAM, {"statically linked"});
    chmod(plain.c_str(), 0755);
    refused(plain, {"neither a program nor a script"});
}

TEST_CASE("a program's last words are shown as text") {
    const Workbench bench;
    const Ended ended = with_program(bench, {}, {PUCKLOOP_MISBEHAVE, "colours"});
    check_one_line(ended, 1, {"status 3", "motor 3 is hot"});
    CHECK_THAT(ended.err, !Contains("\x1b") && !Contains("[0m"));
}

TEST_CASE("a program that prints without end has a bounded log and a run of its usual length") {
    const Workbench bench;
    std::string logs[2];
    for (const bool in_process : {false, true}) {
        Words options{"--duration", "1.06"};
        if (in_process) options.push_back("--in-process");
        check_one_line(with_program(bench, options, {"/bin/yes"}), 1,
                       {"robot0.linux", "never opened", "1.060 s"});
        logs[in_process] = text_of(bench.out("o") / "robot0.linux.log");
        constexpr std::size_t kMost = 64 << 20;
        REQUIRE(logs[in_process].size() > kMost);
        CHECK(logs[in_process].find_first_not_of("y\n") == kMost);
        CHECK_THAT(logs[in_process].substr(kMost),
                   Catch::Matches("puckloop: the other [1-9][0-9]* bytes of the output are left out\n"));
    }
    CHECK(logs[0] == logs[1]);
}

TEST_CASE("a program that crashes is named with its signal, time and last words") {
    const Workbench bench;
    for (const Words& placement : {Words{}, Words{"--in-process"}}) {
        check_one_line(with_program(bench, placement, {PUCKLOOP_MISBEHAVE, "crash"}), 1,
                       {"robot0.linux", "SIGSEGV", "at 1.5", "now I crash"});
        check_kept(bench, 1.51);
        CHECK(text_of(bench.out("o") / "robot0.linux.log") == "now I crash\n");
    }
}

TEST_CASE("a program that exits without touching its port fails the run, whatever its status") {
    const Workbench bench;
    for (const char* status : {"0", "3"}) {
        check_one_line(
            with_program(bench, {}, {PUCKLOOP_MISBEHAVE, "exit", status}), 1,
            {"robot0.linux", std::string("exited with status ") + status, "without ever opening /dev/ttyS0"});
        check_kept(bench, 1.01);
    }
}

TEST_CASE("a program ends the run when its work is done, which failed where nobody answered it") {
    const Workbench bench;
    const Ended ended = with_program(bench, {}, {PUCKLOOP_MISBEHAVE, "done"});
    check_one_line(ended, 1, {"robot0.linux", "sent 5 bytes and never received one"}, 60);
    CHECK(bench.report("o")["simulated_s"].get<double>() == Approx(1.51).margin(0.01));
}

TEST_CASE("a low limit of open files is enough, or named") {
    const Workbench bench;
    const auto limited = [&](const std::string& limit, const Words& placement) {
        Words words{"/bin/sh",        "-c",  "ulimit -n " + limit + "; exec \"$0\" \"$@\"",
                    PUCKLOOP_PROGRAM, "run", bench.hello(),
                    "--duration",     "2",   "--out",
                    bench.out("o")};
        words.insert(words.end(), placement.begin(), placement.end());
        return Process(words, bench.folder()).wait();
    };
    for (const Words& placement : {Words{"--in-process"}, Words{}}) {
        CHECK(limited("100", placement).status == 0);
        check_one_line(limited("30", placement), 1, {"limit of open files is 30", "needs 32"});
    }
}

TEST_CASE("a low limit of the stack is enough") {
    const Workbench bench;
    for (const Words& more :
         {Words{"--in-process"}, Words{}, Words{"--linux", PUCKLOOP_MISBEHAVE, "sleep"}}) {
        Words words{"/bin/sh",        "-c",  "ulimit -s 64; exec \"$0\" \"$@\"",
                    PUCKLOOP_PROGRAM, "run", bench.hello(),
                    "--duration",     "2",   "--out",
                    bench.out("o")};
        words.insert(words.end(), more.begin(), more.end());
        const Ended ended = Process(words, bench.folder()).wait();
        INFO(ended.err);
        CHECK(ended.status == (more.size() > 1 ? 1 : 0));  // it never opens its port
        CHECK(bench.report("o")["simulated_s"].get<double>() == Approx(2.0).margin(0.05));
    }
    const Ended help =
        Process({"/bin/sh", "-c", "ulimit -s 64; exec \"$0\" gap --help", PUCKLOOP_PROGRAM}, bench.folder())
            .wait();
    CHECK(help.status == 0);
}

TEST_CASE("a limit of open files that many robots exceed is named") {
    constexpr int kRobots = 30;
    const Workbench bench;
    std::string text = "[arena]\nsize = [\"4 m\", \"4 m\"]\n";
    for (int i = 0; i < kRobots; ++i)
        text += "[[robot]]\nposition = [\"" + std::to_string(-170 + 35 * (i % 10)) + " cm\", \"" +
                std::to_string(-170 + 35 * (i / 10)) +
                " cm\"]\n[robot.pic]\nfirmware = \"" PUCKLOOP_SOURCE
                "/firmware/epuck/epuck.hex\"\n[robot.linux]\nprogram = [\"" PUCKLOOP_MISBEHAVE
                "\", \"sleep\"]\nstart = \"50 ms\"\n";
    const std::string many = bench.file("many.toml", text);
    for (const int limit : {60, 61, 62, 63, 64, 65}) {  // each runs out at another place
        const Ended ended =
            Process({"/bin/sh", "-c", "ulimit -n " + std::to_string(limit) + "; exec \"$0\" \"$@\"",
                     PUCKLOOP_PROGRAM, "run", "--in-process", many, "--duration", "0.1", "--out",
                     bench.out("o")},
                    bench.folder())
                .wait();
        CAPTURE(limit);
        CHECK((ended.status == 1 || ended.status == 2));
        CHECK(ended.error_lines() == 1);
        CHECK_THAT(ended.err, Contains("Too many open files"));
    }
}

TEST_CASE("a program that never opens its port fails the run at its end") {
    const Workbench bench;
    check_one_line(with_program(bench, {"--duration", "3"}, {PUCKLOOP_MISBEHAVE, "sleep"}), 1,
                   {"robot0.linux", "never opened", "3.000 s"});
    check_kept(bench, 3.0);
}

TEST_CASE("a program whose time has not come is no failure") {
    const Workbench bench;
    const Ended ended = with_program(bench, {"--duration", "0.5"}, {PUCKLOOP_MISBEHAVE, "sleep"});
    CHECK(ended.status == 0);
    CHECK_THAT(bench.report("o")["nodes"]["robot0.linux"]["end"].get<std::string>(), Contains("not started"));
}

TEST_CASE("a program that computes for ever is found in both placements") {
    const Workbench bench;
    for (const char* placement : {"--in-process", "--json"}) {
        const Ended ended = with_program(bench, {placement, "--stall=3"}, {PUCKLOOP_MISBEHAVE, "spin"});
        // On a loaded machine the conductor may lose patience before the program's own watchdog.
        check_one_line(ended, 1, {"robot0.linux", " s of wall ", "--stall)"}, 60);
        check_kept(bench, 1.0);
    }
}

TEST_CASE("a program that waits for what never comes is named, once for robots that are alike") {
    const Workbench bench;
    const std::string waits = bench.file("waits.sh", "#!/bin/sh\nexec 3<>/dev/ttyS0\nread x <&3\n");
    chmod(waits.c_str(), 0755);
    const auto scenario = bench.file("two.toml", R"([run]
allow = ["program"]
[arena]
size = ["2 m", "2 m"]
[[robot]]
name = "a"
position = ["-50 cm", "0 m"]
[robot.pic]
firmware = "own"
[robot.linux]
program = ["./waits.sh"]
[[robot]]
name = "b"
position = ["50 cm", "0 m"]
[robot.pic]
firmware = "own"
[robot.linux]
program = ["./waits.sh"]
)");
    const Ended good = bench.run("o", {scenario, "--in-process", "--duration", "7"});
    INFO(good.out << good.err);
    const auto warnings = bench.report("o")["warnings"];
    REQUIRE(warnings.size() == 2);
    CHECK_THAT(warnings[0].get<std::string>(),
               Contains("a.linux: ") && Contains("has waited for bytes at its serial port since "));
    // One line on the terminal.
    CHECK_THAT(good.out, Contains("warning: a.linux and 1 more: ") && !Contains("warning: b.linux"));
    // A second is no time.
    REQUIRE(bench.run("o", {scenario, "--in-process", "--duration", "2"}).status == good.status);
    CHECK(bench.report("o")["warnings"].empty());
}

TEST_CASE("a port that is not set to the rate of the line is named as that") {
    const Workbench bench;
    const std::string speaks = bench.file(
        "speaks.sh", "#!/bin/sh\nexec 3<>/dev/ttyS0\nprintf '\\001\\002\\003\\004\\005' >&3\nread x <&3\n");
    chmod(speaks.c_str(), 0755);
    const Ended ended = with_program(bench, {"--duration", "4"}, {speaks});
    check_one_line(ended, 1, {"robot0.linux", "sent 5 bytes", "not set to the rate of the line", "115200"});
}
