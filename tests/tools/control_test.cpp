// Where a running world takes commands: whatever a client sends, and what a killed run leaves.

#include "base/error.h"
#include "base/json.h"
#include "run/control/control_place.h"
#include "run/control/control_socket.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstring>
#include <fstream>
#include <thread>

using namespace puckloop;
using namespace puckloop::tools;
using Catch::Contains;
using nlohmann::json;
namespace fs = std::filesystem;

namespace {

/// A results folder, and a socket as a run has it.
struct Run {
    fs::path results = tests::scratch_path("puckloop-control-test");
    std::string socket = new_control_path();

    Run() { fs::create_directories(results); }
    ~Run() { fs::remove_all(results); }
};

/// Connected to a unix socket.
class Client {
  public:
    explicit Client(const std::string& path) : descriptor_(::socket(AF_UNIX, SOCK_STREAM, 0)) {
        sockaddr_un address{};
        address.sun_family = AF_UNIX;
        std::strncpy(address.sun_path, path.c_str(), sizeof address.sun_path - 1);
        REQUIRE(::connect(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
    }
    ~Client() { ::close(descriptor_); }
    Client(const Client&) = delete;
    Client& operator=(const Client&) = delete;

    void send(const std::string& line) const {
        REQUIRE(::send(descriptor_, line.data(), line.size(), MSG_NOSIGNAL) ==
                static_cast<ssize_t>(line.size()));
    }
    std::string reply() const {
        char text[4096];
        const ssize_t size = ::recv(descriptor_, text, sizeof text, MSG_DONTWAIT);
        return {text, text + std::max<ssize_t>(size, 0)};
    }

  private:
    int descriptor_;
};

/// What the world gets of `request`, and what the client hears at once.
struct Heard {
    std::vector<physics::Command> commands;
    std::string reply;
};
Heard heard(const std::string& request) {
    const Run run;
    const ControlPlace place(run.socket, run.results);
    const auto source = make_control_socket(run.socket);
    const Client client(run.socket);
    client.send(request + "\n");
    Heard result;
    for (int i = 0; i < 10; ++i)  // accepts, then reads
        for (physics::Command& command : source->poll())
            result.commands.push_back(std::move(command));
    result.reply = client.reply();
    return result;
}

}  // namespace

TEST_CASE("the world makes its own text of a command: no client can forge a line of its record") {
    const Heard good = heard(R"({"act":"select robot0 position 7"})");
    REQUIRE(good.commands.size() == 1);
    CHECK(good.commands[0].action->number == 7);
    CHECK(good.commands[0].action->toml == "select = \"robot0\"\nposition = 7\n");
    CHECK(good.commands[0].action->command == "select robot0 position 7");
    CHECK(good.reply.empty());  // not before it is done
    CHECK_FALSE(heard(R"({"list":true})").commands.at(0).action);

    // As of an older `puckloop act`: an action with texts of the client's.
    const Heard forged = heard(
        R"({"action":{"verb":3,"object":"robot0","to":null,"relative":false,"heading":null,"over":0.0,"thing":)"
        R"({"walls":[],"boxes":[],"cylinders":[],"lamps":[],"speakers":[],"patches":[]},"property":"",)"
        R"("value":0.0,"number":0,"address":0,"hold":0.0,"command":"\u001b[2J","toml":"x\n[[event]]"}})");
    CHECK(forged.commands.empty());
    CHECK_THAT(forged.reply, Contains("this is no command"));
    for (const char* bad : {R"({"act":"lift robot0\n[[event]]"})", R"({"act":"lift \u001b[2J"})",
                            R"({"act":"select robot0 position 256"})",
                            R"({"act":"select robot0 position 1099511627776"})", R"({"act":""})"}) {
        INFO(bad);
        const Heard refused = heard(bad);
        CHECK(refused.commands.empty());
        CHECK(json::parse(refused.reply).contains("refused"));
    }
    for (const char* bad : {"", "{}", "[]", "7", R"({"act":7})", R"({"list":7})", "\xff"}) {
        INFO(bad);
        CHECK(heard(bad).commands.empty());
        CHECK_THAT(heard(bad).reply, Contains("this is no command"));
    }
}

TEST_CASE("a run of another user is named as such") {
    const Run run;
    const ControlPlace place(run.socket, run.results);
    const auto source = make_control_socket(run.socket);
    const fs::path folder = fs::path(run.socket).parent_path();
    // Nobody may enter; and root, who may enter everywhere, is somebody else for a moment.
    const uid_t me = ::geteuid();
    constexpr uid_t kNobody = 65534;
    REQUIRE(::chmod(folder.c_str(), 0) == 0);
    if (me == 0) REQUIRE(::seteuid(kNobody) == 0);
    std::string problem;
    try {
        ask("out/hello", run.socket, "{\"list\":true}\n", 1.0);
    } catch (const InputError& error) {
        problem = error.what();
    }
    if (me == 0) REQUIRE(::seteuid(me) == 0);
    REQUIRE(::chmod(folder.c_str(), S_IRWXU) == 0);
    CHECK_THAT(problem, Contains("out/hello: belongs to another user"));
}

TEST_CASE("the socket is its user's alone, whatever files he makes for others") {
    const Run run;
    const ControlPlace place(run.socket, run.results);
    const mode_t before = ::umask(0);
    const auto source = make_control_socket(run.socket);
    ::umask(before);
    CHECK((fs::status(run.socket).permissions() & fs::perms::all) ==
          (fs::perms::owner_read | fs::perms::owner_write));
}

TEST_CASE("a command that comes before a new run has its socket waits for it") {
    const Run run;
    const ControlPlace place(run.socket, run.results);
    CHECK(control_path_of(run.results.string()) == run.socket);
    std::thread world([&] {
        std::this_thread::sleep_for(std::chrono::milliseconds(200));
        const auto source = make_control_socket(run.socket);
        for (bool asked = false; !asked; std::this_thread::sleep_for(std::chrono::milliseconds(1)))
            for (const physics::Command& command : source->poll()) {
                source->reply(command.id, "{}");
                asked = true;
            }
        std::this_thread::sleep_for(std::chrono::milliseconds(100));  // it is read
    });
    CHECK(ask("out/hello", run.socket, "{\"list\":true}\n", 10.0) == "{}\n");
    world.join();
    const std::string gone = "/tmp/puckloop-nowhere/act";
    CHECK_THROWS_WITH(ask("out/hello", gone, "{\"list\":true}\n", 1.0), Contains("the run has ended"));
}

TEST_CASE("the socket of a killed run goes with the next run into its folder") {
    const Run killed;
    const fs::path folder = fs::path(killed.socket).parent_path();
    REQUIRE(::mkdir(folder.c_str(), S_IRWXU) == 0);
    std::ofstream(killed.results / "control.json") << json{{"socket", killed.socket}};
    {
        const auto source = make_control_socket(killed.socket);
        const ControlPlace copied("", killed.results);
        CHECK(fs::exists(killed.socket));  // its run is on: the folder is a copy
    }
    std::ofstream(killed.results / "control.json") << json{{"socket", killed.socket}};
    REQUIRE(fs::exists(killed.socket));
    {
        const ControlPlace next("", killed.results);
        CHECK_FALSE(fs::exists(folder));
        CHECK_FALSE(fs::exists(killed.results / "control.json"));
    }
    // A note that names something else takes nothing away.
    const fs::path precious = killed.results / "act";
    std::ofstream(precious) << "x";
    for (const std::string& note :
         {json{{"socket", precious}}.dump(), json{{"socket", "/nowhere/puckloop-1/act"}}.dump(),
          std::string("damaged"), std::string("[]"), json{{"socket", std::string(300, 'x')}}.dump()}) {
        std::ofstream(killed.results / "control.json") << note;
        const ControlPlace next("", killed.results);
        CHECK(fs::exists(precious));
    }
}

TEST_CASE("private folders of runs that were killed are removed by the next run, whatever its folder") {
    const Run run;
    // A process that is surely gone.
    const pid_t child = ::fork();
    if (child == 0) ::_exit(0);
    REQUIRE(::waitpid(child, nullptr, 0) == child);
    const fs::path place = fs::path(new_control_path()).parent_path().parent_path();
    const auto left = place / ("puckloop-" + std::to_string(child) + "-0123456789abcdef");
    const auto used = place / ("puckloop-" + std::to_string(child) + "-fedcba9876543210");
    const auto alive = place / ("puckloop-" + std::to_string(::getpid()) + "-0123456789abcdef");
    const auto driven = place / ("puckloop-" + std::to_string(child) + "-00112233445566aa");
    for (const fs::path& folder : {left, used, alive, driven})
        fs::create_directories(folder);
    // Both sockets of a run that a client drove, and nobody listens any more.
    for (const char* name : {"act", "control"}) {
        const auto source = make_control_socket((driven / name).string());
    }
    REQUIRE(fs::exists(driven / "control"));
    std::ofstream(used / "notes.txt") << "mine";
    { const ControlPlace next("", run.results); }
    CHECK_FALSE(fs::exists(left));
    CHECK_FALSE(fs::exists(driven));
    CHECK(fs::exists(used / "notes.txt"));
    CHECK(fs::exists(alive));
    for (const fs::path& folder : {left, used, alive})
        fs::remove_all(folder);
}
