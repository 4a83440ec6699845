// Cycles of instructions, timed by programs: docs/timing_rules.md, rules I1, I4 and I6.

#include "emu/dspic/machine/isa.h"
#include "tests/timing/timed_chip.h"

#include "base/random.h"

#include <catch2/catch.hpp>

#include <set>

using namespace puckloop;
using namespace puckloop::dspic;
using namespace puckloop::dspic::test;

namespace {

const DeviceInfo* const kDevices[] = {&dspic30f6014a(), &dspic33fj256gp710()};

/// One cycle each (programmer's reference DS70157, instruction table; fact sheet isa.csv).
const char* const kOneCycle[] = {
    // file registers and WREG
    "add 0x1200", "add 0x1200, WREG", "addc 0x1200", "addc 0x1200, WREG", "sub 0x1200", "sub 0x1200, WREG",
    "subb 0x1200", "subb 0x1200, WREG", "and 0x1200", "and 0x1200, WREG", "xor 0x1200", "xor 0x1200, WREG",
    "ior 0x1200", "ior 0x1200, WREG", "subr 0x1200", "subr 0x1200, WREG", "subbr 0x1200",
    "subbr 0x1200, WREG", "mov WREG, 0x1200", "mul 0x1200", "mov 0x1200", "mov 0x1200, WREG", "sl 0x1200",
    "sl 0x1200, WREG", "lsr 0x1200", "lsr 0x1200, WREG", "asr 0x1200", "asr 0x1200, WREG", "rlnc 0x1200",
    "rlnc 0x1200, WREG", "rlc 0x1200", "rlc 0x1200, WREG", "rrnc 0x1200", "rrnc 0x1200, WREG", "rrc 0x1200",
    "rrc 0x1200, WREG", "inc 0x1200", "inc 0x1200, WREG", "inc2 0x1200", "inc2 0x1200, WREG", "dec 0x1200",
    "dec 0x1200, WREG", "dec2 0x1200", "dec2 0x1200, WREG", "neg 0x1200", "neg 0x1200, WREG", "com 0x1200",
    "com 0x1200, WREG", "clr 0x1200", "clr WREG", "setm 0x1200", "setm WREG", "cp 0x1200", "cpb 0x1200",
    "cp0 0x1200", "mov 0x1200, w3", "mov w3, 0x1200",
    // literals
    "add #5, w2", "addc #5, w2", "sub #5, w2", "subb #5, w2", "and #5, w2", "xor #5, w2", "ior #5, w2",
    "mov.b #5, w2", "mov #0x1234, w2", "subr w2, #5, w3", "subbr w2, #5, w3", "add w2, #5, w3",
    "addc w2, #5, w3", "sub w2, #5, w3", "subb w2, #5, w3", "and w2, #5, w3", "xor w2, #5, w3",
    "ior w2, #5, w3", "cp w2, #5", "cpb w2, #5",
    // two and three operands, through pointers as well as direct
    "subr w2, [w8++], [w9++]", "subbr w2, [w8--], w3", "add w2, [++w8], [--w9]", "addc w2, w3, w4",
    "sub w2, [w8], w3", "subb w2, w3, [w9]", "and w2, w3, w4", "xor w2, [w8], w3", "ior w2, w3, w4",
    "mov [w8++], [w9++]", "mov w2, w3", "mov.b [w8], w3", "mov [w8+4], w3", "mov w3, [w8+4]", "sl [w8], w3",
    "lsr w2, w3", "asr w2, [w9]", "rlnc w2, w3", "rlc w2, w3", "rrnc w2, w3", "rrc w2, w3", "inc [w8], [w8]",
    "inc2 w2, w3", "dec w2, w3", "dec2 w2, w3", "neg w2, w3", "com w2, w3", "clr [w9++]", "setm w3",
    "sl w2, #4, w3", "sl w2, w3, w4", "lsr w2, #4, w3", "lsr w2, w3, w4", "asr w2, #4, w3", "asr w2, w3, w4",
    "cp0 [w8]", "cp w2, [w8]", "cpb w2, w3", "cpseq w2, w3", "cpsne w2, w2", "cpsgt w3, w2", "cpslt w2, w3",
    // multiplication, bits, bytes
    "mul.ss w2, [w8], w4", "mul.su w2, #5, w4", "mul.su w2, w3, w4", "mul.us w2, w3, w4", "mul.uu w2, #5, w4",
    "mul.uu w2, w3, w4", "bset w2, #3", "bclr [w8], #3", "btg w2, #3", "btst.c w2, #3", "btst.z [w8], #3",
    "btsts.c w2, #3", "btsts.z w2, #3", "btst.c w2, w3", "btst.z w2, w3", "btss w2, #0", "btsc w2, #2",
    "bset 0x1200, #3", "bclr 0x1200, #3", "btg 0x1200, #3", "btst 0x1200, #3", "btsts 0x1200, #3",
    "btss TBLPAG, #7", "btsc TRISB, #5", "bsw.c w2, w3", "bsw.z w2, w3", "ff1l w2, w3", "ff1r [w8], w3",
    "fbcl w2, w3", "se w2, w3", "ze w2, w3", "exch w2, w3", "swap w2", "daw.b w2",
    // stack, frames, shadows, and what does nothing
    "push 0x1200", "push.s", "pop.s", "nop", "nopr", "disi #0", "clrwdt", "lnk #4",
    // accumulators
    "add a", "neg a", "sub b", "add w4, #2, a", "lac w4, #-2, b", "sac a, #2, w3", "sac.r b, w3",
    "sftac a, #3", "mac w4*w5, a, [w8]+=2, w4, [w10]-=2, w5, w13", "mpy w4*w5, b", "msc w4*w5, a",
    "mpy.n w4*w5, a", "clr a", "movsac a", "mac w4*w4, a", "mpy w5*w5, a",
    "edac w4*w4, a, [w8]+=2, [w10]+=2, w5", "ed w4*w4, b, [w8], [w10], w5"};

const Stretch kLonger[] = {
    {"mov #3, w3", "sftac b, w3", 1},
    {"", "mov.d [w8], w2", 2},
    {"", "mov.d w2, [w9]", 2},
    {"", "tblrdl [w8], w2", 2},
    {"", "tblrdh [w8], w2", 2},
    {"", "tblwtl w2, [w9]", 2},
    {"", "tblwth w2, [w9]", 2},
    {"", "push.d w2\n nop\n pop.d w4", 2 + 1 + 2},
    {"", "push.d w2\n pop.d w4", 2 + 1 + 2},  // a stall: W15 was written just before
    {"push w2", "pop 0x1200", 1},
    {"lnk #4", "ulnk", 1},
    // everything that writes the program counter: 2, returns: 3
    {"", "bra {0}\n nop\n nop", 2},
    {"mov #2, w2", "bra w2\n nop\n nop", 2},
    {"", "goto {0}\n nop", 2},
    {"mov #{0}, w2", "goto w2\n nop", 2},
    {"", "call sub", 2 + 3},
    {"mov #sub, w2", "call w2", 2 + 3},
    {"", "rcall sub5", 2 + 3},
    {"mov #1, w2", "rcall w2\n bra {0}\n return", 2 + 3 + 2},
    {"mov #{0}, w2\n push w2\n clr w2\n push w2", "retfie\n nop", 3},
    // branches: 1, 2 when taken
    {"bset SR, #2", "bra nov, {0}\n bra ov, {0}\n nop", 1 + 2},
    {"bset SR, #0", "bra nc, {0}\n bra c, {0}\n nop", 1 + 2},
    {"bset SR, #1", "bra nz, {0}\n bra z, {0}\n nop", 1 + 2},
    {"bset SR, #3", "bra nn, {0}\n bra n, {0}\n nop", 1 + 2},
    {"bset SR, #1", "bra gt, {0}\n bra le, {0}\n nop", 1 + 2},
    {"bset SR, #3", "bra ge, {0}\n bra lt, {0}\n nop", 1 + 2},
    {"bset SR, #0", "bra leu, {0}\n bra gtu, {0}\n nop", 1 + 2},
    {"", "bra oa, {0}\n bra ob, {0}\n bra sa, {0}\n bra sb, {0}", 4},
    // skips: 1, 2 over one word, 3 over two
    {"", "btss w2, #0\n mov.d w4, [w9]", 1 + 2},
    {"", "btsc w2, #0\n mov.d w4, [w9]", 2},
    {"", "btsc w2, #0\n call sub", 3},
    {"", "cpseq w2, w2\n call sub", 3},
    {"", "cpsne w2, w3\n mov.d w4, [w9]", 2},
    {"", "cpsgt w2, w3\n goto main", 3},
    {"", "cpslt w3, w2\n goto main", 3},
    {"", "btss 0x1200, #0\n btsc 0x1200, #0\n nop", 3},
    // loops in hardware: REPEAT 1 and the target, DO 2 and no time at its end; a division 1 + 18
    {"", "repeat #9\n inc w2, w2", 1 + 10},
    {"mov #7, w2", "repeat w2\n nop", 1 + 8},
    {"", "repeat #0\n nop", 1 + 1},
    {"", "do #6, d{1}\n nop\nd{1}: inc w2, w2", 2 + 7 * 2},
    {"mov #3, w2", "do w2, d{1}\n nop\n nop\nd{1}: inc w3, w3", 2 + 4 * 3},
    {"", "repeat #17\n div.sw w2, w3", 19},
    {"", "repeat #17\n div.uw w2, w3", 19},
    {"", "repeat #17\n div.sd w2, w4", 19},
    {"", "repeat #17\n div.ud w2, w4", 19},
    {"", "repeat #17\n divf w3, w2", 19},
};

/// Checks each stretch, interpreted and translated.
void check(const DeviceInfo& device, const std::vector<Stretch>& stretches) {
    Stopwatch watch(device, stretches);
    for (const bool hot : {false, true}) {
        const std::vector<int> measured = watch.measure(hot);
        for (std::size_t i = 0; i < stretches.size(); ++i) {
            INFO(device.name << (hot ? ", hot: " : ", first time: ") << stretches[i].prepare << " | "
                             << stretches[i].timed);
            CHECK(measured[i] == stretches[i].cycles);
        }
    }
    for (const TrapRecord& trap : watch.chip().chip.report().traps)
        FAIL_CHECK(trap.name << " at " << fmt::format("{:#x}", trap.pc));
    CHECK(watch.chip().chip.report().resets.size() == 1);
}

}  // namespace

TEST_CASE("each instruction takes the cycles of the programmer's reference") {
    std::vector<Stretch> all(std::begin(kLonger), std::end(kLonger));
    for (const char* line : kOneCycle)
        all.push_back({"", line, 1});
    for (const DeviceInfo* device : kDevices)
        check(*device, all);

    // Every form of the instruction table is among them, but for those that end or stop the program.
    std::set<std::string_view> seen;
    for (std::size_t i = 0; i < all.size(); ++i) {
        const std::string prepare = fmt::format(fmt::runtime(all[i].prepare), "here", i);
        const std::string timed = fmt::format(fmt::runtime(all[i].timed), "here", i);
        const Program program =
            TimedChip::assembled(dspic30f6014a(), "sub:\nsub5:\nmain:\n" + prepare + "\n" + timed +
                                                      "\nhere: nop\n return\n retlw #5, w2\n");
        for (const auto& [address, word] : program.words)
            if (const Form* found = find_form(word)) seen.insert(found->name);
    }
    for (const Form& form : forms()) {
        if (form.alias || form.mnemonic == "PWRSAV" || form.mnemonic == "RESET") continue;
        INFO(form.name);
        CHECK(seen.contains(form.name));
    }
}

TEST_CASE("reading program memory through the PSV window costs MOV and MAC one cycle more, others two") {
    const std::string window = "bset CORCON, #2\n clr PSVPAG\n mov #0x8200, w8\n mov #0x8300, w9";
    const auto timed = [&](const std::string& text, int cycles) { return Stretch{window, text, cycles}; };
    for (const DeviceInfo* device : kDevices)
        check(*device,
              {timed("mov [w8], w3", 1 + 1), timed("mov.b [w8++], w3", 1 + 1), timed("mov.d [w8], w2", 2 + 1),
               timed("mov [w8+4], w3", 1 + 1), timed("mov 0x8200, w3", 1 + 1),
               timed("mac w4*w5, a, [w8]+=2, w4", 1 + 1), timed("add w2, [w8], w3", 1 + 2),
               timed("sl [w8++], w3", 1 + 2), timed("cp0 [w8]", 1 + 2), timed("btst.z [w8], #3", 1 + 2),
               timed("mul.uu w2, [w8], w4", 1 + 2), timed("ze [w8], w3", 1 + 2), timed("lac [w8], a", 1 + 2),
               // in a REPEAT the first and the last time only
               timed("repeat #9\n add w2, [w8], w3", 1 + 10 + 2 + 2),
               timed("repeat #1\n add w2, [w8], w3", 1 + 2 + 2 + 2)});
}

TEST_CASE("a pointer that the instruction before has written stalls a source for one cycle, drawn pairs") {
    RandomStream random(Catch::rngSeed(), "stalls");
    const auto below = [&](std::uint64_t limit) { return static_cast<int>(random.next() % limit); };
    // Destination of the first, source of the second: does the pair stall, if both name one register?
    const char* const firsts[] = {"mov w2, {}", "mov w2, [{}]", "mov w2, [{}++]", "mov w2, [++{}]",
                                  "add w2, w3, {}"};
    const bool writes[] = {true, false, true, true, true};
    const char* const seconds[] = {"mov {}, w3",         "mov [{}], w3", "mov [{}++], w3",
                                   "add w2, [--{}], w3", "mov w3, [{}]", "mov w3, [{}++]"};
    const bool reads[] = {false, true, true, true, false, false};
    std::vector<Stretch> pairs;
    for (int i = 0; i < 120; ++i) {
        const int first = below(std::size(firsts)), second = below(std::size(seconds));
        const int one = 8 + below(4), two = below(2) ? one : 8 + below(4);
        const bool gap = below(4) == 0;  // an instruction between: no stall
        const bool stalls = writes[first] && reads[second] && one == two && !gap;
        pairs.push_back({"mov #0x1500, w2",
                         fmt::format(fmt::runtime(firsts[first]), fmt::format("w{}", one)) +
                             (gap ? "\n nop\n " : "\n ") +
                             fmt::format(fmt::runtime(seconds[second]), fmt::format("w{}", two)),
                         2 + gap + stalls});
    }
    for (const DeviceInfo* device : kDevices)
        check(*device, pairs);
}
