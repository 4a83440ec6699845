// puckloop step --mcu atmega1284p: what an answer contains, and what the parser makes of bad lines.

#include "base/random.h"
#include "emu/avr/core/step_vector.h"

#include <catch2/catch.hpp>

#include <string>

using namespace puckloop::avr;

namespace {

std::string registers(const std::string& first = "00") {
    std::string text = "r=" + first;
    for (int i = 1; i < 32; ++i)
        text += ",00";
    return text;
}

std::string answer(const std::string& line) {
    return StepMachine(atmega1284p()).answer(line);
}

void says(const std::string& line, const std::string& what) {
    INFO(line);
    CHECK_THAT(answer(line), Catch::Contains(what));
}

}  // namespace

TEST_CASE("an AVR answer names the whole state") {
    CHECK(answer("7 " + registers("7f") + " sr=80 sp=40ff pc=000100 op=9403") ==  // inc r0
          "7 ok " + registers("80") + " sr=8c sp=40ff rz=00 pc=000102 m= cyc=1");
}

TEST_CASE("memory, program memory and two-word instructions") {
    const std::string state = "1 " + registers("5a") + " pc=000000 sp=0150";
    says(state + " op=9200,0200", "m=0200:5a cyc=2");                             // sts 0x0200, r0
    says(state + " op=9100,0200 m=0200:33", "sp=0150 rz=00 pc=000004 m= cyc=2");  // lds r16, 0x0200
    says(state + " op=940e,0080", "sp=014e rz=00 pc=000100 m=0150:02 cyc=4");     // call 0x100
    says(state + " op=95d8 rz=1 p=10000:4321", "ok r=21,");                       // elpm
    says(state + " op=9af0 m=003e:01", "pc=000002 m= cyc=2");                     // sbi GPIOR0, 0
    says(state + " op=9af1 m=003e:01", "pc=000002 m=003e:03 cyc=2");              // sbi GPIOR0, 1
    says(state + " op=fe00,940e,0080", "cyc=1");                                  // sbrs r0, 0
    says(state + " op=fc00,940e,0080", "pc=000006 m= cyc=3");                     // sbrc r0, 0
    says(state + " op=e00f,950a,f7f1 run=3", "pc=000006 m= cyc=45");              // a loop of 15
}

TEST_CASE("what a vector cannot contain is refused") {
    const std::string state = "1 " + registers() + " pc=0";
    says("1", "1 error no state");
    says("1 pc=0 op=0", "error r is missing");
    says("1 " + registers() + " op=0", "error pc is missing");
    says(state, "error op is missing");
    says(state + " op=zz", "error op: 'zz' is not a hex number");
    says(state + " op=0 op=0", "error op given twice");
    says(state + " op=0 zz=1", "error unknown key 'zz'");
    says(state + " op=0 sr=100", "error sr: 100 is more than ff");
    says(state + " op=0 m=5000:00", "error m: no RAM at 5000");
    says(state + " op=0 p=20000:0000", "error p: no program memory at 020000");
    says("1 r=1,2 pc=0 op=0", "error r: 2 values, expected 32");
    says("1 " + registers() + " pc=1 op=0", "error pc: odd address 1");
    says(state + " op=9519", "unsupported 9519 is no instruction of this part");
    says(state + " op=b406", "unsupported reads TCNT0");  // in r0, TCNT0
    says(state + " op=9100,5000", "unsupported read of data address 0x5000, past the RAM");
    says(state + " op=cfff run=1", "pc=000000");
    says(state + " op=cfff,0 run=2", "unsupported PC does not leave the 2 words");
}

TEST_CASE("no line upsets the machine") {
    puckloop::RandomStream random(7, "avr step lines");
    StepMachine machine(atmega1284p());
    const std::string letters = "0123456789abcdef=,: rspcmopnz";
    for (int i = 0; i < 20000; ++i) {
        std::string line = "9 " + registers() + " pc=0 ";
        for (std::uint64_t n = random.below(30); n > 0; --n)
            line += letters[random.below(letters.size())];
        const std::string text = machine.answer(line);
        const bool known =
            text.starts_with("9 ok ") || text.starts_with("9 error ") || text.starts_with("9 unsupported ");
        REQUIRE(known);
    }
}
