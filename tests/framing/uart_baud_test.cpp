// Baud rates that do not match, -6 to +6 %: what each chip's receiver takes off a sender's line, and what
// receivers take off the line of a chip whose own clock is off. Every character is compared with the
// reference receiver; the edges at which errors begin with theory.

#include "base/random.h"
#include "protocols/serial/uart_sampling.h"
#include "tests/framing/table.h"
#include "tests/framing/uart_chips.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <cmath>

using namespace puckloop;
using namespace puckloop::framing;
using cosim::Time;
using cosim::UartFrame;

namespace {

constexpr double kPicoseconds = 1e12;
constexpr double kWidest = 6.0;  // % either way

std::string text(const Format& format) {
    return fmt::format("{}{}{}", format.data_bits, "NOE"[format.parity], format.stop_bits);
}

std::uint16_t draw_word(RandomStream& random, const Format& format) {
    return static_cast<std::uint16_t>(random.below(1u << format.data_bits));
}

/// Divisors of common rates: the e-puck's and the range-and-bearing board's own among them.
std::uint32_t draw_divisor(RandomStream& random, int ticks) {
    const std::uint32_t common[] = {8, 43, 22, 87, 17};
    return common[random.below(5)] * (ticks == 4 ? 4 : 1);
}

std::vector<Character> as_sent(const std::vector<UartFrame>& line) {
    std::vector<Character> out;
    for (const UartFrame& frame : line)
        out.push_back({frame.data});
    return out;
}

/// Hands the whole line to the chip, reading what it has after each frame, and lets the line rest.
std::vector<Character> receive_all(UartChip& chip, const std::vector<UartFrame>& line) {
    std::vector<Character> heard;
    const auto take = [&] {
        for (const Character& one : chip.take())
            heard.push_back(one);
    };
    for (const UartFrame& frame : line) {
        chip.receive(frame);
        take();
    }
    const UartFrame& last = line.back();
    chip.run_to(last.start + 40 * last.bit_period);
    take();
    return heard;
}

/// Random words at random instants, back to back or with pauses.
std::vector<UartFrame> draw_line(RandomStream& random, const Format& format, Time bit, int count,
                                 bool pauses) {
    std::vector<UartFrame> line;
    Time at = 1'000'000'000 + static_cast<Time>(random.below(static_cast<std::uint64_t>(bit)));
    for (int i = 0; i < count; ++i) {
        line.push_back(frame_of(format, draw_word(random, format), at, bit));
        at += bit * (format.bits_before_stop() + format.stop_bits);
        if (pauses) at += bit + static_cast<Time>(random.below(static_cast<std::uint64_t>(3 * bit)));
    }
    return line;
}

Time bit_time(const UartChip& chip, double mismatch_percent) {
    return std::llround(chip.bit_seconds() * kPicoseconds / (1 + mismatch_percent / 100));
}

/// The whole range in steps; returns the rows "chip, format, mismatch, characters, wrong" for the table.
void sweep(const ChipKind& kind, const Format& format, double step, int count, RandomStream& random,
           Table& table) {
    const Limits worst{limits(format, kind.ticks, 0).longest, limits(format, kind.ticks, 1).shortest};
    for (double mismatch = -kWidest; mismatch <= kWidest + step / 2; mismatch += step) {
        int wrong = 0;
        for (const bool pauses : {false, true}) {
            const auto chip = kind.make(0);
            chip->set(format, draw_divisor(random, kind.ticks));
            const auto line = draw_line(random, format, bit_time(*chip, mismatch), count, pauses);
            const auto heard = receive_all(*chip, line);
            const auto expected =
                listen(line, format, kind.ticks, [&](std::int64_t n) { return chip->tick(n); });
            INFO(kind.name << ' ' << text(format) << " at " << mismatch << " %, pauses " << pauses);
            REQUIRE(heard.size() == expected.size());
            REQUIRE(heard == expected);
            const auto right = as_sent(line);
            const double ratio = 1 / (1 + mismatch / 100);
            if (ratio < worst.longest - 1e-4 && ratio > worst.shortest + 1e-4) REQUIRE(heard == right);
            for (std::size_t i = 0; i < right.size(); ++i)
                wrong += i >= heard.size() || heard[i] != right[i];
        }
        table.add(fmt::format("{},{},{:.2f},{},{}", kind.name, text(format), mismatch, 2 * count, wrong));
    }
}

/// Two frames back to back, the first begun so that the receiver's clock sees it `wait` ticks later: are both
/// taken as sent?
bool taken(const ChipKind& kind, const Format& format, Time bit, double wait) {
    const auto chip = kind.make(0);
    chip->set(format, 8);
    const double tick = chip->bit_seconds() * kPicoseconds / kind.ticks;
    // The worst word: the bit before the stop bit is low, so that reading it in the stop bit's place is
    // wrong.
    const std::uint16_t word = format.parity == 1 ? 1 : 0;
    const Time start = chip->tick(kind.ticks * 10) - static_cast<Time>(std::llround(wait * tick));
    const std::vector<UartFrame> line{
        frame_of(format, word, start, bit),
        frame_of(format, word, start + bit * (format.bits_before_stop() + format.stop_bits), bit)};
    const auto heard = receive_all(*chip, line);
    return !heard.empty() && heard[0] == Character{word};
}

/// The bit time, as part of the receiver's, between `good` and `bad` at which the first frame's errors begin.
double find_edge(const ChipKind& kind, const Format& format, double wait, double good, double bad) {
    const auto chip = kind.make(0);
    chip->set(format, 8);
    const double own = chip->bit_seconds() * kPicoseconds;
    Time right = std::llround(own * good), wrong = std::llround(own * bad);
    REQUIRE(taken(kind, format, right, wait));
    REQUIRE_FALSE(taken(kind, format, wrong, wait));
    while (std::abs(right - wrong) > 1) {
        const Time middle = (right + wrong) / 2;
        (taken(kind, format, middle, wait) ? right : wrong) = middle;
    }
    return static_cast<double>(right) / own;
}

}  // namespace

TEST_CASE("uart: a much slower sender's garbage comes at the receiver's pace, so that a driver keeps up") {
    // Five edges in a word: more characters than a receiver holds, known at once when its frame is handed in.
    RandomStream random(Catch::rngSeed(), "slow sender");
    for (const ChipKind& kind : chip_kinds()) {
        const Format format = kind.formats.front();
        const auto chip = kind.make(0);
        chip->set(format, 8);
        const Time own = std::llround(chip->bit_seconds() * kPicoseconds);
        const Time bit = own * 12 + static_cast<Time>(random.below(static_cast<std::uint64_t>(own)));
        std::vector<UartFrame> line;
        Time at = 1'000'000'000;
        for (int i = 0; i < 6; ++i, at += bit * (format.bits_before_stop() + format.stop_bits))
            line.push_back(frame_of(format, i % 2 == 0 ? 0x55 : 0x2A, at, bit));
        // A driver that looks four times in a character.
        std::vector<Character> heard;
        Time now = 0;
        const auto go = [&](Time until) {
            for (; now < until; now += own * 5 / 2) {
                chip->run_to(now);
                const auto some = chip->take();
                CHECK(some.size() <= 1);
                heard.insert(heard.end(), some.begin(), some.end());
            }
        };
        for (const UartFrame& frame : line) {
            const Time known = frame.start + bit * format.bits_before_stop();
            go(known);
            chip->deliver(frame, std::max(now, known));
        }
        go(now + 80 * bit);
        INFO(kind.name);
        const auto expected = listen(line, format, kind.ticks, [&](std::int64_t n) { return chip->tick(n); });
        CHECK(expected.size() > 3 * line.size());
        CHECK(heard == expected);
    }
}

TEST_CASE("uart: a sweep of the sender's rate, each character as the data sheet's sampling gives it") {
    RandomStream random(17, "uart baud sweep");
    Table table("uart_baud_sweep.csv", "receiver,format,sender's mismatch %,characters,wrong");
    for (const ChipKind& kind : chip_kinds())
        for (const Format& format : kind.formats)
            sweep(kind, format, 0.5, 12, random, table);
}

TEST_CASE("uart: the fine sweep of the sender's rate", "[.slow]") {
    RandomStream random(18, "uart fine baud sweep");
    Table table("uart_baud_fine.csv", "receiver,format,sender's mismatch %,characters,wrong");
    for (const ChipKind& kind : chip_kinds())
        for (const Format& format : kind.formats)
            sweep(kind, format, 0.02, 40, random, table);
}

TEST_CASE("uart: errors begin exactly where the sampling instants leave the stop bit") {
    RandomStream random(19, "uart edges");
    Table table("uart_edges.csv",
                "receiver,format,ticks waited,slowest sender %,theory %,fastest sender %,theory %");
    for (const ChipKind& kind : chip_kinds()) {
        for (const Format& format : kind.formats) {
            for (const double wait : {0.0, 0.999, random.uniform()}) {
                const Limits theory = limits(format, kind.ticks, wait);
                const double longest = find_edge(kind, format, wait, 1, 1.2);
                const double shortest = find_edge(kind, format, wait, 1, 0.92);
                INFO(kind.name << ' ' << text(format) << " wait " << wait);
                // Cycles begin on whole picoseconds: a bit time may be some picoseconds off.
                CHECK(longest == Approx(theory.longest).epsilon(3e-6));
                CHECK(shortest == Approx(theory.shortest).epsilon(3e-6));
                table.add(fmt::format("{},{},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f}", kind.name, text(format),
                                      wait, 100 / longest - 100, 100 / theory.longest - 100,
                                      100 / shortest - 100, 100 / theory.shortest - 100));
            }
        }
    }
}

TEST_CASE("uart: the ATmega's edges are those of its data sheet's table, but for the majority vote") {
    // Data sheet 8272, "Asynchronous Operational Range": 8 data bits, no parity. R_fast is the fastest
    // sender; R_slow demands all three samples in the stop bit, one tick more than a majority needs.
    const Format plain{8, 0};
    CHECK(100 / limits(plain, 16, 1).shortest == Approx(104.58).margin(0.005));
    CHECK(100 / limits(plain, 8, 1).shortest == Approx(103.90).margin(0.005));
    CHECK(100 * 16.0 * 9 / (15 + 16 * 8 + 9) == Approx(100 / limits(plain, 16, 0).longest).margin(0.005));
    CHECK(100 * 8.0 * 9 / (7 + 8 * 8 + 5) == Approx(100 / limits(plain, 8, 0).longest).margin(0.005));
}

TEST_CASE("uart: a chip whose own clock is off sends what the other chips take or lose by the same law") {
    RandomStream random(20, "uart senders");
    for (const ChipKind& sender : chip_kinds()) {
        for (const ChipKind& receiver : chip_kinds()) {
            for (int round = 0; round < 6; ++round) {
                const Format format = sender.formats[random.below(4)];  // the first four are everybody's
                const double mismatch = (2 * random.uniform() - 1) * kWidest;
                const auto to = receiver.make(0);
                to->set(format, draw_divisor(random, receiver.ticks) * 4);
                // The sender's nearest divisor, the rest by its clock.
                const auto nominal = sender.make(0);
                nominal->set(format, 1);
                const double divisor = std::round(to->bit_seconds() / nominal->bit_seconds());
                const double fast = nominal->bit_seconds() * divisor / to->bit_seconds();
                const auto from = sender.make((fast * (1 + mismatch / 100) - 1) * 1e6);
                from->set(format, static_cast<std::uint32_t>(divisor));
                std::vector<Character> right;
                const Time bit = std::llround(from->bit_seconds() * kPicoseconds);
                for (Time t = bit; right.size() < 30; t += bit) {
                    from->run_to(t);
                    const std::uint16_t word = draw_word(random, format);
                    if (from->send(word)) right.push_back({word});
                }
                from->run_to(bit * 12 * 40);
                const std::vector<UartFrame>& line = from->sent();
                REQUIRE(line.size() == right.size());
                INFO(sender.name << " to " << receiver.name << ' ' << text(format) << " at " << mismatch);
                // Within its own tick a frame is as long as its baud rate generator makes it.
                CHECK(static_cast<double>(line[5].bit_period) ==
                      Approx(from->bit_seconds() * kPicoseconds).margin(2));
                const auto heard = receive_all(*to, line);
                REQUIRE(heard ==
                        listen(line, format, receiver.ticks, [&](std::int64_t n) { return to->tick(n); }));
                const double ratio =
                    static_cast<double>(line[5].bit_period) / kPicoseconds / to->bit_seconds();
                const Limits law{limits(format, receiver.ticks, 0).longest,
                                 limits(format, receiver.ticks, 1).shortest};
                if (ratio < law.longest - 1e-4 && ratio > law.shortest + 1e-4) CHECK(heard == right);
            }
        }
    }
}

TEST_CASE("uart: the Linux port's receiver loses characters at the edges of an ideal sampler") {
    RandomStream random(21, "tty edges");
    for (const Format& format : {Format{8, 0}, Format{8, 2}}) {
        const Time own = 8'680'556;
        const double stop = format.bits_before_stop();
        const auto wrong = [&](double ratio) {
            int count = 0;
            const auto line =
                draw_line(random, format, std::llround(static_cast<double>(own) * ratio), 60, false);
            const protocols::UartReceiver receiver{own, static_cast<std::uint8_t>(format.data_bits),
                                                   static_cast<std::uint8_t>(format.parity)};
            Time ready = 0;
            for (const UartFrame& frame : line) {
                const auto heard = protocols::sample_frame(frame, receiver, ready);
                if (!heard.empty()) ready = heard.back().time;
                count += heard.size() != 1 || heard[0].data != frame.data || heard[0].framing_error ||
                         heard[0].parity_error;
            }
            return count;
        };
        // Its bits are read in their middle exactly: the law with a tick of no length.
        const double longest = 1 + 0.5 / stop, shortest = (stop + 0.5) / (stop + 1);
        CHECK(wrong(longest - 1e-5) == 0);
        CHECK(wrong(longest + 1e-5) > 10);
        CHECK(wrong(shortest + 1e-5) == 0);
        CHECK(wrong(shortest - 1e-5) > 10);
        for (double ratio = shortest + 1e-4; ratio < longest; ratio += 0.002)
            CHECK(wrong(ratio) == 0);
    }
}
