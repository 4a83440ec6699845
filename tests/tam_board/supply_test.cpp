// The booth's supply: battery, converter, and the chip's brown-out detector behind them.

#include "base/states/archive.h"
#include "tests/tam_board/rig.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::tam;
using test::Rig;

namespace {

constexpr cosim::Time kMs = cosim::kMillisecond;

/// MCUSR's flags as LEDs are not at hand: 0x0100 has them, 0x0101 counts the starts.
const std::string kStarts = R"(
        in   r16, MCUSR
        sts  0x100, r16
        lds  r17, 0x101
        inc  r17
        sts  0x101, r17
        clr  r16
        out  MCUSR, r16
loop:   rjmp loop
)";

struct Supply : Rig {
    Supply() { board.load(test::assembled(kStarts)); }
    void pass(cosim::Time time) { board.run_until(board.now() + time); }
    int starts() const { return board.chip().peek_data(0x101); }
    int flags() const { return board.chip().peek_data(0x100); }
};

}  // namespace

TEST_CASE("the booth's supply is 3.3 V down to 1.8 V of battery, or what a load leaves of it", "[supply]") {
    Supply s;
    CHECK(s.board.supply() == 3.3);
    s.board.set_signal(kBattery, 2.0);
    CHECK(s.board.supply() == 3.3);
    s.board.set_signal(kVdd, 2.9);
    CHECK(s.board.supply() == 2.9);
    s.board.set_sag(0.3);
    CHECK(s.board.supply() == 0.0);
}

TEST_CASE("a load that pulls VCC down is a brown-out, and the program starts by its fuses", "[supply]") {
    Supply s;
    s.pass(kMs);
    CHECK(s.starts() == 1);
    CHECK(s.flags() == 1);  // PORF
    s.board.set_signal(kVdd, 2.68);
    s.pass(100 * kMs);
    CHECK(s.starts() == 1);  // VBOT- is 2.675 V
    s.board.set_signal(kVdd, 2.6);
    s.pass(20 * kMs);
    s.board.set_signal(kVdd, 3.3);
    s.pass(65 * kMs);
    CHECK(s.starts() == 1);
    s.pass(3 * kMs);  // 65 ms and 16384 clocks of the resonator
    CHECK(s.starts() == 2);
    CHECK(s.flags() == 4);  // BORF
    CHECK(s.of(kPower).empty());
    CHECK(s.board.powered());
}

TEST_CASE("a battery that the converter cannot use any more takes the whole booth with it", "[supply]") {
    for (const bool saved : {false, true}) {
        Supply s, other;
        Supply* one = &s;
        s.pass(kMs);
        s.board.set_battery(1.7);
        s.pass(5 * kMs);
        REQUIRE(s.of(kPower).size() == 1);
        CHECK(s.of(kPower)[0].value == 0.0);
        if (saved) {
            std::vector<std::uint8_t> bytes;
            StateWriter writer(bytes);
            writer.part("board", s.board);
            StateReader reader(bytes);
            reader.part("board", other.board);
            one = &other;
        }
        one->board.set_battery(std::nullopt);
        one->pass(65 * kMs);
        CHECK(one->starts() == 1);
        one->pass(3 * kMs);
        CHECK(one->starts() == 2);
        CHECK(one->flags() == 1);  // PORF
        CHECK(one->board.signal(kPower) == 1.0);
    }
}
