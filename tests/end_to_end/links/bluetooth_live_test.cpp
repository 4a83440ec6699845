// The computer at a Bluetooth module as a program outside meets it, through a pty or a TCP port of a run by
// the wall clock: bytes pass both ways, and each way of leaving it has one outcome. Programs uploaded through
// live lines, by the boot loader.

#include "tests/end_to_end/kit/live_line.h"
#include "tests/end_to_end/kit/load.h"
#include "tests/end_to_end/kit/one_line.h"
#include "tests/end_to_end/kit/upload_scene.h"
#include "tests/end_to_end/kit/workbench.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <map>
#include <thread>

using namespace puckloop::tests;
using Catch::Matchers::Contains;
using Kind = LiveLine::Kind;

namespace {

constexpr double kByteRate = 115200 / 10.0;
/// s of wall time until something that must come has not come: a machine with much other work is slow.
constexpr double kPatience = 120.0;

/// One robot that answers "yes\n" to each line by Bluetooth and writes at UART2 what it heard.
std::string talking_robot(const std::string& computer) {
    return fmt::format(R"([run]
duration = "120 s"
[arena]
size = ["1 m", "1 m"]
[bluetooth]
link_time = ["300 ms", "10 ms"]
[[robot]]
name = "a"
position = ["0 m", "0 m"]
[robot.pic]
firmware = "{}/firmware/bluetooth/talk.hex"
uart2 = "script:/dev/null"
[robot.pic.bluetooth]
computer = "{}"
)",
                       PUCKLOOP_SOURCE, computer);
}

/// `puckloop run --paced` of it.
struct Run {
    Workbench bench;
    std::unique_ptr<Process> process;

    explicit Run(const std::string& scenario) {
        const auto file = bench.file("live.toml", scenario);
        process = bench.start({"run", "--out", bench.out("o"), "--paced", file});
    }
    std::string place(const std::string& end) const { return place_of(bench.folder() / "stderr", end); }
    std::string received(const std::string& end) const {
        return text_of(bench.out("o") / (end + ".received"));
    }
    /// Waits until what came at `end` has this in it.
    bool heard(const std::string& end, const std::string& text) const {
        for (const double until = wall_seconds() + kPatience; wall_seconds() < until;) {
            if (received(end).find(text) != std::string::npos) return true;
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
        return false;
    }
    /// Ends it as its user does; nothing else may have gone wrong.
    nlohmann::json end() {
        process->signal(SIGINT);
        const Ended ended = process->wait();
        INFO(ended.err);
        CHECK(ended.status == 128 + SIGINT);
        CHECK_THAT(ended.err, Contains("interrupted (SIGINT)"));
        return bench.report("o");
    }
};

/// `puckloop upload` to a line of the run, the robot's reset button pressed while it asks. On a busy machine
/// the run stands still and then hurries after the wall clock: the boot loader, which waits a simulated
/// second for a byte, has then left, and there is another try after the next reset.
Ended upload(const Run& run, const std::string& end, const std::string& robot) {
    constexpr int kTries = 12;
    const auto folder = run.bench.folder() / robot, act = folder / "act";  // what each prints
    std::filesystem::create_directories(act);
    Ended ended;
    for (int attempt = 0; attempt < kTries; ++attempt) {
        Process process({PUCKLOOP_PROGRAM, "upload", PUCKLOOP_SOURCE "/firmware/bluetooth/talk.hex",
                         run.place(end), "--wait", "10"},
                        folder);
        Process button({PUCKLOOP_PROGRAM, "act", run.bench.out("o").string(), "reset " + robot}, act);
        const Ended pressed = button.wait();
        INFO(pressed.err << "the run: " << text_of(run.bench.folder() / "stderr"));
        REQUIRE(pressed.status == 0);
        ended = process.wait();
        if (!ended.err.ends_with("was not taken\n") && ended.err.find("no boot loader") == std::string::npos)
            break;
    }
    return ended;
}

/// What the flash of either robot holds ("cable", "air") after an upload at times of its own.
std::map<std::string, std::string> uploaded_by_script(const UploadImages& images) {
    const Workbench bench;
    for (const auto& [file, at] : {std::pair{"cable.txt", "0.6"}, {"air.txt", "40.3"}}) {
        const std::string path = (bench.folder() / file).string();
        const Ended made = bench.puckloop(
            {"upload", PUCKLOOP_SOURCE "/firmware/bluetooth/talk.hex", "--script", path, "--at", at});
        INFO(made.err);
        REQUIRE(made.status == 0);
    }
    const auto scene = bench.file("script.toml", scenario_of({.run = "seed = 4\nduration = \"45 s\"",
                                                              .cable = "script:cable.txt",
                                                              .computer = "script:air.txt",
                                                              .air = "reset = [\"40 s\"]\nnvm = \"air.nvm\"",
                                                              .by_cable = "nvm = \"cable.nvm\""},
                                                             images));
    const Ended ended = bench.run("o", {scene, "--in-process"});
    INFO(ended.err);
    REQUIRE(ended.status == 0);
    return {{"cable", text_of(bench.folder() / "cable.nvm")}, {"air", text_of(bench.folder() / "air.nvm")}};
}

}  // namespace

TEST_CASE("a computer's script is sent to the robot by Bluetooth, and its answers are in a file",
          "[bluetooth]") {
    const Workbench bench;
    // The first waits for the link.
    bench.file("ask.txt", "1.0 61 62 0a\n14.0 63 0a\n");
    const auto file = bench.file("script.toml", talking_robot("script:ask.txt"));
    for (const Words& placement : {Words{}, Words{"--in-process"}}) {
        Words words{file, "--duration", "15"};
        words.insert(words.end(), placement.begin(), placement.end());
        const Ended ended = bench.run("o", words);
        INFO(ended.err);
        REQUIRE(ended.status == 0);
        CHECK(text_of(bench.out("o") / "a.computer.received") == "yes\nyes\n");
        CHECK(text_of(bench.out("o") / "a.uart2.received") == "linked\r\nheard ab\r\nheard c\r\n");
    }
    const auto none = bench.file("none.toml", talking_robot("script:nowhere.txt"));
    check_one_line(bench.run("none", {none}), 2, {"nowhere.txt"});
}

TEST_CASE("a program at the computer's pty talks with the robot, leaves, and comes again", "[bluetooth]") {
    if (!has_ptys()) return;
    Run run(talking_robot("pty"));
    const std::string name = run.place("a.computer");
    struct stat entry {};
    REQUIRE(::stat(name.c_str(), &entry) == 0);
    CHECK((entry.st_mode & 0777) == 0600);  // nobody else's program speaks to the robot
    {
        const LiveLine program(Kind::Pty, name);
        program.send("one\n");
        CHECK(program.read_until("yes\n") == "yes\n");
        program.send("two\n");
    }
    // What nobody has it open for is lost, as at a serial port, and the link stays.
    CHECK(run.heard("a.computer", "yes\nyes\n"));
    const LiveLine program(Kind::Pty, name);
    program.send("three\n");
    CHECK(program.read_until("yes\n") == "yes\n");
    const auto report = run.end();
    CHECK(run.received("a.computer") == "yes\nyes\nyes\n");
    CHECK(run.received("a.uart2") == "linked\r\nheard one\r\nheard two\r\nheard three\r\n");
    CHECK(report["nodes"]["bluetooth"]["links"] == 1);
    CHECK(report["nodes"]["bluetooth"]["lost"] == 0);
}

TEST_CASE("clients of the computer's TCP port: one at a time, however the last one left", "[bluetooth]") {
    Run run(talking_robot("tcp:0"));
    const std::string port = run.place("a.computer");
    LiveLine first(Kind::Tcp, port);
    first.send("one\n");
    CHECK(first.read_until("yes\n") == "yes\n");
    const LiveLine second(Kind::Tcp, port);
    CHECK(second.hung_up());
    first.send("two\n");
    CHECK(first.read_until("yes\n") == "yes\n");
    first.reset();
    {
        const LiveLine third(Kind::Tcp, port);
        third.send("three\n");
        CHECK(third.read_until("yes\n") == "yes\n");
    }
    const LiveLine fourth(Kind::Tcp, port);
    fourth.send("four\n");
    CHECK(fourth.read_until("yes\n") == "yes\n");
    const auto report = run.end();
    CHECK(fourth.hung_up());
    CHECK(run.received("a.uart2") == "linked\r\nheard one\r\nheard two\r\nheard three\r\nheard four\r\n");
    CHECK(report["nodes"]["a.computer"]["sent"] == 4 + 4 + 6 + 5);
    CHECK(report["nodes"]["bluetooth"]["links"] == 1);
}

TEST_CASE("a client that floods the robot waits, and the run goes on at its pace", "[bluetooth]") {
    Run run(talking_robot("tcp:0"));
    const LiveLine client(Kind::Tcp, run.place("a.computer"));
    client.send("one\n");
    CHECK(client.read_until("yes\n") == "yes\n");
    // The system's buffers take a few megabytes, the line 11 kB a second: the rest stays with the client.
    constexpr std::size_t kMost = 64 << 20;
    const std::size_t taken = client.flood(std::string(4096, 'x'), kMost);
    CHECK(taken < kMost / 2);
    CHECK(run.heard("a.uart2", "heard " + std::string(2000, 'x')));
    const auto report = run.end();
    const double sent = report["nodes"]["a.computer"]["sent"].get<double>();
    CHECK(sent > 1000);
    CHECK(sent <= kByteRate * report["simulated_s"].get<double>());
    CHECK(sent < static_cast<double>(taken));
}

TEST_CASE("answers that the computer does not read are lost, and the run's report counts them",
          "[bluetooth]") {
    if (!has_ptys()) return;
    Run run(talking_robot("pty"));
    const LiveLine program(Kind::Pty, run.place("a.computer"));
    program.send("one\n");
    CHECK(program.read_until("yes\n") == "yes\n");
    // 72 kB of answers; the terminal keeps 12 to 21, by how they come in. The robot's own buffer holds 512
    // bytes.
    constexpr std::size_t kBursts = 45, kLines = 400;
    for (std::size_t burst = 1; burst <= kBursts; ++burst) {
        program.send(std::string(kLines, '\n'));
        const std::size_t answers = 4 * (1 + kLines * burst);
        for (const double until = wall_seconds() + kPatience;
             wall_seconds() < until && run.received("a.computer").size() < answers;)
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        REQUIRE(run.received("a.computer").size() == answers);
    }
    // A run that stood still hurries after the wall clock, while bytes leave for the terminal at the line's
    // rate: what is on its way cannot be known from outside. It is there, or is lost, once the run is over,
    // and the terminal is then gone with what it held. What adds up to the last byte is tested where it can
    // be waited for (tests/exec/live_end_test.cpp); here nobody reads any more.
    run.process->signal(SIGINT);
    const Ended ended = run.process->wait();
    CHECK_THAT(ended.err, Contains("a.computer: the program at pty ") && Contains(" does not read"));
    const auto report = run.bench.report("o");
    const auto& node = report["nodes"]["a.computer"];
    const auto received = node["received"].get<std::size_t>(), unread = node["unread"].get<std::size_t>();
    CHECK(received == 4 * (1 + kLines * kBursts));
    CHECK(unread > 0);
    // All but what the program read first and what the terminal held.
    constexpr std::size_t kTerminalMost = 60'000, kTerminalLeast = 4000;
    CHECK(unread <= received - 4 - kTerminalLeast);
    CHECK(unread + 4 + kTerminalMost >= received);
    CHECK_THAT(report["warnings"].dump(), Contains("did not read them"));
}

TEST_CASE("a computer's TCP port that is taken ends the run before it begins, named", "[bluetooth]") {
    const int other = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in here{};
    here.sin_family = AF_INET;
    here.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof here;
    REQUIRE(::bind(other, reinterpret_cast<const sockaddr*>(&here), size) == 0);
    REQUIRE(::listen(other, 1) == 0);
    REQUIRE(::getsockname(other, reinterpret_cast<sockaddr*>(&here), &size) == 0);
    const std::string end = fmt::format("tcp:{}", ntohs(here.sin_port));
    const Workbench bench;
    const auto file = bench.file("taken.toml", talking_robot(end));
    for (const Words& placement : {Words{}, Words{"--in-process"}}) {
        Words words{file, "--paced"};
        words.insert(words.end(), placement.begin(), placement.end());
        check_one_line(bench.run("o", words), 2, {"a.computer", end, "a free port"});
    }
    ::close(other);
}

TEST_CASE("an upload to a line whose run is killed reports that the other end is gone", "[bluetooth]") {
    if (!has_ptys()) return;
    Run run(talking_robot("pty"));
    const std::string name = run.place("a.computer");
    const auto folder = run.bench.folder() / "upload";
    std::filesystem::create_directory(folder);
    // The robot's program is no boot loader: it is asked until somebody answers.
    Process upload({PUCKLOOP_PROGRAM, "upload", PUCKLOOP_SOURCE "/firmware/bluetooth/talk.hex", name},
                   folder);
    CHECK(run.heard("a.uart2", "heard"));
    const auto nodes = run.process->children();
    run.process->signal(SIGKILL);
    run.process->wait();
    check_one_line(upload.wait(), 1, {name, "the other end is gone"});
    CHECK(all_end(nodes));
}

namespace {

void upload_through_live_lines() {
    const auto images = upload_images();
    if (!images) return;
    const std::map<std::string, std::string> expected = uploaded_by_script(*images);
    Run run(scenario_of({.run = "duration = \"3600 s\"",
                         .cable = "pty",
                         .computer = "pty",
                         .air = "nvm = \"air.nvm\"",
                         .by_cable = "nvm = \"cable.nvm\"",
                         .tables = "[bluetooth]\nlink_time = [\"300 ms\", \"10 ms\"]"},
                        *images));
    for (const auto& [end, robot] : {std::pair{"cable.uart1", "cable"}, {"air.computer", "air"}}) {
        const Ended ended = upload(run, end, robot);
        INFO(ended.err);
        REQUIRE(ended.status == 0);
        CHECK_THAT(ended.out, Contains(" rows, and the program starts\n"));
        CHECK(std::stoul(ended.out) > 20);
        // The new program runs: it answers.
        const LiveLine program(Kind::Pty, run.place(end));
        std::string answer;
        for (const double until = wall_seconds() + kPatience;
             wall_seconds() < until && !answer.ends_with("yes\n");) {
            program.send("hi\n");
            answer += program.read_until("yes\n", 1.0);
        }
        CHECK(answer.ends_with("yes\n"));
        CHECK(run.heard(std::string(robot) + ".uart2", "heard hi\r\n"));
    }
    run.end();
    // Whatever hellos and answers met on the way: the flash is, word for word, that of an upload by script.
    for (const auto& [robot, flash] : expected) {
        INFO(robot);
        CHECK(text_of(run.bench.folder() / (robot + ".nvm")) == flash);
    }
}

}  // namespace

TEST_CASE("programs are uploaded through live lines, on a cable and over the air", "[bluetooth]") {
    if (has_ptys()) upload_through_live_lines();
}

// Where the run stands still and hurries, hellos come together and answers late.
TEST_CASE("programs are uploaded beside much other work", "[.sweep]") {
    if (!has_ptys()) return;
    for (int round = 0; round < 5; ++round) {
        INFO("round " << round);
        const Load load(8);
        upload_through_live_lines();
    }
}
