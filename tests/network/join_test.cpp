// Programs of this machine in a run's network, at ports on loopback; bad input.

#include "tests/end_to_end/kit/one_line.h"
#include "tests/end_to_end/kit/workbench.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <thread>

using namespace puckloop::tests;
namespace fs = std::filesystem;

namespace {

using Clock = std::chrono::steady_clock;

/// A client of 127.0.0.1:PORT.
class Caller {
  public:
    /// Tries again until there is somebody, for 20 s.
    explicit Caller(int port) {
        sockaddr_in to{};
        to.sin_family = AF_INET;
        to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        to.sin_port = htons(static_cast<std::uint16_t>(port));
        const auto until = Clock::now() + std::chrono::seconds(20);
        for (;;) {
            fd_ = ::socket(AF_INET, SOCK_STREAM, 0);
            if (::connect(fd_, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0) break;
            ::close(fd_);
            fd_ = -1;
            if (Clock::now() > until) return;
            std::this_thread::sleep_for(std::chrono::milliseconds(50));
        }
        const timeval patience{20, 0};
        ::setsockopt(fd_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    }
    ~Caller() {
        if (fd_ >= 0) ::close(fd_);
    }
    Caller(const Caller&) = delete;
    Caller& operator=(const Caller&) = delete;

    bool there() const { return fd_ >= 0; }
    void say(const std::string& text) { CHECK(::send(fd_, text.data(), text.size(), MSG_NOSIGNAL) > 0); }
    void say_no_more() { ::shutdown(fd_, SHUT_WR); }
    /// What comes until there is a line, or the end.
    std::string line() {
        std::string text;
        char one = 0;
        while (::recv(fd_, &one, 1, 0) == 1) {
            text += one;
            if (one == '\n') break;
        }
        return text;
    }

  private:
    int fd_ = -1;
};

/// A port that was free a moment ago.
int free_port() {
    const int fd = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in here{};
    here.sin_family = AF_INET;
    here.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof here;
    REQUIRE(::bind(fd, reinterpret_cast<const sockaddr*>(&here), size) == 0);
    ::getsockname(fd, reinterpret_cast<sockaddr*>(&here), &size);
    ::close(fd);
    return ntohs(here.sin_port);
}

fs::path server(const Workbench& bench, const std::string& network = "latency = \"20 ms\"") {
    const std::string python = fs::exists("/usr/bin/python3") ? "/usr/bin/python3" : "python3";
    return bench.file(
        "joined.toml",
        fmt::format("[run]\nduration = \"60 s\"\n[arena]\nsize = [\"1 m\", \"1 m\"]\n[network]\n{}\n"
                    "[[host]]\nname = \"server\"\nprogram = [\"{}\", \"-B\", \"-S\", \"-E\", "
                    "\"{}/tests/network/programs/line_server.py\"]\n",
                    network, python, PUCKLOOP_SOURCE));
}

}  // namespace

TEST_CASE("programs of this machine talk to those in a paced run's network", "[network][join]") {
    for (const Words& way : {Words{"--paced"}, Words{"--realtime", "--in-process"}}) {
        const Workbench bench;
        const int port = free_port();
        Words words{"run",    server(bench).string(),
                    "--out",  bench.out("o").string(),
                    "--join", fmt::format("{}=server:7000", port)};
        words.insert(words.end(), way.begin(), way.end());
        const auto run = bench.start(words);
        // The gate may not be there yet when the port is: it is tried again.
        std::string first;
        for (int tries = 0; tries < 100 && first.empty(); ++tries) {
            Caller one(port);
            REQUIRE(one.there());
            one.say("hello\n");
            first = one.line();
            if (first.empty()) std::this_thread::sleep_for(std::chrono::milliseconds(200));
        }
        CHECK(first == "you said hello\n");
        Caller two(port), three(port);
        two.say("two\n");
        three.say("three\n");
        CHECK(two.line() == "you said two\n");
        CHECK(three.line() == "you said three\n");
        three.say_no_more();
        CHECK(three.line() == "bye\n");
        CHECK(three.line().empty());
        run->signal(SIGINT);
        CHECK(run->wait(20.0).status == 128 + SIGINT);
        const auto report = bench.report("o");
        CHECK(report["joined_ports"] == nlohmann::json::array({port}));
        CHECK(report["warnings"].dump().find("the run cannot be repeated") != std::string::npos);
        // Nothing is open once the run is over.
        const int fd = ::socket(AF_INET, SOCK_STREAM, 0);
        sockaddr_in to{};
        to.sin_family = AF_INET;
        to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        to.sin_port = htons(static_cast<std::uint16_t>(port));
        CHECK(::connect(fd, reinterpret_cast<const sockaddr*>(&to), sizeof to) != 0);
        ::close(fd);
    }
}

TEST_CASE("ways into the network that cannot be are one line, status 2", "[network][join]") {
    const Workbench bench;
    const auto file = server(bench);
    const auto check = [&](const Words& more, const Words& expected) {
        Words words{file.string()};
        words.insert(words.end(), more.begin(), more.end());
        check_one_line(bench.run("o", words), 2, expected);
    };
    check({"--join", "8080=server:7000"}, {"--join", "--paced or --realtime"});
    for (const char* bad : {"8080", "8080=server", "=server:7000", "0=server:7000", "65536=server:7000",
                            "8080=:7000", "8080=server:0", "x=server:7000", "8080=server:7000x"})
        check({"--paced", "--join", bad}, {"--join", "is no way into the network", "8080=server:7000"});
    check({"--paced", "--join", "8080=nobody:7000"}, {"there is no 'nobody' on the network", "server"});
    check({"--paced", "--join", "8080=server:1", "--join", "8080=server:2"}, {"8080 is given twice"});
    const int fd = ::socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in here{};
    here.sin_family = AF_INET;
    here.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof here;
    REQUIRE(::bind(fd, reinterpret_cast<const sockaddr*>(&here), size) == 0);
    REQUIRE(::listen(fd, 1) == 0);
    ::getsockname(fd, reinterpret_cast<sockaddr*>(&here), &size);
    check({"--paced", "--join", fmt::format("{}=server:7000", ntohs(here.sin_port))},
          {fmt::format("port {}", ntohs(here.sin_port)), "in use"});
    ::close(fd);
    const auto plain = bench.hello();
    check_one_line(bench.run("o", {plain.string(), "--paced", "--join", "8080=server:7000"}), 2,
                   {"the scenario has no network"});
    const auto adhoc =
        bench.file("adhoc.toml", "[run]\nduration = \"1 s\"\n[arena]\nsize = [\"1 m\", \"1 m\"]\n"
                                 "[network]\nmode = \"wifi\"\n[[host]]\nname = \"server\"\nprogram = "
                                 "[\"true\"]\nposition = [\"0 m\", \"0 m\"]\n");
    check_one_line(bench.run("o", {adhoc.string(), "--paced", "--join", "8080=server:7000"}), 2,
                   {"no access point"});
}
