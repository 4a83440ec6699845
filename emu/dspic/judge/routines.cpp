#include "emu/dspic/judge/routines.h"

#include "emu/dspic/machine/isa.h"
#include "emu/dspic/machine/memory_map.h"

#include <set>
#include <vector>

namespace puckloop::dspic {

namespace {

constexpr std::size_t kMostWords = 20'000;

bool reads_only(const Form& form) {
    return form.mnemonic.starts_with("CP") || form.mnemonic.starts_with("MUL") ||
           form.mnemonic.starts_with("PUSH") || form.id == FormId::MOV_f || form.id == FormId::BTST_f_bit4 ||
           form.id == FormId::BTSS_f_bit4 || form.id == FormId::BTSC_f_bit4 ||
           form.operands.ends_with(",WREG") || form.operands.ends_with(",Wnd");
}

bool names(const Form& form, std::uint32_t word, std::uint16_t address) {
    if (form.id == FormId::MOV_lit16_Wnd) return form.field('k', word) == address;
    if (!form.has_field('f') || reads_only(form)) return false;
    constexpr int kByteAddress = 13;
    const bool words = form.width('f') != kByteAddress;
    const std::uint32_t found = form.field('f', word) << (words ? 1 : 0);
    return (found & ~1u) == address;
}

std::uint32_t relative(const Form& form, std::uint32_t word, std::uint32_t pc) {
    const int offset = static_cast<std::int16_t>(form.field('n', word));
    return static_cast<std::uint32_t>(static_cast<int>(pc) + 2 + 2 * offset) & kProgramSpace;
}

}  // namespace

bool routine_names(const ProgramReader& word, std::uint32_t entry, std::uint16_t address) {
    std::set<std::uint32_t> seen;
    std::vector<std::uint32_t> open{entry & kProgramSpace};
    while (!open.empty() && seen.size() < kMostWords) {
        std::uint32_t pc = open.back();
        open.pop_back();
        while (seen.size() < kMostWords && seen.insert(pc).second) {
            const std::uint32_t text = word(pc);
            const Form* form = find_form(text);
            if (form == nullptr) break;
            if (names(*form, text, address)) return true;
            const FormId id = form->id;
            const std::uint32_t next = pc + (form->two_words() ? 4 : 2);
            if (id == FormId::RETURN || id == FormId::RETFIE || id == FormId::RETLW_lit10_Wn ||
                id == FormId::RESET || id == FormId::BRA_Wn || id == FormId::GOTO_Wn)
                break;
            if (id == FormId::CALL_Expr || id == FormId::GOTO_Expr) {
                open.push_back(form->field2('n', word(pc + 2)) << 16 | form->field('n', text) << 1);
                if (id == FormId::GOTO_Expr) break;
            } else if (id == FormId::RCALL_Expr || id == FormId::BRA_Expr ||
                       form->mnemonic.starts_with("BRA ")) {
                open.push_back(relative(*form, text, pc));
                if (id == FormId::BRA_Expr) break;
            }
            pc = next;
        }
    }
    return false;
}

}  // namespace puckloop::dspic
