// Tuning the 33FJ's RC oscillator. Sources: DS70286, oscillator chapter (fact sheet semantics.md section
// 17); steps of OSCTUN: expected values of errata DS80280G (PIC24H, the same oscillator), item 42.

#include "tests/dspic/chip33_bench.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::dspic;
using namespace puckloop::dspic::test;

namespace {

constexpr double kFrc = 7.37e6;

}  // namespace

TEST_CASE("OSCTUN moves the RC oscillator by 0.375 % a step, also through divider and PLL", "[clock]") {
    // FOSCSEL: FRC, FRC with PLL (x50/2/4 by reset values), FRC by 16, FRC by FRCDIV (1 by reset)
    const std::map<std::uint32_t, double> sources{
        {0xFFF8, 1}, {0xFFF9, 50.0 / 2 / 4}, {0xFFFE, 1.0 / 16}, {0xFFFF, 1}};
    for (const auto& [foscsel, factor] : sources)
        for (const int tun : {0, 1, 10, 31, -1, -20, -32}) {
            CAPTURE(foscsel, tun);
            Bench33 bench(R"(
        .org 0x200
main:   mov #)" + std::to_string(tun & 0x3F) +
                              R"(, w0
        mov w0, OSCTUN
end:    bra end
)",
                          {{0xF80006, foscsel}});
            bench.run_to_label("end");
            CHECK(bench.chip.clock().hertz() ==
                  Approx(kFrc * factor / 2 * (1 + 0.00375 * tun)).epsilon(1e-12));
            bench.chip.mclr();
            bench.chip.run_until(bench.chip.now() + 1);
            CHECK(bench.chip.clock().hertz() == Approx(kFrc * factor / 2).epsilon(1e-12));
        }
}

TEST_CASE("OSCTUN does not move the crystal's clock", "[clock]") {
    Bench33 bench(R"(
        .org 0x200
main:   mov #31, w0
        mov w0, OSCTUN
end:    bra end
)",
                  {{0xF80006, 0xFFFA}});
    bench.run_to_label("end");
    CHECK(bench.chip.clock().hertz() == 2e6);
}
