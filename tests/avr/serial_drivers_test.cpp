// SPI, USARTs with a clock line and the two-wire interface, driven by programs of avr-gcc and avr-libc
// (programs/drivers). Expected values: data sheet 8272, "SPI - Serial Peripheral Interface", "USART", "USART
// in SPI mode", "2-wire Serial Interface".

#include "tests/avr/driver_bench.h"
#include "tests/avr/rig.h"

#include <catch2/catch.hpp>

#include <bit>

using namespace puckloop;
using namespace puckloop::avr;
using test::DriverBench;
using P = PortLetter;
using Kind = cosim::I2cPhaseKind;

namespace {

std::uint8_t drawn(RandomStream& random) {
    return static_cast<std::uint8_t>(random.below(256));
}

}  // namespace

TEST_CASE("SPI master and slave of two chips exchange bytes in every mode and bit order") {
    RandomStream random(20261123, "spi");
    for (unsigned mode = 0; mode < 16; mode += 2) {  // DORD, CPOL, CPHA are bits 5, 3, 2 of SPCR
        const auto control = static_cast<std::uint8_t>((mode & 8) << 2 | (mode & 6) << 1);
        INFO("SPCR " << int(control));
        DriverBench master("spi_master"), slave("spi_slave");
        std::array<std::uint8_t, 10> sent{};
        for (std::uint8_t& byte : sent)
            byte = drawn(random);
        master.put(0, control);
        slave.put(0, control);
        slave.put(1, sent[9]);
        for (std::size_t i = 0; i < 8; ++i)
            master.put(1 + i, sent[i]);
        slave.start();
        slave.chip.run_until(20 * cosim::kMicrosecond);
        master.start();
        master.set_pin({P::B, 6}, true);
        const std::vector<test::Wire> out{
            {{P::B, 4}, {P::B, 4}}, {{P::B, 5}, {P::B, 5}}, {{P::B, 7}, {P::B, 7}}};
        test::run_together(master, slave, out, {{{P::B, 6}, {P::B, 6}}}, 2 * cosim::kMillisecond,
                           [&] { return master.chip.stopped_at().has_value(); });
        REQUIRE(master.chip.stopped_at());
        slave.chip.run_until(slave.chip.now() + 10 * cosim::kMicrosecond);
        for (std::size_t i = 0; i < 8; ++i) {
            CHECK(slave.result(i) == sent[i]);
            CHECK(master.result(i) == (i == 0 ? sent[9] : static_cast<std::uint8_t>(~sent[i - 1])));
        }
        CHECK(slave.result(8) == 0x55);
        CHECK(master.result(8) == 0x40);  // WCOL
        CHECK(master.result(9) == static_cast<std::uint8_t>(~sent[7]));
        CHECK(master.result(10) == 0);
        // Eight periods of 64 clocks a byte; MISO is on the line only while SS is low.
        const auto clock = master.edges_of({P::B, 7});
        REQUIRE(clock.size() >= 9 * 16);
        CHECK(clock[clock.size() - 1].at - clock[clock.size() - 16].at == 15 * 32);
        CHECK_FALSE(slave.driven_level({P::B, 6}));
    }
}

TEST_CASE("an SPI master whose SS input is pulled low becomes a slave, and is interrupted") {
    DriverBench bench("spi_lost");
    bench.start();
    bench.chip.run_until(50 * cosim::kMicrosecond);
    CHECK(bench.result(2) == 0xD0);
    bench.set_pin({P::B, 4}, false);
    REQUIRE(bench.finish(cosim::kMillisecond));
    CHECK(bench.result(0) == 0xC0);
    CHECK(bench.result(1) == 0);  // SPIF is cleared by the interrupt
}

TEST_CASE("a USART as SPI master shifts back to back at its own rate, in every mode and bit order") {
    RandomStream random(20261123, "mspim");
    constexpr Pin kXck{P::D, 4}, kOut{P::D, 3}, kIn{P::D, 2};
    for (unsigned mode = 0; mode < 8; ++mode) {
        INFO("UCSR1C " << mode);
        const bool polarity = mode & 1, late = mode & 2, lowest_first = mode & 4;
        const auto half = static_cast<unsigned>(10 + random.below(30));
        DriverBench bench("usart_spi");
        std::array<std::uint8_t, 8> sent{}, answers{};
        bench.put(0, static_cast<std::uint8_t>(mode));
        bench.put(1, static_cast<std::uint8_t>(half - 1));
        for (std::size_t i = 0; i < 8; ++i) {
            bench.put(2 + i, sent[i] = drawn(random));
            answers[i] = drawn(random);
        }
        // A shift register outside, stated on its own: bit n of the stream goes out before edge 2n (early
        // sampling) or at it.
        std::vector<bool> in, out;
        for (const std::uint8_t byte : answers)
            for (int i = 0; i < 8; ++i)
                out.push_back(byte >> (lowest_first ? i : 7 - i) & 1);
        out.push_back(true);
        std::size_t edges = 0;
        bool listening = false;
        const auto present = [&](std::size_t bit) {
            std::uint8_t& levels = bench.outside[static_cast<std::size_t>(P::D)];
            levels = static_cast<std::uint8_t>(out[bit] ? levels | kIn.mask() : levels & ~kIn.mask());
        };
        bench.on_edge = [&](const DriverBench::Edge& edge) {
            if (edge.pin.port == P::A) {
                listening = true;
                return;
            }
            if (!listening || edge.pin.number != kXck.number) return;
            const bool leading = edges % 2 == 0;
            CHECK(edge.level == (leading != polarity));
            if (leading != late) in.push_back(*bench.driven_level(kOut));
            if (late && leading) present(edges / 2);
            if (!late && !leading) present(edges / 2 + 1);
            ++edges;
        };
        if (!late) present(0);
        bench.start();
        REQUIRE(bench.finish(20 * cosim::kMillisecond));
        REQUIRE(in.size() == 64);
        for (std::size_t i = 0; i < 8; ++i) {
            unsigned byte = 0;
            for (int n = 0; n < 8; ++n)
                byte |= static_cast<unsigned>(in[8 * i + static_cast<std::size_t>(n)])
                        << (lowest_first ? n : 7 - n);
            CHECK(byte == sent[i]);
            CHECK(bench.result(i) == answers[i]);
        }
        CHECK((bench.result(8) & 0x40) == 0x40);
        auto clock = bench.edges_of(kXck);
        clock.erase(clock.begin(), clock.end() - 128);
        for (std::size_t i = 1; i < clock.size(); ++i)
            REQUIRE(clock[i].at - clock[i - 1].at == half);
    }
}

TEST_CASE("two USARTs in synchronous mode, one clocking the other, read each other without errors") {
    RandomStream random(20261123, "synchronous");
    for (const int parity : {0, 2, 3})
        for (const int polarity : {0, 1}) {
            const auto format = static_cast<std::uint8_t>(parity << 4 | (parity & 1) << 3 | polarity);
            INFO("UCSR0C " << int(format));
            DriverBench master("usart_synchronous"), slave("usart_synchronous");
            const auto rate = static_cast<std::uint8_t>(30 + random.below(60));
            std::array<std::array<std::uint8_t, 8>, 2> sent{};
            DriverBench* const both[] = {&master, &slave};
            for (std::size_t side = 0; side < 2; ++side) {
                both[side]->put(0, side == 0);
                both[side]->put(1, rate);
                both[side]->put(2, format);
                for (std::size_t i = 0; i < 8; ++i)
                    both[side]->put(4 + i, sent[side][i] = drawn(random));
                both[side]->start();
            }
            test::run_together(master, slave, {{{P::B, 0}, {P::B, 0}}, {{P::D, 1}, {P::D, 0}}},
                               {{{P::D, 1}, {P::D, 0}}}, 3 * cosim::kMillisecond, [] { return false; });
            for (std::size_t i = 0; i < 8; ++i) {
                CHECK(slave.result(i) == sent[0][i]);
                CHECK(master.result(i) == sent[1][i]);
                CHECK(slave.result(16 + i) == 0);
                CHECK(master.result(16 + i) == 0);
            }
            REQUIRE(master.frames.size() == 8);
            for (std::size_t i = 0; i < 8; ++i) {
                CHECK(master.frames[i].second.data == sent[0][i]);
                CHECK(master.frames[i].second.bit_period == (rate + 1) * 2 * cosim::kSecond / 16'000'000);
            }
            const auto clock = master.edges_of({P::B, 0});
            CHECK(clock[9].at - clock[8].at == rate + 1u);
        }
}

TEST_CASE("a frame on the link is sampled by a synchronous master's clock") {
    test::Rig rig(R"(
        sbi DDRB, 0
        ldi r16, 49
        sts UBRR0L, r16     ; 100 clocks a bit
        ldi r16, 0x46
        sts UCSR0C, r16
        ldi r16, 0x10
        sts UCSR0B, r16
wait:   lds r17, UCSR0A
        sbrs r17, 7
        rjmp wait
        lds r18, UDR0
        sts 0x100, r18
        sts 0x101, r17
end:    rjmp end
)");
    rig.run(500);
    cosim::UartFrame frame;
    frame.start = rig.chip.now();
    frame.bit_period = 100 * cosim::kSecond / 16'000'000;
    frame.data = 0x6B;
    rig.chip.run_until(frame.start + 9 * frame.bit_period);
    rig.chip.uart_receive(0, frame);
    rig.chip.run_until(frame.start + 12 * frame.bit_period);
    CHECK(rig.ram(0x100) == 0x6B);
    CHECK(rig.ram(0x101) == 0xA0);
}

TEST_CASE("in multi-processor mode data frames are seen only by who was addressed") {
    RandomStream random(20261123, "mpcm");
    DriverBench bench("usart_addressed");
    const std::uint8_t ours = drawn(random), other = static_cast<std::uint8_t>(ours + 1);
    bench.put(0, ours);
    bench.start();
    const std::array<std::uint8_t, 3> data{drawn(random), drawn(random), drawn(random)};
    const std::pair<std::uint8_t, bool> sequence[] = {{other, true},    {data[0], false}, {ours, true},
                                                      {data[1], false}, {other, true},    {data[2], false}};
    bench.chip.run_until(100 * cosim::kMicrosecond);
    for (const auto& [byte, mark] : sequence) {
        cosim::UartFrame frame;
        frame.start = bench.chip.now() + cosim::kMicrosecond;
        frame.bit_period = 17 * cosim::kMicrosecond;
        frame.data_bits = 9;
        frame.data = static_cast<std::uint16_t>(byte | mark << 8);
        bench.chip.run_until(frame.start + 10 * frame.bit_period);
        bench.chip.uart_receive(0, frame);
        bench.chip.run_until(frame.start + 13 * frame.bit_period);
    }
    CHECK(bench.result(0) == other);
    CHECK(bench.result(1) == ours);
    CHECK(bench.result(2) == data[1]);
    CHECK(bench.result(3) == other);
    CHECK(bench.result(4) == 0);
}

TEST_CASE("a two-wire START waits for the bus, lost arbitration may make a slave, a stray STOP is an error") {
    const std::string source = R"(
        ldi r26, 0
        ldi r27, 1
        ldi r16, 0x42       ; address 0x21
        sts TWAR, r16
        ldi r16, 72
        sts TWBR, r16
        ldi r16, 0x44
        sts TWCR, r16
        ldi r18, 0
go:     sbis GPIOR0, 0
        rjmp go
        ldi r16, 0xE4       ; START as soon as the bus is free
        sts TWCR, r16
wait:   lds r17, TWCR
        sbrs r17, 7
        rjmp wait
        lds r17, TWSR
        st  X+, r17
        ldi r19, 0xA0       ; address byte
        sts TWDR, r19
        ldi r16, 0xC4
        cpi r17, 0
        brne next
        ldi r16, 0xD4       ; out of a bus error by TWSTO
next:   sts TWCR, r16
        rjmp wait
)";
    const auto phase_of = [](test::Rig& rig, Kind kind, std::uint8_t byte) {
        cosim::I2cPhase phase;
        phase.kind = kind;
        phase.byte = byte;
        phase.start = rig.chip.now();
        phase.clock_period = 10 * cosim::kMicrosecond;
        return phase;
    };
    const auto later = [](test::Rig& rig, int microseconds) {
        rig.chip.run_until(rig.chip.now() + microseconds * cosim::kMicrosecond);
    };
    const auto begin = [&](test::Rig& rig) {
        later(rig, 20);
        rig.chip.inside().core.write_data(0x3E, 1);
    };
    SECTION("the bus is another master's") {
        test::Rig rig(source);
        later(rig, 10);
        rig.chip.twi_slave_phase(phase_of(rig, Kind::Start, 0x90));
        begin(rig);
        later(rig, 300);
        CHECK(rig.phases.empty());
        CHECK(rig.ram(0x100) == 0);
        rig.chip.twi_slave_phase(phase_of(rig, Kind::Stop, 0));
        later(rig, 100);
        CHECK(rig.ram(0x100) == 0x08);
        REQUIRE(rig.phases.size() == 1);
        CHECK(rig.phases[0].byte == 0xA0);
    }
    for (const auto& [address, status] : {std::pair<int, int>{0x42, 0x68}, {0x43, 0xB0}, {0x44, 0x38}}) {
        DYNAMIC_SECTION("lost to a master that sends " << address) {
            test::Rig rig(source);
            begin(rig);
            later(rig, 50);
            REQUIRE(rig.phases.size() == 1);
            rig.chip.twi_slave_phase(phase_of(rig, Kind::Start, static_cast<std::uint8_t>(address)));
            later(rig, 150);
            CHECK(rig.ram(0x101) == status);
            CHECK(rig.answers.size() == 1);
            CHECK(rig.answers[0].ack == (status != 0x38));
        }
    }
    SECTION("somebody sends STOP in the middle of our byte") {
        test::Rig rig(source);
        begin(rig);
        later(rig, 50);
        rig.chip.twi_slave_phase(phase_of(rig, Kind::Stop, 0));
        later(rig, 5);
        CHECK(rig.ram(0x101) == 0x00);
        later(rig, 50);
        CHECK((rig.chip.peek("TWCR") & 0x10) == 0);
        CHECK((rig.chip.peek("TWSR") & 0xF8) == 0xF8);
        CHECK(rig.phases.size() == 1);  // without a STOP of ours
    }
}

TEST_CASE(
    "USART1 by interrupts, double speed, even parity: an echo, and each error in its character's place") {
    RandomStream random(20261123, "echo");
    DriverBench bench("echo");
    bench.start();
    bench.chip.run_until(200 * cosim::kMicrosecond);
    std::vector<std::uint8_t> good;
    for (int i = 0; i < 12; ++i) {
        cosim::UartFrame frame;
        frame.start = bench.chip.now() + 3 * cosim::kMicrosecond;
        frame.bit_period = 8'500'000;  // 8 * 17 clocks
        frame.data = drawn(random);
        frame.parity = 2;
        frame.stop_bits = 2;
        const bool odd = std::popcount(frame.data) % 2;
        const bool wrong_parity = i == 4, is_break = i == 8;
        frame.parity_bit = odd != wrong_parity;
        frame.is_break = is_break;
        if (!wrong_parity && !is_break) good.push_back(static_cast<std::uint8_t>(frame.data));
        bench.chip.run_until(frame.start + 10 * frame.bit_period);
        bench.chip.uart_receive(1, frame);
        bench.chip.run_until(frame.start + 13 * frame.bit_period);
    }
    bench.chip.run_until(bench.chip.now() + cosim::kMillisecond);
    CHECK(bench.result(0) == 0x04);           // UPE
    CHECK((bench.result(1) & 0x10) == 0x10);  // FE
    REQUIRE(bench.frames.size() == good.size());
    for (std::size_t i = 0; i < good.size(); ++i) {
        const cosim::UartFrame& frame = bench.frames[i].second;
        CHECK(frame.data == static_cast<std::uint8_t>(~good[i]));
        CHECK(frame.parity == 2);
        CHECK(frame.parity_bit == std::popcount(frame.data) % 2);
        CHECK(frame.stop_bits == 2);
        CHECK(frame.bit_period == 8'500'000);
    }
}

TEST_CASE("the two-wire master of util/twi.h: write, repeated START, read, every status code") {
    RandomStream random(20261123, "twi");
    DriverBench bench("twi_master");
    const auto address = static_cast<std::uint8_t>(8 + random.below(100));
    const std::uint8_t place = drawn(random), value = drawn(random), read[] = {drawn(random), drawn(random)};
    bench.put(0, address);
    bench.put(1, place);
    bench.put(2, value);
    bench.start();
    std::size_t answered = 0, reads = 0;
    while (bench.chip.now() < cosim::kMillisecond && !bench.chip.stopped_at()) {
        bench.chip.run_until(bench.chip.now() + cosim::kMicrosecond);
        if (bench.phases.size() == answered) continue;
        cosim::I2cPhase answer = bench.phases[answered++];
        if (answer.kind == Kind::Stop) continue;
        bench.chip.run_until(answer.start + 9 * answer.clock_period);
        const bool data = answer.kind == Kind::Read;
        answer.kind = data ? Kind::Data : Kind::Acknowledge;
        if (data)
            answer.byte = read[reads++];
        else
            answer.ack = 1;
        bench.chip.twi_answer(answer);
    }
    REQUIRE(bench.chip.stopped_at());
    const std::uint8_t codes[] = {0x08, 0x18, 0x28, 0x28, 0x10, 0x40, 0x50, 0x58};
    for (std::size_t i = 0; i < std::size(codes); ++i)
        CHECK(bench.result(i) == codes[i]);
    CHECK(bench.result(32) == read[0]);
    CHECK(bench.result(33) == read[1]);
    CHECK(bench.result(34) == 0xF8);
    const std::pair<Kind, int> sent[] = {{Kind::Start, address << 1},
                                         {Kind::Write, place},
                                         {Kind::Write, value},
                                         {Kind::Start, address << 1 | 1},
                                         {Kind::Read, 1},
                                         {Kind::Read, 0},
                                         {Kind::Stop, 0}};
    REQUIRE(bench.phases.size() == std::size(sent));
    for (std::size_t i = 0; i < std::size(sent); ++i) {
        CHECK(bench.phases[i].kind == sent[i].first);
        CHECK((sent[i].first == Kind::Read ? bench.phases[i].ack : bench.phases[i].byte) == sent[i].second);
        CHECK(bench.phases[i].clock_period == (16 + 2 * 12) * cosim::kSecond / 16'000'000);
    }
}
