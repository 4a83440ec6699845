// Loops that count, of drawn forms: 16, 32 and 64 bits wide, in registers and in a frame, up and down,
// nested, with interrupts at drawn times. Skipped or executed, they are in the same state at every cut.

#include "tests/dspic/skips/skipping.h"

#include <catch2/catch.hpp>

#include <string>

using namespace puckloop::dspic;
using namespace puckloop::dspic::test;
using puckloop::RandomStream;

namespace {

class Writer {
  public:
    explicit Writer(std::uint64_t seed) : random_(seed, "counting loops") {}

    /// A loop with label number `depth`; deeper ones inside.
    std::string loop(int depth) {
        const std::string label = "l" + std::to_string(depth);
        std::string body = filler();
        if (depth == 0 && random_.below(2)) body += loop(1);
        body += filler();
        switch (random_.below(4)) {
        case 0:
            return register16(label, body, depth);
        case 1:
            return frame16(label, body, depth);
        case 2:
            return frame32(label, body, depth);
        default:
            return frame64(label, body, depth);
        }
    }
    RandomStream& random() { return random_; }

  private:
    static std::string number(std::uint64_t value) { return "#" + std::to_string(value & 0xFFFF); }
    std::string condition() {
        static constexpr const char* kConditions[] = {"nz", "le", "lt", "leu", "nc", "gt", "nn"};
        return kConditions[random_.below(7)];
    }
    std::string step() { return "#" + std::to_string(1 + random_.below(random_.below(2) ? 1 : 9)); }
    std::string adder() { return random_.below(4) == 0 ? "sub" : "add"; }
    /// Counts on the side, or does nothing lasting.
    std::string filler() {
        switch (random_.below(6)) {
        case 0:
            return "        inc     [w8], [w8]\n";
        case 1:
            return "        add     w7, #3, w7\n";
        case 2:
            return "        nop\n        mov     w7, w6\n";
        case 3:
            return "        push    w6\n        pop     w6\n";
        default:
            return "";
        }
    }
    std::uint64_t start() { return random_.below(3) == 0 ? 65530 : random_.below(400); }
    std::uint64_t bound() { return random_.below(3) == 0 ? 65535 - random_.below(9) : random_.below(3000); }

    std::string register16(const std::string& label, const std::string& body, int depth) {
        const std::string w = depth == 0 ? "w10" : "w11";
        return "        mov     " + number(start()) + ", " + w + "\n" + label + ":\n" + body + "        " +
               adder() + "     " + w + ", " + step() + ", " + w + "\n        mov     " + number(bound()) +
               ", w0\n        cp      " + w + ", w0\n        bra     " + condition() + ", " + label + "\n";
    }
    std::string frame16(const std::string& label, const std::string& body, int depth) {
        const std::string at = "[w14+" + std::to_string(8 * depth) + "]";
        return "        mov     " + number(start()) + ", w0\n        mov     w0, " + at + "\n" + label +
               ":\n" + body + "        mov     " + at + ", w0\n        " + adder() + "     w0, " + step() +
               ", w0\n        mov     w0, " + at + "\n        mov     " + number(bound()) +
               ", w1\n        sub     w0, w1, [w15]\n        bra     " + condition() + ", " + label + "\n";
    }
    std::string frame32(const std::string& label, const std::string& body, int depth) {
        const std::string low = "[w14+" + std::to_string(8 * depth) + "]";
        const std::string high = "[w14+" + std::to_string(8 * depth + 2) + "]";
        return "        mov     " + number(start()) + ", w0\n        mov     w0, " + low +
               "\n        clr     w0\n        mov     w0, " + high + "\n" + label + ":\n" + body +
               "        mov     " + low + ", w0\n        mov     " + high + ", w1\n        add     w0, " +
               step() + ", w0\n        addc    w1, #0, w1\n        mov     w0, " + low +
               "\n        mov     w1, " + high + "\n        mov     " + number(bound()) +
               ", w2\n        mov     #" + std::to_string(random_.below(2)) +
               ", w3\n        sub     w0, w2, [w15]\n        subb    w1, w3, [w15]\n        bra     " +
               condition() + ", " + label + "\n";
    }
    std::string frame64(const std::string& label, const std::string& body, int depth) {
        const std::string to = "        add     w14, #" + std::to_string(8 * depth) + ", w9\n";
        return to + "        mov     " + number(start()) +
               ", w0\n        clr     w1\n        mov.d   w0, [w9++]\n" +
               "        clr     w0\n        mov.d   w0, [w9--]\n" + label + ":\n" + body + to +
               "        mov.d   [w9++], w4\n        mov.d   [w9--], w6\n        mov     " + step() +
               ", w0\n        mov     #0, w1\n        mul.uu  w2, #0, w2\n        add     w4, w0, [w9++]\n"
               "        addc    w5, w1, [w9++]\n        addc    w6, w2, [w9++]\n        addc    w7, w3, "
               "[w9]\n"
               "        sub     #6, w9\n        mov     " +
               number(bound()) + ", w0\n        mov     #" + std::to_string(random_.below(2)) +
               ", w1\n        mul.uu  w2, #0, w2\n        mov.d   [w9++], w4\n        mov.d   [w9--], w6\n"
               "        cp      w4, w0\n        cpb     w5, w1\n        cpb     w6, w2\n        cpb     w7, "
               "w3\n"
               "        bra     " +
               condition() + ", " + label + "\n";
    }

    RandomStream random_;
};

}  // namespace

TEST_CASE("counting loops of drawn forms, skipped and executed") {
    for (std::uint64_t seed = 0; seed < 150; ++seed) {
        Writer writer(seed);
        const std::string source =
            kHead + "again:  mov     #0x0C00, w9\n" + writer.loop(0) + "        bra     done\n" + kTail;
        const Cycle period = writer.random().below(4) == 0 ? 0 : 60 + writer.random().below(6000);
        compare(source, 300'000, period, seed);
    }
}
