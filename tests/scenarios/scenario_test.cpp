#include "base/error.h"
#include "scenarios/reader/read_scenario.h"
#include "tests/scenarios/temporary_file.h"

#include <catch2/catch.hpp>

#include <numbers>

using namespace puckloop;
using namespace puckloop::scenarios;

namespace {

const std::string kArena = "[run]\nduration = \"5 s\"\n[arena]\nsize = [\"1 m\", \"80 cm\"]\n";
const std::string kRobot = "[[robot]]\nposition = [\"0 m\", \"0 m\"]\n[robot.pic]\nfirmware = \"x.hex\"\n";

/// What read_scenario reports of a text, from "line" on.
std::string problem_of(const std::string& text) {
    const TemporaryFile file(text);
    try {
        read_scenario(file.path());
    } catch (const InputError& error) {
        const std::string what = error.what();
        return what.substr(std::min(what.find("line "), what.size()));
    }
    return "accepted";
}

}  // namespace

TEST_CASE("hello.toml is what the README promises") {
    const Scenario hello = read_scenario(std::string(PUCKLOOP_SCENARIOS) + "/hello.toml");
    REQUIRE(hello.robots.size() == 1);
    CHECK(hello.name == "hello");
    CHECK(hello.robots[0].name == "robot0");
    CHECK(hello.robots[0].pic.firmware.filename() == "epuck.hex");
    REQUIRE(hello.robots[0].linux_board);
    CHECK(hello.robots[0].linux_board->command.front() == "puckloop-control");
    CHECK(hello.world.boxes.size() == 1);
    CHECK(hello.world.robots[0].heading == Approx(std::numbers::pi / 6));
}

TEST_CASE("programs of the shipped rooms for calibration keep their files apart") {
    const Scenario room = read_scenario(std::string(PUCKLOOP_SCENARIOS) + "/calibrate_rab.toml");
    REQUIRE(room.robots.size() == 2);
    for (const RobotBoards& robot : room.robots)
        CHECK(robot.linux_board->folder == robot.name);
}

TEST_CASE("a Linux board's devices are named, with aliases") {
    const std::string board = kArena + kRobot + "[robot.linux]\nprogram = [\"p\"]\n";
    const TemporaryFile plain(board);
    const LinuxBoard usual = *read_scenario(plain.path()).robots[0].linux_board;
    CHECK(usual.serial_devices == std::vector<std::string>{"/dev/ttyS0"});
    CHECK(usual.i2c_devices == std::vector<std::string>{"/dev/i2c-3"});
    const TemporaryFile file(board + "serial_devices = [\"/dev/ttyO0\", \"/dev/serial0\"]\n"
                                     "i2c_devices = [\"/dev/i2c-12\"]\n");
    const LinuxBoard named = *read_scenario(file.path()).robots[0].linux_board;
    CHECK(named.serial_devices == std::vector<std::string>{"/dev/ttyO0", "/dev/serial0"});
    CHECK(named.i2c_devices == std::vector<std::string>{"/dev/i2c-12"});
    const std::pair<const char*, const char*> refused[] = {
        {"serial_devices = []\n", "has 0 names"},
        {"serial_devices = [\"ttyO0\"]\n", "is not a device"},
        {"serial_devices = [\"/dev/../etc/passwd\"]\n", "is not a device"},
        {"serial_devices = [\"/dev/null\"]\n", "something else on every Linux board"},
        {"i2c_devices = [\"/dev/fd/0\"]\n", "something else on every Linux board"},
        {"i2c_devices = [\"/dev/i2c-1\", \"/dev/i2c-1\"]\n", "is there twice"},
        {"i2c_devices = [\"/dev/ttyS0\"]\n", "is another device"},
        {"serial_devices = [\"/dev/video1\"]\ncameras = [\"omni\"]\n", "is another device"}};
    for (const auto& [keys, problem] : refused) {
        INFO(keys);
        CHECK_THAT(problem_of(board + keys), Catch::Contains(problem));
    }
}

TEST_CASE("a Linux board's clock has an error only if it is stated") {
    const std::string board = kArena + kRobot + "[robot.linux]\nprogram = [\"p\"]\n";
    const TemporaryFile plain(board), stated(board + "clock_error = \"-12 ppm\"\n");
    CHECK_FALSE(read_scenario(plain.path()).robots[0].linux_board->clock_ppm);
    CHECK(read_scenario(stated.path()).robots[0].linux_board->clock_ppm.value() == Approx(-12));
    CHECK_THAT(problem_of(board + "clock_error = \"2 %\"\n"), Catch::Contains("out of range"));
    CHECK_FALSE(read_scenario(plain.path()).robots[0].linux_board->late.oversleep_stated);
}

TEST_CASE("errata of a main board's chip are named, and others refused") {
    const TemporaryFile file(kArena + kRobot + "errata = [\"daw.b\", \"pwm-zero-duty\"]\n");
    CHECK(read_scenario(file.path()).robots[0].pic.errata ==
          std::vector<std::string>{"daw.b", "pwm-zero-duty"});
    CHECK(problem_of(kArena + kRobot + "errata = [\"daw\"]\n") ==
          "line 9: robot0.pic: there is no erratum 'daw' (expected one of daw.b, pwm-zero-duty)");
    CHECK(problem_of(kArena + kRobot + "errata = 1\n")
              .ends_with("errata is not a list of texts (expected [\"a\", \"b\"])"));
}

TEST_CASE("parameters are named, checked against their range, and set for one robot or all") {
    const TemporaryFile file(
        kArena +
        "[parameters]\nrobot.wheel_radius_left = \"20.3 mm\"\n[parameters.proximity]\ngain3 = 1.2\n" +
        kRobot + "[robot.parameters]\nrobot.axle_length = \"52 mm\"\n");
    const Scenario scenario = read_scenario(file.path());
    CHECK(scenario.world.parameters.at("robot.wheel_radius_left") == Approx(0.0203));
    CHECK(scenario.world.parameters.at("proximity.gain3") == Approx(1.2));
    CHECK(scenario.world.robots[0].parameters.at("robot.axle_length") == Approx(0.052));

    CHECK(problem_of(kArena + "[parameters]\nrobot.axle_lenght = \"52 mm\"\n" + kRobot) ==
          "line 6: parameters: unknown parameter 'robot.axle_lenght' (expected perhaps 'robot.axle_length')");
    CHECK(problem_of(kArena + "[parameters]\nrobot.axle_length = \"52 cm\"\n" + kRobot)
              .starts_with("line 6: parameters: robot.axle_length = 0.52 is out of range"));
    CHECK(problem_of(kArena + "[parameters]\nrobot.axle_length = \"52 g\"\n" + kRobot) ==
          "line 6: parameters: axle_length: '52 g' is a mass (expected a length such as \"25 cm\")");
}

TEST_CASE("an overlay replaces parameters and nothing else") {
    const TemporaryFile file(kArena + kRobot);
    Scenario scenario = read_scenario(file.path());
    const TemporaryFile overlay("[parameters]\ncontact.mu = 0.4\n[[robot]]\nname = \"robot0\"\n"
                                "[robot.parameters]\nproximity.gain0 = 1.5\n");
    apply_overlay(scenario, overlay.path());
    CHECK(scenario.world.parameters.at("contact.mu") == Approx(0.4));
    CHECK(scenario.world.robots[0].parameters.at("proximity.gain0") == Approx(1.5));
    const TemporaryFile stranger("[[robot]]\nname = \"robot7\"\n");
    CHECK_THROWS_WITH(apply_overlay(scenario, stranger.path()),
                      Catch::Contains("line 2") && Catch::Contains("robot7"));
    const TemporaryFile arena("[arena]\nsize = [\"1 m\", \"1 m\"]\n");
    CHECK_THROWS_WITH(apply_overlay(scenario, arena.path()), Catch::Contains("unknown key 'arena'"));
}

TEST_CASE("an overlay's terms without a mechanism are read, and what is wrong with one has its line") {
    const TemporaryFile file(kArena + kRobot);
    const auto with = [&](const std::string& keys) {
        Scenario scenario = read_scenario(file.path());
        const TemporaryFile overlay("[parameters]\ncontact.mu = 0.4\n[[extension]]\n" + keys);
        apply_overlay(scenario, overlay.path());
        return scenario.world.extension;
    };
    const auto terms = with("adds_to = \"motion.turn\"\ntimes = \"speed\"\nover = [\"speed\", \"time\"]\n"
                            "at = [[0, 0.1], [0, 5, 10]]\nvalue = [0, 1, 2, 3, 4, 5]\n"
                            "sd = [0, 0, 0, 0, 0, 0.1]\nrun_spread = 0.02\n"
                            "[[extension]]\nadds_to = \"ground.reading\"\nsensor = 2\nvalue = [-4]\n");
    REQUIRE(terms.size() == 2);
    CHECK(terms[0].over[1].at == std::vector<double>{0, 5, 10});
    CHECK(terms[0].run_spread == 0.02);
    CHECK(terms[1].sensor == 2);
    CHECK(terms[1].value == std::vector<double>{-4});
    const auto refused = [&](const std::string& keys, const std::string& place, const std::string& problem) {
        CHECK_THROWS_WITH(with(keys), Catch::Contains(place) && Catch::Contains(problem));
    };
    const std::string turn = "adds_to = \"motion.turn\"\n";
    refused("value = [1]\n", "line 3", "'adds_to' is missing");
    refused("adds_to = \"motion.spin\"\nvalue = [1]\n", "line 4", "unknown quantity 'motion.spin'");
    refused(turn + "over = \"grey\"\nat = [[0, 1]]\nvalue = [0, 1]\n", "line 5", "does not know 'grey'");
    refused(turn + "over = \"speed\"\nat = [0, 1]\nvalue = [0, 1]\n", "line 6", "at is not a list");
    refused(turn + "over = \"speed\"\nat = [[1, 0]]\nvalue = [0, 1]\n", "line 6", "do not rise");
    refused(turn + "over = \"speed\"\nvalue = [0, 1]\n", "line 3", "0 lists of places for 1 covariates");
    refused(turn + "over = \"speed\"\nat = [[0, 1]]\nvalue = [0]\n", "line 7", "1 values of a table of 2");
    refused(turn + "value = [nan]\n", "line 5", "value");
    refused(turn + "value = [1]\nsmooth = true\n", "line 6", "unknown key 'smooth'");
}

TEST_CASE("an overlay acts on lines and Linux boards of robots that have them") {
    const TemporaryFile file(
        kArena + kRobot + "[robot.linux]\nprogram = [\"p\"]\noversleep = \"1 ms\"\n" +
        "[[robot]]\nposition = [\"20 cm\", \"0 m\"]\n[robot.pic]\nfirmware = \"x.hex\"\n");
    const auto with = [&](const std::string& overlay) {
        Scenario scenario = read_scenario(file.path());
        const TemporaryFile written(overlay);
        apply_overlay(scenario, written.path());
        return scenario;
    };
    const Scenario links =
        with("[uart]\ncommand_delay = \"20 ms\"\nanswer_cut = 0.02\nanswer_cut_again = 0.3\n"
             "answer_edge_loss = 0.01\n");
    REQUIRE(links.faults.size() == 3);
    CHECK(links.faults[0].kind == "delay");
    CHECK(links.faults[0].from == "robot0.linux");
    CHECK(links.faults[1].bytes == std::vector<std::uint8_t>{0x00, 0xFF});
    CHECK(links.faults[2].kind == "cut");
    CHECK(links.faults[2].probability == 0.02);
    CHECK(links.faults[2].parameters.number("again") == 0.3);
    const auto late =
        with("[linux]\ntty_batch = \"20 ms\"\ni2c_hold = \"2 ms\"\n").robots[0].linux_board->late;
    CHECK(late.tty_batch == 0.02);
    CHECK(late.i2c_hold == 0.002);
    CHECK(late.oversleep == 0.001);  // the scenario's own stays
    CHECK(with("[linux]\noversleep = \"-3 ms\"\n").robots[0].linux_board->late.oversleep == -0.003);
    CHECK_THROWS_WITH(with("[linux]\noversleep = \"-2 s\"\n"),
                      Catch::Contains("line 2") && Catch::Contains("oversleep is out of range"));
    CHECK_THROWS_WITH(with("[linux]\ntty_batch = \"-1 ms\"\n"),
                      Catch::Contains("line 2") && Catch::Contains("tty_batch is out of range"));
    CHECK_THROWS_WITH(with("[linux]\nslow = 1\n"), Catch::Contains("unknown key 'slow'"));
    CHECK_THROWS_WITH(with("[uart]\nanswer_cut = 2\n"),
                      Catch::Contains("answer_cut") && Catch::Contains("0 to 1"));
    CHECK_THROWS_WITH(with("[uart]\nanswer_cut_again = 0.5\n"),
                      Catch::Contains("line 2") && Catch::Contains("answer_cut_again does nothing"));
}

TEST_CASE("what cannot be run is refused with its line") {
    CHECK(problem_of("[run]\nduration = \"5 s\"\n") ==
          "line 1: [arena] is missing (expected [arena] with size = [\"1 m\", \"80 cm\"])");
    CHECK(problem_of(kArena) ==
          "line 1: 'robot' is missing (expected at least one [[robot]], [[group]], [[tam]] or [[host]])");
    CHECK(problem_of(kArena + "[[robot]]\nposition = [\"2 m\", \"0 m\"]\n[robot.pic]\nfirmware = \"x.hex\"\n")
              .starts_with("line 5: "));
    CHECK(problem_of(kArena + kRobot + "selecter = 3\n") ==
          "line 9: robot0.pic: unknown key 'selecter' (expected perhaps 'selector')");
    const std::string with_linux = kArena + kRobot + "[robot.linux]\nprogram = [\"p\"]\n";
    CHECK(problem_of(with_linux + "[[fault]]\nlink = \"robot0.uart\"\nkind = \"dorp\"\n")
              .find("unknown fault kind 'dorp' for robot0.uart (expected one of drop, flip,") !=
          std::string::npos);
    CHECK(problem_of(with_linux + "[[fault]]\nlink = \"robot0.uart\"\nbegin = \"5 s\"\nend = \"1 s\"\n")
              .find("window is empty") != std::string::npos);
    CHECK(problem_of(with_linux + "[[fault]]\nlink = \"robot1.uart\"\n")
              .ends_with("fault 1: there is no link 'robot1.uart' that can have a fault (expected "
                         "robot0.uart, robot0.i2c; did you mean \"robot0.uart\"?)"));
    CHECK(problem_of(with_linux + "[[fault]]\nlink = \"robot0.uart\"\nbytes = [\"0x00\", \"300\"]\n")
              .find("'300' is not a byte") != std::string::npos);
    CHECK(problem_of(with_linux + "[[fault]]\nlink = \"robot0.uart\"\nbytes = []\n").find("bytes is empty") !=
          std::string::npos);
    CHECK(problem_of(with_linux + "[[fault]]\nlink = \"robot0.uart\"\nkind = \"cut\"\nagain = 2\n")
              .find("again is out of range") != std::string::npos);
    CHECK(problem_of(with_linux + "restart = [\"3 s\", \"2 s\"]\n").find("do not rise") != std::string::npos);
    CHECK(problem_of(with_linux + "start = \"5 s\"\nrestart = [\"1 s\"]\n").find("do not rise") !=
          std::string::npos);
    CHECK(problem_of("[run]\nrecord_every = \"1500 us\"\n[arena]\nsize = [\"1 m\", \"1 m\"]\n" + kRobot) ==
          "line 2: run: record_every is out of range (expected a multiple of 1 ms, at most 1 h)");
    CHECK(problem_of(kArena + "[[robot]]\nname = \"a b\"\nposition = [\"0 m\", \"0 m\"]\n")
              .starts_with("line 6: "));
    CHECK(problem_of(kArena +
                     "[[box]]\nname = \"b\"\ncentre = [\"0 m\", \"0 m\"]\nsize = [\"1 cm\", \"1 cm\"]\n" +
                     kRobot) ==
          "line 8: box 1: size is not a list of 3 (expected 3, each a length such as \"25 cm\")");
}

TEST_CASE("loudspeakers play tones, sweeps and noise, once or again") {
    const std::string place = "[[speaker]]\nposition = [\"30 cm\", \"0 m\"]\nlevel = 450\n";
    const TemporaryFile file(kArena + kRobot + place +
                             "tone = \"700 Hz\"\nsweep_to = \"2 kHz\"\non = \"1 s\"\n"
                             "duration = \"30 ms\"\nevery = \"500 ms\"\ntimes = 3\n" +
                             place + "wave = \"noise\"\n");
    const auto speakers = read_scenario(file.path()).world.speakers;
    REQUIRE(speakers.size() == 2);
    CHECK(speakers[0].tone == 700);
    CHECK(speakers[0].sweep_to == 2000);
    CHECK(speakers[0].off == Approx(1.03));
    CHECK(speakers[0].every == 0.5);
    CHECK(speakers[0].times == 3);
    CHECK_FALSE(speakers[0].wave);
    CHECK(speakers[1].wave);
    CHECK(speakers[1].every == 0);
    const auto refused = [&](const std::string& keys, const std::string& message) {
        CHECK_THAT(problem_of(kArena + kRobot + place + keys), Catch::Contains(message));
    };
    refused("sweep_to = \"1 kHz\"\nduration = \"1 s\"\n", "without tone");
    refused("tone = \"1 kHz\"\nsweep_to = \"2 kHz\"\n", "without duration");
    refused("every = \"1 s\"\n", "without duration");
    refused("wave = \"square\"\n", "no wave 'square'");
    refused("times = 3\n", "without every");
    refused("off = \"1 s\"\nduration = \"1 s\"\n", "duration is given as well");
    refused("duration = \"1 s\"\nevery = \"900 ms\"\n", "every");
    refused("tone = \"5 kHz\"\n", "tone");
}

TEST_CASE("loudspeakers are read with their level and times") {
    const TemporaryFile file(kArena + kRobot +
                             "[[speaker]]\nposition = [\"30 cm\", \"-1 cm\"]\nlevel = 450\n"
                             "[[speaker]]\nname = \"horn\"\nposition = [\"0 m\", \"20 cm\"]\nlevel = 90\n"
                             "height = \"8 cm\"\non = \"500 ms\"\noff = \"2 s\"\n");
    const auto speakers = read_scenario(file.path()).world.speakers;
    REQUIRE(speakers.size() == 2);
    CHECK(speakers[0].name == "speaker 1");
    CHECK(speakers[0].x == 0.3);
    CHECK(speakers[0].level == 450);
    CHECK(speakers[0].on == 0);
    CHECK(speakers[0].off > 1e6);
    CHECK(speakers[1].name == "horn");
    CHECK(speakers[1].height == 0.08);
    CHECK(speakers[1].on == 0.5);
    CHECK(speakers[1].off == 2);
    const std::string begun = kArena + kRobot + "[[speaker]]\nposition = [\"0 m\", \"0 m\"]\n";
    CHECK(problem_of(begun).find("level") != std::string::npos);
    CHECK(problem_of(begun + "level = 5\nvolume = 3\n").find("volume") != std::string::npos);
}
