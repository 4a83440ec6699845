// [[tam]] tables.

#include "base/error.h"
#include "scenarios/reader/read_scenario.h"
#include "tests/scenarios/temporary_file.h"

#include <catch2/catch.hpp>

#include <numbers>

using namespace puckloop;
using namespace puckloop::scenarios;

namespace {

const std::string kArena = "[run]\nduration = \"5 s\"\n[arena]\nsize = [\"1 m\", \"80 cm\"]\n";
const std::string kTam = "[[tam]]\nposition = [\"0 m\", \"10 cm\"]\n";

/// What read_scenario reports of a TAM with these further keys, the first of them on line 7.
std::string problem_of(const std::string& keys) {
    const TemporaryFile file(kArena + kTam + keys);
    try {
        read_scenario(file.path());
    } catch (const InputError& error) {
        const std::string what = error.what();
        return what.substr(std::min(what.find("line "), what.size()));
    }
    return "accepted";
}

}  // namespace

TEST_CASE("a TAM is read with its defaults, and needs no robot") {
    const TemporaryFile file(kArena + kTam + kTam.substr(0, 8) +
                             "name = \"shop\"\nposition = [\"30 cm\", \"0 m\"]\n" +
                             "heading = \"90 deg\"\nfirmware = \"x.elf\"\nboot_loader = \"b.hex\"\n"
                             "resonator_error = \"-0.3 %\"\nnetwork = 1\nbattery = \"3.2 V\"\n"
                             "console = \"script:in.txt\"\nconsole_baud = 115200\nstart = \"2 s\"\n"
                             "reset = [\"5 s\"]\nadc_noise = 0\nreflectivity = 0.8\n");
    const Scenario scenario = read_scenario(file.path());
    CHECK(scenario.robots.empty());
    REQUIRE(scenario.tams.size() == 2);
    const TamBoard& plain = scenario.tams[0];
    CHECK(plain.name == "tam0");
    CHECK(plain.firmware.empty());
    CHECK(plain.network == 3);
    CHECK(plain.battery == 3.7);
    CHECK(plain.console.empty());
    CHECK(plain.start == 0.0);
    const TamBoard& other = scenario.tams[1];
    CHECK(other.name == "shop");
    CHECK(other.firmware.filename() == "x.elf");
    CHECK(other.boot_loader.filename() == "b.hex");
    CHECK(other.resonator_ppm == Approx(-3000));
    CHECK(other.network == 1);
    CHECK(other.console_baud == 115'200);
    CHECK(other.resets == std::vector<double>{5.0});
    REQUIRE(scenario.world.booths.size() == 2);
    CHECK(scenario.world.booths[0].y == Approx(0.1));
    CHECK(scenario.world.booths[1].heading == Approx(std::numbers::pi / 2));
    CHECK(scenario.world.booths[1].reflectivity == Approx(0.8));
}

TEST_CASE("what a TAM cannot be is refused with its line") {
    CHECK(problem_of("") == "accepted");
    CHECK(problem_of("network = 4\n") ==
          "line 7: tam0: network is out of range (expected a whole number from 0 to 3)");
    CHECK(problem_of("batery = \"3 V\"\n") ==
          "line 7: tam0: unknown key 'batery' (expected perhaps 'battery')");
    CHECK_THAT(problem_of("battery = \"9 V\"\n"), Catch::StartsWith("line 7: tam0: battery is out of range"));
    CHECK_THAT(problem_of("battery = \"9 m\"\n"), Catch::StartsWith("line 7: tam0: battery: '9 m'"));
    CHECK_THAT(problem_of("start = \"-1 s\"\n"), Catch::StartsWith("line 7: tam0: start is out of range"));
    CHECK_THAT(problem_of("firmware = \"a.elf\"\nboot_loader = \"./a.elf\"\n"),
               Catch::Contains("boot_loader is the same file as 'firmware'"));
    CHECK_THAT(problem_of("adc_noise = nan\n"), Catch::Contains("adc_noise: nan is not finite"));
    CHECK_THAT(problem_of("reset = [\"1e30 s\"]\n"), Catch::Contains("later than any run"));
    CHECK_THAT(problem_of("start = \"3 s\"\nreset = [\"2 s\"]\n"),
               Catch::StartsWith("line 8: tam0: the times"));
    CHECK_THAT(problem_of("console_baud = 1\n"),
               Catch::StartsWith("line 7: tam0: console_baud is out of range"));
    CHECK_THAT(problem_of("resonator_error = \"3 %\"\n"),
               Catch::StartsWith("line 7: tam0: resonator_error is out of range"));
    CHECK_THAT(problem_of("name = \"a b\"\n"), Catch::StartsWith("line 7: tam0: the name has other signs"));
    CHECK_THAT(problem_of("[[tam]]\nname = \"tam0\"\nposition = [\"30 cm\", \"0 m\"]\n"),
               Catch::StartsWith("line 8: tam1: a TAM is called 'tam0'"));
    CHECK_THAT(problem_of("[[tam]]\nposition = [\"5 cm\", \"10 cm\"]\n"),
               Catch::StartsWith("line 7: tam 'tam1': overlaps tam 'tam0'"));
    CHECK_THAT(
        problem_of(
            "[[robot]]\nname = \"tam0\"\nposition = [\"30 cm\", \"0 m\"]\n[robot.pic]\nfirmware = \"x\"\n"),
        Catch::Contains("tam0"));
}
