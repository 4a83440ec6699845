// puckloop-coordinator as a process, at a pty: peers that answer, answer late, send garbage, flood, are dead
// or vanish. The wall clock runs here, so limits are generous.

#include "linuxboard/coordinator/event_log.h"
#include "tests/coordinator/simulated_mesh.h"
#include "tests/kit/files.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>

#include <array>
#include <chrono>
#include <csignal>
#include <fcntl.h>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <poll.h>
#include <pty.h>
#include <sys/wait.h>
#include <termios.h>
#include <unistd.h>

using namespace puckloop;
using namespace puckloop::coordinator;
using namespace puckloop::coordinator::test;

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
    return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// A pty whose other end is the program's port.
struct Pty {
    int master = -1;
    std::string port;
    Pty() {
        int slave = -1;
        std::array<char, 64> name{};
        REQUIRE(::openpty(&master, &slave, name.data(), nullptr, nullptr) == 0);
        termios raw{};
        ::tcgetattr(slave, &raw);
        ::cfmakeraw(&raw);
        ::tcsetattr(slave, TCSANOW, &raw);
        ::close(slave);
        ::fcntl(master, F_SETFD, FD_CLOEXEC);
        ::fcntl(master, F_SETFL, O_NONBLOCK);
        port = name.data();
    }
    ~Pty() { vanish(); }
    Pty(const Pty&) = delete;
    Pty& operator=(const Pty&) = delete;
    void vanish() {
        if (master >= 0) ::close(std::exchange(master, -1));
    }
};

struct Program {
    std::filesystem::path folder;
    pid_t pid = -1;
    int status = -1;
    Clock::time_point begun = Clock::now();
    double lasted = 0;

    explicit Program(std::vector<std::string> arguments, const std::string& name = "run")
        : folder(tests::scratch_path("coordinator-" + name)) {
        std::filesystem::create_directories(folder);
        arguments.insert(arguments.begin(), PUCKLOOP_COORDINATOR);
        arguments.insert(arguments.end(), {"--out", folder.string()});
        std::vector<char*> argv;
        for (std::string& argument : arguments)
            argv.push_back(argument.data());
        argv.push_back(nullptr);
        const std::string out = (folder / "stdout").string(), err = (folder / "stderr").string();
        pid = ::fork();
        if (pid == 0) {
            ::dup2(::open(out.c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0600), 1);
            ::dup2(::open(err.c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0600), 2);
            ::execv(argv[0], argv.data());
            ::_exit(127);
        }
    }
    ~Program() {
        if (pid > 0) {
            ::kill(pid, SIGKILL);
            ::waitpid(pid, nullptr, 0);
        }
        std::filesystem::remove_all(folder);
    }
    Program(const Program&) = delete;
    Program& operator=(const Program&) = delete;

    bool ended() {
        int raw = 0;
        if (pid < 0) return true;
        if (::waitpid(pid, &raw, WNOHANG) != pid) return false;
        pid = -1;
        lasted = seconds_since(begun);
        status = WIFEXITED(raw) ? WEXITSTATUS(raw) : 128 + WTERMSIG(raw);
        return true;
    }
    /// Never to anybody else: a process number of -1 would mean everybody.
    void send(int signal) {
        REQUIRE(pid > 0);
        ::kill(pid, signal);
    }
    /// Until it has ended, at most `limit` seconds.
    int wait(double limit = 30) {
        while (!ended() && seconds_since(begun) < limit)
            ::usleep(2000);
        REQUIRE(pid < 0);
        return status;
    }
    std::string error() const { return tests::text_of(folder / "stderr"); }
    std::vector<Event> events() const { return read_events((folder / "tam_events.csv").string()); }
};

/// Lets the mesh serve the pty, by the wall clock, until `done` or 30 s are over.
void serve(Pty& pty, SimulatedMesh& mesh, Clock::time_point begun, const std::function<bool()>& done) {
    std::array<std::uint8_t, 512> bytes;
    while (!done() && seconds_since(begun) < 30) {
        pollfd look{pty.master, POLLIN, 0};
        ::poll(&look, 1, 2);
        const double now = seconds_since(begun);
        const ssize_t count = ::read(pty.master, bytes.data(), bytes.size());
        for (ssize_t i = 0; i < count; ++i)
            mesh.take(bytes[static_cast<std::size_t>(i)], now);
        const std::vector<std::uint8_t> answer = mesh.give(now);
        if (!answer.empty()) CHECK(::write(pty.master, answer.data(), answer.size()) > 0);
    }
}

std::ptrdiff_t lines_of(const std::string& text) {
    return std::count(text.begin(), text.end(), '\n');
}

bool has(const std::vector<Event>& events, const std::string& tam, const std::string& event,
         const std::string& value) {
    return std::any_of(events.begin(), events.end(), [&](const Event& e) {
        return e.tam == tam && e.event == event && (value.empty() || e.value == value);
    });
}

constexpr std::uint64_t kFirst = 0x0013A200408A3100;

}  // namespace

TEST_CASE("two TAMs at a pty: discovery, a task, the end by SIGINT, LEDs off, table and picture") {
    Pty pty;
    SimulatedMesh mesh({.window = 1});
    SimulatedTam& a = mesh.add("TAM01", kFirst);
    SimulatedTam& b = mesh.add("TAM13", kFirst + 0x7E);  // with a byte that is escaped
    Program program({"--port", pty.port, "--durations", "0.3,0.3", "--dead-time", "0.2", "--seed", "3"});
    bool entered = false, asked = false;
    serve(pty, mesh, program.begun, [&] {
        const double now = seconds_since(program.begun);
        if (!entered && a.green + a.blue > 0) {
            mesh.set_robot(a, true, now);
            entered = true;
        }
        if (entered && a.robot && a.set_leds_at.size() >= 4) mesh.set_robot(a, false, now);
        if (!asked && a.set_leds_at.size() >= 5) {
            program.send(SIGINT);
            asked = true;
        }
        return program.ended();
    });
    REQUIRE(program.wait() == 0);
    CHECK(program.error() == "");
    CHECK(mesh.bad_frames == 0);
    CHECK(a.red + a.green + a.blue == 0);
    CHECK(b.red + b.green + b.blue == 0);
    const std::vector<Event> events = program.events();
    CHECK(has(events, "TAM13", "discovered", fmt::format("{:016X}", kFirst + 0x7E)));
    CHECK(has(events, "TAM01", "robot", "in"));
    CHECK(has(events, "TAM01", "task", "done"));
    CHECK(has(events, "TAM01", "robot", "out"));
    CHECK(has(events, "", "ended", "signal"));
    const std::string picture = tests::text_of(program.folder / "tam_gantt.svg");
    CHECK(picture.starts_with("<svg"));
    CHECK(picture.find("TAM13") != std::string::npos);
    CHECK(picture.find("work on") != std::string::npos);
}

TEST_CASE("a killed program leaves a table that can be read, and drawn") {
    Pty pty;
    SimulatedMesh mesh({.window = 1});
    mesh.add("TAM01", kFirst);
    Program program({"--port", pty.port});
    serve(pty, mesh, program.begun, [&] {
        std::error_code none;
        const auto size = std::filesystem::file_size(program.folder / "tam_events.csv", none);
        return !none && size > 0 && has(program.events(), "TAM01", "state", "");
    });
    program.send(SIGKILL);
    REQUIRE(program.wait() == 128 + SIGKILL);
    CHECK(has(program.events(), "TAM01", "discovered", ""));
    CHECK_FALSE(std::filesystem::exists(program.folder / "tam_gantt.svg"));
    Program drawing({"--draw", (program.folder / "tam_events.csv").string()}, "draw");
    REQUIRE(drawing.wait() == 0);
    CHECK(tests::text_of(drawing.folder / "tam_gantt.svg").find("TAM01") != std::string::npos);
}

TEST_CASE("peers that are dead, flood, or send garbage end the program with port and step") {
    Pty dead, flood, garbage;
    Program with_dead({"--port", dead.port}, "dead");
    Program with_flood({"--port", flood.port}, "flood");
    Program with_garbage({"--port", garbage.port}, "garbage");
    RandomStream random(4, "garbage");
    std::vector<std::uint8_t> block(1024, 0x7E);
    while (!(with_dead.ended() & with_flood.ended() & with_garbage.ended()) &&
           seconds_since(with_dead.begun) < 30) {
        [[maybe_unused]] ssize_t written = ::write(flood.master, block.data(), block.size());
        std::array<std::uint8_t, 7> noise;
        for (std::uint8_t& byte : noise)
            byte = static_cast<std::uint8_t>(random.next());
        written = ::write(garbage.master, noise.data(), noise.size());
        ::usleep(1000);
    }
    for (const auto& [program, port] :
         {std::pair(&with_dead, dead.port), {&with_flood, flood.port}, {&with_garbage, garbage.port}}) {
        CHECK(program->wait() == 1);
        CHECK(program->error().starts_with("puckloop-coordinator: " + port + ": start-up step 1, AP"));
        CHECK(lines_of(program->error()) == 1);
        CHECK(program->lasted > 4.5);
        CHECK(program->lasted < 15);
        CHECK(program->events().back().event == "ended");
    }
}

TEST_CASE("a port that vanishes ends the program at once, a second signal does so while it waits") {
    Pty pty;
    SimulatedMesh mesh({.window = 1});
    SimulatedTam& tam = mesh.add("TAM01", kFirst);
    Program program({"--port", pty.port});
    serve(pty, mesh, program.begun, [&] { return tam.green + tam.blue > 0; });
    const double before = seconds_since(program.begun);
    pty.vanish();
    CHECK(program.wait() == 1);
    CHECK(program.lasted - before < 5);
    CHECK(program.error().find(pty.port) != std::string::npos);
    CHECK(program.events().back().value == "failure");

    Pty silent;
    SimulatedMesh other({.window = 1});
    SimulatedTam& deaf = other.add("TAM02", kFirst + 1);
    Program stubborn({"--port", silent.port}, "stubborn");
    serve(silent, other, stubborn.begun, [&] { return deaf.green + deaf.blue > 0; });
    stubborn.send(SIGTERM);  // waits up to 10 s for the LEDs, which nobody confirms
    const auto asked = Clock::now();
    while (seconds_since(asked) < 0.3)
        ::usleep(10'000);
    CHECK_FALSE(stubborn.ended());
    stubborn.send(SIGTERM);
    CHECK(stubborn.wait() == 128 + SIGTERM);
}

TEST_CASE("wrong use is one line and status 2") {
    const std::filesystem::path config = tests::scratch_path("coordinator-config.toml");
    const auto refused = [&](std::vector<std::string> arguments, const std::string& expected) {
        Program program(std::move(arguments), "wrong");
        CHECK(program.wait() == 2);
        INFO(program.error());
        CHECK(program.error().find(expected) != std::string::npos);
        CHECK(program.error().starts_with("puckloop-coordinator: "));
        CHECK(lines_of(program.error()) == 1);
    };
    refused({"--port", "/dev/there-is-no-such-port"}, "/dev/there-is-no-such-port: No such file");
    refused({"--port", "/dev/null"}, "/dev/null: expected a serial port");
    refused({"--experiment", "dance"}, "--experiment: 'dance' is none (expected random-task or sequence)");
    refused({"--dead-tim", "3"}, "--dead-tim: is not a parameter of this experiment (expected --dead-time)");
    refused({"--dead-time", "soon"}, "--dead-time: 'soon' cannot be used (expected 0 to 1000000)");
    refused({"--colors", "red,000019"}, "--colors: 'red' is no colour");
    refused({"--tasks", "a,b,c"}, "--colors: has 2 values (expected 3, one per task)");
    refused({"--experiment", "sequence", "--order", "TAM01,TAM01"}, "--order: has TAM01 twice");
    refused({"stray"}, "stray: is not an option");
    const auto with_file = [&](const std::string& text, const std::string& expected) {
        std::ofstream(config) << text;
        refused({"--config", config.string()}, config.string() + ": " + expected);
    };
    with_file("dead_time = 3\ndurations = [1, 2]\nseeed = 4\n", "line 3: seeed: is not a parameter");
    with_file("durations = [1, \"x\"]\n", "line 1: durations: 'x' cannot be used");
    with_file("experiment = \"dance\"\n", "line 1: experiment: 'dance' is none");
    with_file("[table]\nx = 1\n", "line 1: is no single value");
    with_file("dead_time = \n", "line 1, column 1: missing value");
    refused({"--draw", config.string()}, config.string() + ": line 1: is not the head of an event table");
    std::filesystem::remove(config);
}
