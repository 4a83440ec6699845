// `puckloop exec --uart1 pty` as a terminal program meets it: the pace and the rate of a wire.

#include "tests/end_to_end/kit/live_line.h"
#include "tests/end_to_end/kit/workbench.h"
#include "tests/kit/dspic_pieces.h"

#include <catch2/catch.hpp>

#include <fcntl.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <thread>

using namespace puckloop::tests;

namespace {

constexpr double kByte = 10.0 / 115200;  // seconds

/// Sends without pause; a byte received ends it for good and comes back plus one.
const std::string kSource = kMain + kUart1 + R"(
send:   btsc    U1STA, #9
        bra     send
        inc     w1, w1
        mov     w1, U1TXREG
        btss    U1STA, #0
        bra     send
echo:   btss    U1STA, #0
        bra     echo
        mov     U1RXREG, w0
        inc     w0, w0
        mov     w0, U1TXREG
        bra     echo
)";

std::string image(const Workbench& work) {
    const std::string source = work.file("send.s", kSource), image = work.folder() / "send.hex";
    REQUIRE(work.puckloop({"asm", source, "-o", image}).status == 0);
    return image;
}

struct Bench {
    Workbench work;
    std::unique_ptr<Process> process;
    int terminal = -1;

    explicit Bench(const Words& more = {}) {
        Words words{"exec", "--board", "pic", image(work), "--uart1", "pty"};
        words.insert(words.end(), more.begin(), more.end());
        process = work.start(words);
        terminal = open(place_of(work.folder() / "stderr", "uart1").c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK);
        REQUIRE(terminal >= 0);
    }
    ~Bench() { close(terminal); }
    /// Bytes that come until the wall clock shows `until`.
    std::string read_until(double until) const {
        std::string got;
        char block[4096];
        while (wall_seconds() < until) {
            pollfd waiting{terminal, POLLIN, 0};
            if (poll(&waiting, 1, 5) != 1) continue;
            const ssize_t count = read(terminal, block, sizeof block);
            if (count > 0) got.append(block, static_cast<std::size_t>(count));
        }
        return got;
    }
};

}  // namespace

TEST_CASE("after a pause of the process a pty brings no more bytes than the wire would") {
    if (!has_ptys()) return;
    const Bench bench;
    CHECK(bench.read_until(wall_seconds() + 0.3).size() > 500);
    bench.process->signal(SIGSTOP);
    std::this_thread::sleep_for(std::chrono::milliseconds(600));
    tcflush(bench.terminal, TCIFLUSH);
    const double went_on = wall_seconds();
    bench.process->signal(SIGCONT);
    const std::size_t got = bench.read_until(went_on + 0.2).size();
    const double elapsed = wall_seconds() - went_on;
    // What was on its way, and what a UART's FIFO holds, may come at once; the 600 ms are 6900 bytes.
    CHECK(static_cast<double>(got) <= elapsed / kByte + 64);
    CHECK(got > 200);
    bench.process->signal(SIGINT);
    const Ended ended = bench.process->wait();
    CHECK(ended.out.find("fell behind the wall clock by 0.") != std::string::npos);
}

TEST_CASE("a program that sets another rate on a pty reads garbage until it sets the line's") {
    if (!has_ptys()) return;
    const Bench bench;
    termios settings{};
    REQUIRE(tcgetattr(bench.terminal, &settings) == 0);
    CHECK(cfgetospeed(&settings) == B115200);
    const auto set = [&](speed_t speed) {
        cfsetspeed(&settings, speed);
        REQUIRE(tcsetattr(bench.terminal, TCSANOW, &settings) == 0);
    };
    REQUIRE(write(bench.terminal, "x", 1) == 1);  // the board is quiet from now on
    bench.read_until(wall_seconds() + 0.3);
    const auto ask = [&](char byte) {
        REQUIRE(write(bench.terminal, &byte, 1) == 1);
        return bench.read_until(wall_seconds() + 0.3);
    };
    // A busy machine may answer late: ask again for up to some 6 s.
    const auto ask_until_right = [&] {
        std::string answer;
        for (int tries = 0; tries < 20 && answer != "B"; ++tries)
            answer = ask('A');
        return answer;
    };
    CHECK(ask_until_right() == "B");
    set(B38400);
    CHECK(ask('A').find('B') == std::string::npos);
    set(B115200);
    CHECK(ask_until_right() == "B");
    bench.process->signal(SIGINT);
    const Ended ended = bench.process->wait();
    CHECK(ended.err.find("to 38400 baud, the line is meant to have 115200") != std::string::npos);
}

namespace {

/// `exec` that is not paced, with a client at its TCP port.
struct Fast {
    Workbench work;
    std::unique_ptr<Process> process;

    explicit Fast(const Words& more) {
        Words words{"exec",  "--board", "pic",           image(work), "--uart1",
                    "tcp:0", "--json",  "--no-realtime", "--seconds", "60"};
        words.insert(words.end(), more.begin(), more.end());
        process = work.start(words);
    }
    LiveLine client() const { return {LiveLine::Kind::Tcp, place_of(work.folder() / "stderr", "uart1")}; }
};

std::uint64_t count(const nlohmann::json& report, const char* what) {
    return report["uart1"][what].get<std::uint64_t>();
}

}  // namespace

TEST_CASE("what a program at a pty does not read is lost, reported at once and counted to the byte") {
    if (!has_ptys()) return;
    const Bench bench({"--json"});
    // The kernel keeps some kB for it, the line brings 11 kB a second.
    for (const double until = wall_seconds() + 60;
         wall_seconds() < until &&
         text_of(bench.work.folder() / "stderr").find("does not read") == std::string::npos;)
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
    const std::string notice = text_of(bench.work.folder() / "stderr");
    CHECK_THAT(notice, Catch::Contains("uart1: the program at pty /dev/pts/") &&
                           Catch::Contains(" does not read: bytes for it are lost from "));
    REQUIRE(write(bench.terminal, "x", 1) == 1);  // the board is quiet from now on
    std::size_t got = 0;
    for (std::size_t more = 1; more > 0; got += more)
        more = bench.read_until(wall_seconds() + 0.5).size();
    bench.process->signal(SIGINT);
    const auto report = nlohmann::json::parse(bench.process->wait().out);
    CHECK(count(report, "unread") > 0);
    CHECK(count(report, "unconnected") == 0);
    CHECK(count(report, "unread") + got == count(report, "sent"));
    REQUIRE(report["warnings"].size() == 1);
    CHECK_THAT(report["warnings"][0].get<std::string>(),
               Catch::Contains(std::to_string(count(report, "unread")) + " bytes from ") &&
                   Catch::Contains("did not read them"));
}

TEST_CASE("a run that is not paced waits for a client that reads, and reports what another one lost") {
    {
        const Fast fast({});
        const LiveLine client = fast.client();
        const std::string got = client.read_until("nothing ends so", 60.0);
        const auto report = nlohmann::json::parse(fast.process->wait().out);
        CHECK(count(report, "unread") == 0);
        CHECK(got.size() + count(report, "unconnected") == count(report, "sent"));
        for (std::size_t i = 1; i < got.size(); ++i)
            if (static_cast<std::uint8_t>(got[i]) != static_cast<std::uint8_t>(got[i - 1] + 1)) FAIL(i);
    }
    for (const bool strict : {false, true}) {
        const Fast fast(strict ? Words{"--strict"} : Words{});
        const LiveLine client = fast.client();
        const Ended ended = fast.process->wait();
        CHECK(ended.status == (strict ? 1 : 0));
        const auto report = nlohmann::json::parse(ended.out);
        CHECK(report["simulated_s"] == 60.0);
        CHECK(count(report, "unread") > 100000);
        CHECK_THAT(ended.err, Catch::Contains(" does not read"));
        CHECK_THAT(report["warnings"][0].get<std::string>(), Catch::Contains("did not read them"));
    }
}
