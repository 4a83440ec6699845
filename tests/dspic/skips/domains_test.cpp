// An instruction means the same in every domain that it is executed in: what the affine domain of the loop
// walk gives for the nth iteration is what the interpreter does when it executes that iteration.

#include "base/random.h"
#include "emu/dspic/machine/execute/semantics.h"
#include "emu/dspic/walk/affine_domain.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <memory>

using namespace puckloop::dspic;
using puckloop::RandomStream;

namespace {

constexpr std::uint32_t kPc = 0x1000;
constexpr std::uint16_t kWindow = 0x1200;  ///< RAM that the pointers reach
constexpr std::size_t kWindowWords = 0x100;

/// A core without anything around it.
struct Bare {
    SfrSpace sfr;
    EventQueue events;
    InterruptController interrupts;
    Machine m;

    Bare() : interrupts(dspic30f6014a(), describe()), m(dspic30f6014a(), sfr, events, interrupts) {
        perform_reset(m, ResetCause::PowerOn);
    }
    SfrSpace& describe() {
        sfr.describe(dspic30f6014a().registers);
        return sfr;
    }
    std::uint16_t* window() { return m.ram + (kWindow - kRamStart) / 2; }
};

/// One instruction in the affine domain, W registers moving by `steps` an iteration.
class Once : public AffineDomain {
  public:
    Once(const Machine& m, const std::array<int, 16>& steps) : AffineDomain(m, plan, trace, {}) {
        bound_ = kMost;
        trace.boundaries.emplace_back();
        for (std::uint16_t reg = 0; reg < 16; ++reg) {
            first_[reg] = {};
            first_[reg].key = reg;
            first_[reg].step = steps[reg];
        }
        first_count_ = 16;
        c_ = {true, (m.st.sr & sr::C) != 0};
        z_ = {true, (m.st.sr & sr::Z) != 0};
        n_ = {true, (m.st.sr & sr::N) != 0};
        ov_ = {true, (m.st.sr & sr::OV) != 0};
    }
    /// False if the domain cannot follow.
    bool run(const Op* op) {
        try {
            next = execute_in<AffineDomain>(*this, op);
            for (std::size_t i = 0; i < plan.count; ++i)
                if (plan.cells[i].carried) hold(plan.cells[i].start, plan.cells[i].step, 0, 0xFFFF);
            return next != nullptr;
        } catch (const Stop&) {
            return false;
        }
    }
    std::uint64_t bound() const { return bound_; }
    std::uint16_t flags() const {
        return static_cast<std::uint16_t>((c_.value ? sr::C : 0) | (z_.value ? sr::Z : 0) |
                                          (n_.value ? sr::N : 0) | (ov_.value ? sr::OV : 0));
    }
    static constexpr std::uint64_t kMost = 1u << 20;
    static constexpr std::uint16_t kFlags = sr::C | sr::Z | sr::N | sr::OV;
    LoopPlan plan;
    LoopTrace trace;
    const Op* next = nullptr;
};

/// A word of a form with random fields that are legal; the pointers that it uses lead into the window.
std::uint32_t random_word(const Form& form, RandomStream& random) {
    while (true) {
        const auto word = (static_cast<std::uint32_t>(random.below(1u << 24)) & ~form.mask) | form.value;
        if (matches(form, word) && find_form(word) == &form) return word;
    }
}

std::uint16_t random_value(RandomStream& random) {
    const std::uint16_t edges[] = {0, 1, 2, 0x7F, 0x80, 0xFF, 0x100, 0x7FFF, 0x8000, 0xFFFE, 0xFFFF};
    if (random.below(3) == 0) return edges[random.below(std::size(edges))];
    if (random.below(2)) return static_cast<std::uint16_t>(kWindow + random.below(2 * kWindowWords - 16));
    return static_cast<std::uint16_t>(random.below(0x10000));
}

}  // namespace

TEST_CASE("an instruction means the same for affine values and for words") {
    RandomStream random(1, "domains");
    const auto before = std::make_unique<Bare>();
    const auto after = std::make_unique<Bare>();
    std::map<std::string_view, int> followed, moving;
    for (const Form& form : forms()) {
        if (form.alias) continue;
        for (int round = 0; round < 400; ++round) {
            const std::uint32_t word = random_word(form, random);
            const auto word2 = static_cast<std::uint32_t>(random.below(0x80));
            std::array<std::uint16_t, kWindowWords> memory{};
            for (auto& cell : memory)
                cell = random_value(random);
            std::array<std::uint16_t, 16> w{};
            std::array<int, 16> steps{};
            const bool moves = random.below(2);
            for (std::size_t reg = 0; reg < 16; ++reg) {
                w[reg] = random_value(random);
                if (moves && reg < 15 && random.below(3) != 0)
                    steps[reg] = static_cast<int>(random.below(9)) - 4;
            }
            w[15] = static_cast<std::uint16_t>((kWindow + 0x40 + random.below(0x80)) & ~1u);
            const auto status = static_cast<std::uint16_t>(random.below(16));
            const auto prepare = [&](Bare& bare, std::uint64_t n) -> const Op* {
                Machine& m = bare.m;
                for (const std::uint32_t offset : {0u, 2u})
                    write_program(m, kPc + offset, offset ? word2 : word);
                for (std::size_t reg = 0; reg < 16; ++reg)
                    m.st.w[reg] = static_cast<std::uint16_t>(w[reg] + steps[reg] * static_cast<int>(n));
                m.st.sr = status;
                m.st.cycle = 1000;
                m.watch = 0;
                m.limit = m.until = 1'000'000;
                m.reset_request.reset();
                std::fill(m.ram_store.begin(), m.ram_store.end(), std::uint16_t{0x1357});
                std::copy(memory.begin(), memory.end(), bare.window());
                Op& op = m.code[kPc / 2];
                decode(m, op);
                op.may_skip = false;
                return m.current = &op;
            };
            const Op* op = prepare(*before, 0);
            Once domain(before->m, steps);
            if (!domain.run(op)) continue;
            ++followed[form.name];
            for (std::size_t i = 0; i < domain.plan.count; ++i)
                if (domain.plan.cells[i].carried && domain.plan.cells[i].step != 0) {
                    ++moving[form.name];
                    break;
                }
            for (const std::uint64_t n :
                 {std::uint64_t{0}, std::uint64_t{1}, domain.bound() / 2, domain.bound()}) {
                if (n > domain.bound()) continue;
                const Op* real = prepare(*after, n);
                Machine& m = after->m;
                INFO(form.name << " " << std::hex << word << " n = " << std::dec << n << " of "
                               << domain.bound());
                const auto untouched = std::make_pair(m.st.w, m.ram_store);
                const Op* next = real->base(m, real);
                REQUIRE(next - m.code == domain.next - before->m.code);
                REQUIRE(m.st.cycle - 1000 == domain.plan.cycles);
                REQUIRE((m.st.sr & Once::kFlags) == domain.flags());
                auto expected = untouched;
                for (std::size_t i = 0; i < domain.plan.count; ++i) {
                    const LoopPlan::Cell& cell = domain.plan.cells[i];
                    const auto value =
                        static_cast<std::uint16_t>(cell.now + cell.now_step * static_cast<std::int32_t>(n));
                    (cell.key < 16 ? expected.first[cell.key]
                                   : expected.second[(cell.key - kRamStart) / 2u]) = value;
                }
                REQUIRE(m.st.w == expected.first);
                REQUIRE(m.ram_store == expected.second);
            }
        }
    }
    // What was followed is no accident: every group of forms, and values that move where they may.
    for (const char* name :
         {"ADD_Wb_Ws_Wd", "SUBBR_Wb_Ws_Wd", "AND_Wb_Ws_Wd",    "INC_Ws_Wd",    "NEG_Ws_Wd",   "CP_Wb_Ws",
          "CPSEQ_Wb_Wn",  "ASR_Ws_Wd",      "SL_Wb_Wns_Wnd",   "FF1L_Ws_Wnd",  "SWAP_Wn",     "MOV_Ws_Wd",
          "MOV_D_Ws_Wnd", "LNK_lit14",      "BSET_Ws_bit4",    "BTSS_Ws_bit4", "BSW_C_Ws_Wb", "BRA_LE_Expr",
          "CALL_Wn",      "RETURN",         "MUL_SS_Wb_Ws_Wnd"}) {
        INFO(name);
        CHECK(followed[name] > 20);
    }
    for (const char* name :
         {"ADD_Wb_Ws_Wd", "SUB_Wb_Ws_Wd", "INC_Ws_Wd", "DEC2_Ws_Wd", "MOV_Ws_Wd", "CP_Wb_Ws"}) {
        INFO(name);
        CHECK(moving[name] > 0);
    }
    CHECK(followed["PWRSAV_lit1"] == 0);
    CHECK(followed["RESET"] == 0);
}
