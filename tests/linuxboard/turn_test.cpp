// The word by which a program and its node take turns, and what goes through a channel that is too small.

#include "base/random.h"
#include "linuxboard/shim/node/process.h"
#include "linuxboard/shim/wire/turn.h"

#include <catch2/catch.hpp>

#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstring>
#include <memory>
#include <thread>

using namespace puckloop;
using namespace puckloop::linuxboard;

namespace {

template <int Processors>
struct Host {
    template <typename... Arguments>
    static long call(long number, Arguments... arguments) {
        if (number != SYS_sched_getaffinity) return syscall(number, arguments...);
        const long values[] = {static_cast<long>(arguments)...};
        std::memset(reinterpret_cast<void*>(values[2]), 0, static_cast<std::size_t>(values[1]));
        *reinterpret_cast<unsigned long*>(values[2]) = (1ul << Processors) - 1;
        return 8;
    }
    static std::int64_t nanoseconds() {
        ++clock_readings;
        return std::chrono::steady_clock::now().time_since_epoch().count();
    }
    static inline std::atomic<int> clock_readings{0};
};

constexpr std::int64_t kSecond = 1'000'000'000;

}  // namespace

TEST_CASE("two sides that take turns see all that the other one wrote") {
    constexpr int kRounds = 20'000;
    Turn turn;
    std::uint64_t value = 0;
    const auto play = [&](Turn::Side mine, Turn::Side other, std::uint64_t seed) {
        RandomStream random(seed, "turns");
        Patience patience;
        for (int round = 0; round < kRounds; ++round) {
            while (!turn.await<Host<2>>(mine, patience, kSecond)) {
            }
            for (std::uint64_t i = random.below(300); i > 0; --i)
                value = value * 3 + i;
            value += mine == Turn::Node ? 1 : 5;
            turn.pass<Host<2>>(other);
        }
    };
    std::thread node(play, Turn::Node, Turn::Program, 1);
    play(Turn::Program, Turn::Node, 2);
    node.join();
    RandomStream program(2, "turns"), of_node(1, "turns");
    std::uint64_t expected = 0;
    for (int round = 0; round < 2 * kRounds; ++round) {
        for (std::uint64_t i = (round % 2 == 0 ? program : of_node).below(300); i > 0; --i)
            expected = expected * 3 + i;
        expected += round % 2 == 0 ? 5 : 1;
    }
    CHECK(value == expected);
}

TEST_CASE("nobody looks on a host with one processor, nor where it was in vain") {
    Turn turn;
    Patience patience;
    CHECK_FALSE(turn.await<Host<1>>(Turn::Node, patience, 1'000));
    CHECK(Host<1>::clock_readings == 0);
    int looks = 0;
    for (int wait = 0; wait < 640; ++wait) {
        const int before = Host<2>::clock_readings;
        CHECK_FALSE(turn.await<Host<2>>(Turn::Node, patience, 1'000));
        if (Host<2>::clock_readings > before) ++looks;
    }
    CHECK(looks == 7);  // 2 at first, then after 16, 32, 64, 128 and 256 waits without
    Patience used;
    for (int wait = 0; wait < 1000; ++wait)  // one wait in four takes longer
        if (used.next(2) > 0) used.ended(wait % 4 != 0);
    int again = 0;
    for (int wait = 0; wait < 100; ++wait)
        again += used.next(2) > 0 ? 1 : 0;
    CHECK(again == 100);
}

TEST_CASE("completions that are too many for a channel come in parts") {
    auto memory = std::make_unique<wire::Channel>();
    wire::ProcessEntry entry;
    int sockets[2] = {-1, -1};
    REQUIRE(socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, sockets) == 0);
    Process process(sockets[0], entry, *memory);
    std::vector<FinishedCall> calls;
    RandomStream random(7, "parts");
    for (std::uint32_t thread = 0; thread < 40; ++thread) {
        FinishedCall call;
        call.header.thread = thread;
        call.data.assign(random.below(wire::kMaximumData + 1), static_cast<char>('a' + thread % 26));
        call.header.length = static_cast<std::uint32_t>(call.data.size());
        calls.push_back(call);
    }
    std::vector<FinishedCall> received;
    std::thread program([&] {
        Patience patience;
        memory->turn.pass<Host<2>>(Turn::Node);
        while (true) {
            while (!memory->turn.await<Host<2>>(Turn::Program, patience, kSecond)) {
            }
            const char* cursor = memory->reply_data;
            for (std::uint32_t i = 0; i < memory->reply.count; ++i) {
                FinishedCall call;
                std::memcpy(&call.header, cursor, sizeof call.header);
                cursor += sizeof call.header;
                call.data.assign(cursor, call.header.length);
                cursor += call.header.length;
                received.push_back(std::move(call));
            }
            if (memory->reply.more == 0) return;
            memory->turn.pass<Host<2>>(Turn::Node);
        }
    });
    wire::Request request;
    std::string data;
    CHECK(process.hear(5.0, request, data) == ProcessEvent::Request);
    process.reply({}, calls);
    program.join();
    close(sockets[1]);
    REQUIRE(received.size() == calls.size());
    for (std::size_t i = 0; i < calls.size(); ++i) {
        CHECK(received[i].header.thread == calls[i].header.thread);
        CHECK((received[i].data == calls[i].data));
    }
}

TEST_CASE("a process that dies while the node waits for it is noticed at once") {
    auto memory = std::make_unique<wire::Channel>();
    wire::ProcessEntry entry;
    int sockets[2] = {-1, -1};
    REQUIRE(socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, sockets) == 0);
    const pid_t child = fork();
    if (child == 0) {
        usleep(50'000);
        raise(SIGKILL);
    }
    close(sockets[1]);
    entry.host = child;
    Process process(sockets[0], entry, *memory);
    wire::Request request;
    std::string data;
    // Not noticed it would be waited for without end; 55 ms on a machine that is not busy.
    constexpr double kForGood = 1e6;  // s
    CHECK(process.hear(kForGood, request, data) == ProcessEvent::Ended);
    CHECK(process.killed_by() == SIGKILL);
    CHECK(process.describe_end() == "was killed by SIGKILL (Killed)");
}
