// Faults that leave no mark in a trace, taken from the faults.csv beside it.

#include "trace_kit.h"

#include "base/error.h"
#include "traces/decoders/decode.h"
#include "traces/edges.h"
#include "traces/fault_marks.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <filesystem>
#include <fstream>

using namespace puckloop;
using namespace puckloop::cosim;
using namespace puckloop::tests;
using namespace puckloop::tools;

namespace {

constexpr const char* kHead = "fault,kind,place,firing,time_s,from,index,what\n";

/// A results folder with a write of two bytes on bus.i2c, and these firings.
struct Results {
    explicit Results(const std::string& faults) : folder(scratch("marked")) {
        std::filesystem::create_directories(folder);
        I2cScript script(rows, 10 * kMicrosecond);
        script.start(0x40, true, 0);
        bytes.push_back(script.now());
        script.write(0x0c, true, 0);
        bytes.push_back(script.now());
        script.write(0x55, true, 0);
        script.stop();
        std::filesystem::rename(write_trace("marked.csv", rows), folder + "/trace.csv");
        write(faults);
    }
    void write(const std::string& faults) const { std::ofstream(folder + "/faults.csv") << faults; }
    std::vector<DecodedFrame> frames(TraceSelection selection = {}) const {
        std::vector<DecodedFrame> frames;
        decode_trace(RecordedTrace(folder, std::move(selection)),
                     [&](const DecodedFrame& frame) { frames.push_back(frame); });
        return frames;
    }
    std::string folder;
    std::vector<TraceRow> rows;
    std::vector<Time> bytes;
};

std::string firing(const std::string& place, const std::string& kind, Time time, const std::string& what,
                   const std::string& from = "") {
    return fmt::format("a, b,{},{},0,{},{},7,{}\n", kind, place, format_seconds(time), from, what);
}

}  // namespace

TEST_CASE("a fault of a byte on a bus is marked on its transfer, others have a line of their own") {
    Results results(kHead);
    const std::string bus = results.rows.at(0).link.substr(0, results.rows.at(0).link.rfind('.'));
    results.write(kHead + firing(bus, "flip", results.bytes[0], "m 0x20 byte 1 written 0x0c bit 3") +
                  firing("robot0.pic", "reset", 3 * kMicrosecond, "watchdog at pc 0x1CA") +
                  firing("robot0.uart", "drop", 4 * kMicrosecond, "0x41", "robot0.linux") +
                  firing("ether", "loss", kSecond, "data from a to b"));
    const auto frames = results.frames();
    REQUIRE(frames.size() == 3);  // a UART's are marked in its rows
    CHECK(to_text(frames[0]) ==
          "0.000003000000 robot0.pic robot0.pic fault: reset: watchdog at pc 0x1CA  !! fault reset");
    CHECK(frames[1].protocol == "i2c");
    CHECK(frames[1].errors == std::vector<std::string>{"fault flip: m 0x20 byte 1 written 0x0c bit 3"});
    CHECK(frames[2].link == "ether");
    TraceSelection some;
    some.kinds = {"i2c"};
    CHECK(results.frames(some).size() == 1);
    some.kinds = {"radio"};
    REQUIRE(results.frames(some).size() == 1);
    some = {};
    some.until_s = 0.5;
    CHECK(results.frames(some).size() == 2);
    std::filesystem::remove(results.folder + "/faults.csv");
    CHECK(results.frames().size() == 1);
}

TEST_CASE("a fault's line is high while its byte lasts, a line that is held is drawn") {
    Results results(kHead);
    const std::string bus = results.rows.at(0).link.substr(0, results.rows.at(0).link.rfind('.'));
    const Time held = 5 * kMillisecond, until = held + 300 * kMicrosecond;
    results.write(kHead + firing(bus, "nack", results.bytes[1], "m 0x20 byte 2 written 0x55") +
                  firing(bus, "sda", held + 7,
                         fmt::format("m finds the bus busy low from {} until {}", format_seconds(held),
                                     format_seconds(until))));
    const RecordedTrace trace(results.folder, {});
    const FaultMarks marks(trace);
    const LineSurvey found = survey(trace, marks);
    std::map<std::string, std::vector<Time>> changes;
    EdgeStream edges(trace, marks, found);
    while (const auto next = edges.next())
        for (const auto& [line, level] : next->levels)
            changes[found.lines[line].full_name()].push_back(next->time);
    const Time byte = results.bytes[1];
    CHECK(changes[bus + "/fault"] == std::vector<Time>{byte, byte + 90 * kMicrosecond, held, until});
    auto sda = changes[bus + "/sda"];
    REQUIRE(sda.size() > 2);
    CHECK(std::vector<Time>(sda.end() - 2, sda.end()) == std::vector<Time>{held, until});
}

TEST_CASE("of a byte at which a fault took the bus the bits before are drawn, then the line as it was held") {
    Results results(kHead);
    TraceRow request = results.rows.at(0), lost = request;
    const std::string bus = request.link.substr(0, request.link.rfind('.'));
    const Time us = kMicrosecond, start = 20 * kMillisecond, until = start + 300 * us;
    request.time = start;
    request.payload = I2cPhase{I2cPhaseKind::Start, 0xA5, 0, start, 10 * us, 0};  // 1010 0101
    lost.from = bus;
    lost.time = start + 90 * us;
    lost.payload = I2cPhase{I2cPhaseKind::BusLost, 0xA5, 0, start, 10 * us, 0};
    std::ofstream(results.folder + "/trace.csv", std::ios::app) << to_csv(request) << '\n'
                                                                << to_csv(lost) << '\n';
    const auto drawn = [&](const std::string& kind, const std::string& more) {
        results.write(kHead + firing(bus, kind, start, "m 0x52 address byte 0xa5" + more));
        const RecordedTrace trace(results.folder, {});
        const FaultMarks marks(trace);
        const LineSurvey found = survey(trace, marks);
        std::map<std::string, std::vector<double>> changes;
        EdgeStream edges(trace, marks, found);
        while (const auto next = edges.next())
            for (const auto& [line, level] : next->levels)
                if (next->time >= start)
                    changes[found.lines[line].name].push_back(static_cast<double>(next->time - start) / us);
        return changes;
    };
    // Bits 1, 0, and another master's 0 in place of the second 1; its STOP when it lets go.
    auto lines = drawn("lose_arbitration", fmt::format(" bit 5 until {}", format_seconds(until)));
    CHECK(lines["sda"] == std::vector<double>{2.5, 4.375, 12.5, 297.5});
    CHECK(lines["scl"] == std::vector<double>{3.75, 5, 10, 15, 20, 25, 30, 293.75});
    // SDA low from behind the first bit: a 0 fits, at the next 1 the master lets go.
    lines = drawn(
        "sda", fmt::format(" low from {} until {}", format_seconds(start + 11 * us), format_seconds(until)));
    CHECK(lines["sda"] == std::vector<double>{2.5, 4.375, 11, 300});
    CHECK(lines["scl"] == std::vector<double>{3.75, 5, 10, 15, 20, 25});
}

TEST_CASE("a list of firings that nobody wrote is refused in one line, whatever is in it") {
    Results results(kHead);
    std::mt19937 random{Catch::rngSeed() + 1};
    const std::string good =
        kHead + firing("ether", "loss", kSecond, "data from a to b") + firing("x.i2c", "sda", 5, "until 0.1");
    results.write("fault,kind\n");
    CHECK_THROWS_AS(results.frames(), InputError);
    for (int i = 0; i < 300; ++i) {
        std::string text = good;
        for (unsigned n = 0; n <= random() % 4; ++n)
            text[random() % text.size()] = static_cast<char>(random() % 256);
        if (random() % 4 == 0) text.resize(random() % text.size());
        results.write(text);
        try {
            results.frames();
        } catch (const InputError& error) {
            const std::string said = error.what();
            CHECK(said.find("faults.csv: line ") != std::string::npos);
            CHECK(said.find('\n') == std::string::npos);
        }
    }
}
