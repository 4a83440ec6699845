// The coordinator as a Linux program under the shim: it follows simulated time, so that every byte it sends
// has the same time whatever the grants, and its tables are the same.

#include "linuxboard/coordinator/event_log.h"
#include "linuxboard/shim/node/linux_node.h"
#include "protocols/serial/uart_sampling.h"
#include "tests/coordinator/simulated_mesh.h"
#include "tests/kit/files.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>

#include <deque>
#include <filesystem>
#include <fmt/format.h>

using namespace puckloop;
using namespace puckloop::coordinator;
using namespace puckloop::coordinator::test;
using cosim::Time;

namespace {

constexpr Time kBit = cosim::kSecond / 9600;

struct Run {
    std::string trace;  ///< start and value of every byte that the program sent
    std::string table, picture, report;
    double simulated = 0;
    bool success = false;
};

/// 40 s of random-task with two TAMs and a robot; grants of `slice`, at most the 9 bits that a byte takes.
Run perform(Time slice, const std::string& seed, bool wind_up) {
    const std::filesystem::path folder = tests::scratch_path("coordinator-shim");
    std::filesystem::create_directories(folder);
    SimulatedMesh mesh({.window = 10});
    SimulatedTam& a = mesh.add("TAM01", 0x0013A200408A3101);
    mesh.add("TAM02", 0x0013A200408A3102);
    mesh.plan(10, [&] { mesh.set_robot(a, true, 10); });
    mesh.plan(18, [&] { mesh.set_robot(a, false, 18); });

    linuxboard::LinuxSpec spec;
    spec.name = "coordinator";
    spec.program = PUCKLOOP_COORDINATOR;
    spec.args = {"--seed", seed, "--durations", "3,4", "--dead-time", "2"};
    if (!wind_up) spec.args.insert(spec.args.end(), {"--duration", "35"});
    spec.tty = "/dev/ttyUSB0";
    spec.i2c = {};
    spec.cwd = folder.string();
    spec.grace = 15 * cosim::kSecond;
    Run run;
    {
        linuxboard::LinuxNode node(spec);
        std::deque<cosim::Message> coming;
        bool asked = false;
        for (Time now = 0; now < 60 * cosim::kSecond && !node.stop(); now += slice) {
            if (wind_up && !asked && now >= 35 * cosim::kSecond) {
                node.wind_up(now, 0);
                asked = true;
            }
            if (asked && node.wound_up() <= now) break;
            std::vector<cosim::Message> inbox, outbox;
            while (!coming.empty() && coming.front().time < now + slice) {
                inbox.push_back(coming.front());
                coming.pop_front();
            }
            node.advance(now + slice, inbox, outbox);
            for (const cosim::Message& message : outbox) {
                const auto& frame = std::get<cosim::UartFrame>(message.payload);
                run.trace += fmt::format("{} {:02x}\n", frame.start, frame.data);
                const double arrives = cosim::to_seconds(frame.start + 10 * kBit);
                mesh.plan(arrives, [&mesh, frame, arrives] {
                    mesh.take(static_cast<std::uint8_t>(frame.data), arrives);
                });
            }
            // One byte at a time, each stamped behind what was granted, at a time that no slice changes.
            for (double due = mesh.next(); due <= cosim::to_seconds(now + slice); due = mesh.next()) {
                for (const std::uint8_t byte : mesh.give(due)) {
                    cosim::UartFrame frame;
                    frame.start = cosim::from_seconds(due);
                    frame.bit_period = kBit;
                    frame.data = byte;
                    coming.push_back({protocols::stop_bit_start(frame), linuxboard::kUartPort, frame});
                }
            }
            run.simulated = cosim::to_seconds(now);
        }
        if (const auto stop = node.stop()) run.success = stop->success;
        run.report = node.finish();
    }
    run.table = tests::text_of(folder / "tam_events.csv");
    run.picture = tests::text_of(folder / "tam_gantt.svg");
    std::filesystem::remove_all(folder);
    return run;
}

}  // namespace

TEST_CASE("under the shim the coordinator is the same in every byte, however time is granted") {
    const Run run = perform(900 * cosim::kMicrosecond, "5", false);
    CHECK(run.success);
    CHECK(run.table.find(",TAM01,task,done,") != std::string::npos);
    CHECK(run.table.find(",TAM02,state,offer ") != std::string::npos);
    CHECK(run.table.find(",,ended,duration,") != std::string::npos);
    CHECK(run.picture.find("TAM02") != std::string::npos);
    const Run other = perform(311 * cosim::kMicrosecond, "5", false);
    CHECK(run.trace == other.trace);
    CHECK(run.table == other.table);
    CHECK(run.picture == other.picture);
    CHECK(perform(900 * cosim::kMicrosecond, "6", false).trace != run.trace);
}

TEST_CASE("a run that ends asks the coordinator to: LEDs off, table complete") {
    const Run run = perform(900 * cosim::kMicrosecond, "5", true);
    CHECK(run.table.find(",,ended,signal,") != std::string::npos);
    CHECK(run.table.find("not confirmed") == std::string::npos);
    CHECK(run.picture.find("</svg>") != std::string::npos);
    CHECK(run.simulated < 38);
}
