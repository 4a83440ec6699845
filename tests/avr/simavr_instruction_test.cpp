// Every instruction against simavr's core: random operands, registers, flags and memory; the whole state and
// the cycles are compared afterwards. One departure of simavr 1.6: its RAMPZ has eight bits, the
// ATmega1284P's one ("bits 7:1 are reserved and read as zero"), which ELPM Z+ shows at the end of the flash.

#include "base/random.h"
#include "emu/avr/core/core.h"
#include "emu/avr/isa/isa.h"
#include "tests/avr/simavr.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <string>
#include <vector>

using namespace puckloop;
using namespace puckloop::avr;

namespace {

constexpr int kCasesPerForm = 1000;
constexpr std::uint16_t kErased = 0xFFFF;
/// GPIOR0..2: I/O registers that are mere storage on both sides.
constexpr std::uint16_t kStorage[] = {0x3E, 0x4A, 0x4B};

class Pair {
  public:
    Pair() : core_(atmega1284p(), described(io_), events_, interrupts_) {}

    /// Runs `word` and what follows it from the same random state on both; what differs, or nothing.
    std::string compare(const Form& form, RandomStream& random);

  private:
    static IoSpace& described(IoSpace& io) {
        io.describe(atmega1284p().registers);
        return io;
    }
    CoreState random_state(const Form& form, RandomStream& random);
    std::uint16_t random_word(const Form& form, RandomStream& random);

    IoSpace io_;
    EventQueue events_;
    InterruptController interrupts_;
    Core core_;
    test::Simavr simavr_;
};

std::uint8_t byte(RandomStream& random) {
    return static_cast<std::uint8_t>(random.below(256));
}

/// A pointer into RAM, now and then among the working registers; not at the edges, which displacements cross.
std::uint16_t pointer(RandomStream& random) {
    return static_cast<std::uint16_t>(random.below(16) == 0 ? random.below(20) + 4
                                                            : 0x140 + random.below(0x3E00));
}

bool uses_pointers(const Form& form) {
    return form.operands.find_first_of("XYZ") != std::string_view::npos && form.mnemonic != "lpm" &&
           form.mnemonic != "elpm";
}

/// A pointer register loaded or stored by the access that moves it: "the result is undefined", states the
/// manual.
bool leaves_result_open(const Form& form, std::uint16_t word) {
    const auto name = form.operands.find_first_of("XYZ");
    const bool moves =
        form.operands.find_first_of("+-") != std::string_view::npos && !form.pattern.width('q');
    if (name == std::string_view::npos || !moves) return false;
    const std::uint32_t reg = form.pattern.field('d', word) | form.pattern.field('r', word);
    return reg / 2 == 13u + static_cast<std::uint32_t>(form.operands[name] - 'X');
}

CoreState Pair::random_state(const Form& form, RandomStream& random) {
    CoreState state;
    for (std::uint8_t& r : state.r)
        r = byte(random);
    // Equal, zero and sign-changing operands more often than chance gives them.
    if (random.below(4) == 0)
        for (std::uint8_t& r : state.r)
            r = std::array<std::uint8_t, 4>{0, 0xFF, 0x80, 0x7F}[random.below(4)];
    if (uses_pointers(form)) {
        for (const std::size_t low : {26u, 28u, 30u}) {
            const std::uint16_t address = pointer(random);
            state.r[low] = static_cast<std::uint8_t>(address);
            state.r[low + 1] = static_cast<std::uint8_t>(address >> 8);
        }
        if (form.mnemonic == "ldd" || form.mnemonic == "std")  // not into the registers of the peripherals
            for (const std::size_t low : {28u, 30u})
                if (state.r[low + 1] == 0) state.r[low + 1] = 2;
    }
    state.sreg = byte(random);
    state.rampz = static_cast<std::uint8_t>(random.below(2));
    state.sp = static_cast<std::uint16_t>(0x200 + random.below(0x3D00));
    state.pc = static_cast<std::uint16_t>(0x1000 + random.below(0x8000));
    return state;
}

std::uint16_t Pair::random_word(const Form& form, RandomStream& random) {
    while (true) {
        const auto word = static_cast<std::uint16_t>(
            form.pattern.value() | (random.below(0x10000) & ~std::uint32_t{form.pattern.mask()}));
        if (form.pattern.width('A') != 0) {
            const std::uint32_t address = form.pattern.field('A', word) + 0x20;
            const bool low = form.pattern.width('A') == 5;
            if (address != kStorage[0] && (low || (address != kStorage[1] && address != kStorage[2])))
                continue;
        }
        if (leaves_result_open(form, word)) continue;
        return word;
    }
}

std::string Pair::compare(const Form& form, RandomStream& random) {
    const std::uint16_t word = random_word(form, random);
    CoreState state = random_state(form, random);
    state.cycle = core_.cycle();
    std::vector<std::uint16_t> words = {word, static_cast<std::uint16_t>(random.below(0x10000))};
    if (form.two_words && (form.id == FormId::LDS || form.id == FormId::STS))
        words[1] = random.below(8) == 0 ? kStorage[random.below(3)] : pointer(random);
    if (form.two_words && (form.id == FormId::JMP || form.id == FormId::CALL)) {
        words[0] &= static_cast<std::uint16_t>(~form.pattern.place('k', 0x3F));  // a 16-bit program counter
        words[0] |= form.pattern.value();
    }
    // A skip may find one or two words.
    const Form& behind = avr::form(random.below(2) ? FormId::JMP : FormId::ADD);
    if (form.extra == Extra::Skip) words[1] = behind.pattern.value();

    std::vector<std::uint16_t> addresses = {kStorage[0], kStorage[1], kStorage[2]};
    for (const std::size_t low : {26u, 28u, 30u})
        for (int i = -1; i < 64; ++i)
            addresses.push_back(static_cast<std::uint16_t>((state.r[low] | state.r[low + 1] << 8) + i));
    for (int i = -2; i <= 3; ++i)
        addresses.push_back(static_cast<std::uint16_t>(state.sp + i));
    if (form.two_words) addresses.push_back(words[1]);
    std::erase_if(addresses, [](std::uint16_t a) {
        return (a < 0x100 || a > 0x40FF) && a != kStorage[0] && a != kStorage[1] && a != kStorage[2];
    });
    for (const std::uint16_t address : addresses) {
        const std::uint8_t value = byte(random);
        if (address < 0x100)
            io_.raw(address) = value;
        else
            core_.ram()[address - 0x100u] = value;
        simavr_.set_data(address, value);
    }
    for (std::uint32_t i = 0; i < words.size(); ++i) {
        core_.set_program(state.pc + i, words[i]);
        simavr_.set_program(state.pc + i, words[i]);
    }
    // Program memory that LPM and ELPM may read.
    const std::uint32_t z = (state.r[30] | state.r[31] << 8) / 2u;
    for (const std::uint32_t bank : {0u, 0x8000u}) {
        const std::uint32_t at = bank + z;
        if (at >= state.pc && at < state.pc + words.size()) continue;
        const auto value = static_cast<std::uint16_t>(random.below(0x10000));
        core_.set_program(at, value);
        simavr_.set_program(at, value);
    }

    core_.set_state(state);
    simavr_.set_state(state);
    core_.step();
    simavr_.step();

    std::string difference;
    const CoreState ours = core_.state(), theirs = simavr_.state();
    const auto differs = [&](std::string_view what, std::uint64_t a, std::uint64_t b) {
        if (a != b) difference += fmt::format(" {} {:x} not {:x}", what, a, b);
    };
    for (std::size_t i = 0; i < ours.r.size(); ++i)
        differs(fmt::format("r{}", i), ours.r[i], theirs.r[i]);
    differs("sreg", ours.sreg, theirs.sreg);
    differs("sp", ours.sp, theirs.sp);
    differs("rampz", ours.rampz, theirs.rampz & 1);
    differs("pc", ours.pc, theirs.pc);
    differs("cycles", ours.cycle - state.cycle, theirs.cycle - state.cycle);
    for (const std::uint16_t address : addresses)
        differs(fmt::format("[{:04x}]", address),
                address < 0x100 ? io_.raw(address) : core_.ram()[address - 0x100u], simavr_.data(address));
    for (std::uint32_t i = 0; i < words.size(); ++i)
        core_.set_program(state.pc + i, kErased);
    if (!difference.empty())
        difference = fmt::format("{} {:04x} {:04x} from sreg {:02x}:{}", form.name, words[0], words[1],
                                 state.sreg, difference);
    return difference;
}

}  // namespace

TEST_CASE("Every instruction leaves the state and takes the cycles of simavr") {
    Pair pair;
    int compared = 0, expected = 0;
    for (const Form& form : forms()) {
        if (form.role != Role::Primary) continue;
        RandomStream random(1284, form.name);
        int failures = 0;
        expected += kCasesPerForm;
        for (int i = 0; i < kCasesPerForm; ++i, ++compared) {
            const std::string difference = pair.compare(form, random);
            if (difference.empty()) continue;
            if (++failures <= 3) UNSCOPED_INFO(difference);
        }
        CHECK(failures == 0);
    }
    CHECK(compared == expected);
    CHECK(kCasesPerForm >= 200);
    WARN(compared << " cases compared");
}
