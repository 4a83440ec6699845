// Polarity and infra-red coding of the dsPIC33FJ's UARTs (UTXINV, URXINV, IREN), each sender with each
// receiver: what comes in is what the reference receiver takes off the levels that the line must have.
// Sources: DS70286, UxMODE and UxSTA; pulses: manual on the UART, DS70188, 17.13 (3/16 of a bit, from its
// seventh sixteenth on).

#include "base/random.h"
#include "protocols/serial/uart_sampling.h"
#include "tests/framing/dspic_uart_bench.h"
#include "tests/framing/uart_wave.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

using namespace puckloop;
using namespace puckloop::framing;
using cosim::Time;
using cosim::UartFrame;

namespace {

constexpr std::uint16_t kEnable = 0x8000, kIren = 0x1000, kUrxinv = 0x10, kBrgh = 8;
constexpr std::uint16_t kUtxinv = 0x4000, kUtxen = 0x0400;
constexpr Time kForEver = cosim::kSecond;

struct Side {
    bool inverted = false, infrared = false;
};

std::uint16_t mode_of(const Format& format, const Side& side, bool high_speed, bool receives) {
    const int select = format.data_bits == 9 ? 3 : format.parity == 2 ? 1 : format.parity == 1 ? 2 : 0;
    return static_cast<std::uint16_t>(kEnable | (high_speed ? kBrgh : 0) | select << 1 |
                                      (format.stop_bits == 2 ? 1 : 0) | (side.infrared ? kIren : 0) |
                                      (receives && side.inverted ? kUrxinv : 0));
}

/// The line that a sender makes, painted from the words and their starts.
struct Painted {
    Wave meant;        ///< high at rest
    Time from = 0;     ///< the transmitter has the line since then
    bool low = false;  ///< its rest

    bool level(Time time) const { return time < from || meant.level(time) != low; }
};

void paint(Painted& line, const Format& format, std::uint16_t data, Time start, Time bit, bool pulses) {
    if (!pulses) return line.meant.word(format, data, start, bit);
    Wave word;
    word.word(format, data, start, bit);
    for (int i = 0; i < format.bits_before_stop(); ++i)
        if (const Time at = start + i * bit; !word.level(at + bit / 2))
            line.meant.paint(at + bit * 7 / 16, at + bit * 10 / 16, false);
}

/// The levels behind a decoder: low for one of its bits from each falling edge on.
Wave decoded(const std::function<bool(Time)>& level, const std::vector<Time>& edges, Time own_bit) {
    Wave out;
    Time low_until = 0;
    for (const Time edge : edges) {
        if (level(edge) || !level(edge - 1)) continue;
        const Time from = std::max(edge, low_until);
        low_until = from + own_bit;
        out.paint(from, low_until, false);
    }
    return out;
}

std::string text(const std::vector<Character>& heard) {
    std::string out;
    for (const Character& one : heard)
        out += fmt::format("{:03x}{}{} ", one.data, one.framing ? "F" : "", one.parity ? "P" : "");
    return out;
}

struct Result {
    std::vector<Character> heard, right;
    std::string sent;
};

Result run(RandomStream& random, const Format& format, const Side& sends, const Side& receives,
           bool high_speed) {
    const double ppm = (random.next() % 2 ? 1 : -1) * (1000 + 4000 * random.uniform());
    DspicUartBench tx(true, 0), rx(true, ppm);
    const auto divisor = static_cast<std::uint32_t>((high_speed ? 20 : 5) + random.below(60));
    const auto reg = [](DspicUartBench& bench, int offset) {
        return static_cast<std::uint16_t>(bench.setup.mode + offset);
    };
    for (DspicUartBench* bench : {&tx, &rx})
        bench->write(reg(*bench, 8), static_cast<std::uint16_t>(divisor - 1));
    // Either is switched on first.
    const auto on = 100 + random.below(40 * 16 * divisor);
    rx.go(100 + random.below(40 * 16 * divisor));
    rx.write(reg(rx, 0), mode_of(format, receives, high_speed, true));
    const std::uint64_t phase = rx.now + 1;
    tx.go(on);
    tx.write(reg(tx, 0), mode_of(format, sends, high_speed, false));
    tx.write(reg(tx, 2), static_cast<std::uint16_t>(kUtxen | (sends.inverted ? kUtxinv : 0)));

    Painted line;
    line.from = tx.clock.time_of(tx.now + 1);
    const bool pulses = sends.infrared && !high_speed;
    line.low = sends.inverted != pulses;
    tx.go(std::max<std::uint64_t>(tx.now, rx.now) + 12 * 16 * divisor);
    Result result;
    std::vector<std::uint16_t> words;
    for (int i = 0; i < 12; ++i) {
        const auto data = static_cast<std::uint16_t>(random.below(1u << format.data_bits));
        if (random.below(3) == 0) tx.go(tx.now + random.below(60 * 16 * divisor));
        while (!tx.send(data))
            tx.go(tx.now + 50);
        words.push_back(data);
        result.sent += fmt::format("{:03x} ", data);
    }
    tx.go(tx.now + 100 * 16 * divisor);

    std::vector<UartFrame> frames = tx.pins.frames;
    std::stable_sort(frames.begin(), frames.end(), [](const UartFrame& a, const UartFrame& b) {
        return protocols::stop_bit_start(a) < protocols::stop_bit_start(b);
    });
    std::size_t word = 0;
    for (const UartFrame& frame : frames)
        if (!frame.is_break) paint(line, format, words.at(word++), frame.start, frame.bit_period, pulses);
    REQUIRE(word == words.size());

    const auto take = [&] {
        for (std::uint16_t sta; (sta = rx.sta()) & DspicUartBench::kUrxda;)
            result.heard.push_back(
                {rx.data(), (sta & DspicUartBench::kFerr) != 0, (sta & DspicUartBench::kPerr) != 0, false});
    };
    const auto go = [&](Time until) {
        const std::uint64_t end = rx.clock.first_cycle_at(until);
        while (rx.now < end) {
            rx.go(std::min<std::uint64_t>(end, rx.now + 8 * 16 * divisor));
            take();
        }
    };
    for (const UartFrame& frame : frames) {
        const Time at = std::max(protocols::stop_bit_start(frame), rx.clock.time_of(rx.now));
        go(at);
        rx.uart.receive(frame, rx.now);
        take();
    }
    const Time end = tx.clock.time_of(tx.now);
    go(end);

    const int ticks = high_speed ? 4 : 16;
    const auto tick = [&](std::int64_t n) {
        return rx.clock.time_of(phase + divisor * static_cast<std::uint64_t>(n));
    };
    const auto view = [&](Time time) { return line.level(time) != receives.inverted; };
    if (receives.infrared && !high_speed) {
        std::vector<Time> edges{line.from};
        for (Time edge = 0; (edge = line.meant.next_edge(edge)) != cosim::kNever;)
            edges.push_back(edge);
        std::sort(edges.begin(), edges.end());
        const Wave behind = decoded(view, edges, tick(ticks) - tick(0));
        result.right = listen([&](Time t) { return behind.level(t); }, end, format, ticks, tick);
    } else {
        result.right = listen(view, end, format, ticks, tick);
    }
    return result;
}

}  // namespace

TEST_CASE("uart polarity: each receiver hears the levels of each sender's line") {
    RandomStream random(Catch::rngSeed(), "polarity");
    const Format formats[] = {{8, 0}, {8, 1}, {8, 2}, {9, 0}, {8, 0, 2}};
    int matched = 0, framing = 0, silent = 0;
    for (int round = 0; round < 400; ++round) {
        const Format& format = formats[random.below(std::size(formats))];
        const bool high_speed = random.below(4) == 0;
        const Side sends{random.below(2) != 0, random.below(2) != 0};
        const Side receives{random.below(2) != 0, random.below(2) != 0};
        INFO("round " << round << ": " << format.data_bits << "NOE"[format.parity] << format.stop_bits
                      << (high_speed ? " BRGH" : "") << ", sender inverted " << sends.inverted
                      << " infra-red " << sends.infrared << ", receiver " << receives.inverted << ' '
                      << receives.infrared);
        const Result result = run(random, format, sends, receives, high_speed);
        INFO("sent " << result.sent);
        REQUIRE(text(result.heard) == text(result.right));
        // UTXINV has the other sense with IREN: low at rest without it.
        const bool infrared = !high_speed && sends.infrared;
        const bool rests_low = sends.inverted != infrared;
        const bool same_coding = high_speed || sends.infrared == receives.infrared;
        const bool fits = same_coding && rests_low == receives.inverted;
        const auto ends_with_sent = [&] {
            const std::string heard = text(result.heard);
            return heard.size() >= result.sent.size() &&
                   heard.substr(heard.size() - result.sent.size()) == result.sent;
        };
        if (fits) CHECK(ends_with_sent());
        matched += fits;
        silent += !fits && result.heard.empty();
        for (const Character& one : result.heard)
            framing += one.framing;
    }
    CHECK(matched > 50);
    CHECK(framing > 50);
    CHECK(silent > 5);
}
