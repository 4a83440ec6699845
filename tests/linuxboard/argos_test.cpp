// ARGoS's real-robot program (facts: its serial session) against a scripted main board. The program is not
// part of the project: PUCKLOOP_ARGOS names the folder of a build (argos_epuck, avoid*.argos).

#include "tests/linuxboard/bench.h"

#include <catch2/catch.hpp>

#include <cstdlib>

using namespace puckloop;
using namespace puckloop::cosim;
using namespace puckloop::tests;

namespace {
constexpr std::size_t kHandshakeBytes = 5;  // wake-up and configuration
constexpr std::size_t kFrameBytes = 12;
constexpr std::size_t kStateBytes = 72;
constexpr std::size_t kResetOffset = 10;

struct Session {
    int normal = 0;
    int reset = 0;
    std::string trace;
    std::string log;
    std::vector<std::string> warnings;
    std::optional<Stop> stop;
    std::uint64_t requests = 0;
};

Session run_argos(const std::string& folder, const std::string& experiment, Time slice) {
    linuxboard::LinuxSpec spec = spec_for("echo");
    spec.program = folder + "/argos_epuck";
    spec.args = {"-c", folder + "/" + experiment, "-i", "avoid"};
    Bench bench(std::move(spec), slice);
    bench.add_device(0x60, {{0, 0x03}, {1, 0x20}, {2, 0x02}, {3, 0x10}, {4, 0x01}, {5, 0xff}});
    bench.add_device(0x20, {});
    Session session;
    std::string frame;
    std::size_t handshake = 0;
    bench.on_byte = [&](Time time, std::uint8_t byte) {
        if (handshake < kHandshakeBytes) {
            if (++handshake == kHandshakeBytes)
                bench.send(time + 50 * kMillisecond, std::string(kStateBytes, '\1'));
            return;
        }
        frame += static_cast<char>(byte);
        if (frame.size() < kFrameBytes) return;
        if (frame[kResetOffset] == 'N') {
            ++session.normal;
            bench.send(time + kMillisecond, std::string(kStateBytes, '\1'));
        } else {
            session.reset += frame[kResetOffset] == 'R' ? 1 : 0;
        }
        frame.clear();
    };
    bench.run(70 * kSecond);
    session.trace = bench.trace();
    session.log = bench.log();
    session.warnings = bench.node().warnings();
    session.stop = bench.node().stop();
    session.requests = bench.node().requests();
    return session;
}
}  // namespace

TEST_CASE("ARGoS's real-robot program runs its 60 seconds, the same each time") {
    const char* folder = std::getenv("PUCKLOOP_ARGOS");
    if (folder == nullptr) {
        WARN("skipped: PUCKLOOP_ARGOS does not name a folder with an ARGoS build");
        return;
    }
    for (const char* experiment : {"avoid.argos", "avoid_ground.argos", "avoid_rab.argos"}) {
        const Session first = run_argos(folder, experiment, 70 * kMicrosecond);
        INFO(experiment << "\n" << first.log.substr(0, 2000));
        for (const std::string& warning : first.warnings)
            WARN(warning);
        REQUIRE(first.stop);
        INFO(first.stop->reason);
        CHECK(first.stop->success);
        CHECK(first.normal == 600);
        CHECK(first.reset == 1);
        const Session second = run_argos(folder, experiment, 31 * kMicrosecond);
        CHECK(first.trace == second.trace);
        CHECK(first.log == second.log);
        WARN(experiment << ": " << first.requests << " requests");
    }
}
