// The two-wire unit as a slave that its program takes away from a master in the middle of a byte, and what
// TWDR holds when both have sent.

#include "tests/avr/rig.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::avr;
using cosim::I2cPhase;
using cosim::I2cPhaseKind;
using cosim::Time;
using test::Rig;

namespace {

constexpr Time kSclPeriod = 10 * cosim::kMicrosecond;

/// Addressed by 0x2A; loads 0x5A at SLA+R, then does `next` where the master's next byte waits for it.
std::string unit_program(const std::string& next) {
    return R"(
        ldi r16, 0x2A
        sts TWAR, r16
        ldi r16, 0x44
        sts TWCR, r16
addr:   lds r17, TWCR
        sbrs r17, 7
        rjmp addr
        ldi r16, 0x5A
        sts TWDR, r16
        ldi r24, 0          ; 256 us, a byte and a half
        ldi r25, 4
hold:   sbiw r24, 1
        brne hold
)" + next;
}

struct UnitsMaster {
    Rig rig;

    explicit UnitsMaster(const std::string& next) : rig(unit_program(next)) {
        rig.chip.run_until(kSclPeriod);
    }
    /// Begins a phase; its answer comes later, if at all.
    void begin(I2cPhaseKind kind, std::uint8_t byte = 0, bool ack = false) {
        I2cPhase phase;
        phase.kind = kind;
        phase.byte = byte;
        phase.ack = ack ? 1 : 0;
        phase.start = rig.chip.now();
        phase.clock_period = kSclPeriod;
        rig.answers.clear();
        rig.chip.twi_slave_phase(phase);
    }
    I2cPhase answer() {
        for (int i = 0; i < 200 && rig.answers.empty(); ++i)
            rig.chip.run_until(rig.chip.now() + kSclPeriod);
        REQUIRE(rig.answers.size() == 1);
        const I2cPhase answer = rig.answers[0];
        rig.chip.run_until(rig.chip.now() + kSclPeriod);
        return answer;
    }
    I2cPhase act(I2cPhaseKind kind, std::uint8_t byte = 0, bool ack = false) {
        begin(kind, byte, ack);
        return answer();
    }
};

const std::string kAddressedAgain = "ldi r16, 0xC4\nsts TWCR, r16\nend: rjmp end\n";

}  // namespace

TEST_CASE("a two-wire unit that is switched off while it holds SCL lets the master go on, alone") {
    const std::string how = GENERATE(values<std::string>({
        "eor r16, r16\nsts TWCR, r16\n" + kAddressedAgain,                              // TWEN
        "ldi r16, 0x18\nsts WDTCSR, r16\nldi r16, 0x08\nsts WDTCSR, r16\nr: rjmp r\n",  // a reset
    }));
    UnitsMaster master(how);
    CHECK(master.act(I2cPhaseKind::Start, 0x2B).ack == 1);
    master.begin(I2cPhaseKind::Read, 0, true);
    CHECK(master.rig.chip.earliest_twi_slave_answer() != cosim::kNever);
    I2cPhase read;
    for (int i = 0; i < 4000 && master.rig.answers.empty(); ++i)
        master.rig.chip.run_until(master.rig.chip.now() + kSclPeriod);
    REQUIRE(master.rig.answers.size() == 1);
    read = master.rig.answers[0];
    CHECK(read.kind == I2cPhaseKind::Data);
    CHECK(read.byte == 0xFF);
    CHECK(read.stretch > 200 * cosim::kMicrosecond);
    master.begin(I2cPhaseKind::Stop);
    master.rig.chip.run_until(master.rig.chip.now() + 30 * cosim::kMillisecond);
    if (how.find("WDTCSR") == std::string::npos) CHECK(master.act(I2cPhaseKind::Start, 0x2A).ack == 1);
}

TEST_CASE("a start that is asked for while a master's byte still runs comes after that one's STOP") {
    UnitsMaster master("eor r16, r16\nsts TWCR, r16\nldi r16, 0xA4\nsts TWCR, r16\nstarted: lds r17, TWCR\n"
                       "sbrs r17, 7\nrjmp started\nlds r17, TWSR\nsts 0x100, r17\nend: rjmp end\n");
    CHECK(master.act(I2cPhaseKind::Start, 0x2B).ack == 1);
    CHECK(master.act(I2cPhaseKind::Read, 0, true).byte == 0xFF);
    CHECK(master.rig.ram(0x100) == 0);
    master.begin(I2cPhaseKind::Stop);
    master.rig.chip.run_until(master.rig.chip.now() + 4 * kSclPeriod);
    CHECK(master.rig.ram(0x100) == 0x08);
}

TEST_CASE("TWDR holds what was on the line when a master wrote to a unit that sent") {
    UnitsMaster master("ldi r16, 0xC4\nsts TWCR, r16\nsent: lds r17, TWCR\nsbrs r17, 7\nrjmp sent\n"
                       "lds r17, TWDR\nsts 0x100, r17\nlds r17, TWSR\nsts 0x101, r17\nend: rjmp end\n");
    CHECK(master.act(I2cPhaseKind::Start, 0x2B).ack == 1);
    const I2cPhase both = master.act(I2cPhaseKind::Write, 0x93);
    CHECK(both.byte == (0x5A & 0x93));
    master.rig.chip.run_until(master.rig.chip.now() + 4 * kSclPeriod);
    CHECK(master.rig.ram(0x100) == (0x5A & 0x93));
    CHECK(master.rig.ram(0x101) == 0xC0);
}
