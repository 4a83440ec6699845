// A robot drives into a TAM and out again, by wheels and proximity sensors alone: both light barriers see it,
// and the TAM's firmware reports it to its coordinator in the time that its fact sheet states. With the
// unmodified firmware of the TAM's makers (tam_firmware.elf in PUCKLOOP_IMAGES) and with the project's own.

#include "protocols/radio/xbee_frame.h"
#include "protocols/radio/xbee_message.h"
#include "tests/end_to_end/kit/same_run.h"
#include "tests/end_to_end/kit/workbench.h"

#include <catch2/catch.hpp>

#include <optional>

using namespace puckloop;
using namespace puckloop::tests;

namespace {

/// One TAM, one robot that serves at it; the mesh has a coordinator's module with nobody behind it.
const std::string kScenario = R"([run]
duration = "19 s"

[arena]
size = ["80 cm", "80 cm"]

[[tam]]
position = ["10 cm", "20 cm"]
heading = "-90 deg"
%TAM%
[coordinator]

[[robot]]
position = ["10 cm", "-6 cm"]
heading = "90 deg"

[robot.pic]
firmware = ")" PUCKLOOP_SOURCE R"(/firmware/epuck/epuck.hex"

[robot.linux]
program = ["puckloop-control", "--behaviour", "serve"]
start = "1 s"
)";

struct Report {
    double at = 0;  ///< s: its last byte has left the board
    bool present = false;
};

/// The states that the board sent to its radio module.
std::vector<Report> reports_of(const std::vector<Row>& trace) {
    protocols::XBeeReader reader(protocols::XBeeApiMode::Escaped);
    std::vector<Report> reports;
    for (const Row& row : trace) {
        if (row.at("link") != "tam0.xbee" || row.at("from") != "tam0.avr") continue;
        const auto reading = reader.take(static_cast<std::uint8_t>(std::stoi(row.at("value"), nullptr, 16)));
        if (!reading) continue;
        REQUIRE(reading->ok());
        const auto message = protocols::decode_xbee(reading->data);
        const auto* data = std::get_if<protocols::XBeeTx>(&message);
        if (data == nullptr) continue;
        REQUIRE(data->data.size() == 8);  // 00 red green blue present battery battery robot
        REQUIRE(data->data[0] == 0);
        reports.push_back({std::stod(row.at("time_s")), data->data[4] == 1});
    }
    return reports;
}

/// When the beams were, for the first time from `from` on, as a TAM's firmware looks for them: the front one
/// lit, the back one dark or lit. A beam counts as dark when less than 0.387 of its light comes through.
std::optional<double> seen(const std::vector<Row>& tams, double from, bool back_dark) {
    const auto dark = [](const std::string& share) { return std::stod(share) > 1 - 0.387; };
    for (const Row& row : tams)
        if (std::stod(row.at("t_s")) >= from && !dark(row.at("front")) && dark(row.at("back")) == back_dark)
            return std::stod(row.at("t_s"));
    return std::nullopt;
}

/// From what the beams show until the report is out, s.
struct Times {
    double least = 0, most_entering = 0, most_leaving = 0;
};

void check_visit(const std::string& firmware, const Times& times) {
    const Workbench bench;
    std::string text = kScenario;
    text.replace(text.find("%TAM%"), 5, firmware.empty() ? "" : "firmware = \"" + firmware + "\"\n");
    const auto scenario = bench.file("visit.toml", text);
    const Ended ended = bench.run("o", {scenario, "--no-cache"});
    INFO(ended.err);
    REQUIRE(ended.status == 0);
    const auto tams = bench.csv("o", "tams.csv");
    const auto entered = seen(tams, 0.001, true);
    REQUIRE(entered);
    const auto left = seen(tams, *entered, false);
    REQUIRE(left);
    CHECK(*left - *entered > 8);  // it stayed
    std::optional<double> reported, gone;
    for (const Report& report : reports_of(bench.csv("o", "trace.csv"))) {
        if (report.present && !reported) reported = report.at;
        if (!report.present && reported && !gone) gone = report.at;
    }
    REQUIRE(reported);
    REQUIRE(gone);
    INFO("entered " << *entered << " s, reported " << *reported << " s, left " << *left << " s, reported "
                    << *gone << " s");
    CHECK(*reported - *entered > times.least);
    CHECK(*reported - *entered < times.most_entering);
    CHECK(*gone - *left > times.least);
    CHECK(*gone - *left < times.most_leaving);
    const auto board = bench.report("o")["nodes"]["tam0.avr"];
    // In and out: the front beam twice, the back beam once.
    CHECK(board["interruptions"]["front"] == 2);
    CHECK(board["interruptions"]["back"] == 1);
    CHECK(board["unmodelled"].empty());
    CHECK(board["warnings"].empty());
    CHECK_THAT(text_of(bench.out("o") / "trajectory.svg"), Catch::Contains(">tam0<"));
    // The same in one process.
    REQUIRE(bench.run("one", {scenario, "--no-cache", "--in-process", "--threads", "2"}).status == 0);
    check_same_run(bench, "o", "one");
    CHECK(text_of(bench.out("o") / "tams.csv") == text_of(bench.out("one") / "tams.csv"));
    CHECK(text_of(bench.out("o") / "tam0.avr.log") == text_of(bench.out("one") / "tam0.avr.log"));
}

// The fact sheet, section 4: 360 to 412 ms. The makers' firmware then prints a line and, with a robot there,
// sends a word by infra-red before it reports, while its loop stands still; as long as the robot is there, a
// word goes out every 200 ms, which stretches the eight rounds that decide. The report's bytes come last.
constexpr double kLeast = 0.360, kMost = 0.412, kLine = 0.011, kWord = 0.033, kReport = 0.030;

}  // namespace

TEST_CASE("a robot visits a TAM with the firmware of its makers") {
    const auto firmware = outside("PUCKLOOP_IMAGES", "tam_firmware.elf");
    if (!firmware) {
        WARN("skipped: PUCKLOOP_IMAGES does not name a folder with tam_firmware.elf");
        return;
    }
    check_visit(firmware->string(),
                {kLeast, kMost + kLine + kWord + kReport, kMost + kLine + 3 * kWord + kReport});
}

TEST_CASE("a robot visits a TAM with the project's own firmware") {
    check_visit("", {0.350, 0.460 + kReport, 0.460 + kReport});
}
