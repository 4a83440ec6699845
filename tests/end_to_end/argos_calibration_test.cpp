// ARGoS's calibration program for the e-puck, unmodified (PUCKLOOP_ARGOS: a folder with `calibration`): what
// an operator does between its phases is done by the scenario, and it runs to its end and writes its files.
// The firmware is the project's own; with the original one the same takes 42 s more of simulated time.

#include "tests/end_to_end/kit/workbench.h"

#include <catch2/catch.hpp>

#include <fmt/format.h>

#include <array>
#include <sstream>

using namespace puckloop::tests;
using Catch::Contains;

namespace {

constexpr const char* kEpuck = PUCKLOOP_SOURCE "/firmware/epuck/epuck.hex";
constexpr const char* kRab = PUCKLOOP_SOURCE "/firmware/rab/rab.hex";

/// The experiment file of the program: one controller, which saves to `saves_to`. It turns on the spot, so
/// that every sensor meets what stands beside the robot.
std::filesystem::path experiment(const Workbench& bench, const std::string& controller,
                                 const std::string& saves_to, const std::string& devices,
                                 const std::string& speed) {
    return bench.file(controller + ".argos", fmt::format(R"(<?xml version="1.0" ?>
<argos-configuration>
  <framework>
    <system threads="0" />
    <experiment length="0" ticks_per_second="10" random_seed="128" />
  </framework>
  <controllers>
    <calibrate_epuck id="{0}">
      {1}
      <params wheel_speed="{2}" ignore_first_samples="2" num_samples="100"
              {0}_configuration_file="{3}" />
    </calibrate_epuck>
  </controllers>
</argos-configuration>
)",
                                                         controller, devices, speed, saves_to));
}

std::string one_sensor(const std::string& sensor) {
    return "<actuators><epuck_wheels/></actuators><sensors><" + sensor + " calibrated=\"false\"/></sensors>";
}

std::string robot(const std::string& name, const std::string& x, const std::string& linux) {
    return fmt::format("[[robot]]\nname = \"{}\"\nposition = [\"{}\", \"0 cm\"]\n[robot.pic]\nfirmware = "
                       "\"{}\"\n[robot.linux]\n{}",
                       name, x, kEpuck, linux);
}

std::string program(const std::filesystem::path& calibration, const std::filesystem::path& file,
                    const std::string& controller, const std::string& hostname, const std::string& start) {
    return fmt::format(
        "program = [\"{}\", \"-c\", \"{}\", \"-i\", \"{}\"]\nhostname = \"{}\"\nstart = \"{}\"\n",
        calibration.string(), file.string(), controller, hostname, start);
}

/// The numbers of an element of a saved file.
std::vector<double> saved(const std::string& xml, const std::string& element) {
    INFO(xml);
    const std::size_t from = xml.find("<" + element + ">");
    REQUIRE(from != std::string::npos);
    const std::size_t begin = from + element.size() + 2;
    std::istringstream in(xml.substr(begin, xml.find('<', begin) - begin));
    std::vector<double> numbers;
    for (std::string number; std::getline(in, number, ',');)
        numbers.push_back(std::stod(number));
    return numbers;
}

/// Runs one robot's calibration, started at 1 s; phases last 10.3 s. Returns the saved file.
std::string calibrate(const Workbench& bench, const std::filesystem::path& calibration,
                      const std::string& controller, const std::string& world) {
    const std::string file = controller + "_sensor.xml";
    const auto xml = experiment(bench, controller, (bench.folder() / file).string(),
                                one_sensor("epuck_" + controller), "4.0");
    const auto scenario =
        bench.file("calibrate.toml",
                   "[run]\nduration = \"60 s\"\n[arena]\nsize = [\"1.2 m\", \"90 cm\"]\n" + world +
                       robot("robot0", "0 cm", program(calibration, xml, controller, "epuck12", "1 s")));
    const Ended ended = bench.run("o", {scenario, "--in-process"});
    INFO(ended.out << ended.err << text_of(bench.out("o") / "robot0.linux.log"));
    REQUIRE(ended.status == 0);
    const auto report = bench.report("o");
    CHECK(report["ended_by"] == "node stopped");
    CHECK(report["warnings"].empty());
    CHECK_THAT(text_of(bench.out("o") / "robot0.linux.log"), !Contains("min >= max"));
    return text_of(bench.folder() / file);
}

std::optional<std::filesystem::path> program_or_skip() {
    const auto calibration = outside("PUCKLOOP_ARGOS", "calibration");
    if (!calibration) WARN("PUCKLOOP_ARGOS has no calibration: skipped");
    return calibration;
}

}  // namespace

TEST_CASE("ARGoS's proximity calibration meets cans that are put down for its second phase", "[argos]") {
    const auto calibration = program_or_skip();
    if (!calibration) return;
    const Workbench bench;
    // The operator looks at the robot: it rests between the phases. In contact all but half a millimetre.
    std::string cans;
    int number = 0;
    for (const char* centre :
         {R"("65.5 mm", "0 mm")", R"("-65.5 mm", "0 mm")", R"("0 mm", "65.5 mm")", R"("0 mm", "-65.5 mm")"})
        cans += fmt::format("[[event]]\nwhen = {{ robot = \"robot0\", wheels = \"stop\" }}\nadd = "
                            "\"cylinder\"\nname = \"can{}\"\ncentre = [{}]\nradius = \"3 cm\"\n",
                            ++number, centre);
    const std::string xml = calibrate(bench, *calibration, "proximity", cans);
    const auto base = saved(xml, "base_values"), largest = saved(xml, "max_values");
    REQUIRE(base.size() == 8);
    REQUIRE(largest.size() == 8);
    for (std::size_t i = 0; i < 8; ++i) {
        CHECK(base[i] > 30);
        CHECK(base[i] < 80);
        CHECK(largest[i] > 1000);
        CHECK(largest[i] < 4096);
    }
}

TEST_CASE("ARGoS's ground calibration sees the floor that it is put on", "[argos]") {
    const auto calibration = program_or_skip();
    if (!calibration) return;
    const Workbench bench;
    const std::string xml =
        calibrate(bench, *calibration, "ground",
                  "floor_grey = 0\n[[event]]\nat = \"11.35 s\"\nset = \"floor\"\ngrey = 1\n");
    const auto dark = saved(xml, "min_values"), white = saved(xml, "max_values");
    REQUIRE(dark.size() == 3);
    REQUIRE(white.size() == 3);
    for (std::size_t i = 0; i < 3; ++i) {
        CHECK(dark[i] == Approx(329).margin(20));
        CHECK(white[i] == Approx(953).margin(20));
    }
}

TEST_CASE("ARGoS's light calibration keeps the room's light, once the lamp is out", "[argos]") {
    const auto calibration = program_or_skip();
    if (!calibration) return;
    const Workbench bench;
    // All round: the calibration keeps each sensor's darkest reading of two turns.
    std::string lamps, put_out;
    int number = 0;
    for (const char* centre :
         {R"("20 cm", "0 cm")", R"("-20 cm", "0 cm")", R"("0 cm", "20 cm")", R"("0 cm", "-20 cm")"}) {
        lamps += fmt::format("[[lamp]]\nname = \"lamp{}\"\ncentre = [{}]\n", ++number, centre);
        put_out += fmt::format("[[event]]\nat = \"500 ms\"\nswitch_off = \"lamp{}\"\n", number);
    }
    const auto lit = saved(calibrate(bench, *calibration, "light", lamps), "base_values");
    const auto room = saved(calibrate(bench, *calibration, "light", lamps + put_out), "base_values");
    REQUIRE(lit.size() == 8);
    REQUIRE(room.size() == 8);
    for (std::size_t i = 0; i < 8; ++i)
        CHECK(lit[i] > room[i] + 50);
    for (const double value : room)
        CHECK(value == Approx(392).margin(40));
}

TEST_CASE("ARGoS's range-and-bearing calibration ends at Ctrl-C with its gain", "[argos]") {
    const auto calibration = program_or_skip();
    if (!calibration) return;
    const Workbench bench;
    const std::string boards =
        "<actuators><epuck_wheels/><epuck_range_and_bearing data_size=\"1\"/></actuators>"
        "<sensors><epuck_range_and_bearing data_size=\"1\" calibrated=\"false\"/></sensors>";
    // One experiment file for both, as on robots; each works in a folder of its own.
    const auto xml = experiment(bench, "range_and_bearing", "gain.xml", boards, "0.8");
    std::string text = "[arena]\nsize = [\"1.2 m\", \"90 cm\"]\n";
    // 20 cm from each other, as its instructions say; both have their hundred samples after some 4 s.
    for (const auto& [name, x, host, start] : {std::array{"robot0", "-10 cm", "epuck12", "200 ms"},
                                               std::array{"robot1", "10 cm", "epuck13", "213.7 ms"}}) {
        text +=
            robot(name, x,
                  program(*calibration, xml, "range_and_bearing", host, start) +
                      fmt::format("folder = \"{}\"\nsignals = [{{ at = \"8 s\", send = \"INT\" }}]\n", name));
        text += fmt::format("[robot.rab]\nfirmware = \"{}\"\n", kRab);
    }
    const Ended ended =
        bench.run("o", {bench.file("calibrate.toml", text), "--in-process", "--duration", "20"});
    INFO(ended.out << ended.err);
    REQUIRE(ended.status == 0);
    for (const char* name : {"robot0", "robot1"}) {
        CHECK(bench.report("o")["nodes"][std::string(name) + ".linux"]["end"] == "exited with status 0");
        CHECK_THAT(text_of(bench.out("o") / (std::string(name) + ".linux.log")),
                   Contains("Data for range and bearing sensor acquired"));
        const auto gain = saved(text_of(bench.out("o") / name / "gain.xml"), "k_value");
        REQUIRE(gain.size() == 1);
        // 20 cm over the curve's value at strengths of 1000 to 1200 counts, those of IRIDIA's table at 20 cm
        CHECK(gain[0] > 0.3);
        CHECK(gain[0] < 4);
        const auto sent = bytes_sent(bench.csv("o", "trace.csv"), std::string(name) + ".uart",
                                     std::string(name) + ".linux");
        REQUIRE(sent.size() > 12);
        CHECK(sent[sent.size() - 2] == 'R');
    }
}
