// Every form of plain instruction between two others, on random states, translated and interpreted: all
// that can be seen is compared, and which forms are translated at all.

#include "emu/dspic/core/core.h"
#include "emu/dspic/machine/isa.h"
#include "emu/dspic/machine/machine.h"
#include "emu/dspic/translate/library.h"
#include "tests/translate/random_loops.h"
#include "tests/translate/translation_guard.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <iterator>
#include <memory>
#include <set>
#include <string>
#include <vector>

using namespace puckloop;
using namespace puckloop::tests;
using namespace puckloop::dspic;

namespace {

constexpr std::uint32_t kStart = 0x400;

struct Subject {
    SfrSpace sfr;
    EventQueue events;
    InterruptController interrupts;
    Core core;

    Subject() : interrupts(dspic30f6014a(), described(sfr)), core(dspic30f6014a(), sfr, events, interrupts) {
        core.reset(ResetCause::PowerOn);
        for (std::uint32_t vector = 0; vector < 62; ++vector)
            core.poke_program(4 + 2 * vector, kStart);
    }
    static SfrSpace& described(SfrSpace& space) {
        space.describe(dspic30f6014a().registers);
        return space;
    }
};

std::unique_ptr<Subject> made(bool translated) {
    const TranslationGuard guard(translated, 1);
    return std::make_unique<Subject>();
}

/// Numbers at which flags change, more often than others.
std::uint16_t some_number(RandomStream& random) {
    constexpr std::uint16_t kEdges[] = {0,      1,      2,      0x7F,   0x80,   0xFF,  0x100,
                                        0x7FFF, 0x8000, 0x8001, 0xFFFE, 0xFFFF, 0x80FF};
    if (random.below(2) != 0) return kEdges[random.below(std::size(kEdges))];
    return static_cast<std::uint16_t>(random.next());
}

CoreState some_state(RandomStream& random, const CoreState& now) {
    CoreState state = now;
    for (std::size_t i = 0; i < 15; ++i) {
        const bool points = i >= 8 ? random.below(8) != 0 : random.below(8) == 0;
        const auto odd = static_cast<std::uint64_t>(random.below(8) == 0 ? 1 : 0);
        state.w[i] =
            points ? static_cast<std::uint16_t>(0x0840 + 2 * random.below(0x400) + odd) : some_number(random);
    }
    state.w[15] = static_cast<std::uint16_t>(0x1400 + 2 * random.below(0x40));
    state.sr = static_cast<std::uint16_t>(random.next()) & (sr::C | sr::Z | sr::OV | sr::N | sr::DC);
    state.corcon = 0;
    state.rcount = static_cast<std::uint16_t>(random.below(0x4000));
    state.psvpag = static_cast<std::uint16_t>(random.below(0x100));
    state.disi_end = 0;
    state.pc = kStart;
    return state;
}

std::vector<std::uint8_t> seen_of(Subject& s) {
    std::vector<std::uint8_t> bytes;
    StateWriter writer(bytes);
    CoreState state = s.core.state();
    writer(state);
    writer(s.core.instructions());
    return bytes;
}

bool is_subject(const Form& form) {
    return form.name == "ULNK" || (is_plain(form) && form.name != "CLRWDT");
}

void compare(Subject& fast, Subject& slow, RandomStream& random, const Form& form) {
    std::uint32_t pc = kStart;
    std::string words;
    const auto put = [&](std::uint32_t word) {
        for (Subject* s : {&fast, &slow})
            s->core.poke_program(pc, word);
        pc += 2;
        words += " " + std::to_string(word);
    };
    put(random_plain_word(random));
    put(random_word_of(random, form));
    // Who reads its flags: a branch over the next instruction, which comes in either case.
    constexpr std::uint32_t kConditions[] = {0x30, 0x31, 0x32, 0x33, 0x34, 0x35, 0x36,
                                             0x38, 0x39, 0x3A, 0x3B, 0x3C, 0x3D, 0x3E};
    if (random.below(2) != 0) put(kConditions[random.below(std::size(kConditions))] << 16 | 1);
    put(random_plain_word(random));
    put(random_plain_word(random));
    put(0x370000 | (((kStart - pc - 2) / 2) & 0xFFFF));
    constexpr int kStates = 10;
    for (int i = 0; i < kStates; ++i) {
        const CoreState state = some_state(random, slow.core.state());
        for (Subject* s : {&fast, &slow})
            s->core.set_state(state);
        const Cycle until = slow.core.cycle() + 1 + random.below(i < 2 ? 30 : 12);
        const Core::Outcome outcome = slow.core.run(until);
        INFO(form.name << ", words" << words << ", state " << i);
        REQUIRE(fast.core.run(until) == outcome);
        REQUIRE(fast.core.cycle() == slow.core.cycle());
        REQUIRE(fast.core.state().w == slow.core.state().w);
        REQUIRE(fast.core.state().sr == slow.core.state().sr);
        const bool same = seen_of(fast) == seen_of(slow);
        REQUIRE(same);
        const auto a = fast.core.ram(), b = slow.core.ram();
        const bool same_ram = std::equal(a.begin(), a.end(), b.begin());
        REQUIRE(same_ram);
    }
}

}  // namespace

TEST_CASE("every form on random states, translated and interpreted") {
    RandomStream random(1, "forms");
    const auto fast = made(true), slow = made(false);
    const auto ram = slow->core.ram();
    std::generate(ram.begin(), ram.end(), [&] { return some_number(random); });
    std::copy(ram.begin(), ram.end(), fast->core.ram().begin());
    constexpr int kPrograms = 40;
    for (const Form& form : forms())
        for (int i = 0; is_subject(form) && i < kPrograms; ++i)
            compare(*fast, *slow, random, form);
}

TEST_CASE("what is not translated is on a list") {
    // Searches, decimal numbers, bits by number, the shadow set, tables of program memory: rare.
    const std::set<std::string_view> interpreted{
        "FF1L_Ws_Wnd",  "FF1R_Ws_Wnd",  "FBCL_Ws_Wnd", "DAW_B_Wn", "BSW_C_Ws_Wb",    "BSW_Z_Ws_Wb",
        "TBLRDL_Ws_Wd", "TBLRDH_Ws_Wd", "PUSH_S",      "POP_S",    "MOVSAC_Prefetch"};
    const DeviceInfo& device = dspic30f6014a();
    SfrSpace sfr;
    EventQueue events;
    InterruptController interrupts(device, Subject::described(sfr));
    Machine m(device, sfr, events, interrupts);
    translate::Library* const library = translate::library_for(m);
    if (!library) return;
    RandomStream random(2, "forms");
    constexpr std::uint32_t kIndex = kStart / 2;
    for (const Form& form : forms()) {
        if (!is_subject(form) || is_dsp(form)) continue;
        bool made = false;
        for (int i = 0; i < 200 && !made; ++i) {
            write_program(m, kStart, random_word_of(random, form));
            decode(m, m.code[kIndex]);
            made = translate::block_at(*library, m, kIndex) != 0;
        }
        INFO(form.name);
        CHECK(made == !interpreted.contains(form.name));
    }
}
