// CAN buses in runs: robots whose main boards exchange frames, a board of another family among them, faults,
// exports, and the same bytes in every placement.

#include "tests/end_to_end/kit/one_line.h"
#include "tests/end_to_end/kit/same_run.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

using namespace puckloop::tests;

namespace {

const std::string kFirmware = PUCKLOOP_SOURCE "/firmware/can/can.hex";
constexpr double kBit = 120.0 / 14'745'600.0;  // s, of can.s

std::string robot(int number, const std::string& more = {}) {
    return fmt::format(
        "[[robot]]\nname = \"robot{}\"\nposition = [\"{} cm\", \"0 cm\"]\n[robot.pic]\nfirmware = "
        "\"{}\"\nselector = {}\ncrystal_error = \"{} ppm\"\n{}",
        number, 20 * number - 20, kFirmware, number, 40 * (number - 1), more);
}

std::string scenario(const std::string& robots, const std::string& controllers,
                     const std::string& more = {}) {
    return "[run]\nduration = \"300 ms\"\n[arena]\nsize = [\"2 m\", \"1 m\"]\n" + robots +
           "[[can_bus]]\ncontrollers = [" + controllers + "]\n" + more;
}

const std::string kThree = robot(0) + robot(1) + robot(2);
const std::string kAllThree = R"("robot0.pic.can1", "robot1.pic.can1", "robot2.pic.can1")";

/// What each controller got reported of whole frames, by "sent" and "received": frames in order.
std::map<std::string, std::vector<std::string>> told(const Workbench& bench, const std::string& run,
                                                     const std::string& what) {
    std::map<std::string, std::vector<std::string>> frames;
    for (const Row& row : bench.csv(run, "trace.csv"))
        if (row.at("kind") == "can" && row.at("detail").starts_with(what + " "))
            frames[row.at("link")].push_back(row.at("value"));
    return frames;
}

}  // namespace

TEST_CASE("the images are what their sources make") {
    const Workbench bench;
    for (const auto& [name, chip] :
         {std::pair{"can", "dspic30f6014a"}, std::pair{"ecan", "dspic33fj256gp710"}}) {
        const std::string path = fmt::format(PUCKLOOP_SOURCE "/firmware/can/{}", name);
        const Ended made = bench.puckloop({"asm", "--mcu", chip, path + ".s"});
        CHECK(made.status == 0);
        CHECK(made.out == text_of(path + ".hex"));
    }
}

TEST_CASE("three robots talk on a CAN bus: what one sends the others receive, in every placement") {
    const Workbench bench;
    const std::string file = bench.file("can.toml", scenario(kThree, kAllThree)).string();
    REQUIRE(bench.run("a", {file}).status == 0);
    const auto sent = told(bench, "a", "sent"), received = told(bench, "a", "received");
    REQUIRE(sent.size() == 3);
    for (int i = 0; i < 3; ++i) {
        const auto& frames = sent.at(fmt::format("can.robot{}.pic.can1", i));
        CHECK(frames.size() > 25);  // one each 10 ms
        for (std::size_t k = 0; k < frames.size(); ++k)
            CHECK(frames[k] == fmt::format("10{}#0{}{:02x}", i, i, k));
    }
    // In the order in which they passed: each of those of the others.
    std::vector<std::pair<std::string, std::string>> passed;
    for (const Row& row : bench.csv("a", "trace.csv"))
        if (row.at("kind") == "can" && row.at("detail").starts_with("sent "))
            passed.emplace_back(row.at("link"), row.at("value"));
    for (const auto& [link, frames] : received) {
        std::vector<std::string> of_others;
        for (const auto& [sender, frame] : passed)
            if (sender != link) of_others.push_back(frame);
        CHECK(frames == of_others);
    }
    // The firmware took them: LED n of a robot toggles for each frame of robot n.
    std::size_t toggles = 0;
    for (const Row& row : bench.csv("a", "trace.csv"))
        toggles += row.at("from") == "robot0.pic" && row.at("detail") == "led2";
    CHECK(toggles + 1 >= sent.at("can.robot2.pic.can1").size());
    const auto report = bench.report("a")["nodes"]["can"];
    CHECK(report["frames"] == passed.size());
    CHECK(report["controllers"]["robot1.pic.can1"]["transmit_errors"] == 0);
    CHECK(report["warnings"].empty());
    REQUIRE(bench.run("b", {file, "--in-process"}).status == 0);
    REQUIRE(bench.run("c", {file, "--in-process", "--threads", "2"}).status == 0);
    check_same_run(bench, "a", "b");
    check_same_run(bench, "a", "c");
}

TEST_CASE("a main board and a range-and-bearing board talk on a CAN bus, both saved in the middle") {
    const Workbench bench;
    const std::string rab = "[robot.rab]\nfirmware = \"" PUCKLOOP_SOURCE "/firmware/can/ecan.hex\"\n";
    const std::string file =
        bench.file("two.toml", scenario(robot(3, rab) + robot(1), R"("robot1.pic.can1", "robot3.rab.can1")"))
            .string();
    REQUIRE(bench.run("a", {file}).status == 0);
    const auto sent = told(bench, "a", "sent");
    const auto& asked = sent.at("can.robot1.pic.can1");
    const auto& answers = sent.at("can.robot3.rab.can1");
    CHECK(asked.size() > 25);
    REQUIRE(answers.size() + 1 >= asked.size());
    for (std::size_t k = 0; k < answers.size(); ++k)
        CHECK(answers[k] == fmt::format("201#fe{:02x}", 0xff - k));
    CHECK(bench.report("a")["nodes"]["can"]["warnings"].empty());
    const std::string snapshot = (bench.folder() / "half.snap").string();
    REQUIRE(bench.run("b", {file, "--in-process", "--save-at", "150ms", "--save", snapshot}).status == 0);
    check_same_run(bench, "a", "b");
    REQUIRE(bench.run("c", {"--from", snapshot}).status == 0);
    check_same_run(bench, "a", "c");
}

TEST_CASE("faults of a CAN bus: a bit costs an error frame, a held wire a pause, a cut controller is alone") {
    const Workbench bench;
    const std::string faults = R"(
[[fault]]
link = "can"
kind = "flip"
from = "robot0.pic.can1"
begin = "50 ms"
count = 3
[[fault]]
link = "can"
kind = "drop"
to = "robot1.pic.can1"
id = "0x102"
begin = "50 ms"
count = 2
[[fault]]
link = "can"
kind = "stuck"
begin = "120 ms"
for = "20 ms"
[[fault]]
link = "can"
kind = "disconnect"
from = "robot2.pic.can1"
begin = "200 ms"
for = "50 ms"
)";
    const std::string file = bench.file("faults.toml", scenario(kThree, kAllThree, faults)).string();
    const Ended ended = bench.run("a", {file});
    REQUIRE(ended.status == 0);
    const auto report = bench.report("a");
    const auto& robots = report["nodes"]["can"]["controllers"];
    CHECK(robots["robot0.pic.can1"]["errors_sending"] >= 3);
    CHECK(robots["robot2.pic.can1"]["errors"]["ack"] > 10);
    // Nothing is lost but what was dropped: each frame comes, if late.
    const auto sent = told(bench, "a", "sent"), received = told(bench, "a", "received");
    for (int i = 0; i < 2; ++i) {
        const auto& frames = sent.at(fmt::format("can.robot{}.pic.can1", i));
        for (std::size_t k = 0; k < frames.size(); ++k)
            CHECK(frames[k] == fmt::format("10{}#0{}{:02x}", i, i, k));
    }
    const auto count = [&](int receiver, int sender) {
        const auto& frames = received.at(fmt::format("can.robot{}.pic.can1", receiver));
        return std::count_if(frames.begin(), frames.end(), [&](const std::string& frame) {
            return frame.starts_with(fmt::format("10{}#", sender));
        });
    };
    CHECK(count(0, 2) == count(1, 2) + 2);
    CHECK_THAT(ended.out + ended.err, Catch::Contains("fault can.flip: fired 3 times"));
    REQUIRE(bench.run("b", {file, "--in-process"}).status == 0);
    check_same_run(bench, "a", "b");
}

TEST_CASE("a CAN bus in traces: exports and decode have each frame once, with its sender and time") {
    const Workbench bench;
    const std::string fault = "[[fault]]\nlink = \"can\"\nkind = \"flip\"\nbegin = \"50 ms\"\ncount = 1\n";
    const std::string file = bench.file("can.toml", scenario(kThree, kAllThree, fault)).string();
    REQUIRE(bench.run("a", {file, "--in-process"}).status == 0);
    std::size_t frames = 0;
    for (const auto& [link, list] : told(bench, "a", "sent"))
        frames += list.size();
    const Ended decoded =
        bench.puckloop({"trace", "decode", bench.out("a").string(), "--protocol", "can", "--json"});
    REQUIRE(decoded.status == 0);
    std::size_t lines = 0, errors = 0;
    std::istringstream in(decoded.out);
    for (std::string line; std::getline(in, line); ++lines) {
        const auto json = nlohmann::json::parse(line);
        CHECK(json["from"].get<std::string>().ends_with(".pic.can1"));
        errors += json["errors"].size();
        const double bits = (json["end_s"].get<double>() - json["begin_s"].get<double>()) / kBit;
        CHECK(bits == Approx(std::round(bits)).margin(0.02));
    }
    CHECK(lines == frames + 1);
    CHECK(errors == 1);
    for (const std::string format : {"vcd", "sr", "pcapng"}) {
        const std::string out = (bench.folder() / ("bus." + format)).string();
        const Ended done =
            bench.puckloop({"trace", "export", bench.out("a").string(), "--kind", "can", "-o", out});
        CHECK(done.status == 0);
        CHECK(std::filesystem::file_size(out) > 1000);
    }
}

TEST_CASE("a CAN bus that cannot be is refused in one line") {
    const Workbench bench;
    const auto refused = [&](const std::string& table, const Words& words) {
        const std::string file =
            bench
                .file("bad.toml",
                      "[run]\nduration = \"1 s\"\n[arena]\nsize = [\"1 m\", \"1 m\"]\n" + robot(0) + table)
                .string();
        check_one_line(bench.run("o", {file}), 2, words, 10.0);
    };
    refused("[[can_bus]]\ncontrollers = [\"robot0.pic.can3\"]\n",
            {"bad.toml", "line ", "no CAN controller 'robot0.pic.can3'", "robot0.pic.can1, robot0.pic.can2"});
    refused("[[can_bus]]\ncontrollers = [\"robot0.pic.can1\", \"robot0.pic.can1\"]\n",
            {"'robot0.pic.can1' is on a bus already"});
    refused("[[can_bus]]\nname = \"world\"\ncontrollers = [\"robot0.pic.can1\"]\n",
            {"something else has the name 'world'"});
    refused("[[can_bus]]\nname = \"a b\"\ncontrollers = [\"robot0.pic.can1\"]\n",
            {"'a b' is no name for a bus"});
    refused("[[can_bus]]\n", {"can_bus 1", "0 controllers on a bus"});
    refused("[[can_bus]]\ncontrollers = [\"robot0.pic.can1\"]\nbaud = 125000\n", {"unknown key 'baud'"});
    const std::string bus = "[[can_bus]]\ncontrollers = [\"robot0.pic.can1\"]\n";
    refused(bus + "[[fault]]\nlink = \"can\"\nkind = \"nack\"\n",
            {"unknown fault kind 'nack' for can", "drop, flip, stuck, disconnect"});
    refused(bus + "[[fault]]\nlink = \"can\"\nkind = \"flip\"\nto = \"robot1.pic.can1\"\n",
            {"'robot1.pic.can1' is at no end of can"});
    refused(bus + "[[fault]]\nlink = \"can\"\nkind = \"stuck\"\nprobability = 0.5\n",
            {"holds during its whole"});
}
