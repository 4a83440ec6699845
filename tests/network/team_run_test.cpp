// Robots with the project's own network firmware: by WiFi over UART2 and the Linux board, and by Bluetooth;
// and what a monitor captures of the radio.

#include "tests/end_to_end/kit/one_line.h"
#include "tests/end_to_end/kit/same_run.h"
#include "tests/end_to_end/kit/workbench.h"
#include "tests/kit/files.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <filesystem>
#include <iterator>

using namespace puckloop::tests;
namespace fs = std::filesystem;

namespace {

std::string team(int robots, const std::string& duration, const std::string& wifi = "") {
    std::string text = fmt::format("[run]\nduration = \"{}\"\n[arena]\nsize = [\"2.0 m\", \"1.8 m\"]\n"
                                   "[network]\nmode = \"wifi\"\naccess_point = [\"3 m\", \"0 m\"]\n"
                                   "[network.wifi]\n{}\n[[host]]\nname = \"manager\"\nprogram = [\"{}\"]\n",
                                   duration, wifi, PUCKLOOP_NETMANAGER);
    for (int i = 0; i < robots; ++i)
        text +=
            fmt::format("[[robot]]\nposition = [\"{} cm\", \"0 cm\"]\n[robot.pic]\nfirmware = \"network\"\n"
                        "selector = 10\n[robot.linux]\nprogram = [\"{}\", \"--server\", \"manager:7700\"]\n",
                        30 * i - 40, PUCKLOOP_FORWARD);
    return text;
}

std::size_t occurrences(const std::string& text, const std::string& what) {
    std::size_t found = 0;
    for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1))
        ++found;
    return found;
}

/// What tshark prints of a file: one line for each packet that the filter lets through.
std::string tshark(const Workbench& bench, const fs::path& file, const std::string& filter,
                   const Words& fields) {
    Words words{"tshark",
                "-r",
                file.string(),
                "-Y",
                filter,
                "-T",
                "fields",
                "-o",
                "wlan.check_checksum:TRUE",
                "-o",
                "ip.check_checksum:TRUE"};
    for (const std::string& field : fields)
        words.insert(words.end(), {"-e", field});
    Process process(words, bench.folder());
    const Ended read = process.wait(60.0);
    INFO(read.err);
    CHECK(read.status == 0);
    return read.out;
}

}  // namespace

TEST_CASE("robots wander, say hello to all and answer who asks them by number", "[network][team]") {
    const Workbench bench;
    const std::string python = fs::exists("/usr/bin/python3") ? "/usr/bin/python3" : "python3";
    const std::string text =
        team(3, "8 s") + fmt::format("[[host]]\nname = \"asker\"\nprogram = [\"{}\", \"-B\", \"-S\", \"-E\", "
                                     "\"{}/tests/network/programs/asker.py\"]\n",
                                     python, PUCKLOOP_SOURCE);
    const auto file = bench.file("team.toml", text);
    for (const auto& [run, words] : {std::pair{"here", Words{"--in-process"}},
                                     {"apart", Words{}},
                                     {"two", Words{"--in-process", "--threads", "2"}}}) {
        Words all{file.string()};
        all.insert(all.end(), words.begin(), words.end());
        const Ended ended = bench.run(run, all);
        INFO(ended.err);
        REQUIRE(ended.status == 0);
    }
    check_same_run(bench, "here", "apart");
    check_same_run(bench, "here", "two");
    CHECK(text_of(bench.out("here") / "asker.linux.log") == "1 !one\n2 !two\n");
    CHECK(journey(bench.csv("here", "trajectory.csv")).length > 0.1);
    const std::string log = text_of(bench.out("here") / "robot0.pic.log");
    INFO(log);
    CHECK(occurrences(log, "led0 on") >= 1);  // it heard others
}

TEST_CASE("a receive call of the network firmware gives up after 3 s", "[network][team]") {
    const Workbench bench;
    const auto file = bench.file("alone.toml", team(1, "11 s"));
    const Ended ended = bench.run("alone", {file, "--in-process"});
    INFO(ended.err);
    REQUIRE(ended.status == 0);
    // It walks from its first receive call on, and nobody else is there.
    double walks = -1, lit = -1;
    for (const auto& row : bench.csv("alone", "trace.csv")) {
        if (row.at("kind") != "signal") continue;
        if (walks < 0 && row.at("detail").starts_with("wheel_")) walks = std::stod(row.at("time_s"));
        if (lit < 0 && row.at("detail") == "led_body") lit = std::stod(row.at("time_s"));
    }
    REQUIRE(walks > 2);
    CHECK(lit - walks == Approx(3.0).margin(0.01));
    CHECK(text_of(bench.out("alone") / "robot0.pic.log").find("led_body off") == std::string::npos);
}

TEST_CASE("at a selector below 10 packets go by Bluetooth, to the number that a name has",
          "[bluetooth][team]") {
    const Workbench bench;
    std::string text = "[run]\nduration = \"36 s\"\n[arena]\nsize = [\"60 cm\", \"60 cm\"]\n";
    for (int i = 0; i < 2; ++i)
        text +=
            fmt::format("[[robot]]\nposition = [\"{} cm\", \"0 cm\"]\n[robot.pic]\nfirmware = \"network\"\n"
                        "selector = {}\nuart2 = \"script:/dev/null\"\n[robot.pic.bluetooth]\nnumber = {}\n",
                        20 * i - 10, i, 2101 + i);
    const Ended ended = bench.run("air", {bench.file("air.toml", text), "--in-process"});
    INFO(ended.err);
    REQUIRE(ended.status == 0);
    const std::string one = text_of(bench.out("air") / "robot0.uart2.received"),
                      two = text_of(bench.out("air") / "robot1.uart2.received");
    INFO(one << two);
    CHECK(occurrences(one, "sent 2102") + occurrences(two, "sent 2101") >= 1);
    CHECK(occurrences(two, "heard 2101 hello 0000") == occurrences(one, "sent 2102"));
    CHECK(occurrences(one, "heard 2102 hello 0000") == occurrences(two, "sent 2101"));
}

TEST_CASE("a monitor's capture of the radio is what tshark reads without complaint", "[network][team]") {
    const Workbench bench;
    for (const std::string standard : {"g", "b"}) {
        const auto file = bench.file(
            "captured.toml", team(2, "7 s", fmt::format("standard = \"{}\"\ncapture = true", standard)));
        const Ended ended = bench.run("o" + standard, {file, "--in-process"});
        INFO(ended.err);
        REQUIRE(ended.status == 0);
        const fs::path capture = bench.out("o" + standard) / "wifi.pcapng";
        REQUIRE(fs::exists(capture));
        const auto network = bench.report("o" + standard)["nodes"]["network"];
        const std::size_t frames = network["access_point"]["frames"].get<std::size_t>() +
                                   network["stations"]["robot0"]["radio"]["frames"].get<std::size_t>() +
                                   network["stations"]["robot1"]["radio"]["frames"].get<std::size_t>();
        if (!fs::exists("/usr/bin/tshark")) {
            WARN("there is no tshark: skipped");
            return;
        }
        CHECK(occurrences(tshark(bench, capture, "radiotap and wlan", {"frame.number"}), "\n") == frames);
        CHECK(tshark(bench, capture,
                     "_ws.malformed or _ws.expert.severity >= 6291456 or wlan.fcs.status == 0 or "
                     "ip.checksum.status == 0",
                     {"frame.number"})
                  .empty());
        // A robot's packet goes to the manager in the pieces in which its bytes came from UART2.
        CHECK(tshark(bench, capture, "tcp.len > 0 and wlan.fc.tods == 1", {"wlan.sa"})
                  .find("02:00:0a:00:00:0") == 0);
        CHECK(tshark(bench, capture, "tcp contains \"hello\" and wlan.fc.fromds == 1", {"wlan.sa"})
                  .find("02:00:0a:00:00:fe") == 0);
        CHECK(tshark(bench, capture, "wlan.fc.type_subtype == 0x1d", {"frame.len"}).find("37\n") == 0);
    }
    const auto file = bench.file("plain.toml", team(1, "1 s"));
    REQUIRE(bench.run("plain", {file, "--in-process"}).status == 0);
    CHECK_FALSE(fs::exists(bench.out("plain") / "wifi.pcapng"));
}
