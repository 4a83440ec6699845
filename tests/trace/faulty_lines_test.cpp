// Runs with a fault of every kind on a UART, at times drawn at random, exported: sigrok's uart decoder and
// tshark find the errors that `trace decode` finds, and no others.

#include "foreign_tools.h"

#include "base/json.h"
#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <sstream>

using namespace puckloop;
using namespace puckloop::tests;

namespace {

constexpr double kFrame = 10.0 / 115200;  // s

struct Found {
    double time = 0.0;  // s
    std::string what;   // "break", "framing error", "wrong parity", "no character"
};

/// What `trace decode` prints of the characters of one sender.
std::vector<Found> ours(const std::string& out, const std::string& from) {
    std::vector<Found> found;
    const Called called =
        puckloop::tests::puckloop(fmt::format("trace decode {} --errors --json --from-node {}", out, from));
    REQUIRE(called.status == 0);
    for (const std::string& line : lines_of(called.out)) {
        const std::vector<std::string> errors = nlohmann::json::parse(line).at("errors");
        for (const std::string& error : errors)
            for (const char* what : {"break", "framing error", "wrong parity", "no character"}) {
                const std::size_t at = error.find(" at "), colon = error.find("): ");
                // A break that a fault makes is named twice.
                if (at == std::string::npos || colon == std::string::npos ||
                    error.find(what, colon) == std::string::npos)
                    continue;
                if (std::string(what) == "break" && error.substr(colon + 3, 5) != "break") continue;
                found.push_back({std::stod(error.substr(at + 4)), what});
                break;
            }
    }
    return found;
}

/// sigrok's warnings: where its annotations begin, s.
std::vector<Found> sigroks(const std::string& sr, const std::string& line, double rate) {
    std::vector<Found> found;
    const Called called =
        shell(fmt::format("sigrok-cli -i {} -P uart:rx={}:baudrate=115200 -A uart=rx-warnings:rx-break "
                          "--protocol-decoder-samplenum",
                          sr, line));
    REQUIRE(called.status == 0);
    for (const std::string& text : lines_of(called.out))
        found.push_back(
            {std::stod(text) / rate, text.find("Break") != std::string::npos ? "break" : "framing error"});
    return found;
}

bool near(const std::vector<Found>& list, double time, double before, double after,
          const std::vector<std::string>& kinds) {
    for (const Found& one : list)
        for (const std::string& kind : kinds)
            if (one.what == kind && one.time >= time - before && one.time <= time + after) return true;
    return false;
}

}  // namespace

TEST_CASE("sigrok and tshark find the errors of a line with every kind of fault that decode finds") {
    const unsigned seed = Catch::rngSeed();
    std::mt19937 random{seed};
    INFO("--rng-seed " << seed);
    const char* kKinds[] = {"flip position={}",
                            "stop position={}",
                            "false_start width=3us",
                            "break",
                            "insert position={}",
                            "duplicate position={}",
                            "swap position={}",
                            "drop position={}",
                            "cut",
                            "truncate keep=20",
                            "delay delay=2ms position={}",
                            "stuck for=52ms",
                            "stuck level=high for=52ms",
                            "batch slot=2ms for=52ms",
                            "throttle rate=57600 for=52ms",
                            "rate factor=1.02 for=52ms",
                            "baud offset=2% for=52ms",
                            "baud offset=-1.5% drift=0.1% for=52ms",
                            "stall for=52ms",
                            "disconnect for=52ms",
                            "unplug for=52ms",
                            "swapped_wires for=52ms",
                            "invert for=52ms"};
    std::string faults;
    // The main board sends at the beginning of each tenth of a second. What a fault itself puts on the line
    // stands at rest; what it does to frames is done to one somewhere in a record, or from its first on.
    double at = 1.05 + static_cast<double>(random() % 3000) / 1e5, inverted = 0.0;
    std::vector<double> cuts;
    for (const char* kind : kKinds) {
        const std::string text = fmt::format(fmt::runtime(kind), 20 + random() % 50);
        const std::size_t blank = text.find(' ');
        if (text.starts_with("invert")) inverted = at;
        if (text.starts_with("stuck") || text.starts_with("unplug"))
            cuts.insert(cuts.end(), {at, at + 0.052});
        const bool window = text.find("for=") != std::string::npos;
        faults += fmt::format(" --fault '{} link=robot0.uart{} {}={:.5f}s{}{} may_not_fire=true'",
                              text.substr(0, blank), text.starts_with("swapped") ? "" : " from=robot0.pic",
                              window ? "begin" : "at", at, blank == std::string::npos ? "" : " ",
                              blank == std::string::npos ? "" : text.substr(blank + 1));
        at += 0.1;
    }
    const std::string out = scratch("faulty");
    const Called run = puckloop::tests::puckloop(
        fmt::format("run {}/scenarios/hello.toml --in-process --duration {:.3f} --seed {} --out {} "
                    "--trace-format pcapng{}",
                    PUCKLOOP_SOURCE, at + 0.1, random() % 1000, out, faults));
    INFO(faults << "\n" << run.out);
    REQUIRE(run.status == 0);
    constexpr double kRate = 10e6;
    const std::string sr = out + "/trace.sr";
    REQUIRE(
        puckloop::tests::puckloop(
            fmt::format("trace export {} -o {} --rate {} --from-node robot0.pic --kind uart", out, sr, kRate))
            .status == 0);
    const std::vector<Found> mine = ours(out, "robot0.pic");
    std::size_t breaks = 0, framing = 0;
    for (const Found& one : mine) {
        breaks += one.what == "break" ? 1U : 0U;
        framing += one.what == "framing error" ? 1U : 0U;
    }
    CHECK(breaks >= 2);  // break, stuck low; a missing stop bit of 00 is one, too
    CHECK(breaks + framing >= 3);
    if (installed("sigrok-cli")) {
        const std::vector<Found> theirs = sigroks(sr, "robot0.uart/robot0.pic", kRate);
        // sigrok marks the stop bit, or where a break began; of a start bit that is too short it reports that
        // it is a wrong frame. An inverted line is in the trace frame by frame: between them it is not drawn.
        const auto is_inverted = [&](double time) { return time >= inverted && time < inverted + 0.06; };
        for (const Found& one : mine) {
            if (is_inverted(one.time)) continue;
            INFO(one.what << " at " << one.time);
            CHECK(near(theirs, one.time, 1e-6, 1.5 * kFrame, {"break", "framing error"}));
        }
        // A frame that is on the way when the line gets stuck or is unplugged, or comes back, is whole in the
        // trace, and drawn with that level: sigrok may be out of step for the rest of that record.
        const auto is_cut = [&](double time) {
            return std::any_of(cuts.begin(), cuts.end(),
                               [&](double cut) { return time >= cut - kFrame && time < cut + 0.01; });
        };
        for (const Found& one : theirs) {
            if (is_inverted(one.time) || is_cut(one.time)) continue;
            INFO("sigrok: " << one.what << " at " << one.time);
            CHECK(near(mine, one.time, 1.5 * kFrame, 1e-6, {"break", "framing error", "no character"}));
        }
    }
    if (installed("tshark")) {
        const auto count = [&](const char* filter) {
            return tests::tshark(
                       out + "/trace.pcapng",
                       fmt::format("frame.interface_name == \"robot0.uart robot0.pic\" && {}", filter),
                       "-e frame.number")
                .size();
        };
        CHECK(count("rtacser.eventtype == 7") == framing);
        CHECK(count("rtacser.eventtype == 9") == breaks);
        CHECK(count("frame.comment contains \"fault: drop, not received\"") == 1);
    }
}

namespace {

/// In thousandths: the bit time of a sender whose edges keep away from where a receiver samples.
cosim::Time clear_factor(std::mt19937& random) {
    for (;;) {
        const auto factor = static_cast<cosim::Time>(880 + random() % 200);
        bool clear = true;
        for (int bit = 1; bit <= 9; ++bit) {
            const double at = (bit + 0.5) * 1000.0 / static_cast<double>(factor);
            clear = clear && std::abs(at - std::round(at)) > 0.1;
        }
        if (clear) return factor;
    }
}

}  // namespace

TEST_CASE("sigrok reads frames of wrong bit rates, missing stop bits and short starts as decode does") {
    const unsigned seed = Catch::rngSeed();
    std::mt19937 random{seed};
    INFO("--rng-seed " << seed);
    using namespace cosim;
    constexpr Time kBit = kSecond / 115200;
    std::vector<TraceRow> rows;
    Time now = kMillisecond;
    for (int i = 0; i < 300; ++i) {
        UartFrame frame{now, kBit, static_cast<std::uint16_t>(random() % 256)};
        FaultKind fault = FaultKind::None;
        switch (random() % 5) {
        case 0:
            fault = FaultKind::Rate;
            frame.bit_period = kBit * clear_factor(random) / 1000;
            break;
        case 1:
            fault = FaultKind::Stop;
            frame.data_bits = 9;
            break;
        case 2:
            fault = FaultKind::Break;
            frame.is_break = 1;
            frame.bit_period = kBit * 3 / 2;
            break;
        default:
            break;
        }
        rows.push_back(uart_row("toy.line", "left", frame, fault));
        now = frame.start + 18 * kBit + static_cast<Time>(random() % 1000) * kNanosecond;
    }
    const std::string trace = write_trace("rates.csv", rows);
    const Called decoded = puckloop::tests::puckloop(fmt::format("trace decode {} --json", trace));
    REQUIRE(decoded.status == 0);
    std::vector<unsigned> bytes;
    std::size_t framing = 0, breaks = 0;
    for (const std::string& line : lines_of(decoded.out)) {
        const auto json = nlohmann::json::parse(line);
        std::istringstream words(json.at("bytes").get<std::string>());
        for (std::string word; words >> word;)
            bytes.push_back(static_cast<unsigned>(std::stoul(word, nullptr, 16)));
        const std::vector<std::string> errors = json.at("errors");
        for (const std::string& error : errors) {
            framing += error.find("framing error") != std::string::npos ? 1U : 0U;
            breaks += error.find("): break") != std::string::npos ? 1U : 0U;
        }
    }
    CHECK(bytes.size() == rows.size());
    CHECK(framing > 10);
    CHECK(breaks > 10);
    const std::string sr = trace + ".sr", pcapng = trace + ".pcapng";
    for (const std::string& file : {sr, pcapng})
        REQUIRE(puckloop::tests::puckloop(fmt::format("trace export {} -o {}", trace, file)).status == 0);
    if (installed("sigrok-cli")) {
        CHECK(sigrok_uart(sr, "toy.line/left", 115200) == bytes);
        CHECK(sigrok_uart_count(sr, "toy.line/left", 115200, "none", "rx-warnings") == framing + breaks);
    }
    if (installed("tshark")) {
        CHECK(tests::tshark(pcapng, "rtacser.eventtype == 7", "-e frame.number").size() == framing);
        CHECK(tests::tshark(pcapng, "rtacser.eventtype == 9", "-e frame.number").size() == breaks);
    }
}
