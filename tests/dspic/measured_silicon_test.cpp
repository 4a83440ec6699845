// What timing diagrams and errata of the dsPICs give as absolute values, each by a small program of ours. The
// data, with sources, are in measured_silicon.csv; docs/measured_silicon.md has the table.

#include "base/text/csv.h"
#include "tests/dspic/chip30_bench.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <map>
#include <set>
#include <string>

using namespace puckloop;
using namespace puckloop::dspic;
using namespace puckloop::dspic::test;

namespace {

/// To the end of the program, which begins when the power-up timer is over, and well after it.
void finish(Bench30& bench) {
    constexpr Cycle kLong = 100'000;
    bench.go(bench.run_to("done") + kLong);
}

/// Counts read in three cycles, from the one in which the counter is at its period on.
std::string timer_at_period() {
    // One instruction per cycle; the sixteen counts read follow one another.
    std::string source =
        ".org 0x200\nmain: mov #0x4800, w0\nmov w0, PR2\nmov #0x47FA, w0\nmov w0, TMR2\nmov #0x8000, w0\n"
        "mov w0, T2CON\n";
    for (int i = 1; i <= 12; ++i)
        source += fmt::format("mov TMR2, w{}\n", i);
    for (int i = 1; i <= 12; ++i)
        source += fmt::format("mov w{}, 0x{:x}\n", i, 0x900 + 2 * i);
    Bench30 bench(source + "done: bra done\n");
    finish(bench);
    for (int i = 1; i <= 10; ++i)
        if (bench.word(0x900 + 2 * i) == 0x4800)
            return fmt::format("{:x} {:x} {:x}", bench.word(0x900 + 2 * i), bench.word(0x902 + 2 * i),
                               bench.word(0x904 + 2 * i));
    return "never";
}

std::string timer_period_zero() {
    Bench30 bench(".org 0x200\nmain: clr PR2\nclr TMR2\nmov #0x8000, w0\nmov w0, T2CON\ndone: bra done\n");
    finish(bench);
    return fmt::format("{}", bench.reg("IFS0") >> 6 & 1);
}

/// For each place of the prescaler at the write: cycles until the count is another one.
std::string write_clears_prescaler() {
    std::set<int> cycles;
    for (int before = 0; before < 8; ++before) {
        std::string source =
            ".org 0x200\nmain: setm PR2\nclr TMR2\nmov #0x8010, w0\nmov #100, w1\nmov w0, T2CON\n";
        for (int i = 0; i < before; ++i)
            source += "nop\n";
        source += "mov w1, TMR2\n";
        for (int i = 2; i <= 12; ++i)
            source += fmt::format("mov TMR2, w{}\n", i);
        for (int i = 2; i <= 12; ++i)
            source += fmt::format("mov w{}, 0x{:x}\n", i, 0x900 + 2 * i);
        Bench30 bench(source + "done: bra done\n");
        finish(bench);
        int same = 0;
        while (same < 11 && bench.word(0x904 + 2 * same) == 100)
            ++same;
        cycles.insert(same);
    }
    return cycles.size() == 1 ? fmt::format("{}", *cycles.begin()) : "differs";
}

Bench30 sender(const std::string& more) {
    return Bench30(".org 0x200\nmain: mov #25, w0\nmov w0, U1BRG\nmov #0x8000, w0\nmov w0, U1MODE\n" + more +
                   "done: bra done\n");
}

std::string uart_bit() {
    Bench30 bench = sender("bset U1STA, #10\nmov #0x55, w0\nmov w0, U1TXREG\n");
    finish(bench);
    REQUIRE(bench.pins.frames.size() == 1);
    const double cycle = 1e12 / bench.chip.clock().hertz();
    return fmt::format("{}", std::lround(static_cast<double>(bench.pins.frames[0].bit_period) / cycle));
}

std::string uart_early_byte() {
    Bench30 bench = sender("mov #0x55, w0\nmov w0, U1TXREG\nnop\nnop\nbset U1STA, #10\n");
    finish(bench);
    return fmt::format("{}", bench.pins.frames.size());
}

std::string uart_first_enabled() {
    Bench30 bench = sender("");
    finish(bench);
    return fmt::format("{}", bench.reg("IFS0") >> 10 & 1);
}

/// OC1 on Timer2 at 1:1; the cycle in which Timer2 is 0 first is that of the label "on".
struct Comparing : Bench30 {
    Cycle on = 0;

    Comparing(int mode, int r, int rs, int period)
        : Bench30(fmt::format(
              ".org 0x200\nmain: setm ADPCFG\nmov #{}, w0\nmov w0, PR2\nmov #{}, w0\nmov w0, OC1R\n"
              "mov #{}, w0\nmov w0, OC1RS\nmov #{}, w0\nmov w0, OC1CON\nmov #0x8000, w0\n"
              "mov w0, T2CON\non: nop\ndone: bra done\n",
              period, r, rs, mode)) {
        on = run_to("on");
    }
    const std::vector<Pins30::Edge>& pin() const { return edges(PortLetter::D, 0); }
};
constexpr int kGoHigh = 1, kPwm = 6;

std::string compare_pin() {
    constexpr int kMatch = 300;
    Comparing bench(kGoHigh, kMatch, 0, 1000);
    bench.go(bench.on + 500);
    REQUIRE(bench.pin().size() == 1);
    return fmt::format("{}", bench.pin()[0].at - (bench.on + kMatch));
}

std::string compare_flag() {
    constexpr int kMatch = 300;
    Comparing bench(kGoHigh, kMatch, 0, 1000);
    Cycle cycle = bench.on;
    for (; cycle < bench.on + 500; ++cycle) {
        bench.go(cycle + 1);
        if (bench.reg("IFS0") >> 2 & 1) break;
    }
    REQUIRE(bench.pin().size() == 1);
    return fmt::format("{}", cycle - bench.pin()[0].at);
}

std::string pwm_period() {
    Comparing bench(kPwm, 50, 50, 191);
    bench.go(bench.on + 10 * 200);
    std::vector<Cycle> rises;
    for (const auto& edge : bench.pin())
        if (edge.level) rises.push_back(edge.at);
    REQUIRE(rises.size() > 4);
    return fmt::format("{}", rises[4] - rises[3]);
}

std::string pwm_exceptions() {
    std::string counts;
    for (const int duty : {0, 192}) {
        Comparing bench(kPwm, duty, duty, 191);
        bench.go(bench.on + 10 * 192);
        const bool ends_as_meant = (bench.pins.levels_now[3] & 1) == (duty > 0 ? 1 : 0);
        counts +=
            fmt::format("{}{}", counts.empty() ? "" : " ", ends_as_meant ? int(bench.pin().size()) : -1);
    }
    return counts;
}

/// IC1 takes Timer2 at every rising edge.
Bench30 capturing() {
    return Bench30(
        ".org 0x200\nmain: setm PR2\nmov #0x0083, w0\nmov w0, IC1CON\nmov #0x8000, w0\nmov w0, T2CON\n"
        "on: nop\ndone: bra done\n");
}

std::string capture_latency() {
    Bench30 bench = capturing();
    const Cycle on = bench.run_to("on");
    const Cycle edge = on + 1000;
    bench.pulse(PortLetter::D, 8, edge, 20);
    bench.go(edge + 30);
    const int late = bench.reg("IC1BUF") - static_cast<int>(edge - on);
    return late == 1 || late == 2 ? "1 or 2" : fmt::format("{}", late);
}

std::string capture_overflow() {
    Bench30 bench(
        ".org 0x200\nmain: setm PR2\nmov #0x0083, w0\nmov w0, IC1CON\nmov #0x8000, w0\nmov w0, T2CON\n"
        "on: btss PORTF, #0\nbra on\nmov IC1CON, w1\nmov IC1BUF, w5\nmov IC1BUF, w5\nmov IC1BUF, w5\n"
        "mov IC1CON, w2\nmov IC1BUF, w5\nmov IC1CON, w3\nmov w1, 0x900\nmov w2, 0x902\nmov w3, 0x904\n"
        "done: bra done\n");
    const Cycle on = bench.run_to("on");
    for (Cycle i = 1; i <= 5; ++i)
        bench.pulse(PortLetter::D, 8, on + 100 * i, 20);
    bench.set(PortLetter::F, 0, true, on + 600);
    bench.run_to("done");
    const auto overflow = [&](int place) { return bench.word(place) >> 4 & 1; };
    return fmt::format("{} {} {}", overflow(0x900), overflow(0x902), overflow(0x904));
}

std::string spi_word() {
    Bench30 bench(".org 0x200\nmain: mov #0x0020, w0\nmov w0, SPI1CON\nbset SPI1STAT, #15\nmov #0xa5, w0\n"
                  "mov w0, SPI1BUF\nbegun: nop\ndone: bra done\n");
    const Cycle begun = bench.run_to("begun");
    bench.go(begun + 10'000);
    REQUIRE(bench.pins.words.size() == 1);
    return fmt::format("{}", bench.pins.words[0].at - begun);
}

const std::map<std::string, std::function<std::string()>>& programs() {
    static const std::map<std::string, std::function<std::string()>> all{
        {"timer-at-period", timer_at_period},
        {"timer-period-zero", timer_period_zero},
        {"timer-write-clears-prescaler", write_clears_prescaler},
        {"uart-bit-26", uart_bit},
        {"uart-early-byte", uart_early_byte},
        {"uart-first-enabled", uart_first_enabled},
        {"oc-pin-after-match", compare_pin},
        {"oc-flag-after-pin", compare_flag},
        {"oc-pwm-period", pwm_period},
        {"oc-pwm-exceptions", pwm_exceptions},
        {"ic-latency", capture_latency},
        {"ic-overflow", capture_overflow},
        {"spi-word", spi_word},
    };
    return all;
}

}  // namespace

TEST_CASE("each published value of the dsPICs is what our part shows") {
    std::ifstream in(DSPIC_MEASURED);
    REQUIRE(in);
    std::string line;
    std::getline(in, line);  // names of the columns
    std::set<std::string> seen;
    while (std::getline(in, line)) {
        const auto cells = csv_cells(line, ',');
        REQUIRE(cells.size() == 5);
        const std::string id(cells[0]);
        INFO(id << ": " << cells[3] << " (" << cells[2] << ", " << cells[4] << ")");
        REQUIRE(programs().contains(id));
        seen.insert(id);
        CHECK(programs().at(id)() == std::string(cells[1]));
    }
    CHECK(seen.size() == programs().size());
}
