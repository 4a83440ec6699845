// Timer 2 with its own clock, ADC, comparator, watchdog, memories, sleep and pins, driven by programs of
// avr-gcc and avr-libc (programs/drivers). Expected values: data sheet 8272, "Asynchronous Operation of
// Timer/Counter2", "Analog to Digital Converter", "Power Management and Sleep Modes", "Watchdog Timer",
// "Boot Loader Support", "Alternate Port Functions".

#include "tests/avr/driver_bench.h"
#include "tests/avr/rig.h"

#include <catch2/catch.hpp>

#include <bit>
#include <cmath>

using namespace puckloop;
using namespace puckloop::avr;
using test::DriverBench;
using P = PortLetter;

namespace {

constexpr double kHertz = 16e6, kWatch = 32768;
constexpr Fuses kAsShippedButCrystal{0xFF, 0x99, 0xFF, 0xFF};

ChipOptions with_watch() {
    ChipOptions options;
    options.watch_hertz = 32768;
    return options;
}

}  // namespace

TEST_CASE("timer 2 on a watch crystal: update flags, waking from power-save, standing still in power-down") {
    RandomStream random(20261123, "watch");
    const auto top = static_cast<std::uint8_t>(20 + random.below(40));
    DriverBench bench("clock_of_its_own", with_watch());
    bench.put(0, top);
    bench.start();
    while (bench.chip.now() < cosim::kSecond && !(bench.chip.sleeping() && bench.chip.peek("SMCR") >> 1 == 2))
        bench.chip.run_until(bench.chip.now() + cosim::kMillisecond);
    bench.chip.run_until(bench.chip.now() + 300 * cosim::kMillisecond);
    REQUIRE(bench.chip.sleeping());
    bench.set_pin({P::B, 0}, false);
    REQUIRE(bench.finish());
    CHECK(bench.result(0) == 0x2F);  // AS2 and four registers on their way
    CHECK(bench.result(1) == top);
    CHECK(bench.result(2) == 0x02);
    // Two rising edges of TOSC1: one to two periods, and the program's own loop.
    CHECK(bench.stamp(0) > kHertz / kWatch - 20);
    CHECK(bench.stamp(0) < 2 * kHertz / kWatch + 40);
    CHECK(bench.result(3) == 0x20);
    CHECK(bench.result(4) == 6);
    const auto ticks = bench.edges_of({P::A, 0});
    REQUIRE(ticks.size() >= 6);
    for (std::size_t i = 2; i < 6; ++i)  // the first one may find the CPU awake
        CHECK(static_cast<double>(ticks[i].at - ticks[i - 1].at) ==
              Approx((top + 1) * 8 * kHertz / kWatch).margin(2.0));
    CHECK(bench.result(7) - bench.result(5) <= 1);
    CHECK(bench.result(8) == bench.result(6));
    CHECK(bench.result(9) == 1);
    CHECK(bench.chip.report().unmodelled.empty());
    CHECK(bench.chip.report().warnings.empty());
}

TEST_CASE("timer 2 keeps the watch crystal's time whatever the CPU's clock does, and a state keeps both") {
    // Overflows of 256 * 1 / 32768 s count in RAM while the CPU's clock is divided by eight half-way.
    const std::string source = R"(
        jmp start
        .org 0x2C
        lds r20, 0x100      ; TIMER2_OVF
        inc r20
        sts 0x100, r20
        reti
start:  ldi r16, 0x20
        sts ASSR, r16
        ldi r16, 1
        sts TCCR2B, r16
        sts TIMSK2, r16
        sei
slow:   lds r20, 0x100
        cpi r20, 50
        brlo slow
        ldi r16, 0x80
        ldi r17, 3
        sts CLKPR, r16
        sts CLKPR, r17
end:    rjmp end
)";
    test::Rig rig(source, with_watch());
    rig.chip.run_until(cosim::kSecond + 5 * cosim::kMillisecond);
    CHECK(rig.ram(0x100) == 128);
    CHECK(rig.chip.clock().hertz() == 2e6);
    CHECK(rig.chip.cycle() < 8'000'000);  // (50 + 78 / 8) / 128 of a second's
}

TEST_CASE("AS2 without a crystal stops timer 2, which is reported, with EXCLK it counts edges at TOSC1") {
    test::Rig rig("ldi r16, 0x20\n sts ASSR, r16\n ldi r16, 1\n sts TCCR2B, r16\nend: rjmp end\n");
    rig.chip.run_until(10 * cosim::kMillisecond);
    CHECK(rig.chip.peek("ASSR") == 0x21);
    REQUIRE(rig.chip.report().warnings.size() == 1);
    CHECK(rig.chip.report().warnings[0].text.find("no crystal at TOSC1") != std::string::npos);

    RandomStream random(20261123, "exclk");
    DriverBench bench("clock_at_pin");
    bench.set_pin({P::C, 6}, false);
    bench.start();
    bench.chip.run_until(30 * cosim::kMicrosecond);
    const auto edges = static_cast<int>(20 + random.below(500));
    for (int i = 0; i < edges; ++i) {
        bench.set_pin({P::C, 6}, true);
        bench.chip.run_until(bench.chip.now() + 5 * cosim::kMicrosecond);
        bench.set_pin({P::C, 6}, false);
        bench.chip.run_until(bench.chip.now() + 5 * cosim::kMicrosecond);
    }
    CHECK(bench.result(0) == 100 + edges / 8);
}

TEST_CASE("the ADC: triggers without interrupts, a channel that stays, sleep that converts, the multiplexed "
          "comparator") {
    RandomStream random(20261123, "adc");
    DriverBench bench("adc_triggered");
    for (double& volts : bench.volts)
        volts = 0.1 + 4.8 * random.uniform();
    bench.volts[4] = 0.3;
    const auto code = [&](std::size_t channel) { return std::floor(bench.volts[channel] / 5.0 * 1024.0); };
    bench.start();
    while (bench.chip.now() < cosim::kSecond && bench.chip.peek("GPIOR0") != 1)
        bench.chip.run_until(bench.chip.now() + 100 * cosim::kMicrosecond);
    CHECK(bench.result(1) == 0);
    for (const double volts : {1.05, 1.15, 2.0, 0.9, 1.2}) {
        bench.volts[4] = volts;
        bench.chip.pins_changed(P::A);
        bench.chip.run_until(bench.chip.now() + 50 * cosim::kMicrosecond);
    }
    REQUIRE(bench.finish(cosim::kMillisecond));
    CHECK(bench.stamp(0) == code(3));
    CHECK(bench.stamp(1) == code(1));
    CHECK(bench.stamp(2) == code(2));
    CHECK(bench.result(0) == 1);
    CHECK((bench.result(2) & 0x20) == 0);  // ACO: 1.1 V against 1.2 V
    const auto ends = bench.edges_of({P::A, 7});
    REQUIRE(ends.size() == 6);
    for (std::size_t i = 2; i < 5; ++i)
        CHECK(static_cast<double>(ends[i].at - ends[i - 1].at) == Approx(10'000).margin(8));
}

TEST_CASE("each trigger source of the ADC starts a conversion when its flag rises, and only then") {
    // ADTS, what raises the flag; conversions are counted by ADIF, polled and cleared.
    struct Source {
        int number;
        std::string set_up;
        bool pin;
    };
    for (const Source& source : {Source{2, "ldi r16, 2\n sts EICRA, r16\n", true},
                                 Source{3, "ldi r16, 99\n out OCR0A, r16\n", false}, Source{4, "", false},
                                 Source{5, "ldi r16, 77\n sts OCR1BL, r16\n", false},
                                 Source{7, "ldi r16, 0x41\n sts TCCR1B, r16\n", true}}) {
        INFO("ADTS " << source.number);
        test::Rig rig(
            "ldi r16, 2\n out TCCR0B, r16\n ldi r16, 1\n sts TCCR1B, r16\n" + source.set_up + "ldi r16, " +
            std::to_string(source.number) +
            "\n sts ADCSRB, r16\n ldi r16, 0xA2\n sts ADCSRA, r16\n"
            "loop: lds r17, ADCSRA\n sbrs r17, 4\n rjmp loop\n"
            "lds r18, 0x100\n inc r18\n sts 0x100, r18\n ldi r17, 0xB2\n sts ADCSRA, r17\n rjmp loop\n");
        if (source.number == 7) rig.set_pin({P::D, 6}, false);
        rig.run(100);
        CHECK(rig.ram(0x100) == 0);
        if (source.pin) {
            rig.set_pin({P::D, static_cast<std::uint8_t>(source.number == 2 ? 2 : 6)}, source.number == 7);
        }
        rig.run(20'000);
        CHECK(rig.ram(0x100) == 1);  // the flag stays set: no second edge
    }
}

TEST_CASE("EEPROM, watchdog, clock prescaler and fuses as avr-libc uses them") {
    RandomStream random(20261123, "memories");
    DriverBench bench("memories");
    std::array<std::uint8_t, 8> bytes{};
    for (std::size_t i = 0; i < bytes.size(); ++i)
        bench.put(i, bytes[i] = static_cast<std::uint8_t>(random.below(256)));
    bench.start();
    REQUIRE(bench.finish());
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        CHECK(bench.chip.eeprom()[i] == bytes[i]);
        CHECK(bench.result(i) == bytes[i]);
    }
    CHECK(bench.result(8) == 0xFF);
    CHECK(bench.result(9) == 0xD9);
    CHECK(bench.result(10) == 0xFD);
    CHECK(bench.result(11) == 0x1E);
    CHECK(bench.result(12) == 0x97);
    CHECK(bench.result(13) == 0x05);
    // Interrupt after 8192 periods of 128 kHz, reset after as many more.
    const auto& clock = bench.chip.clock();
    const auto on = bench.edges_of({P::A, 0}), bark = bench.edges_of({P::A, 1});
    REQUIRE(on.size() >= 1);
    REQUIRE(bark.size() >= 1);
    const ChipReport report = bench.chip.report();
    REQUIRE(report.resets.size() == 2);
    CHECK(report.resets[1].cause == ResetCause::Watchdog);
    const double began = cosim::to_seconds(clock.time_of(on[0].at));
    CHECK(cosim::to_seconds(clock.time_of(bark[0].at)) - began == Approx(0.064).margin(1e-4));
    CHECK(cosim::to_seconds(clock.time_of(report.resets[1].cycle)) - began == Approx(0.128).margin(1e-4));
}

TEST_CASE("JTAG holds its pins until JTD is written twice, every port's pin changes wake from power-down") {
    RandomStream random(20261123, "wakers");
    DriverBench bench("wakers", {.fuses = kAsShippedButCrystal});
    std::array<std::uint8_t, 4> masks{};
    for (std::size_t port = 0; port < 4; ++port) {
        masks[port] = static_cast<std::uint8_t>(1u << random.below(3) | 1u << (4 + random.below(4)));
        bench.put(port, masks[port]);
    }
    bench.start();
    for (int port = 0; port < 4; ++port) {
        INFO("port " << port);
        bench.chip.run_until(bench.chip.now() + 5 * cosim::kMillisecond);
        REQUIRE(bench.chip.sleeping());
        REQUIRE(bench.chip.peek("GPIOR0") == port + 1);
        for (std::uint8_t pin = 0; pin < 8; ++pin)  // pins without their mask do not wake
            if (!(masks[static_cast<std::size_t>(port)] >> pin & 1)) {
                bench.set_pin({static_cast<PortLetter>(port), pin}, false);
                bench.set_pin({static_cast<PortLetter>(port), pin}, true);
            }
        bench.chip.run_until(bench.chip.now() + 2 * cosim::kMillisecond);
        REQUIRE(bench.chip.sleeping());
        const auto pin = static_cast<std::uint8_t>(std::countr_zero(masks[static_cast<std::size_t>(port)]));
        bench.set_pin({static_cast<PortLetter>(port), pin}, false);
    }
    REQUIRE(bench.finish(10 * cosim::kMillisecond));
    CHECK(bench.result(0) == 0xC3);
    CHECK(bench.result(1) == 0xC3);
    CHECK(bench.result(2) == 0xFF);
    CHECK(bench.result(3) == 0xF0);
    for (std::size_t port = 0; port < 4; ++port)
        CHECK(bench.result(4 + port) == 1 << port);
}

TEST_CASE("a boot loader writes the application, which is unreadable meanwhile, and locks itself") {
    RandomStream random(20261123, "boot");
    DriverBench bench("boot_loader");
    bench.chip.set_fuses({0xFF, 0xD8, 0xFD, 0xFF});  // boot section of 4096 words, reset there
    std::array<std::uint8_t, 32> bytes{};
    for (std::size_t i = 0; i < bytes.size(); ++i)
        bench.put(i, bytes[i] = static_cast<std::uint8_t>(random.below(256)));
    bench.start();
    REQUIRE(bench.finish());
    CHECK(bench.result(0) == 0xFF);
    CHECK(bench.result(1) == 1);
    CHECK(bench.result(2) == 0xFF);
    CHECK(bench.result(3) == 1);
    CHECK(bench.stamp(0) == Approx(3.7e-3 * kHertz / 64).margin(5));
    CHECK(bench.result(4) == 0xFF);
    for (std::size_t i = 0; i < bytes.size(); ++i)
        CHECK(bench.result(16 + i) == bytes[i]);
    CHECK(bench.result(5) == 0x5A);
    CHECK(bench.result(6) == 0xEF);
}

TEST_CASE("lock bits keep interrupts off where their vectors may not be read from") {
    // INT0 is pending; the program enables interrupts in the application, and in the boot section.
    const std::string source = R"(
        jmp start
        ldi r20, 1
        sts 0x100, r20
        cbi EIMSK, 0
        reti
        .org 0x100
start:  sbi EIMSK, 0
        jmp 0x1E000
back:   ldi r21, 7
        sts 0x102, r21
        nop
end:    rjmp end
        .org 0x1E000
        sei
        nop
        nop
        lds r21, 0x100
        sts 0x101, r21
        jmp back
)";
    for (const bool locked : {false, true}) {
        ChipOptions options;
        options.fuses = {0xFF, 0xD9, 0xFD, static_cast<std::uint8_t>(locked ? 0xCF : 0xFF)};
        test::Rig rig(source, options);
        rig.set_pin({P::D, 2}, false);
        rig.run(200);
        CHECK(rig.ram(0x101) == !locked);
        CHECK(rig.ram(0x100) == 1);
        CHECK(rig.ram(0x102) == 7);
    }
}

TEST_CASE("fuses choose the clock, keep the watchdog on, and set the supply below which nothing runs") {
    const std::string blink = "sbi DDRA, 0\nloop: sbi PINA, 0\n rjmp loop\n";
    for (const auto& [low, hertz] :
         {std::pair<int, double>{0x62, 1e6}, {0xE2, 8e6}, {0xE3, 128e3}, {0xFF, 12e6}}) {
        ChipOptions options;
        options.oscillator_hertz = 12e6;
        options.fuses.low = static_cast<std::uint8_t>(low);
        test::Rig rig(blink, options);
        rig.chip.run_until(10 * cosim::kMillisecond);
        CHECK(rig.chip.clock().hertz() == hertz);
    }
    ChipOptions always;
    always.fuses.high = 0xC9;  // WDTON
    test::Rig watched("ldi r16, 0x18\n ldi r17, 0x40\n sts WDTCSR, r16\n sts WDTCSR, r17\nend: rjmp end\n",
                      always);
    watched.chip.run_until(20 * cosim::kMillisecond);
    REQUIRE(watched.chip.report().resets.size() == 2);
    CHECK(watched.chip.report().resets[1].cause == ResetCause::Watchdog);

    test::Rig supplied("in r16, MCUSR\n sts 0x100, r16\n" + blink);  // BODLEVEL 2.7 V
    const auto runs = [&] {
        const std::size_t before = supplied.edges.size();
        supplied.chip.run_until(supplied.chip.now() + 10 * cosim::kMicrosecond);
        return supplied.edges.size() > before + 5;
    };
    CHECK(runs());
    supplied.chip.set_supply(2.75);
    CHECK(runs());
    supplied.chip.set_supply(2.6);
    supplied.chip.run_until(supplied.chip.now() + 3 * cosim::kMicrosecond);  // tBOD is 2
    CHECK_FALSE(runs());
    supplied.chip.set_supply(2.72);
    CHECK_FALSE(runs());
    supplied.chip.set_supply(3.3);
    const auto start_up = [&] {  // 65 ms and 16384 clocks
        CHECK_FALSE(runs());
        supplied.chip.run_until(supplied.chip.now() + 67 * cosim::kMillisecond);
    };
    start_up();
    CHECK(runs());
    CHECK(supplied.ram(0x100) == 0x05);  // BORF beside PORF
    supplied.chip.set_supply(0.5);
    supplied.chip.set_supply(5.0);
    start_up();
    CHECK(runs());
    CHECK(supplied.ram(0x100) == 0x01);
    const ChipReport report = supplied.chip.report();
    REQUIRE(report.resets.size() == 3);
    CHECK(report.resets[1].cause == ResetCause::BrownOut);
    CHECK(report.resets[2].cause == ResetCause::PowerOn);
}

TEST_CASE("PWM at the pins, capture through the noise canceler and edges at T0, as a program sets them up") {
    RandomStream random(20261123, "timers");
    DriverBench bench("timers");
    std::array<unsigned, 4> duty{};
    for (std::size_t i = 0; i < duty.size(); ++i)
        bench.put(i, static_cast<std::uint8_t>(duty[i] = static_cast<unsigned>(20 + random.below(200))));
    bench.set_pin({P::B, 5}, false);
    bench.set_pin({P::B, 0}, false);
    bench.start();
    bench.chip.run_until(cosim::kMillisecond);
    std::vector<Cycle> moved;
    for (int i = 0; i < 6; ++i) {
        // A spike of three clocks is no edge.
        bench.set_pin({P::B, 5}, i % 2 == 0);
        bench.chip.run_until(bench.chip.clock().time_of(bench.chip.cycle() + 2));
        bench.set_pin({P::B, 5}, i % 2 != 0);
        bench.chip.run_until(bench.chip.now() + 20 * cosim::kMicrosecond);
        moved.push_back(bench.chip.clock().first_cycle_at(bench.chip.now()));
        bench.set_pin({P::B, 5}, i % 2 == 0);
        bench.chip.run_until(bench.chip.now() +
                             static_cast<cosim::Time>(50 + random.below(100)) * cosim::kMicrosecond);
    }
    for (std::size_t i = 1; i < 6; ++i)
        CHECK(((bench.stamp(i) - bench.stamp(i - 1)) & 0xFFFF) == ((moved[i] - moved[i - 1]) & 0xFFFF));
    // From rising edge to falling edge, and from one rising edge to the next.
    const auto pulse = [&](Pin pin) {
        const auto edges = bench.edges_of(pin);
        REQUIRE(edges.size() > 8);
        const std::size_t up = edges[4].level ? 4 : 5;
        return std::pair(edges[up + 1].at - edges[up].at, edges[up + 2].at - edges[up].at);
    };
    CHECK(pulse({P::B, 3}) == std::pair<Cycle, Cycle>(duty[0] + 1, 256));
    CHECK(pulse({P::B, 4}) == std::pair<Cycle, Cycle>(256 - duty[1] - 1, 256));
    CHECK(pulse({P::D, 7}) == std::pair<Cycle, Cycle>(2 * duty[2], 510));
    CHECK(pulse({P::D, 5}) == std::pair<Cycle, Cycle>(501 + duty[3], 2000));
    REQUIRE(bench.chip.peek("GPIOR0") == 1);
    for (int i = 0; i < 6; ++i) {
        CHECK_FALSE(bench.chip.stopped_at());
        bench.set_pin({P::B, 0}, true);
        bench.chip.run_until(bench.chip.now() + 10 * cosim::kMicrosecond);
        if (i < 5) bench.set_pin({P::B, 0}, false);
    }
    REQUIRE(bench.chip.stopped_at());
    CHECK(bench.result(0) == 0);
}

TEST_CASE("external interrupts by edge and level wait for SEI and come by their numbers") {
    DriverBench bench("external");
    bench.set_pin({P::D, 3}, false);
    bench.start();
    while (bench.chip.peek("GPIOR0") != 1)
        bench.chip.run_until(bench.chip.now() + cosim::kMicrosecond);
    bench.set_pin({P::B, 2}, false);
    bench.set_pin({P::D, 3}, true);
    bench.set_pin({P::D, 2}, false);
    bench.set_pin({P::D, 2}, true);
    bench.chip.run_until(bench.chip.now() + cosim::kMillisecond);
    CHECK(bench.result(0) == 0x10);
    CHECK(bench.result(1) == 0x11);
    CHECK(bench.result(2) == 0x12);
    bench.set_pin({P::D, 3}, false);  // not INT1's edge
    bench.chip.run_until(bench.chip.now() + cosim::kMillisecond);
    CHECK(bench.result(3) == 0);
    bench.set_pin({P::D, 2}, false);
    REQUIRE(bench.finish(cosim::kMillisecond));
    CHECK(bench.result(3) == 0x10);
}
