// A world that changes: by its scenario, and by commands from a second terminal.

#include "tests/end_to_end/kit/one_line.h"
#include "tests/end_to_end/kit/same_run.h"
#include "tests/end_to_end/kit/workbench.h"

#include <catch2/catch.hpp>

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstring>
#include <thread>

using namespace puckloop::tests;
using Catch::Contains;

namespace {

const std::string kEvents = R"(
[[cylinder]]
name = "can"
centre = ["-25 cm", "-20 cm"]
radius = "5 cm"

[[event]]
at = "2 s"
move = "can"
to = ["15 cm", "8 cm"]
over = "500 ms"

[[event]]
label = "met"
when = { robot = "robot0", near = "can", within = "8 cm" }
lift = "robot0"

[[event]]
when = { after = "met" }
delay = "400 ms"
put = "robot0"
to = ["-30 cm", "-30 cm"]
heading = "45 deg"

[[event]]
at = "4500.5 ms"
reset = "robot0"

[[event]]
when = { robot = "robot0", enters = ["59 cm", "44 cm"], radius = "1 mm" }
remove = "can"
)";

/// With a range-and-bearing board and a program that follows others; `start` in milliseconds.
std::string follower(const std::string& name, const std::string& x_y, int id, int start) {
    return "[[robot]]\nname = \"" + name + "\"\nposition = [" + x_y + "]\n" + R"([robot.pic]
firmware = ")" PUCKLOOP_SOURCE R"(/firmware/epuck/epuck.hex"
[robot.rab]
firmware = ")" PUCKLOOP_SOURCE R"(/firmware/rab/rab.hex"
[robot.linux]
program = ["puckloop-control", "--behaviour", "follow", "--duration", "30", "--rab-id", ")" +
           std::to_string(id) + "\"]\nstart = \"" + std::to_string(start) + " ms\"\n";
}

const std::string kPair = R"([run]
duration = "1200 ms"
[arena]
size = ["1.6 m", "1.2 m"]
)" + follower("a", R"("10 cm", "0 cm")", 1, 200) +
                          follower("b", R"("-20 cm", "5 cm")", 2, 207) + R"(
[[event]]
at = "600 ms"
add = "wall"
name = "screen"
from = ["-5 cm", "-30 cm"]
to = ["-5 cm", "30 cm"]
height = "30 cm"
[[event]]
at = "900.25 ms"
remove = "screen"
)";

/// One robot whose firmware runs by itself.
const std::string kAlone = R"([run]
duration = "60 s"
[arena]
size = ["1.2 m", "90 cm"]
[[cylinder]]
name = "can"
centre = ["20 cm", "0 cm"]
radius = "5 cm"
[[robot]]
position = ["0 cm", "0 cm"]
[robot.pic]
firmware = ")" PUCKLOOP_SOURCE R"(/firmware/epuck/epuck.hex"
)";

nlohmann::json json_of(const std::filesystem::path& file) {
    return nlohmann::json::parse(text_of(file), nullptr, false);
}

/// Waits until a run takes commands.
std::filesystem::path socket_of(const Workbench& bench, const std::string& name) {
    for (int i = 0; i < 1500; ++i) {
        const auto note = std::filesystem::exists(bench.out(name) / "control.json")
                              ? json_of(bench.out(name) / "control.json")
                              : nlohmann::json();
        if (note.is_object() && note.contains("socket") && std::filesystem::exists(note["socket"]))
            return note["socket"].get<std::string>();
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    FAIL("the run takes no commands");
    return {};
}

int mode_of(const std::filesystem::path& file) {
    struct stat info {};
    return ::stat(file.c_str(), &info) == 0 ? static_cast<int>(info.st_mode & 0777) : -1;
}

void send_and_leave(const std::filesystem::path& socket, const std::string& text) {
    const int descriptor = ::socket(AF_UNIX, SOCK_STREAM, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, socket.c_str(), sizeof address.sun_path - 1);
    CHECK(::connect(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
    ::send(descriptor, text.data(), text.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    ::close(descriptor);
}

/// Lets a paced run go on until `commands` were carried out, then stops it; its fingerprint must be that of
/// its record.
void check_replay(const Workbench& bench, const std::filesystem::path& scenario, const std::string& pace,
                  const Words& commands) {
    const std::string out = bench.out("live").string();
    const auto live = bench.start({"run", scenario.string(), pace, "--duration", "6", "--out", out});
    const auto socket = socket_of(bench, "live");
    CHECK(mode_of(socket) == 0600);
    CHECK(mode_of(socket.parent_path()) == 0700);
    for (const std::string& command : commands) {
        const Ended act = bench.puckloop({"act", out, command});
        INFO(command);
        CHECK(act.err == "");
        CHECK(act.status == 0);
        CHECK_THAT(act.out, Contains(" s: " + command));
    }
    CHECK(live->wait().status == 0);
    CHECK_FALSE(std::filesystem::exists(socket.parent_path()));
    REQUIRE(
        bench.run("again", {scenario.string(), "--events", out + "/events.toml", "--duration", "6"}).status ==
        0);
    CHECK(bench.report("live").at("trace_sha256") == bench.report("again").at("trace_sha256"));
    CHECK(text_of(bench.out("live") / "trajectory.csv") == text_of(bench.out("again") / "trajectory.csv"));
    CHECK(bench.report("live").at("events").size() == commands.size());
}

}  // namespace

TEST_CASE("events are carried out, reported, and the same however the run is placed") {
    const Workbench bench;
    const std::string scenario = bench.hello(kEvents).string();
    REQUIRE(bench.run("apart", {scenario, "--duration", "6"}).status == 0);
    REQUIRE(bench.run("together", {scenario, "--duration", "6", "--in-process"}).status == 0);
    check_same_run(bench, "apart", "together");
    const auto report = bench.report("apart");
    const auto events = report.at("events");
    REQUIRE(events.size() == 4);
    CHECK(events[0].at("action") == "move can to 15 cm, 8 cm over 500 ms");
    CHECK(events[0].at("at_s") == 2.0);
    CHECK(events[1].at("event") == "met");
    const double met = events[1].at("at_s");
    CHECK(events[2].at("action") == "put robot0 to -30 cm, -30 cm heading 45 deg");
    CHECK(events[2].at("at_s").get<double>() == Approx(met + 0.4));
    CHECK(events[3].at("at_s") == 4.5005);
    CHECK_THAT(report.at("warnings").dump(),
               Contains("event 5") && Contains("never happened: its condition never came true"));
    CHECK(report.at("nodes").at("robot0.pic").at("resets").size() == 2);
    CHECK_THAT(text_of(bench.out("apart") / "world.log"), Contains("lift robot0"));
    // The record of what happened, conditions included, as times.
    const std::string record = (bench.out("apart") / "events.toml").string();
    REQUIRE(bench.run("again", {scenario, "--duration", "6", "--events", record}).status == 0);
    CHECK(bench.report("again").at("trace_sha256") == report.at("trace_sha256"));
    CHECK(text_of(bench.out("again") / "events.toml") == text_of(record));
}

TEST_CASE("a screen between two boards silences them, in every placement alike") {
    const Workbench bench;
    const std::string scenario = bench.file("pair.toml", kPair).string();
    REQUIRE(bench.run("apart", {scenario}).status == 0);
    REQUIRE(bench.run("together", {scenario, "--in-process"}).status == 0);
    REQUIRE(bench.run("threads", {scenario, "--in-process", "--threads", "3"}).status == 0);
    check_same_run(bench, "apart", "together");
    check_same_run(bench, "apart", "threads");
    int before = 0, behind = 0, after = 0, frames_behind = 0;
    for (const auto& row : bench.csv("apart", "ir.csv")) {
        const double t = std::stod(row.at("t_s"));
        const int heard = row.at("heard") == "1" ? 1 : 0;
        if (t < 0.59) before += heard;
        if (t > 0.61 && t < 0.89) {
            behind += heard;
            ++frames_behind;
        }
        if (t > 0.91) after += heard;
    }
    CHECK(before > 0);
    CHECK(frames_behind > 0);
    CHECK(behind == 0);
    CHECK(after > 0);
}

TEST_CASE("a run that could take commands and gets none is as any other") {
    const Workbench bench;
    const std::string quiet = kPair.substr(0, kPair.find("[[event]]"));
    const std::string scenario = bench.file("quiet.toml", quiet).string();
    REQUIRE(bench.run("plain", {scenario, "--in-process"}).status == 0);
    REQUIRE(bench.run("paced", {scenario, "--in-process", "--paced"}).status == 0);
    CHECK(bench.report("plain").at("trace_sha256") == bench.report("paced").at("trace_sha256"));
}

TEST_CASE("commands from a second terminal are carried out, and their record repeats the run") {
    const Words commands{"move can to 30 cm, 20 cm over 1 s",
                         "add box name crate centre 6 cm, 0 cm size 4 cm, 4 cm, 9 cm",
                         "lift robot0",
                         "put robot0 to -20 cm, 10 cm heading 90 deg",
                         "select robot0 position 7",
                         "set light ambient 4",
                         "reset robot0",
                         "remote all key 5 address 8",
                         "remove crate"};
    SECTION("boards and world by the wall clock") {
        const Workbench bench;
        check_replay(bench, bench.file("alone.toml", kAlone), "--realtime", commands);
    }
    SECTION("with a Linux program in simulated time") {
        const Workbench bench;
        Words some = commands;
        some[0] = "lift robot0";
        some[2] = "set floor grey 0.2";
        some[4] = "move robot0 by 1 cm, 1 cm over 300 ms";
        check_replay(bench, bench.hello(), "--paced", some);
    }
}

TEST_CASE("a command that cannot be carried out is one line, and so is a run that takes none") {
    const Workbench bench;
    const std::string scenario = bench.file("alone.toml", kAlone).string();
    const std::string out = bench.out("live").string();
    const auto live = bench.start({"run", scenario, "--paced", "--out", out});
    const auto socket = socket_of(bench, "live");
    const auto act = [&](const std::string& command) { return bench.puckloop({"act", out, command}); };
    check_one_line(act("move cann to 1 cm, 1 cm"), 2, {"there is no 'cann' in this world", "perhaps 'can'"});
    check_one_line(act("move can to 3 m, 1 cm"), 2, {"outside the arena"});
    check_one_line(act("move can to 0 cm, 0 cm"), 2, {"is taken by 'robot0'"});
    check_one_line(act("fly robot0"), 2, {"'fly' is unknown"});
    check_one_line(act("put robot0"), 2, {"has not been lifted"});
    check_one_line(act(""), 2, {"it is empty"});
    const Ended list = act("list");
    CHECK(list.status == 0);
    // Rubbish is refused or its sender disconnected; the run goes on either way.
    for (const std::string& rubbish :
         {std::string("{}\n"), std::string("\xff\xfe\n"), std::string(200'000, 'x'),
          std::string("{\"action\":{\"verb\":99}}\n"), std::string()})
        send_and_leave(socket, rubbish);
    CHECK(act("list").status == 0);
    CHECK_THAT(list.out, Contains("cylinder     can") && Contains("robot        robot0") &&
                             Contains("move OBJECT [to X, Y"));
    live->signal(SIGINT);
    CHECK(live->wait().status == 130);
    check_one_line(act("list"), 2, {"the run has ended"});
    CHECK(bench.report("live").at("events").empty());
    REQUIRE(bench.run("fast", {scenario, "--duration", "1"}).status == 0);
    check_one_line(bench.puckloop({"act", bench.out("fast").string(), "list"}), 2,
                   {"takes no commands", "--paced"});
    check_one_line(bench.puckloop({"act", bench.out("never").string(), "list"}), 2, {"there is no such run"});
    for (const char* damaged : {R"({"ended":3})", R"({"socket":"/etc/passwd"})", "{", ""}) {
        bench.file("fast/control.json", damaged);
        check_one_line(bench.puckloop({"act", bench.out("fast").string(), "list"}), 2,
                       {"control.json", "is damaged"});
    }
}

TEST_CASE("an impossible event stops the run before it begins") {
    const Workbench bench;
    const auto refused = [&](const std::string& event, const std::string& words) {
        const std::string scenario = bench.hello("\n[[event]]\nat = \"1 s\"\n" + event).string();
        INFO(event);
        check_one_line(bench.run("bad", {scenario}), 2, {"hello.toml: line 2", words});
        CHECK_FALSE(std::filesystem::exists(bench.out("bad")));
    };
    refused("move = \"cam\"\nto = [\"0 m\", \"0 m\"]\n", "there is no 'cam'");
    refused("move = \"box 1\"\nto = [\"58 cm\", \"0 m\"]\n", "too close to the arena's wall");
    refused("move = \"robot0\"\nto = [\"1 m\", \"0 m\"]\n", "outside the arena");
    refused("select = \"robot0\"\npos = 3\n", "'position' is missing");
    refused("set = \"floor\"\ngrey = 2\n", "grey = 2 is out of range");
    const std::string scenario = bench.hello().string();
    const std::string other =
        bench.file("other.toml", "[[event]]\nat = \"1 s\"\nlift = \"robot7\"\n").string();
    check_one_line(bench.run("bad", {scenario, "--events", other}), 2,
                   {"other.toml: line 1", "there is no 'robot7'", "perhaps 'robot0'"});
    check_one_line(bench.run("bad", {scenario, "--events", "nowhere.toml"}), 2,
                   {"nowhere.toml", "cannot be opened"});
}
