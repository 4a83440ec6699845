// Files of snapshots: whole or not at all; what is damaged, foreign, older or cut short is refused.

#include "cosim/resume/run_snapshot.h"

#include "base/error.h"
#include "base/random.h"
#include "base/sha256.h"
#include "cosim/resume/sealed_file.h"
#include "cosim/resume/state_file.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>

#include <algorithm>

using namespace puckloop;
using namespace puckloop::cosim;

namespace {

RunSnapshot example() {
    RunSnapshot run;
    run.build = build_id();
    run.origin = "{}";
    run.time = 10 * kSecond;
    run.nodes = {{"robot0.pic", true, {1, 2, 3}, false}, {"robot0.linux", false, {}, true}};
    UartFrame frame;
    frame.start = 9 * kSecond;
    frame.bit_period = 8'680'556;
    run.wires.resize(2);
    run.wires[0].sent = SentRecord(true);
    run.wires[0].sent.add(run.time - 5, frame);
    run.wires[0].faulty = true;
    run.wires[0].arrived = {{run.time - 5, 0, Direction::FromA, 0, FaultKind::Drop, frame}};
    run.stats.resize(2);
    run.stats[1].signals = 7;
    run.in_flight = {{run.time + 5, 0, Direction::FromB, 3, FaultKind::None, Signal{2, -1.5}}};
    run.hash = {4, 5};
    run.stop = StopSnapshot{{run.time - 1, true, "done", 1}, 1};
    run.stop_requests = {*run.stop};
    run.trace = "time_s\n";
    return run;
}

/// Empty: it was read.
std::string problem(const std::vector<std::uint8_t>& bytes) {
    try {
        decode_snapshot(bytes, "x.snap");
    } catch (const InputError& error) {
        return error.what();
    }
    return {};
}

/// With a checksum that fits again.
std::vector<std::uint8_t> sealed(std::vector<std::uint8_t> bytes) {
    bytes.resize(bytes.size() - std::tuple_size_v<Sha256>);
    const Sha256 digest = sha256(bytes);
    bytes.insert(bytes.end(), digest.begin(), digest.end());
    return bytes;
}

}  // namespace

TEST_CASE("a snapshot comes back as it was written") {
    const auto path = tests::scratch_path("run.snap");
    write_snapshot(path, example());
    const RunSnapshot read = read_snapshot(path);
    std::filesystem::remove(path);
    CHECK(encode(read) == encode(example()));
    CHECK(read.nodes[1].name == "robot0.linux");
    REQUIRE(read.wires[0].sent.messages(4).size() == 1);
    CHECK(read.wires[0].sent.messages(4)[0].port == 4);
    CHECK((read.in_flight == example().in_flight));
    CHECK(read.stop->stop.reason == "done");
}

TEST_CASE("what is no snapshot of this build is refused in one line") {
    const auto good = encode(example());
    CHECK(problem(good).empty());
    CHECK(problem({}) == "x.snap: is no snapshot (expected a file written by --save)");
    auto other = good;
    other[0] ^= 1;
    CHECK_THAT(problem(other), Catch::Contains("is no snapshot"));
    other = good;
    other[27] += 1;  // behind the first line
    CHECK_THAT(problem(other), Catch::Contains("of format 2, from another version"));
    other = good;
    other.back() ^= 1;
    CHECK_THAT(problem(other), Catch::Contains("is damaged"));
    RunSnapshot foreign = example();
    foreign.build = "0123456789abcdef";
    CHECK_THAT(problem(encode(foreign)), Catch::Contains("of another build of puckloop (0123456789ab...)"));
    CHECK_THROWS_AS(read_snapshot("/nowhere/x.snap"), InputError);
    CHECK_THROWS_AS(write_snapshot("/nowhere/x.snap", example()), RunError);
}

TEST_CASE("damaged snapshots never do harm") {
    const auto good = encode(example());
    for (std::size_t size = 0; size < good.size(); ++size)
        CHECK_FALSE(problem({good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size)}).empty());
    RandomStream random(18, "damage");
    int refused = 0;
    constexpr int kTries = 20000;
    for (int i = 0; i < kTries; ++i) {
        auto bytes = good;
        for (std::uint64_t flips = 1 + random.below(3); flips > 0; --flips) {
            const auto at = 31 + random.below(bytes.size() - 31);
            bytes[at] = static_cast<std::uint8_t>(random.below(256));
        }
        if (bytes == good) continue;
        CHECK_FALSE(problem(bytes).empty());
        // Even if somebody takes care of the checksum: refused, or read as something.
        if (!problem(sealed(bytes)).empty()) ++refused;
    }
    CHECK(refused > kTries / 3);
}
