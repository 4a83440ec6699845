// The range-and-bearing board's own firmware on the bare dsPIC33FJ256GP710: boot times, register values after
// the initialisation, UART text, interrupt rates, the I2C slave, the potentiometer's byte, a frame's chips.
// Figures: fact sheet rab.md, sections 1.3 to 1.7, 2.4 and 3.1 (measured there on another model; 2 %).

#include "emu/dspic/chip/chip.h"
#include "emu/image/image.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

using namespace puckloop;
using namespace puckloop::dspic;
using cosim::I2cPhase;
using cosim::I2cPhaseKind;
using cosim::Time;

namespace {

constexpr double kCrystal = 4e6;
constexpr double kFcy = 41e6;
constexpr std::uint32_t kMain = 0x3638, kT1 = 0x34F4, kT2 = 0x34E4, kT3 = 0x1704;
constexpr std::uint16_t kEmitters = 0xFF39;  // of port B
constexpr Time kSclPeriod = cosim::kSecond / 100'000;

double seconds(Time time) {
    return static_cast<double>(time) / static_cast<double>(cosim::kSecond);
}

struct Board : Pins {
    const Chip* chip = nullptr;
    std::string text;
    std::vector<Time> sent;
    std::vector<std::pair<Time, std::uint16_t>> port_b;
    std::vector<std::pair<Time, int>> potentiometer;
    std::optional<I2cPhase> answer;

    void driven(PortLetter port, std::uint16_t levels, std::uint16_t, Cycle now) override {
        if (port == PortLetter::B) port_b.emplace_back(chip->clock().time_of(now), levels);
    }
    std::uint16_t levels(PortLetter, Cycle) override { return 0xFFFF; }  // no carrier anywhere
    double analog(int, Cycle) override { return 0.0; }
    void uart_sent(int unit, const cosim::UartFrame& frame) override {
        if (unit == 2) {
            text += static_cast<char>(frame.data);
            sent.push_back(frame.start);
        }
    }
    void i2c_phase(int, const I2cPhase&) override {}
    void i2c_slave_answer(int, const I2cPhase& phase) override { answer = phase; }
    std::uint16_t spi_exchange(int unit, std::uint16_t word, int bits, Cycle now) override {
        CHECK(unit == 1);
        CHECK(bits == 8);
        potentiometer.emplace_back(chip->clock().time_of(now), word);
        return 0;
    }
};

/// The chip with the board's crystal, and a bus master at 100 kHz.
struct Bench {
    Board board;
    Chip chip{dspic33fj256gp710(), board, ChipOptions{kCrystal, 0.0, std::nullopt}};
    Time bus = 0;  ///< the master has got so far

    explicit Bench(const std::string& file) {
        board.chip = &chip;
        chip.load(image::load_image(file));
        chip.power_on();
    }
    void run_to(double time) { chip.run_until(static_cast<Time>(time * 1e12)); }
    /// Times at which the program comes by `pc` until `end`.
    std::vector<Time> passes(std::uint32_t pc, double end) {
        chip.stop_at(pc);
        std::vector<Time> times;
        const auto until = static_cast<Time>(end * 1e12);
        while (chip.now() < until) {
            chip.run_until(until);
            if (chip.stopped_at()) times.push_back(chip.now());
        }
        return times;
    }

    I2cPhase phase(I2cPhaseKind kind, int byte = 0) {
        chip.run_until(std::max(bus, chip.now()));
        I2cPhase phase;
        phase.kind = kind;
        phase.byte = static_cast<std::uint8_t>(byte);
        phase.ack = 1;
        phase.start = std::max(bus, chip.now());
        phase.clock_period = kSclPeriod;
        board.answer.reset();
        chip.i2c_slave_phase(1, phase);
        if (kind == I2cPhaseKind::Stop) {
            bus = phase.start + kSclPeriod;
            return phase;
        }
        while (!board.answer)
            chip.run_until(chip.now() + cosim::kMicrosecond);
        // The ninth clock ends one period after the answer.
        bus = phase.start + 9 * kSclPeriod + board.answer->stretch;
        return *board.answer;
    }
    /// Duration on the bus in seconds.
    double write_register(int reg, int value) {
        chip.run_until(std::max(bus, chip.now()));
        const Time start = std::max(bus, chip.now());
        CHECK(phase(I2cPhaseKind::Start, 0x40).ack == 1);
        CHECK(phase(I2cPhaseKind::Write, reg).ack == 1);
        CHECK(phase(I2cPhaseKind::Write, value).ack == 1);
        phase(I2cPhaseKind::Stop);
        return seconds(bus - start);
    }
    int read_register(int reg) {
        CHECK(phase(I2cPhaseKind::Start, 0x40).ack == 1);
        CHECK(phase(I2cPhaseKind::Write, reg).ack == 1);
        CHECK(phase(I2cPhaseKind::Start, 0x41).ack == 1);
        const I2cPhase data = phase(I2cPhaseKind::Read);
        phase(I2cPhaseKind::Stop);
        return data.byte;
    }
};

std::optional<std::string> image_file(const std::string& name) {
    const char* folder = std::getenv("PUCKLOOP_IMAGES");
    const std::string path = folder ? std::string(folder) + "/" + name : std::string{};
    if (folder != nullptr && std::filesystem::exists(path)) return path;
    WARN("skipped: PUCKLOOP_IMAGES does not name a folder with " << name);
    return std::nullopt;
}

const char* const kImages[] = {"randb.hex", "erab_1to4b.hex"};

}  // namespace

TEST_CASE("the board's firmware boots: clock switch, registers, text, potentiometer") {
    for (const char* name : kImages) {
        INFO(name);
        const auto file = image_file(name);
        if (!file) return;
        Bench bench(*file);
        const std::vector<Time> main = bench.passes(kMain, 0.0085);
        REQUIRE(main.size() == 1);
        CHECK(seconds(main[0]) == Approx(29'751 / 3.685e6).epsilon(0.002));
        bench.run_to(0.090);
        Chip& chip = bench.chip;
        CHECK(chip.clock().hertz() == kFcy);
        CHECK(chip.report().unmodelled.empty());
        CHECK(chip.report().warnings.empty());
        CHECK(chip.report().resets.size() == 1);
        CHECK(chip.report().traps.empty());
        // Unimplemented bits of TRISA, F and G read 0.
        const std::map<std::string, int> values = {
            {"TRISA", 0xFFC4 & 0xF6FF}, {"TRISB", 0x00C2},
            {"TRISD", 0xFFFF},          {"TRISF", 0xEEFC & 0x31FF},
            {"TRISG", 0x0FFC & 0xF3CF}, {"LATA", 0x0000},
            {"LATB", 0x0004},           {"LATF", 0x1000},
            {"LATG", 0x0000},           {"CLKDIV", 0x3000},
            {"PLLFBD", 0x0050},         {"OSCCON", 0x3320},
            {"T1CON", 0x8000},          {"PR1", 0x0FA0},
            {"T2CON", 0x8000},          {"PR2", 0x0054},
            {"T3CON", 0x8000},          {"PR3", 0x0FA0},
            {"OC1R", 0x002A},           {"OC1RS", 0x002A},
            {"OC1CON", 0x0006},         {"IEC0", 0x1988},
            {"IEC1", 0xC001},           {"IPC0", 0x4444},
            {"IPC1", 0x5444},           {"IPC2", 0x6441},
            {"IPC4", 0x4447 & 0x7077},  {"I2C1CON", 0x9040},
            {"I2C1ADD", 0x0020},        {"U1MODE", 0xA000},
            {"U2MODE", 0xA000},         {"U1STA", 0x0510},
            {"U2STA", 0x0510},          {"U1BRG", 0x002A},
            {"U2BRG", 0x002A},          {"SPI1CON1", 0x0121},
            {"AD1CON1", 0x84E1},        {"AD1CON2", 0x0000},
            {"AD1CON3", 0x000A},        {"AD1CHS0", 0x001F},
            {"AD1PCFGH", 0x000F},       {"AD1PCFGL", 0x0000},
        };
        for (const auto& [reg, value] : values) {
            INFO(reg);
            CHECK(chip.peek(reg) == value);
        }
        CHECK((chip.peek("SPI1STAT") & 0x8000) == 0x8000);
        const OutputCompareState carrier = chip.output_compare(1);
        CHECK(carrier.mode == 6);
        CHECK(carrier.running);
        CHECK(carrier.period == 85);
        CHECK(carrier.high == 42);

        CHECK(bench.board.text == "E-PUCK RANGE AND BEARING STARTED\n\r0 0 0 0 0 0 0 0 0 0 0 0 \n\r");
        CHECK(seconds(bench.board.sent.front()) == Approx(9.3e-3).epsilon(0.02));
        REQUIRE(bench.board.potentiometer.size() == 2);
        CHECK(bench.board.potentiometer[0].second == 0);
        CHECK(bench.board.potentiometer[1].second == 100);
        CHECK(seconds(bench.board.potentiometer[1].first) == Approx(62.4e-3).epsilon(0.02));
    }
}

TEST_CASE("the firmware's timers interrupt at the rates measured") {
    const auto file = image_file("randb.hex");
    if (!file) return;
    const auto mean = [&](std::uint32_t pc, double from, double to) {
        Bench bench(*file);
        bench.run_to(from);
        const std::vector<Time> times = bench.passes(pc, to);
        REQUIRE(times.size() > 2);
        return seconds(times.back() - times.front()) / static_cast<double>(times.size() - 1) * kFcy;
    };
    CHECK(mean(kT1, 0.07, 0.12) == Approx(4021.5).epsilon(0.0005));
    CHECK(mean(kT3, 0.07, 0.12) == Approx(4021.5).epsilon(0.0005));
    CHECK(mean(kT2, 0.07, 0.08) == Approx(85).epsilon(1e-6));
}

TEST_CASE("the firmware answers on the bus, stretches, and emits a frame") {
    const auto file = image_file("randb.hex");
    if (!file) return;
    Bench bench(*file);
    bench.run_to(0.005);
    CHECK(bench.phase(I2cPhaseKind::Start, 0x40).ack == 0);  // not initialised yet
    bench.phase(I2cPhaseKind::Stop);
    bench.run_to(0.070);
    CHECK(bench.phase(I2cPhaseKind::Start, 0x42).ack == 0);  // another address
    bench.phase(I2cPhaseKind::Stop);

    CHECK(bench.read_register(0) == 0);  // no message
    bench.run_to(seconds(bench.bus) + 1e-3);
    CHECK(bench.write_register(13, 0xA5) == Approx(293e-6).epsilon(0.05));
    bench.board.potentiometer.clear();
    CHECK(bench.write_register(12, 0x33) == Approx(318e-6).epsilon(0.05));
    REQUIRE(bench.board.potentiometer.size() == 1);
    CHECK(bench.board.potentiometer[0].second == 0x33);

    // Send 0xA5C3 from all emitters: the board is deaf for 33133 cycles.
    bench.board.port_b.clear();
    CHECK(bench.write_register(14, 0xC3) == Approx(280e-6 + 33'133 / kFcy).epsilon(0.02));
    bench.run_to(seconds(bench.bus) + 10e-3);
    std::vector<std::pair<Time, bool>> edges;
    for (const auto& [time, levels] : bench.board.port_b) {
        const bool on = (levels & kEmitters) == kEmitters;
        CHECK((on || (levels & kEmitters) == 0));
        CHECK((levels & 0x0004) == 0x0004);  // chip select stays
        if (edges.empty() || edges.back().second != on) edges.emplace_back(time, on);
    }
    std::string chips;
    const double chip_cycles = 4021.5;
    while (!edges.empty() && !edges.front().second)
        edges.erase(edges.begin());
    REQUIRE(edges.size() > 10);
    for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
        const double length = seconds(edges[i + 1].first - edges[i].first) * kFcy / chip_cycles;
        chips.append(static_cast<std::size_t>(std::lround(length)), edges[i].second ? '1' : '0');
    }
    // The frame ends with the carrier off, which makes no edge.
    CHECK(chips + "0" == "1111111010010101011010100110010110011010010101" + std::string("0"));
    CHECK(seconds(edges[1].first - edges[0].first) * kFcy == Approx(28'150).epsilon(0.001));
}

TEST_CASE("how time is cut and whether waiting is skipped changes nothing on the range-and-bearing board") {
    const auto file = image_file("randb.hex");
    if (!file) return;
    std::vector<std::pair<Time, std::uint16_t>> reference;
    std::uint64_t instructions = 0;
    for (const int variant : {0, 1, 2}) {
        Bench bench(*file);
        bench.chip.set_skipping(variant != 1);
        if (variant == 2)
            for (double time = 0; time < 0.08; time += 33e-6)
                bench.run_to(time);
        bench.run_to(0.08);
        if (variant == 0) {
            reference = bench.board.port_b;
            instructions = bench.chip.report().instructions;
            continue;
        }
        CHECK(bench.board.port_b == reference);
        CHECK(bench.chip.report().instructions == instructions);
    }
}
