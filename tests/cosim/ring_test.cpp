// Bytes, messages and wake-ups through shared memory; and memory in which nothing can be trusted.

#include "base/error.h"
#include "base/random.h"
#include "cosim/remote/processes/death_watch.h"
#include "cosim/remote/processes/node_processes.h"
#include "cosim/remote/protocol.h"
#include "cosim/remote/processes/ring_stream.h"

#include <catch2/catch.hpp>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstring>
#include <memory>
#include <thread>

using namespace puckloop;
using namespace puckloop::cosim;
using std::chrono::milliseconds;

namespace {

/// Two sides of the memory of one node process, in one process.
struct Pair {
    std::unique_ptr<SharedWithNode> shared = std::make_unique<SharedWithNode>();
    SharedByRun run{};
    Bell conductor_bell{run.conductor, run.busy};
    Bell node_bell{shared->node, run.busy};
    RingStream conductor{shared->from_node, shared->to_node, conductor_bell, node_bell};
    RingStream node{shared->to_node, shared->from_node, node_bell, conductor_bell};
};

Bytes random_report(RandomStream& random, std::size_t longest) {
    std::string text(random.below(longest), ' ');
    for (char& c : text)
        c = static_cast<char>(random.next());
    Bytes bytes;
    protocol::write_report(bytes, text);
    return bytes;
}

Bytes body(const RingStream& stream) {
    return {stream.body().begin(), stream.body().end()};
}

Bytes body_of(const Bytes& bytes) {
    return {bytes.begin() + protocol::kLengthBytes, bytes.end()};
}

double seconds_of(const std::function<void()>& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

TEST_CASE("a ring hands out what was put in, whatever the pieces") {
    const auto state = std::make_unique<RingState>();
    RingWriter writer(*state);
    RingReader reader(*state);
    RandomStream random(5, "ring");
    Bytes put, got;
    while (put.size() < 20 * RingState::kCapacity) {
        Bytes piece(random.below(random.below(8) == 0 ? 2 * RingState::kCapacity : 300));
        for (std::uint8_t& byte : piece)
            byte = static_cast<std::uint8_t>(random.next());
        const std::size_t count = writer.write(piece);
        REQUIRE(count == std::min(piece.size(), RingState::kCapacity - (put.size() - got.size())));
        put.insert(put.end(), piece.begin(), piece.begin() + static_cast<std::ptrdiff_t>(count));
        if (random.below(3) != 0) reader.read(got);
    }
    reader.read(got);
    CHECK(got == put);
}

TEST_CASE("whole messages pass in both directions, far larger ones than a ring too") {
    Pair pair;
    constexpr int kMessages = 300;
    std::thread node([&pair] {
        for (int m = 0; m < kMessages; ++m) {
            while (!pair.node.receive(milliseconds(50))) {
            }
            Bytes answer = body(pair.node);
            std::reverse(answer.begin(), answer.end());
            Bytes bytes;
            protocol::write_report(bytes, std::string(answer.begin(), answer.end()));
            while (!pair.node.send(bytes, milliseconds(50))) {
            }
        }
    });
    RandomStream random(7, "messages");
    for (int m = 0; m < kMessages; ++m) {
        const Bytes bytes = random_report(random, m % 50 == 0 ? 1'000'000 : 400);
        while (!pair.conductor.send(bytes, milliseconds(50))) {
        }
        while (!pair.conductor.receive(milliseconds(50))) {
        }
        const std::string answer = protocol::read_report(pair.conductor.body());
        Bytes expected = body_of(bytes);
        std::reverse(expected.begin(), expected.end());
        REQUIRE(Bytes(answer.begin(), answer.end()) == expected);
    }
    node.join();
}

TEST_CASE("several messages at once are handed out one by one") {
    Pair pair;
    RandomStream random(8, "several");
    std::vector<Bytes> sent;
    for (int m = 0; m < 20; ++m) {
        sent.push_back(random_report(random, 300));
        REQUIRE(pair.node.send(sent.back(), milliseconds(0)));
    }
    for (const Bytes& bytes : sent) {
        REQUIRE(pair.conductor.receive());
        REQUIRE(body(pair.conductor) == body_of(bytes));
    }
    CHECK_FALSE(pair.conductor.receive());
}

TEST_CASE("a message that nobody takes waits no longer than it may") {
    Pair pair;
    Bytes bytes;
    protocol::write_report(bytes, std::string(3 * RingState::kCapacity, 'x'));
    CHECK_FALSE(pair.conductor.send(bytes, milliseconds(20)));
    CHECK_FALSE(pair.conductor.receive(milliseconds(20)));
    // It goes on where it stopped.
    std::thread node([&pair] {
        while (!pair.node.receive(milliseconds(50))) {
        }
    });
    while (!pair.conductor.send(bytes, milliseconds(50))) {
    }
    node.join();
    CHECK(protocol::read_report(pair.node.body()).size() == 3 * RingState::kCapacity);
}

TEST_CASE("impossible lengths and positions are refused") {
    Pair pair;
    SECTION("a message of no length") {
        pair.shared->from_node.written = 4;
    }
    SECTION("a message too long") {
        std::memset(pair.shared->from_node.bytes, 0xff, 4);
        pair.shared->from_node.written = 4;
    }
    SECTION("more bytes than the ring holds") {
        pair.shared->from_node.written = RingState::kCapacity + 1;
    }
    SECTION("a position that falls") {
        Bytes bytes;
        protocol::write_finish(bytes);
        REQUIRE(pair.node.send(bytes, milliseconds(0)));
        REQUIRE(pair.conductor.receive());
        pair.shared->from_node.written = 1;
    }
    CHECK_THROWS_WITH(pair.conductor.receive(), Catch::Contains("impossible length"));
    pair.shared->to_node.read = 1;
    CHECK_THROWS_AS(pair.conductor.send(Bytes(10), milliseconds(0)), CodecError);
}

TEST_CASE("whatever stands in the memory, reading and writing end with a message or a CodecError") {
    RandomStream random(31, "nonsense");
    int refused = 0, taken = 0;
    for (int round = 0; round < 600; ++round) {
        Pair pair;
        auto* const memory = reinterpret_cast<std::uint8_t*>(pair.shared.get());
        for (int step = 0; step < 30; ++step) {
            // Mostly positions and lengths, at times anything.
            RingState& ring = random.below(2) == 0 ? pair.shared->from_node : pair.shared->to_node;
            try {
                switch (random.below(6)) {
                case 0:
                    ring.written =
                        random.below(4) == 0 ? random.next() : random.below(2 * RingState::kCapacity);
                    break;
                case 1:
                    ring.read = random.below(4) == 0 ? random.next() : random.below(2 * RingState::kCapacity);
                    break;
                case 2:
                    for (std::size_t i = 0; i < 64; ++i)
                        ring.bytes[i] = static_cast<std::uint8_t>(random.below(8) == 0 ? random.next() : 0);
                    break;
                case 3:
                    memory[random.below(sizeof(SharedWithNode))] = static_cast<std::uint8_t>(random.next());
                    break;
                case 4:
                    taken += pair.node.send(random_report(random, 100), milliseconds(0)) &&
                             pair.conductor.receive();
                    break;
                default:
                    pair.shared->node.rings = static_cast<std::uint32_t>(random.next());
                    break;
                }
                if (random.below(2) == 0) pair.conductor.send(Bytes(random.below(5000)), milliseconds(0));
                taken += pair.conductor.receive();
            } catch (const CodecError&) {
                ++refused;
                break;
            }
        }
    }
    CHECK(refused > 300);
    CHECK(taken > 10);
}

TEST_CASE("no ring of a bell is lost") {
    SharedByRun there{}, back{};
    Bell ping(there.conductor, there.busy), pong(back.conductor, there.busy);
    constexpr std::uint32_t kRounds = 20'000;
    const auto follow = [](Bell& mine, Bell& theirs, std::uint32_t lead) {
        for (std::uint32_t round = 0; round < kRounds; ++round) {
            if (lead != 0) theirs.ring();
            while (mine.rings() == round)
                mine.wait(round, 1, std::chrono::seconds(100));
            if (lead == 0) theirs.ring();
        }
    };
    const double wall = seconds_of([&] {
        std::thread other([&] { follow(ping, pong, 0); });
        follow(pong, ping, 1);
        other.join();
    });
    CHECK(wall < 60.0);  // one lost ring costs 100 s
}

TEST_CASE("a wait for several rings ends with the last of them, at once, or when its time is over") {
    SharedByRun run{};
    Bell waiter(run.conductor, run.busy), ringer(run.conductor, run.busy);
    const auto wait_while = [&](const std::function<void()>& work) {
        const std::uint32_t seen = waiter.rings();
        std::thread other(work);
        const double wall = seconds_of([&] { waiter.wait(seen, 3, std::chrono::seconds(20)); });
        other.join();
        return wall;
    };
    std::atomic<int> rung{0};
    const double wall = wait_while([&] {
        for (int i = 0; i < 3; ++i) {
            std::this_thread::sleep_for(milliseconds(20));
            ++rung;
            ringer.ring();
        }
    });
    CHECK(rung == 3);
    CHECK(wall < 15.0);
    CHECK(wait_while([&] { ringer.ring(true); }) < 15.0);
    const double over = seconds_of([&] { waiter.wait(waiter.rings(), 1, milliseconds(30)); });
    CHECK(over >= 0.025);
    CHECK(over < 15.0);
}

TEST_CASE("shared memory keeps its size, and what is none is refused") {
    SharedMemory memory("puckloop-test", 5000);
    CHECK(ftruncate(memory.descriptor(), 0) != 0);
    CHECK(ftruncate(memory.descriptor(), 10'000) != 0);
    memory.data()[4999] = std::byte{7};
    const SharedMemory again(dup(memory.descriptor()), 5000);
    CHECK(again.data()[4999] == std::byte{7});
    CHECK_THROWS_AS(SharedMemory(dup(memory.descriptor()), 5001), RunError);
    CHECK_THROWS_AS(SharedMemory(-1, 10), RunError);
    int ends[2];
    REQUIRE(pipe(ends) == 0);
    CHECK_THROWS_AS(SharedMemory(ends[0], 10), RunError);
    close(ends[1]);
}

TEST_CASE("the death of a child is noticed at once, before it is reaped") {
    Busy busy{};
    BellState state{};
    Bell bell(state, busy);
    DeathWatch deaths([&bell] { bell.ring(true); });
    std::vector<std::pair<pid_t, const std::atomic<bool>*>> children;
    for (int c = 0; c < 3; ++c) {
        const pid_t child = fork();
        if (child == 0) {
            pause();
            _exit(0);
        }
        children.emplace_back(child, deaths.watch(child));
        REQUIRE(children.back().second != nullptr);
    }
    for (const auto& [child, ended] : children) {
        CHECK_FALSE(*ended);
        const std::uint32_t seen = bell.rings();
        kill(child, SIGKILL);
        const double wall = seconds_of([&] { bell.wait(seen, 1, std::chrono::seconds(20)); });
        CHECK(*ended);
        CHECK(wall < 10.0);
        CHECK(waitpid(child, nullptr, 0) == child);
    }
}
