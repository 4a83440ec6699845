// Ends with a clock of their own: the pace of the wire in both directions, a pty's rate, hanging up.

#include "bench/bench.h"
#include "ends/pty_speed.h"

#include "emu/image/image.h"
#include "protocols/serial/uart_sampling.h"
#include "run/factory/outside_node.h"

#include <catch2/catch.hpp>

#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

using namespace puckloop;
using exec::LiveOptions;
using exec::UartEnd;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

namespace {

constexpr cosim::Time kSlowBit = 1'000'000'000'000 / 2400;
constexpr auto kSlowByte = std::chrono::nanoseconds(10 * kSlowBit / 1000);  // 4.17 ms
constexpr int kBytes = 30;

bool no_ptys() {
    if (access("/dev/pts", R_OK) == 0 && !std::filesystem::is_empty("/dev/pts")) return false;
    WARN("no devpts at /dev/pts (a bare chroot?): skipped");
    return true;
}

/// A program on the host that has the terminal open.
class Terminal {
  public:
    explicit Terminal(const std::string& announcement)
        : file_(open(announcement.substr(announcement.find("/dev/")).c_str(), O_RDWR | O_NOCTTY)) {
        REQUIRE(file_ >= 0);
    }
    ~Terminal() { close(file_); }
    void set(speed_t speed) const {
        termios settings{};
        REQUIRE(tcgetattr(file_, &settings) == 0);
        cfsetspeed(&settings, speed);
        REQUIRE(tcsetattr(file_, TCSANOW, &settings) == 0);
    }
    void send(const std::string& bytes) const {
        REQUIRE(write(file_, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size()));
    }
    /// One byte within `patience`, or -1.
    int receive(milliseconds patience = milliseconds(2000)) const {
        pollfd waiting{file_, POLLIN, 0};
        std::uint8_t byte = 0;
        if (poll(&waiting, 1, static_cast<int>(patience.count())) != 1 || read(file_, &byte, 1) != 1)
            return -1;
        return byte;
    }
    int file() const { return file_; }

  private:
    int file_;
};

/// Each byte as early as the wire could have brought it after the first, or later.
void check_pace(const std::vector<Clock::time_point>& times, Clock::time_point first) {
    REQUIRE(times.size() == kBytes);
    for (std::size_t i = 0; i < times.size(); ++i) {
        INFO("byte " << i);
        CHECK(times[i] - first >= static_cast<int>(i) * kSlowByte);
    }
    CHECK(times.back() - first < std::chrono::seconds(2));  // 125 ms at its rate
}

/// Simulated time that rushes past, as after a pause of the process: the chip sends without pause.
std::vector<Clock::time_point> rush(UartEnd& end, const Terminal& terminal) {
    for (int i = 0; i < kBytes; ++i) {
        const cosim::Time start = 10 * i * kSlowBit;
        end.poll(start, cosim::kNever);
        end.receive(static_cast<std::uint8_t>(i), true, start);
    }
    std::vector<Clock::time_point> times;
    for (int i = 0; i < kBytes; ++i) {
        CHECK(terminal.receive() == i);
        times.push_back(Clock::now());
    }
    return times;
}

}  // namespace

TEST_CASE("a pty gives bytes to the host no faster than the wire, however fast simulated time catches up") {
    if (no_ptys()) return;
    const auto end = exec::make_pty_end(LiveOptions{"uart1", kSlowBit, true});
    const Terminal terminal(end->announcement());
    const auto begun = Clock::now();
    const auto times = rush(*end, terminal);
    check_pace(times, begun);
}

TEST_CASE("bytes that the host writes at once reach the chip no faster than the wire") {
    if (no_ptys()) return;
    const auto end = exec::make_pty_end(LiveOptions{"uart1", kSlowBit, true});
    const Terminal terminal(end->announcement());
    const auto begun = Clock::now();
    terminal.send(std::string(kBytes, 'x'));
    std::vector<Clock::time_point> times;
    for (int now = 0; times.size() < kBytes && Clock::now() - begun < std::chrono::seconds(3); ++now) {
        end->poll(now * cosim::kMillisecond, cosim::kNever);
        for (; end->next() != cosim::kNever; end->take())
            times.push_back(Clock::now());
        std::this_thread::sleep_for(milliseconds(1));
    }
    check_pace(times, begun);
}

TEST_CASE("an end of a run that is not paced does not wait") {
    if (no_ptys()) return;
    const auto end = exec::make_pty_end(LiveOptions{"uart1", cosim::kSecond / 50, false});
    const Terminal terminal(end->announcement());
    for (int i = 0; i < kBytes; ++i)
        end->receive(static_cast<std::uint8_t>(i), true, 0);
    const auto begun = Clock::now();
    for (int i = 0; i < kBytes; ++i)
        CHECK(terminal.receive() == i);
    CHECK(Clock::now() - begun < std::chrono::seconds(3));  // 6 s at 50 baud
}

TEST_CASE("a pty has the line's rate until a program sets another one") {
    if (no_ptys()) return;
    const auto end = exec::make_pty_end(LiveOptions{"uart1", 1'000'000'000'000 / 115200, true});
    const Terminal terminal(end->announcement());
    CHECK(exec::terminal_baud(terminal.file()) == 115200.0);
    termios settings{};
    REQUIRE(tcgetattr(terminal.file(), &settings) == 0);
    CHECK(cfgetospeed(&settings) == B115200);
    end->poll(0, cosim::kNever);
    CHECK(end->bit_period() == 8'680'556);
    terminal.set(B9600);
    end->poll(1, cosim::kNever);
    CHECK(end->bit_period() == 104'166'667);
    terminal.send("x");
    for (int i = 2; i < 500 && end->next() == cosim::kNever; ++i) {
        std::this_thread::sleep_for(milliseconds(5));
        end->poll(i, cosim::kNever);
    }
    REQUIRE(end->next() != cosim::kNever);
    CHECK(end->next_bit_period() == 104'166'667);
    // A rate that no B constant names.
    const auto odd = exec::make_pty_end(LiveOptions{"uart1", 1'000'000'000'000 / 76800, true});
    CHECK(exec::terminal_baud(Terminal(odd->announcement()).file()) == 76800.0);
}

TEST_CASE("a program at another rate reads and sends what sampling at that rate gives") {
    if (no_ptys()) return;
    tools::OutsideSpec spec;
    spec.name = "robot0.uart1";
    spec.end.kind = exec::UartSpec::Kind::Pty;
    // The node prints where its terminal is; tests find it by asking for the next free one.
    std::string last;
    const auto names = [] {
        std::vector<std::string> list;
        for (const auto& entry : std::filesystem::directory_iterator("/dev/pts"))
            list.push_back(entry.path());
        return list;
    };
    const auto before = names();
    tools::OutsideNode node(spec);
    for (const std::string& name : names())
        if (std::find(before.begin(), before.end(), name) == before.end()) last = name;
    REQUIRE(!last.empty());
    const Terminal terminal(last);
    terminal.set(B57600);
    const cosim::Time fast = 8'680'556, slow = 17'361'111;
    std::vector<cosim::Message> outbox;
    cosim::Time now = 2 * cosim::kMillisecond;
    node.advance(now, {}, outbox);
    // From the robot: 0x55 at twice the rate.
    cosim::UartFrame frame{.start = now, .bit_period = fast, .data = 0x55};
    const auto expected = protocols::sample_frame(frame, {.bit_period = slow}, 0);
    REQUIRE(expected.size() == 1);
    REQUIRE(expected[0].data != 0x55);
    now += cosim::kMillisecond;
    node.advance(now, std::vector{cosim::Message{now - 1, 0, frame}}, outbox);
    CHECK(terminal.receive() == expected[0].data);
    // To the robot: frames with the program's own bit time.
    terminal.send("A");
    for (int i = 0; i < 500 && outbox.empty(); ++i) {
        std::this_thread::sleep_for(milliseconds(5));
        now += 5 * cosim::kMillisecond;
        node.advance(now, {}, outbox);
    }
    REQUIRE(outbox.size() == 1);
    const auto sent = std::get<cosim::UartFrame>(outbox[0].payload);
    CHECK(sent.data == 'A');
    CHECK(sent.bit_period == slow);
}

TEST_CASE("a pty that everybody closed, or that was set to B0, is unplugged") {
    if (no_ptys()) return;
    const auto end = exec::make_pty_end(LiveOptions{"uart1", 8'680'556, false});
    const auto settle = [&] {
        for (int i = 0; i < 15; ++i) {
            std::this_thread::sleep_for(milliseconds(10));
            end->poll(i, cosim::kNever);
        }
    };
    end->receive('1', true, 0);  // kept for the first program
    {
        const Terminal first(end->announcement());
        CHECK(first.receive() == '1');
    }
    settle();
    end->receive('2', true, 0);
    settle();
    const Terminal second(end->announcement());
    settle();
    end->receive('3', true, 0);
    CHECK(second.receive() == '3');
    second.set(B0);
    settle();
    end->receive('4', true, 0);
    second.send("lost");
    settle();
    CHECK(end->next() == cosim::kNever);
    second.set(B115200);
    settle();
    end->receive('5', true, 0);
    CHECK(second.receive() == '5');
}

namespace {

/// A client of the end's TCP port.
class Client {
  public:
    explicit Client(const std::string& announcement) : file_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
        sockaddr_in here{};
        here.sin_family = AF_INET;
        here.sin_port =
            htons(static_cast<std::uint16_t>(std::stoi(announcement.substr(announcement.rfind(':') + 1))));
        here.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        REQUIRE(connect(file_, reinterpret_cast<const sockaddr*>(&here), sizeof here) == 0);
    }
    ~Client() { close(file_); }
    /// At most a block; "" if nothing comes within `patience`.
    std::string read_some(milliseconds patience) const {
        pollfd waiting{file_, POLLIN, 0};
        char block[65536];
        if (poll(&waiting, 1, static_cast<int>(patience.count())) != 1) return {};
        const ssize_t got = read(file_, block, sizeof block);
        return {block, got > 0 ? static_cast<std::size_t>(got) : 0};
    }

  private:
    int file_;
};

/// Bytes that count up and do not repeat every 256.
std::uint8_t byte_at(std::size_t i) {
    return static_cast<std::uint8_t>(i % 251);
}

std::size_t first_wrong(const std::string& bytes) {
    for (std::size_t i = 0; i < bytes.size(); ++i)
        if (static_cast<std::uint8_t>(bytes[i]) != byte_at(i)) return i;
    return bytes.size();
}

}  // namespace

TEST_CASE("a paced run does not wait for a client that does not read: what it loses is counted") {
    const auto end = exec::make_tcp_end(0, LiveOptions{"uart1", 1, true});
    const Client client(end->announcement());
    end->poll(0, cosim::kNever);
    std::this_thread::sleep_for(milliseconds(50));  // it is accepted
    const auto begun = Clock::now();
    std::size_t sent = 0;
    // The kernel's own buffers take some megabytes at most.
    for (; sent < 32 << 20 && end->losses().unread < 1000; ++sent)
        end->receive(byte_at(sent), true, cosim::kSecond + static_cast<cosim::Time>(sent));
    CHECK(Clock::now() - begun < std::chrono::seconds(20));
    const exec::EndLosses lost = end->losses();
    REQUIRE(lost.unread == 1000);
    CHECK(lost.unconnected == 0);
    CHECK(lost.unread_since >= cosim::kSecond + (1 << 20));
    CHECK(lost.unread_since < cosim::kSecond + static_cast<cosim::Time>(sent));
    // All before that is still there, in order.
    std::string got;
    while (got.size() < sent - 1000) {
        const std::string more = client.read_some(milliseconds(2000));
        REQUIRE_FALSE(more.empty());
        got += more;
    }
    CHECK(got.size() == sent - 1000);
    CHECK(first_wrong(got) == got.size());
}

TEST_CASE("a run that is not paced waits for a client that reads slowly, and not for one that does not") {
    const auto end = exec::make_tcp_end(0, LiveOptions{"uart1", 1, false});
    constexpr std::size_t kSent = 8 << 20;
    {
        const Client client(end->announcement());
        std::this_thread::sleep_for(milliseconds(50));
        std::string got;
        std::thread reader([&] {
            std::this_thread::sleep_for(milliseconds(300));
            while (got.size() < kSent) {
                const std::string more = client.read_some(milliseconds(5000));
                if (more.empty()) break;
                got += more;
                if (got.size() % 7 == 0) std::this_thread::sleep_for(milliseconds(1));
            }
        });
        for (std::size_t i = 0; i < kSent; ++i)
            end->receive(byte_at(i), true, 0);
        end->finish();
        reader.join();
        CHECK(got.size() == kSent);
        CHECK(first_wrong(got) == got.size());
        CHECK(end->losses().unread == 0);
    }
    for (int i = 0; i < 100 && end->losses().unconnected == 0; ++i) {  // until it is seen to have left
        std::this_thread::sleep_for(milliseconds(5));
        end->receive('x', true, 0);
    }
    CHECK(end->losses().unconnected > 0);
    const Client idle(end->announcement());
    std::this_thread::sleep_for(milliseconds(50));
    const auto begun = Clock::now();
    for (std::size_t i = 0; i < kSent; ++i)
        end->receive(byte_at(i), true, static_cast<cosim::Time>(i));
    CHECK(Clock::now() - begun < std::chrono::seconds(20));  // a second of patience, once
    CHECK(end->losses().unread > kSent / 4);
}

TEST_CASE("a paced run loses what a terminal has no room for, and counts it") {
    if (no_ptys()) return;
    const auto end = exec::make_pty_end(LiveOptions{"uart1", 1, true});
    const Terminal terminal(end->announcement());
    constexpr std::uint64_t kSent = 200000;
    for (std::uint64_t i = 0; i < kSent; ++i)
        end->receive(byte_at(i), true, static_cast<cosim::Time>(i));
    end->finish();
    // All has been written or given up; what was written comes, however long the system takes over it.
    const std::uint64_t unread = end->losses().unread;
    std::uint64_t got = 0;
    while (got + unread < kSent && terminal.receive(milliseconds(60'000)) >= 0)
        ++got;
    CHECK(got > 1000);
    CHECK(got + unread == kSent);
    CHECK(terminal.receive(milliseconds(100)) < 0);
    CHECK(end->losses().unconnected == 0);
}

TEST_CASE("a paced bench that falls behind does not hurry after the wall clock") {
    exec::BenchOptions options;
    options.mcu = "dspic30f6014a";
    exec::Bench bench(options);
    image::Image image;
    bench.target().load(image);
    bench.run_until(10 * cosim::kMillisecond);
    bench.pace_by_wall_clock();
    std::this_thread::sleep_for(milliseconds(500));
    const auto begun = Clock::now();
    bench.run_until(410 * cosim::kMillisecond);
    // It may catch up 50 ms of the 500.
    CHECK(Clock::now() - begun >= milliseconds(345));
    CHECK(bench.fallen_behind() >= 440 * cosim::kMillisecond);
}
