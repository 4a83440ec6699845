// What timing diagrams and errata of the dsPICs give as absolute values, each by a small program of ours. The
// data, with sources, are in measured_silicon.csv; docs/measured_silicon.md has the table.

#include "base/csv.h"
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

const std::map<std::string, std::function<std::string()>>& programs() {
    static const std::map<std::string, std::function<std::string()>> all{
        {"timer-at-period", timer_at_period},
        {"timer-period-zero", timer_period_zero},
        {"timer-write-clears-prescaler", write_clears_prescaler},
        {"uart-bit-26", uart_bit},
        {"uart-early-byte", uart_early_byte},
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
