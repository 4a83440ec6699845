// What a program waits for, and whether it hangs: each kind of wait as a small program.

#include "emu/dspic/assembler/assembler.h"
#include "emu/dspic/chip/chip.h"
#include "emu/dspic/waits/status_bits.h"

#include <catch2/catch.hpp>

#include <string>

using namespace puckloop;
using namespace puckloop::dspic;

namespace {

struct OutsideWorld : Pins {
    std::uint16_t fixed = 0;  ///< pins of port C on which nothing changes

    void driven(PortLetter, std::uint16_t, std::uint16_t, Cycle) override {}
    std::uint16_t levels(PortLetter, Cycle) override { return 0; }
    double analog(int, Cycle) override { return 0.5; }
    void uart_sent(int, const cosim::UartFrame&) override {}
    void i2c_phase(int, const cosim::I2cPhase&) override {}
    OutsidePin outside(PortLetter port, int bit) const override {
        return {port != PortLetter::C || (fixed >> bit & 1) == 0, bit == 4 ? "camera_vsync" : ""};
    }
};

struct Bench {
    OutsideWorld pins;
    Chip chip;

    explicit Bench(const std::string& body, std::uint16_t fixed = 0)
        : chip(dspic30f6014a(), pins, {.fosc = 0xFFE6}) {
        pins.fixed = fixed;
        AssembleOptions options;
        for (const RegisterInfo& info : dspic30f6014a().registers)
            options.predefined[std::string(info.name)] = info.address;
        const Program program = assemble("        goto main\n" + body, options);
        for (const auto& [address, word] : program.words)
            chip.load_word(address, word);
        chip.power_on();
    }
    /// What is said after `seconds`, and whether it is a hang.
    WaitReport after(double seconds) {
        chip.run_until(cosim::from_seconds(seconds));
        return chip.waiting().value_or(WaitReport{.text = "nothing"});
    }
};

const std::string kMain = R"(
        .org 0x100
main:   mov #0x0900, w15
        mov #0x27f0, w0
        mov w0, SPLIM
)";
/// T1 every millisecond; its routine does `work`.
std::string with_timer(const std::string& work, const std::string& loop) {
    return "        .org 0x001A\n        .pword isr\n" + kMain + R"(
        mov #14745, w0
        mov w0, PR1
        bset IEC0, #3
        mov #0x8000, w0
        mov w0, T1CON
)" + loop + "\nisr:    push w0\n" +
           work + "\n        bclr IFS0, #3\n        pop w0\n        retfie\n";
}

}  // namespace

TEST_CASE("a bit that no model drives is named, with the loop and how long it has run") {
    Bench bench(kMain + R"(
        bset RCON, #12
wait:   btss INTCON1, #1
        bra wait
)");
    const WaitReport wait = bench.after(2.0);
    CHECK(wait.hung);
    CHECK(wait.first == 0x108);
    CHECK(wait.last == 0x10A);
    CHECK(wait.text == "reading INTCON1, bit OSCFAIL, which no model drives");
    CHECK(bench.chip.clock().time_of(wait.since) < cosim::kMillisecond);
}

TEST_CASE("it is named where the loop reads the register into W and masks it, through a call") {
    Bench bench(kMain + R"(
wait:   rcall look
        cp0 w0
        bra z, wait
        bra main
look:   mov INTCON1, w0
        mov #2, w1
        and w0, w1, w0
        return
)");
    const WaitReport wait = bench.after(1.0);
    CHECK(wait.hung);
    CHECK(wait.text == "reading INTCON1, bit OSCFAIL, which no model drives");
}

TEST_CASE("a register without a model hangs its reader, interrupts or not") {
    Bench bench(with_timer("", R"(
wait:   btss BSRAM, #0
        bra wait
)"));
    const WaitReport wait = bench.after(1.0);
    CHECK(wait.hung);
    CHECK(wait.text == "reading BSRAM, bit RL_BSR, which no model drives");
}

TEST_CASE("a wait with a time-out is no hang, and the missing bit is reported all the same") {
    Bench bench(kMain + R"(
        mov #20000, w2
wait:   btsc INTCON1, #1
        bra done
        dec w2, w2
        bra nz, wait
done:   btss U2STA, #0
        bra done
)");
    const WaitReport wait = bench.after(1.0);
    CHECK_FALSE(wait.hung);
    CHECK(wait.text == "reading U2STA, bit URXDA");
    const ChipReport report = bench.chip.report();
    REQUIRE(report.missing_bits.size() == 1);
    CHECK(report.missing_bits[0].bits == "INTCON1, bit OSCFAIL");
}

TEST_CASE("waiting for a character is no hang, however long") {
    Bench bench(kMain + R"(
        mov #0x8000, w0
        mov w0, U2MODE
wait:   btss U2STA, #0
        bra wait
)");
    const WaitReport wait = bench.after(12.0);
    CHECK_FALSE(wait.hung);
    CHECK(wait.text == "reading U2STA, bit URXDA");
    CHECK(bench.chip.report().missing_bits.empty());
}

TEST_CASE("an endless loop is a hang only if no interrupt can come") {
    CHECK(Bench(kMain + "stop:   bra stop\n").after(1.0).hung);
    CHECK_FALSE(Bench(with_timer("        btg LATD, #0", "stop:   bra stop")).after(1.0).hung);
    // The source is enabled, but off.
    CHECK(Bench(kMain + "        bset IEC0, #3\nstop:   bra stop\n").after(1.0).hung);
}

TEST_CASE("a trap handler that never returns is a hang, whatever is enabled") {
    Bench bench(
        "        .org 0x0008\n        .pword trap\n" +
        with_timer("", "        mov #0x0901, w1\n        mov [w1], w0\nend: bra end\ntrap:   bra trap"));
    const WaitReport wait = bench.after(1.0);
    CHECK(wait.hung);
    CHECK(wait.text == "which has no end, and no interrupt can come");
}

TEST_CASE("a flag in RAM: whose routine sets it decides") {
    const std::string wait_loop = R"(
wait:   mov 0x0850, w0
        cp0 w0
        bra z, wait
stop:   bra stop
)";
    const std::string set = "        mov w15, 0x0850";
    SECTION("a routine that comes names it: a wait") {
        // Set after a count that is not reached in the time of the test.
        Bench bench(with_timer("        btsc TMR1, #15\n" + set, wait_loop));
        const WaitReport wait = bench.after(1.0);
        CHECK_FALSE(wait.hung);
        CHECK(wait.text == "reading RAM 0x0850");
    }
    SECTION("nobody names it, interrupts come: a wait, for pointers are not followed") {
        CHECK_FALSE(Bench(with_timer("", wait_loop)).after(1.0).hung);
    }
    SECTION("nobody names it and nothing is enabled") {
        const WaitReport wait = Bench(kMain + wait_loop).after(1.0);
        CHECK(wait.hung);
        CHECK(wait.text == "reading RAM 0x0850, which no interrupt can change");
    }
    SECTION("the only routine that names it cannot come, others do") {
        // T4 counts RC3, and on this board nothing changes there. Vector of T4: IRQ 21.
        const std::string more = "        .org 0x003E\n        .pword isr4\n";
        const std::string isr4 = "isr4:   mov w15, 0x0850\n        bclr IFS1, #5\n        retfie\n";
        const std::string start4 = "        bset IEC1, #5\n        mov #0x8002, w0\n        mov w0, T4CON\n";
        const std::string source = more + with_timer("", start4 + wait_loop) + isr4;
        const WaitReport hung = Bench(source, 1u << 3).after(1.0);
        CHECK(hung.hung);
        CHECK(hung.text == "reading RAM 0x0850, which only the routine of T4 writes, and T4 counts pin RC3, "
                           "on which nothing changes");
        CHECK_FALSE(Bench(source, 0).after(1.0).hung);
    }
}

TEST_CASE("a pin on which nothing changes") {
    const std::string source = kMain + R"(
wait:   btss PORTC, #4
        bra wait
)";
    const WaitReport wait = Bench(source, 1u << 4).after(1.0);
    CHECK(wait.hung);
    CHECK(wait.text == "reading PORTC, bit RC4, a pin on which nothing changes (camera_vsync)");
    CHECK_FALSE(Bench(source, 0).after(1.0).hung);
}

TEST_CASE("the flag of a timer that is off stays clear") {
    const WaitReport wait = Bench(kMain + "wait: btss IFS0, #7\n bra wait\n").after(1.0);
    CHECK(wait.hung);
    CHECK(wait.text == "reading IFS0, bit T3IF, which stays as it is: T3 is off");
}

TEST_CASE("a compared word counts as read, though no single bit of it decides") {
    Bench bench(with_timer("        inc 0x0850", R"(
wait:   mov 0x0850, w0
        mov #0x0007, w1
        and w0, w1, w0
        cp w0, #9
        bra nz, wait
)"));
    // 9 is never reached under the mask: no value tried ends the loop, and interrupts come: no hang.
    CHECK_FALSE(bench.after(1.0).hung);
}

TEST_CASE("a program that works is in no loop for long") {
    // Waits a millisecond for T1, works, and waits again.
    Bench bench(with_timer("        setm 0x0850", R"(
again:  mov 0x0850, w0
        cp0 w0
        bra z, again
        clr 0x0850
        btg LATD, #1
        mov #500, w1
work:   dec w1, w1
        bra nz, work
        bra again
)"));
    CHECK_FALSE(bench.after(3.0).hung);
}

TEST_CASE("sleep without anything enabled is for ever") {
    const WaitReport wait = Bench(kMain + "        pwrsav #0\nstop: bra stop\n").after(1.0);
    CHECK(wait.hung);
    CHECK(wait.asleep);
}

TEST_CASE("what a program waits for is the same with every turn of its loop executed") {
    const std::string source = kMain + "        bset RCON, #12\nwait:   btss INTCON1, #1\n        bra wait\n";
    Bench skipping(source), executing(source);
    executing.chip.set_skipping(false);
    const WaitReport a = skipping.after(0.3), b = executing.after(0.3);
    CHECK(a.text == b.text);
    CHECK(a.since == b.since);
    CHECK(b.hung);
}

TEST_CASE("an address that nobody acknowledges is counted") {
    Bench bench(kMain + R"(
        mov #0x8000, w0
        mov w0, I2CCON
        bset I2CCON, #0
s:      btsc I2CCON, #0
        bra s
        mov #0xC0, w0
        mov w0, I2CTRN
t:      btsc I2CSTAT, #14
        bra t
stop:   bra stop
)");
    bench.chip.run_until(cosim::kMillisecond);
    cosim::I2cPhase answer;
    answer.kind = cosim::I2cPhaseKind::Acknowledge;
    answer.ack = 0;
    bench.chip.i2c_answer(1, answer);
    const ChipReport report = bench.chip.report();
    REQUIRE(report.refused_addresses.size() == 1);
    CHECK(report.refused_addresses[0].address == 0x60);
    CHECK(report.refused_addresses[0].times == 1);
}

TEST_CASE("every line of the status bits names registers and fields that exist") {
    for (const DeviceInfo* device : devices())
        for (const StatusBits& line : device->status_bits) {
            INFO(device->name << " " << line.registers << " " << line.bits);
            bool any = false;
            for (const RegisterInfo& info : device->registers) {
                if (info.name.size() != line.registers.size()) continue;
                bool fits = true;
                for (std::size_t i = 0; i < info.name.size(); ++i)
                    fits &= line.registers[i] == '?' || line.registers[i] == info.name[i];
                if (!fits) continue;
                any = true;
                std::string_view bits = line.bits;
                while (bits != "*" && !bits.empty()) {
                    const std::string_view field = bits.substr(0, bits.find(' '));
                    INFO(info.name << " " << field);
                    CHECK(field_mask(info, field) != 0);
                    bits.remove_prefix(std::min(bits.size(), field.size() + 1));
                }
            }
            CHECK(any);
        }
}

TEST_CASE("a register's bits by name") {
    const RegisterInfo info{"T1CON", 0x104, 0, 0xA076, "TON:15 TSIDL:13 TGATE:6 TCKPS:5:4 TSYNC:2 TCS:1"};
    CHECK(field_mask(info, "TON") == 0x8000);
    CHECK(field_mask(info, "TCKPS") == 0x0030);
    CHECK(field_mask(info, "NONE") == 0);
    CHECK(register_text(info, 0x8000) == "T1CON, bit TON");
    CHECK(register_text(info, 0x8010) == "T1CON, bits TON and TCKPS");
    CHECK(register_text(info, 0xFFFF) == "T1CON");
}
