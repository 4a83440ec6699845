// The real image boots: range-and-bearing fact sheet 6.3 A1, A2, A3, A21, 1.5, 1.7, and 4.8 Q14.

#include "tests/rab_board/rab_rig.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

using namespace puckloop;
using rab::RabRig;

namespace {

Approx about(double value) {
    return Approx(value).epsilon(0.02);
}

constexpr const char* kBanner = "E-PUCK RANGE AND BEARING STARTED\n\r";

struct Expected {
    const char* name;
    std::uint16_t value;
    std::uint16_t mask = 0xFFFF;  ///< bits that the sheet states
};

/// Fact sheet 1.5, but for IPC4: bits 10 to 8 do not exist on this part (data sheet: mask 0x7077), so the
/// sheet's 0x4447 cannot be read.
constexpr Expected kAfterInit[] = {
    {"TRISA", 0xFFC4, 0xF6FF}, {"TRISB", 0x00C2},
    {"TRISD", 0xFFFF},         {"TRISF", 0xEEFC, 0x31FF},
    {"TRISG", 0x0FFC, 0xF3CF}, {"LATA", 0x0000},
    {"LATB", 0x0004},          {"LATF", 0x1000},
    {"LATG", 0x0000},          {"CLKDIV", 0x3000},
    {"PLLFBD", 0x0050},        {"OSCCON", 0x3320},
    {"IPC2", 0x6441},          {"T1CON", 0x8000},
    {"PR1", 0x0FA0},           {"T2CON", 0x8000},
    {"PR2", 0x0054},           {"T3CON", 0x8000},
    {"PR3", 0x0FA0},           {"OC1R", 0x002A},
    {"OC1RS", 0x002A},         {"OC1CON", 0x0006},
    {"IEC0", 0x1988},          {"IEC1", 0xC001},
    {"IPC0", 0x4444},          {"IPC1", 0x5444},
    {"IPC4", 0x4047},          {"I2C1CON", 0x9040},
    {"I2C1ADD", 0x0020},       {"U1MODE", 0xA000},
    {"U2MODE", 0xA000},        {"U1STA", 0x0510},
    {"U2STA", 0x0510},         {"U1BRG", 0x002A},
    {"U2BRG", 0x002A},         {"SPI1STAT", 0x8000, 0xFFFE},
    {"SPI1CON1", 0x0121},      {"AD1CON1", 0x84E0, 0xFFFE},
    {"AD1CON2", 0x0000},       {"AD1CON3", 0x000A},
    {"AD1CHS0", 0x001F},       {"AD1PCFGH", 0x000F},
    {"AD1PCFGL", 0x0000},
};

}  // namespace

TEST_CASE("A1: the board prints its baselines, sets the potentiometer twice and stands as in the sheet") {
    const char* const image = GENERATE(rab::kRandb, rab::kErab);
    const auto file = exec::real_image(image);
    if (!file) return;
    INFO(image);
    RabRig rig(*file);
    for (int i = 0; i < 12; ++i)
        rig.bench().set(fmt::format("peak{}", i + 1), 100 + i);
    rig.run_to(0.1);
    CHECK(rig.bench().take_text(2) ==
          std::string(kBanner) + "100 101 102 103 104 105 106 107 108 109 110 111 \n\r");
    CHECK(rig.bench().bench().uart(2).framing_errors_seen() == 0);
    std::vector<double> codes;
    for (const auto& change : rig.changes("power"))
        codes.push_back(change.value);
    CHECK(codes == std::vector<double>{0x00, 0x64});
    for (const Expected& expected : kAfterInit) {
        INFO(expected.name);
        CHECK((rig.chip().peek(expected.name) & expected.mask) == (expected.value & expected.mask));
    }
    for (const auto& change : rig.changes("led"))
        CHECK(change.value == 0);
    const dspic::ChipReport report = rig.chip().report();
    CHECK(report.resets.size() == 1);
    CHECK(report.traps.empty());
    CHECK(report.unmodelled.empty());
    CHECK(report.warnings.empty());
    // 24 pulses of 720 to 890 cycles: every reset line twice.
    for (int i = 1; i <= 12; ++i) {
        const auto pulses = rig.changes(fmt::format("peak_reset{}", i));
        INFO("peak_reset" << i);
        REQUIRE(pulses.size() >= 4);
        const std::size_t first = pulses.size() - 4;
        for (std::size_t k = first; k < pulses.size(); k += 2) {
            CHECK(pulses[k].value == 1);
            CHECK((pulses[k + 1].time_s - pulses[k].time_s) * 41e6 == Approx(805).margin(100));
        }
    }
}

TEST_CASE("A2: the board acknowledges 0x20 once its ports are set up, and 0x21 never") {
    const auto file = exec::real_image(rab::kRandb);
    if (!file) return;
    RabRig rig(*file);
    std::string script;
    for (int i = 0; i < 100; ++i)
        script += fmt::format("{:.6f} w 0x20 00\n{:.6f} w 0x21 00\n", 0.007 + i * 2.5e-4, 0.007 + i * 2.5e-4);
    rig.play(script);
    CHECK(rig.bus().starts == 200);
    const std::uint64_t refused = rig.bus().addresses_refused - 100;  // those for 0x21
    CHECK(0.007 + static_cast<double>(refused) * 2.5e-4 == Approx(0.0093).margin(0.0004));
}

TEST_CASE("A3: the carrier has a period of 85 cycles, 42 of them high") {
    const auto file = exec::real_image(rab::kRandb);
    if (!file) return;
    RabRig rig(*file);
    rig.boot();
    const dspic::OutputCompareState carrier = rig.chip().output_compare(1);
    CHECK(carrier.running);
    CHECK(carrier.mode == 6);
    CHECK(carrier.period == 85);
    CHECK(carrier.high == 42);
    CHECK(rig.bench().get("carrier") == Approx(482'352.9));
}

TEST_CASE("A21: timers interrupt as often as in the sheet") {
    const auto file = exec::real_image(rab::kRandb);
    if (!file) return;
    const auto [entry, rate] =
        GENERATE(table<std::uint32_t, double>({{0x34E4, 482'353.0}, {0x34F4, 10'195.0}, {0x1704, 10'195.0}}));
    RabRig rig(*file);
    rig.boot();
    rig.chip().stop_at(entry);
    const double from = rig.now_s(), seconds = 0.02;
    int count = 0;
    while (rig.bench().bench().run_until(cosim::from_seconds(from + seconds)) == exec::Bench::End::Address)
        ++count;
    INFO("entry " << entry);
    CHECK(count / seconds == Approx(rate).epsilon(0.005));
}

TEST_CASE("boot takes its time: main, text, carrier, baselines, main loop") {
    const auto file = exec::real_image(rab::kRandb);
    if (!file) return;
    // Ambient level, end of the baselines' text, second potentiometer byte: 1.7. The potentiometer settles 1
    // ms.
    const auto [level, text_ms, loop_ms] =
        GENERATE(table<int, double, double>({{5, 27.8, 62.4}, {500, 42.7, 77.4}, {1500, 50.2, 84.9}}));
    RabRig rig(*file);
    rig.ambient(level);
    rig.run_to(0.1);
    INFO("baseline " << level);
    const auto text = rig.bench().take(2);
    REQUIRE(text.size() > 34 + 12 * 2);
    CHECK(text[0].start == Approx(9.3e9).epsilon(0.05));
    CHECK(cosim::to_seconds(text[33].start) == about(0.0150));
    CHECK(cosim::to_seconds(text.back().start) == about(text_ms * 1e-3));
    const auto carrier = rig.changes("carrier");
    REQUIRE(carrier.size() == 1);
    CHECK(carrier[0].time_s == about(0.0151));
    const auto power = rig.changes("power");
    REQUIRE(power.size() == 2);
    CHECK(power[1].time_s - 1e-3 == about(loop_ms * 1e-3));
}

TEST_CASE("the program is in main after 29751 cycles on the internal oscillator") {
    const auto file = exec::real_image(rab::kRandb);
    if (!file) return;
    RabRig rig(*file);
    rig.chip().stop_at(0x3638);
    REQUIRE(rig.bench().bench().run_until(cosim::kSecond) == exec::Bench::End::Address);
    CHECK(static_cast<double>(rig.chip().cycle()) == about(29'751));
    CHECK(rig.now_s() == about(8.07e-3));
}

TEST_CASE("Q14: a range set before the main loop is replaced, a frame sent before 15 ms is lost") {
    const auto file = exec::real_image(rab::kRandb);
    if (!file) return;
    RabRig rig(*file);
    rig.play("0.0105 w 0x20 0e 55\n0.030 w 0x20 0c 73\n");
    rig.run_to(0.1);
    std::vector<double> codes;
    for (const auto& change : rig.changes("power"))
        codes.push_back(change.value);
    CHECK(codes == std::vector<double>{0x00, 0x73, 0x64});
    CHECK(rig.bursts().empty());
    rig.send(16, 0x0055);
    rig.run_for(0.01);
    CHECK(rig.bursts().size() == 1);
}
