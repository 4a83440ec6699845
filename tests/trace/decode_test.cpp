// `puckloop trace decode` against records drawn at random, with what was done to them, and a run of boards.

#include "trace_kit.h"

#include "base/error.h"
#include "protocols/infrared/rab_frame.h"
#include "protocols/radio/xbee_frame.h"
#include "protocols/radio/xbee_message.h"
#include "protocols/serial/epuck_serial.h"
#include "protocols/serial/uart_sampling.h"
#include "traces/decoders/decode.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <fstream>
#include <random>
#include <sstream>

using namespace puckloop;
using namespace puckloop::cosim;
using namespace puckloop::tests;
using tools::DecodedFrame;

namespace {

std::vector<DecodedFrame> decode(const std::vector<TraceRow>& rows) {
    std::vector<DecodedFrame> frames;
    tools::decode_trace(tools::RecordedTrace(write_trace("decode.csv", rows), {}),
                        [&](const DecodedFrame& frame) { frames.push_back(frame); });
    return frames;
}

/// Puts bytes on a line, one behind the other.
struct Talk {
    std::vector<TraceRow> rows;
    Time now = kMillisecond;
    void say(const std::string& link, const std::string& from, std::span<const std::uint8_t> bytes) {
        for (const std::uint8_t byte : bytes) {
            const UartFrame frame{now, kSecond / 115200, byte};
            rows.push_back(uart_row(link, from, frame));
            now = protocols::frame_end(frame);
        }
        now += kMillisecond;
    }
};

protocols::EpuckActuators actuators_of(std::mt19937& random) {
    protocols::EpuckActuators out;
    out.left = static_cast<std::int16_t>(random() % 2001) - 1000;
    out.right = static_cast<std::int16_t>(random() % 2001) - 1000;
    out.ring_leds = static_cast<std::uint8_t>(random());
    return out;
}

/// A session of `cycles` cycles; the rows and what the actuators were.
std::pair<Talk, std::vector<protocols::EpuckActuators>> session(std::mt19937& random, int cycles) {
    Talk talk;
    std::vector<protocols::EpuckActuators> sent;
    talk.say("r.uart", "r.linux", std::vector<std::uint8_t>{1, 7, 0, 0, 0});
    for (int i = 0; i < cycles; ++i) {
        protocols::EpuckSensors sensors;
        sensors.battery_ok = 1;
        for (auto& one : sensors.light)
            one = static_cast<std::int16_t>(random() % 4096);
        talk.say("r.uart", "r.pic", protocols::encode(sensors));
        sent.push_back(actuators_of(random));
        if (i + 1 == cycles) sent.back().reset = protocols::kEpuckEnd;
        talk.say("r.uart", "r.linux", protocols::encode(sent.back()));
    }
    return {talk, sent};
}

}  // namespace

TEST_CASE("e-puck records of both directions are found, two sessions in a row") {
    std::mt19937 random{Catch::rngSeed()};
    INFO("seed " << Catch::rngSeed());
    auto [talk, sent] = session(random, 12);
    auto [again, more] = session(random, 3);
    for (TraceRow row : again.rows) {
        std::get<UartFrame>(row.payload).start += talk.now;
        row.time += talk.now;
        talk.rows.push_back(row);
    }
    sent.insert(sent.end(), more.begin(), more.end());
    std::size_t at = 0, sensors = 0, sessions = 0;
    for (const DecodedFrame& frame : decode(talk.rows)) {
        INFO(to_text(frame));
        CHECK(frame.errors.empty());
        const std::string record = frame.fields.at("record");
        sensors += record == "sensors" ? 1U : 0U;
        sessions += record == "session" ? 1U : 0U;
        if (record != "actuators") continue;
        REQUIRE(at < sent.size());
        CHECK(frame.fields.at("left") == sent[at].left);
        CHECK(frame.fields.at("right") == sent[at].right);
        CHECK(frame.fields.at("ring_leds") == sent[at].ring_leds);
        ++at;
    }
    CHECK(at == 15);
    CHECK(sensors == 15);
    CHECK(sessions == 2);
}

TEST_CASE("a byte lost in an e-puck record is reported at its place, and decoding goes on behind it") {
    std::mt19937 random{Catch::rngSeed()};
    INFO("seed " << Catch::rngSeed());
    for (int round = 0; round < 20; ++round) {
        auto [talk, sent] = session(random, 6);
        std::vector<std::size_t> from_board;
        for (std::size_t i = 0; i < talk.rows.size(); ++i)
            if (talk.rows[i].from == "r.pic") from_board.push_back(i);
        // Any but the last record, whose rest has no other end than the trace's.
        TraceRow& harmed = talk.rows[from_board[random() % (5 * protocols::kEpuckSensorBytes)]];
        harmed.fault = FaultKind::Drop;
        std::vector<DecodedFrame> bad;
        std::size_t good = 0;
        for (const DecodedFrame& frame : decode(talk.rows)) {
            if (!frame.errors.empty()) bad.push_back(frame);
            good += frame.errors.empty() && frame.fields.at("record") == "sensors" ? 1U : 0U;
        }
        CHECK(bad.size() == 1);
        REQUIRE(!bad.empty());
        CHECK(bad[0].begin <= std::get<UartFrame>(harmed.payload).start);
        CHECK(bad[0].end >= std::get<UartFrame>(harmed.payload).start);
        CHECK_THAT(bad[0].errors[0],
                   Catch::Contains("fault drop: lost") &&
                       Catch::Contains(format_seconds(std::get<UartFrame>(harmed.payload).start)));
        CHECK(good == 5);
    }
}

TEST_CASE("what Linux sent is called out of step when the board answers early") {
    std::mt19937 random{5};
    auto [talk, sent] = session(random, 2);
    // One byte more before the first actuators.
    const auto first = std::find_if(talk.rows.begin() + 5, talk.rows.end(),
                                    [](const TraceRow& row) { return row.from == "r.linux"; });
    TraceRow extra = *first;
    std::get<UartFrame>(extra.payload).data = 0xAA;
    talk.rows.insert(first, extra);
    std::size_t out_of_step = 0;
    for (const DecodedFrame& frame : decode(talk.rows))
        for (const std::string& error : frame.errors)
            out_of_step += error.find("out of step") != std::string::npos ? 1U : 0U;
    CHECK(out_of_step == 1);
}

TEST_CASE("XBee frames are found and their errors named") {
    std::mt19937 random{Catch::rngSeed()};
    INFO("seed " << Catch::rngSeed());
    Talk talk;
    std::vector<std::string> data;
    for (int i = 0; i < 30; ++i) {
        protocols::XBeeTx tx;
        for (std::size_t n = random() % 20 + 1; n > 0; --n)
            tx.data.push_back(static_cast<std::uint8_t>(random()));
        auto bytes = protocols::encode_xbee(protocols::encode(protocols::XBeeMessage(tx)),
                                            protocols::XBeeApiMode::Escaped);
        data.push_back(i % 3 == 1 ? "" : hex_of(Octets(tx.data)));
        if (i % 3 == 1)
            bytes[1 + bytes.size() / 2] ^= 0x01;  // may become an escape or a start: any error will do
        talk.say("t.xbee", "t.xbee", bytes);
    }
    std::vector<std::string> found, wanted;
    std::size_t errors = 0;
    for (const DecodedFrame& frame : decode(talk.rows)) {
        CHECK(frame.protocol == "xbee");
        errors += frame.errors.empty() ? 0U : 1U;
        if (!frame.errors.empty() || !frame.fields.contains("data")) continue;
        std::string text = frame.fields.at("data");
        std::erase(text, ' ');
        found.push_back(text);
    }
    for (const std::string& one : data)
        if (!one.empty()) wanted.push_back(one);
    CHECK(errors >= 10);
    for (const std::string& one : wanted)
        CHECK(std::count(found.begin(), found.end(), one) >= 1);
}

TEST_CASE("I2C transfers have their registers' names and their errors") {
    std::vector<TraceRow> rows;
    I2cScript script(rows, 10 * kMicrosecond);
    script.start(0x40, true, 0);
    script.write(12, true, 0);
    script.write(115, false, 0);
    script.stop();
    script.start(0x40, true, 0);
    script.write(3, true, 0);
    script.start(0x41, true, 0);
    script.read(0x65, false, 0);
    script.stop();
    script.start(0x84, false, 0);
    script.stop();
    const auto frames = decode(rows);
    REQUIRE(frames.size() == 3);
    CHECK(frames[0].text == "0x20 rab write RANGE(12) = 73");
    CHECK(frames[0].errors == std::vector<std::string>{"byte 2 not acknowledged"});
    CHECK(frames[1].text == "0x20 rab write select 3 | 0x20 rab read BEARING_HIGH(3) = 65");
    CHECK(frames[1].errors.empty());
    CHECK(frames[2].errors == std::vector<std::string>{"address 0x42 not acknowledged"});
}

TEST_CASE("infra-red frames of range-and-bearing boards are read from their emitters") {
    std::mt19937 random{Catch::rngSeed()};
    INFO("seed " << Catch::rngSeed());
    std::vector<TraceRow> rows;
    std::vector<std::uint32_t> payloads;
    Time now = kMillisecond;
    constexpr Time kChip = 98'085 * kNanosecond;
    for (int i = 0; i < 10; ++i) {
        payloads.push_back(static_cast<std::uint32_t>(random() % 65536));
        bool level = false;
        for (const char chip : protocols::encode_rab(16, payloads.back()) + "0") {
            if ((chip == '1') != level) {
                level = !level;
                for (int emitter = 1; emitter <= 12; ++emitter)
                    rows.push_back({now, "r.ir", "r.rab", fmt::format("emitter{}", emitter), FaultKind::None,
                                    Signal{static_cast<std::uint16_t>(23 + emitter), level ? 1.0 : 0.0}});
            }
            now += kChip + static_cast<Time>(random() % 1000) * 1000;
        }
        now += kMillisecond;
    }
    std::vector<std::uint32_t> found;
    for (const DecodedFrame& frame : decode(rows)) {
        INFO(to_text(frame));
        CHECK(frame.errors.empty());
        CHECK(frame.fields.at("emitters") == "all");
        if (frame.fields.contains("payload")) found.push_back(frame.fields.at("payload"));
    }
    CHECK(found == payloads);
}

TEST_CASE("no damaged trace brings decoding down") {
    std::mt19937 random{Catch::rngSeed()};
    INFO("seed " << Catch::rngSeed());
    auto [talk, sent] = session(random, 2);
    I2cScript script(talk.rows, 10 * kMicrosecond);
    script.start(0x41, true, 0);
    script.read(0x55, false, 0);
    script.stop();
    std::string whole = std::string(kTraceColumns) + "\n";
    for (const TraceRow& row : talk.rows)
        whole += to_csv(row) + "\n";
    const std::string file = scratch("damaged.csv");
    for (int i = 0; i < 300; ++i) {
        std::string text = whole;
        for (std::size_t n = 1 + random() % 6; n > 0; --n) {
            const std::size_t at = random() % text.size();
            if (random() % 2 == 0)
                text[at] = "0123456789,.:abcdef\n\"-"[random() % 22];
            else
                text.erase(at, 1 + random() % 150);
        }
        std::ofstream(file, std::ios::binary) << text;
        try {
            tools::decode_trace(tools::RecordedTrace(file, {}), [](const DecodedFrame& frame) {
                to_text(frame);
                to_json(frame);
            });
        } catch (const InputError& error) {
            CHECK_THAT(error.what(), Catch::Contains(file + ": line "));
        }
    }
    const Called none = tests::puckloop("trace decode /nonexistent");
    CHECK(none.status == 2);
    CHECK_THAT(none.out, Catch::Contains("no such file"));
}

TEST_CASE("a trace that grows meanwhile is decoded as far as it was at the beginning") {
    Talk talk;
    const std::vector<std::uint8_t> some{0x41, 0x42};
    talk.say("robot0.uart1", "robot0.pic", some);
    const std::string file = write_trace("grows.csv", talk.rows);
    Talk late = talk;
    late.rows.clear();
    late.say("robot1.uart1", "robot1.pic", some);
    std::ifstream more(write_trace("grows_more.csv", late.rows));
    std::string header, added;
    std::getline(more, header);
    std::stringstream rest;
    rest << more.rdbuf();
    added = rest.str();
    // A line that nobody knew of comes between the two readings.
    bool grown = false;
    std::size_t bytes = 0;
    const tools::RecordedTrace trace(file, {});
    tools::decode_trace(trace,
                        [&](const DecodedFrame& frame) { bytes += frame.link == "robot0.uart1" ? 1 : 100; },
                        {[&](const TraceRow&) {
                             if (!grown) std::ofstream(file, std::ios::app) << added << std::flush;
                             grown = true;
                         },
                         {}});
    CHECK(grown);
    CHECK((bytes > 0 && bytes < 100));
    std::size_t rows = 0;
    trace.for_each_checked([&](const TraceRow&) { ++rows; });
    CHECK(rows == talk.rows.size());
    rows = 0;
    tools::RecordedTrace(file, {}).for_each_checked([&](const TraceRow&) { ++rows; });
    CHECK(rows == talk.rows.size() + late.rows.size());
}

TEST_CASE("a trace whose run went back between two readings has other links") {
    Talk talk;
    const std::vector<std::uint8_t> some{0x41, 0x42, 0x43};
    talk.say("robot0.uart1", "robot0.pic", some);
    const std::string file = write_trace("back.csv", talk.rows);
    Talk other;
    other.say("robot1.uart1", "robot1.pic", some);
    tools::decode_trace(tools::RecordedTrace(file, {}),
                        [&](const DecodedFrame& frame) { CHECK(frame.link != "robot1.uart1"); },
                        {[&](const TraceRow&) {
                             const std::string again = write_trace("back_again.csv", other.rows);
                             std::ofstream(file) << std::ifstream(again).rdbuf();
                         },
                         {}});
}
