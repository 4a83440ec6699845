// Faults of boards and of the light between them in whole runs of the project's firmware: what they do, the
// evidence, and that all of it is the same in one process and in many.

#include "tests/end_to_end/kit/same_run.h"
#include "tests/end_to_end/kit/workbench.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <fstream>

using namespace puckloop::tests;
using Catch::Contains;

namespace {

const std::string kSource = PUCKLOOP_SOURCE;

/// Address of the routine behind vector `number` (0 is INT0) of the main board's firmware.
std::string routine(int number) {
    std::ifstream file(kSource + "/firmware/epuck/epuck.hex");
    const std::size_t wanted = 2 * (0x14 + 2 * static_cast<std::size_t>(number));
    std::size_t high = 0;
    for (std::string line; std::getline(file, line);) {
        const auto hex = [&](std::size_t at, std::size_t digits) {
            return std::stoul(line.substr(1 + at, digits), nullptr, 16);
        };
        const std::size_t count = hex(0, 2), address = hex(2, 4);
        if (hex(6, 2) == 4) high = hex(8, 4) << 16;
        if (hex(6, 2) != 0 || wanted < high + address || wanted >= high + address + count) continue;
        const std::size_t at = 8 + 2 * (wanted - high - address);
        return fmt::format("0x{:X}", hex(at, 2) | hex(at + 2, 2) << 8);
    }
    FAIL("no vector " << number);
    return {};
}

const nlohmann::json& fault_named(const nlohmann::json& report, const std::string& name) {
    for (const auto& fault : report.at("faults"))
        if (fault.at("name") == name) return fault;
    FAIL("no fault " << name);
    return report;
}

}  // namespace

TEST_CASE("faults of a main board in a run: their effects and their evidence") {
    const Workbench bench;
    constexpr int kTimer1 = 3;
    const std::string pc = routine(kTimer1);
    Words words{bench.hello(), "--duration", "4"};
    for (const std::string& fault :
         {"hang name=hang node=robot0.pic pc=" + pc + " nth=500 begin=1.5s duration=300us",
          std::string("lost_interrupt name=lost node=robot0.pic vector=U2RX at=2s count=2"),
          std::string("late_interrupt name=late node=robot0.pic vector=T1 every=50 delay=100us jitter=50us"),
          std::string("spurious_interrupt name=nowhere node=robot0.pic vector=T1 at=2500ms"),
          std::string("battery name=battery node=robot0.pic profile=\"0 s 4 V, 2 s 3 V, 3 s 3.9\" begin=1s"),
          std::string("ambient_burst name=light node=robot0.pic at=1200ms for=500ms")})
        words.insert(words.end(), {"--fault", fault});
    REQUIRE(bench.run("many", words).status == 0);
    words.emplace_back("--in-process");
    REQUIRE(bench.run("one", words).status == 0);
    check_same_run(bench, "one", "many");
    const auto report = bench.report("one");
    CHECK(report["faults"] == bench.report("many")["faults"]);
    CHECK(text_of(bench.out("one") / "faults.csv") == text_of(bench.out("many") / "faults.csv"));

    const auto& hang = fault_named(report, "hang");
    CHECK(hang["fired"] == 1);
    CHECK_THAT(hang["firings"][0]["what"].get<std::string>(), Contains("pc " + pc));
    CHECK(hang["first_s"].get<double>() == Approx(1.5 + 500.0 / 1024).margin(0.002));  // 1024 ticks a second
    const auto& lost = fault_named(report, "lost");
    CHECK(lost["fired"] == 2);
    CHECK(lost["first_s"].get<double>() >= 2.0);
    CHECK(lost["firings"][1]["index"].get<int>() == lost["firings"][0]["index"].get<int>() + 1);
    // Four bytes have room: the next interrupt empties the FIFO, and the robot goes on.
    CHECK(report["nodes"]["robot0.pic"]["uart2"]["overruns"] == 0);
    CHECK(journey(bench.csv("one", "trajectory.csv"), 3.0).length > 0.02);
    CHECK(fault_named(report, "late")["fired"].get<int>() == Approx(4 * 1024 / 50).margin(4));
    CHECK_THAT(fault_named(report, "nowhere")["firings"][0]["what"].get<std::string>(), Contains("T1 at pc"));
    CHECK(fault_named(report, "battery")["fired"] == 3);
    CHECK(fault_named(report, "light")["first_s"] == 1.2);
}

TEST_CASE("a receiver that lost its interrupts overruns") {
    const Workbench bench;
    REQUIRE(bench
                .run("o", {bench.hello(), "--duration", "3", "--in-process", "--fault",
                           "lost_interrupt node=robot0.pic vector=U2RX at=2s count=9"})
                .status == 0);
    const auto report = bench.report("o");
    // The fifth byte finds no room and the FIFO takes none any more: no event is left to interrupt for, until
    // the firmware's watchdog clears the overrun a second later and as much is lost again.
    const auto& lost = report["faults"][0];
    REQUIRE(lost["fired"] == 8);
    const auto at = [&](int firing) { return lost["firings"][firing]["time_ps"].get<double>() * 1e-12; };
    CHECK(at(3) - at(0) < 0.001);
    CHECK(at(4) - at(3) > 0.9);
    CHECK(at(7) - at(4) < 0.001);
    CHECK(report["nodes"]["robot0.pic"]["uart2"]["overruns"].get<int>() > 0);
}

TEST_CASE("what a node's fault cannot be ends the run in one line") {
    const Workbench bench;
    const std::string plain = bench.hello();
    const std::vector<std::pair<std::string, std::string>> cases{
        {"flip node=robot0.pic space=ram address=0x100 at=1s", "no cell of the ram at 0x100"},
        {"flip node=robot0.pic space=ram address=0x2800 at=1s", "no cell of the ram at 0x2800"},
        {"flip node=robot0.pic space=flash address=0x18000 at=1s", "no cell of the flash at 0x18000"},
        {"flip node=robot0.pic space=eeprom address=0 at=1s", "no cell of the eeprom at 0x0"},
        {"flip node=robot0.pic space=ram address=0x901 at=1s", "no cell of the ram at 0x901"},
        {"flip node=robot0.pic space=ram address=0x900 bit=16 at=1s", "no bit 16 there"},
        {"flip node=robot0.pic address=0x1000000 at=1s", "address is out of range"},
        {"flip node=robot0.pic space=register symbol=U9STA at=1s", "no register 'U9STA'"},
        {"lost_interrupt node=robot0.pic vector=U9RX", "no interrupt source 'U9RX'"},
        {"reset node=robot0.pic pc=0x101", "no program at pc = '0x101'"},
        {"sag node=robot0.pic volts=1V probability=0.5", "sag holds during its whole window"},
        {"battery node=robot0.pic profile=\"4 V\"", "no number at 'V'"}};
    bool in_process = false;
    for (const auto& [fault, part] : cases) {
        INFO(fault);
        Words words{plain, "--duration", "2", "--fault", fault};
        if ((in_process = !in_process)) words.emplace_back("--in-process");
        const Ended ended = bench.run("x", words);
        CHECK(ended.status == 2);
        CHECK_THAT(ended.err, Contains(part) && Contains("(expected "));
        CHECK(ended.error_lines() == 1);
    }
    const Ended never = bench.run("never", {plain, "--duration", "1", "--in-process", "--fault",
                                            "lost_interrupt node=robot0.pic vector=INT0"});
    CHECK(never.status == 1);
    CHECK_THAT(never.err, Contains("fault robot0.pic.lost_interrupt never fired"));
}

TEST_CASE("chips, shade and daylight between two robots' boards") {
    const Workbench bench;
    Words words{kSource + "/scenarios/rab_pair.toml", "--duration", "1.4"};
    for (const char* fault :
         {"chip_flip name=flip link=leader.ir from=ir chip=20 begin=400ms",
          "chip_jitter name=jitter link=follower.ir from=follower.rab jitter=2us end=300ms",
          "occlusion name=shade link=follower.ir from=follower.rab other=leader begin=800ms end=1s",
          "weak_emitter name=weak link=leader.ir gain=1e-6 begin=800ms end=1s",
          "ambient_burst name=sun link=leader.ir begin=1.1s end=1.3s"})
        words.insert(words.end(), {"--fault", fault});
    REQUIRE(bench.run("many", words).status == 0);
    words.emplace_back("--in-process");
    REQUIRE(bench.run("one", words).status == 0);
    check_same_run(bench, "one", "many");
    const auto report = bench.report("one");
    CHECK(report["faults"] == bench.report("many")["faults"]);
    for (const auto& fault : report["faults"]) {
        INFO(fault["name"]);
        CHECK(fault["fired"].get<int>() > 1);
    }
    CHECK_THAT(fault_named(report, "flip")["firings"][0]["what"].get<std::string>(),
               Contains("follower to leader chip 20"));

    // Frames with a wrong chip could be heard, and the firmware's check let none of them pass.
    for (const char* begin : {"0", "0.4"}) {
        const Ended ended = bench.puckloop({"trace", "rab", bench.out("one"), "--json", "--from", begin});
        INFO(ended.err);
        REQUIRE(ended.status == 0);
        const auto losses = nlohmann::json::parse(ended.out);
        INFO(losses["groups"].dump());
        for (const auto& group : losses["groups"]) {
            const bool flipped = begin == std::string("0.4");
            if (group["group"] == "leader -> follower") CHECK(group["delivered"] > 10);
            if (group["group"] != "follower -> leader") continue;
            CHECK(group["frames"] > 10);
            if (flipped)
                CHECK(group["delivered"] == 0);
            else
                CHECK(group["delivered"] > 2);
            if (flipped)
                CHECK(group["lost_by_cause"]["other"].get<int>() +
                          group["lost_by_cause"]["after_error"].get<int>() >
                      5);
        }
    }
    int sent = 0, heard = 0;
    for (const Row& row : bench.csv("one", "ir.csv")) {
        const double time = std::stod(row.at("t_s"));
        const bool leader_hears = row.at("receiver") == "leader";
        const bool shaded = time >= 0.8 && time < 1.0;
        const bool dazzled = leader_hears && time >= 1.1 && std::stod(row.at("end_s")) < 1.3;
        INFO(time << " " << row.at("receiver"));
        if (shaded || dazzled) CHECK(row.at("heard") == "0");
        heard += row.at("heard") == "1";
        sent += leader_hears && time >= 0.4;
    }
    CHECK(sent > 10);
    CHECK(heard > 40);
    CHECK(fault_named(report, "flip")["fired"] == sent);
}

TEST_CASE("until faults begin a run is the one without them, to the picosecond") {
    const Workbench bench;
    Words words{PUCKLOOP_SOURCE "/scenarios/rab_pair.toml", "--duration", "1.6", "--in-process"};
    REQUIRE(bench.run("without", words).status == 0);
    for (const char* fault :
         {"clock node=follower.pic ppm=3000 begin=1.2s", "clock node=leader.rab drift=500 begin=1.2s",
          "clock node=follower.rab ppm=-40000 begin=1.2s for=20ms",
          "baud link=follower.uart match=\"00 00\" offset=2% begin=1.2s",
          "stretch link=leader.i2c time=1ms at=1.2s",
          "break link=leader.uart begin=1.2s period=90ms end=100s",
          // The peak detectors of receivers 1 to 12 are at the converter's inputs 20 to 31.
          "adc_stuck name=stuck node=follower.rab channel=22 value=0.25 begin=1.2s"})
        words.insert(words.end(), {"--fault", fault});
    REQUIRE(bench.run("with", words).status == 0);
    const auto before = [&](const std::string& name) {
        std::string rows;
        std::ifstream file(bench.out(name) / "trace.csv");
        std::string line;
        for (std::getline(file, line); std::getline(file, line) && std::stod(line) < 1.2;)
            rows += line + "\n";
        return rows;
    };
    const std::string rows = before("without");
    CHECK(std::count(rows.begin(), rows.end(), '\n') > 10'000);
    CHECK((before("with") == rows));
    const auto report = bench.report("with");
    for (const auto& fault : report.at("faults")) {
        INFO(fault.at("name"));
        CHECK(fault.at("fired") > 0);
        // Pulses of the line are planned long before: those beyond the run's end never happened.
        CHECK(fault.at("last_ps").get<double>() * 1e-12 < report.at("simulated_s").get<double>());
    }
    CHECK_THAT(fault_named(report, "stuck").at("firings").at(0).at("what").get<std::string>(),
               Contains("AN22 ") && Contains(" to 0.2500"));
}

TEST_CASE("a main board whose receiver overran unnoticed stops, hears again and goes on") {
    const Workbench bench;
    // Four characters that nobody fetches fill the FIFO; what is left of the faults does the same a second
    // later.
    const auto [count, at] = GENERATE(table<int, double>({{4, 1.5}, {7, 1.637}, {9, 1.71}}));
    INFO(count << " lost");
    REQUIRE(bench
                .run("o", {bench.hello(), "--duration", "6", "--in-process", "--fault",
                           fmt::format("lost_interrupt node=robot0.pic vector=U2RX begin={}s count={}", at,
                                       count)})
                .status == 0);
    CHECK(bench.report("o").at("nodes").at("robot0.pic").at("uart2").at("overruns") > 0);
    std::vector<double> records;
    double before = 0;
    for (const Row& row : bench.csv("o", "trace.csv")) {
        const double time = std::stod(row.at("time_s"));
        if (row.at("from") != "robot0.pic") continue;
        if (row.at("link") == "robot0.uart") {
            if (time - before > 0.01) records.push_back(time);
            before = time;
        }
    }
    const auto answered = [&](double from, double to) {
        return std::count_if(records.begin(), records.end(),
                             [=](double time) { return time > from && time < to; });
    };
    CHECK(answered(at + 0.3, at + 0.9) == 0);
    CHECK(answered(5.0, 6.0) >= 9);
    double first = records.back();
    for (const double time : records)
        if (time > at + 0.9) first = std::min(first, time);
    CHECK(first < at + 1.6);
    CHECK(journey(bench.csv("o", "trajectory.csv"), 4.8).length > 0.02);
}

TEST_CASE("a dip of a robot's battery resets both of its boards, and the summary names them") {
    const Workbench bench;
    // Of some 4 V: less than 1.85 V are left behind the regulators.
    Words words{kSource + "/scenarios/rab_pair.toml",
                "--duration",
                "0.9",
                "--no-cache",
                "--fault",
                "sag name=dip node=leader.pic volts=2.4V begin=600ms for=20ms"};
    const Ended many = bench.run("many", words);
    REQUIRE(many.status == 0);
    words.emplace_back("--in-process");
    const Ended one = bench.run("one", words);
    REQUIRE(one.status == 0);
    check_same_run(bench, "one", "many");
    for (const Ended& ended : {many, one}) {
        CHECK_THAT(ended.out, Contains("reset: leader.pic, ") && Contains("reset: leader.rab, "));
        CHECK_THAT(ended.out, !Contains("reset: follower"));
        CHECK_THAT(ended.out, !Contains("warning: leader.rab: crashed"));
    }
    const auto report = bench.report("one");
    CHECK(fault_named(report, "dip")["fired"] == 1);
    for (const char* board : {"leader.pic", "leader.rab"}) {
        INFO(board);
        const auto& resets = report["nodes"][board]["resets"];
        REQUIRE(resets.size() == 2);
        const double instant = resets[1]["time_s"];
        CHECK(instant >= 0.6);
        CHECK(instant < 0.6001);
        const std::string cause = resets[1]["cause"];
        CHECK((cause == "POR" || cause == "BOR"));
        CHECK_THAT(one.out, Contains(fmt::format("({}) once, first at pc {}", cause,
                                                 resets[1]["pc"].get<std::string>())) &&
                                Contains(fmt::format("({:.6f} s)", instant)));
    }
    CHECK(report["nodes"]["follower.pic"]["resets"].size() == 1);
    CHECK(report["nodes"]["follower.rab"]["resets"].size() == 1);
}

TEST_CASE("a fault of the range-and-bearing board's supply leaves the main board alone") {
    const Workbench bench;
    const Ended ended = bench.run(
        "o", {kSource + "/scenarios/rab_pair.toml", "--duration", "0.7", "--in-process", "--fault",
              "battery node=follower.rab profile=\"0 s 3.9 V, 100 ms 2.5 V\" begin=400ms for=200ms"});
    REQUIRE(ended.status == 0);
    CHECK_THAT(ended.out, Contains("reset: follower.rab, brown-out (BOR) once") &&
                              !Contains("reset: follower.pic") && !Contains("reset: leader"));
}

TEST_CASE("an empty battery resets the range-and-bearing board, as the world has it") {
    const Workbench bench;
    // 3.76 V as it is charged; empty, the load leaves 2.5 V of its 3 V, 2.4 V behind the regulator.
    const auto scenario = bench.hello("[robot.rab]\nfirmware = \"" + kSource +
                                      "/firmware/rab/rab.hex\"\n[parameters]\n\"battery.resistance\" = 1.0\n"
                                      "[[event]]\nat = \"500 ms\"\nset = \"robot0\"\ncharge = 0.0\n"
                                      "[[event]]\nat = \"600 ms\"\nset = \"robot0\"\ncharge = 0.9\n");
    Words words{scenario, "--duration", "1.3", "--no-cache"};
    REQUIRE(bench.run("many", words).status == 0);
    words.emplace_back("--in-process");
    const Ended one = bench.run("one", words);
    REQUIRE(one.status == 0);
    check_same_run(bench, "one", "many");
    CHECK_THAT(one.out, Contains("reset: robot0.rab, brown-out (BOR) once"));
    const auto resets = bench.report("one")["nodes"]["robot0.rab"]["resets"];
    REQUIRE(resets.size() == 2);
    CHECK(resets[1]["time_s"].get<double>() ==
          Approx(0.501).margin(0.0011));  // the world's step, and the next
}
