#include "toy_run.h"

#include "base/error.h"
#include "base/random.h"
#include "cosim/trace/trace_csv.h"
#include "cosim/trace/trace_hash.h"
#include "cosim/trace/trace_merger.h"
#include "cosim/trace/trace_stats.h"
#include "protocols/serial/irda.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <unistd.h>

using namespace puckloop;
using namespace puckloop::cosim;

namespace {

std::vector<TraceRow> some_rows() {
    std::vector<TraceRow> rows;
    rows.push_back({kSecond + 1, "robot0.uart", "robot0.pic", "", FaultKind::None,
                    UartFrame{kSecond - 78'125'000, 8'680'555, 0x4e, 8, 0, 1, 0, 0}});
    rows.push_back({kSecond + 2, "robot0.uart", "robot0.linux", "", FaultKind::Flip,
                    UartFrame{kSecond, 8'680'555, 0x1a5, 9, 2, 2, 1, 0}});
    rows.push_back({kSecond + 3, "robot0.uart", "robot0.linux", "", FaultKind::None,
                    UartFrame{kSecond, 8'680'555, 0, 8, 0, 1, 0, 1}});
    for (const I2cPhaseKind kind : {I2cPhaseKind::Start, I2cPhaseKind::Write, I2cPhaseKind::Stop,
                                    I2cPhaseKind::Data, I2cPhaseKind::BusLost})
        rows.push_back({kSecond + 4, "robot0.i2c", "bus", "", FaultKind::None,
                        I2cPhase{kind, 0xc1, 0, kSecond, 2'500'000, 17}});
    for (const I2cPhaseKind kind : {I2cPhaseKind::Read, I2cPhaseKind::Acknowledge})
        for (const std::uint8_t ack : {std::uint8_t{0}, std::uint8_t{1}})
            rows.push_back({kSecond + 5, "robot0.i2c", "bus", "", FaultKind::None,
                            I2cPhase{kind, 0x60, ack, kSecond, 2'500'000, 0}});
    rows.push_back({2 * kSecond, "a, \"b\"", "world", "", FaultKind::None, Signal{17, 0.1}});
    rows.push_back({3 * kSecond, "world0", "robot0.pic", "wheel_left", FaultKind::None, Signal{0, -1e-17}});
    const std::vector<std::uint8_t> octets{0x00, 0x7e, 0xff};
    rows.push_back({kSecond, "tam0.radio", "ether", "", FaultKind::None,
                    RadioFrame{kSecond - 288'000'000, 288'000'000, Octets(octets), 12, -60}});
    CanMessage can;
    can.start = kMillisecond;
    can.bit_time = 2'000'000;
    can.tag = 2;
    const auto add = [&](CanKind kind) {
        can.kind = kind;
        rows.push_back({kSecond, "can.robot0.pic.can1", "can", "", FaultKind::None, can});
    };
    can.data = {16, 12, 4};
    can.flags = kCanListens;
    add(CanKind::Join);
    can.data = {};
    can.flags = 0;
    for (const CanKind kind : {CanKind::Watch, CanKind::Leave, CanKind::Withdraw, CanKind::Withdrawn,
                               CanKind::Recovered, CanKind::Wake, CanKind::Error})
        add(kind);
    can.id = 0x123;
    can.data = {0, 0xff};
    can.length = 2;
    add(CanKind::Offer);
    can.flags = kCanLost | kCanGone;
    add(CanKind::Received);
    can.transmit_errors = 256;
    can.receive_errors = 9;
    can.position = 34;
    for (int error = 1; error <= kMostCanError; ++error) {
        can.flags = static_cast<std::uint8_t>(kCanSender | error << kCanErrorShift);
        add(CanKind::Error);
    }
    can.id = 0x1abcdef0;
    can.data = {};
    can.position = 0;
    can.flags = kCanExtended | kCanRemote;
    add(CanKind::Sent);
    return rows;
}

std::string temporary(const std::string& name) {
    return (std::filesystem::temp_directory_path() / fmt::format("{}.{}", name, getpid())).string();
}

}  // namespace

TEST_CASE("rows go to text and back without loss") {
    for (const TraceRow& row : some_rows()) {
        INFO(to_csv(row));
        CHECK(parse_trace_row(to_csv(row), "trace.csv", 2) == row);
    }
    CHECK(to_csv(some_rows()[0]) ==
          "1.000000000001,robot0.uart,robot0.pic,uart,4e,8N1,0.999921875000,0.000008680555,,");
    CHECK(to_csv(some_rows().back()) ==
          "1.000000000000,can.robot0.pic.can1,can,can,1abcdef0#R2,sent tag 2 tec 256 rec 9,"
          "0.001000000000,0.000002000000,,");
    const auto rows = some_rows();
    const auto radio =
        std::find_if(rows.begin(), rows.end(), [](const TraceRow& row) { return row.link == "tam0.radio"; });
    REQUIRE(radio != rows.end());
    CHECK(to_csv(*radio) ==
          "1.000000000000,tam0.radio,ether,radio,007eff,ch12 -60dBm,0.999712000000,0.000288000000,,");
    CHECK(format_seconds(-1) == "-0.000000000001");
}

TEST_CASE("damaged rows are refused with file and line, never more") {
    const auto refused = [](const std::string& text, const std::string& why) {
        CHECK_THROWS_WITH(parse_trace_row(text, "trace.csv", 7),
                          Catch::StartsWith("trace.csv: line 7: ") && Catch::Contains(why));
    };
    refused("", "1 fields");
    refused("1.5,l,n,uart,4e,8N1,0.000000000000,0.000000000000,,", "\"1.5\" is no time");
    refused("1.000000000000,l,n,smoke,4e,8N1,0.000000000000,0.000000000000,,", "no kind of message");
    refused("1.000000000000,l,n,uart,zz,8N1,0.000000000000,0.000000000000,,", "\"zz\" is no data");
    refused("1.000000000000,l,n,uart,4e,8X1,0.000000000000,0.000000000000,,", "no frame format");
    refused("1.000000000000,l,n,i2c,4e,jump,0.000000000000,0.000000000000,0.000000000000,", "no I2C phase");
    refused("1.000000000000,l,n,signal,4e!,a,,,,", "no value");
    refused("1.000000000000,l,n,uart,4e,8N1,0.000000000000,0.000000000000,,worn", "no fault");
    refused("1.000000000000,l,n,radio,7ef,ch12 -60dBm,0.000000000000,0.000000000000,,", "no radio frame");
    refused("1.000000000000,l,n,radio,,ch12 -60dBm,0.000000000000,0.000000000000,,", "no radio frame");
    refused("1.000000000000,l,n,radio,7e,ch12 -600dBm,0.000000000000,0.000000000000,,", "no channel");
    refused("1.000000000000,l,n,radio,7e,ch,0.000000000000,0.000000000000,,", "no channel");
    RandomStream random(1, "rows");
    const auto rows = some_rows();
    for (int round = 0; round < 5000; ++round) {
        std::string text = to_csv(rows[random.below(rows.size())]);
        for (std::uint64_t i = 1 + random.below(3); i > 0; --i)
            text[random.below(text.size())] = static_cast<char>(32 + random.below(95));
        try {
            parse_trace_row(text, "trace.csv", 1);
        } catch (const InputError&) {
        }
    }
}

TEST_CASE("a recorded run reads back as it was") {
    const std::string path = temporary("trace.csv");
    toy::Run run = toy::random_chatter(6, 4);
    toy::Recorder recorder;
    {
        TraceCsvSink csv(path);
        Conductor conductor(run.nodes, run.links, {}, run.options, toy::make);
        conductor.add_sink(recorder);
        conductor.add_sink(csv);
        REQUIRE(conductor.run().reason == EndReason::Duration);
    }
    std::vector<TraceRow> expected, got;
    for (const TraceRecord& record : recorder.records)
        expected.push_back(to_row(record, run.links));
    std::ifstream in(path);
    CHECK(read_trace(in, path, [&](const TraceRow& row) { got.push_back(row); }));
    CHECK(got == expected);
    // What one direction sends may be left out of the file; the hash does not see that.
    std::filesystem::remove(path);
}

TEST_CASE("a trace whose writer was killed is read up to its last whole line") {
    std::string text =
        std::string(kTraceColumns) + "\n" + to_csv(some_rows()[0]) + "\n" + to_csv(some_rows()[1]);
    text.resize(text.size() - 4);
    std::istringstream in(text);
    int rows = 0;
    CHECK_FALSE(read_trace(in, "trace.csv", [&](const TraceRow&) { ++rows; }));
    CHECK(rows == 1);
    std::istringstream other("time,what\n");
    CHECK_THROWS_WITH(read_trace(other, "x.csv", [](const TraceRow&) {}),
                      Catch::Contains("x.csv: line 1: no recorded trace"));
}

TEST_CASE("a full disk is one clear error, and ends the run") {
    toy::Run run = toy::random_chatter(6, 4);
    run.options.duration = 10 * kSecond;
    TraceCsvSink csv("/dev/full");
    Conductor conductor(run.nodes, run.links, {}, run.options, toy::make);
    conductor.add_sink(csv);
    const Outcome outcome = conductor.run();
    CHECK(outcome.reason == EndReason::Failed);
    CHECK(outcome.text ==
          "/dev/full: cannot write: No space left on device; what was written before is kept");
    CHECK(outcome.node.empty());
    CHECK(outcome.simulated < kSecond);
    for (const auto& node : outcome.nodes)
        CHECK(node.json != "");
    CHECK_THROWS_AS(TraceCsvSink("/nonexistent/folder/trace.csv"), RunError);
}

TEST_CASE("links choose what is written, not what is hashed") {
    const std::string path = temporary("part.csv");
    toy::Run run = toy::random_chatter(6, 4);
    const std::string hash = run().trace_sha256;
    for (LinkSpec& link : run.links)
        link.record_from_b = false;
    std::string part;
    {
        TraceCsvSink csv(path);
        Conductor conductor(run.nodes, run.links, {}, run.options, toy::make);
        conductor.add_sink(csv);
        part = conductor.run().trace_sha256;
    }
    CHECK(part == hash);
    std::ifstream in(path);
    int rows = 0;
    read_trace(in, path, [&](const TraceRow& row) {
        ++rows;
        for (const LinkSpec& link : run.links)
            if (link.name == row.link) CHECK(link.a.node == row.from);
    });
    CHECK(rows > 0);
    std::filesystem::remove(path);
}

TEST_CASE("the merger holds back what may still be preceded") {
    TraceMerger merger;
    std::vector<Time> out;
    const auto release = [&](Time floor) {
        std::vector<TraceRecord> batch;
        merger.take(floor, batch);
        TraceMerger::sort(batch);
        for (const TraceRecord& record : batch)
            out.push_back(record.time);
    };
    for (const Time time : {30, 10, 20, 25})
        merger.add({time, 0, Direction::FromA, static_cast<std::uint64_t>(time), FaultKind::None, Signal{}});
    release(21);
    CHECK(out == std::vector<Time>{10, 20});
    CHECK(merger.waiting() == 2);
    release(kNever);
    CHECK(out == std::vector<Time>{10, 20, 25, 30});
}

TEST_CASE("the hash is a fixed function of the messages") {
    toy::Run run{{{"left", "echo first=1"}, {"right", "echo delay_us=100"}},
                 {toy::uart("wire", {"left", "uart0"}, {"right", "uart0"})}};
    run.options.duration = kMillisecond;
    run.options.in_process = true;
    // Worked out from the documented form by a program of another language; changes only with that form.
    CHECK(run().trace_sha256 == "150ed69d5056d0be8c6bcb8e1d605bcdf15862079287630d578bbdb0c34ccbe2");
}

TEST_CASE("a link that only hands use is in the hash once they do") {
    const LinkSpec wire{"wire", {"left", "uart0"}, {"right", "uart0"}};
    LinkSpec hands{"hands", {"left", "hands"}, {"right", "hands"}};
    hands.hashed_when_unused = false;
    const auto hash_of = [](const std::vector<LinkSpec>& links, bool used) {
        TraceHash hash;
        hash.begin(links);
        TraceRecord record{};
        record.link = 1;
        record.payload = Signal{1, 2.0};
        if (used) hash.record(record);
        return hash.finish();
    };
    const std::string plain = hash_of({wire}, false);
    CHECK(hash_of({wire, hands}, false) == plain);
    CHECK(hash_of({wire, hands}, true) != plain);
    LinkSpec other = hands;
    other.hashed_when_unused = true;
    CHECK(hash_of({wire, other}, false) != plain);
}

TEST_CASE("statistics of a trace") {
    TraceStats stats;
    for (const TraceRow& row : some_rows())
        stats.add(row);
    CHECK_THAT(stats.text(), Catch::Contains("robot0.i2c"));
    CHECK_THAT(stats.json(), Catch::Contains("\"messages\": 31") && Catch::Contains("\"i2c_nacks\": 1") &&
                                 Catch::Contains("\"uart_breaks\": 1") &&
                                 Catch::Contains("\"radio_frames\": 1, \"radio_octets\": 3") &&
                                 Catch::Contains("\"link\": \"a, \\\"b\\\"\""));
}

TEST_CASE("the merger does not go through what waits again and again") {
    TraceMerger merger;
    std::vector<TraceRecord> batch;
    int releases = 0;
    constexpr int kRecords = 20'000;
    for (int i = 0; i < kRecords; ++i) {
        merger.add({kSecond, 0, Direction::FromA, static_cast<std::uint64_t>(i), FaultKind::None, Signal{}});
        if (!merger.full()) continue;
        merger.take(kSecond, batch);  // none is due
        ++releases;
    }
    CHECK(releases > 0);
    CHECK(releases < 10);
    merger.take(kNever, batch);
    CHECK(merger.waiting() == 0);
}

namespace {

/// A row as the format's comment has it, written plainly.
std::string plain_row(const TraceRow& row) {
    const auto seconds = [](Time time) {
        const Time size = std::abs(time);
        return fmt::format("{}{}.{:012}", time < 0 ? "-" : "", size / kSecond, size % kSecond);
    };
    std::string text = seconds(row.time) + "," + row.link + "," + row.from + ",";
    if (const auto* frame = std::get_if<UartFrame>(&row.payload)) {
        text += frame->is_break ? "break,," : fmt::format("uart,{:02x},", frame->data);
        text += fmt::format("{}{}{}", frame->data_bits, "NOE"[frame->parity], frame -> stop_bits);
        if (frame->parity != 0) text += frame->parity_bit ? " p1" : " p0";
        const bool infrared = frame->glitch_width == 0xFFFFFFFF;
        if (infrared) text += " irda";
        if (frame->line & 1) text += " inverted";
        if (frame->line & 2) text += " low";
        if (frame->glitch_width != 0 && !infrared)
            text += fmt::format(" glitch {}+{}ns", frame->glitch_at, frame->glitch_width);
        text += fmt::format(",{},{},", seconds(frame->start), seconds(frame->bit_period));
    } else if (const auto* phase = std::get_if<I2cPhase>(&row.payload)) {
        const char* const kinds[] = {
            "start", "write", phase->ack ? "read+ack" : "read+nack", "stop", phase->ack ? "ack" : "nack",
            "data",  "lost"};
        text += fmt::format("i2c,{:02x},{},{},{},{}", phase->byte, kinds[static_cast<int>(phase->kind)],
                            seconds(phase->start), seconds(phase->clock_period), seconds(phase->stretch));
    } else {
        const auto& signal = std::get<Signal>(row.payload);
        text += fmt::format("signal,{},{},,,", signal.value,
                            row.signal.empty() ? fmt::format("#{}", signal.id) : row.signal);
    }
    return text + "," + std::string(fault_name(row.fault));
}

Time random_time(RandomStream& chance) {
    return static_cast<Time>(chance.next() >> (1 + chance.below(62))) -
           (chance.below(4) == 0 ? 1'000'000 : 0);
}

double random_value(RandomStream& chance) {
    constexpr double kOdd[] = {0.0,     -0.0,  1e15,    999999999999999.0,   1e16, 1e-7, 0.1, -1.0,
                               4095.25, 1e300, -1e-300, 123456789012345680.0};
    switch (chance.below(5)) {
    case 0:
        return kOdd[chance.below(std::size(kOdd))];
    case 1:
        return static_cast<double>(chance.below(5000));
    case 2:
        return 0.25 * static_cast<double>(chance.below(20000));
    case 3:
        return -static_cast<double>(chance.below(100000));
    default:
        return chance.normal() * std::pow(10.0, static_cast<double>(chance.below(30)) - 10.0);
    }
}

Payload random_payload(RandomStream& chance) {
    const auto bit = [&] { return static_cast<std::uint8_t>(chance.below(2)); };
    switch (chance.below(3)) {
    case 0: {
        UartFrame frame;
        frame.start = random_time(chance);
        frame.bit_period = random_time(chance);
        frame.data = static_cast<std::uint16_t>(chance.below(512));
        frame.data_bits = static_cast<std::uint8_t>(5 + chance.below(5));
        frame.parity = static_cast<std::uint8_t>(chance.below(3));
        frame.stop_bits = static_cast<std::uint8_t>(1 + bit());
        frame.parity_bit = bit();
        frame.is_break = bit();
        if (bit()) frame.line = static_cast<std::uint8_t>(chance.below(4));
        if (bit()) {
            frame.glitch_at = static_cast<std::uint32_t>(chance.below(1ull << 32));
            frame.glitch_width = static_cast<std::uint32_t>(1 + chance.below(100'000));
        }
        if (chance.below(4) == 0) protocols::set_infrared(frame);
        return frame;
    }
    case 1:
        return I2cPhase{static_cast<I2cPhaseKind>(chance.below(7)),
                        static_cast<std::uint8_t>(chance.below(256)),
                        bit(),
                        random_time(chance),
                        random_time(chance),
                        random_time(chance)};
    default:
        return Signal{static_cast<std::uint16_t>(chance.below(6)), random_value(chance)};
    }
}

}  // namespace

TEST_CASE("rows are written as in their plain form") {
    const std::string path = temporary("rows.csv");
    std::vector<LinkSpec> links(2);
    for (std::size_t i = 0; i < links.size(); ++i) {
        links[i].name = fmt::format("robot{}.world", i);
        links[i].a = {fmt::format("robot{}.pic", i), "world"};
        links[i].b = {"world", fmt::format("robot{}.board", i)};
        links[i].signal_names = {"proximity0", "acc_x", "wheel_left"};  // ids 3 to 5 have no name
    }
    links[1].record_from_b = false;
    RandomStream chance(11, "rows");
    std::vector<std::string> expected;
    {
        TraceCsvSink csv(path);
        csv.begin(links);
        for (std::uint64_t i = 0; i < 30'000; ++i) {
            TraceRecord record{random_time(chance),
                               static_cast<std::uint16_t>(chance.below(2)),
                               chance.below(2) == 0 ? Direction::FromA : Direction::FromB,
                               i,
                               static_cast<FaultKind>(chance.below(9)),
                               random_payload(chance)};
            csv.record(record);
            const TraceRow row = to_row(record, links);
            REQUIRE(to_csv(row) == plain_row(row));
            if (record.link == 0 || record.direction == Direction::FromA) expected.push_back(plain_row(row));
        }
    }
    std::ifstream in(path);
    std::string line;
    REQUIRE(std::getline(in, line));
    REQUIRE(line == kTraceColumns);
    for (const std::string& row : expected) {
        REQUIRE(std::getline(in, line));
        REQUIRE(line == row);
    }
    CHECK_FALSE(std::getline(in, line));
    std::filesystem::remove(path);
}

TEST_CASE("a packet's row comes back, and says what is in it") {
    const std::vector<std::uint8_t> datagram{0x45, 0,  0, 29, 0, 1, 0, 0, 64, 17, 0x66, 0xcd, 10, 0,  0,
                                             1,    10, 0, 0,  2, 0, 7, 0, 9,  0,  9,    0,    0,  'x'};
    TraceRow row{kSecond, "robot0.network", "robot0.linux",
                 "",      FaultKind::None,  Packet{kSecond - 5, 7, Octets(datagram)}};
    const std::string text = to_csv(row);
    CHECK_THAT(text, Catch::Contains(",packet,4500001d") &&
                         Catch::Contains(",UDP 10.0.0.1:7 > 10.0.0.2:9 1 octets,"));
    CHECK(to_csv(parse_trace_row(text, "trace.csv", 2)) == text);
    for (const char* bad : {"", "45", "4500001", "zz00001d"}) {
        const std::string damaged =
            "1.000000000000,robot0.network,robot0.linux,packet," + std::string(bad) + ",,0.5,0.0,,";
        CHECK_THROWS_AS(parse_trace_row(damaged, "trace.csv", 2), InputError);
    }
    TraceStats stats;
    stats.add(row);
    CHECK_THAT(stats.json(), Catch::Contains("\"packets\": 1, \"packet_octets\": 29"));
}
