// Boards whose flash and EEPROM last from run to run: [robot.pic] nvm, [robot.rab] nvm.

#include "tests/end_to_end/kit/one_line.h"
#include "tests/kit/dspic_pieces.h"

#include <catch2/catch.hpp>

#include <chrono>
#include <csignal>
#include <thread>

using namespace puckloop::tests;
using Catch::Contains;

namespace {

/// Counts its boots in EEPROM and sends the count as a digit on UART1.
const std::string kCounter = kMain + kUart1 + kCountBoots + R"(
        mov     #0x30, w0
        add     w5, w0, w5
        mov     w5, U1TXREG
)" + kWaitForCharacter + kWriteMemory;

std::string robot(const std::string& hex, const std::string& more) {
    return "[[robot]]\nposition = [\"" + std::string(more.empty() ? "0" : "30") +
           " cm\", \"0 m\"]\n[robot.pic]\nfirmware = \"" + hex + "\"\n" + more;
}

struct Lab {
    Workbench bench;
    std::string hex = (bench.folder() / "counter.hex").string();

    Lab() {
        const std::string source = bench.file("counter.s", kCounter).string();
        REQUIRE(bench.puckloop({"asm", source, "-o", hex}).status == 0);
        bench.file("nothing.txt", "100 00\n");
    }
    std::string scenario(const std::string& name, const std::string& robots) const {
        return bench.file(name, "[run]\nduration = \"100 ms\"\n[arena]\nsize = [\"2 m\", \"1 m\"]\n" + robots)
            .string();
    }
    std::string counting(const std::string& nvm) const {
        return scenario("s.toml", robot(hex, "uart1 = \"script:nothing.txt\"\nnvm = \"" + nvm + "\"\n"));
    }
    /// What the robot sent in a run.
    std::string sent(const Words& words) const {
        CHECK(bench.run("o", words).status == 0);
        return text_of(bench.out("o") / "robot0.uart1.received");
    }
};

}  // namespace

TEST_CASE("a robot counts its boots over runs, in every placement", "[nvm]") {
    const Lab lab;
    const std::string file = lab.counting("robot0.nvm");
    CHECK_THAT(lab.sent({file}), Catch::EndsWith("0"));
    CHECK_THAT(lab.sent({file, "--in-process"}), Catch::EndsWith("1"));
    CHECK_THAT(lab.sent({file}), Catch::EndsWith("2"));
    CHECK(std::filesystem::exists(lab.bench.folder() / "robot0.nvm"));
    CHECK_FALSE(std::filesystem::exists(lab.bench.folder() / "robot0.nvm.part"));
}

TEST_CASE("two boards in one file, a damaged one, a place that cannot be written: refused before the run",
          "[nvm]") {
    const Lab lab;
    const std::string key = "nvm = \"./robot0.nvm\"\n";
    const std::string two = lab.scenario(
        "two.toml", robot(lab.hex, "nvm = \"robot0.nvm\"\n") +
                        "[[robot]]\nposition = [\"-30 cm\", \"0 m\"]\n[robot.pic]\nfirmware = \"" + lab.hex +
                        "\"\n" + key);
    check_one_line(lab.bench.run("o", {two}), 2,
                   {"two.toml", "line 1", "keeps another board's memory already"});
    CHECK_FALSE(std::filesystem::exists(lab.bench.out("o")));

    const std::string nowhere = lab.scenario("nowhere.toml", robot(lab.hex, "nvm = \"no/such/x.nvm\"\n"));
    check_one_line(lab.bench.run("o", {nowhere}), 2, {"no/such/x.nvm", "cannot be written"});
    CHECK_FALSE(std::filesystem::exists(lab.bench.out("o")));

    const std::string file = lab.counting("robot0.nvm");
    lab.bench.file("robot0.nvm", "puckloop non-volatile memory 1\nrubbish\n");
    check_one_line(lab.bench.run("o", {file}), 2, {"robot0.nvm", "line 2", "is damaged"});
    CHECK(text_of(lab.bench.folder() / "robot0.nvm") == "puckloop non-volatile memory 1\nrubbish\n");
}

TEST_CASE("a run that is killed leaves the memory as it was", "[nvm]") {
    const Lab lab;
    const std::string file = lab.counting("robot0.nvm");
    lab.sent({file});
    const std::string before = text_of(lab.bench.folder() / "robot0.nvm");
    const auto process = lab.bench.start({"run", file, "--duration", "3600", "--out", lab.bench.out("k")});
    for (const double begun = wall_seconds(); wall_seconds() - begun < 60.0;) {
        if (text_of(lab.bench.out("k") / "trajectory.csv").find("\n1.000,") != std::string::npos) break;
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    // Meanwhile the file is taken.
    check_one_line(lab.bench.run("o", {file}), 2, {"robot0.nvm", "is in use by another board or run"});
    process->signal(SIGKILL);
    process->wait();
    CHECK(text_of(lab.bench.folder() / "robot0.nvm") == before);
    for (int tries = 0; tries < 200; ++tries) {  // until the kernel has ended the nodes
        if (lab.bench.run("o", {file}).status == 0) break;
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    CHECK_THAT(text_of(lab.bench.out("o") / "robot0.uart1.received"), Catch::EndsWith("1"));
}

TEST_CASE("SIGUSR1 presses the reset button of a board on the bench", "[nvm]") {
    const Lab lab;
    const auto logs = lab.bench.out("logs");
    const auto process = lab.bench.start({"exec", "--board", "pic", lab.hex, "--uart1", "-", "--realtime",
                                          "--seconds", "4", "--log", logs.string()});
    for (const double begun = wall_seconds(); wall_seconds() - begun < 60.0;) {
        if (text_of(logs / "uart1.csv").find(",tx,30") != std::string::npos) break;
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    process->signal(SIGUSR1);
    const Ended ended = process->wait();
    CHECK(ended.status == 0);
    CHECK(ended.out == "01");
    CHECK_THAT(ended.err, Contains("reset button pressed at "));
}
