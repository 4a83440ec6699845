// Bluetooth in a run: robots that talk by the project's own firmware, the same in every placement; the e-puck
// library's images; programs uploaded on a cable and over the air.

#include "tests/end_to_end/kit/same_run.h"
#include "tests/end_to_end/kit/upload_scene.h"
#include "tests/end_to_end/kit/workbench.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <sstream>

using namespace puckloop::tests;

namespace {

std::string received(const Workbench& bench, const std::string& run, const std::string& name) {
    std::ifstream in(bench.out(run) / (name + ".received"), std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

std::vector<std::string> air(const Workbench& bench, const std::string& run) {
    std::vector<std::string> rows;
    for (const Row& row : bench.csv(run, "bluetooth.csv"))
        rows.push_back(fmt::format("{} {} {}", row.at("who"), row.at("what"), row.at("whom")));
    return rows;
}

}  // namespace

TEST_CASE("two robots talk by Bluetooth, the same in every placement and thread count", "[bluetooth]") {
    const Workbench bench;
    const std::vector<Words> ways{
        {}, {"--in-process"}, {"--in-process", "--threads", "2"}, {"--in-process", "--threads", "4"}};
    for (std::size_t i = 0; i < ways.size(); ++i) {
        Words words{PUCKLOOP_SOURCE "/scenarios/bluetooth.toml", "--duration", "30"};
        words.insert(words.end(), ways[i].begin(), ways[i].end());
        const Ended ended = bench.run(fmt::format("o{}", i), words);
        INFO(ended.err);
        REQUIRE(ended.status == 0);
        if (i > 0) check_same_run(bench, "o0", fmt::format("o{}", i));
    }
    CHECK(air(bench, "o0") == std::vector<std::string>{"caller found listener", "caller inquiry over ",
                                                       "caller named listener", "caller linked listener",
                                                       "caller released listener",
                                                       "listener released caller"});
    const std::string caller = received(bench, "o0", "caller.uart2");
    CHECK(caller.starts_with("named e-puck_1234 in "));
    CHECK(caller.find("\r\nanswered\r\n") != std::string::npos);
    CHECK(caller.find("\r\nexchange ") != std::string::npos);
    CHECK(received(bench, "o0", "listener.uart2") == "linked\r\nheard I hear you\r\nreleased\r\n");
    const auto report = bench.report("o0")["nodes"]["bluetooth"];
    CHECK(report["links"] == 1);
    CHECK(report["bytes"] == 15);  // "I hear you\n" there, "yes\n" back
    CHECK(report["bytes_lost"] == 0);
    CHECK(report["warnings"].empty());
    // The packets of a whole exchange, by name, from the trace.
    const Ended decoded =
        bench.puckloop({"trace", "decode", bench.out("o0").string(), "--protocol", "bluetooth"});
    REQUIRE(decoded.status == 0);
    for (const char* text :
         {"caller.pic bluetooth: REQ GAP_INQUIRY 5 10 0",
          "bluetooth bluetooth: IND GAP_DEVICE_FOUND 08:00:17:2C:04:D2",
          "CFM GAP_REMOTE_DEVICE_NAME OK 08:00:17:2C:04:D2 \"e-puck_1234\"", "IND SPP_LINK_ESTABLISHED OK",
          "listener.bluetooth bluetooth bluetooth: IND SPP_INCOMING_LINK_ESTABLISHED 08:00:17:2C:00:01 "
          "port=1",
          "CFM SPP_TRANSPARENT_MODE OK port=1", "IND SPP_LINK_RELEASED 0 port=1"})
        CHECK(decoded.out.find(text) != std::string::npos);
}

TEST_CASE("the e-puck library's images: one robot finds the other and leads it", "[bluetooth]") {
    const auto leader = outside("PUCKLOOP_IMAGES", "bluetoot_mirror.hex");
    const auto follower = outside("PUCKLOOP_IMAGES", "BTcom_default.hex");
    if (!leader || !follower) {
        WARN("PUCKLOOP_IMAGES has no bluetoot_mirror.hex or BTcom_default.hex: skipped");
        return;
    }
    const Workbench bench;
    const auto file = bench.file("mirror.toml", fmt::format(R"([run]
seed = 1
duration = "30 s"
[arena]
size = ["2 m", "2 m"]
[[robot]]
name = "a"
position = ["-40 cm", "0 cm"]
[robot.pic]
firmware = "{}"
selector = 1
[robot.pic.bluetooth]
number = 1001
[[robot]]
name = "b"
position = ["40 cm", "0 cm"]
[robot.pic]
firmware = "{}"
[robot.pic.bluetooth]
number = 2002
)",
                                                            leader->string(), follower->string()));
    const Ended ended = bench.run("o", {file, "--in-process"});
    INFO(ended.err);
    REQUIRE(ended.status == 0);
    CHECK(air(bench, "o") ==
          std::vector<std::string>{"a found b", "a inquiry over ", "a named b", "a linked b"});
    // Both drive, at 200 steps/s where nothing is near.
    const auto report = bench.report("o")["nodes"];
    CHECK(report["a.pic"]["wheel_steps"]["left"].get<double>() > 200);
    CHECK(report["b.pic"]["wheel_steps"]["left"].get<double>() > 200);
}

TEST_CASE("programs are uploaded by the boot loader, on a cable and over the air", "[bluetooth]") {
    const auto images = upload_images();
    if (!images) return;
    const Workbench bench;
    const std::string image = PUCKLOOP_SOURCE "/firmware/bluetooth/talk.hex";
    const auto script = [&](const char* name, const char* at, const std::string& more) {
        const std::string path = (bench.folder() / name).string();
        const Ended made = bench.puckloop({"upload", image, "--script", path, "--at", at});
        INFO(made.err);
        REQUIRE(made.status == 0);
        std::ofstream(path, std::ios::app) << more;
        return std::stoul(made.out);  // "41 rows, ..."
    };
    // Once the program runs it is said "hi\n".
    const std::size_t rows = script("cable.txt", "0.6", "8.0 68 69 0a\n");
    CHECK(rows > 20);
    CHECK(script("air.txt", "40.3", "50.0 68 69 0a\n") == rows);
    const UploadScene scene{.run = "seed = 4\nduration = \"52 s\"",
                            .cable = "script:cable.txt",
                            .computer = "script:air.txt",
                            .air = "reset = [\"40 s\"]"};
    const auto file = bench.file("upload.toml", scenario_of(scene, *images));
    const Ended ended = bench.run("o", {file, "--in-process"});
    INFO(ended.err);
    REQUIRE(ended.status == 0);
    // The boot loader's chip, a K for itself and one for each row, then what the new program answers.
    const std::string taken = "q" + std::string(rows + 1, 'K') + "yes\n";
    CHECK(received(bench, "o", "cable.uart1") == taken);
    const std::string over_the_air = received(bench, "o", "air.computer");
    CHECK(over_the_air.ends_with(taken));
    CHECK(received(bench, "o", "cable.uart2") == "heard hi\r\n");
    CHECK(received(bench, "o", "air.uart2").ends_with("heard hi\r\n"));
}

TEST_CASE("what is wrong in a scenario or an upload is refused with its place", "[bluetooth]") {
    const Workbench bench;
    const auto refused = [&](const std::string& tables) {
        const auto file =
            bench.file("bad.toml", "[run]\nduration = \"1 s\"\n[arena]\nsize = [\"1 m\", \"1 m\"]\n"
                                   "[[robot]]\nposition = [\"0 m\", \"0 m\"]\n[robot.pic]\n"
                                   "firmware = \"" PUCKLOOP_SOURCE "/firmware/bluetooth/talk.hex\"\n" +
                                       tables);
        const Ended ended = bench.run("o", {file});
        CHECK(ended.status == 2);
        CHECK(std::count(ended.err.begin(), ended.err.end(), '\n') == 1);
        return ended.err;
    };
    CHECK(refused("uart1 = \"pty\"\n[robot.pic.bluetooth]\n").find("UART1") != std::string::npos);
    CHECK(refused("[robot.pic.bluetooth]\nnumber = 10000\n").find("number") != std::string::npos);
    CHECK(refused("[robot.pic.bluetooth]\naddress = \"08:00:17\"\n").find("no Bluetooth address") !=
          std::string::npos);
    CHECK(refused("[robot.pic.bluetooth]\nconnect = \"1 s\"\n").find("no computer") != std::string::npos);
    CHECK(refused("[robot.pic.bluetooth]\ncomputer = \"pty\"\n").find("clock of its own") !=
          std::string::npos);
    CHECK(refused("[robot.pic.bluetooth]\npin = \"\"\n").find("pin") != std::string::npos);
    CHECK(refused("[robot.pic.bluetooth]\n[bluetooth]\nlink_time = [\"1 s\"]\n").find("link_time") !=
          std::string::npos);
    const Ended none = bench.puckloop({"upload", PUCKLOOP_SOURCE "/firmware/bluetooth/talk.hex"});
    CHECK(none.status == 2);
    const Ended rab = bench.puckloop({"upload", PUCKLOOP_SOURCE "/firmware/rab/crt0.s", "--script", "x"});
    CHECK(rab.status == 2);
    const Ended port = bench.puckloop(
        {"upload", PUCKLOOP_SOURCE "/firmware/bluetooth/talk.hex", "/dev/null", "--wait", "1"});
    CHECK(port.status == 2);
    CHECK(port.err.find("/dev/null: no serial port") != std::string::npos);
    const Ended absent =
        bench.puckloop({"upload", PUCKLOOP_SOURCE "/firmware/bluetooth/talk.hex", "/nowhere/pts"});
    CHECK(absent.status == 2);
    CHECK(absent.err.find("/nowhere/pts: cannot be opened: No such file") != std::string::npos);
}
