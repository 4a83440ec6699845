// `puckloop trace export` as a user calls it, and what it makes of bad input.

#include "tests/kit/files.h"
#include "trace_kit.h"

#include "base/error.h"
#include "traces/formats/export.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

using namespace puckloop;
using namespace puckloop::cosim;
using namespace puckloop::tests;

namespace {

std::vector<TraceRow> some_rows() {
    std::vector<TraceRow> rows{uart_row("wire", "left", {kMillisecond, kSecond / 9600, 0x4e})};
    I2cScript script(rows, 10 * kMicrosecond);
    script.pause(2 * kMillisecond);
    script.start(0x41, true, 0);
    script.read(0x55, false, 0);
    script.stop();
    rows.push_back({script.now(), "w", "board", "wheel_left", FaultKind::None, Signal{3, -2.5}});
    RadioFrame radio{script.now(), kMillisecond, {}, 12, -60};
    radio.octets = Octets(std::vector<std::uint8_t>{0x00, 0x7e, 0xff});
    rows.push_back({script.now() + kMillisecond, "r", "m.xbee", "", FaultKind::Flip, radio});
    return rows;
}

}  // namespace

TEST_CASE("a value change dump holds every kind of message and is in order") {
    const std::string trace = write_trace("all.csv", some_rows());
    const std::string vcd = tests::puckloop(fmt::format("trace export {} --format vcd -o -", trace)).out;
    long long before = -1;
    for (const std::string& line : lines_of(vcd))
        if (line[0] == '#' && line.size() > 1 && std::isdigit(static_cast<unsigned char>(line[1]))) {
            const long long time = std::stoll(line.substr(1));
            CHECK(time > before);
            before = time;
        }
    CHECK_THAT(vcd, Catch::Contains("$timescale 100 ns $end") && Catch::Contains("$scope module wire $end") &&
                        Catch::Contains("scl $end") && Catch::Contains("sstart ") &&
                        Catch::Contains("sack ") && Catch::Contains("$var real 64") &&
                        Catch::Contains("wheel_left") && Catch::Contains("s007eff ") &&
                        Catch::Contains("sflip "));
}

TEST_CASE("a value change dump is as coarse as its shortest bit allows, or as is asked for") {
    const auto scale_of = [](const std::vector<TraceRow>& rows, const std::string& more) {
        const std::string trace = write_trace("scale.csv", rows);
        const std::string vcd =
            tests::puckloop(fmt::format("trace export {} --format vcd -o - {}", trace, more)).out;
        return lines_of(vcd).at(1);
    };
    const auto uart = [](int baud) {
        return std::vector<TraceRow>{uart_row("wire", "left", {kMillisecond, kSecond / baud, 0x4e})};
    };
    CHECK(scale_of(uart(9600), "") == "$timescale 1 us $end");
    CHECK(scale_of(uart(115200), "") == "$timescale 100 ns $end");
    CHECK(scale_of(uart(2000000), "") == "$timescale 10 ns $end");
    CHECK(scale_of(uart(115200), "--timescale '1 ps'") == "$timescale 1 ps $end");
    const std::string trace = write_trace("scale.csv", uart(115200));
    CHECK(tests::puckloop(fmt::format("trace export {} -o x.sr --timescale '1 ns'", trace)).status == 2);
    // The start bit begins at 1 ms, bit 1 (high) two bits later.
    const std::string vcd = tests::puckloop(fmt::format("trace export {} --format vcd -o -", trace)).out;
    CHECK_THAT(vcd, Catch::Contains("\n#10000\n") && Catch::Contains("\n#10173\n"));
}

TEST_CASE("sigrok reads a value change dump to its end, in the time that it reads the lines") {
    if (!installed("sigrok-cli")) return;
    std::vector<TraceRow> rows;
    for (int i = 0; i < 20; ++i) {
        rows.push_back(uart_row("wire", "left", {(1 + 25 * i) * kMillisecond, kSecond / 115200, 0x41}));
        rows.push_back(uart_row("wire", "right", {(2 + 25 * i) * kMillisecond, kSecond / 115200, 0x7e}));
    }
    const std::string trace = write_trace("sigrok.csv", rows);
    REQUIRE(tests::puckloop(fmt::format("trace export {0} -o {0}.vcd", trace)).status == 0);
    for (const auto& [sender, byte] : {std::pair{"left", "41"}, std::pair{"right", "7E"}}) {
        INFO(sender);
        const Called read = shell(fmt::format("timeout 60 sigrok-cli -I vcd -i {}.vcd -P uart:rx=wire/{}:"
                                              "baudrate=115200 -A uart=rx-data 2>/dev/null",
                                              trace, sender));
        CHECK(read.status == 0);
        CHECK(lines_of(read.out) == std::vector<std::string>(20, fmt::format("uart-1: {}", byte)));
    }
}

TEST_CASE("packets are in the order of their times, however late their rows are") {
    if (!installed("tshark")) return;
    // A burst that lasts 20 ms while frames of another line come and go, and a frame that is known late.
    std::vector<TraceRow> rows;
    const Time bit = kSecond / 115200;
    for (int i = 0; i < 200; ++i)
        rows.push_back(uart_row("long", "a", {kMillisecond + 10 * i * bit, bit, 0x55}));
    for (int i = 0; i < 5; ++i)
        rows.push_back(uart_row("short", "b", {(3 + 2 * i) * kMillisecond, bit, 0x21}));
    TraceRow late = uart_row("late", "c", {4 * kMillisecond, bit, 0x42});
    late.time = 800 * kMillisecond;
    rows.push_back(late);
    rows.push_back(uart_row("short", "b", {400 * kMillisecond, bit, 0x22}));
    std::stable_sort(rows.begin(), rows.end(),
                     [](const TraceRow& a, const TraceRow& b) { return a.time < b.time; });
    const std::string trace = write_trace("order.csv", rows), file = trace + ".pcapng";
    REQUIRE(tests::puckloop(fmt::format("trace export {} -o {}", trace, file)).status == 0);
    const Called read = shell(fmt::format(
        "tshark -r {} -T fields -e frame.time_epoch -e frame.interface_name -e frame.comment 2>/dev/null",
        file));
    double before = 0;
    std::vector<std::string> packets = lines_of(read.out);
    REQUIRE(packets.size() == 8);
    for (const std::string& line : packets) {
        INFO(line);
        const double time = std::stod(line);
        CHECK(time >= before);
        before = time;
    }
    CHECK_THAT(packets.front(), Catch::Contains("long a") && Catch::StartsWith("0.001"));
    CHECK_THAT(packets.at(6), Catch::Contains("late c") && Catch::Contains("began at 0.004"));
}

TEST_CASE("only frames that were on the air are frames of the radio") {
    std::vector<TraceRow> rows;
    for (int i = 0; i < 3; ++i) {
        RadioFrame radio{(10 + i) * kMillisecond, i == 1 ? 0 : kMillisecond, {}, 12, -60};
        radio.octets = Octets(std::vector<std::uint8_t>{0x00, 0x7e, 0xff});
        rows.push_back({radio.start + radio.duration, "ether", "m.xbee", "", FaultKind::None, radio});
    }
    const std::string trace = write_trace("air.csv", rows);
    const std::string vcd = tests::puckloop(fmt::format("trace export {} --format vcd -o -", trace)).out;
    std::size_t frames = 0;
    for (const std::string& line : lines_of(vcd))
        if (line.starts_with("s007eff ")) ++frames;
    CHECK(frames == 2);
    CHECK(lines_of(tests::puckloop("trace decode " + trace).out).size() == 2);
    if (!installed("tshark")) return;
    REQUIRE(tests::puckloop(fmt::format("trace export {0} -o {0}.pcapng", trace)).status == 0);
    CHECK(lines_of(shell(fmt::format("tshark -r {}.pcapng 2>/dev/null", trace)).out).size() == 2);
}

TEST_CASE("the same trace gives the same files") {
    const std::string trace = write_trace("same.csv", some_rows());
    for (const char* format : {"sr", "pcapng", "vcd", "csv"}) {
        for (const char* name : {"a", "b"})
            REQUIRE(
                tests::puckloop(fmt::format("trace export {0} -o {0}.{1}.{2}", trace, name, format)).status ==
                0);
        CHECK(text_of(fmt::format("{}.a.{}", trace, format)) ==
              text_of(fmt::format("{}.b.{}", trace, format)));
    }
    CHECK(text_of(trace + ".a.csv") == text_of(trace));
}

TEST_CASE("no field of a trace, however damaged, brings an exporter down") {
    const unsigned seed = Catch::rngSeed();
    std::mt19937 random{seed};
    INFO("--rng-seed " << seed);
    std::vector<TraceRow> rows = some_rows();
    for (int i = 0; i < 10; ++i) {
        rows.push_back(uart_row("wire", "left", {3 * kMillisecond + i * kMillisecond, kSecond / 9600, 0x31}));
        rows.back().fault = i % 2 == 0 ? FaultKind::Stop : FaultKind::None;
    }
    const std::string whole = text_of(write_trace("whole.csv", rows));
    const std::string file = scratch("damaged_export.csv");
    int refused = 0;
    for (int i = 0; i < 400; ++i) {
        std::string text = whole;
        for (std::size_t n = 1 + random() % 4; n > 0; --n) {
            const std::size_t at =
                cosim::kTraceColumns.size() + 1 + random() % (text.size() - cosim::kTraceColumns.size() - 1);
            if (random() % 3 != 0)
                text[at] = "0123456789,.:abcdef\n\"-"[random() % 22];
            else
                text.erase(at, 1 + random() % 150);
            if (text.size() < cosim::kTraceColumns.size() + 10) break;
        }
        std::ofstream(file, std::ios::binary) << text;
        try {
            const tools::RecordedTrace trace(file, {});
            std::ostringstream out;
            switch (random() % 3) {
            case 0:
                tools::export_vcd(trace, out);
                break;
            case 1:
                tools::export_pcapng(trace, out);
                break;
            default:
                tools::export_sr(trace, file + ".sr", 100'000);
            }
        } catch (const InputError& error) {
            ++refused;
            CHECK_THAT(error.what(), Catch::Contains(file + ": line ") || Catch::Contains("are too many") ||
                                         Catch::Contains("no line to draw"));
        }
    }
    CHECK(refused > 50);
}

TEST_CASE("files that are no traces are refused in one line, whatever is asked of them") {
    const std::string trace = write_trace("good.csv", some_rows());
    REQUIRE(tests::puckloop("trace export " + trace + " -o " + trace + ".pcapng").status == 0);
    const std::string empty = scratch("empty.csv"), endless = scratch("endless.csv");
    std::ofstream{empty};
    std::ofstream(endless) << kTraceColumns << '\n' << std::string(3'000'000, '1');
    for (const std::string& file : {trace + ".pcapng", empty, endless, std::string(PUCKLOOP_PROGRAM),
                                    std::string("/dev/zero"), std::string("/proc/self/mem")})
        for (const char* what :
             {"trace {}", "trace decode {}", "trace export {} --format vcd -o -",
              "trace export {} --format pcapng -o -", "trace export {} --format csv -o -"}) {
            const Called called = tests::puckloop(fmt::format(fmt::runtime(what), file));
            INFO(what << " " << file << "\n" << called.out.substr(0, 300));
            CHECK(called.status == 2);
            CHECK(lines_of(called.out).size() == 1);
            CHECK_THAT(called.out, Catch::StartsWith("puckloop: "));
        }
}

TEST_CASE("a disk that is full leaves no part of a file") {
    std::vector<TraceRow> rows;
    for (int i = 1; i <= 2000; ++i)
        rows.push_back(
            uart_row("wire", "left", {i * kMillisecond, kSecond / 9600, static_cast<std::uint8_t>(i)}));
    const std::string trace = write_trace("full.csv", rows);
    for (const char* format : {"csv", "vcd", "pcapng", "sr"}) {
        const std::string folder = scratch(std::string("full_") + format), file = folder + "/x";
        std::filesystem::create_directories(folder);
        // Where a limit stands in for the disk's end.
        const Called called =
            shell(fmt::format("trap '' XFSZ; ulimit -f 1; {} trace export {} --format {} -o {} 2>&1",
                              PUCKLOOP_PROGRAM, trace, format, file));
        INFO(format << "\n" << called.out);
        CHECK(called.status == 1);
        CHECK(lines_of(called.out).size() == 1);
        CHECK_THAT(called.out, Catch::StartsWith("puckloop: " + file + ": cannot write: ") &&
                                   Catch::Contains("File too large"));
        CHECK(std::filesystem::is_empty(folder));
    }
}

TEST_CASE("what cannot be exported is reported in one line") {
    const std::string trace = write_trace("bad.csv", some_rows());
    const auto fails = [](const std::string& arguments, int status, const std::string& text) {
        const Called called = tests::puckloop("trace export " + arguments);
        INFO(arguments << "\n" << called.out);
        CHECK(called.status == status);
        CHECK(lines_of(called.out).size() == 1);
        CHECK_THAT(called.out, Catch::StartsWith("puckloop: ") && Catch::Contains(text));
    };
    fails(trace + " -o " + trace + ".xyz", 2, "csv, pcapng, sr or vcd");
    fails(trace + " --format smoke -o x", 2, "smoke");
    fails(trace + " --format sr -o -", 2, "zip archive");
    fails(trace + " --format csv -o " + trace, 2, "is the trace itself");
    fails(trace + " --rate 1000 -o x.vcd", 2, "sample rate");
    fails(trace + " --rate 1e9 --link none -o " + trace + ".sr", 2, "'none' does not occur");
    fails(trace + " --link w -o " + trace + ".sr", 2, "no line to draw");
    fails(trace + " --from 2 --to 1 -o " + trace + ".sr", 2, "not after --from");
    fails(trace + " --format vcd -o /dev/full", 1, "cannot write");
    fails(trace + " -o /nonexistent/x.sr", 2, "/nonexistent/x.sr: cannot write: No such file or directory");
    fails(trace + " -o /nonexistent/x.vcd", 2, "/nonexistent/x.vcd: cannot write: No such file or directory");
    fails("/nonexistent -o x.sr", 2, "no such file");
    fails("/dev/zero -o x.sr", 2, "no regular file");
    const std::string far = write_trace("far.csv", {uart_row("w", "l", {8'000'000 * kSecond, 1'000'000, 1})});
    fails(far + " -o " + far + ".sr", 2, "too many");
}

TEST_CASE("no damaged trace brings an export down") {
    constexpr const char* kFormats[] = {"sr", "pcapng", "vcd", "csv"};
    std::mt19937 random{Catch::rngSeed()};
    INFO("seed " << Catch::rngSeed());
    const std::string whole = text_of(write_trace("fuzz.csv", some_rows()));
    const std::string file = scratch("damaged.csv");
    for (int i = 0; i < 60; ++i) {
        std::string text = whole;
        const unsigned changes = 1 + random() % 4;
        for (unsigned n = 0; n < changes; ++n) {
            const std::size_t at = random() % text.size();
            switch (random() % 4) {
            case 0:
                text[at] = static_cast<char>(random() % 256);
                break;
            case 1:
                text.erase(at, 1 + random() % 20);
                break;
            case 2:
                text.insert(at, text.substr(random() % text.size(), random() % 30));
                break;
            default:
                text.resize(at + 1);
            }
        }
        std::ofstream(file, std::ios::binary) << text;
        const char* format = kFormats[i % 4];
        const Called called =
            tests::puckloop(fmt::format("trace export {} --format {} -o {}.out", file, format, file));
        INFO(text << "\n" << called.out);
        REQUIRE((called.status == 0 || called.status == 2));
        if (called.status == 2)
            CHECK_THAT(called.out, Catch::Contains(file + ": ") || Catch::Contains("too many"));
    }
}
