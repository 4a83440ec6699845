// The instruction table itself: no two forms share a word, and fields go in and out.

#include "emu/dspic/machine/isa.h"

#include <catch2/catch.hpp>

using namespace puckloop::dspic;

TEST_CASE("no word belongs to two primary forms") {
    // Two forms can only overlap where their fixed bits agree; try every word of every such pair.
    for (const Form& a : forms()) {
        for (const Form& b : forms()) {
            if (a.alias || b.alias || a.id >= b.id) continue;
            if ((a.value ^ b.value) & a.mask & b.mask) continue;
            const std::uint32_t free = ~(a.mask | b.mask) & 0xFFFFFF;
            std::uint32_t bits = 0;
            int shared = 0;
            do {
                const std::uint32_t word = a.value | b.value | bits;
                shared += matches(a, word) && matches(b, word);
                bits = (bits - free) & free;
            } while (bits != 0);
            INFO(a.name << " and " << b.name);
            CHECK(shared == 0);
        }
    }
}

TEST_CASE("an alias only spells words that a primary form covers") {
    for (const Form& f : forms()) {
        if (!f.alias) continue;
        INFO(f.name);
        const Form* primary = find_form(f.value);
        REQUIRE(primary != nullptr);
        CHECK_FALSE(primary->alias);
    }
}

TEST_CASE("fields split over the word are gathered and spread") {
    const Form& load = form(FormId::MOV_WsOffset_Wnd);
    for (std::uint32_t k = 0; k < 1024; ++k)
        REQUIRE(load.field('k', load.value | load.place('k', k)) == k);
    CHECK(load.width('k') == 10);
    CHECK(form(FormId::CALL_Expr).field2('n', 0x7F) == 0x7F);
}

TEST_CASE("field constraints decide what is defined") {
    CHECK(find_form(0xDA4000) == nullptr);  // debugger break
    CHECK(find_form(0x3F0000) == nullptr);  // illegal by design
    CHECK(find_form(0x000000)->id == FormId::NOP);
    CHECK(find_form(0x400001)->id == FormId::ADD_Wb_Ws_Wd);
    CHECK(find_form(0x780F80)->id == FormId::MOV_Ws_Wd);
    CHECK(find_form(0xD80002)->id == FormId::DIV_SW_Wm_Wn);
    CHECK(find_form(0xD80001) == nullptr);  // divisor must be W2..W15
}
