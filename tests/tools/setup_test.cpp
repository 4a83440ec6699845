// From a scenario and the command line to nodes and links.

#include "base/error.h"
#include "base/json.h"
#include "run/setup.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <utility>
#include <vector>

using namespace puckloop;
using nlohmann::json;
using tools::RunRequest;
using tools::RunSetup;
using tools::set_up;

namespace {

constexpr const char* kTwoRobots = R"(
[run]
duration = "1 s"
i2c_clock = "400 kHz"
[arena]
size = ["1 m", "1 m"]
[[robot]]
name = "left"
position = ["-20 cm", "0 cm"]
[robot.pic]
firmware = "pic.hex"
[robot.rab]
firmware = "rab.hex"
crystal_error = "30 ppm"
[robot.linux]
program = ["./program"]
[[robot]]
name = "right"
position = ["20 cm", "0 cm"]
[robot.pic]
firmware = "pic.hex"
[robot.rab]
firmware = "rab.hex"
)";

class Scene {
  public:
    explicit Scene(const std::string& text) : path_(tests::scratch_path("puckloop-setup.toml")) {
        std::ofstream(path_) << text;
        request.scenario = path_;
    }
    ~Scene() { std::filesystem::remove(path_); }
    Scene(const Scene&) = delete;
    Scene& operator=(const Scene&) = delete;
    RunRequest request;

  private:
    std::filesystem::path path_;
};

/// What its process gets.
json described(const RunSetup& setup, const std::string& name) {
    for (const auto& spec : setup.nodes)
        if (spec.name == name) return json::parse(encode(spec.what));
    return nullptr;
}

json node(const RunSetup& setup, const std::string& name) {
    return described(setup, name).at("node");
}

std::string link(const RunSetup& setup, const std::string& name) {
    for (const auto& spec : setup.links)
        if (spec.name == name) return spec.a.node + "." + spec.a.port + " " + spec.b.node + "." + spec.b.port;
    return {};
}

}  // namespace

TEST_CASE("a range-and-bearing board hangs on its robot's bus and in the air") {
    const Scene scene(kTwoRobots);
    const RunSetup setup = set_up(scene.request);
    const json rab = node(setup, "left.rab");
    CHECK(described(setup, "left.rab").at("kind") == "rab");
    CHECK(rab.at("crystal_ppm").get<double>() == Approx(30.0));
    CHECK(rab.at("i2c_hertz") == 400e3);
    CHECK(std::filesystem::path(rab.at("firmware").get<std::string>()).is_absolute());
    CHECK(node(setup, "left.i2c").at("boards") ==
          json::parse(R"([{"main_board":false,"name":"rab","prompt":false}])"));
    CHECK(link(setup, "left.i2c.rab") == "left.rab.i2c left.i2c.rab");
    CHECK(link(setup, "right.ir") == "right.rab.ir ir.right.ir");
    CHECK(link(setup, "left.i2c.linux") == "left.linux.i2c left.i2c.linux");
    CHECK(link(setup, "right.i2c.linux").empty());
    REQUIRE(setup.warnings.size() == 1);
    CHECK_THAT(setup.warnings[0], Catch::StartsWith("right: no Linux board"));
}

TEST_CASE("firmware is replaced on one board or on all of a kind") {
    Scene scene(kTwoRobots);
    scene.request.firmware = {"rab=/x/all.hex", "right.rab=/x/right.hex", "left.pic=/x/left.hex"};
    const RunSetup setup = set_up(scene.request);
    CHECK(node(setup, "left.rab").at("firmware") == "/x/all.hex");
    CHECK(node(setup, "right.rab").at("firmware") == "/x/right.hex");
    CHECK(node(setup, "left.pic").at("firmware") == "/x/left.hex");
    scene.request.firmware = {"middle.rab=/x/y.hex"};
    CHECK_THROWS_WITH(set_up(scene.request),
                      "--firmware: the scenario has no board 'middle.rab' (expected one of left.pic, "
                      "left.rab, right.pic, right.rab, or pic, rab or tam for all)");
}

TEST_CASE("the programs of all robots end a run together") {
    Scene scene(kTwoRobots);
    CHECK(node(set_up(scene.request), "left.linux").at("programs") == 1);
    scene.request.linux_command = {"./other", "-x"};
    const RunSetup both = set_up(scene.request);
    CHECK(node(both, "left.linux").at("programs") == 2);
    CHECK(node(both, "right.linux").at("programs") == 2);
    CHECK(node(both, "right.linux").at("args") == json::array({"-x"}));
    CHECK(both.warnings.empty());
}

TEST_CASE("Linux boards of several robots are not alike, unless ideal ones are asked for") {
    const auto clocks = [](const RunSetup& setup) {
        std::vector<std::pair<double, double>> all;  // error in ppm, mean oversleep in s
        for (const char* name : {"left.linux", "right.linux"}) {
            const json program = node(setup, name);
            all.emplace_back(program.at("system_clock_ppm"), program.at("oversleep").at("mean_s"));
        }
        return all;
    };
    Scene alone(kTwoRobots);
    const json one = node(set_up(alone.request), "left.linux");
    CHECK(one.at("system_clock_ppm") == 0);
    CHECK(one.at("oversleep").at("mean_s") == 0);
    Scene scene(kTwoRobots);
    scene.request.linux_command = {"./other"};
    const auto drawn = clocks(set_up(scene.request));
    CHECK(drawn == clocks(set_up(scene.request)));
    CHECK(drawn[0] != drawn[1]);
    for (const auto& [error, late] : drawn) {
        CHECK(std::abs(error) <= 20);
        CHECK(late >= 60e-6);
        CHECK(late <= 100e-6);
    }
    scene.request.seed = 2;
    CHECK(clocks(set_up(scene.request)) != drawn);
    std::string text = kTwoRobots;
    text.replace(text.find("[run]\n"), 6, "[run]\nideal_linux_clocks = true\n");
    Scene ideal(text);
    ideal.request.linux_command = {"./other"};
    CHECK(clocks(set_up(ideal.request)) == std::vector<std::pair<double, double>>(2, {0.0, 0.0}));
    text = kTwoRobots;
    text.replace(text.find("[robot.linux]\n"), 14,
                 "[robot.linux]\nclock_error = \"5 ppm\"\noversleep = \"2 ms\"\n");
    Scene stated(text);
    stated.request.linux_command = {"./other"};
    CHECK(clocks(set_up(stated.request))[0] == std::pair(5.0, 2e-3));
    CHECK(clocks(set_up(stated.request))[1] == drawn[1]);
}

TEST_CASE("a Linux board's devices have the scenario's names") {
    std::string text = kTwoRobots;
    text.replace(text.find("[robot.linux]\n"), 14,
                 "[robot.linux]\nserial_devices = [\"/dev/ttyO0\", \"/dev/serial0\"]\n"
                 "i2c_devices = [\"/dev/i2c-4\", \"/dev/i2c-12\"]\n");
    const Scene scene(text);
    const json program = node(set_up(scene.request), "left.linux");
    CHECK(program.at("tty") == "/dev/ttyO0");
    CHECK(program.at("tty_aliases") == json{"/dev/serial0"});
    CHECK(program.at("i2c") == json{"/dev/i2c-4", "/dev/i2c-12"});
}

TEST_CASE("a duration or a program, in the file or on the command line, ends a run") {
    const std::string text = kTwoRobots;
    std::string endless = text.substr(text.find("[arena]"));
    endless.erase(endless.find("[robot.linux]"),
                  std::string("[robot.linux]\nprogram = [\"./program\"]\n").size());
    Scene scene(endless);
    CHECK_THROWS_WITH(set_up(scene.request),
                      Catch::Contains("[run]: nothing ends this run") && Catch::Contains("--duration"));
    scene.request.duration = 9.0;
    CHECK(set_up(scene.request).scenario.duration == 9.0);
    scene.request.duration.reset();
    scene.request.linux_command = {"./other"};
    CHECK(node(set_up(scene.request), "left.linux").at("programs") == 2);
}

TEST_CASE("a record has whether it repeats the run: programs by the wall clock do not") {
    Scene scene(kTwoRobots);
    const auto repeats = [&] { return node(set_up(scene.request), "world").at("events").at("repeats"); };
    CHECK(repeats() == true);
    scene.request.paced = true;
    CHECK(repeats() == true);
    scene.request.paced = false;
    scene.request.realtime = true;
    CHECK(repeats() == false);
    const std::string text = kTwoRobots;
    Scene alone(text.substr(0, text.find("[robot.linux]")));
    alone.request.realtime = true;
    CHECK(node(set_up(alone.request), "world").at("events").at("repeats") == true);
}

TEST_CASE("files beside a linked folder's target are found") {
    namespace fs = std::filesystem;
    const fs::path place =
        fs::canonical(fs::temp_directory_path()) / tests::scratch_path("linked").filename();
    fs::create_directories(place / "checkout/scenarios");
    fs::create_directory_symlink(place / "checkout/scenarios", place / "scenarios");
    std::string text = kTwoRobots;
    text.replace(text.find("pic.hex"), 7, "../firmware/pic.hex");
    text.replace(text.find("./program"), 9, "../bin/program");
    std::ofstream(place / "scenarios/x.toml") << text;
    RunRequest request;
    request.scenario = place / "scenarios/x.toml";
    const RunSetup setup = set_up(request);
    CHECK(node(setup, "left.pic").at("firmware") == (place / "checkout/firmware/pic.hex").string());
    CHECK(node(setup, "right.pic").at("firmware") == (place / "checkout/scenarios/pic.hex").string());
    CHECK(node(setup, "left.linux").at("program") == (place / "checkout/bin/program").string());
    fs::remove_all(place);
}

TEST_CASE("a range-and-bearing board needs its firmware, and unknown keys are refused") {
    const std::string text = kTwoRobots;
    const auto with = [&](const std::string& line) {
        return text.substr(0, text.rfind("firmware = \"rab.hex\"")) + line + "\n";
    };
    const Scene missing(with("adc_noise = 3"));
    CHECK_THROWS_WITH(set_up(missing.request), Catch::Contains("right.rab: 'firmware' is missing"));
    const Scene unknown(with("firmware = \"x.hex\"\naddress = \"0x21\""));
    CHECK_THROWS_WITH(set_up(unknown.request), Catch::Contains("right.rab: unknown key 'address'"));
}
