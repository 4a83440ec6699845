#pragma once
// Programs of random waiting loops: they poll counters, flags, pins and variables that interrupts change,
// write counters, start and stop a timer, call subroutines, switch interrupts off and on, use the stack and
// scratch variables. Endless, and never the same turn twice.

#include "base/random.h"

#include <fmt/format.h>

#include <string>

namespace puckloop::avr::test {

class RandomLoops {
  public:
    explicit RandomLoops(RandomStream& random) : random_(random) {}

    std::string program() {
        std::string text = "        jmp start\n";
        text += isr(0x24, "T2C");  // TIMER2_COMPA .. see below
        text += isr(0x2C, "T2O");
        text += isr(0x48, "T0O");
        text += "        .org 0x100\n";
        text += service("T2C", 0x202) + service("T2O", 0x201) + service("T0O", 0x200);
        text += "start:  ldi r16, 0x20\n        out DDRB, r16\n";
        text += set("TCCR0A", pick({0, 2, 3})) + set("TCCR0B", 1 + below(5)) + set("OCR0A", 40 + below(200));
        text += set("TCCR2A", pick({0, 2, 3})) + set("TCCR2B", 1 + below(7)) + set("OCR2A", 40 + below(200));
        text += set("TIMSK0", below(2)) + set("TIMSK2", below(4));
        text += set("TCCR1B", 1 + below(3));
        text += "        sei\n";
        const int loops = 3 + below(4);
        for (int i = 0; i < loops; ++i)
            text += loop(i);
        text += "        jmp start_over\n";
        text += subroutines();
        return text;
    }

  private:
    int below(int n) { return static_cast<int>(random_.below(static_cast<std::uint64_t>(n))); }
    int pick(std::initializer_list<int> values) {
        return *(values.begin() + below(static_cast<int>(values.size())));
    }
    static std::string line(const std::string& text) { return "        " + text + "\n"; }
    static std::string set(const std::string& name, int value) {
        return line(fmt::format("ldi r16, {}", value)) + line(fmt::format("sts {}, r16", name));
    }
    static std::string isr(int address, const std::string& name) {
        return fmt::format("        .org 0x{:X}\n        jmp {}\n", address, name);
    }
    /// Counts, and sometimes writes the counter as the TAM's firmware does.
    std::string service(const std::string& name, int variable) {
        std::string text = name + ":\n" + line("push r24") + line("in r24, SREG") + line("push r24");
        if (name != "T0O" && below(2))
            text += line(fmt::format("ldi r24, {}", below(250))) + line("sts TCNT2, r24");
        if (name != "T0O" && below(3) == 0) text += clock_of_timer_2();
        text += line(fmt::format("lds r24, {}", variable)) + line("inc r24") +
                line(fmt::format("sts {}, r24", variable));
        if (below(2)) text += line("sbi PINB, 5");
        return text + line("pop r24") + line("out SREG, r24") + line("pop r24") + line("reti");
    }
    /// Another clock for timer 2; half the time it is stopped for some clocks before.
    std::string clock_of_timer_2() {
        std::string text;
        if (below(2)) {
            text += line("ldi r24, 0") + line("sts TCCR2B, r24");
            for (int n = below(4); n > 0; --n)
                text += line("nop");
        }
        return text + line(fmt::format("ldi r24, {}", 1 + below(7))) + line("sts TCCR2B, r24");
    }
    std::string subroutines() {
        std::string text;
        for (int i = 0; i < 3; ++i) {
            text += fmt::format("sub{}:\n", i);
            const bool masks = below(2);
            if (masks) text += line("in r19, SREG") + line("cli");
            for (int n = 1 + below(6); n > 0; --n)
                text += body();
            if (below(2)) {  // an inner loop
                text += line(fmt::format("ldi r20, {}", 1 + below(4))) + fmt::format("inner{}:\n", i) +
                        line("lsl r22") + line("rol r23") + line("dec r20") +
                        line(fmt::format("brne inner{}", i));
            }
            if (masks) text += line("out SREG, r19");
            text += line("ret");
        }
        return text;
    }
    std::string body() {
        const int d = 16 + below(10), r = 16 + below(10), high = 16 + below(10), cell = 0x210 + below(6);
        switch (below(26)) {
        case 0:
            return line(fmt::format("in r{}, TCNT0", d));
        case 1:
            return line(fmt::format("lds r{}, TCNT2", d));
        case 2:
            return line(fmt::format("in r{}, TIFR0", d));
        case 3:
            return line(fmt::format("in r{}, TIFR2", d));
        case 4:
            return line(fmt::format("in r{}, PIND", d));
        case 5:
            return line(fmt::format("lds r{}, 0x{:X}", d, 0x200 + below(3)));
        case 6:
            return line(fmt::format("sts 0x{:X}, r{}", cell, d));
        case 7:
            return line(fmt::format("lds r{}, 0x{:X}", d, cell));
        case 8:
            return line(fmt::format("add r{}, r{}", d, r));
        case 9:
            return line(fmt::format("adc r{}, r{}", d, r));
        case 10:
            return line(fmt::format("sub r{}, r{}", d, r));
        case 11:
            return line(fmt::format("sbc r{}, r{}", d, r));
        case 12:
            return line(fmt::format("{} r{}, {}", pick({0, 1}) ? "subi" : "sbci", high, below(256)));
        case 13:
            return line(fmt::format("{} r{}", below(2) ? "inc" : "dec", d));
        case 14:
            return line(fmt::format("{} r{}", below(2) ? "lsr" : "ror", d));
        case 15:
            return line(fmt::format("mul r{}, r{}", d, r)) + line("movw r22, r0");
        case 16:
            return line(fmt::format("ldi r{}, {}", high, below(256)));
        case 17:
            return line(fmt::format("mov r{}, r{}", d, r));
        case 18:
            return line("in r21, SREG");
        case 19:
            return line(fmt::format("push r{}", d)) + line(fmt::format("pop r{}", r));
        case 20:
            return line("cli") + line(fmt::format("eor r{}, r{}", d, r)) + line("sei");
        case 21:
            return line(fmt::format("{} r{}, {}", below(2) ? "sbrc" : "sbrs", d, below(8))) +
                   line(fmt::format("and r{}, r{}", d, r));
        case 22:
            return line(fmt::format("sbis TIFR0, {}", below(3))) + line(fmt::format("com r{}", d));
        case 23:  // a count that is written and read back, one to three clocks later
            return line(fmt::format("out TCNT0, r{}", d)) + (below(2) ? line("nop") : "") +
                   line(below(2) ? fmt::format("in r{}, TCNT0", r) : fmt::format("lds r{}, 0x46", r));
        default:
            return line(fmt::format("{} r24, {}", below(2) ? "adiw" : "sbiw", below(64)));
        }
    }
    std::string loop(int number) {
        std::string text = number == 0 ? "start_over:\n" : "";
        text += line(fmt::format("lds r2, 0x{:X}", 0x200 + below(3)));
        text += fmt::format("loop{}:\n", number);
        for (int n = below(9); n > 0; --n)
            text += below(6) ? body() : line(fmt::format("call sub{}", below(3)));
        switch (below(4)) {
        case 0:
            text += line("in r18, TCNT0") + line(fmt::format("cpi r18, {}", 20 + below(200)));
            break;
        case 1:
            text += line("lds r18, TCNT2") + line(fmt::format("subi r18, {}", below(256))) +
                    line(fmt::format("cpi r18, {}", below(256)));
            break;
        default:
            text += line(fmt::format("lds r18, 0x{:X}", 0x200 + below(3))) + line("sub r18, r2") +
                    line(fmt::format("cpi r18, {}", 1 + below(4)));
            break;
        }
        return text + line(fmt::format("{} loop{}", below(3) ? "brlo" : "brne", number));
    }

    RandomStream& random_;
};

}  // namespace puckloop::avr::test
