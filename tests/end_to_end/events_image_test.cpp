// What happens to a world, as firmware and programs that nobody here made take it: remote control and
// calibrations. Images come from PUCKLOOP_IMAGES, ARGoS' calibration program from PUCKLOOP_ARGOS; without
// them those cases say so and pass.

#include "tests/end_to_end/kit/workbench.h"

#include <catch2/catch.hpp>

#include <regex>

using namespace puckloop::tests;
using Catch::Contains;

namespace {

const std::string kScenarios = PUCKLOOP_SOURCE "/scenarios/";

/// ARGoS' configuration with its results in the test's folder.
std::string configuration(const Workbench& bench, const std::filesystem::path& original) {
    const std::string text = std::regex_replace(text_of(original), std::regex("\"([a-z_]+_sensor\\.xml)\""),
                                                "\"" + bench.folder().string() + "/$1\"");
    return bench.file("calibration.argos", text).string();
}

/// The numbers of <name>1,2,3</name>.
std::vector<double> numbers(const std::string& xml, const std::string& name) {
    const auto begin = xml.find("<" + name + ">"), end = xml.find("</" + name + ">");
    REQUIRE(begin != std::string::npos);
    std::vector<double> values;
    std::string list = xml.substr(begin + name.size() + 2, end - begin - name.size() - 2);
    for (std::size_t comma = 0; comma != std::string::npos; list.erase(0, comma + 1)) {
        comma = list.find(',');
        values.push_back(std::stod(list.substr(0, comma)));
        if (comma == std::string::npos) break;
    }
    return values;
}

/// Runs one of ARGoS' calibrations on the original firmware; its file.
std::optional<std::string> calibrated(const Workbench& bench, const std::string& what,
                                      const std::string& scenario) {
    const auto program = outside("PUCKLOOP_ARGOS", "calibration");
    const auto original = outside("PUCKLOOP_ARGOS", "calibration.argos");
    const auto image = outside("PUCKLOOP_IMAGES", "epuck_firmware.hex");
    if (!program || !original || !image) {
        WARN("no calibration program, or no image of the original firmware");
        return std::nullopt;
    }
    const auto ended =
        bench.run(what, {kScenarios + scenario, "--in-process", "--firmware", "pic=" + image->string(),
                         "--linux", program->string(), "-c", configuration(bench, *original), "-i", what});
    INFO(ended.err);
    CHECK(ended.status == 0);
    for (const auto& event : bench.report(what).at("events"))
        CHECK(event.at("done") == true);
    return text_of(bench.folder() / (what + "_sensor.xml"));
}

/// Largest and smallest of a sensors.csv column between two times.
struct Span {
    double low = 1e9, high = -1e9;
};
Span span(const std::vector<Row>& rows, const std::string& column, double from, double to) {
    Span span;
    for (const Row& row : rows) {
        const double t = std::stod(row.at("t_s")), value = std::stod(row.at(column));
        if (t < from || t > to) continue;
        span.low = std::min(span.low, value);
        span.high = std::max(span.high, value);
    }
    return span;
}

}  // namespace

TEST_CASE("BTcom drives by its remote control") {
    const auto image = outside("PUCKLOOP_IMAGES", "BTcom_default.hex");
    if (!image) {
        WARN("no image of BTcom");
        return;
    }
    const Workbench bench;
    const std::string scenario =
        bench
            .file("remote.toml",
                  "[run]\nduration = \"11 s\"\n[arena]\nsize = [\"3 m\", \"3 m\"]\n"
                  "[[robot]]\nposition = [\"0 m\", \"0 m\"]\n[robot.pic]\nfirmware = \"" +
                      image->string() +
                      "\"\n[[event]]\nat = \"6 s\"\nremote = \"robot0\"\nkey = 2\naddress = 8\n"
                      "[[event]]\nat = \"8 s\"\nremote = \"all\"\nkey = 5\naddress = 8\n"
                      "[[event]]\nat = \"9 s\"\nremote = \"all\"\nkey = 4\naddress = 8\nhold = \"300 ms\"\n")
            .string();
    REQUIRE(bench.run("remote", {scenario, "--in-process"}).status == 0);
    const auto rows = bench.csv("remote", "sensors.csv");
    CHECK(span(rows, "steps_left", 0, 6).high == 0);
    // Key 2: 600 steps/s straight on; key 5: stop; key 4: on the spot to the left.
    const Span straight = span(rows, "steps_left", 8.2, 9);
    CHECK(straight.low == Approx(1200).margin(80));
    CHECK(straight.high == straight.low);
    CHECK(span(rows, "steps_right", 8.2, 9).high == straight.high);
    CHECK(span(rows, "steps_left", 11, 11).low == Approx(straight.low - 1200).margin(80));
    CHECK(span(rows, "steps_right", 11, 11).high == Approx(straight.low + 1200).margin(80));
}

TEST_CASE("the calibration scenarios change the world when the wheels stop") {
    const Workbench bench;
    REQUIRE(bench.run("proximity", {kScenarios + "calibrate_proximity.toml", "--in-process"}).status == 0);
    const auto rows = bench.csv("proximity", "sensors.csv");
    for (int i = 0; i < 8; ++i) {
        const std::string column = "proximity" + std::to_string(i);
        CHECK(span(rows, column, 42, 52.2).high < 100);
        CHECK(span(rows, column, 52.5, 62.8).high > 2000);
    }
    REQUIRE(bench.run("ground", {kScenarios + "calibrate_ground.toml", "--in-process"}).status == 0);
    const auto ground = bench.csv("ground", "sensors.csv");
    for (const std::string column : {"ground0", "ground1", "ground2"}) {
        CHECK(span(ground, column, 42, 52.2).high < 450);
        CHECK(span(ground, column, 52.5, 62.8).low > 850);
    }
    CHECK(bench.report("ground").at("warnings").empty());
}

TEST_CASE("ARGoS' own calibrations run to their end and write plausible files") {
    const Workbench bench;
    const auto proximity = calibrated(bench, "proximity", "calibrate_proximity.toml");
    if (!proximity) return;
    for (const double base : numbers(*proximity, "base_values"))
        CHECK((base > 35 && base < 80));
    for (const double most : numbers(*proximity, "max_values"))
        CHECK((most > 2000 && most < 4096));
    const auto ground = calibrated(bench, "ground", "calibrate_ground.toml");
    for (const double black : numbers(*ground, "min_values"))
        CHECK((black > 280 && black < 380));
    for (const double white : numbers(*ground, "max_values"))
        CHECK((white > 900 && white < 1000));
    const auto light = calibrated(bench, "light", "calibrate_light.toml");
    for (const double base : numbers(*light, "base_values"))
        CHECK((base > 250 && base < 650));
}
