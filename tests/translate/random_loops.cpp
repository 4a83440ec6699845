#include "tests/translate/random_loops.h"

#include "emu/dspic/assembler/assembler.h"

#include <array>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::tests {

using dspic::Form;

namespace {

constexpr std::uint32_t kRoutines = LoopProgram::kBody + 2 * LoopProgram::kBodyWords;

/// Of the core class, which is most of what programs execute.
bool common(const Form& form) {
    return is_plain(form) && !is_dsp(form) && form.value >> 20 != 0xF;
}

std::uint32_t with(const Form& form, std::uint32_t word, char letter, std::uint64_t number) {
    return (word & ~form.place(letter, 0xFFFF)) | form.place(letter, static_cast<std::uint32_t>(number));
}

/// W8 to W12 mostly point into RAM: pointers are taken from them, results go elsewhere.
std::uint32_t with_sane_pointers(RandomStream& random, const Form& form, std::uint32_t word) {
    const auto pointer = [&] { return 8 + random.below(5); };
    for (const auto& [mode, reg] :
         {std::pair{'p', 's'}, std::pair{'g', 's'}, std::pair{'q', 'd'}, std::pair{'h', 'd'}}) {
        if (!form.has_field(mode) || form.field(mode, word) == 0) continue;
        if (form.field(mode, word) >= 6 && random.below(2) != 0) return with(form, word, mode, 1);
        word = with(form, word, reg, pointer());
    }
    const bool direct = (form.has_field('q') && form.field('q', word) == 0) ||
                        (form.has_field('h') && form.field('h', word) == 0) ||
                        (!form.has_field('q') && !form.has_field('h'));
    if (form.name == "MOV_WsOffset_Wnd") word = with(form, word, 's', pointer());
    if (form.name == "MOV_Wns_WdOffset") return with(form, word, 'd', pointer());
    if (form.has_field('d') && direct && form.width('d') == 4)
        word = with(form, word, 'd', random.below(8) & (form.name.starts_with("MUL") ? 6 : 7));
    return word;
}

/// Nothing if that word would be of another form, or spoil the stack.
std::optional<std::uint32_t> try_word_of(RandomStream& random, const Form& form) {
    std::uint32_t word = (static_cast<std::uint32_t>(random.next()) & 0xFFFFFF & ~form.mask) | form.value;
    if (form.has_field('f') && random.below(24) != 0) {  // mostly RAM
        const auto address = static_cast<std::uint32_t>(0x0800 + random.below(0x800));
        const bool words = form.width('f') == 15;
        word = with(form, word, 'f', words ? address / 2 : random.below(4) ? address & ~1u : address);
    }
    if (form.has_field('f') && random.below(10) == 0) {  // a register that programs do look at
        constexpr std::uint32_t kRegisters[] = {0x32, 0x34, 0x36, 0x84, 0x85, 0x86, 0x8C, 0x94, 0x280, 0x282};
        const std::uint32_t address = kRegisters[random.below(std::size(kRegisters))];
        word = with(form, word, 'f', form.width('f') == 15 ? address / 2 : address);
    }
    if (random.below(24) != 0) word = with_sane_pointers(random, form, word);
    // W15 loses the stack soon enough without being written on purpose.
    if (form.has_field('d') && form.field('d', word) == 15 && random.below(16) != 0) return std::nullopt;
    if (dspic::find_form(word) != &form) return std::nullopt;
    return word;
}

std::uint32_t some_word(RandomStream& random, const std::vector<const Form*>& forms) {
    while (true)
        if (const auto word = try_word_of(random, *forms[random.below(forms.size())])) return *word;
}

std::uint32_t relative(std::uint32_t opcode, std::uint32_t from, std::uint32_t to) {
    return opcode << 16 | (((to - from - 2) / 2) & 0xFFFF);
}

}  // namespace

bool is_plain(const Form& form) {
    return !form.alias && !form.two_words() && !form.name.starts_with("TBLWT") && form.cycles == 1 &&
           !form.name.starts_with("BRA") && form.name != "RESET" && form.name != "PWRSAV_lit1" &&
           !form.name.starts_with("REPEAT") && !form.name.starts_with("DIV") && form.name != "ULNK";
}

bool is_dsp(const Form& form) {
    return form.value >> 20 == 0xC || form.value >> 18 == 0x3C;
}

std::uint32_t random_word_of(RandomStream& random, const Form& form) {
    while (true)
        if (const auto word = try_word_of(random, form)) return *word;
}

std::uint32_t random_plain_word(RandomStream& random) {
    static const auto list = [] {
        std::vector<const Form*> forms;
        for (const Form& form : dspic::forms())
            if (is_plain(form) && !is_dsp(form)) forms.push_back(&form);
        return forms;
    }();
    return some_word(random, list);
}

std::uint32_t random_word(RandomStream& random, std::uint32_t pc) {
    static const auto all = [] {
        std::array<std::vector<const Form*>, 2> lists;
        for (const Form& form : dspic::forms()) {
            if (common(form)) lists[0].push_back(&form);
            if (is_plain(form)) lists[1].push_back(&form);
        }
        return lists;
    }();
    const auto inside = [&](std::uint32_t first, std::uint32_t words) {
        return first + 2 * static_cast<std::uint32_t>(random.below(words));
    };
    const std::uint64_t kind = random.below(40);
    if (kind < 3) {  // a pointer into RAM, or to registers
        const std::uint64_t to =
            random.below(8) == 0 ? 0x27C + random.below(12) : 0x0900 + 2 * random.below(0x200);
        return 0x200000 | static_cast<std::uint32_t>(to) << 4 |
               static_cast<std::uint32_t>(8 + random.below(5));
    }
    if (kind < 10) {  // a conditional branch, near more often than far
        constexpr std::uint32_t kConditions[] = {0x30, 0x31, 0x32, 0x33, 0x34, 0x35, 0x36, 0x38, 0x39,
                                                 0x3A, 0x3B, 0x3C, 0x3D, 0x3E, 0x0C, 0x0D, 0x0E, 0x0F};
        std::uint32_t to = inside(LoopProgram::kBody, LoopProgram::kBodyWords);
        if (random.below(3) != 0) to = pc - 8 + 2 * static_cast<std::uint32_t>(random.below(10));
        if (to < LoopProgram::kBody || to >= kRoutines) to = LoopProgram::kBody;
        return relative(kConditions[random.below(18)], pc, to);
    }
    if (kind == 10) return relative(0x37, pc, inside(LoopProgram::kBody, LoopProgram::kBodyWords));
    if (kind == 11) return relative(0x07, pc, kRoutines + 16 * static_cast<std::uint32_t>(random.below(4)));
    if (kind == 12) return 0x090000 | static_cast<std::uint32_t>(random.below(6));   // REPEAT
    if (kind == 13) return 0xFC0000 | static_cast<std::uint32_t>(random.below(20));  // DISI
    if (kind < 16) {
        constexpr std::uint32_t kStack[] = {0x781F80, 0x78004F};  // push w0, pop w0
        const auto reg = static_cast<std::uint32_t>(random.below(14));
        return kind == 14 ? kStack[0] | reg : kStack[1] | reg << 7;
    }
    if (kind == 17 && random.below(2) != 0) {
        constexpr std::uint32_t kSaves[] = {0xF80036, 0xF90036, 0xF80034, 0xF90034};  // RCOUNT, PSVPAG
        return kSaves[random.below(4)];
    }
    return some_word(random, all[kind == 16]);
}

LoopProgram random_loops(RandomStream& random) {
    // Traps and the interrupt come to routines that go on at the start, or where they came from.
    std::string source = "        goto 0x200\n        .org 0x200\nstart:\n";
    for (int i = 0; i < 15; ++i)
        source += "        mov #" + std::to_string(0x0900 + 2 * random.below(0x300)) + ", w" +
                  std::to_string(i) + "\n";
    source += "        mov #0x1C00, w15\n        bset 0x8C, #3\n        goto 0x400\n"
              "trap:   clr 0x80\n        clr 0x44\n        mov #0x1800, w15\n        mov #0x200, w0\n"
              "        push w0\n        clr w0\n        push w0\n        clr 0x46\n        clr 0x50\n        "
              "retfie\n"
              "isr:    push w0\n        push 0x36\n        push 0x34\n        clr w0\n        mov w0, "
              "0x34\n        mov 0x0280, w0\n        mov 0x0900, w0\n        inc w0, w0\n        mov "
              "w0, 0x0900\n"
              "        bclr 0x84, #3\n        pop 0x34\n        pop 0x36\n        pop w0\n        retfie\n";
    const dspic::Program assembled = dspic::assemble(source);
    LoopProgram program;
    for (const auto& [address, word] : assembled.words)
        program.words[address] = word;
    for (std::uint32_t vector = 1; vector < 62; ++vector)
        program.words[4 + 2 * vector] = assembled.symbol(vector == 8 + 3 ? "isr" : "trap");
    for (std::uint32_t i = 0; i < LoopProgram::kBodyWords; ++i) {
        const std::uint32_t pc = LoopProgram::kBody + 2 * i;
        program.words[pc] = random_word(random, pc);
    }
    // A hardware loop over some words, and the way round.
    const auto loop = LoopProgram::kBody + 2 * static_cast<std::uint32_t>(random.below(40));
    program.words[loop] = 0x080000 | static_cast<std::uint32_t>(random.below(5));
    program.words[loop + 2] = static_cast<std::uint32_t>(1 + random.below(12));
    program.words[kRoutines - 4] = 0x040400;  // goto 0x400
    program.words[kRoutines - 2] = 0;
    for (std::uint32_t routine = 0; routine < 4; ++routine) {
        std::uint32_t pc = kRoutines + 16 * routine;
        program.words[pc] = routine % 2 ? 0xFA0004 : 0xEB0000;  // LNK #4 or CLR W0
        for (int i = 0; i < 4; ++i) {
            pc += 2;
            program.words[pc] = random_word(random, pc);
        }
        program.words[pc += 2] = routine % 2 ? 0xFA8000 : 0x000000;  // ULNK
        program.words[pc += 2] = 0x060000;                           // RETURN
        program.words[pc += 2] = 0x060000;
    }
    return program;
}

}  // namespace puckloop::tests
