// One line a case, worked by hand from the programmer's reference: an instruction of every class, the
// registers before and after, and its cycles. Flags are written as letters: C Z V (OV) N D (DC), lower case =
// clear.

#include "tests/dspic/rig.h"

#include <catch2/catch.hpp>

#include <cctype>
#include <sstream>
#include <utility>

using namespace puckloop::dspic;
using namespace puckloop::dspic::test;

namespace {

struct Case {
    const char* instruction;
    const char* before;  ///< "w1=1234 m1000=55aa a=7fffffffff cc=0020 CzvN"
    const char* after;   ///< what to check; registers not named must be as before
    int cycles = 1;
};

constexpr Case kCases[] = {
    // Addition and subtraction.
    {"add w1, w2, w3", "w1=7fff w2=0001", "w3=8000 czVND"},
    {"add w1, w2, w3", "w1=ffff w2=0001", "w3=0000 CZvnD"},
    {"add.b w1, w2, w3", "w1=120f w2=3401 w3=5500", "w3=5510 czvnD"},
    {"add.b w1, w2, w3", "w1=0010 w2=0000 w3=0000", "w3=0010 czvnd"},
    {"addc w1, w2, w3", "w1=ffff w2=0000 Cz", "w3=0000 CzvnD"},  // Z is only ever cleared
    {"addc w1, w2, w3", "w1=ffff w2=0000 CZ", "w3=0000 CZvnD"},
    {"addc w1, w2, w3", "w1=8000 w2=ffff C", "w3=8000 CzvND"},
    {"sub w1, w2, w3", "w1=0001 w2=0002", "w3=ffff czvNd"},
    {"sub w1, #31, w3", "w1=001f", "w3=0000 CZvnD"},
    {"subb w1, w2, w3", "w1=ffff w2=ffff cZ", "w3=ffff czvNd"},
    {"subb w1, w2, w3", "w1=0000 w2=7fff c", "w3=8000 czvNd"},
    {"subr w1, w2, w3", "w1=0001 w2=8000", "w3=7fff CzVnd"},
    {"subbr w1, #5, w3", "w1=0004 cZ", "w3=0000 CZvnD"},
    {"add #0x3ff, w4", "w4=0001", "w4=0400 czvnD"},
    {"inc w1, w2", "w1=7fff", "w2=8000 czVND"},
    {"dec2.b w1, w2", "w1=0001 w2=ab00", "w2=abff czvNd"},
    {"neg w1, w2", "w1=8000", "w2=8000 czVND"},
    {"neg w1, w2", "w1=0000", "w2=0000 CZvnD"},
    {"cp w1, w2", "w1=8000 w2=0001", "CzVnd"},
    {"cp0.b w1", "w1=ff80", "CzvND"},
    {"cpb w1, #1", "w1=0002 cZ", "CZvnD"},
    {"daw.b w1", "w1=00fa", "w1=0060 C"},
    // Logic, shifts, extension.
    {"and w1, w2, w3", "w1=ff00 w2=8f0f CV", "w3=8f00 CzVN"},
    {"ior.b w1, #3, w2", "w1=00f0 w2=1100", "w2=11f3 zN"},
    {"xor w1, w1, w2", "w1=1234", "w2=0000 Zn"},
    {"com w1, w2", "w1=ffff", "w2=0000 Zn"},
    {"sl w1, w2", "w1=c000 V", "w2=8000 CzVN"},
    {"lsr w1, w2", "w1=8001", "w2=4000 Czn"},
    {"asr.b w1, w2", "w1=0081 w2=0000", "w2=00c0 CzN"},
    {"rlc w1, w2", "w1=8000 C", "w2=0001 Czn"},
    {"rrnc w1, w2", "w1=0001 C", "w2=8000 CzN"},
    {"sl w1, #4, w2", "w1=1234 C", "w2=2340 Czn"},
    {"asr w1, w2, w3", "w1=8000 w2=0014", "w3=ffff zN"},
    {"se w1, w2", "w1=0080", "w2=ff80 czN"},
    {"ze w1, w2", "w1=ff80", "w2=0080 Czn"},
    {"swap w1", "w1=1234", "w1=3412"},
    {"swap.b w1", "w1=1234", "w1=1243"},
    {"exch w1, w2", "w1=0001 w2=0002", "w1=0002 w2=0001"},
    {"ff1l w1, w2", "w1=0010", "w2=000c c"},
    {"ff1r w1, w2", "w1=0000 w2=1234", "w2=0000 C"},
    {"fbcl w1, w2", "w1=ffff", "w2=fff1 C"},
    // Bits.
    {"bset w1, #15", "w1=0001", "w1=8001"},
    {"bclr.b [w1], #0", "w1=1101 m1100=ffff", "m1100=feff"},
    {"btg w1, #4", "w1=0010", "w1=0000"},
    {"btst.c w1, #3", "w1=0008", "C"},
    {"btst.z w1, w2", "w1=0008 w2=0013", "z"},
    {"btsts.z w1, #2", "w1=0000", "w1=0004 Z"},
    {"bsw.z w1, w2", "w1=0000 w2=0005 z", "w1=0020"},
    {"bsw.c w1, w2", "w1=00ff w2=0000 c", "w1=00fe"},
    // Moves and pointers.
    {"mov w1, w2", "w1=1234 CZVN", "w2=1234 CZVN"},
    {"mov [w1++], [--w2]", "w1=1100 w2=1202 m1100=beef", "w1=1102 w2=1200 m1200=beef"},
    {"mov.b [w1--], w2", "w1=1101 m1100=aa55 w2=1111", "w1=1100 w2=11aa"},
    {"mov [w1++], [w1]", "w1=1100 m1100=1234", "w1=1102 m1102=1234"},  // the moved pointer is used
    {"mov [w1+w2], w3", "w1=1100 w2=0004 m1104=7777", "w3=7777"},
    {"mov [w1-6], w3", "w1=1106 m1100=4321", "w3=4321"},
    {"mov.b w3, [w1+3]", "w1=1100 w3=00ee", "m1102=ee00"},
    {"mov.d [w2++], w4", "w2=1100 m1100=1111 m1102=2222", "w2=1104 w4=1111 w5=2222", 2},
    {"mov.d w4, [--w2]", "w2=1104 w4=1111 w5=2222", "w2=1100 m1100=1111 m1102=2222", 2},
    {"mov #0x8000, w1", "Z", "w1=8000 Z"},
    {"mov 0x1100, wreg", "m1100=8000", "w0=8000 zN"},
    {"push w1", "w1=4711", "w15=1802 m1800=4711"},
    {"pop w1", "w15=1802 m1800=4711", "w15=1800 w1=4711"},
    {"lnk #8", "w14=1234", "w14=1802 w15=180a m1800=1234"},
    {"ulnk", "w14=1802 w15=1810 m1800=1234", "w14=1234 w15=1800"},
    {"setm [w1]", "w1=1100", "m1100=ffff"},
    {"clr.b w1", "w1=1234", "w1=1200"},
    // Multiplication.
    {"mul.ss w1, w2, w4", "w1=ffff w2=0002", "w4=fffe w5=ffff"},
    {"mul.us w1, w2, w4", "w1=ffff w2=ffff", "w4=0001 w5=ffff"},
    {"mul.su w1, #31, w4", "w1=ffff", "w4=ffe1 w5=ffff"},
    {"mul.uu w1, w2, w4", "w1=ffff w2=ffff", "w4=0001 w5=fffe"},
    {"mul.b 0x1100", "w0=12ff m1100=3402", "w2=01fe"},
    // DSP. cc: 0001 integer, 0000 fraction; 0080 SATA, 0010 ACCSAT, 1000 US, 0002 RND, 0020 SATDW.
    {"mpy w4*w5, a", "w4=8000 w5=8000 cc=0000", "a=0080000000"},
    {"mpy w4*w5, a", "w4=8000 w5=8000 cc=0080", "a=007fffffff"},
    {"mpy w4*w5, a", "w4=ffff w5=ffff cc=1001", "a=00fffe0001"},
    {"mpy.n w4*w5, a", "w4=0003 w5=0005 cc=0001", "a=fffffffff1"},
    {"mac w4*w5, a", "w4=0003 w5=0005 a=0000000001 cc=0001", "a=0000000010"},
    {"msc w4*w5, a", "w4=0003 w5=0005 a=0000000010 cc=0001", "a=0000000001"},
    {"mac w4*w5, a, [w8]+=2, w4, [w10]-=2, w5",
     "w4=0002 w5=0003 w8=1100 w10=1a02 m1100=1111 m1a02=2222 cc=0001",
     "a=0000000006 w4=1111 w5=2222 w8=1102 w10=1a00"},
    {"ed w4*w4, a, [w8]+=2, [w10]+=2, w4", "w4=0004 w8=1100 w10=1a00 m1100=0009 m1a00=0004 cc=0001",
     "a=0000000010 w4=0005 w8=1102 w10=1a02"},
    {"clr a, [w8]+=2, w4", "a=1234567890 w8=1100 m1100=5555", "a=0000000000 w4=5555 w8=1102"},
    {"lac w1, #4, a", "w1=8000", "a=fff8000000"},
    {"sac a, #-4, w1", "a=0001234567 cc=0020", "w1=1234"},
    {"sac a, #-8, w1", "a=0001234567 cc=0020", "w1=7fff"},
    {"sac.r a, w1", "a=0000018000 cc=0000", "w1=0002"},  // to even
    {"sac.r a, w1", "a=0000008000 cc=0000", "w1=0000"},  // to even
    {"sac.r a, w1", "a=0000008000 cc=0002", "w1=0001"},  // half up
    {"sftac a, #4", "a=8000000000", "a=f800000000"},
    {"neg a", "a=8000000000 cc=0090", "a=7fffffffff"},
    {"add w1, a", "w1=0001 a=000000ffff", "a=000001ffff"},
};

constexpr std::pair<char, std::uint16_t> kFlags[] = {
    {'C', sr::C}, {'Z', sr::Z}, {'V', sr::OV}, {'N', sr::N}, {'D', sr::DC}};

/// The flags that a list names, set or clear.
std::uint16_t named_flags(const std::string& text) {
    std::uint16_t named = 0;
    std::istringstream in(text);
    for (std::string token; in >> token;)
        for (const char c : token.find('=') == std::string::npos ? token : std::string())
            for (const auto& [letter, bit] : kFlags)
                if (std::toupper(c) == letter) named = static_cast<std::uint16_t>(named | bit);
    return named;
}

void apply(CoreState& st, Rig& rig, const std::string& text) {
    std::istringstream in(text);
    for (std::string token; in >> token;) {
        const auto equals = token.find('=');
        if (equals == std::string::npos) {
            for (const char c : token)
                for (const auto& [letter, bit] : kFlags)
                    if (std::toupper(c) == letter)
                        st.sr = static_cast<std::uint16_t>(std::isupper(c) ? st.sr | bit : st.sr & ~bit);
            continue;
        }
        const std::string key = token.substr(0, equals);
        const std::uint64_t value = std::stoull(token.substr(equals + 1), nullptr, 16);
        if (key == "cc") {
            st.corcon = static_cast<std::uint16_t>(value);
        } else if (key == "a") {
            st.acc[0] = static_cast<std::int64_t>(value << 24) >> 24;
        } else if (key[0] == 'w') {
            st.w[std::stoul(key.substr(1))] = static_cast<std::uint16_t>(value);
        } else {
            const auto address = static_cast<std::uint16_t>(std::stoul(key.substr(1), nullptr, 16));
            rig.core.write_data(address, static_cast<std::uint16_t>(value));
        }
    }
}

}  // namespace

TEST_CASE("instructions of every class, worked by hand") {
    for (const Case& c : kCases) {
        INFO(c.instruction << " | " << c.before);
        Rig rig("        " + std::string(c.instruction) + "\n        nop\n");
        CoreState st = rig.core.state();
        for (std::size_t i = 0; i < 15; ++i)
            st.w[i] = 0;
        st.w[15] = 0x1800;
        apply(st, rig, c.before);
        rig.core.set_state(st);
        const Cycle start = rig.core.cycle();
        rig.core.step();
        const CoreState got = rig.core.state();
        CHECK(got.cycle - start == static_cast<Cycle>(c.cycles));

        // Expected: the state before, changed as the case states; then what a Rig reads back at named places.
        Rig scratch("        nop\n");
        CoreState want = st;
        apply(want, scratch, c.after);
        for (std::size_t i = 0; i < 16; ++i) {
            INFO("w" << i);
            CHECK(got.w[i] == want.w[i]);
        }
        CHECK(got.acc[0] == want.acc[0]);
        std::istringstream in(c.after);
        for (std::string token; in >> token;) {
            if (token[0] != 'm') continue;
            const auto address = static_cast<std::uint16_t>(std::stoul(token.substr(1, 4), nullptr, 16));
            CHECK(rig.data(address) == scratch.data(address));
        }
        CHECK((got.sr & named_flags(c.after)) == (want.sr & named_flags(c.after)));
    }
}

TEST_CASE("accumulator flags: overflow, saturation, and what clears them") {
    Rig rig(R"(
        mov     #0x7fff, w4
        lac     w4, a
        add     w4, a           ; beyond 1.31: OA, OAB
one:    bset    0x44, #7        ; SATA
        add     w4, a           ; limited: SA, SAB, OA off
two:    clr     a               ; OA and SA off
three:  lac     w4, #-8, b
        bset    0x44, #6        ; SATB
        bset    0x44, #4        ; ACCSAT: 9.31
        add     w4, b
four:   add     w4, b
        bclr    0x42, #10       ; SAB clears both
five:   bra     five
)");
    const auto flags = [&](const std::string& label) {
        REQUIRE(rig.run_to(label));
        return rig.core.state().sr & 0xFC00;
    };
    CHECK(flags("one") == (sr::OA | sr::OAB));
    CHECK(flags("two") == (sr::SA | sr::SAB));
    CHECK(rig.core.state().acc[0] == 0x7FFFFFFF);
    CHECK(flags("three") == 0);
    CHECK((flags("four") & sr::OB) != 0);
    CHECK((flags("five") & (sr::SA | sr::SB | sr::SAB)) == 0);
}
